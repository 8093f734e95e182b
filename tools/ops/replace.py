"""The operation replace: remove the target and put a new object in its place."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from ...gaussians.language.query.selection import Selection, mask_of
from ...gaussians.scene import Scene
from ..checks import count_matches, none_left, placed
from ..cloud_diff import selection_of
from ..new_objects import (
    AssetRequest,
    NewObjects,
    add_obstacle,
    affine_of,
    fitted,
    in_its_light,
    make_asset,
    rested,
    scene_scale,
    set_down,
    standing_axes,
)
from ..operation import AssetName, ColorName, Context, Outcome, TargetedOp
from ..placement.bodies import bodies_of
from ..placement.place import spot_near
from ..placement.surroundings import Surroundings
from ..receipt import Check


class Replace(TargetedOp):
    """Take the target away and put a new object of another kind in its place."""

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "replace the stool with a green armchair",
        {"op": "replace", "target": {"text": "stool"}, "asset": "armchair", "color": "green"},
    )
    takes_enclosed: ClassVar[bool] = True
    reveals: ClassVar[bool] = True
    puts: ClassVar[bool] = True
    op: Literal["replace"] = "replace"
    asset: AssetName
    """Kind of the new object, singular."""
    color: ColorName | None = None
    infill: bool = True  # whether the surfaces that it hid are filled, see `completing`
    harmony: bool = True  # whether its colours are fitted to the light of the scene, see `harmony`

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        bodies = bodies_of(scene, selection)
        go = mask_of(scene.cloud, selection.ids)
        # Removed ids are not used again: new ids are above those of the whole scene.
        objects, moved, notes = NewObjects(scene, go), [], dict[str, None]()
        around = Surroundings(scene, context, go, frozenset(b.group for b in bodies))
        for index, body in enumerate(bodies):
            scale = fitted(scene_scale(scene, [(body, self.target.text)]), self.asset, body.box)
            request = AssetRequest(self.asset, self.color, context.seed + index, scale, own=context.assets)
            asset = make_asset(scene, request)
            around.rests = asset.support not in ("wall", "ceiling")
            spot = rested(around, spot_near(around, asset.size, standing_axes(around, [body]), body), asset)
            cloud = set_down(asset, spot.foot, spot.axes)
            cloud, told = in_its_light(
                cloud, scene, self.harmony and context.harmony, self.color is None, asset.pigment
            )
            add_obstacle(cloud, scene, around)
            moved.append(affine_of(objects.add(cloud, asset.label, spot.axes), spot.support, spot.touches))
            notes |= dict.fromkeys((*asset.notes, *spot.notes, *told))
        after, groups = objects.build_scene(context)
        added = objects.ids()
        focus = selection_of(selection, added, groups, f"the new {self.asset}")
        return Outcome(
            after, added=added, removed=scene.cloud.ids[go], moved=tuple(moved), notes=tuple(notes), focus=focus
        )

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        after = outcome.scene
        return none_left(after, outcome), count_matches(before, after, outcome), *placed(outcome)

"""The operation insert: add new objects from the asset library."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

import torch
from pydantic import Field
from torch import Tensor

from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from ..checks import count_matches, out_of_view_note, placed
from ..cloud_diff import rows_of
from ..new_objects import (
    AssetRequest,
    NewObjects,
    add_obstacle,
    affine_of,
    find_spot,
    in_its_light,
    laid,
    make_asset,
    rested,
    scene_scale,
    set_down,
    viewed_point,
)
from ..operation import AssetName, ColorName, Context, EditOp, Length, Outcome, Placement
from ..placement.place import anchors_of
from ..placement.surroundings import Surroundings
from ..receipt import Check, at_least
from ..when import When


class Insert(EditOp):
    """Add new objects of a kind from the asset library, standing at `place` (or on a free spot of the floor)."""

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "put a red vase on the coffee table",
        {
            "op": "insert", "asset": "vase", "color": "red",
            "place": {"relation": "on", "anchors": [{"text": "coffee table"}]},
        },
    )  # fmt: skip
    puts: ClassVar[bool] = True
    op: Literal["insert"] = "insert"
    asset: AssetName
    """Kind of object, singular: "armchair", "floor lamp"."""
    count: Annotated[int, Field(ge=1, le=50)] = 1
    color: ColorName | None = None
    height: Length | None = None
    """How tall it is to be; otherwise as tall as such things are."""
    place: Placement | None = None
    harmony: bool = True  # whether its colours are fitted to the light of the scene, see `harmony`
    when: When | None = None

    def time(self) -> When | None:
        return self.when

    def subject(self) -> str:
        return f"{self.count} {self.asset}" if self.count > 1 else self.asset

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        around, objects, moved = Surroundings(scene, context), NewObjects(scene), []
        anchors = anchors_of(around, self.place) if self.place is not None else []
        called = self.place.anchors[0].text if self.place is not None and len(anchors) == 1 else ""
        named = [(body, called) for body in anchors]
        scale, start, notes = scene_scale(scene, named), viewed_point(around), dict[str, None]()
        for index in range(self.count):
            request = AssetRequest(self.asset, self.color, context.seed + index, scale, self.height, context.assets)
            asset = laid(make_asset(scene, request), self.place)
            around.rests = asset.support not in ("wall", "ceiling")
            spot = rested(around, find_spot(around, asset, self.place, start), asset)
            cloud = set_down(asset, spot.foot, spot.axes)
            cloud, fitted = in_its_light(
                cloud, scene, self.harmony and context.harmony, self.color is None, asset.pigment
            )
            add_obstacle(cloud, scene, around)
            hangs = self.place is None and asset.support in ("wall", "ceiling")
            moved.append(
                affine_of(objects.add(cloud, asset.label, spot.axes), None if hangs else spot.support, spot.touches)
            )
            notes |= dict.fromkeys((*asset.notes, *spot.notes, *fitted))
        after, groups = objects.build_scene(context)
        added = objects.ids()
        query = Query(text=objects.entries[0].label, groups=groups)
        focus = Selection(query, "found", added, groups, (), f"{self.subject()}, just inserted")
        said = (*notes, *out_of_view_note(after, tuple(moved), context.viewer))
        return Outcome(after, added=added, moved=tuple(moved), notes=said, focus=focus)

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        after = outcome.scene
        there = len(rows_of(after.cloud, outcome.added))
        checks = [at_least("inserted", there, 1, "Gaussians", f"{there:,} Gaussians of {self.subject()} are there")]
        checks.append(count_matches(before, after, outcome))
        return *checks, *placed(outcome)

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        return torch.zeros(len(scene.cloud), dtype=torch.bool, device=scene.cloud.device)


def _label(objects: NewObjects) -> str:
    """What the new things are called."""
    return objects.entries[0].label

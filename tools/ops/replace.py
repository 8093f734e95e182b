"""replace: another object where the target stands."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from ...gaussians.language.query.selection import Selection, mask_of
from ...gaussians.scene import Scene
from ..checks import collision_free, counted, gone, supported
from ..cloud_diff import selection_of
from ..new_objects import Arrivals, Piece, Wish, as_moved, fetch, metre, set_down, standing_axes, taken_by
from ..operation import AssetName, ColorName, Context, Outcome, TargetedOp
from ..placement.bodies import Body, bodies_of
from ..placement.place import Spot, spot_near
from ..placement.surroundings import Surroundings
from ..receipt import Check


class Replace(TargetedOp):
    """Take the target away and put a new object of another kind in its place."""

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "replace the stool with a green armchair",
        {"op": "replace", "target": {"text": "stool"}, "asset": "armchair", "color": "green"},
    )
    op: Literal["replace"] = "replace"
    asset: AssetName
    """Kind of the new object, singular."""
    color: ColorName | None = None

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        bodies = bodies_of(scene, selection)
        go = mask_of(scene.cloud, selection.ids)
        # Ids of what goes are not given out again: the arrivals are numbered above those of the whole scene.
        arrivals, moved, notes = Arrivals(scene, go), [], dict[str, None]()
        around = Surroundings(scene, context, go, frozenset(b.group for b in bodies))
        for index, body in enumerate(bodies):
            wish = Wish(self.asset, self.color, context.seed + index, metre(scene, [body]))
            piece = fetch(scene, wish)
            spot = self._spot(around, piece, body)
            cloud = set_down(piece, spot.foot, spot.axes)
            taken_by(cloud, scene, around)
            moved.append(as_moved(arrivals.add(cloud, piece.label, spot.axes), spot.support))
            notes |= dict.fromkeys((*piece.notes, *spot.notes))
        after, groups = arrivals.enter(context)
        added = arrivals.ids()
        focus = selection_of(selection, added, groups, f"the new {self.asset}")
        return Outcome(
            after, added=added, removed=scene.cloud.ids[go], moved=tuple(moved), notes=tuple(notes), focus=focus
        )

    def _spot(self, around: Surroundings, piece: Piece, body: Body) -> Spot:
        """Where the old thing stood, or as near to it as there is room."""
        return spot_near(around, piece.size, standing_axes(around, [body]), body)

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        after = outcome.scene
        checks = [gone(after, outcome), counted(before, after, outcome)]
        checks += [c for c in (supported(after, outcome.moved), collision_free(after, outcome.moved)) if c is not None]
        return tuple(checks)

"""insert: a new object from the asset library."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

import torch
from pydantic import Field
from torch import Tensor

from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from ..checks import collision_free, counted, supported, unseen
from ..cloud_diff import rows_of
from ..new_objects import Arrivals, Wish, as_moved, fetch, find_spot, gaze, metre, set_down, taken_by
from ..operation import AssetName, ColorName, Context, EditOp, Length, Outcome, Placement
from ..placement.place import anchors_of
from ..placement.surroundings import Surroundings
from ..receipt import Check, at_least


class Insert(EditOp):
    """Add new objects of a kind from the asset library, standing at `place` (or on a free spot of the floor)."""

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "put a red vase on the coffee table",
        {
            "op": "insert", "asset": "vase", "color": "red",
            "place": {"relation": "on", "anchors": [{"text": "coffee table"}]},
        },
    )  # fmt: skip
    op: Literal["insert"] = "insert"
    asset: AssetName
    """Kind of object, singular: "armchair", "floor lamp"."""
    count: Annotated[int, Field(ge=1, le=50)] = 1
    color: ColorName | None = None
    height: Length | None = None
    """How tall it is to be; otherwise as tall as such things are."""
    place: Placement | None = None

    def subject(self) -> str:
        return f"{self.count} {self.asset}" if self.count > 1 else self.asset

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        around, arrivals, moved = Surroundings(scene, context), Arrivals(scene), []
        anchors = anchors_of(around, self.place) if self.place is not None else []
        scale, start, notes = metre(scene, anchors), gaze(around), dict[str, None]()
        for index in range(self.count):
            wish = Wish(self.asset, self.color, context.seed + index, scale, self.height)
            piece = fetch(scene, wish)
            spot = find_spot(around, piece, self.place, start)
            cloud = set_down(piece, spot.foot, spot.axes)
            taken_by(cloud, scene, around)
            hangs = self.place is None and piece.support in ("wall", "ceiling")
            moved.append(as_moved(arrivals.add(cloud, piece.label, spot.axes), None if hangs else spot.support))
            notes |= dict.fromkeys(piece.notes)
        after, groups = arrivals.enter(context)
        added = arrivals.ids()
        query = Query(text=moved_label(arrivals), groups=groups)
        focus = Selection(query, "found", added, groups, (), f"{self.subject()}, just inserted")
        said = (*notes, *unseen(after, tuple(moved), context.viewer))
        return Outcome(after, added=added, moved=tuple(moved), notes=said, focus=focus)

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        after = outcome.scene
        there = len(rows_of(after.cloud, outcome.added))
        checks = [at_least("inserted", there, 1, "Gaussians", f"{there:,} Gaussians of {self.subject()} are there")]
        checks.append(counted(before, after, outcome))
        checks += [c for c in (supported(after, outcome.moved), collision_free(after, outcome.moved)) if c is not None]
        return tuple(checks)

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        return torch.zeros(len(scene.cloud), dtype=torch.bool, device=scene.cloud.device)


def moved_label(arrivals: Arrivals) -> str:
    """What the new things are called."""
    return arrivals.newcomers[0].label

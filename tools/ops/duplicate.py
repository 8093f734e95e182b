"""The operation duplicate: add copies of the target."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
import torch
from pydantic import ConfigDict, Field, model_validator
from torch import Tensor

from ...gaussians.language.field.measure import solid_points
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from ..alternatives import NOT_GIVEN, either, given
from ..carried_objects import is_told_apart
from ..checks import count_matches, moved_as_asked, overlap_notes, placed
from ..cloud_diff import Draft, selection_of
from ..new_objects import NewObjects
from ..operation import Affine, Context, Direction, Length, Outcome, Placement, TargetedOp
from ..placement.bodies import Array, Body, bodies_of, centimetre, heading
from ..placement.place import anchors_of, free_spot, spot_beside
from ..placement.surroundings import Surroundings
from ..receipt import Check
from ..transform import shift

_STEP = 0.35  # of its height: by which a copy in a capture may stand higher or lower than its original


_FARTHER = (0.0, 0.3, 0.6, 1.0)  # of its width: how much farther off a copy may stand where there is more room
_WAYS: dict[str, Direction] = {"left_of": "left", "in_front_of": "backward", "behind": "forward"}


class Duplicate(TargetedOp):
    """Copy the target `count` times: in a row along `direction`, or to a `place`, or else to free spots beside it.

    `distance` is the step from one copy to the next and goes with `direction`; without it copies stand side by side.
    """

    model_config = ConfigDict(
        json_schema_extra=either(
            {"direction": given(), "place": NOT_GIVEN}, {"direction": NOT_GIVEN, "distance": NOT_GIVEN}
        )
    )
    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "put another two chairs like this one to the right",
        {"op": "duplicate", "target": {"text": "chair"}, "count": 2, "direction": "right"},
    )
    takes_enclosed: ClassVar[bool] = True
    puts: ClassVar[bool] = True
    op: Literal["duplicate"] = "duplicate"
    count: Annotated[int, Field(ge=1, le=50)] = 1
    direction: Direction | None = None
    distance: Length | None = None
    place: Placement | None = None

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if self.place is not None and self.direction is not None:
            raise ValueError("duplicate takes a direction or a place, not both")
        if self.distance is not None and self.direction is None:
            raise ValueError("a distance needs the direction it goes in")
        return self

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        return torch.zeros(len(scene.cloud), dtype=torch.bool, device=scene.cloud.device)

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        bodies = bodies_of(scene, selection)
        objects, moved = NewObjects(scene), []
        notes = self.distance.assumption(scene.frame) if self.distance is not None else ()
        copies, found = self._copies(scene, bodies, context)
        notes += found
        for body, offset, support in copies:
            original = scene.cloud[body.rows]
            draft = Draft(original)
            shift(draft, torch.arange(len(original), device=original.device), offset)
            like = body.group if scene.language is not None and body.group >= 0 else None
            rows = objects.add(draft.done(), body.label, body.box.axes, like)
            moved.append(Affine(rows, np.eye(3), offset, body.rows, support))
        after, groups = objects.build_scene(context)
        added = objects.ids()
        if self.direction is not None:
            notes += overlap_notes(after, set(groups))
        said = f"{len(moved)} new of {self.target.describe()}"
        focus = selection_of(selection, added, groups, said)
        return Outcome(after, added=added, moved=tuple(moved), notes=notes, focus=focus)

    def _copies(
        self, scene: Scene, bodies: list[Body], context: Context
    ) -> tuple[list[tuple[Body, Array, float | None]], tuple[str, ...]]:
        """For each copy its original, its offset, and the height of its support (None if it was not placed); notes."""
        if self.direction is not None:
            way = heading(context.viewer, scene.frame, self.direction)
            step = self._step(scene, bodies, way)
            return [(b, way * step * (i + 1), None) for i in range(self.count) for b in bodies], ()
        up, around = scene.frame.up_vector, Surroundings(scene, context)
        found: list[tuple[Body, Array, float | None]] = []
        notes = dict[str, None]()
        place = self.place
        for body in [b for _ in range(self.count) for b in bodies]:
            if place is not None:
                spot = free_spot(around, body.box.size, body.box.axes, place, body.foot(up))
            else:
                spot = spot_beside(around, body)
            offset = spot.foot - body.foot(up)
            support: float | None = spot.support
            if abs(float(offset @ up)) > _STEP * body.box.size[2] and not is_told_apart(scene):
                offset, support = self._beside(around, body, context), None
                notes["no surface is seen where the copy goes: it is as high as the original"] = None
            around.add_obstacle(solid_points(scene.cloud, body.rows) + offset, body.box.shifted(offset))
            found.append((body, offset, support))
            notes |= dict.fromkeys(spot.notes if support is not None else ())
        return found, tuple(notes)

    def _beside(self, around: Surroundings, body: Body, context: Context) -> Array:
        """The way of a copy to the side that the place names of a thing, or else to the right of the original, at the
        height of the original."""
        anchors = anchors_of(around, self.place) if self.place is not None else []
        by, up = anchors[0] if anchors else body, around.up
        side = _WAYS.get(self.place.relation, "right") if self.place is not None else "right"
        way = heading(context.viewer, around.frame, side)
        gap = 8 * centimetre(around.frame, max(body.box.size))
        goal = by.center + way * ((by.box.extent(way) + body.box.extent(way)) / 2 + gap)
        level = goal - body.center - up * float((goal - body.center) @ up)
        tries = [level + step * body.box.extent(way) * way for step in _FARTHER]
        return min(tries, key=lambda offset: self._taken(around, body, offset))

    def _taken(self, around: Surroundings, body: Body, offset: Array) -> int:
        """How many solid points are where a copy would be."""
        local = np.abs(body.box.shifted(offset).local(around.solid.astype(np.float64)))
        return int((local <= 0.45 * np.array(body.box.size)).all(axis=1).sum())

    def _step(self, scene: Scene, bodies: list[Body], way: Array) -> float:
        """Step from one copy to the next: as given, or the extent of all originals together plus 8 cm."""
        if self.distance is not None:
            return self.distance.in_units(scene.frame)
        corners = np.concatenate([b.box.corners() for b in bodies]) @ way
        return float(np.ptp(corners)) + 8 * centimetre(scene.frame, max(b.box.extent(way) for b in bodies))

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        after = outcome.scene
        return moved_as_asked(before, after, outcome.moved), count_matches(before, after, outcome), *placed(outcome)

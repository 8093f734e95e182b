"""The operation move: move the target by a distance, toward something, or to a place."""

from __future__ import annotations

import math
from typing import Any, ClassVar, Literal, Self

import numpy as np
import torch
from pydantic import ConfigDict, model_validator
from torch import Tensor

from ...gaussians.errors import InstructionError
from ...gaussians.language.field.measure import solid_points
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Scene
from ...gaussians.world.box import Box
from ..alternatives import NOT_GIVEN, either, given
from ..carried_objects import carried_note, rows_with_carried, with_carried
from ..checks import count_matches, moved_as_asked, overlap_notes, placed
from ..cloud_diff import Draft
from ..field_update import after_move
from ..operation import Affine, Context, Direction, Length, Outcome, Placement, TargetedOp
from ..placement.bodies import (
    Array,
    Body,
    bodies_of,
    centimetre,
    contact_box,
    groups_of,
    heading,
    mask_of_bodies,
    strays_note,
)
from ..placement.overhead import place_above
from ..placement.place import free_spot
from ..placement.surroundings import Surroundings, support_height
from ..placement.walls import clear_length, require_clear_path
from ..receipt import Check, at_most
from ..transform import shift, turn

_NO: dict[str, Any] = {"enum": [False]}
_MOST_OF_IT = 0.8  # of the way to something: where a wall ends it after more, it is near enough
_SHORT = 1e-4  # units: less is no way that a wall ends


class Move(TargetedOp):
    """Move the target: in a `direction`, `toward` something, or to a `place`; exactly one of the three.

    Directions are the viewer's: forward is away from the viewer, right is to the viewer's right. `away`: from what
    `toward` names, not to it. `distance` goes with `direction` or `toward`; without it the target moves by its own
    width, or until it stands next to what it goes to. It does not go through walls or out of the room. What stands on
    it goes along.
    """

    model_config = ConfigDict(
        json_schema_extra=either(
            {"direction": given(), "toward": NOT_GIVEN, "place": NOT_GIVEN, "away": _NO},
            {"toward": given(), "direction": NOT_GIVEN, "place": NOT_GIVEN},
            {"place": given(), "direction": NOT_GIVEN, "toward": NOT_GIVEN, "distance": NOT_GIVEN, "away": _NO},
        )
    )
    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "move the lamp 40 cm to the left",
        {"op": "move", "target": {"text": "lamp"}, "direction": "left", "distance": {"value": 40, "unit": "cm"}},
    )
    takes_enclosed: ClassVar[bool] = True
    reveals: ClassVar[bool] = True
    puts: ClassVar[bool] = True
    op: Literal["move"] = "move"
    direction: Direction | None = None
    distance: Length | None = None
    place: Placement | None = None
    """Where to put it down: supported and free of collision."""
    toward: Query | None = None
    away: bool = False
    infill: bool = True  # whether the surfaces that it hid are filled, see `completing`

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        said = [n for n in ("direction", "toward", "place") if getattr(self, n) is not None]
        if len(said) != 1:
            raise ValueError(f"move needs exactly one of direction, toward and place, got {said or 'none'}")
        if self.place is not None and self.distance is not None:
            raise ValueError("a distance goes with a direction or toward, not with a place")
        if self.away and self.toward is None:
            raise ValueError("away goes with toward, which says from what")
        return self

    def stronger(self, times: float) -> Self | None:
        return None if self.distance is None else self.model_copy(update={"distance": self.distance.times(times)})

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        return rows_with_carried(scene, selection)

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        bodies = with_carried(scene, bodies_of(scene, selection))
        moved, notes = self._moves(scene, bodies, context)
        if self.place is None:
            require_clear_path(scene, bodies, [asked.offset for asked in moved])
        draft = Draft(scene.cloud)
        for asked in moved:
            if np.array_equal(asked.matrix, np.eye(3)):
                shift(draft, asked.rows, asked.offset)
            else:  # an object that moves to another wall turns its back to that wall
                turn(draft, asked.rows, asked.matrix, asked.offset)
        cloud = draft.done()
        after = scene.replace(cloud=cloud, language=after_move(scene, cloud, moved))
        if self.place is None:
            notes += overlap_notes(after, groups_of(bodies))
        touched = scene.cloud.ids[torch.cat([body.rows for body in bodies])].sort().values
        notes = (*notes, *carried_note(scene, bodies), *strays_note(bodies))
        return Outcome(after, touched=touched, moved=tuple(moved), notes=notes)

    def _moves(self, scene: Scene, bodies: list[Body], context: Context) -> tuple[list[Affine], tuple[str, ...]]:
        """The map requested for each body, and notes."""
        said = self.distance.assumption(scene.frame) if self.distance is not None else ()
        if self.place is not None:
            return self._placed(scene, bodies, context, self.place)
        if self.toward is not None:
            goals = bodies_of(scene, context.resolve(scene, self.toward).require())
            if self.away:
                said += () if self.distance is not None else ("no distance was given: moved by its own extent",)
                return [self._asked(b, self._retreat(scene, b, goals)) for b in bodies], said
            ways = [self._approach(scene, b, goals) for b in bodies]
            short = tuple(f"a wall ends its way {off:.2g} units before it" for _, off in ways if off > _SHORT)
            return [self._asked(b, way) for b, (way, _) in zip(bodies, ways, strict=True)], (*said, *short)
        assert self.direction is not None
        way = heading(context.viewer, scene.frame, self.direction)
        if self.distance is not None:
            step = self.distance.in_units(scene.frame)
        else:
            step = max(b.box.extent(way) for b in bodies)
            said = (f"no distance was given: moved by its own extent, {step:.3g} units",)
        return [self._asked(b, way * step) for b in bodies], said

    def _retreat(self, scene: Scene, body: Body, goals: list[Body]) -> Array:
        """Horizontal offset away from the nearest of the goals, by the given distance or its own extent."""
        way, _ = _level_way(scene, body, goals)
        step = body.box.extent(way) if self.distance is None else self.distance.in_units(scene.frame)
        return np.asarray(-way * step)

    def _approach(self, scene: Scene, body: Body, goals: list[Body]) -> tuple[Array, float]:
        """Horizontal offset toward the nearest of the goals, by the given distance or until 3 cm before it; and by how
        much less a wall lets it go, scene units."""
        up = scene.frame.up_vector
        way, nearest = _level_way(scene, body, goals)
        if self.distance is not None:
            return np.asarray(way * self.distance.in_units(scene.frame)), 0.0
        gap = 3 * centimetre(scene.frame, max(body.box.size))
        room = _free_way(body.box, goals[nearest].box, way, up, gap)
        if room <= 0:
            raise InstructionError("it already stands beside it: give a distance to move it anyway")
        clear = clear_length(scene, body, way * room)
        if _MOST_OF_IT * room < clear < room:
            return np.asarray(way * clear), room - clear
        return np.asarray(way * room), 0.0

    def _placed(
        self, scene: Scene, bodies: list[Body], context: Context, place: Placement
    ) -> tuple[list[Affine], tuple[str, ...]]:
        """The map that puts each body on a free spot of its own, and notes."""
        up = scene.frame.up_vector
        around = Surroundings(scene, context, mask_of_bodies(scene, bodies), frozenset(groups_of(bodies)))
        moved, notes = [], dict[str, None]()
        for body in bodies:
            around.rests = support_height(scene, body, context) is not None
            if place.relation == "above":
                matrix, spot = place_above(around, body, place)
            else:
                matrix, spot = np.eye(3), free_spot(around, body.box.size, body.box.axes, place, body.foot(up))
            offset = spot.foot - matrix @ body.foot(up)
            points = solid_points(scene.cloud, body.rows) @ matrix.T + offset
            around.add_obstacle(points, contact_box(points, scene.frame, spot.axes))
            moved.append(Affine(body.rows, matrix, offset, body.rows, spot.support))
            notes |= dict.fromkeys(spot.notes)
        return moved, tuple(notes)

    def _asked(self, body: Body, offset: Array) -> Affine:
        return Affine(body.rows, np.eye(3), np.asarray(offset, dtype=np.float64), body.rows)

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        after = outcome.scene
        checks = [moved_as_asked(before, after, outcome.moved), count_matches(before, after, outcome)]
        if self.distance is not None:
            checks.append(self._distance_kept(before, outcome))
        return *checks, *placed(outcome)

    def _distance_kept(self, before: Scene, outcome: Outcome) -> Check:
        """The mean of the centres moved by the given distance."""
        assert self.distance is not None
        asked, rows = self.distance.in_units(before.frame), torch.cat([body.rows for body in outcome.moved])
        was, now = (s.cloud.means[rows] for s in (before, outcome.scene))
        measured = float(torch.linalg.vector_norm((now - was).mean(dim=0, dtype=torch.float64)))
        if len(outcome.moved) > 1 and self.toward is not None:  # each thing moved in its own direction
            measured = float(torch.linalg.vector_norm(now - was, dim=1).mean(dtype=torch.float64))
        # float32 centres: rounding is a few millionths of the coordinates, which may be far larger than the step.
        bound = 1e-5 * max(1.0, asked, float(was.abs().max()))
        said = f"it moved {measured:.4g} of {asked:.4g} units"
        return at_most("distance", abs(measured - asked), bound, "units", said)


def _level_way(scene: Scene, body: Body, goals: list[Body]) -> tuple[Array, int]:
    """The horizontal way to the nearest of the goals, of length 1, and which one that is.

    Raises:
        InstructionError: it is where the goal is.
    """
    up = scene.frame.up_vector
    ways = [g.center - body.center for g in goals]
    ways = [w - up * (w @ up) for w in ways]
    nearest = int(np.argmin([np.linalg.norm(w) for w in ways]))
    length = float(np.linalg.norm(ways[nearest]))
    if length < 1e-9:
        raise InstructionError("it is already there: name a direction instead")
    return np.asarray(ways[nearest] / length), nearest


def _free_way(box: Box, goal: Box, way: Array, up: Array, gap: float) -> float:
    """How far a box moves over the floor until it is a gap before another one; 0 or less if it stands there.

    Of the sides of both boxes, the one behind which the other box comes last stops it (separating axes of two
    rectangles, Gottschalk et al. 1996, swept along the way).
    """
    far, between = -math.inf, np.subtract(goal.center, box.center)
    for side in np.asarray((*box.axes, *goal.axes)):
        if abs(float(side @ up)) > 0.5:
            continue
        speed = float(way @ side)
        apart = abs(float(between @ side)) - (box.extent(side) + goal.extent(side)) / 2 - gap
        if abs(speed) > 1e-9 and speed * float(between @ side) > 0:
            far = max(far, apart / abs(speed))
    return far if far > -math.inf else 0.0

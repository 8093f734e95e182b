"""The operation rotate: turn the target on the spot."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
import torch
from pydantic import ConfigDict, Field, model_validator
from torch import Tensor

from ...gaussians.language.field.measure import centroid, reach, solid_points
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Selection
from ...gaussians.rotations import axis_rotation
from ...gaussians.scene import Scene
from ..alternatives import NOT_GIVEN, either, given
from ..carried_objects import carried_note, rows_with_carried, with_carried
from ..checks import count_matches, moved_as_asked, overlap_notes, stays_put
from ..cloud_diff import Draft
from ..field_update import after_move
from ..operation import Affine, Context, Outcome, TargetedOp
from ..placement.bodies import Array, Body, bodies_of, groups_of, heading, strays_note, turn_to_face
from ..receipt import Check
from ..transform import turn


class Rotate(TargetedOp):
    """Turn the target about its own centre, by `degrees` or so that its front points `toward` something.

    Each of several things turns about its own centre. Degrees together with `toward` are turned beyond it: 180 turns
    its back to it. What stands on a thing that turns about "up" turns along.

    Positive degrees are counter-clockwise seen from the tip of the axis: about "up", seen from above. "right" and
    "forward" are the viewer's level axes (to tilt or topple); the thing stays at the height of its support.
    """

    model_config = ConfigDict(
        json_schema_extra=either(
            {"degrees": given(), "toward": NOT_GIVEN}, {"toward": given(), "axis": {"enum": ["up"]}}
        )
    )
    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "turn the chair 90 degrees clockwise",
        {"op": "rotate", "target": {"text": "chair"}, "degrees": -90},
    )
    takes_enclosed: ClassVar[bool] = True
    op: Literal["rotate"] = "rotate"
    degrees: Annotated[float, Field(ge=-3600, le=3600, allow_inf_nan=False)] | None = None
    axis: Literal["up", "right", "forward"] = "up"
    toward: Query | None = None
    """What to face; the nearest of several things."""

    @model_validator(mode="after")
    def _says_how_far(self) -> Self:
        if self.degrees is None and self.toward is None:
            raise ValueError("rotate needs degrees, or something to turn toward")
        if self.toward is not None and self.axis != "up":
            raise ValueError("a thing that turns toward something turns about up")
        return self

    def stronger(self, times: float) -> Self | None:
        if self.degrees is None or self.toward is not None:
            return None
        return self.model_copy(update={"degrees": min(max(self.degrees * times, -3600.0), 3600.0)})

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        return rows_with_carried(scene, selection) if self.axis == "up" else super().may_change(scene, selection)

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        axis = heading(context.viewer, scene.frame, self.axis)
        draft, moved, notes = Draft(scene.cloud), list[Affine](), dict[str, None]()
        bodies = bodies_of(scene, selection)
        bodies = with_carried(scene, bodies) if self.axis == "up" else bodies
        goals = [] if self.toward is None else bodies_of(scene, context.resolve(scene, self.toward).require())
        for body in bodies:
            degrees, said = self._degrees(scene, body, goals)
            notes |= dict.fromkeys(said)
            matrix = axis_rotation(axis, degrees)
            offset = self._offset(scene, body, matrix)
            turn(draft, body.rows, matrix, offset)
            moved.append(Affine(body.rows, matrix, offset, body.rows))
        cloud = draft.done()
        after = scene.replace(cloud=cloud, language=after_move(scene, cloud, moved))
        told = (*notes, *overlap_notes(after, groups_of(bodies)), *carried_note(scene, bodies), *strays_note(bodies))
        touched = scene.cloud.ids[torch.cat([body.rows for body in bodies])].sort().values
        return Outcome(after, touched=touched, moved=tuple(moved), notes=told)

    def _degrees(self, scene: Scene, body: Body, goals: list[Body]) -> tuple[float, tuple[str, ...]]:
        """The angle by which one body turns, and notes."""
        more = self.degrees or 0.0
        if not goals:
            return more, ()
        nearest = min(goals, key=lambda goal: float(np.linalg.norm(goal.center - body.center)))
        facing, notes = turn_to_face(scene, body, nearest.center)
        return facing + more, notes

    def _offset(self, scene: Scene, body: Body, matrix: Array) -> Array:
        """The offset that keeps the pivot in place, and the underside of a tilted thing at its old height.

        For a turn about up the pivot is the middle of the object's box. The box of Gaussians without an object is
        measured anew each time and its middle would drift, so there, and for tilts, the pivot is the mean of the
        centres.
        """
        upright = self.axis == "up" and body.group >= 0
        pivot = body.center if upright else centroid(scene.cloud, body.rows)
        offset = pivot - matrix @ pivot
        if self.axis == "up":
            return offset
        up, points = scene.frame.up_vector, solid_points(scene.cloud, body.rows)
        sunk = reach(points @ up)[0] - reach((points @ matrix.T + offset) @ up)[0]
        return np.asarray(offset + sunk * up)

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        after, moved = outcome.scene, outcome.moved
        return (
            moved_as_asked(before, after, moved),
            count_matches(before, after, outcome),
            stays_put(before, after, moved),
        )

"""rotate: turn the target on the spot."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from ...gaussians.language.selection import Selection
from ...gaussians.scene import Scene
from ..base import Affine, Context, Outcome, TargetedOp
from ..bookkeeping import carried
from ..checks import bumps, carried_as_asked, counted
from ..measure import centroid, reach, solid_points
from ..receipt import Check
from ..rows import Draft
from ..shape import axis_rotation, turn
from ..space import Array, Body, bodies_of, heading


class Rotate(TargetedOp):
    """Turn the target about its own centre; each of several things turns about its own.

    Positive degrees are counter-clockwise seen from the tip of the axis: about "up", seen from above. "right" and
    "forward" are the viewer's level axes (to tilt or topple); the thing stays at the height of its support.
    """

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "turn the chair 90 degrees clockwise",
        {"op": "rotate", "target": {"text": "chair"}, "degrees": -90},
    )
    op: Literal["rotate"] = "rotate"
    degrees: Annotated[float, Field(ge=-3600, le=3600, allow_inf_nan=False)]
    axis: Literal["up", "right", "forward"] = "up"

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        axis = heading(context.viewer, scene.frame, self.axis)
        matrix = axis_rotation(axis, self.degrees)
        draft, moved = Draft(scene.cloud), []
        bodies = bodies_of(scene, selection)
        for body in bodies:
            offset = self._offset(scene, body, matrix)
            turn(draft, body.rows, matrix, offset)
            moved.append(Affine(body.rows, matrix, offset, body.rows))
        cloud = draft.done()
        after = scene.replace(cloud=cloud, language=carried(scene, cloud, moved))
        notes = bumps(after, {b.group for b in bodies})
        return Outcome(after, touched=selection.ids, moved=tuple(moved), notes=notes)

    def _offset(self, scene: Scene, body: Body, matrix: Array) -> Array:
        """What keeps the pivot in place, and a tilted thing's underside at the height it had.

        About up the pivot is the middle of the object's box; a box without an object behind it is measured anew
        each time and would wander, so there, and for tilts, it is the mean of the centres.
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
        return carried_as_asked(before, outcome.scene, outcome.moved), counted(before, outcome.scene, outcome)

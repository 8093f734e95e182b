"""The operation arrange: move the target by exact distances along the axes and turn it, as a layout states them."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
import torch
from pydantic import ConfigDict, Field, model_validator
from torch import Tensor

from ...gaussians.errors import InstructionError
from ...gaussians.language.query.selection import Selection
from ...gaussians.rotations import axis_rotation
from ...gaussians.scene import Scene
from ..alternatives import either, nonzero
from ..carried_objects import carried_note, rows_with_carried, with_carried
from ..checks import count_matches, moved_as_asked, placed
from ..cloud_diff import Draft
from ..field_update import after_move
from ..operation import Affine, Context, Metres, Outcome, TargetedOp
from ..placement.bodies import Array, Body, bodies_of
from ..placement.surroundings import support_height
from ..receipt import Check
from ..transform import turn


class Arrange(TargetedOp):
    """Move the target by an exact way along the axes of the scene graph, and turn it about its own centre.

    `x`, `y` and `z` are metres to add to its position in the graph, `turn` degrees to add to its yaw (counter-clockwise
    seen from above). What stands on it goes along. It must be carried there, and stand in nothing else. Use it where
    positions are known as numbers; to say where in words, use move.
    """

    model_config = ConfigDict(
        json_schema_extra=either(
            {"x": nonzero(1000)}, {"y": nonzero(1000)}, {"z": nonzero(1000)}, {"turn": nonzero(360)}
        )
    )
    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "shift the armchair by 0.4 m along x and -1.2 m along y and turn it by 90 degrees",
        {"op": "arrange", "target": {"text": "armchair"}, "x": 0.4, "y": -1.2, "turn": 90},
    )
    op: Literal["arrange"] = "arrange"
    x: Metres = 0.0
    y: Metres = 0.0
    z: Metres = 0.0
    turn: Annotated[float, Field(ge=-360, le=360, allow_inf_nan=False)] = 0.0

    @model_validator(mode="after")
    def _goes_somewhere(self) -> Self:
        if not (self.x or self.y or self.z or self.turn):
            raise ValueError("arrange needs a way or a turn: x, y, z or turn")
        return self

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        return rows_with_carried(scene, selection)

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        bodies = with_carried(scene, bodies_of(scene, selection))
        matrix = axis_rotation(scene.frame.up_vector, self.turn)
        draft, offsets = Draft(scene.cloud), list[Array]()
        for body in bodies:
            offsets.append(body.center + self._way(scene) - matrix @ body.center)
            turn(draft, body.rows, matrix, offsets[-1])
        cloud = draft.done()
        asked = [Affine(b.rows, matrix, offset, b.rows) for b, offset in zip(bodies, offsets, strict=True)]
        after = scene.replace(cloud=cloud, language=after_move(scene, cloud, asked))
        moved = tuple(self._put_down(scene, after, b, o, matrix, context) for b, o in zip(bodies, offsets, strict=True))
        touched = cloud.ids[torch.cat([body.rows for body in bodies])].sort().values
        scale = () if scene.frame.metres_per_unit is not None else ("one scene unit was taken for a metre",)
        return Outcome(after, touched=touched, moved=moved, notes=(*scale, *carried_note(scene, bodies)))

    def _way(self, scene: Scene) -> Array:
        """`[3]` offset of a body's centre, world frame, scene units."""
        way = np.array([self.x, self.y, self.z]) / (scene.frame.metres_per_unit or 1.0)
        return np.asarray(way @ scene.frame.basis())

    def _put_down(
        self, before: Scene, after: Scene, body: Body, offset: Array, matrix: Array, context: Context
    ) -> Affine:
        """The map requested for a body, with the height of its new support. Raises InstructionError if the body had a
        support and has none at the new position."""
        now = support_height(after, body, context)
        if now is None and support_height(before, body, context) is not None:
            raise InstructionError(f"nothing there would carry the {body.label or 'thing'}: give another place")
        return Affine(body.rows, matrix, offset, body.rows, now)

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        after = outcome.scene
        return moved_as_asked(before, after, outcome.moved), count_matches(before, after, outcome), *placed(outcome)

"""The operation exchange: swap the positions of two things."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import numpy as np
import torch
from torch import Tensor

from ...gaussians.errors import InstructionError
from ...gaussians.language.field.measure import solid_points
from ...gaussians.language.query.selection import Selection
from ...gaussians.rotations import axis_rotation
from ...gaussians.scene import Scene
from ..carried_objects import carried_by, carried_note, rows_with_carried, with_carried
from ..checks import count_matches, moved_as_asked, placed
from ..cloud_diff import Draft
from ..field_update import after_move
from ..operation import Affine, Context, Outcome, TargetedOp
from ..placement.bodies import (
    Body,
    angle_between,
    bodies_of,
    contact_box,
    front_of,
    groups_of,
    mask_of_bodies,
    turned_axes,
)
from ..placement.place import spot_near
from ..placement.surroundings import Surroundings, support_height
from ..receipt import Check
from ..transform import turn


class Exchange(TargetedOp):
    """The two things that the target means change places; each stands where the other did, or as near as there is room.

    Where it can be told which way both face, each also faces as the other did. What stands on them goes along.
    """

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "swap the lamp and the vase",
        {"op": "exchange", "target": {"text": "lamp", "also": [{"text": "vase"}]}},
    )
    op: Literal["exchange"] = "exchange"

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        return rows_with_carried(scene, selection)

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        bodies = self._two(scene, selection)
        around = Surroundings(scene, context, mask_of_bodies(scene, bodies), frozenset(groups_of(bodies)))
        moved = [self._to(scene, around, one, other) for one, other in (bodies, bodies[::-1])]
        draft = Draft(scene.cloud)
        for asked in moved:
            turn(draft, asked.rows, asked.matrix, asked.offset)
        cloud = draft.done()
        after = scene.replace(cloud=cloud, language=after_move(scene, cloud, moved))
        crowded = any(asked.touches for asked in moved)
        notes = (*carried_note(scene, bodies), *(("there is little room: they touch what stands there",) * crowded))
        touched = cloud.ids[torch.cat([body.rows for body in bodies])].sort().values
        return Outcome(after, touched=touched, moved=tuple(moved), notes=notes)

    def _two(self, scene: Scene, selection: Selection) -> list[Body]:
        """The two bodies; raises InstructionError if they are not two, or one stands on the other."""
        bodies = bodies_of(scene, selection)
        if len(bodies) != 2:
            raise InstructionError(f"two things change places; {selection.query.describe()} means {len(bodies)}")
        carried = [set(carried_by(scene, [body.group])) for body in bodies]
        if bodies[0].group in carried[1] or bodies[1].group in carried[0]:
            raise InstructionError("a thing cannot change places with what stands on it: say where each should go")
        return with_carried(scene, bodies)

    def _to(self, scene: Scene, around: Surroundings, one: Body, other: Body) -> Affine:
        """The map that brings one thing to the other's place. Raises InstructionError if one stands and the other
        hangs, or there is no room."""
        up, hanging = scene.frame.up_vector, [support_height(scene, b, around.context) is None for b in (one, other)]
        if hanging[0] != hanging[1]:
            raise InstructionError("one of them stands and the other hangs: they cannot change places")
        matrix = axis_rotation(up, self._turn(scene, one, other))
        support: float | None = None
        touches = False
        if hanging[0]:
            foot = other.center - up * (one.box.size[2] / 2)
        else:
            spot = spot_near(around, one.box.size, turned_axes(one.box.axes, matrix, scene.frame), other)
            foot, support, touches = spot.foot, spot.support, spot.touches
        offset = foot - matrix @ one.foot(up)
        points = solid_points(scene.cloud, one.rows) @ matrix.T + offset
        around.add_obstacle(points, contact_box(points, scene.frame))
        return Affine(one.rows, matrix, np.asarray(offset), one.rows, support, touches)

    def _turn(self, scene: Scene, one: Body, other: Body) -> float:
        """Degrees by which a thing must turn to face as the other does; 0 where the front of either is unknown."""
        mine, yours = front_of(scene, one), front_of(scene, other)
        if mine is None or yours is None:
            return 0.0
        return angle_between(mine, yours, scene.frame.up_vector)

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        after = outcome.scene
        return moved_as_asked(before, after, outcome.moved), count_matches(before, after, outcome), *placed(outcome)

"""The operation tip: let the target tip over and lie on its side."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field
from torch import Tensor

from ...gaussians.errors import InstructionError
from ...gaussians.language.query.selection import Selection
from ...gaussians.motion.motion import Track, moving_ids, poses
from ...gaussians.scene import Scene
from ..carried_objects import rows_with_carried
from ..checks import count_matches
from ..operation import Context, Outcome, TargetedOp
from ..placement.bodies import heading
from ..receipt import Check, at_most
from ..timing.added import Start, with_movement

_TAKES = 0.8  # seconds, where nothing is said
_KEYS = 12
_FALLS = 2.0  # exponent of the angle over time: it begins slowly, as what tips over does


class Tip(TargetedOp):
    """Let the target tip over by 90 degrees about the edge of its foot, and stay lying there.

    `direction` is the viewer's. What stands on it goes along.
    """

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "the chair tips over to the left at 2 s",
        {"op": "tip", "target": {"text": "chair"}, "direction": "left", "when": {"start": 2}},
    )
    makes_motion: ClassVar[bool] = True
    op: Literal["tip"] = "tip"
    direction: Literal["left", "right", "forward", "backward"] = "right"
    degrees: Annotated[float, Field(gt=0, le=90, allow_inf_nan=False)] = 90.0

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        return rows_with_carried(scene, selection)

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        own = np.isin(moving_ids(scene.motion), selection.ids.cpu().numpy())
        if own.any():
            raise InstructionError(f"{self.target.describe()} moves already: say when it is to begin")
        return with_movement(scene, selection, self.when, context, lambda start: self._track(start, context))

    def _track(self, start: Start, context: Context) -> Track:
        begin, stop = start.span
        stop = stop if math.isfinite(stop) else begin + _TAKES
        frame, body = start.scene.frame, start.body
        up, way = frame.up_vector, heading(context.viewer, frame, self.direction)
        edge = body.foot(up) + way * body.box.extent(way) / 2
        share = np.linspace(0.0, 1.0, _KEYS + 1)
        angles = math.radians(self.degrees) * share**_FALLS
        return Track.hinge(start.ids, begin + (stop - begin) * share, angles, np.cross(up, way), edge, smooth=False)

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        motion = outcome.scene.motion
        assert motion is not None
        track = motion.tracks[-1]
        turns, _ = poses(track, track.times[-1:])
        leaning = math.degrees(math.acos(min(1.0, float(before.frame.up_vector @ turns[0] @ before.frame.up_vector))))
        off = abs(leaning - self.degrees)
        return count_matches(before, outcome.scene, outcome), at_most(
            "tipped over", off, 0.01, "degrees", f"it leans by {leaning:.3g} degrees"
        )

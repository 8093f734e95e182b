"""The operation sway: let the target hop, bob, shake, swing or wobble where it is, and come back to rest."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from torch import Tensor

from ...gaussians.language.query.selection import Selection
from ...gaussians.motion.motion import Track, poses
from ...gaussians.scene import Scene
from ..carried_objects import rows_with_carried
from ..checks import count_matches
from ..operation import Context, Length, Outcome, TargetedOp
from ..placement.bodies import heading
from ..receipt import Check, at_most
from ..timing.added import Start, with_movement

F64 = NDArray[np.float64]
How = Literal["hop", "bob", "shake", "swing", "wobble"]

_PERIOD: dict[How, float] = {"hop": 0.6, "bob": 1.0, "shake": 0.3, "swing": 1.5, "wobble": 0.8}  # seconds of one
_FAR: dict[How, float] = {"hop": 0.2, "bob": 0.1, "shake": 0.03}  # metres, where nothing is said
_TILT: dict[How, float] = {"swing": 20.0, "wobble": 6.0}  # degrees, likewise
_TIMES: dict[How, int] = {"hop": 1, "bob": 2, "shake": 4, "swing": 2, "wobble": 3}  # likewise
_KEYS = 8  # of one of them


class Sway(TargetedOp):
    """Let the target move to and fro where it is, and end where it was.

    "hop": up and down again by `distance`; "bob": likewise, up and down without touching down; "shake": to both
    sides; "swing": it swings like a pendulum that hangs from its top; "wobble": it tilts to both sides on its foot.
    `times` how often; without a number as often as there is time for in `when`. Distances are those to one side.
    """

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "let the vase hop twice at 2 s",
        {"op": "sway", "target": {"text": "vase"}, "how": "hop", "times": 2, "when": {"start": 2}},
    )
    makes_motion: ClassVar[bool] = True
    op: Literal["sway"] = "sway"
    how: How = "hop"
    times: Annotated[int, Field(ge=1, le=100)] | None = None
    distance: Length | None = None
    degrees: Annotated[float, Field(gt=0, le=90, allow_inf_nan=False)] | None = None

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        return rows_with_carried(scene, selection)

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        return with_movement(scene, selection, self.when, context, lambda start: self._track(start, context))

    def _track(self, start: Start, context: Context) -> Track:
        begin, stop = start.span
        period = _PERIOD[self.how]
        if math.isfinite(stop):
            count = self.times or max(round((stop - begin) / period), 1)
        else:
            count = self.times or _TIMES[self.how]
            stop = begin + count * period
        times = np.linspace(begin, stop, count * _KEYS + 1)
        phase = np.linspace(0.0, float(count), count * _KEYS + 1)
        frame, body = start.scene.frame, start.body
        up = frame.up_vector
        metre = 1.0 / (frame.metres_per_unit or 1.0)
        far = self.distance.in_units(frame) if self.distance is not None else _FAR.get(self.how, 0.0) * metre
        if self.how in ("hop", "bob"):
            up_and_down = (
                np.abs(np.sin(math.pi * phase)) if self.how == "hop" else (1 - np.cos(2 * math.pi * phase)) / 2
            )
            return Track.slide(start.ids, times, far * up_and_down, up, smooth=False)
        right = heading(context.viewer, frame, "right")
        if self.how == "shake":
            return Track.slide(start.ids, times, far * np.sin(2 * math.pi * phase), right, smooth=False)
        tilt = math.radians(self.degrees or _TILT[self.how])
        angles = tilt * np.sin(2 * math.pi * phase)
        foot = body.foot(up)
        pivot = foot if self.how == "wobble" else foot + up * body.box.extent(up)
        return Track.hinge(start.ids, times, angles, np.cross(up, right), pivot, smooth=False)

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        """It ends where it was."""
        motion, worst = outcome.scene.motion, 0.0
        assert motion is not None
        for track in motion.tracks[-1:]:
            turns, shifts = poses(track, track.times[-1:])
            worst = max(float(np.abs(turns - np.eye(3)).max()), float(np.abs(shifts).max()))
        said = f"it ends {worst:.2g} units from where it was"
        return count_matches(before, outcome.scene, outcome), at_most("comes to rest", worst, 1e-6, "units", said)

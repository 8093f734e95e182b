"""The operation follow: let the target go the way of another thing, at its distance or some time behind it."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import Field
from torch import Tensor

from ...gaussians.errors import InstructionError
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Selection
from ...gaussians.motion.motion import Track, chained, moving_ids
from ...gaussians.rows import rows_of_ids
from ...gaussians.scene import Scene
from ..carried_objects import rows_with_carried
from ..checks import count_matches
from ..operation import Context, Outcome, TargetedOp
from ..receipt import Check, at_most
from ..timing.added import Start, with_movement
from ..timing.retiming import divided, movement
from ..timing.spans import moving_one

F64 = NDArray[np.float64]
_STEP = 1 / 15  # seconds between the keys of its way
_CLEAR = 0.1  # metres between two things of which one follows the other, once it has caught up


class Follow(TargetedOp):
    """Let the target move as another thing does: the same steps over the floor at the same times.

    "along" keeps it where it is beside the other; "behind" first goes to where the other set out, and then its way, and
    has caught up with it at the end. `seconds` lets it start later than the other. It does not turn with it.
    """

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "let the toy car follow the robot",
        {"op": "follow", "target": {"text": "toy car"}, "leader": {"text": "robot"}},
    )
    makes_motion: ClassVar[bool] = True
    op: Literal["follow"] = "follow"
    leader: Query
    how: Literal["along", "behind"] = "behind"
    seconds: Annotated[float, Field(ge=0, le=3600, allow_inf_nan=False)] = 0.0

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        return rows_with_carried(scene, selection)

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        leader = moving_one(scene, self.leader, context).require()
        ids = np.intersect1d(leader.ids.cpu().numpy(), moving_ids(scene.motion))
        if scene.motion is None or not len(ids):
            raise InstructionError(f"{self.leader.describe()} does not move, so that nothing can follow it")
        if np.isin(selection.ids.cpu().numpy(), ids).any():
            raise InstructionError("a thing cannot follow itself")
        tracks, inside = divided(scene.motion, ids)
        own = [t for t, flag in zip(tracks, inside, strict=True) if flag]
        span = movement(own, scene.motion.start, scene.motion.stop)
        if span is None:
            raise InstructionError(f"{self.leader.describe()} does not move, so that nothing can follow it")
        times = np.append(np.arange(span[0], span[1], _STEP), span[1])
        rows = rows_of_ids(scene.cloud.ids, torch.from_numpy(ids))
        means = scene.cloud.means[rows].double().cpu().numpy()
        middle, up = means.mean(axis=0), scene.frame.up_vector
        turns, shifts = chained(own, times)
        way = turns @ middle + shifts
        level = way - ((way - way[0]) @ up)[:, None] * up  # what bobs is followed on the floor
        if float(np.linalg.norm(level[-1] - level[0])) < 1e-6 + 0.02 / (scene.frame.metres_per_unit or 1.0):
            raise InstructionError(f"{self.leader.describe()} stays in its place, so that nothing can follow it")
        apart = _reach(means, up) + _CLEAR / (scene.frame.metres_per_unit or 1.0)
        return with_movement(
            scene, selection, self.when, context, lambda start: self._track(start, times, level, up, apart)
        )

    def _track(self, start: Start, times: F64, way: F64, up: F64, apart: float) -> Track:
        first = max(start.span[0], float(times[0]) + self.seconds)
        if self.how == "along":
            late = first - float(times[0])
            kept = (times + late <= start.span[1]) if math.isfinite(start.span[1]) else np.ones(len(times), dtype=bool)
            return Track.along(start.ids, times[kept] + late, way[kept] - way[0] + start.body.center, smooth=False)
        return self._behind(start, times, way, up, first, apart)

    def _behind(self, start: Start, times: F64, way: F64, up: F64, first: float, apart: float) -> Track:
        """It sets out with the other, goes to where that set out and then its way, so much faster that it is close
        behind in the end; it never overtakes."""
        away = way[0] - start.body.center
        here = start.body.center + (away - up * (away @ up)) + way - way[0]  # the other's way on its own level
        path = np.concatenate([[start.body.center], here])
        along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
        gone = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(way, axis=0), axis=1))])  # of the other
        own = start.scene.cloud.means[start.body.rows].double().cpu().numpy()
        ahead = along[1]  # how far it is to where the other set out
        behind = min(ahead, apart + _reach(own, up))
        gone *= (ahead + gone[-1] - behind) / gone[-1]
        points = np.stack([np.interp(gone, along, path[:, i]) for i in range(3)], axis=1)
        return Track.along(start.ids, times + (first - float(times[0])), points, smooth=False)

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        still = len(moving_ids(outcome.scene.motion)) <= len(moving_ids(before.motion))
        return count_matches(before, outcome.scene, outcome), at_most(
            "moves", float(still), 0, "", "what follows does not move" if still else "it moves"
        )


def _reach(means: F64, up: F64) -> float:
    """How far most of a thing reaches from its middle over the floor, scene units."""
    off = means - means.mean(axis=0)
    return float(np.quantile(np.linalg.norm(off - (off @ up)[:, None] * up, axis=1), 0.95))

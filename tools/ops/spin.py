"""The operation spin: let the target turn about itself, for a time or without an end."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import Field, model_validator
from torch import Tensor

from ...gaussians.language.query.selection import Selection, mask_of
from ...gaussians.motion.at import at
from ...gaussians.motion.motion import Kind, Track, poses
from ...gaussians.rows import rows_of_ids
from ...gaussians.scene import Scene
from ..carried_objects import with_carried
from ..checks import count_matches
from ..operation import Context, Outcome, TargetedOp
from ..placement.bodies import bodies_of, heading
from ..receipt import Check, at_most
from ..timing.retiming import angles_at, divided, with_tracks
from ..timing.spans import SHORTEST, length_of, longer_notes, spans_of

F64 = NDArray[np.float64]

_LASTS = 5.0  # seconds for which something turns without an end in a scene that stood still before it, or has ended
_STEP = 1 / 30  # seconds between the keys of what a thing did before it is told to turn otherwise
_ONE = 1.0  # turns a second, where nothing is said


class Spin(TargetedOp):
    """Let the target turn about itself without an end, or by a number of turns.

    `turns_per_second` is positive counter-clockwise seen from the tip of `axis`. `turns` is how many in all; they fill
    the time that it lasts. What turns already keeps its axis and the time in which it turns; `other_way` turns it
    against its sense.
    """

    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "let the globe spin twice a second from 1 to 4 s",
        {"op": "spin", "target": {"text": "globe"}, "turns_per_second": 2, "when": {"start": 1, "stop": 4}},
    )
    makes_motion: ClassVar[bool] = True
    op: Literal["spin"] = "spin"
    turns_per_second: Annotated[float, Field(ge=-100, le=100, allow_inf_nan=False)] | None = None
    turns: Annotated[float, Field(ge=-1000, le=1000, allow_inf_nan=False)] | None = None
    other_way: bool = False
    axis: Literal["up", "right", "forward"] = "up"

    @model_validator(mode="after")
    def _turns(self) -> Self:
        if self.turns_per_second == 0 or self.turns == 0:
            raise ValueError("spin turns the target; to stop it, use pace with the change stop")
        return self

    def stronger(self, times: float) -> Self | None:
        rate = self.turns_per_second if self.turns_per_second is not None else _ONE
        return self.model_copy(update={"turns_per_second": min(max(rate * times, -100.0), 100.0)})

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        return mask_of(scene.cloud, selection.ids)

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        whole = length_of(scene)
        spans = spans_of(self.when, scene, selection, context, onward=True) if self.when is not None else []
        start, stop = spans[0] if spans else (-math.inf, math.inf)
        begin = start if math.isfinite(start) else whole.start
        now = at(scene, begin)
        motion = scene.motion
        tracks, inside = divided(motion, selection.ids.cpu().numpy()) if motion is not None else ([], [])
        touched, end = list[Tensor](), whole.stop
        for body in with_carried(now, bodies_of(now, selection)):
            ids = now.cloud.ids[body.rows]
            names = np.sort(ids.cpu().numpy())
            touched.append(ids)
            turning = [
                i
                for i, t in enumerate(tracks)
                if inside[i] and t.kind in ("spin", "hinge") and np.isin(t.ids, names).any()
            ]
            if turning:
                place, old = turning[0], tracks[turning[0]]
                tracks = [t for i, t in enumerate(tracks) if i not in turning]
                inside = [f for i, f in enumerate(inside) if i not in turning]
                made = self._again(old, begin, stop, bool(spans))
            else:  # it turns first, and then goes where its other tracks take it
                holding = [i for i, t in enumerate(tracks) if np.isin(t.ids, names).any()]
                place = holding[0] if holding else len(tracks)
                axis, pivot = heading(context.viewer, scene.frame, self.axis), np.asarray(body.center)
                for i in reversed(holding):
                    turns, shifts = poses(tracks[i], (begin,))
                    axis, pivot = turns[0].T @ axis, turns[0].T @ (pivot - shifts[0])
                made = self._new(names, axis, pivot, begin, stop)
            tracks.insert(place, made)
            inside.insert(place, True)
            lasts = _LASTS if not whole.known or begin >= whole.stop - SHORTEST else 0.0
            end = max(end, float(made.times[-1]) if made.kind == "hinge" else begin + lasts)
        after = with_tracks(scene, tracks, end)
        notes = longer_notes(whole, end, anyway=True)
        return Outcome(after, touched=torch.cat(touched).sort().values, notes=notes)

    def _rate(self, lasting: float) -> float:
        """Turns a second."""
        sense = -1.0 if self.other_way else 1.0
        if self.turns is not None and math.isfinite(lasting):
            return sense * self.turns / lasting
        if self.turns_per_second is not None:
            return (
                sense
                * abs(self.turns_per_second)
                * (math.copysign(1.0, self.turns) if self.turns else math.copysign(1.0, self.turns_per_second))
            )
        return sense * math.copysign(_ONE, self.turns if self.turns is not None else 1.0)

    def _new(self, ids: NDArray[np.int64], axis: F64, pivot: F64, begin: float, stop: float) -> Track:
        rate = self._rate(stop - begin)
        if self.turns is not None and not math.isfinite(stop):
            stop = begin + abs(self.turns / rate)
        if math.isinf(stop):
            return Track.spin(ids, rate, axis, pivot, begin)
        angle = 2 * math.pi * rate * (stop - begin)
        return Track.hinge(ids, (begin, stop), (0.0, angle), axis, pivot, smooth=self.turns is not None)

    def _again(self, old: Track, begin: float, stop: float, timed: bool) -> Track:
        """A track that turns already, at another rate, or the other way."""
        assert old.axis is not None and old.angles is not None and old.pivot is not None
        lasting, turned = np.diff(old.times), np.diff(old.angles)
        span = max(float(lasting[turned != 0].sum()), 1e-9)  # it may rest before and after
        rate = float(turned.sum()) / (2 * math.pi * span)
        if self.turns is None and self.turns_per_second is None and not self.other_way and turned.any():
            return self._as_it_does(old, rate, begin, stop, timed)
        if timed:
            return self._meanwhile(old, begin, stop)
        wanted = (
            rate
            if self.turns_per_second is None
            else math.copysign(self.turns_per_second, self.turns_per_second * (rate or 1.0))
        )
        if self.turns is not None:
            wanted = math.copysign(self.turns / span, rate)
        factor = (-1.0 if self.other_way else 1.0) * wanted / (rate or 1.0)
        return replace(old, angles=old.angles * factor)

    def _as_it_does(self, old: Track, rate: float, begin: float, stop: float, timed: bool) -> Track:
        """What turns already, at its own rate: only from `begin` to `stop`, or without an end."""
        assert old.axis is not None and old.angles is not None
        if not timed:
            last = int(np.flatnonzero(np.diff(old.angles))[-1]) + 2  # what rests in the end goes on
            return replace(old, kind="spin", times=old.times[:last], angles=old.angles[:last], smooth=False)
        if math.isinf(stop):
            return Track.spin(old.ids, rate, old.axis, old.pivot, begin, name=old.name)
        angle = 2 * math.pi * rate * (stop - begin)
        return Track.hinge(old.ids, (begin, stop), (0.0, angle), old.axis, old.pivot, smooth=False, name=old.name)

    def _meanwhile(self, old: Track, begin: float, stop: float) -> Track:
        """What turns already, at another rate from `begin` to `stop`, and before and after that as ever."""
        new = self._new(old.ids, old.axis, old.pivot, begin, stop)  # type: ignore[arg-type]
        assert new.angles is not None
        rate = float(new.angles[-1] - new.angles[0]) / float(new.times[-1] - new.times[0])
        until = float(new.times[-1]) if math.isinf(stop) and new.kind == "spin" else min(stop, float(new.times[-1]))
        before = np.array([*np.arange(float(old.times[0]), begin, _STEP)])
        before = before[before < begin - _STEP / 2]
        after = np.zeros(0)
        if math.isfinite(stop):
            after = np.array([t for t in old.times if t > until + _STEP / 2] or [until + 1.0])
        first, ends = angles_at(old, np.array([begin, until]))
        turned = rate * (until - begin)
        angles = [*angles_at(old, before), first, first + turned, *(angles_at(old, after) - ends + first + turned)]
        kind: Kind = "spin" if math.isinf(stop) or old.kind == "spin" else "hinge"
        times = np.array([*before, begin, until, *after])
        return replace(old, kind=kind, times=times, angles=np.array(angles), smooth=False)

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        after, motion = outcome.scene, outcome.scene.motion
        assert motion is not None
        return count_matches(before, after, outcome), self._kept_apart(after, outcome.touched)

    def _kept_apart(self, after: Scene, ids: Tensor) -> Check:
        """What turns keeps its distance from its axis through a whole turn."""
        motion = after.motion
        assert motion is not None
        worst = 0.0
        for track in motion.tracks:
            if track.axis is None or not np.isin(track.ids, ids.cpu().numpy()).all():
                continue
            rows = rows_of_ids(after.cloud.ids, torch.from_numpy(track.ids))[:2000]
            points = after.cloud.means[rows].double().cpu().numpy() - track.pivot
            turns, shifts = poses(track, (motion.start, (motion.start + motion.stop) / 2))
            moved = (points + track.pivot) @ turns[1].T + shifts[1] - track.pivot
            far = [np.linalg.norm(np.cross(p, track.axis), axis=1) for p in (points, moved)]
            worst = max(worst, float(np.abs(far[0] - far[1]).max(initial=0.0)))
        return at_most("turns about its axis", worst, 1e-6, "units", f"it strays {worst:.2g} units from its circle")

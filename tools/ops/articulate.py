"""The operation articulate: open or close what swings on a hinge or slides."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import ConfigDict, Field
from torch import Tensor

from ...gaussians.errors import InstructionError
from ...gaussians.language.query.selection import Selection, mask_of
from ...gaussians.motion.at import at
from ...gaussians.motion.motion import Motion, Track, carried, poses
from ...gaussians.rotations import axis_rotation
from ...gaussians.scene import Scene
from ..alternatives import NOT_GIVEN, either
from ..checks import count_matches, moved_as_asked
from ..cloud_diff import Draft
from ..field_update import after_move
from ..operation import Affine, Context, Length, Outcome, TargetedOp
from ..placement.bodies import Body, bodies_of
from ..receipt import Check, at_most
from ..timing.hinges import Opening, opening_of
from ..timing.retiming import angles_at, moved, movement, playing, with_tracks
from ..timing.spans import length_of, longer_notes, spans_of
from ..transform import turn
from ..when import When

F64 = NDArray[np.float64]

_TAKES = 1.5  # seconds, where nobody says how long
_LEAST = 0.1  # seconds
_SAME = 1e-6
_NONE = np.zeros(0)
_GRID = 100  # times a second at which it is looked whether something moves
_OPEN = 0.02  # of the way: what is as near to open is open


class Articulate(TargetedOp):
    """Open or close a door, a drawer or a lid: a share of the way, to an angle, or a drawer by a distance.

    Without `when` it is open or closed; what opens by itself in the scene does so as far as was said. With `when` it
    moves from how it is then. How it opens is found from its shape, its handle and what it touches.
    """

    model_config = ConfigDict(
        json_schema_extra=either(
            {"degrees": NOT_GIVEN, "distance": NOT_GIVEN}, {"share": NOT_GIVEN, "distance": NOT_GIVEN},
            {"share": NOT_GIVEN, "degrees": NOT_GIVEN},
        )
    )  # fmt: skip
    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "open the door halfway from 1 to 2 s",
        {"op": "articulate", "target": {"text": "door"}, "share": 0.5, "when": {"start": 1, "stop": 2}},
    )
    makes_motion: ClassVar[bool] = True
    op: Literal["articulate"] = "articulate"
    change: Literal["open", "close"] = "open"
    share: Annotated[float, Field(gt=0, le=1, allow_inf_nan=False)] | None = None
    degrees: Annotated[float, Field(gt=0, le=180, allow_inf_nan=False)] | None = None
    distance: Length | None = None

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        return mask_of(scene.cloud, selection.ids)

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        after, moved, notes = scene, list[Affine](), list[str]()
        touched: list[Tensor] = []
        for body in bodies_of(scene, selection):
            ids = scene.cloud.ids[body.rows]
            touched.append(ids)
            own = self._own_track(after, ids.cpu().numpy())
            if own is not None:
                after, told = self._moving(after, own, selection, context)
            elif self.when is not None:
                after, told = self._from_rest(after, body, ids, selection, context)
            else:
                after, body_map, told = self._at_once(after, body)
                moved.append(body_map)
            notes += [t for t in told if t]
        return Outcome(after, touched=torch.cat(touched).sort().values, moved=tuple(moved), notes=tuple(notes))

    def _own_track(self, scene: Scene, ids: NDArray[np.int64]) -> Track | None:
        """The track on which most of a body opens by itself."""
        for track in scene.motion.tracks if scene.motion is not None else ():
            opens = track.kind in ("hinge", "slide") and not track.still
            if opens and 2 * int(np.isin(ids, track.ids).sum()) > len(ids):
                return track
        return None

    def begins_shut(self, scene: Scene, selection: Selection) -> bool:
        """Whether the one thing that is meant opens by itself, and from its shape is shut at the start of its scene."""
        bodies = bodies_of(scene, selection)
        own = self._own_track(scene, scene.cloud.ids[bodies[0].rows].cpu().numpy()) if len(bodies) == 1 else None
        if own is None or own.axis is None:
            return False
        try:
            found = self._opening(scene, bodies[0])
        except InstructionError:
            return False
        return float(found.axis @ own.axis) * _widest(own) > 0

    def _goal(self, most: float, slides: bool, scene: Scene) -> float:
        """Radians or scene units at which it shall be; `most` is wide open, with its sign."""
        if self.degrees is not None or self.distance is not None:
            if slides != (self.distance is not None):
                raise InstructionError("a drawer slides by a distance, and a door or lid turns by degrees")
            said = self.distance.in_units(scene.frame) if self.distance is not None else math.radians(self.degrees or 0)
            return math.copysign(said, most)
        share = 1.0 if self.share is None else self.share  # closed by a share of the way, or wholly
        return most * (1 - share if self.change == "close" else share)

    def _moving(
        self, scene: Scene, own: Track, selection: Selection, context: Context
    ) -> tuple[Scene, tuple[str, ...]]:
        """What opens by itself: as far as was said, or from a time on otherwise."""
        assert scene.motion is not None
        whole = length_of(scene)
        if self.when is None:
            made, told = self._at_all_times(scene, own)
            end = whole.stop
        else:
            made, told, end = self._timed(scene, own, selection, context)
        stop = max(whole.stop, end)
        tracks = [made if t is own else t for t in scene.motion.tracks]
        return with_tracks(scene, tracks, stop), (told, *longer_notes(whole, stop))

    def _at_all_times(self, scene: Scene, own: Track) -> tuple[Track, str]:
        """The track of what opens by itself, and a note: it opens as far as was said, or does not move any more."""
        assert scene.motion is not None and own.angles is not None
        slides, most = own.kind == "slide", _widest(own)
        goal = self._goal(most, slides, scene)
        asked = self.share is not None or self.degrees is not None or self.distance is not None
        if asked and self.change == "open":
            told = f"it opens by itself, now by {_told(goal, slides, scene)}"
            return replace(own, angles=own.angles * (goal / most)), told
        return replace(own, times=np.array([scene.motion.start]), angles=np.array([goal])), "it does not move any more"

    def _timed(self, scene: Scene, own: Track, selection: Selection, context: Context) -> tuple[Track, str, float]:
        """The track of what opens by itself that moves otherwise from a time on, a note, and when that ends.

        Raises:
            InstructionError: it is shut then, or as far open as it is to be.
        """
        assert scene.motion is not None and self.when is not None
        motion, slides, most = scene.motion, own.kind == "slide", _widest(own)
        start, end = self._from_to(scene, own, selection, context)
        now = float(angles_at(own, np.array([start]))[0])
        goal = self._goal(most, slides, scene)
        if not self._has_end and self.change == "open" and self.when.start is not None and _near(goal, now, most):
            made, end = _opening_at(own, motion, most, start)
            return made, f"it opens by itself, now from {start:.3g} s", end
        shuts = self.change == "close" and _near(goal, 0.0, most) and not self._has_end
        if shuts and (later := _closing_at(own, motion, start)) is not None:
            return later[0], f"it closes by itself, now from {start:.3g} s", later[1]
        self._require_movable(now, goal, most, start)
        if not self._has_end:  # as fast as it opens by itself
            end = start + max(_taken(own) * abs(goal - now) / abs(most), _LEAST)
        before = [t for t in own.times if t < start - _SAME]
        dense = np.unique(np.round([*before, *np.arange(before[-1], start, 1 / 30)], 9)) if before else _NONE
        dense = dense[dense < start - _SAME]
        made = replace(own, times=np.array([*dense, start, end]), angles=np.array([*angles_at(own, dense), now, goal]))
        told = f"{start:.3g} to {end:.3g} s: from {_told(now, slides, scene)} to {_told(goal, slides, scene)}"
        return made, told, end

    def _from_to(self, scene: Scene, own: Track, selection: Selection, context: Context) -> tuple[float, float]:
        """From when to when what opens by itself is to move, seconds."""
        assert scene.motion is not None
        first = scene.motion.start
        start, end = self._time(spans_of(self.when, scene, selection, context, onward=True)[0], first, context)
        if self.change == "close" and self.when is not None and self.when == When(stop=self.when.stop):
            return max(end - _taken(own), first), end  # as fast as it opens, and shut then
        span = movement([own], first, scene.motion.stop) if self._only_lasts else None
        if span is None:
            return start, end
        if self.change == "open":  # it opens by itself, and this is how long it takes
            return span[0], span[0] + end - start
        now, last = angles_at(own, np.array([start, span[1]]))
        late = span[1] if _near(now, 0.0, _widest(own)) and not _near(last, 0.0, _widest(own)) else start
        return late, late + end - start  # what is shut closes when it has opened

    def _require_movable(self, now: float, goal: float, most: float, start: float) -> None:
        """Refuse to open or close what opens by itself from a time at which it cannot be.

        Args:
            now, goal: how far it is open then, and is to be; radians or scene units.
            most: of wide open.
            start: seconds.

        Raises:
            InstructionError: it is shut then, or as far open as it is to be.
        """
        name = self.target.describe()
        if self.change == "close" and abs(now) - abs(goal) < _OPEN * abs(most):
            how = "shut" if _near(now, 0.0, most) else "no further open"
            raise InstructionError(f"{name} is {how} at {start:.3g} s: say a time at which it is open")
        if self.change == "open" and _near(goal, now, most):
            how = "open" if _near(now, most, most) else "as far open"
            raise InstructionError(f"{name} is {how} already at {start:.3g} s: say an earlier time, or close it first")

    @property
    def _has_end(self) -> bool:
        """Whether is said when it is done, or how long it takes."""
        when = self.when
        return when is not None and not (when.stop is None and when.lasting is None and when.until is None)

    @property
    def _only_lasts(self) -> bool:
        """Whether only is said how long it takes."""
        when = self.when
        return when is not None and when.lasting is not None and when == When(lasting=when.lasting)

    def _time(self, span: tuple[float, float], first: float, context: Context) -> tuple[float, float]:
        start = span[0] if math.isfinite(span[0]) else (first if context.time is None else context.time)
        return start, span[1] if math.isfinite(span[1]) else start + _TAKES

    def _from_rest(
        self, scene: Scene, body: Body, ids: Tensor, selection: Selection, context: Context
    ) -> tuple[Scene, tuple[str, ...]]:
        """What does not open by itself yet: from closed, or for "close" from how it is told to be open."""
        assert self.when is not None
        whole = length_of(scene)
        start, end = self._time(spans_of(self.when, scene, selection, context, onward=True)[0], whole.start, context)
        then = at(scene, start)  # other rows, if something is hidden then
        there = [b for b in bodies_of(then, selection) if bool(torch.isin(then.cloud.ids[b.rows], ids).any())]
        if not there:
            raise InstructionError(f"{self.target.describe()} is not there at {start:.3g} s")
        found = self._opening(then, there[0])
        if self.change == "close":
            raise InstructionError(f"nothing tells how far {self.target.describe()} is open: open it first")
        goal = self._goal(found.most, found.how == "drawer", scene)
        names = ids.cpu().numpy()
        if found.how == "drawer":
            made = Track.slide(names, (start, end), (0.0, goal), found.axis)
        else:
            made = Track.hinge(names, (start, end), (0.0, goal), found.axis, found.pivot)
        tracks = [*(scene.motion.tracks if scene.motion is not None else ()), made]
        return with_tracks(scene, tracks, max(whole.stop, end)), (found.told, *longer_notes(whole, end))

    def _opening(self, scene: Scene, body: Body) -> Opening:
        return opening_of(scene, body, self.target.text or body.label)

    def _at_once(self, scene: Scene, body: Body) -> tuple[Scene, Affine, tuple[str, ...]]:
        """The scene with it open."""
        if self.change == "close":
            raise InstructionError(f"nothing tells how far {self.target.describe()} is open: undo what opened it")
        found = self._opening(scene, body)
        goal = self._goal(found.most, found.how == "drawer", scene)
        if found.how == "drawer":
            matrix, offset = np.eye(3), goal * found.axis
        else:
            matrix = axis_rotation(found.axis, math.degrees(goal))
            offset = found.pivot - matrix @ found.pivot
        draft = Draft(scene.cloud)
        turn(draft, body.rows, matrix, offset)
        cloud = draft.done()
        made = Affine(body.rows, matrix, offset, body.rows)
        after = scene.replace(cloud=cloud, language=after_move(scene, cloud, (made,)))
        ids = scene.cloud.ids[body.rows].cpu().numpy()
        return after.replace(motion=carried(scene.motion, ids, matrix, offset)), made, (found.told,)

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        counted = count_matches(before, outcome.scene, outcome)
        if outcome.moved:
            return counted, moved_as_asked(before, outcome.scene, outcome.moved)
        return counted, self._on_its_axis(outcome)

    def _on_its_axis(self, outcome: Outcome) -> Check:
        """The hinge stays where it is at every key."""
        motion, worst = outcome.scene.motion, 0.0
        for track in motion.tracks if motion is not None else ():
            if (
                track.kind == "hinge"
                and track.axis is not None
                and np.isin(track.ids, outcome.touched.cpu().numpy()).all()
            ):
                turns, shifts = poses(track, track.times)
                for along in (0.0, 1.0):
                    point = track.pivot + along * track.axis
                    worst = max(worst, float(np.abs(turns @ point + shifts - point).max(initial=0.0)))
        return at_most("hinge stays", worst, 1e-6, "units", f"its hinge moves by {worst:.2g} units")


def _opening_at(own: Track, motion: Motion, most: float, start: float) -> tuple[Track, float]:
    """A track that opens by itself, with its opening at another time; what it does behind that keeps its time if it
    can. And when it ends.

    Args:
        most: angle or distance of wide open.
        start: seconds.
    """
    times = _grid(motion, own)
    share = angles_at(own, times) / most
    moves = np.flatnonzero(np.abs(np.diff(share)) > _SAME)
    low, high = float(times[moves[0]]), float(times[int(np.argmax(share > 1 - _OPEN / 2))])
    end = start + high - low
    again = moves[(times[moves] > high) & (share[moves] > 1 - _OPEN / 2)]
    behind = float(times[again[-1]]) if len(again) else math.inf
    last = float(times[moves[-1] + 1])
    made = playing(own, moved((low, high), (start, end), -math.inf, behind))
    return made, last if end < behind < math.inf else last + end - high


def _closing_at(own: Track, motion: Motion, start: float) -> tuple[Track, float] | None:
    """A track that closes by itself before a time, with its closing then, and when it ends. It stays open until then.

    None if it does not close wholly, or opens again before.
    """
    times = _grid(motion, own)
    angles = np.abs(angles_at(own, times))
    steps = np.diff(angles) / max(float(angles.max()), 1e-12)
    closes = steps < -_SAME
    begins = np.flatnonzero(closes & ~np.r_[False, closes[:-1]] & (times[:-1] < start))
    if not len(begins):
        return None
    first = int(begins[-1])
    last = first + int(np.flatnonzero(~np.r_[closes[first:], False])[0])
    again = last + np.flatnonzero(np.abs(steps[last:]) > _SAME)
    behind = float(times[again[0]]) if len(again) else math.inf
    if angles[last] > _OPEN / 2 * angles.max() or behind < start:
        return None
    low, high = float(times[first]), float(times[last])
    end = start + high - low
    return playing(own, moved((low, high), (start, end), -math.inf, behind)), end


def _grid(motion: Motion, own: Track) -> F64:
    """Times at which it is looked whether something moves, to its last key if the scene ends before."""
    stop = max(motion.stop, float(own.times[-1]))
    return np.linspace(motion.start, stop, max(round((stop - motion.start) * _GRID), 2))


def _near(angle: float, other: float, most: float) -> bool:
    """Whether two angles, or distances, are the same but for a trifle of wide open."""
    return abs(angle - other) < _OPEN * abs(most)


def _widest(own: Track) -> float:
    """The angle, or distance, at which a track is the farthest from its start, with its sign."""
    assert own.angles is not None
    return float(own.angles[int(np.argmax(np.abs(own.angles)))])


def _taken(own: Track) -> float:
    """Seconds that a track takes from closed to as wide as it opens."""
    assert own.angles is not None
    widest = int(np.argmax(np.abs(own.angles)))
    closed = np.flatnonzero(np.abs(own.angles[:widest]) < _SAME)
    return float(own.times[widest] - own.times[closed[-1] if len(closed) else 0])


def _told(amount: float, slides: bool, scene: Scene) -> str:
    if slides:
        return f"{abs(amount) * (scene.frame.metres_per_unit or 1.0) * 100:.3g} cm"
    return f"{abs(math.degrees(amount)):.3g} degrees"

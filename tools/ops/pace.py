"""The operation pace: when, how fast and in which direction of time the target moves."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import ConfigDict, Field, model_validator
from torch import Tensor

from ...gaussians.errors import InstructionError
from ...gaussians.language.query.query import ALL
from ...gaussians.language.query.selection import Selection, mask_of
from ...gaussians.motion.motion import Motion, Track, chained, moving_ids, poses
from ...gaussians.rows import rows_of_ids
from ...gaussians.scene import Scene
from ..alternatives import NOT_GIVEN, either, given
from ..checks import count_matches
from ..operation import Context, Length, Outcome, TargetedOp
from ..placement.bodies import rows_by_thing
from ..receipt import Check, at_most
from ..timing.bending import bent, upright_turns
from ..timing.retiming import Warp, divided, moved, movement, parted, playing, shown, waving, with_tracks
from ..timing.spans import Span, spans_of
from ..when import During, When
from .articulate import Articulate

I64 = NDArray[np.int64]
F64 = NDArray[np.float64]

_TURNS = 2.1 * math.pi  # radians from which a turn is one of many, whose speed is not how soon it ends
_NO_TIME = 1e-3  # seconds
_ON_THE_SPOT = 0.05  # metres: what goes less far takes no turn on its way
_BESIDE = 0.02  # seconds between two movements that are not one
_MOVEMENTS = ("opening", "closing", "falling", "turning")  # of which a thing may have several
_WHILE_MOVING = When(during=During(state="moving"))
_NO_TURN = 0.1  # radians
_STRAIGHT = 0.05  # of its way: what strays less to its sides goes straight on


_PLAYED = ("stop", "begin", "speed", "later", "reverse", "return", "repeat", "back_and_forth")  # which looks follow
_HOW_MUCH = ("factor", "seconds", "share", "distance", "times", "degrees")


def _but(field: str) -> dict[str, Any]:
    """The fields that say how much, but one, as fields that are not given."""
    return {name: NOT_GIVEN for name in _HOW_MUCH if name != field}


class Pace(TargetedOp):
    """Change when and how fast the target moves, of what moves already.

    "stop": it stands still in the time of `when`, and goes on behind it; without `when` at all times. "begin": its
    movement begins at `when`, and takes as long as that lasts. While it opens, closes, falls or turns: that movement
    alone. "speed": `factor` times as fast. "later": by `seconds`,
    negative is earlier. "reverse": played backwards in its own time; one that is then the same, in that of the scene.
    "return": it goes back the way it came. "go_on": it keeps its last speed until the end of `when`. "part": it goes
    only a `share` of its way, or a `distance`, and stands still there. "repeat": it does the same again and again,
    "back_and_forth": there and back, `times` times or until the end of the scene. "mirror": it turns right where it
    turned left. "turn": on its way it turns by `degrees` in all, to the side to which it does, and goes on from there.
    Everything is the whole scene, with its looks, which then gets longer or shorter.
    """

    model_config = ConfigDict(
        json_schema_extra=either(
            {"change": {"enum": ["speed"]}, "factor": given(), **_but("factor")},
            {"change": {"enum": ["later"]}, "seconds": given(), **_but("seconds")},
            {"change": {"enum": ["part"]}, "share": given(), **_but("share")},
            {"change": {"enum": ["part"]}, "distance": given(), **_but("distance")},
            {"change": {"enum": ["repeat", "back_and_forth"]}, **_but("times")},
            {"change": {"enum": ["turn"]}, "degrees": given(), **_but("degrees")},
            {"change": {"enum": ["stop", "begin", "reverse", "return", "go_on", "mirror"]}, **_but("")},
        )
    )
    example: ClassVar[tuple[str, dict[str, Any]]] = (
        "stop the fan after two seconds",
        {"op": "pace", "target": {"text": "fan"}, "change": "stop", "when": {"start": 2}},
    )
    makes_motion: ClassVar[bool] = True
    of_what_moves: ClassVar[bool] = True
    op: Literal["pace"] = "pace"
    change: Literal[
        "stop",
        "begin",
        "speed",
        "later",
        "reverse",
        "return",
        "go_on",
        "part",
        "repeat",
        "back_and_forth",
        "mirror",
        "turn",
    ]
    factor: Annotated[float, Field(gt=0, le=1000, allow_inf_nan=False)] | None = None
    seconds: Annotated[float, Field(ge=-3600, le=3600, allow_inf_nan=False)] | None = None
    share: Annotated[float, Field(gt=0, lt=1, allow_inf_nan=False)] | None = None
    distance: Length | None = None
    times: Annotated[int, Field(ge=1, le=100)] | None = None
    degrees: Annotated[float, Field(gt=0, le=360, allow_inf_nan=False)] | None = None

    @model_validator(mode="after")
    def _says_how_much(self) -> Self:
        if (self.change == "part") != ((self.share is None) != (self.distance is None)):
            raise ValueError("part needs either a share or a distance, and nothing else has one")
        if self.times is not None and self.change not in ("repeat", "back_and_forth"):
            raise ValueError("times goes with repeat and back_and_forth")
        for name, change in (("factor", "speed"), ("seconds", "later"), ("degrees", "turn")):
            if (getattr(self, name) is not None) != (self.change == change):
                raise ValueError(f"{name} goes with {change}, and {change} needs it")
        return self

    def stronger(self, times: float) -> Self | None:
        if self.factor is not None:
            return self.model_copy(update={"factor": min(max(self.factor**times, 1e-3), 1000.0)})
        return None if self.seconds is None else self.model_copy(update={"seconds": self.seconds * times})

    def may_change(self, scene: Scene, selection: Selection) -> Tensor:
        """All of the moving things that the target is: their place at the start may be another; of everything, also
        what looks otherwise for a while."""
        ids = self._ids(scene, selection)
        return mask_of(scene.cloud, torch.from_numpy(self._with_looks(scene.motion, ids)))

    def _ids(self, scene: Scene, selection: Selection) -> I64:
        moving = moving_ids(scene.motion)
        return moving if self._whole else moving[np.isin(moving, selection.ids.cpu().numpy())]

    @property
    def _whole(self) -> bool:
        return self.target.text in ALL and not self.target.exclude and self.target.region is None

    def _with_looks(self, motion: Motion | None, ids: I64) -> I64:
        """Ids, and if the whole scene is played otherwise those of its looks, too; ascending."""
        looks = motion.looks if motion is not None and self._plays_looks(motion) else ()
        return np.unique(np.concatenate([ids, *(look.ids for look in looks)]))

    def apply(self, scene: Scene, selection: Selection, context: Context) -> Outcome:
        motion, ids = scene.motion, self._ids(scene, selection)
        every = self._with_looks(motion, ids)
        if motion is None or not len(every):
            raise InstructionError(
                f"{self.target.describe()} does not move: say what it is to do, as 'move it to the sofa in 3 seconds'"
            )
        if (closing := self._closing(scene, selection, context)) is not None:
            return closing.apply(scene, selection, context)
        waves, residuals = parted(motion.residuals, ids)
        if waves and self.change in ("part", "mirror", "turn", "go_on"):
            raise InstructionError(
                f"some of {self.target.describe()} changes its shape, which has no way or turn that could be another "
                "one: say when it is to move, or how fast"
            )
        when = When(during=self.when.during) if self.when is not None and self._of_one_movement else self.when
        onward = self.change in ("begin", "return", "repeat")
        spans = spans_of(when, scene, selection, context, onward) if when is not None else []
        movements = spans_of(_WHILE_MOVING, scene, selection, context) if self._of_one_movement else []
        tracks, inside = divided(motion, ids)
        stop = motion.stop
        made, paced, played = list(tracks), False, None
        for group in _things(scene, selection, ids, self._whole):
            held = [i for i, t in enumerate(tracks) if inside[i] and np.isin(t.ids, group).any()]
            own = [tracks[i] for i in held]
            shapes, waves = parted(waves, group)
            span = movement(own, motion.start, motion.stop, shapes)
            if self._plays_looks(motion):
                if span is None or self.times is not None:  # the film, of which nothing may move
                    span = (motion.start, motion.stop)
                played, end = self._played(scene, own, group, span, spans)
                stop = max(stop, end)
            if span is None:
                residuals += shapes
                continue
            paced = True
            if (
                self.change in ("speed", "reverse", "go_on")
                and (turning := [is_turning(t) for t in own])
                and all(turning)
                and not shapes
            ):
                for i in held:
                    made[i], end = self._turned(tracks[i], motion, spans)
                    stop = max(stop, end)
                continue
            if self.change == "mirror":
                for i, track in zip(held, self._mirrored(scene, own, group, span), strict=True):
                    made[i] = track
                continue
            if self.degrees is not None:
                for i, track in zip(held, self._bent(scene, own, group, span), strict=True):
                    made[i] = track
                continue
            if self._of_one_movement:
                warp, end = self._in_movement(spans[0], movements, span)
            else:
                warp, end = self._played(scene, own, group, span, spans)
            for i in held:
                made[i] = playing(tracks[i], warp)
            residuals += [waving(shape, warp) for shape in shapes]
            stop = end if self._whole else max(stop, end)
        if not paced:
            raise InstructionError(f"{self.target.describe()} hardly moves: say what it is to do")
        if played is not None and (self.change != "stop" or played.after):  # a film that stops for good keeps its looks
            scene = scene.replace(motion=motion.replace(looks=shown(motion.looks, played)))
        after = with_tracks(scene, made, stop, (*residuals, *waves))
        return Outcome(after, touched=torch.from_numpy(every), notes=self._notes(stop, motion))

    def _plays_looks(self, motion: Motion | None) -> bool:
        """Whether the whole scene is played otherwise, with looks that follow it."""
        played = self._whole and self.change in _PLAYED and not self._of_one_movement
        return played and motion is not None and bool(motion.looks)

    def _played(self, scene: Scene, own: list[Track], group: I64, span: Span, spans: list[Span]) -> tuple[Warp, float]:
        """Which old time is shown when, and when the scene or the movement then ends."""
        assert scene.motion is not None
        if self.change in ("part", "repeat", "back_and_forth"):
            return self._again(scene, own, group, span, spans)
        return self._warp(scene.motion, own, span, spans)

    def _closing(self, scene: Scene, selection: Selection, context: Context) -> Articulate | None:
        """What is meant by "close the door 2 s later" of a door that opens and does not close yet: it closes 2 s after
        it has opened. None if it closes, or nothing tells that it opens."""
        told = self.when.during if self.when is not None else None
        later = self.change == "later" and self.seconds is not None and self.seconds >= 0
        if not later or told is None or told.state != "closing" or not self._of_one_movement:
            return None
        opens, closes = (During(state=state) for state in ("opening", "closing"))
        try:
            spans = [spans_of(When(during=during), scene, selection, context)[-1] for during in (closes, opens)]
        except InstructionError:
            return None
        op = Articulate(
            target=self.target,
            change="close",
            when=When(start=self.seconds, during=opens.model_copy(update={"part": "after"})),
        )
        overlap = spans[0][0] < spans[1][1] and spans[1][0] < spans[0][1]  # one movement, both opening and closing
        return op if overlap and op.begins_shut(scene, selection) else None

    def _notes(self, stop: float, motion: Motion) -> tuple[str, ...]:
        return (f"the scene lasts {stop - motion.start:g} s now",) if abs(stop - motion.stop) > _NO_TIME else ()

    def _warp(self, motion: Motion, own: list[Track], span: Span, spans: list[Span]) -> tuple[Warp, float]:
        """Which old time is shown when, and when the scene or the movement then ends."""
        whole = self._whole or (self.change == "reverse" and bool(own) and _is_even(own, span))
        low, high = (motion.start, motion.stop) if whole else span
        start = spans[0][0] if spans and math.isfinite(spans[0][0]) else None
        stop = spans[0][1] if spans and math.isfinite(spans[0][1]) else None
        if self.change == "stop":
            return self._stopped(motion, spans, low, high)
        if self.change == "begin":
            begin = low if start is None else start
            lasting = high - low if stop is None else stop - begin
            if self.when is not None and self.when.lasting is not None:
                begin, lasting = (
                    (low if self.when.start is None and self.when.during is None else begin),
                    self.when.lasting,
                )
            if lasting < _NO_TIME:
                raise InstructionError(
                    f"it would begin at {begin:g} s and end then: say when it is to begin, or to end"
                )
            return Warp((begin, begin + lasting), (low, high), 0.0, 0.0), begin + lasting
        if self.change == "later":
            assert self.seconds is not None
            by = max(self.seconds, motion.start - low)
            return Warp((low + by,), (low,), 0.0, 1.0), high + by
        if self.change == "reverse":
            return Warp((low, high), (high, low), 0.0, 0.0), high
        if self.change == "return":
            back = max(high, start) if start is not None else high
            taken = high - low if self.when is None or self.when.lasting is None else self.when.lasting
            taken = (
                stop - back if stop is not None and stop > back and (self.when and self.when.lasting is None) else taken
            )
            return Warp(
                (low, high, back + _NO_TIME, back + _NO_TIME + taken), (low, high, high, low), 0.0, 0.0
            ), back + taken
        if self.change == "go_on":
            raise InstructionError(f"{self.target.describe()} does not turn or run at one speed: say where it is to go")
        assert self.factor is not None
        first = low if start is None else start
        last = math.inf if stop is None else stop
        if math.isinf(last):
            return Warp((first,), (first,), 1.0, self.factor), first + (high - first) / self.factor
        if last - first < _NO_TIME:
            raise InstructionError(f"it only begins to move at {first:.3g} s, and {last:.3g} s is no later than that")
        gained = first + (last - first) * self.factor
        return Warp((first, last), (first, gained), 1.0, 1.0), high + last - gained

    @property
    def _of_one_movement(self) -> bool:
        """Whether only one of its movements is meant: "slower while it opens"."""
        if self.change not in ("speed", "later", "begin") or self.when is None or self.when.during is None:
            return False
        told = self.when.during
        return told.part == "while" and told.of is None and told.state in _MOVEMENTS and self.when.start is None

    def _in_movement(self, part: Span, movements: list[Span], span: Span) -> tuple[Warp, float]:
        """Which old time is shown when, where one movement gets another time; those behind it keep theirs if they
        can."""
        assert self.when is not None
        low, high = max(part[0], span[0]), min(part[1], span[1])  # an end may be open
        before = max((b for _, b in movements if b <= low + _BESIDE), default=-math.inf)
        behind = min((a for a, b in movements if b > high + _BESIDE), default=math.inf)
        begin, lasting = low, high - low
        if lasting < _NO_TIME:
            raise InstructionError(f"{self.target.describe()} does not move then")
        if self.change == "later":
            assert self.seconds is not None
            begin = max(low + self.seconds, before + _NO_TIME)
        elif self.when.lasting is not None:
            lasting = self.when.lasting
        elif self.factor is not None:
            lasting /= self.factor
        end = begin + lasting
        stop = max(span[1], end) if end < behind < math.inf else span[1] + end - high
        return moved((low, high), (begin, end), before, behind), stop

    def _again(self, scene: Scene, own: list[Track], group: I64, span: Span, spans: list[Span]) -> tuple[Warp, float]:
        """Which old time is shown when, of what goes a part of its way or goes it several times."""
        assert scene.motion is not None
        (low, high), whole = span, scene.motion.stop
        if self.change == "repeat" and spans and math.isfinite(spans[0][0]):  # once more, from then on
            first = max(spans[0][0], high + _NO_TIME)
            end = first + _NO_TIME + high - low
            until = whole if self.when is not None and self.when.stop == "end" else spans[0][1]
            turns = bool(own) and all(map(is_turning, own))
            if turns and first < until < end:  # what turns round and round may stop anywhere
                last = low + until - first - _NO_TIME
                return Warp((low, high, first, first + _NO_TIME, until), (low, high, high, low, last), 0.0, 0.0), until
            return Warp((low, high, first, first + _NO_TIME, end), (low, high, high, low, high), 0.0, 0.0), end
        if self.change == "part":
            until = self._until(scene, own, group, span)
            return Warp((until,), (until,), 1.0, 0.0), until
        back = self.change == "back_and_forth"
        taken = (high - low) * (2 if back else 1)
        count = self.times if self.times is not None else max(math.ceil((whole - low) / taken), 1)
        if self.times is None and count == 1 and not back:
            raise InstructionError(f"{self.target.describe()} moves until the end: say how many times")
        new, old = [low], [low]
        for turn in range(count):
            first = low + turn * taken
            new += [first + (high - low)] + ([first + taken] if back else [])
            old += [high] + ([low] if back else [])
            if not back and turn + 1 < count:  # what does not end where it began jumps there
                new.append(first + taken + _NO_TIME)
                old.append(low)
        end = new[-1] if self.times is not None or count == 1 else whole  # there and back is longer than the scene
        return Warp(tuple(new), tuple(old), 0.0, 0.0), end

    def _until(self, scene: Scene, own: list[Track], group: I64, span: Span) -> float:
        """When the middle of a thing has gone the part of its way that is asked for, seconds."""
        times = np.linspace(span[0], span[1], max(int((span[1] - span[0]) * 200), 2))
        way = _way_of(scene, own, group, times)
        gone = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(way, axis=0), axis=1))])
        asked = gone[-1] * self.share if self.share is not None else 0.0
        if self.distance is not None:
            asked = self.distance.in_units(scene.frame)
        if asked >= gone[-1]:
            metres = gone[-1] * (scene.frame.metres_per_unit or 1.0)
            raise InstructionError(f"{self.target.describe()} only goes {metres:.2g} m: say less, or move it there")
        return float(np.interp(asked, gone, times))

    def _mirrored(self, scene: Scene, own: list[Track], group: I64, span: Span) -> list[Track]:
        """Tracks whose turns to the left are turns to the right: mirrored at the plane in which a thing sets out."""
        times = np.linspace(span[0], span[1], 200)
        way, up = _way_of(scene, own, group, times), scene.frame.up_vector
        level = _level(way, up)
        length = np.linalg.norm(level, axis=1)
        gone = np.flatnonzero(length > 0.1 * max(float(length.max()), 1e-9))
        if length.max() * (scene.frame.metres_per_unit or 1.0) < _ON_THE_SPOT:
            raise InstructionError(f"{self.target.describe()} goes nowhere: say how it is to turn")
        first = level[gone[0]] / length[gone[0]]
        side = np.cross(up, first)
        if float(np.abs(level @ side).max()) < _STRAIGHT * float(length.max()):
            raise InstructionError(f"{self.target.describe()} goes straight on and takes no turn")
        return [_reflected(track, side, way[0]) for track in own]

    def _bent(self, scene: Scene, own: list[Track], group: I64, span: Span) -> list[Track]:
        """Tracks with another turn on the way."""
        assert self.degrees is not None
        up, times = scene.frame.up_vector, np.linspace(span[0], span[1], 400)
        turning = [track for track in own if abs(float(upright_turns(track, times, up)[-1])) > _NO_TURN]
        far = _level_way(turning[0], times, up) if len(turning) == 1 else 0.0
        if far * (scene.frame.metres_per_unit or 1.0) < _ON_THE_SPOT:
            raise InstructionError(f"{self.target.describe()} takes no turn on its way: say where it is to go")
        if any(_level_way(track, times, up) > _STRAIGHT * far for track in own if track not in turning):
            raise InstructionError(f"{self.target.describe()} goes its way on several tracks, and none of them is bent")
        middle = _way_of(scene, [], group, times[:1])[0]
        return [bent(t, math.radians(self.degrees), up, middle, times) if t in turning else t for t in own]

    def _stopped(self, motion: Motion, spans: list[Span], low: float, high: float) -> tuple[Warp, float]:
        """It stands still in the spans, and goes on behind each of them; what stands still anyway does not get late."""
        if not spans:
            return Warp((motion.start,), (motion.start,), 0.0, 0.0), motion.stop
        new, old, late = [], [], 0.0
        for start, stop in spans:
            first = max(start, low + late)
            if stop <= first:
                continue
            new.append(first)
            old.append(first - late)
            if math.isinf(stop):
                return Warp(tuple(new), tuple(old), 1.0, 0.0), motion.stop
            late += stop - first
            new.append(stop)
            old.append(stop - late)
        if not new:
            return Warp((low,), (low,)), high
        return Warp(tuple(new), tuple(old), 1.0, 1.0), high + late

    def _turned(self, track: Track, motion: Motion, spans: list[Span]) -> tuple[Track, float]:
        """A track of many turns at another speed, the other way round, or without an end; and its end."""
        assert track.axis is not None and track.angles is not None
        low, high = movement([track], motion.start, motion.stop) or (motion.start, motion.stop)
        start = max(spans[0][0], low) if spans else low
        stop = min(spans[0][1], math.inf) if spans else math.inf
        if self.change == "go_on":
            rate = _rate(track, low, high)
            angle = _angle(track, (low + high) / 2)
            middle = (low + high) / 2
            end = stop if math.isfinite(stop) else middle + 1.0
            before = [float(t) for t in track.times if t < middle]
            keys = np.array([*before, middle, max(end, middle + _NO_TIME)])
            turned = np.array([*(_angle(track, t) for t in keys[:-1]), angle + rate * (keys[-1] - middle)])
            kind: Literal["hinge", "spin"] = "hinge" if math.isfinite(stop) else "spin"
            onward = Track(track.runs, keys, track.quats, track.offsets, track.pivot, kind, track.axis, turned, False,
                           track.name)  # fmt: skip
            return onward, high
        factor = self.factor if self.change == "speed" and self.factor is not None else -1.0
        if not spans or (start <= low and stop >= high):
            return _scaled(track, factor), motion.stop
        edges = [t for t in (start, stop) if math.isfinite(t)]
        times = np.unique(np.concatenate([track.times, edges, [max(high, *edges) + 1.0]]))
        rates = np.diff([_angle(track, t) for t in times]) / np.diff(times)
        middles = (times[1:] + times[:-1]) / 2
        rates = np.where((middles > start) & (middles < stop), rates * factor, rates)
        angles = np.concatenate([[0.0], np.cumsum(rates * np.diff(times))])
        made = Track(track.runs, times, track.quats, track.offsets, track.pivot, track.kind, track.axis, angles, False,
                     track.name)  # fmt: skip
        return made, motion.stop

    def check(self, before: Scene, outcome: Outcome, selection: Selection, context: Context) -> tuple[Check, ...]:
        after, was = outcome.scene.motion, before.motion
        assert was is not None
        lost = len(moving_ids(was)) - len(moving_ids(after)) if self.change != "stop" else 0
        said = f"{max(lost, 0)} Gaussians that moved before do not move any more"
        return count_matches(before, outcome.scene, outcome), at_most("still moves", max(lost, 0), 0, "Gaussians", said)


def _is_even(own: list[Track], span: Span) -> bool:
    """Whether a movement is the same backwards: there and back."""
    times = np.linspace(span[0], span[1], 9)
    turns, shifts = chained(own, times)
    far = max(float(np.abs(shifts - shifts[0]).max()), _NO_TIME)
    return bool(np.allclose(turns, turns[::-1], atol=0.02) and np.allclose(shifts, shifts[::-1], atol=0.02 * far))


def _way_of(scene: Scene, own: list[Track], group: I64, times: F64) -> F64:
    """`[T, 3]` where the middle of some Gaussians is, scene units."""
    rows = rows_of_ids(scene.cloud.ids, torch.from_numpy(group))
    middle = scene.cloud.means[rows].double().mean(dim=0).cpu().numpy()
    turns, shifts = chained(own, times)
    return np.asarray(turns @ middle + shifts)


def _level(way: F64, up: F64) -> F64:
    """`[T, 3]` how far along the floor a way `[T, 3]` has gone from where it begins."""
    gone = way - way[:1]
    return np.asarray(gone - (gone @ up)[:, None] * up)


def _level_way(track: Track, times: F64, up: F64) -> float:
    """How far a track carries its pivot along the floor, scene units."""
    turns, shifts = poses(track, times)
    return float(np.linalg.norm(_level(turns @ track.pivot + shifts, up), axis=1).max())


def _reflected(track: Track, side: F64, point: F64) -> Track:
    """A track mirrored at the plane through `point` with the normal `side`; what it moves is not mirrored itself."""
    mirror = np.eye(3) - 2 * np.outer(side, side)
    turns, shifts = poses(track, track.times)
    made = mirror @ turns @ mirror
    moved = (turns @ (point - mirror @ point) + shifts - point) @ mirror + point
    return Track.poses_at(track.ids, track.times, made, moved, track.pivot, track.smooth, track.name)


def _things(scene: Scene, selection: Selection, ids: I64, whole: bool) -> list[I64]:
    """The moving ids of each thing; all of them where the whole scene is meant."""
    if whole:
        return [ids]
    found = [scene.cloud.ids[rows].cpu().numpy() for _, rows in rows_by_thing(scene, selection)]
    return [own for own in (np.intersect1d(thing, ids) for thing in found) if len(own)]


def is_turning(track: Track) -> bool:
    """Whether a track turns round and round, so that its speed is turns a second."""
    if track.angles is None or track.kind == "slide":
        return False
    return track.kind == "spin" or float(np.ptp(track.angles)) > _TURNS


def _angle(track: Track, time: float) -> float:
    assert track.angles is not None
    beyond = 0.0
    if track.kind == "spin" and time > track.times[-1]:
        beyond = _rate(track, float(track.times[-2]), float(track.times[-1])) * (time - float(track.times[-1]))
    return float(np.interp(time, track.times, track.angles)) + beyond


def _rate(track: Track, low: float, high: float) -> float:
    """Radians a second in a time."""
    assert track.angles is not None
    ends = np.interp([low, min(high, float(track.times[-1]))], track.times, track.angles)
    return float((ends[1] - ends[0]) / max(min(high, float(track.times[-1])) - low, 1e-9))


def _scaled(track: Track, factor: float) -> Track:
    assert track.angles is not None and track.axis is not None
    return Track(track.runs, track.times, track.quats, track.offsets, track.pivot, track.kind, track.axis,
                 track.angles * factor, track.smooth, track.name)  # fmt: skip

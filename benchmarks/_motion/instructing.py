"""Written instructions for the moving rooms, carried out in a session and judged by their effect on the scene.

What an operation is called does not count; only where things are, how they turn and how they look over time, before and
after.
"""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from statistics import median
from typing import Any, Literal

import numpy as np
import torch
from numpy.typing import NDArray

from ...agent.session.session import Session
from ...gaussians.errors import ScenewrightError
from ...gaussians.language.field.language_field import Group
from ...gaussians.language.query.attributes import COLOR_HOLDS, color_scores
from ...gaussians.motion import events
from ...gaussians.motion.at import at
from ...gaussians.motion.courses import Course, course_of
from ...gaussians.motion.holding import Span
from ...gaussians.scene import Scene
from ...gaussians.world.words import singular
from ..harness import Metric
from . import rooms
from .written import cases

Outcome = Literal["right", "wrong", "refused"]
F64 = NDArray[np.float64]

RIGHT, WRONG = 0.85, 0.03  # goals: at least, at most
DETAIL = 0.3
NEAR = 0.3  # seconds, where a case says nothing
BESIDE = 0.45  # metres: gap to what something goes to; the ball starts 0.40 m from the sofa
_LAST = 5.0  # seconds: the end of the rooms
_SAMPLES = tuple(np.arange(0.05, _LAST, 0.1))  # seconds: times at which looks are compared
_SEEN = 0.01  # opacity of what is to be seen
_NUMBER = "group "
_MOVED = 0.03  # metres: what nobody spoke of may differ by this


@dataclass(frozen=True)
class Instructed:
    """One instruction with what came of it.

    Attributes:
        case: as written.
        outcome: one that cannot be carried out is right if it is refused, and wrong otherwise.
        told: the error, or what was found wrong.
        seconds: of the processor.
    """

    case: dict[str, Any]
    outcome: Outcome
    told: str
    seconds: float


@dataclass(frozen=True, eq=False)
class _Effect:
    """A scene before and after an instruction."""

    before: Scene
    after: Scene

    def names(self, name: str) -> list[str]:
        """The things that a case names: each of several by its number, "all chairs"."""
        assert self.before.language is not None
        noun = name.split()[-1]
        if singular(noun) == noun or any(noun in g.label for g in self.before.language.groups):
            return [name]
        fits = [g for g in self.before.language.groups if g.level == "object" and singular(noun) in g.label.split()]
        return [f"{_NUMBER}{g.id}" for g in fits]

    def group(self, name: str) -> int:
        """The group that a case names: the words of its label, with a colour or its place in a stack; or its number."""
        assert self.before.language is not None
        if name.startswith(_NUMBER):
            return int(name.removeprefix(_NUMBER))
        words, table = name.split(), self.before.language.groups
        fits = [g for g in table if g.level == "object" and set(g.label.split()) & set(words) and words[-1] in g.label]
        if len(fits) > 1 and words[0] in _RANKS:
            return sorted(fits, key=lambda g: g.box.center[2])[_RANKS[words[0]]].id
        fits = [g for g in fits if g.label == name] or fits  # "door", and not "door frame"
        if len(fits) > 1:
            return max(fits, key=lambda g: float(color_scores(words[0], np.array(g.lab)))).id
        return fits[0].id

    def course(self, name: str, before: bool = False) -> Course:
        """Where a thing is through time."""
        return course_of(self.before if before else self.after, self.group(name))

    @property
    def end(self) -> float:
        """Seconds at which the film ends: an edit may make it longer."""
        return _LAST if self.after.motion is None else max(_LAST, self.after.motion.stop)

    @cached_property
    def shots(self) -> list[tuple[float, Scene, Scene]]:
        """Both scenes at sampled times."""
        return [(float(t), at(self.before, float(t)), at(self.after, float(t))) for t in _SAMPLES]

    def is_there(self, group: int) -> list[bool]:
        """At each sampled time, whether a thing is to be seen."""
        return [_count(after, group) > 0.5 * max(_count(before, group), 1) for _, before, after in self.shots]


_RANKS = {"top": -1, "middle": 1, "bottom": 0}  # in a stack of three


def _count(scene: Scene, group: int) -> int:
    """How many Gaussians of a thing are to be seen."""
    assert scene.language is not None
    if group >= len(scene.language.groups):
        return 0
    leaves = torch.tensor(scene.language.leaves(group), dtype=torch.int32)
    own = torch.isin(scene.cloud.group.cpu(), leaves) & (scene.cloud.opacities.cpu() > _SEEN)
    return int(own.sum())


def instructed(which: Sequence[dict[str, Any]]) -> list[Instructed]:
    """Each instruction carried out on a fresh room."""
    found = []
    for case in which:
        scene = rooms.moving_room(case["room"], DETAIL)
        session = Session(scene)
        before = session.scene
        started = time.process_time()
        try:
            session.do(case["text"])
        except ScenewrightError as error:
            told, outcome = str(error), "right" if case["expect"]["kind"] == "refuse" else "refused"
        else:
            told = _wrong(case["expect"], _Effect(before, session.scene))
            outcome = "wrong" if told else "right"
        found.append(Instructed(case, outcome, told, time.process_time() - started))  # type: ignore[arg-type]
    return found


def _wrong(expect: dict[str, Any], effect: _Effect) -> str:
    """What an effect lacks of what is expected; "" if nothing."""
    if expect.get("frozen") is True:  # from `start` to `stop`, or at all times
        still = [expect.get("start") or 0.0, expect.get("stop") or _LAST]
        expect = {k: v for k, v in expect.items() if k not in ("start", "stop")} | {"frozen": still}
    kind = expect["kind"]
    listed = expect["thing"] if isinstance(expect["thing"], list) else [expect["thing"]]
    named = [name for thing in listed for name in effect.names(thing)]
    if kind == "refuse":
        return "something was done"
    checks = {"remove": _removed, "hide": _hidden, "look": _looks, "static": _looks}
    single = len(named) == 1 or kind in checks
    each = expect if single else {k: v for k, v in expect.items() if k not in ("start", "stop")}
    wrong = "; ".join(told for name in named if (told := checks.get(kind, _moves)(each, name, effect)))
    if not single and not wrong:
        wrong = _together(expect, named, effect)
    if not wrong and "order" in expect:
        starts = [_spans(effect.course(n))[0][0] for n in expect["order"] if _spans(effect.course(n))]
        wrong = "" if len(starts) == len(expect["order"]) and starts == sorted(starts) else "the order is another"
    return wrong or _others([*named, *expect.get("order", ())], effect)


def _together(expect: dict[str, Any], named: Sequence[str], effect: _Effect) -> str:
    """What is wrong with when several things move: the first of them begins and the last of them stops in time."""
    spans = [s for name in named for s in _spans(effect.course(name))]
    if not spans:
        return "" if expect.get("factor") == 0 else "nothing moves"
    for key, seen in (("start", min(a for a, _ in spans)), ("stop", max(b for _, b in spans))):
        if expect.get(key) is not None and abs(seen - expect[key]) > _near(expect):
            return f"they {'begin' if key == 'start' else 'end'} at {seen:.2f} s"
    return ""


def _removed(expect: dict[str, Any], name: str, effect: _Effect) -> str:
    return "it is still there" if _count(effect.after, effect.group(name)) else ""


def _hidden(expect: dict[str, Any], name: str, effect: _Effect) -> str:
    start, stop = _range(expect)
    seen = effect.is_there(effect.group(name))
    for (t, _, _), there in zip(effect.shots, seen, strict=True):
        if min(abs(t - start), abs(t - stop)) > _near(expect) and there == (start < t < stop):
            return f"at {t:.2f} s it is {'there' if there else 'gone'}"
    return ""


def _looks(expect: dict[str, Any], name: str, effect: _Effect) -> str:
    start, stop = _range(expect)
    group, word = effect.group(name), expect["color"]
    for t, before, after in effect.shots:
        assert before.language is not None and after.language is not None
        if min(abs(t - start), abs(t - stop)) <= _near(expect):
            continue
        own, other = (np.array(s.language.groups[group].lab) for s in (after, before))  # type: ignore[union-attr]
        if start < t < stop and float(color_scores(word, own)) < COLOR_HOLDS:
            return f"at {t:.2f} s it is not {word}"
        if not start < t < stop and float(np.linalg.norm(own - other)) > 3.0:
            return f"at {t:.2f} s it looks different"
    return ""


def _range(expect: dict[str, Any]) -> Span:
    start, stop = expect.get("start"), expect.get("stop")
    return -1.0 if start is None else float(start), math.inf if stop is None or stop >= _LAST else float(stop)


def _near(expect: dict[str, Any]) -> float:
    return float(expect.get("tolerance") or NEAR)


def _spans(course: Course) -> list[Span]:
    return events.movements(course)


def _moves(expect: dict[str, Any], name: str, effect: _Effect) -> str:
    """What is wrong with the motion of a thing."""
    course, earlier = effect.course(name), effect.course(name, before=True)
    spans = _spans(course)
    rests = expect.get("frozen", [0])[0] > 0 or expect.get("stop") is not None  # it opens before it closes
    stays = expect.get("angle_deg") == 0 and expect.get("start") is None and not rests  # "keep it shut"
    if expect.get("factor") == 0 or stays:
        return f"it moves from {spans[0][0]:.2f} s" if spans else ""
    timed = any(expect.get(key) is not None for key in ("start", "stop", "duration_s", "frozen"))
    if not spans and expect["kind"] == "path" and expect.get("at_end") and not timed:  # put there once and for all
        return _reaching(expect, course, earlier, spans, effect)
    if not spans:
        return "" if expect.get("frozen", [1])[0] == 0 else "it does not move"
    tests = (_timing, _pacing, _turning, _reaching)
    return next((told for test in tests if (told := test(expect, course, earlier, spans, effect))), "")


def _timing(expect: dict[str, Any], course: Course, earlier: Course, spans: list[Span], effect: _Effect) -> str:
    closes = expect["kind"] == "articulate" and expect.get("angle_deg") == 0
    start = _closes_at(course, spans) if closes else spans[0][0]
    moved = expect["kind"] == "path" and bool(_spans(earlier))  # by itself, before it is sent
    if (expect["kind"] == "spin" or moved) and expect.get("start"):
        start = next((a for a, _ in spans if abs(a - expect["start"]) <= _near(expect)), spans[-1][0])
        if any(a - NEAR <= expect["start"] <= b for a, b in spans):
            start = expect["start"]  # it goes on from another movement
    slowed = max(1.0, 1 / (expect.get("factor") or 1.0))  # what begins slowly is seen to move so much later
    if expect.get("start") is not None and not closes and abs(start - expect["start"]) > slowed * _near(expect):
        return f"it begins at {start:.2f} s"
    if closes and start < (expect.get("start") or 0.0) - _near(expect):
        return f"it closes at {start:.2f} s"
    returns = expect.get("distance_m") is not None and expect["kind"] == "articulate"
    stops = {spans[0][1], spans[-1][1]} if returns else {spans[-1][1]}  # until it is out, or back in
    if expect.get("stop") is not None and min(abs(stop - expect["stop"]) for stop in stops) > _near(expect):
        return f"it ends at {min(stops):.2f} s"
    if "starts_after_s" in expect and start < expect["starts_after_s"]:
        return f"it begins at {start:.2f} s"
    later = closes or (expect["kind"] == "path" and start > spans[0][0])  # it goes on from another movement
    if moved and expect.get("start") is None:  # how long it takes from where its own movement ends
        start, later = spans[-1][0], True
    taken = spans[-1][1] - (start if later else spans[0][0])
    if "duration_s" in expect and abs(taken - expect["duration_s"]) > 0.4:
        return f"it takes {taken:.2f} s"
    for a, b in [expect["frozen"]] if "frozen" in expect else []:
        if any(s[0] < b - 0.1 and a + 0.1 < s[1] for s in spans) and not _rests(spans, (a, b), _near(expect)):
            return f"it moves between {a} and {b} s"
    return ""


def _rests(spans: list[Span], wanted: Span, near: float) -> bool:
    """Whether something rests between two movements for as long as it is wanted to, near that time."""
    for (_, start), (stop, _) in pairwise(spans):
        if max(abs(start - wanted[0]), abs(stop - wanted[1])) <= near and stop - start >= wanted[1] - wanted[0] - 0.1:
            return True
    return False


def _closes_at(course: Course, spans: list[Span]) -> float:
    """When something that opened begins to close: it may go straight on from opening."""
    times = course.grid((0.0, spans[-1][1]))
    angles = course.angles(times)  # from how it is at the start
    widest = float(angles.max())
    if widest == 0 or spans[-1][0] >= times[int(np.argmax(angles))] - NEAR:
        return spans[-1][0]
    return float(times[np.flatnonzero(angles >= 0.98 * widest)[-1]])


def _pacing(expect: dict[str, Any], course: Course, earlier: Course, spans: list[Span], effect: _Effect) -> str:
    factor = expect.get("factor")
    if factor is None or "turns_per_s" in expect:
        return ""
    if factor < 0:
        ends = np.array([0.0, _LAST])
        gaps = np.linalg.norm(course.centers(ends) - earlier.centers(ends[::-1]), axis=1)
        return f"it is {gaps.max():.2f} m off its way back" if gaps.max() > 0.2 else ""
    rates = [float(c.rates(np.concatenate([c.grid(s) for s in _spans(c)])).mean()) for c in (course, earlier)]
    ratio = rates[0] / max(rates[1], 1e-9)
    return f"its speed is {ratio:.2f} times the former" if abs(ratio / factor - 1) > 0.15 else ""


def _turning(expect: dict[str, Any], course: Course, earlier: Course, spans: list[Span], effect: _Effect) -> str:
    if "turns_per_s" in expect:
        after = (max(spans[0][0], expect.get("start") or 0.0), spans[-1][1])
        rate = events.yawed(course, after) / (after[1] - after[0]) / (2 * math.pi)
        wanted = expect["turns_per_s"]
        if expect["kind"] == "spin" and wanted < 0:
            own = events.yawed(earlier, _spans(earlier)[0])
            rate *= math.copysign(1.0, own)
        return (
            f"it turns {rate:.2f} times a second"
            if abs(rate if wanted < 0 else abs(rate)) == 0
            or abs((rate if wanted < 0 else abs(rate)) - wanted) > 0.15 * abs(wanted)
            else ""
        )
    if expect["kind"] == "spin" and "angle_deg" in expect:
        after = (expect["start"] - NEAR, effect.end)
        turned = abs(math.degrees(events.yawed(course, after)))
        return f"it turns by {turned:.0f} degrees" if abs(turned - expect["angle_deg"]) > 15 else ""
    if "angle_deg" in expect and (expect.get("factor") or 1) > 0:  # an angle is from how it is at the start
        angle = math.degrees(float(course.angles(np.array([effect.end]))[0]))
        return f"it is open by {angle:.0f} degrees" if abs(angle - expect["angle_deg"]) > 5 else ""
    if "turn_deg" in expect:
        turned, own = (sum(math.degrees(events.yawed(c, s)) for s in _spans(c)) for c in (course, earlier))
        misses = min(abs(turned - expect["turn_deg"]), abs(abs(turned - own) - expect["turn_deg"]))  # in all, or anew
        return f"it turns by {turned:.0f} degrees" if misses > 20 else ""
    return ""


def _reaching(expect: dict[str, Any], course: Course, earlier: Course, spans: list[Span], effect: _Effect) -> str:
    way = course.centers(course.grid()) - course.centers(np.array([0.0]))
    if "distance_m" in expect:
        far = float((way @ course.up).max() if expect.get("toward") == "up" else np.linalg.norm(way, axis=1).max())
        if abs(far - expect["distance_m"]) > max(0.15 * expect["distance_m"], _MOVED):
            return f"it moves by {far:.2f} m"
    for key in ("toward", "at_end"):
        if expect.get(key) in (None, "up", "open", "left", "right"):
            continue
        pair = events.Encounter.of(effect.after, course.group, [effect.group(expect[key])])
        first, gap = (float(g) for g in pair.gaps(np.array([expect.get("start") or 0.0, effect.end])))
        if "distance_m" in expect:  # only so far
            if gap >= first:
                return f"it does not come nearer to the {expect[key]}"
        elif gap > BESIDE:
            return f"at the end it is {gap:.2f} m from the {expect[key]}"
    return ""


def _others(named: Sequence[str], effect: _Effect) -> str:
    """What moves differently though nobody spoke of it."""
    spoken = {effect.group(n) for n in named}
    assert effect.before.language is not None and effect.after.language is not None
    times = np.linspace(0.0, _LAST, 11)
    for group in effect.before.language.groups:
        if group.level != "object" or group.id in spoken or not group.count:
            continue
        if not _count(effect.after, group.id):
            return f"the {group.label} is gone"
        before, after = (course_of(s, group.id).centers(times) for s in (effect.before, effect.after))
        moved = after - before
        if float(np.abs(moved).max()) > _MOVED and not _is_carried(group, moved, times, spoken, effect):
            return f"the {group.label} moves, too"
    return ""


def _is_carried(group: Group, moved: F64, times: F64, carriers: set[int], effect: _Effect) -> bool:
    """Whether a thing stands on one that moves, and moves as that does: the lamp on the desk that is pushed away."""
    assert effect.before.language is not None
    for carrier in (effect.before.language.groups[i] for i in carriers):
        off = np.array(group.box.center) - np.array(carrier.box.center)
        ways = [course_of(s, carrier.id).centers(times) for s in (effect.before, effect.after)]
        over = np.linalg.norm(off[:2]) < np.linalg.norm(np.array(carrier.box.size)[:2]) / 2 and off[2] > 0
        if over and float(np.abs(moved - (ways[1] - ways[0])).max()) <= _MOVED:
            return True
    return False


def metrics(which: str) -> list[Metric]:
    """The shares of a set of instructions; none if the set is not there.

    Args:
        which: "instructions", "held_instructions" or "later_instructions".
    """
    found = instructed(cases(which))
    if not found:
        return []
    counts = Counter(i.outcome for i in found)
    return [
        Metric(f"{which}.right", counts["right"] / len(found), "share", "higher", 0.02, RIGHT),
        Metric(f"{which}.wrong", counts["wrong"] / len(found), "share", "lower", 0.02, WRONG),
        Metric(f"{which}.given", float(len(found)), "count"),
        Metric(f"{which}.cpu", median(i.seconds for i in found), "s", "lower", 0.5),
    ]

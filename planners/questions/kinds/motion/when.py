"""When something happens: "when does the ball reach the wall?", "at what time is the door half open?"."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .....gaussians import late_re as re
from .....gaussians.motion.holding import Span
from ...answer import Answer
from ...candidates import is_plural
from ...reading.time.deeds import AT_ONCE, STATES, Deed
from ...reading.time.moments import seconds
from ...survey import listed
from ...timeline.asked import PLACES, Told, Untold, at, cap, during, kind, number, verb, within
from ...timeline.bodies import Body
from ...timeline.happening import peak

_STEP = 1 / 240  # seconds, over which turns are added
_ALMOST = 0.01  # of a turn
COUNTED_TURNS = re.compile(
    r"\b(?P<n>half a|one|per|a|each|every|two|three|four|five|ten|\d+) (?:(?:full|single|whole|complete) )?"
    r"(?:turn|rotation|revolution|spin|round)s?\b"
)
Event = tuple[float, Body, Span]
_ALL = re.compile(r"\b(?:all|both|every|everything|each|nothing|none)\b")


def moment(deed: Deed, span: Span) -> float:
    """The time that "when" asks of: the end of what stops, the start of everything else."""
    return span[1] if deed.stops else span[0]


def turns_of(counted: re.Match[str]) -> float:
    """The number of turns that words tell: "two full turns"."""
    return 1.0 if counted["n"] in ("each", "every", "per") else seconds(counted["n"])


def changes(told: Told, body: Body) -> list[Span]:
    """The spans of a deed that begin, or of what stops end, within the scene's time, if there are such."""
    deed, line = told.frame.what.deed, told.timeline
    assert deed is not None
    found = within(told.spans(body), told.window())
    if deed.stops:
        return [s for s in found if s[1] < line.stop - 1e-3]
    if deed.kind in STATES:
        return [s for s in found if s[0] > line.start + 1e-3] or found
    return found


def _when(told: Told) -> Answer | None:
    deed = told.frame.what.deed
    if deed is None:
        return None
    if told.frame.measure == "end" and not deed.phase and deed.kind not in AT_ONCE:  # "until when does it turn"
        deed = replace(deed, phase="stop")
        told = replace(told, frame=replace(told.frame, what=replace(told.frame.what, deed=deed)))
    if deed.kind == "turn" and (counted := COUNTED_TURNS.search(told.asked.said)) is not None and deed.stops:
        return _turned(told, told.one(), turns_of(counted))
    subject = told.frame.what.subject
    bodies = told.bodies()
    each = [(b, changes(told, b)) for b in bodies]
    doing = [(b, s) for b, s in each if s]
    if not doing:
        raise Untold(_never(told, bodies))
    if len(doing) > 1 and _ALL.search(told.asked.said) and (deed.kind in STATES or deed.at_once):
        time = max(_events(deed, [each])[0][0] for each in doing)
        return number(time, "s", cap(f"{_told(told, doing)}."), [b for b, _ in doing], time, others=told.others())
    if len(doing) > 1 and subject is not None and not is_plural(subject) and not told.frame.rank:
        return _several(told, doing)
    events = _events(deed, doing)
    if told.frame.rank in ("fastest", "slowest", "farthest", "nearest"):
        return _at_most(told, doing)
    if subject is not None and subject.count is not None and subject.count > 1:
        return _so_many(told, subject.count, events, doing)
    if told.frame.rank == "last" and deed.stops and len(events) == 1:
        told = replace(told, frame=replace(told.frame, rank=""))
    place = PLACES.get(told.frame.rank, -1 if deed == replace(deed, kind="move", phase="stop") else 0)
    if told.frame.rank == "again" and deed.kind in STATES:
        events = [e for e in events if e[0] > told.timeline.start + 1e-3]
        if not events:
            raise Untold(f"That does not happen again: {_told(told, doing)}.")
    elif told.frame.rank == "again":
        place = min(1, len(events) - 1)
    if told.frame.rank in ("last", "second", "third") and deed.kind == "turn" and len(events) == 1 and not deed.stops:
        raise Untold(f"Its turns follow one another without a rest: {_told(told, doing)}.")
    if place >= len(events):
        raise Untold(f"That happens {len(events)} time{'s' if len(events) > 1 else ''} only: {_told(told, doing)}.")
    time, body, _ = events[place]
    text = f"{_told(told, doing)}."
    return number(time, "s", cap(text), [body], time, others=told.others())


def _at_most(told: Told, doing: Sequence[tuple[Body, list[Span]]]) -> Answer:
    """When something that is done goes fastest."""
    deed = told.frame.what.deed
    if (
        told.frame.rank != "fastest"
        or len(doing) != 1
        or deed is None
        or deed.kind not in ("move", "fall")
        or deed.phase
    ):
        raise Untold("When that is most so cannot be told.")
    body, spans = doing[0]
    _, time = max(peak(body, s) for s in spans)
    return number(time, "s", f"{cap(body.name)} moves fastest at {at(time)}.", [body], time)


def _so_many(told: Told, count: int, events: Sequence[Event], doing: Sequence[tuple[Body, list[Span]]]) -> Answer:
    """When so many of several do it, or have done it."""
    firsts = sorted({b.group.id: t for t, b, _ in reversed(events)}.values())
    if len(firsts) < count:
        raise Untold(f"Not so many do that: {_told(told, doing)}.")
    time = firsts[count - 1]
    return number(time, "s", cap(f"{_told(told, doing)}."), [b for b, _ in doing], time, others=told.others())


def _turned(told: Told, body: Body, turns: float) -> Answer:
    """When it has made so many turns."""
    times = body.course.grid(None, _STEP)
    rates = np.linalg.norm(body.course.turns(times), axis=1)
    done = np.cumsum(rates) * _STEP / (2 * math.pi)
    if done[-1] < turns - _ALMOST:
        raise Untold(cap(f"{body.name} makes {done[-1]:.1f} turns only."))
    time = float(times[int(np.argmax(done >= turns - _ALMOST))])
    return number(time, "s", f"{cap(body.name)} has made {turns:g} turns at {at(time)}.", [body], time)


def _events(deed: Deed, doing: Sequence[tuple[Body, list[Span]]]) -> list[Event]:
    found = [(moment(deed, s), b, s) for b, spans in doing for s in spans]
    return sorted(found, key=lambda event: event[0])


def _told(told: Told, doing: Sequence[tuple[Body, list[Span]]]) -> str:
    """When each of them does it: "the ball stops at 3.5 s"."""
    deed = told.frame.what.deed
    assert deed is not None
    long = not deed.at_once
    parts = []
    for body, spans in doing:
        times = listed([during(s) if long else f"at {at(moment(deed, s))}" for s in spans])
        parts.append(f"{body.name} {verb(told)} {times}")
    return "; ".join(parts)


def _several(told: Told, doing: Sequence[tuple[Body, list[Span]]]) -> Answer:
    """One phrase for several things that do it at different times."""
    from ...timeline.asked import nothing

    return nothing(f"Several things do that: {_told(told, doing)}. Say which one.", "number", [b for b, _ in doing])


def _never(told: Told, bodies: Sequence[Body]) -> str:
    names = listed([b.name for b in bodies]) if bodies else "anything"
    still = [b for b in bodies if not b.moving]
    if bodies and len(still) == len(bodies):
        return cap(f"{names} {'does' if len(bodies) == 1 else 'do'} not move.")
    return cap(f"{names} never {verb(told)}.") if len(bodies) == 1 else f"None of them {verb(told)}: {names}."


WHEN = kind("when", "when", _when)

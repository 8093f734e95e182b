"""When something happens: "when does the ball reach the wall?", "at what time is the door half open?"."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from .....gaussians.motion.holding import Span
from ...answer import Answer
from ...candidates import is_plural
from ...reading.time.deeds import AT_ONCE, STATES, Deed
from ...survey import listed
from ...timeline.asked import PLACES, Told, Untold, at, cap, during, kind, number, verb, within
from ...timeline.bodies import Body

_ALL = re.compile(r"\b(?:all|both|every|everything|each)\b")


def moment(deed: Deed, span: Span) -> float:
    """The time that "when" asks of: the end of what stops, the start of everything else."""
    return span[1] if deed.stops else span[0]


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
    place = PLACES.get(told.frame.rank, -1 if deed == replace(deed, kind="move", phase="stop") else 0)
    if told.frame.rank == "again":
        place = min(1, len(events) - 1)
    if told.frame.rank in ("last", "second", "third") and deed.kind == "turn" and len(events) == 1:
        raise Untold(f"Its turns follow one another without a rest: {_told(told, doing)}.")
    if place >= len(events):
        raise Untold(f"That happens {len(events)} time{'s' if len(events) > 1 else ''} only: {_told(told, doing)}.")
    time, body, _ = events[place]
    text = f"{_told(told, doing)}."
    return number(time, "s", cap(text), [body], time, others=told.others())


def _events(deed: Deed, doing: Sequence[tuple[Body, list[Span]]]) -> list[tuple[float, Body, Span]]:
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

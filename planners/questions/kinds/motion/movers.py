"""Which things do something: "what moves?", "which book falls first?", "how many things move?"."""

from __future__ import annotations

import re
from dataclasses import replace

from .....gaussians.motion import events
from .....gaussians.motion.holding import Span
from .....gaussians.world.words import singular
from ...answer import Answer
from ...candidates import is_plural
from ...reading.noun_phrase import is_anything
from ...reading.time.deeds import STATES, Deed
from ...reading.time.frames import plain
from ...reading.time.happenings import TRANSITIVE
from ...survey import NotResolved, Thing, listed
from ...telling import evidence as evidence_of
from ...timeline.asked import PLACES, Told, Untold, at, cap, kind, names, number, spoken, verb, within
from ...timeline.bodies import Body
from .when import moment

_FIXTURES = ("door frame", "window frame")  # parts of the walls: they are no things that stand somewhere
_JUST = 0.05  # seconds
_MOMENTS = ("at", "in", "start", "end", "middle")


def doing(told: Told) -> list[tuple[Body, list[Span]]]:
    """The bodies that do it in the time that is asked of, with the spans."""
    window, found = told.window(), list[tuple[Body, list[Span]]]()
    state = told.frame.what.deed is not None and told.frame.what.deed.kind in STATES
    if window is not None and told.frame.when is not None and told.frame.when.conj == "by" and state:
        window = (window[1], window[1])
    for body in told.bodies():
        try:
            spans = told.spans(body)
        except Untold:
            continue
        deed = told.frame.what.deed
        if deed is not None and deed.at_once and window is not None:
            spans = [s for s in spans if window[0] - 0.1 <= moment(deed, s) <= window[1] + 0.1]
        elif deed is not None and deed.stops:
            spans = [s for s in spans if s[1] < told.timeline.stop - 1e-3]
        elif window is not None and window[0] < window[1]:
            spans = [s for s in spans if _overlaps(s, window)]
        else:
            spans = within(spans, window) or (within(spans, _soon(window)) if state is False else [])
        if spans:
            found.append((body, spans))
    return found


def _soon(window: Span | None) -> Span | None:
    """A moment a little later: what starts just then happens at it."""
    return window if window is None else (window[0] + _JUST, window[1] + _JUST)


def _overlaps(span: Span, window: Span) -> bool:
    """Whether a good part of a span lies in a window, or of the window in the span."""
    shared = min(span[1], window[1]) - max(span[0], window[0])
    return shared >= 0.25 * min(span[1] - span[0], window[1] - window[0])


def _which(told: Told) -> Answer | None:
    what = told.frame.what
    deed = what.deed
    if deed is None and not (told.frame.rank and what.subject is not None):
        return None
    at_moment = told.frame.when is None or told.frame.when.kind in _MOMENTS
    if deed is not None and deed.kind == "related" and what.object is not None and at_moment and not told.frame.rank:
        return None  # the scene at that time tells it
    said = plain(told.asked.words)
    asks_object = re.match(
        r"(?:what|which)(?: things?| objects?| furniture)? (?:does|do|did|will|is|has|the|it)\b", said
    )
    if deed is not None and deed.kind in TRANSITIVE and what.object is None:
        return _objects(told) if asks_object and what.subject is not None else None
    if deed is not None and (deed.kind == "still" or (_stays_shut(deed) and what.subject is not None)):
        return _still(told)
    if deed is not None and (what.denied or deed.kind == "is_closed"):
        return _others(told)
    transitive = re.match(r"(?:what|which) (?:does|do|did|will|has)\b", said)
    if deed is not None and transitive and what.subject is not None and what.object is None and not told.frame.rank:
        return None  # "what does the ball roll"
    found = doing(told)
    if told.frame.rank:
        return _ranked(told, found)
    several = what.subject is not None and is_plural(what.subject)
    if told.frame.when is not None and told.frame.when.conj in ("after", "before") and len(found) > 1 and not several:
        next_one = told.frame.when.conj == "after"  # "which book falls after the red one?"
        found = [(min if next_one else max)(found, key=lambda f: f[1][0][0])]
    bodies = [b for b, _ in found]
    if not bodies:
        return names([], f"Nothing {verb(told)}{_then(told)}.")
    text = "; ".join(f"{b.name} {verb(told)} {_when(told, s)}" for b, s in found)
    time = told.window()[0] if told.window() is not None else found[0][1][0][0]  # type: ignore[index]
    return names(bodies, f"{cap(text)}.", time, single=True)


def _when(told: Told, spans: list[Span]) -> str:
    """The times of a deed in words; of what starts or stops, each moment."""
    deed = told.frame.what.deed
    if deed is not None and deed.at_once:
        return f"at {listed([at(moment(deed, s)) for s in spans])}"
    return spoken(spans)


def _then(told: Told) -> str:
    return " then" if told.frame.when is not None and told.frame.when.kind not in ("ever", "always") else ""


def _ranked(told: Told, found: list[tuple[Body, list[Span]]]) -> Answer:
    """The first, the fastest, the farthest of those that do it."""
    rank, deed = told.frame.rank, told.frame.what.deed
    if not found:
        raise Untold(f"Nothing {verb(told)}{_then(told)}.")
    if rank in PLACES:
        ordered = sorted(
            found,
            key=lambda f: moment(deed, f[1][-1 if deed.stops else 0]) if deed is not None else f[1][0][0],
        )
        if PLACES[rank] >= len(ordered):
            raise Untold(f"Only {listed([b.name for b, _ in ordered])} {verb(told)}.")
        body, spans = ordered[PLACES[rank]]
        text = "; ".join(f"{b.name} {verb(told)} {_when(told, s)}" for b, s in ordered)
        first = f"{cap(body.name)}: " if len(ordered) > 1 else ""
        return names([body], cap(f"{first}{text}."), spans[0][0], single=True)
    by = _speed if rank in ("fastest", "slowest") else _way
    if deed is not None and deed.kind in STATES:
        return _longest(told, found)
    scored = sorted(((by(b, told), b) for b, _ in found), key=lambda pair: -pair[0])
    if rank in ("slowest", "nearest"):
        scored.reverse()
    if len(scored) > 1 and abs(scored[0][0] - scored[1][0]) < 0.03 * max(abs(scored[0][0]), 1e-9):
        told_each = listed([f"{b.name} {v:.2f}" for v, b in scored])
        raise Untold(f"They do not differ: {told_each} {'m/s' if by is _speed else 'm'}.")
    text = listed([f"{b.name} {v:.2f} {'m/s' if by is _speed else 'm'}" for v, b in scored])
    first = f"{cap(scored[0][1].name)}: " if len(scored) > 1 else ""
    return names([scored[0][1]], cap(f"{first}{text}."), single=True)


def _longest(told: Told, found: list[tuple[Body, list[Span]]]) -> Answer:
    """Which is so for the longest, or the shortest time."""
    lasts = sorted(((sum(b - a for a, b in spans), body) for body, spans in found), key=lambda pair: -pair[0])
    if told.frame.rank == "nearest":
        lasts.reverse()
    text = "; ".join(f"{body.name} {verb(told)} for {at(seconds)}" for seconds, body in lasts)
    return names([lasts[0][1]], cap(f"{text}."), single=True)


def _speed(body: Body, told: Told) -> float:
    return float(events.speeds(body.course, body.course.grid()).max()) / told.timeline.unit


def _way(body: Body, told: Told) -> float:
    return sum(events.path_length(body.course, s) for s in body.moving) / told.timeline.unit


def _objects(told: Told) -> Answer | None:
    """What a body does something to: "what does the ball hit?"."""
    from ...timeline.happening import spans_of

    deed, body = told.frame.what.deed, told.one()
    assert deed is not None
    window, found = told.window(), []
    for thing in told.survey.things:
        if thing.id in (body.group.id, getattr(body.thing, "id", None)):
            continue
        spans = within(spans_of(deed, body, (thing,), told.timeline, told.survey) or [], window)
        if spans:
            found.append((spans[0][0], thing))
    if not found and deed.relation == "on":
        return None  # what stands still is asked of then
    if deed.kind == "reach" and "wall" in told.survey.stage.ids:
        wall = told.survey.at(told.survey.stage.ids.index("wall"))
        spans = within(spans_of(deed, body, (wall,), told.timeline, told.survey) or [], window)
        found += [(spans[0][0], wall)] if spans else []
    found.sort(key=lambda f: f[0])
    labels = tuple(t.name for _, t in found)
    text = f"{cap(body.name)} {verb(told)} {listed([told.survey.named(t) for _, t in found])}."
    return Answer(
        answer=labels if len(labels) != 1 else labels[0],
        answer_type="list" if len(labels) != 1 else "label",
        text=text,
        confidence=0.85,
        evidence=evidence_of([*([body.thing] if body.thing else []), *(t for _, t in found)]),
    )


def _stays_shut(deed: Deed) -> bool:
    """Whether what does it never opens, so that of drawers and doors it is what stands still."""
    return deed.kind == "is_closed" and deed.verb.startswith(("stay", "remain", "keep"))


def _still(told: Told) -> Answer:
    """What stands still, at a time or all the time."""
    window = told.window()
    moving = {
        b.thing.id
        for b in told.timeline.movers(told.survey)
        if b.thing is not None and b.course.group == b.thing.id and within(list(b.moving), window)
    }
    subject = told.frame.what.subject
    named = subject is not None and not is_anything(subject)
    every = told.survey.things
    if named and subject is not None:
        every = told.survey.find(subject.model_copy(update={"pick": "all"})).things
        every = tuple(t for t in every if t.label == singular(subject.text)) or every  # drawers, and no dresser
    things = [t for t in every if t.id not in moving and (named or t.label not in _FIXTURES)]
    text = (
        f"{cap(listed([told.survey.named(t) for t in things]))} {'stands' if len(things) == 1 else 'stand'} "
        f"still{_then(told)}."
    )
    return Answer(
        answer=things[0].name if named and len(things) == 1 else tuple(t.name for t in things),
        answer_type="label" if named and len(things) == 1 else "list",
        text=text,
        confidence=0.9,
        evidence=evidence_of(things),
    )


def _others(told: Told) -> Answer | None:
    """Which things do not do it: of the things of that kind all but those that do; "closed" is "not open"."""
    what = told.frame.what
    assert what.deed is not None
    shut = what.deed.kind == "is_closed"
    if shut and what.denied:
        return None
    deed = replace(what.deed, kind="is_open") if shut else what.deed
    moved = replace(told, frame=replace(told.frame, what=replace(what, deed=deed, denied=False)))
    busy = {b.thing.id for b, _ in doing(moved) if b.thing is not None}
    things = [t for t in _of_kind(told) if t.id not in busy]
    if not things:
        return names([], f"There is none of which that is so{_then(told)}.")
    named = tuple(told.survey.named(t) for t in things)
    are = f"{cap(listed(named))} {'are' if len(things) > 1 else 'is'} closed{_then(told)}."
    done = replace(moved.frame.what, deed=replace(deed, phase=""))
    text = are if shut else f"None of these {verb(moved, done)}{_then(told)}: {listed(named)}."
    bare = tuple(name.removeprefix("the ") for name in named)
    return Answer(
        answer=bare[0] if len(bare) == 1 else bare,
        answer_type="label" if len(things) == 1 else "list",
        text=text,
        confidence=0.85,
        evidence=evidence_of(things),
    )


def _of_kind(told: Told) -> list[Thing]:
    """The things that a deed is asked of: those that are named, else those like what ever does it."""
    what = told.frame.what
    if what.subject is not None and not is_anything(what.subject):
        found = told.survey.find(what.subject.model_copy(update={"pick": "all"})).things
        label = singular(what.subject.text)
        return [t for t in found if t.label == label] or [t for t in found if t.label.endswith(f" {label}")]
    always = replace(told, frame=replace(told.frame, when=None, what=replace(what, denied=False)))
    labels = {b.thing.label for b, _ in doing(always) if b.thing is not None}
    return [t for t in told.survey.things if t.label in labels]


def _many(told: Told) -> Answer | None:
    what = told.frame.what
    if what.deed is None:
        return None
    at_moment = told.frame.when is None or told.frame.when.kind in _MOMENTS
    try:
        if what.deed.kind == "related" and at_moment and not all(b.moving for b in told.bodies()):
            return None  # the scene at that time tells it
        found = doing(told)
    except NotResolved as error:
        if error.found.verdict != "ambiguous":
            raise
        return None
    if what.deed.kind in ("still", "is_closed") or what.denied:
        given = _still(told) if what.deed.kind == "still" or _stays_shut(what.deed) else _others(told)
        if given is None:
            return None
        count = len(given.answer) if isinstance(given.answer, tuple) else 1
        return number(float(count), "", given.text, [])
    bodies = [b for b, _ in found]
    text = (
        f"{len(bodies)}: {listed([f'{b.name} {spoken(s)}' for b, s in found])}."
        if bodies
        else f"None {verb(told)}{_then(told)}."
    )
    return number(float(len(bodies)), "", text, bodies, None)


WHICH = kind("which_moves", "which", _which)
MANY = kind("how_many_move", "how_many", _many)

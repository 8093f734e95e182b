"""What happens, in which order, and what a thing does: "what happens here?", "what does the robot do at 3 s?"."""

from __future__ import annotations

import re
from itertools import pairwise

from .....gaussians.motion import events
from .....gaussians.motion.holding import Span
from ....grammar.vocabulary.nouns import is_opened
from ...answer import Answer
from ...reading.time.deeds import Deed
from ...reading.time.happenings import thing as named_thing
from ...survey import listed
from ...timeline.asked import PLACES, Told, Untold, at, cap, evidence, kind, names, spoken, verb, within
from ...timeline.bodies import Body
from ...timeline.happening import TURNS, first_near, openness, spans_of, steps, turning
from .places import direction
from .speeds import is_turning
from .when import moment

_ABOUT = 0.1  # seconds: what happens so near to a time happens at it
_NEAR_END = 0.3  # seconds: what is reached so near to the end of a stretch is where it leads to
Event = tuple[float, str, Body]


def _order(told: Told) -> Answer | None:
    if told.frame.other is not None:
        return _of_two(told)
    if told.frame.options:
        return _visits(told)
    deed = told.frame.what.deed
    if deed is not None and not deed.verb.startswith(("happen", "occur")):
        return _of_deed(told)
    found = sorted((e for b in told.bodies() for e in story(b, told)), key=lambda e: e[0])
    window = told.window()
    if window is not None:
        found = [e for e in found if window[0] - _ABOUT <= e[0] <= window[1] + _ABOUT]
    if not found:
        raise Untold("Nothing happens then.")
    if told.frame.rank:
        place = PLACES.get(told.frame.rank, 0)
        if place >= len(found):
            raise Untold(f"Only {len(found)} things happen.")
        time, said, body = found[place]
        return Answer(
            answer=said.removeprefix("the "),
            answer_type="text",
            text=f"{cap(said)} at {at(time)}.",
            confidence=0.85,
            evidence=evidence([body], time),
        )
    text = "; ".join(f"at {at(t)} {said}" for t, said, _ in found)
    return Answer(
        answer=tuple(said.removeprefix("the ") for _, said, _ in found),
        answer_type="list",
        text=f"{cap(text)}.",
        confidence=0.85,
        evidence=evidence([b for _, _, b in found], found[0][0]),
    )


def _of_two(told: Told) -> Answer | None:
    """ "What comes first, the ball leaving the rug or reaching the wall?"."""
    found = []
    for what in (told.frame.what, told.frame.other):
        if what is None or what.deed is None:
            return None
        body = told.one(what)
        if not (spans := told.spans(body, what)):
            raise Untold(cap(f"{body.name} never {verb(told, what)}."))
        found.append((moment(what.deed, spans[0]), f"{body.name} {verb(told, what)}", body))
    found.sort(key=lambda e: e[0])
    return Answer(
        answer=tuple(said.removeprefix("the ") for _, said, _ in found),
        answer_type="list",
        text=f"{cap('; '.join(f'at {at(t)} {said}' for t, said, _ in found))}.",
        confidence=0.85,
        evidence=evidence([b for _, _, b in found], found[0][0]),
    )


def _visits(told: Told) -> Answer:
    """ "In what order does the ball pass the rug, the sofa and the wall?"."""
    body, found = told.one(), []
    for said in told.frame.options:
        query = named_thing(said)
        met = told.survey.find(query) if query is not None else None
        if query is None or met is None or not met.things:
            raise Untold(f"It is not known what this is: {said}.")
        found.append((first_near(body, met.things, told.timeline), said, met.things[0]))
    found.sort(key=lambda e: e[0])
    text = "; ".join(f"at {at(t)} {told.survey.named(thing)}" for t, _, thing in found)
    return Answer(
        answer=tuple(re.sub(r"^(?:the|a|an) ", "", said) for _, said, _ in found),
        answer_type="list",
        text=f"{cap(body.name)} comes by these: {text}.",
        confidence=0.85,
        evidence=evidence([body], found[0][0], [thing for _, _, thing in found]),
    )


def _of_deed(told: Told) -> Answer | None:
    deed = told.frame.what.deed
    assert deed is not None
    each = [(b, within(told.spans(b), told.window())) for b in told.bodies()]
    found = sorted(((moment(deed, s[0]), b) for b, s in each if s), key=lambda pair: pair[0])
    if not found:
        raise Untold(f"Nothing {verb(told)}.")
    text = listed([f"{b.name} at {at(t)}" for t, b in found])
    return names([b for _, b in found], f"{cap(text)}.", found[0][0])


def story(body: Body, told: Told) -> list[Event]:
    """What a body does, from its first movement to its last."""
    line, found = told.timeline, list[Event]()
    falls = events.falls(body.course, line.unit)
    spins = is_turning(body) and not _opens(body, told)
    for a, b in body.moving:
        if any(f[0] < b and a < f[1] for f in falls):
            found.append((a, f"{body.name} falls", body))
            continue
        if _opens(body, told):
            said = [
                kind
                for kind in ("open", "close")
                if (a, b) in (spans_of(Deed(kind), body, (), line, told.survey) or [])
            ]
            slides = body.course.moving is not None and any(t.kind == "slide" for t in body.course.moving.tracks[:1])
            words = {"open": "slides out" if slides else "opens", "close": "slides back in" if slides else "closes"}
            found.append((a, f"{body.name} {words[said[0]] if said else 'moves'}", body))
            continue
        found.append((a, f"{body.name} starts to {'turn' if spins else 'move'}", body))
        if not spins:
            found += [
                (s[0], f"{body.name} turns {_side(body, s)}", body)
                for s in turning(body)
                if a < s[0] < b and s != (a, b)
            ]
            found += _crossed(body, told, (a, b))
        if b < line.stop - 1e-3:
            found.append((b, f"{body.name} stops", body))
    return found


def _crossed(body: Body, told: Told, span: Span) -> list[Event]:
    """What a body rolls over or reaches on its way."""
    found = list[Event]()
    for thing in told.survey.things:
        if thing.id in (body.group.id, getattr(body.thing, "id", None)):
            continue
        for a, _ in spans_of(Deed("cross"), body, (thing,), told.timeline, told.survey) or []:
            if span[0] < a < span[1]:
                found.append((a, f"{body.name} comes onto {told.survey.named(thing)}", body))
        for a, _ in spans_of(Deed("reach"), body, (thing,), told.timeline, told.survey) or []:
            if span[0] < a <= span[1] and not any(f[1].endswith(f"onto {told.survey.named(thing)}") for f in found):
                found.append((a, f"{body.name} reaches {told.survey.named(thing)}", body))
    if "wall" in told.survey.stage.ids:
        wall = told.survey.at(told.survey.stage.ids.index("wall"))
        for a, _ in spans_of(Deed("reach"), body, (wall,), told.timeline, told.survey) or []:
            if span[0] < a <= span[1]:
                found.append((a, f"{body.name} reaches the wall", body))
    return found


def _side(body: Body, span: Span) -> str:
    return "left" if events.yawed(body.course, span) > 0 else "right"


def _opens(body: Body, told: Told) -> bool:
    """Whether a body opens: a door, a drawer, a lid."""
    kinds = {t.kind for t in body.course.moving.tracks} if body.course.moving is not None else set()
    part = body.thing is None or body.thing.id != body.group.id or is_opened(body.thing.label)
    return part and bool(kinds & {"hinge", "slide"}) and openness(body, told.timeline)[2] > 0


def _does(told: Told) -> Answer | None:
    if told.frame.what.deed is not None or told.frame.what.subject is None:
        return None
    body, window = told.one(), told.window()
    if not body.moving:
        return _text(f"{cap(body.name)} stands still all the time.", "stands still", body, None)
    if window is None:
        found = _stretches(body, told)
        told_each = "; ".join(f"from {at(a)} to {at(b)} {said}" for (a, b), said in found)
        if told.timeline.stop - body.moving[-1][1] > _NEAR_END:
            told_each += "; then it stands still"
        if len(found) == 1:
            return _text(f"{cap(body.name)} {told_each}.", found[0][1], body, found[0][0][0])
        return Answer(
            answer=tuple(said for _, said in found),
            answer_type="list",
            text=f"{cap(body.name)} {told_each}.",
            confidence=0.85,
            frame="viewer",
            evidence=evidence([body], found[0][0][0]),
        )
    now = within(list(body.moving), window)
    if not now:
        return _text(
            f"{cap(body.name)} stands still then; it moves {spoken(body.moving)}.", "stands still", body, window[0]
        )
    span = now[0] if now[0] in body.moving else next(s for s in body.moving if s[0] <= now[0][0] <= s[1])
    said = _doing(body, span, window[0], told)
    return _text(f"{cap(body.name)} {said} then; it moves {spoken(body.moving)}.", said, body, window[0])


def _stretches(body: Body, told: Told) -> list[tuple[Span, str]]:
    """What a body does, one movement after the other: "moves to the right", "turns left", "moves to the bed"."""
    found, opens = list[tuple[Span, str]](), _opens(body, told)
    turns = [] if opens or is_turning(body) else [s for s in turning(body) if s not in body.moving]
    for span in body.moving:
        if found and opens:
            found.append(((found[-1][0][1], span[0]), f"stays {_HELD.get(found[-1][1].split()[0], 'there')}"))
        inside = [s for s in turns if span[0] < s[0] < span[1]]
        ends = [span[0], *(t for s in inside for t in s), span[1]]
        for k, (a, b) in enumerate(pairwise(ends)):
            if b - a < _ABOUT:
                continue
            if k % 2:
                found.append(((a, b), f"turns {_side(body, (a, b))}"))
            else:
                found.append(((a, b), _moves(body, (a, b), told)))
    return found


_HELD = {"opens": "open", "slides": "out", "closes": "closed"}


def _moves(body: Body, span: Span, told: Told) -> str:
    """What a body does in one stretch of its way, with the thing that it gets to, or else the way that it goes."""
    begun = next(((t, said) for t, said, _ in story(body, told) if t == span[0]), (span[0], ""))[1]
    own = begun.removeprefix(f"{body.name} ")
    if own and not own.startswith("starts"):
        return own
    if is_turning(body):
        return "turns"
    met = [said for t, said, _ in _crossed(body, told, span) if " reaches " in said and t > span[1] - _NEAR_END]
    goal = f"to {met[-1].split(' reaches ')[1]}" if met else direction(body, span, told)
    return f"{_gait(body)} {goal}"


def _gait(body: Body) -> str:
    """How a body goes along: what bobs on its way walks, what turns about its way rolls."""
    if len(steps(body)) > 1:
        return "walks"
    yaw = sum(abs(events.yawed(body.course, span)) for span in body.moving)
    return "rolls" if events.turned(body.course) - yaw > TURNS else "moves"


def _doing(body: Body, span: Span, time: float, told: Told) -> str:
    """What a body does in one of its movements."""
    if any(a <= span[1] and span[0] <= b for a, b in events.falls(body.course, told.timeline.unit)):
        return "falls"
    if _opens(body, told):
        opening = span in (spans_of(Deed("open"), body, (), told.timeline, told.survey) or [])
        return "opens" if opening else "closes"
    if is_turning(body):
        return "turns"
    if any(a <= time <= b for a, b in turning(body)) and turning(body) != list(body.moving):
        return f"turns {_side(body, turning(body)[0])}"
    return f"{_gait(body)} {direction(body, (max(span[0], time - 0.25), min(span[1], time + 0.25)), told)}"


def _text(text: str, answer: str, body: Body, time: float | None) -> Answer:
    return Answer(
        answer=answer, answer_type="text", text=text, confidence=0.85, frame="viewer", evidence=evidence([body], time)
    )


ORDER = kind("what_happens", "order", _order)
DOES = kind("what_it_does", "does", _does)

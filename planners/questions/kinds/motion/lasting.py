"""How long something lasts: "how long does the door take to open?", "how much time is there between the two falls?"."""

from __future__ import annotations

import math

import numpy as np

from .....gaussians import late_re as re
from .....gaussians.motion import events
from .....gaussians.motion.holding import Span
from ...answer import Answer
from ...kind import Asked, Kind
from ...reading.phrase_templates import templates
from ...reading.time.deeds import AT_ONCE
from ...reading.time.happenings import Happening
from ...survey import Survey
from ...timeline.asked import PLACES, Told, Untold, agreed, at, cap, kind, number, spoken, verb, within
from ...timeline.bodies import Body
from ...timeline.happening import steps
from .when import COUNTED_TURNS, moment, turns_of

_ONCE = re.compile(r"\bonce\b")
_SOON = 1e-3  # seconds: what is so soon after another thing happens with it
_WAITS = (
    "wait",
    "waits",
    "waiting",
    "waited",
    "rest",
    "rests",
    "pause",
    "pauses",
    "paused",
    "idle",
    "idles",
    "pausing",
)


def _long(told: Told) -> Answer | None:
    if told.frame.what.deed is None:
        return None
    return agreed(told, lambda body: _of_one(told, body))


def _of_one(told: Told, body: Body) -> Answer:
    deed, when = told.frame.what.deed, told.frame.when
    assert deed is not None
    found = told.spans(body)
    counted = COUNTED_TURNS.search(told.asked.said)
    if deed.kind == "turn" and counted is not None and events.turned(body.course) > 2 * math.pi:
        turns = turns_of(counted)
        seconds = turns * sum(b - a for a, b in found) * 2 * math.pi / events.turned(body.course)
        return number(seconds, "s", f"{at(seconds)}: {body.name} turns {turns:g} times in that time.", [body])
    if deed.kind == "bob" and _ONCE.search(told.asked.said) and len(risen := steps(body)) > 1:
        seconds = float(np.diff(risen).mean())
        return number(seconds, "s", f"{at(seconds)}: {body.name} bobs {len(risen)} times.", [body], float(risen[0]))
    if when is not None:
        found = within(found, told.window())
        found = found[-1:] if deed.kind == "still" and when.conj == "before" else found
    if told.frame.rank in PLACES and found:  # "how long does the second movement last"
        place = PLACES[told.frame.rank]
        if place >= len(found):
            raise Untold(f"That happens {len(found)} times only.")
        found = [found[place]]
    if not found:
        raise Untold(cap(f"{body.name} never {verb(told)}."))
    if (
        when is not None and when.kind == "after" and deed.at_once and not deed.starts
    ):  # "how long after 2 s does it stop"
        time = moment(deed, found[0])
        return number(
            time - when.start, "s", f"{at(time - when.start)}: {body.name} {verb(told)} at {at(time)}.", [body], time
        )
    if deed.kind in AT_ONCE or (deed.kind == "move" and deed.phase):
        return _way_to(told, body, found)
    if deed.kind == "still" and deed.verb in _WAITS and when is None and len(inner := _inner(found, told)) >= 1:
        found = inner
    seconds = sum(b - a for a, b in found)
    text = f"{at(seconds)}: {body.name} {verb(told)} {spoken(found)}."
    return number(seconds, "s", text, [body], found[0][0], others=told.others())


def _inner(found: list[Span], told: Told) -> list[Span]:
    """The rests between movements, not those at the start and the end of the scene."""
    line = told.timeline
    return [s for s in found if s[0] > line.start + 1e-3 and s[1] < line.stop - 1e-3]


def _way_to(told: Told, body: Body, found: list[Span]) -> Answer:
    """From when it begins to move to what happens at once: reaching, landing, stopping."""
    deed = told.frame.what.deed
    assert deed is not None
    time = moment(deed, found[-1] if deed.stops else found[0])
    begun = [a for a, _ in body.moving if a < time]
    if not begun:
        raise Untold(f"{cap(body.name)} does not move before that.")
    start = begun[-1] if not deed.stops else begun[0]
    text = f"{at(time - start)}: {body.name} starts to move at {at(start)} and {verb(told)} at {at(time)}."
    return number(time - start, "s", text, [body], time, others=told.others())


def _between(told: Told) -> Answer | None:
    first, second = told.frame.what, told.frame.other
    if second is None or (first.deed is None and second.deed is None):
        return None
    times, bodies = list[float](), list[Body]()
    for what in (first, second):
        body, found = told.nth(what) if what.nth else (told.one(what), [])
        found = found or told.spans(body, what)
        if not found:
            raise Untold(cap(f"{body.name} never {verb(told, what)}."))
        deed = what.deed or (first.deed or second.deed)
        assert deed is not None
        own = [moment(deed, span) for span in found]
        behind = [time for time in own if times and time > times[0] + _SOON]
        times.append(behind[0] if behind and not deed.stops else own[-1] if deed.stops else own[0])
        bodies.append(body)
    if bodies[0] is bodies[1] and times[0] == times[1]:
        return None  # one happening is read twice
    apart = abs(times[1] - times[0])
    said = [f"{_who(b, w)} {verb(told, w)} at {at(t)}" for b, w, t in zip(bodies, (first, second), times, strict=True)]
    return number(apart, "s", f"{at(apart)}: {said[0]} and {said[1]}.", bodies, min(times))


def _who(body: Body, what: Happening) -> str:
    return "the film" if what.deed is not None and what.deed.kind == "scene" else body.name


def _clip(asked: Asked, survey: Survey) -> Answer | None:
    if asked.timeline is None:
        return None
    seconds = asked.timeline.stop - asked.timeline.start
    return number(seconds, "s", f"The scene lasts {at(seconds)}.", [])


_CLIPS = """
    how long (is|does|lasts) [the|this] (film|clip|video|scene|recording|animation|shot|movie|sequence|footage) \
        [last|take|run|long]
    [what is] [the] (length|duration) of [the|this] (film|clip|video|scene|recording|animation|shot|movie|sequence|\
        footage)
"""
CLIP = Kind("how_long_the_scene", templates(_CLIPS), _clip)
LONG = kind("how_long", "how_long", _long)
BETWEEN = kind("between_events", "between", _between)

"""Where things go: "where does the ball stop?", "which way does the robot turn?"."""

from __future__ import annotations

import re

import numpy as np

from .....gaussians.motion import events
from .....gaussians.motion.holding import Span
from ...answer import Answer, Evidence
from ...kind import Undecided
from ...placing import place_of
from ...timeline.asked import Told, Untold, at, cap, during, evidence, kind, within
from ...timeline.bodies import Body
from ...timeline.happening import turning
from .speeds import is_turning
from .when import changes, moment

_LEG = 0.5  # seconds that tell which way something goes at first or in the end
_OBLIQUE = 0.45  # of the larger part of a way: from here on the smaller part is told too
_ORIGIN = re.compile(r"\bfrom where\b|\bwhere\b.*\b(?:from|start|starts|begin|begins|set off|starting)\b")


def direction(body: Body, span: Span, told: Told) -> str:
    """The way of a body in a span, in the viewer's frame: "to the left", "away from you", "down"."""
    stand = told.timeline.stand
    way = events.displacement(body.course, span)
    parts = {
        "up" if way @ stand.up > 0 else "down": abs(float(way @ stand.up)),
        "to the right" if way @ stand.right > 0 else "to the left": abs(float(way @ stand.right)),
        "away from you" if way @ stand.forward > 0 else "towards you": abs(float(way @ stand.forward)),
    }
    ordered = sorted(parts.items(), key=lambda part: -part[1])
    said = [name for name, length in ordered if length > _OBLIQUE * ordered[0][1]]
    return " and ".join(said[:2])


def _way(told: Told) -> Answer | Undecided | None:
    deed = told.frame.what.deed
    if deed is None:
        return None
    body, window = told.one(), told.window()
    if not body.moving:
        raise Untold(cap(f"{body.name} does not move."))
    turns = deed.kind == "turn" and told.frame.options not in (("up", "down"), ("down", "up"))
    every = turning(body) if turns else list(body.moving)
    spans = within(every, window) if told.frame.when is None or told.frame.when.kind not in ("start", "end") else every
    kind = told.frame.when.kind if told.frame.when is not None else ""
    if kind in ("start", "end") and spans:  # "at first", "at the end": how it begins, or how it ends
        a, b = body.moving[0 if kind == "start" else -1]
        spans = [(a, min(a + _LEG, b)) if kind == "start" else (max(b - _LEG, a), b)]
    elif window is not None and window[0] == window[1]:
        near = [(max(a, window[0] - 0.1), min(b, window[0] + 0.1)) for a, b in body.moving]
        spans = [s for s in near if s[0] < s[1]]
    if not spans:
        raise Untold(cap(f"{body.name} does not {'turn' if turns else 'move'}{' then' if window is not None else ''}."))
    span = (spans[0][0], spans[-1][1]) if deed.kind not in ("open", "close") and not deed.starts else spans[0]
    if turns:
        left = events.yawed(body.course, span) > 0
        if is_turning(body):
            said = "counterclockwise" if left else "clockwise"
            text = f"{cap(body.name)} turns {said} as seen from above."
        else:
            said = "left" if left else "right"
            text = f"{cap(body.name)} turns to its {said} {during(span)}."
        return Answer(
            answer=said,
            answer_type="label",
            text=text,
            confidence=0.9,
            frame="object",
            evidence=evidence([body], span[0]),
        )
    if (
        is_turning(body)
        and deed.kind == "move"
        and float(np.linalg.norm(events.displacement(body.course, span))) < 0.05
    ):
        raise Untold(cap(f"{body.name} turns in its place."))
    said = direction(body, span, told)
    chosen = said
    if told.frame.options:
        fits = [o for o in told.frame.options if _fits(o, body, span, told)]
        if len(fits) != 1:
            raise Untold(f"{cap(body.name)} moves {said}.")
        chosen = fits[0]
    chosen = chosen.removeprefix("to the ")
    return Answer(
        answer=chosen,
        answer_type="label",
        text=f"{cap(body.name)} moves {said}, as you see it, {during(span)}.",
        confidence=0.9,
        frame="viewer",
        evidence=evidence([body], span[0]),
    )


def _fits(option: str, body: Body, span: Span, told: Told) -> bool:
    """Whether a body moves in one of two ways that are offered."""
    stand, way = told.timeline.stand, events.displacement(body.course, span)
    ways = {
        "left": -way @ stand.right,
        "right": way @ stand.right,
        "up": way @ stand.up,
        "down": -way @ stand.up,
        "forward": -way @ stand.forward,
        "backward": way @ stand.forward,
        "toward me": -way @ stand.forward,
        "towards me": -way @ stand.forward,
        "away from me": way @ stand.forward,
        "away": way @ stand.forward,
    }
    plain = option.removesuffix("s") if option in ("forwards", "backwards") else option
    if plain not in ways:
        return False
    return float(ways[plain]) > 0.02 * told.timeline.unit


def _where(told: Told) -> Answer | Undecided | None:
    deed = told.frame.what.deed
    if deed is None and (told.frame.when is None or told.frame.what.subject is None):
        return None
    body, said = told.one(), told.asked.said
    if body.thing is None or (deed is None and not body.moving):
        return None  # the scene at that time tells it
    if deed is None:
        span = told.window()
        if span is None or told.frame.when.kind in ("ever", "always"):  # type: ignore[union-attr]
            return None
        time = (span[0] + span[1]) / 2
    elif _ORIGIN.search(said) and not deed.stops and deed.kind != "land":
        time = told.timeline.start
    elif deed.kind in ("move", "fall", "turn") and not deed.stops:
        window = told.window()
        time = window[1] if window is not None else told.timeline.stop
    else:
        found = changes(told, body)
        if not found:
            raise Untold(cap(f"{body.name} does not do that."))
        time = moment(deed, found[-1] if deed.stops else found[0])
    survey = told.timeline.survey_at(time)
    thing = survey.thing(body.thing.id)
    place, rest = place_of(thing, survey)
    if not place.startswith("on ") and _is_on_floor(body, time, told):
        place, rest = "on the floor", f"{place}{', ' + rest if rest else ''}"
    text = f"At {at(time)}: {cap(body.name)} is {place}{', ' + rest if rest else ''}."
    near = [i for i in (thing.node.support if thing.node is not None else "",) if isinstance(i, int)]
    answer = f"{place}, {rest}" if rest else place
    return Answer(
        answer=answer,
        answer_type="text",
        text=text,
        confidence=0.85,
        frame="viewer",
        evidence=Evidence(ids=(body.thing.id, *near), time=time),
    )


def _is_on_floor(body: Body, time: float, told: Told) -> bool:
    """Whether it lies on the floor at a time."""
    floors = [g.id for g in told.timeline.scene.language.groups if g.level == "structure" and g.label == "floor"]  # type: ignore[union-attr]
    at_time = np.array([time])
    gaps = [float(events.Encounter.of(told.timeline.scene, body.group.id, [f]).gaps(at_time)[0]) for f in floors]
    return bool(gaps) and min(gaps) < events.TOUCHES * told.timeline.unit


WAY = kind("which_way_it_moves", "which_way", _way)
WHERE = kind("where_it_goes", "where", _where)

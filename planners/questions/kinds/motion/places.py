"""Where things go: "where does the ball stop?", "which way does the robot turn?"."""

from __future__ import annotations

import numpy as np

from .....gaussians import late_re as re
from .....gaussians.motion import events
from .....gaussians.motion.holding import Span
from .....gaussians.world.support import is_sheet
from ...answer import Answer, Evidence
from ...candidates import is_plural
from ...kind import Undecided
from ...placing import place_of
from ...reading.time.deeds import Deed
from ...survey import Thing
from ...timeline.asked import Told, Untold, at, cap, during, evidence, kind, within
from ...timeline.bodies import Body
from ...timeline.happening import spans_of, turning
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
    turns = "clockwise" in " ".join(told.frame.options) or (
        deed.kind == "turn" and told.frame.options not in (("up", "down"), ("down", "up"))
    )
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
    plain = (
        option.removesuffix("s")
        if option in ("forwards", "backwards")
        else re.sub(r" (?:us|you|the viewer)$", " me", option)
    )
    if plain not in ways:
        return False
    return float(ways[plain]) > 0.02 * told.timeline.unit


def _where(told: Told) -> Answer | Undecided | None:
    subject = told.frame.what.subject
    if told.frame.what.deed is None and (told.frame.when is None or subject is None):
        return None
    bodies = told.bodies() if subject is not None and is_plural(subject) else (told.one(),)
    if any(b.thing is None or (told.frame.what.deed is None and not b.moving) for b in bodies):
        return None  # the scene at that time tells it
    times = [_time_of(told, b) for b in bodies]
    if not times or None in times:
        return None
    placed = [_place(told, b, t) for b, t in zip(bodies, times, strict=True) if t is not None]
    return Answer(
        answer="; ".join(dict.fromkeys(answer for answer, _, _ in placed)),
        answer_type="text",
        text=" ".join(text for _, text, _ in placed),
        confidence=0.85,
        frame="viewer",
        evidence=Evidence(ids=tuple(dict.fromkeys(i for _, _, ids in placed for i in ids)), time=times[0]),
    )


def _time_of(told: Told, body: Body) -> float | None:
    """The time at which a place is asked of: of the deed, or as it is said."""
    deed, window = told.frame.what.deed, told.window()
    if deed is None:
        return None if window is None else (window[0] + window[1]) / 2
    if _ORIGIN.search(told.asked.said) and not deed.stops and deed.kind != "land":
        return told.timeline.start
    if deed.kind in ("move", "fall", "turn") and not deed.stops:
        return window[1] if window is not None else told.timeline.stop
    if not (found := changes(told, body)):
        raise Untold(cap(f"{body.name} does not do that."))
    return moment(deed, found[-1] if deed.stops else found[0])


def _place(told: Told, body: Body, time: float) -> tuple[str, str, tuple[int, ...]]:
    """Where a body is at a time: as an answer, as a sentence, and the ids of it and of what it is on."""
    assert body.thing is not None
    survey = told.timeline.survey_at(time)
    if body.thing.id not in survey.stage.ids:
        raise Untold(f"{cap(body.name)} is not to be seen at {at(time)}.")
    thing = survey.thing(body.thing.id)
    place, rest = place_of(thing, survey)
    sheet = _sheet_under(body, time, told)
    if sheet is not None:
        place, rest = f"on {survey.named(sheet)}", f"{place}{', ' + rest if rest else ''}"
    elif not place.startswith("on ") and _is_on_floor(body, time, told):
        place, rest = "on the floor", f"{place}{', ' + rest if rest else ''}"
    rest = rest.removeprefix(place).strip(" ,")
    answer = f"{place}, {rest}" if rest else place
    support = thing.node.support if thing.node is not None else ""
    ids = tuple(i for i in (body.thing.id, support) if isinstance(i, int))
    return answer, f"At {at(time)}: {cap(body.name)} is {answer}.", ids


def _sheet_under(body: Body, time: float, told: Told) -> Thing | None:
    """The rug, or other sheet, that it is on at a time."""
    for thing in told.survey.things:
        if thing.node is not None and thing.id != body.group.id and is_sheet(thing.group.box.size):
            on = spans_of(Deed("related", relation="on"), body, (thing,), told.timeline, told.survey) or []
            if any(a <= time <= b for a, b in on):
                return thing
    return None


def _is_on_floor(body: Body, time: float, told: Told) -> bool:
    """Whether it lies on the floor at a time."""
    floors = [g.id for g in told.timeline.scene.language.groups if g.level == "structure" and g.label == "floor"]  # type: ignore[union-attr]
    at_time = np.array([time])
    gaps = [float(events.Encounter.of(told.timeline.scene, body.group.id, [f]).gaps(at_time)[0]) for f in floors]
    return bool(gaps) and min(gaps) < events.TOUCHES * told.timeline.unit


WAY = kind("which_way_it_moves", "which_way", _way)
WHERE = kind("where_it_goes", "where", _where)

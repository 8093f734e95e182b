"""How fast, how far and how often things move: "how fast does the fan turn?", "how far does the ball roll?"."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .....gaussians import late_re as re
from .....gaussians.motion import events
from .....gaussians.motion.holding import Span
from .....gaussians.world.lengths import METRES
from ...answer import Answer
from ...reading.time.deeds import AT_ONCE, Deed
from ...reading.time.moments import When
from ...timeline.asked import Told, Untold, agreed, at, cap, during, kind, names, number, spoken, verb, within, yes_no
from ...timeline.bodies import Body
from ...timeline.happening import MOMENT, STEP, bobs, hinged, opened, peak, steps
from .when import moment

F64 = NDArray[np.float64]
_PER_SECOND = {  # by the first letters of a unit: its sign, and how many of it are a metre a second
    "km": ("km/h", 3.6),
    "kph": ("km/h", 3.6),
    "kilo": ("km/h", 3.6),
    "mph": ("mph", 2.2369363),
    "miles": ("mph", 2.2369363),
    "cm": ("cm/s", 100.0),
    "centi": ("cm/s", 100.0),
    "m": ("m/s", 1.0),
}
_LENGTHS = {
    "mm": ("mm", 1000.0),
    "milli": ("mm", 1000.0),
    "cm": ("cm", 100.0),
    "centi": ("cm", 100.0),
    "f": ("ft", 1 / METRES["ft"]),
    "inch": ("in", 1 / METRES["in"]),
    "y": ("yd", 1 / (3 * METRES["ft"])),
    "k": ("km", 1e-3),
    "m": ("m", 1.0),
}
_TURNS = re.compile(
    r"turns?|rotations?|revolutions?|revs?|rounds?|spins?|cycles?|rot|rpm|rps|r p m|hz|hertz|deg|degs|degrees?|rad|"
    r"radians?"
)
_NET = re.compile(
    r"\b(?:as the crow flies|net|displacement|from where (?:it|he|she) (?:started|starts|began)|(?:straight|bee|air) "
    r"?-?line|beeline|"
    r"from (?:its|the) (?:start|starting|initial|first|original) (?:position|point|place|spot|one) to)\b|"
    r"\b(?:finishing|final|end|stopping|last) (?:spot|position|place|point) from (?:its|the) "
    r"(?:start|initial|first|original)",
    re.IGNORECASE,
)
_TOTAL = re.compile(r"\b(?:total|altogether|all together|overall)\b", re.IGNORECASE)
_SPINS = math.radians(340)  # what turns by more in its place is told in turns, what turns by less in degrees


def is_turning(body: Body) -> bool:
    """Whether a body turns in its place or on a hinge, so that its speed is one of turning."""
    kinds = {t.kind for t in body.course.moving.tracks} if body.course.moving is not None else set()
    if kinds & {"spin", "hinge"}:
        return True
    way = events.path_length(body.course)
    angle = events.turned(body.course)
    return angle > math.radians(30) and way < 0.3 * angle * max(body.group.box.size[:2]) / 2


def _spans(told: Told, body: Body) -> list[Span]:
    """The spans over which a speed is taken: those of the deed, or of the time that is asked of."""
    window = told.window()
    deed = told.frame.what.deed
    if deed is not None and deed.kind in ("is_open", "is_closed"):  # "is drawn out"
        opens = Deed("open" if deed.kind == "is_open" else "close")
        told = replace(told, frame=replace(told.frame, what=replace(told.frame.what, deed=opens)))
        deed = opens
    found = (
        list(body.moving)
        if deed is None or deed.kind in AT_ONCE or (deed.kind == "move" and deed.phase)
        else told.spans(body)
    )
    when = told.frame.when
    if window is not None and window[0] < window[1] and when is not None and when.kind in ("span", "last", "after"):
        return [window]  # the mean over a time that is given in seconds
    found = within(found, window) if window is not None else found
    if not found:
        if body.moving and window is not None:
            return [window]
        raise Untold(cap(f"{body.name} does not move{' then' if window is not None else ''}."))
    return found


def _fast(told: Told) -> Answer | None:
    if (
        told.frame.what.deed is None
        and told.frame.what.subject is None
        and not told.frame.unit
        and not told.frame.measure
    ):
        return None
    return agreed(told, lambda body: _fast_one(told, body))


def _fast_one(told: Told, body: Body) -> Answer:
    unit, deed = told.frame.unit, told.frame.what.deed
    if not body.moving:
        raise Untold(cap(f"{body.name} does not move."))
    turning = is_turning(body)
    if unit:
        turning = _TURNS.match(unit) is not None
    elif told.frame.measure == "angular" or (deed is not None and deed.kind == "turn"):
        turning = True
    window = told.window()
    now = window[0] if window is not None and window[0] == window[1] else None
    if now is not None and told.frame.when is not None and told.frame.when.kind == "clause":
        now -= MOMENT / 4  # "when it hits the floor": it still moves
    return _turning(told, body, now) if turning else _going(told, body, now)


def _going(told: Told, body: Body, now: float | None) -> Answer:
    """A speed along a way."""
    key = next((k for k in _PER_SECOND if told.frame.unit.startswith(k)), "m")
    sign, factor = _PER_SECOND[key]
    per = factor / told.timeline.unit
    if now is not None:
        around = (max(now - MOMENT / 4, told.timeline.start), min(now + MOMENT / 4, told.timeline.stop))
        speed = float(events.speeds(body.course, body.course.grid(around, STEP)).mean()) * per
        return number(speed, sign, f"At {at(now)} {body.name} moves at {_short(speed)} {sign}.", [body], now)
    found = _spans(told, body)
    way, seconds = sum(events.path_length(body.course, s) for s in found), sum(b - a for a, b in found)
    top, fastest = max(peak(body, s) for s in found)
    top *= per
    mean = way * per / max(seconds, 1e-9)
    if told.frame.measure == "top":
        return number(
            top, sign, f"{cap(body.name)} moves at {_short(top)} {sign} at most, at {at(fastest)}.", [body], fastest
        )
    text = (
        f"{cap(body.name)} moves at {_short(mean)} {sign} on average {spoken(found)}, at most at {_short(top)} {sign}."
    )
    return number(mean, sign, text, [body], found[0][0])


def _turning(told: Told, body: Body, now: float | None) -> Answer:
    """A speed of turning."""
    unit = told.frame.unit
    if unit.startswith("rad"):
        sign, factor = "rad/s", 1.0
    elif unit.startswith("deg"):
        sign, factor = "deg/s", 180 / math.pi
    elif unit in ("rpm", "r p m") or "min" in unit:
        sign, factor = "rpm", 30 / math.pi
    elif unit or events.turned(body.course) > _SPINS:
        sign, factor = "turns/s", 0.5 / math.pi
    else:
        sign, factor = "deg/s", 180 / math.pi
    if now is not None:
        rate = float(np.linalg.norm(body.course.turns(np.array([now]))[0])) * factor
        return number(rate, sign, f"At {at(now)} {body.name} turns at {_short(rate)} {sign}.", [body], now)
    found = _spans(told, body)
    times = np.concatenate([body.course.grid(s) for s in found])
    top = float(np.linalg.norm(body.course.turns(times), axis=1).max()) * factor
    mean = sum(events.turned(body.course, s) for s in found) * factor / max(sum(b - a for a, b in found), 1e-9)
    value = top if told.frame.measure == "top" else mean
    text = (
        f"{cap(body.name)} turns at {_short(mean)} {sign} on average {spoken(found)}, at most at {_short(top)} {sign}."
    )
    return number(value, sign, text, [body], found[0][0])


_SLIDES = {"close": "closes", "move": "moves"}


def _far(told: Told) -> Answer | None:
    told = _so_far(told)
    what = told.frame.what
    if what.deed is None and what.subject is not None and re.search(r"\b(?:opening|angle)\b", told.asked.said):
        opened_by = replace(told.frame, what=replace(what, deed=Deed("open")))
        told = replace(told, frame=opened_by)
    if told.frame.what.deed is None:
        return None
    if told.frame.measure == "nearest":
        return _nearest(told)
    return agreed(told, lambda body: _far_one(told, body))


def _so_far(told: Told) -> Told:
    """The question with the time up to a moment, where it asks what has been done after some seconds."""
    when = told.frame.when
    if when is None or when.kind != "after" or not re.search(r"\b(?:has|have|had)\b", told.asked.said):
        return told
    return replace(told, frame=replace(told.frame, when=When("span", told.timeline.start, when.start)))


def _nearest(told: Told) -> Answer | None:
    """How near a body comes to another thing: the least gap between them."""
    body, others = told.one(), told.others()
    gaps = [
        events.nearest_gap(told.timeline.scene, body.group.id, group)
        for thing in others
        for group in told.timeline.groups(thing)
    ]
    if not gaps or not body.moving:
        return None
    time, gap = min(gaps, key=lambda g: g[1])
    said = f"at {at(time)}, when it is nearest, {body.name} is away from {told.survey.named(others[0])} by"
    return _length(told, body, max(gap, 0.0), said, None)


def _far_one(told: Told, body: Body) -> Answer:
    deed, unit = told.frame.what.deed, told.frame.unit
    assert deed is not None
    if deed.kind == "still" or not body.moving:
        raise Untold(cap(f"{body.name} does not move."))
    said = " ".join(told.asked.words)
    if deed.kind == "bob":
        return _length(told, body, bobs(body), f"{body.name} goes up and down by", None)
    window = told.window()
    if window is not None and window[0] == window[1] and deed.kind in ("is_open", "open"):
        return _open_at(told, body, window[0])
    found = within(
        told.spans(body) if deed.kind in ("open", "close", "fall", "turn", "move", "cross") else list(body.moving),
        window,
    )
    if window is not None and window[0] == window[1] and deed.kind not in ("is_open",):
        found = within(list(body.moving), (told.timeline.start, window[0]))
    if not found and deed.kind not in ("is_open", "is_closed"):
        raise Untold(cap(f"{body.name} does not move then."))
    angle = unit.startswith(("deg", "rad")) or (
        not unit and deed.kind in ("open", "close", "is_open", "turn") and hinged(body)
    )
    if angle:
        return _angle(told, body, found, unit)
    slides = body.course.moving is not None and {t.kind for t in body.course.moving.tracks} == {"slide"}
    if (deed.kind in ("open", "close", "is_open") and not hinged(body)) or (
        deed.kind == "move" and slides and window is None and not _TOTAL.search(told.asked.text)
    ):
        away = float(np.ptp(opened(body, np.array([t for s in found for t in s] or [body.course.start]))))
        away = away or float(opened(body, body.course.grid()).max())
        return _length(
            told,
            body,
            away,
            f"{body.name} {_SLIDES.get(deed.kind, 'opens')} by",
            found[0] if found else None,
        )
    if deed.kind in ("fall", "land") or re.match(r"(?:and )?(?:from |by )*(?:how|what) (?:high|height|deep)", said):
        fall = (events.falls(body.course, told.timeline.unit) or list(body.moving))[0]
        rise = float(events.displacement(body.course, fall) @ body.course.up)
        return _length(told, body, abs(rise), f"{body.name} {'rises' if rise > 0 else 'falls'} by", fall)
    if deed.kind in ("reach", "land", "enter", "leave", "pass") and (to := told.spans(body)):
        found = within(list(body.moving), (told.timeline.start, to[0][0])) or found
    if _NET.search(told.asked.text):
        net = float(np.linalg.norm(events.displacement(body.course, (found[0][0], found[-1][1]))))
        return _length(
            told, body, net, f"{body.name} ends up away from where it started by", (found[0][0], found[-1][1])
        )
    way = sum(events.path_length(body.course, s) for s in found)
    return _length(told, body, way, f"{body.name} moves by", found[0])


def _open_at(told: Told, body: Body, time: float) -> Answer:
    """How far a body is open at a time: degrees of what hangs on hinges, metres of what slides."""
    away = float(opened(body, np.array([time]))[0])
    if not hinged(body):
        return _length(told, body, away, f"at {at(time)} {body.name} is open by", None)
    return number(
        math.degrees(away),
        "deg",
        f"At {at(time)} {body.name} is open by {math.degrees(away):.0f} degrees.",
        [body],
        time,
    )


def _length(told: Told, body: Body, length: float, said: str, span: Span | None) -> Answer:
    key = next((k for k in _LENGTHS if told.frame.unit.startswith(k)), "m")
    sign, factor = _LENGTHS[key]
    value = length * factor / told.timeline.unit
    metres = length / told.timeline.unit
    shown = f"{_short(value)} {sign}" if sign != "m" or metres >= 0.1 else f"{metres * 100:.1f} cm"
    more = f" {during(span)}" if span is not None else ""
    return number(value, sign, f"{cap(said)} {shown}{more}.", [body], span[1] if span is not None else None)


def _angle(told: Told, body: Body, found: list[Span], unit: str) -> Answer:
    deed = told.frame.what.deed
    assert deed is not None
    if deed.kind in ("turn", "move") and not hinged_track(body):
        value = sum(abs(events.yawed(body.course, s)) for s in found) or sum(
            events.turned(body.course, s) for s in found
        )
    else:
        ends = np.array([t for s in found for t in s] or [told.timeline.start])
        value = float(np.ptp(opened(body, ends))) or float(opened(body, body.course.grid()).max())
    if deed.kind == "turn" and events.turned(body.course) > _SPINS:
        value = sum(events.turned(body.course, s) for s in found)
    sign, factor = ("rad", 1.0) if unit.startswith("rad") else ("deg", 180 / math.pi)
    shown = f"{value * factor:.1f}".rstrip("0").rstrip(".")
    text = f"{cap(body.name)} turns by {shown} {'degrees' if sign == 'deg' else 'rad'} {spoken(found)}."
    return number(value * factor, sign, text, [body], found[0][1] if found else None)


def hinged_track(body: Body) -> bool:
    """Whether it is known to turn on a hinge."""
    return body.course.moving is not None and any(t.kind == "hinge" for t in body.course.moving.tracks)


def _rounds(told: Told, body: Body) -> bool:
    """Whether a count is one of full turns: of what spins, and of what is said to turn as it rolls."""
    deed = told.frame.what.deed
    says_turn = deed is not None and deed.kind == "turn"
    return events.turned(body.course) > _SPINS and (says_turn or is_turning(body))


def _often(told: Told) -> Answer | None:
    told = _so_far(told)
    deed = told.frame.what.deed
    said = " ".join(told.asked.words)
    body = told.one()
    if deed is not None and deed.kind == "bob" and len(risen := _within(steps(body), told.window())):
        text = f"{len(risen)} times: {body.name} bobs {spoken(list(body.moving))}."
        return number(float(len(risen)), "", text, [body], float(risen[0]))
    counts_turns = re.search(
        r"\b(?:turns?|rotations?|revolutions?|spins?|rounds?|circles?|laps|loops|cycles|revs|twists)\b", said
    )
    if (deed is None or deed.kind in ("turn", "move")) and _rounds(told, body):
        found = within(list(body.moving), told.window())
        turns = sum(events.turned(body.course, s) for s in found) / (2 * math.pi)
        return number(turns, "", f"{cap(body.name)} makes {_short(turns)} turns {spoken(found)}.", [body], None)
    if deed is None and not counts_turns:
        return None
    if counts_turns and (deed is None or deed.kind == "move"):
        from ...timeline.happening import turning

        found = turning(body)
    else:
        found = told.spans(body)
        if deed is not None and deed.stops:
            found = [s for s in found if s[1] < told.timeline.stop - 1e-3]
    found = within(found, told.window())
    times = f"{len(found)} time{'s' if len(found) != 1 else ''}"
    return number(float(len(found)), "", f"{times}: {spoken(found)}.", [body], found[0][0] if found else None)


def _within(times: F64, window: Span | None) -> F64:
    return times if window is None else times[(times >= window[0]) & (times <= window[1])]


def _faster(told: Told) -> Answer | None:
    first, second = told.frame.what, told.frame.other
    if told.frame.than is not None:
        return _at_two_times(told)
    if second is None:
        return None
    bodies = [told.one(first), told.one(second)]
    if told.frame.rank in ("first", "last"):
        return _earlier(told, bodies)
    tops = [float(events.speeds(b.course, b.course.grid()).max()) / told.timeline.unit for b in bodies]
    best = int(np.argmin(tops) if told.frame.rank == "slower" else np.argmax(tops))
    if abs(tops[0] - tops[1]) < 0.03 * max(*tops, 1e-9):
        raise Untold(f"Both move at {_short(tops[0])} m/s at most.")
    text = (
        f"{cap(bodies[best].name)} moves at {_short(tops[best])} m/s at most, {bodies[1 - best].name} at "
        f"{_short(tops[1 - best])} m/s."
    )
    return names([bodies[best]], text, single=True)


def _at_two_times(told: Told) -> Answer | None:
    """ "Is the ball faster at 1 s than at 3 s?"."""
    frame = replace(told.frame, rank="", than=None)
    deed = frame.what.deed
    if deed is not None and deed.kind not in ("move", "turn", "fall", "open", "close"):
        return None
    both = [
        _fast_one(replace(told, frame=replace(frame, when=when)), told.one()) for when in (frame.when, told.frame.than)
    ]
    first, second = (float(a.answer) for a in both if isinstance(a.answer, float))
    holds = first < second if told.frame.rank == "slower" else first > second
    return yes_no(holds, " ".join(a.text for a in both), [told.one()], both[0].evidence.time)


def _earlier(told: Told, bodies: list[Body]) -> Answer:
    """Which of two does it first, or last."""
    deeds, times = [], []
    for body, what in zip(bodies, (told.frame.what, told.frame.other), strict=True):
        if what is None or what.deed is None or not (found := told.spans(body, what)):
            raise Untold(cap(f"{body.name} never {verb(told, what)}."))
        times.append(moment(what.deed, found[0]))
        deeds.append(f"{body.name} {verb(told, what)} at {at(times[-1])}")
    best = int(np.argmin(times) if told.frame.rank == "first" else np.argmax(times))
    return names([bodies[best]], cap(f"{'; '.join(deeds)}."), times[best], single=True)


def _short(value: float) -> str:
    return f"{value:.0f}" if value >= 100 else f"{value:.1f}" if value >= 10 else f"{value:.2f}"


FAST = kind("how_fast", "how_fast", _fast)
FAR = kind("how_far_moved", "how_far", _far)
OFTEN = kind("how_often", "how_often", _often)
FASTER = kind("which_is_faster", "faster", _faster)

"""When what moves begins and ends, and how fast it is: the commands of such wishes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from .....gaussians import late_re as re
from .....tools.when import Part
from ...vocabulary.nouns import is_opened
from ..command import pace
from ..happenings import IT
from ..moments import Moment
from .moves import move
from .orders import ordered
from .slots import Slots
from .wanted import Wanted, now, paced, plainly, whose_of

SLOWER = re.compile(
    r"\b(?:slow\w*|calm\w*|gentl\w+|lazy|lazily|leisurely|brake|reduce\w*|less|lower|lessen|decelerat\w+|snail\w*|"
    r"drag\w*|"
    r"sluggish\w*|crawl\w*|slo|longer|long)\b"
)

_FASTER = re.compile(
    r"\b(?:fast\w*|quick\w*|speed\w*|hurr\w+|rush\w*|snapp\w+|brisk\w*|zip\w*|accelerat\w+|rapid\w*|swift\w*|pace|"
    r"rate|"
    r"velocity|tempo|increase\w*|raise|more)\b"
)

_TOO_SLOW = re.compile(r"\b(?:too|so|painfully|awfully|rather)(?: \w+)? (?:slow\w*|sluggish\w*|lazy|lazily)\b")

_TOO_FAST = re.compile(
    r"\b(?:too|so|awfully|rather)(?: \w+)? (?:fast|quick\w*|rapid\w*|hast\w+|rushed)\b|\b(?:not|less) (?:so |as |"
    r"that )?(?:fast|quick\w*|rapid\w*)\b"
)

_LONG = re.compile(r"\b(?:(?<!double )(?<!half )time|long|length|duration)\b")

_LESS = re.compile(r"\b(?:less|lower|reduc\w+|cut|drop|decreas\w+|slower|slow)\b")

_MORE = re.compile(r"\b(?:faster|quicker|increas\w+|rais\w+|more|up)\b")

_LATER = re.compile(
    r"\b(?:plus|later|delay\w*|late|postpon\w+|hold\w*|held|waits?|waiting|longer|behind|lag\w*|defer\w*|push\w*|"
    r"hang\w*|hung|extra|additional|lead in|heels|tarr\w+|dawdl\w+|idl\w+|sit\w* tight|rest\w*|stillness|"
    r"back|pause\w*|linger\w*|stay\w*|"
    r"another|extension|grant\w*|sleep\w*|"
    r"put\b(?:.{1,40})? off|to the right|down the (?:(?:time ?)?line|track))\b|\+ ?\d"
)

EARLIER = re.compile(
    r"\b(?:minus|earlier|sooner|early|ahead|forwards?|advanc\w+|shorter|less|prepon\w+|anticipat\w+|"
    r"jump\w* the gun|to the (?:front|left))\b|(?<!\w)[-−–] ?\d"
)

_STRICTLY_LATER = re.compile(r"\b(?:later|delay\w*|postpon\w+|longer)\b")

TOO = re.compile(r"\btoo (?:\w+ )?(?P<what>late|early|soon)\b")

_SHUTS = re.compile(r"\b(?:clos\w+|shut\w*|(?:go|going|goes|slid\w+|mov\w+|com\w+) back|return\w*|back in)\b")

_OPENS = re.compile(r"\bopen\w*\b")  # "hold it shut till three, then swing it open"


def begin(slots: Slots) -> Iterator[Wanted]:
    """What begins, and ends, at another time."""
    slots.used |= {goal.name for goal in slots.goals if slots.happening is None or _LEAVES_IT.search(slots.rest)}
    moment, by = plainly(slots.moment), slots.one("s", "")
    if by is not None and isinstance(moment.start, float) and slots.happening is None:
        slots.repeated.add(by.said)  # "0.4 s earlier: it begins at 3.1"
    elif by is not None:
        sign = sign_of(slots)
        if sign is None and slots.tell(_BETWEEN) and whose_of(slots).pick == "all" and slots.happening is None:
            yield Wanted(ordered(whose_of(slots), "kept", gap=by.value), Moment(), None)
        elif sign is not None and slots.happening is None:
            yield Wanted(pace(whose_of(slots), "later", seconds=sign * by.value), Moment(), None)
        elif slots.happening is not None and moment.empty and slots.happening.during.part != "until":
            yield paced(slots, "begin", replace(moment, start=by.value))
        return
    if not slots.told:
        return
    if isinstance(moment.start, float) and moment.stop is None and _SUCH_THAT.search(slots.rest):
        moment = replace(moment, start=None, stop=moment.start)
    if (
        isinstance(moment.stop, float)
        and moment.start is None
        and moment.lasting is None
        and _ARRIVES.search(slots.rest)
    ):
        moves = None if slots.happening is not None else slots.movement(slots.queries[0])
        if moves is not None and (begins := round(moves.start + moment.stop - moves.stop, 4)) >= 0:
            slots.pass_goals()
            slots.repeated |= set(moment.said)
            yield paced(slots, "begin", Moment(start=begins))  # "delay it such that it reaches the bed at 4.9 s"
        return
    if moment.stop is not None and moment.start is None and slots.happening is None and moment.lasting is None:
        if not slots.tell(_LATER) and not any(tag in ("from", "to") for tag, _, _ in slots.spans):
            return
        moment = replace(moment, start=moment.stop, stop=None)  # "it waits until 2 s"
    shuts = _SHUTS.search(slots.rest) is not None and _OPENS.search(slots.rest) is None
    if is_opened(slots.noun) and shuts and isinstance(slots.moment.start, float):
        yield Wanted(f"close {slots.whom}", moment, slots.happening)
        return
    if isinstance(moment.start, float) and isinstance(moment.stop, float) and moment.stop <= moment.start:
        slots.repeated |= set(moment.said)
        moment = replace(moment, stop=None)  # "at rest for the first second, it starts at 1 s"
    waits = moment.lasting if moment.start is None and _BEFORE.search(slots.rest) else None
    if waits is not None and slots.happening is not None:
        moment = replace(moment, start=waits, lasting=None)  # "once it has landed, let a second pass before"
    elif waits is not None:
        if (moves := slots.movement(slots.queries[0])) is not None:  # "a second of stillness before the fan begins"
            slots.repeated |= set(moment.said)
            now = moves.start if waits <= moves.start or _BY_MORE.search(" ".join(slots.words)) else 0.0
            yield paced(slots, "begin", Moment(start=round(now + waits, 4)))
        return
    if moment.lasting is not None:
        moment = replace(moment, taken=True)
    moves = slots.movement(slots.queries[0])
    if moves is not None and moves.turns and moment.stop is None and _STOPS_AGAIN.search(slots.idle):
        told = any(slots.told_of(tag, moves.stop) for tag in ("keep", "off", "not"))
        yield replace(
            paced(slots, "begin", moment), also=(paced(slots, "stop", Moment(start=moves.stop)),) if told else ()
        )
        return
    if slots.happening is not None and moment.empty and slots.happening.during.part in _ENDED_BY:
        part = _ENDED_BY[slots.happening.during.part]  # "postpone it until the blue one has landed"
        slots.happening = replace(slots.happening, during=slots.happening.during.model_copy(update={"part": part}))
    faster = slots.one("times", "%")
    if faster is not None and (factor := factor_of(slots)) is not None:  # "at 2 s, but at double speed"
        speed = Wanted(pace(whose_of(slots), "speed", factor=round(factor, 4)), Moment(), None)
        yield replace(speed, also=(paced(slots, "begin", moment),))
        return
    yield paced(slots, "begin", moment)


_SUCH_THAT = re.compile(r"\b(?:such|so) that (?:it|he|she|\||the \w+)? ?(?:reach|arriv|gets? (?:there|to|home)|lands?)")
_ARRIVES = re.compile(r"\b(?:reach\w*|arriv\w*|gets? (?:there|to|home)|is there|be there|lands?) ?(?:\||$|,|there)")

_BETWEEN = re.compile(r"\b(?:between|apart|intervals?|stagger\w*|spaced?)\b")

_STOPS_AGAIN = re.compile(r"\b(?:stops?|stopping|rests?|at rest|ends?|ending|finish\w*|off|still|halts?)\b")

_LEAVES_IT = re.compile(r"\b(?:leav\w+|left|quit\w*|depart\w*|go of|leave of|off|from) \|")

_BEFORE = re.compile(r"\b(?:before|until|till)\b")

_ENDED_BY: dict[Part, Part] = {"until": "from", "until_end": "after"}


def sign_of(slots: Slots) -> float | None:
    """1 if something is to be later, -1 if earlier; None if neither is said, or both."""
    whole = slots.whole
    if (too := TOO.search(whole)) is not None and not re.search(r"\b(?:earlier|sooner|later)\b", slots.said):
        return -1.0 if too["what"] == "late" else 1.0
    for later in (_STRICTLY_LATER, _LATER):
        late, early = (slots.tell(words) for words in (later, EARLIER))
        if late != early:
            return 1.0 if late else -1.0
    return None


def speed(slots: Slots) -> Iterator[Wanted]:
    """What moves at another speed."""
    slots.pass_goals()
    if (rate := slots.one("turns/s")) is not None:
        factors = {own.said for own in slots.amounts if own.unit in ("times", "%")}
        slots.used |= factors  # "double time, two turns a second"
        slots.repeated |= factors
        yield now(slots, f"spin {slots.whom} {rate.value:g} turns per second")
        return
    if (seconds := slots.one("s")) is not None and not slots.told:
        yield paced(slots, "begin", Moment(lasting=seconds.value, taken=True))
        return
    if slots.moment.lasting is not None and slots.moment.start is None and slots.happening is None:
        slots.used |= {own.said for own in slots.amounts}
        yield from duration(slots)
        return
    if (rate := slots.one("m/s")) is not None:
        moves = slots.movement(slots.queries[0])
        if moves is not None and moves.metres > 0:
            slots.repeated.add(rate.said)
            times = rate.value * (moves.stop - moves.start) / moves.metres
            yield paced(slots, "speed", factor=round(times, 4))
        return
    if (factor := factor_of(slots)) is not None:
        yield paced(slots, "speed", factor=round(factor, 4))


def factor_of(slots: Slots) -> float | None:
    """How many times as fast; None if that is not told."""
    said = _TOO_SLOW.sub(" faster ", _TOO_FAST.sub(" slower ", slots.said))
    slow, fast = SLOWER.search(said) is not None, _FASTER.search(said) is not None
    told = slots.one("times", "%", "turns", "")
    if told is None:
        strictly = re.search(r"\b(?:faster|quicker|speed (?:\S+ )*up|hurry|accelerat\w+)\b", said) is not None
        if slow and not strictly:
            return 0.5
        return 2.0 if fast and not slow else None
    value = told.value / 100 if told.unit == "%" else told.value
    if value <= 0:
        return None
    if told.unit == "%" or (value < 1 and re.search(rf"\bby (?:a )?{re.escape(told.said)}", said)):
        if re.search(r"\b(?:to|at|of|with) (?:only |just |about )?" + re.escape(told.said), said):
            return value
        if _LESS.search(said):
            return 1 - value if value < 1 else None
        if _MORE.search(said):
            return 1 + value
        return value
    if _LONG.search(said) and not fast:
        return 1 / value
    if value > 1 and slow and not re.search(r"\bas (?:fast|quick)\b", said):
        return 1 / value
    return value


_SENT = re.compile(r"^(?:please |just )?(?:drive|move|push|pull|send|slide|roll|carry|bring|shift|walk|shove|take) \|")


def duration(slots: Slots) -> Iterator[Wanted]:
    """What takes another time."""
    if slots.goals and _SENT.match(slots.rest) and not slots.moves(slots.queries[0]):
        yield from move(slots)  # "drive the truck over to the garage within four seconds"
        return
    slots.pass_goals()
    moment = plainly(slots.moment)
    moves = slots.movement(slots.queries[0])
    goes_on = moment.lasting is not None and not moment.taken and any(said.startswith("for ") for said in moment.said)
    if goes_on and (moves is None or moves.turns):
        return  # how long it goes on, or how long it takes
    if moment.lasting is None and moment.stop is None and (seconds := slots.one("s")) is not None:
        if slots.tell(_BY_MORE):
            if (sign := 1 if slots.tell(_LONGER) else -1 if slots.tell(_SHORTER) else 0) and moves is not None:
                slots.repeated.add(seconds.said)  # "it ought to reach the wall a whole second sooner"
                ends = round(moves.stop + sign * seconds.value, 4)
                if not moves.turns and ends > moves.start + _SHORTEST:
                    yield paced(slots, "begin", Moment(start=round(moves.start, 4), stop=ends))
            return
        moment = replace(moment, lasting=seconds.value)
    if moment.lasting is not None:
        factors = {own.said for own in slots.amounts if own.unit in ("times", "%")}
        slots.used |= factors  # "double the duration, so 3 s"
        slots.repeated |= factors
    if moment.lasting is not None and _ends_itself(slots):
        yield Wanted(pace(whose_of(slots), "begin"), replace(moment, taken=True), None)
    elif moment.lasting is not None:
        yield paced(slots, "begin", replace(moment, taken=True))
    elif moment.always and moment.start is None and any(tag == "to" for tag, _, _ in slots.spans):
        yield paced(slots, "begin", replace(moment, stop="end", always=False))  # "it is there just as the film closes"
    elif moment.stop not in (None, "end") or (moment.stop == "end" and moment.start is not None):
        yield paced(slots, "begin", moment)
    elif (factor := slots.one("times", "%")) is not None:
        value = factor.value / 100 if factor.unit == "%" else factor.value
        if value > 0:
            yield paced(slots, "speed", moment, factor=round(1 / value, 4))


_BY_MORE = re.compile(r"\b(?:longer|shorter|more|less|another|extra|additional|sooner|earlier|later)\b")
_LONGER, _SHORTER = re.compile(r"\b(?:longer|later)\b"), re.compile(r"\b(?:shorter|sooner|earlier)\b")
_SHORTEST = 0.05  # seconds of a movement


def _ends_itself(slots: Slots) -> bool:
    """Whether what happens only tells that its own movement ends: "two whole seconds till it lands"."""
    during = None if slots.happening is None or slots.happening.until is not None else slots.happening.during
    return during is not None and during.part in _ENDED_BY and during.of in (None, IT, *slots.queries)


def longer(slots: Slots) -> Iterator[Wanted]:
    """What goes on for longer."""
    slots.pass_goals()
    if slots.happening is not None:
        if slots.happening.during.part in _ENDED_BY and slots.moment.empty:  # "until the door clicks"
            yield paced(slots, "go_on", Moment())
        return
    stop = slots.moment.stop if isinstance(slots.moment.stop, float) else None
    if slots.moment.lasting is None and all(own.said in slots.used for own in slots.amounts):
        yield Wanted(pace(whose_of(slots), "go_on"), Moment(stop=stop), None)
        return
    moves, more = slots.movement(slots.queries[0]), slots.one("s", "")
    rate = 0.0 if moves is None else moves.rate
    slots.used |= {own.said for own in slots.amounts if own.unit == "turns/s" and abs(own.value - rate) < _AS_TOLD}
    seconds = slots.moment.lasting if more is None else more.value
    if moves is None or seconds is None:
        return  # only the scene tells when it stops now
    words = slots.whole
    ends = round((moves.stop if more is not None or _EXTRA.search(words) else moves.start) + seconds, 4)
    if ends <= moves.stop or (stop is not None and abs(stop - ends) > _AS_TOLD):
        return
    slots.repeated |= {*slots.moment.said, *(() if more is None else (more.said,))}
    yield Wanted(pace(whose_of(slots), "go_on"), Moment(stop=ends), None)


_EXTRA = re.compile(
    r"\b(?:extra|more|another|longer|further|additional|beyond|prolong\w*|extend\w*|extension|add\w*)\b"
)

_AS_TOLD = 0.06  # seconds by which two tellings of one time may differ

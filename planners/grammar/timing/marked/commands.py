"""The commands that each kind of wish makes of what the marks of an instruction hold."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

from .....gaussians import late_re as re
from .....tools.when import During, Part
from ...learned.seen import hues
from ...vocabulary.nouns import is_opened
from ..clauses import ALL_OF_IT
from ..command import Command, pace
from ..happenings import IT, Happening
from ..moments import Moment
from .far import far_along, goes_as_far, how_far
from .guards import ASKED_AS_NOT, NO_MORE
from .orders import ordered, told_order
from .slots import ALL_MOVING, Slots
from .steps import gap_of, in_step, in_turn, opened
from .wanted import Wanted, now, paced, plainly, whose_of

_SLOWER = re.compile(
    r"\b(?:slow\w*|calm\w*|gentl\w+|lazy|lazily|leisurely|brake|reduce\w*|less|lower|lessen|decelerat\w+|snail\w*|"
    r"drag\w*|"
    r"sluggish\w*|crawl\w*|slo|longer|long)\b"
)
_FASTER = re.compile(
    r"\b(?:fast\w*|quick\w*|speed\w*|hurr\w+|rush\w*|snapp\w+|brisk\w*|zip\w*|accelerat\w+|rapid\w*|swift\w*|pace|"
    r"rate|"
    r"velocity|tempo|increase\w*|raise|more)\b"
)
_HASTE = re.compile(r"\b(?:fast\w*|quick\w*|rapid\w*|swift\w*)\b")
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
    r"back|pause\w*|linger\w*|stay\w*|put\b(?:.{1,40})? off|to the right|down the (?:time ?)?line)\b|\+ ?\d"
)
_EARLIER = re.compile(
    r"\b(?:minus|earlier|sooner|early|ahead|forwards?|advanc\w+|shorter|less|prepon\w+|anticipat\w+|"
    r"jump\w* the gun|to the (?:front|left))\b|(?<!\w)[-−–] ?\d"
)
_STRICTLY_LATER = re.compile(r"\b(?:later|delay\w*|postpon\w+|longer)\b")
_TOO = re.compile(r"\btoo (?:\w+ )?(?P<what>late|early|soon)\b")
_UP = re.compile(
    r"\b(?:up(?! (?:next|to|beside|at|against|by|on)\b)|upwards?|lift\w*|rais\w+|ris\w+|levitat\w+|float\w*|"
    r"hover\w*|hoist\w*|higher|ascend\w*|into the air|"
    r"off the ground|soar\w*|elevat\w+|jack|climb\w*)\b"
)
_DOWN = re.compile(r"\b(?:down|downwards?|lower\w*|sink\w*|sank|descend\w*)\b")
_LEFT, _RIGHT = (
    re.compile(r"\bleft(?:wards?)?\b"),
    re.compile(r"\bright(?:wards?)?\b(?! (?:away|after|when|at|then|now|up|next|beside|before|as|on|in|from)\b)"),
)
_FOLLOWS = re.compile(
    r"\b(?:follow\w*|chas\w+|tail\w*|trail\w*|pursu\w+|(?:run|go|drive|roll|walk|come|trot|"
    r"rac\w+)\w* (?:right )?(?:after|behind)|tag along)\b"
)
_ROUND = re.compile(r"\b(?:circl\w+|orbit\w*|round|around|laps?|loops?)\b")
_HOPS = re.compile(r"\b(?:hop|hops|hopping|jump\w*|leap\w*)\b")
_OTHERWISE = re.compile(  # moves that marks do not tell apart
    r"\b(?:bounc\w+|bob\w*|wobbl\w+|sway\w*|shak\w+|swing\w*|tip\w*|toppl\w+|fall\w*|knock\w*|"
    r"nod\w*|"
    r"rock\w*|danc\w+|drop\w*|swap\w*|exchang\w+|trad\w+|places|throw\w*|kick\w*(?! off)|sits?|tumbl\w+|crash\w*)\b"
)
_SEEN = re.compile(
    r"\b(?:appears?|appear(?:ed|ing)|shows?|showing|shown|visible|into view|in view|pops? (?:up|in)|comes? in(?:to)?|"
    r"reveals?|revealed|spawns?|turns? up|materiali[sz]es?|to be seen|see|seen|in (?:the )?(?:picture|shot|frame)|"
    r"there)\b"
)
_BACK = re.compile(r"\b(?:back|again)\b")
_ENTERS = re.compile(
    r"\b(?:appears?|spawns?|pops? (?:up|in)|shows? up|enters?|comes? in|reveals?|"
    r"materiali[sz]es?)\b"
)
_GONE = re.compile(
    r"\b(?:hid\w*|invisible|vanish\w*|disappear\w*|gone|gon|out|lose|lost|remov\w+|away|off|blank\w*|conceal\w*|poof|"
    r"cut|drop|delet\w+|eras\w+|without|absent|unseen|unrender\w*|mask\w*|take|despawn\w*|bye|missing|suppress\w*|"
    r"visib\w+ ?(?:=|:|to|is)? ?(?:false|0|off|no|none)|"
    r"make \w+self scarce|blink\w*|transparent|ghost|rid|exit\w*|leave\w*|kill|cloak\w*)\b"
)
_NOT = re.compile(r"\b(?:not|no|never|without|nobody|nothing|neither|nor|stop|hardly)\b")
_NO_WISH = re.compile(r"\b(?:unless|except|instead of|if (?:the|it|he|she|they)|or)\b")
_WHICH_ONE = re.compile(r"\| (?:that(?! way\b)|which|who|whose)\b")  # "the book that falls first"
_OTHER_WAY = re.compile(
    r"\b(?:(?:other|opposite|reverse|wrong|contrary) (?:way|direction|side|sense)|way (?:round|around)|direction|"
    r"sense|clockwise|anti ?clockwise|counter ?clockwise|counter|turns? (?:left|right))\b"
)
_BACKWARDS = re.compile(r"\b(?:backwards?|in reverse|rewind|rewound|from (?:the )?(?:end|back) to|end to start)\b")
_TRAVELS = re.compile(
    r"\b(?:travel|roll|walk|driv|slid|march|fall|run|ris)(?:e?s|e|ing|ling)?\b|\bsetting (?:off|out)\b"
)
_SHUTS = re.compile(r"\b(?:clos\w+|shut\w*|(?:go|going|goes|slid\w+|mov\w+|com\w+) back|return\w*|back in)\b")


def commands(kind: str, slots: Slots) -> Iterator[Wanted]:
    """The commands of a kind that hold all that the marks do, the likeliest first."""
    made = _KINDS.get(kind)
    if made is None or not slots.names or _NO_WISH.search(slots.rest):
        return
    if kind != "order" and _WHICH_ONE.search(slots.rest):
        return
    if kind not in _NEGATIVE and _NOT.search(NO_MORE.sub(" ", ASKED_AS_NOT.sub(" ", slots.rest))):
        return
    for wanted in made(slots):
        if not slots.unused():
            yield wanted
        slots.used.clear()
        slots.repeated.clear()


_NEGATIVE = ("hide", "remove", "still", "stay", "halt", "longer", "amount", "begin", "pause", "duration")


# -- looks and places --------------------------------------------------------------------------------------------------


def _recolor(slots: Slots) -> Iterator[Wanted]:
    hue = [word for word in slots.color.split() if word in hues()]
    for color in dict.fromkeys((slots.color, " ".join(hue))) if hue else ():  # "neon green" is green
        slots.pass_goals()
        yield Wanted(Command(kind="look", text=f"make {slots.whom} {color}"), slots.moment, slots.happening)


def _hide(slots: Slots) -> Iterator[Wanted]:
    if not slots.told:
        yield from _remove(slots)
        return
    seen = _SEEN.search(slots.rest) is not None and _GONE.search(slots.rest) is None
    enters = slots.moment.start is not None and slots.moment.stop is None and _ENTERS.search(slots.rest) is not None
    seen = seen and (enters or _NOT.search(slots.rest) is None)
    if seen and _BACK.search(" ".join(slots.words)):
        return  # "show it for a second, then bring it back" contradicts itself
    slots.pass_goals()
    yield Wanted(f"{'show' if seen else 'hide'} {slots.whom}", slots.moment, slots.happening)


def _remove(slots: Slots) -> Iterator[Wanted]:
    slots.pass_goals()
    if slots.told:
        yield Wanted(f"hide {slots.whom}", slots.moment, slots.happening)
    else:
        yield Wanted(Command(kind="look", text=f"remove {slots.whom}"), slots.moment, None)


def _move(slots: Slots) -> Iterator[Wanted]:
    if slots.tell(_OTHERWISE) or _TO_A_HEIGHT.search(slots.said):
        return
    step, whole = slots.happening, " ".join(slots.words)
    if step is not None and step.until is not None and step.during.part == "while":  # "as it turns, until it stops"
        begun = step.during.model_copy(update={"part": "from"})
        slots = replace(slots, happening=replace(step, during=begun))
        step = slots.happening
    begins = step is not None and (step.during.state, step.during.part) == ("moving", "from")
    if step is not None and begins and step.during.of not in (None, *slots.queries) and _BOTH_THERE.search(whole):
        slots = replace(slots, happening=replace(step, during=step.during.model_copy(update={"part": "while"})))
    if (beside := _beside_another(slots)) is not None:
        yield beside
        return
    goal, length = slots.goal(), slots.one("m")
    if goal is not None and _FOLLOWS.search(slots.rest):
        yield now(slots, f"let {slots.whom} follow {goal.name}")
        return
    if goal is not None and goal.way not in ("on", "to") and _ROUND.search(slots.rest):
        yield now(slots, f"let {slots.whom} drive around {goal.name}")
        return
    ways = [way for way, words in _WAYS.items() if words.search(slots.said)]
    if _HOPS.search(slots.rest) and goal is None and set(ways) <= {"up"}:
        yield now(slots, f"let {slots.whom} hop{'' if length is None else f' {length.value:g} m'}")
        return
    if goal is not None and not (len(ways) == 1 and length is not None and goal.way == ""):
        how = f" by {length.value:g} m" if length is not None else ""
        new = any(tag == "x" and slots.words[start] in ("a", "an") for tag, start, _ in slots.spans)  # is put in
        film = slots.moves(ALL_MOVING) and not slots.moves(slots.queries[0])
        if length is None and not slots.told and film and not new:
            text = f"move {slots.whom} {'onto' if goal.way == 'on' else 'next to'} {goal.name}"
            yield Wanted(Command(kind="look", text=text), Moment(), None)
        place = f"towards {goal.name}" if length is not None else f"{'onto' if goal.way == 'on' else 'to'} {goal.name}"
        yield Wanted(f"move {slots.whom}{how} {place}", slots.moment, slots.happening)
    elif len(ways) == 1 and (length is not None or ways == ["up"]):
        how = f" by {length.value:g} m" if length is not None else ""
        yield Wanted(f"move {slots.whom} {ways[0]}{how}", slots.moment, slots.happening)


_BOTH_THERE = re.compile(  # "sets off when the robot does, and they both get there together"
    r"\b(?:both|together)\b.*\b(?:arriv\w+|there|reach\w*)\b|\b(?:arriv\w+|there|reach\w*)\b.*\b(?:both|together)\b"
)
_ARRIVES = re.compile(
    r"\b(?:arriv\w+|there|reach\w*|gets? (?:to|in)|finish\w*|lands?|parks?|ends? (?:up )?together|both|sync\w*|same "
    r"times|side by side|comes? in|pull\w* (?:in|up)|together\b.*\btogether)\b"
)


def _beside_another(slots: Slots) -> Wanted | None:
    """Something that goes to a place as another thing moves, which is named beside that: "the car drives to the bed,
    too, and both arrive together"; None for others."""
    others = [goal for goal in slots.goals if goal.way != "from"]
    movers = [goal for goal in others if slots.moves(goal.query)]
    ends = slots.moment.start is None and slots.happening is None  # "... and arrives at 3 s"
    if len(others) != 2 or len(movers) != 1 or not ends or slots.moves(slots.queries[0]):
        return None
    place = next(goal for goal in others if goal is not movers[0])
    slots.pass_goals()
    lags = slots.moment.lasting is not None and _BEHIND_IT.search(slots.rest) is not None
    if lags:  # "comes in half a second behind the robot"
        happening = Happening(During(state="moving", of=movers[0].query, part="from"), f"after {movers[0].name}")
        return Wanted(f"move {slots.whom} to {place.name}", Moment(start=slots.moment.lasting), happening)
    words = " ".join(slots.words)
    part: Part = "while" if _ARRIVES.search(words) and not slots.told else "from"
    happening = Happening(During(state="moving", of=movers[0].query, part=part), f"as {movers[0].name} does")
    return Wanted(f"move {slots.whom} to {place.name}", plainly(slots.moment), happening)


_BEHIND_IT = re.compile(r"\b(?:behind|after) \|")
_TO_A_HEIGHT = re.compile(r"\bto (?:\d[\d.]*|half a|one|two|three) ?(?:m|cm|met\w+|centimet\w+)\b")
_WAYS = {
    "up": _UP, "down": _DOWN, "to the left": _LEFT, "to the right": _RIGHT,
    "forward": re.compile(r"\b(?:forwards?|ahead)\b"), "backwards": re.compile(r"\bbackwards?\b"),
    "back": re.compile(r"\bback\b(?! (?:to|in|into|at|by|on)\b)"),
    "towards the viewer": re.compile(
        r"\b(?:to|towards?|nearer|closer)\b (?:to )?(?:the )?(?:viewer|camera|screen|audience)\b"
    ),
}  # fmt: skip


# -- turns and repeats -------------------------------------------------------------------------------------------------


def _spin(slots: Slots) -> Iterator[Wanted]:
    slots.pass_goals()
    whom = slots.whom
    if (rate := slots.one("turns/s")) is not None:
        yield now(slots, f"spin {whom} {rate.value:g} turns per second")
        return
    whole = {"stop": "end"} if slots.moment.always or _is_last(slots.moment) else {}
    if (angle := slots.one("deg")) is not None:
        yield now(slots, f"spin {whom} by {angle.value:g} degrees", **whole)
    elif (turns := slots.one("turns", "times")) is not None:
        how = {0.5: "half a turn", 0.25: "a quarter turn", 1.0: "once"}.get(turns.value, f"{turns.value:g} turns")
        yield now(slots, f"spin {whom} {how}", **whole)
    else:
        yield now(slots, f"let {whom} spin" if slots.told else f"spin {whom}", **whole)


def _is_last(moment: Moment) -> bool:
    """Whether a time is the last seconds of the scene."""
    return isinstance(moment.start, float) and moment.start < 0 and moment.stop is None


def _reverse(slots: Slots) -> Iterator[Wanted]:
    slots.pass_goals()
    slots.used |= {own.said for own in slots.amounts if own.unit in ("deg", "%")}  # "from 80 degrees to 0"
    moves, moment, whose = slots.movement(slots.queries[0]), plainly(slots.moment), slots.queries[0]
    if slots.happening is not None or (slots.told and (moves is None or moves.turns)):
        return
    back = slots.goals or slots.told or slots.tell(_TRAVELS)  # "the wrong way round, from the wall to the sofa"
    if not back and slots.tell(_OTHER_WAY) and not slots.tell(_BACKWARDS):
        yield now(slots, f"let {slots.whom} turn the other way round")
        return
    reverse = Wanted(pace(ALL_OF_IT if whose.text == "everything" else whose_of(slots), "reverse"), Moment(), None)
    if (
        moves is not None
        and moment.told
        and (moment.start, moment.stop) != (round(moves.start, 2), round(moves.stop, 2))
    ):
        yield replace(reverse, also=(paced(slots, "begin", replace(moment, taken=moment.lasting is not None)),))
    else:
        slots.repeated |= set(moment.said)
        yield reverse


_GOES_ON = re.compile(r"\b(?:keep\w*|goes|going|go|carr\w+|runs?) (?:it |him |her |\| )?(?:going|on)\b")


def _repeat(slots: Slots) -> Iterator[Wanted]:
    slots.pass_goals()
    if slots.moment.always and slots.moment.start is not None:  # "again from 4.5 until the end"
        moment = replace(plainly(slots.moment), stop="end", always=False)
        yield Wanted(pace(whose_of(slots), "repeat", times=1), moment, slots.happening)
        return
    moves = slots.movement(slots.queries[0])
    if moves is not None and moves.turns and slots.moment.stop is None and _GOES_ON.search(" ".join(slots.words)):
        yield paced(slots, "repeat", replace(plainly(slots.moment), stop="end"), times=1)
        return
    again = slots.one("times", "turns", "")
    slots.repeated |= set() if again is None else {again.said}
    lasting = slots.moment.lasting
    if (
        lasting is not None
        and again is not None
        and again.value >= 2
        and slots.moment.start is None
        and slots.happening is None
    ):
        each = paced(slots, "begin", Moment(lasting=lasting, taken=True))
        yield replace(each, also=(paced(slots, "repeat", Moment(), times=round(again.value) - 1),))
        return
    if slots.told:
        yield paced(slots, "repeat", times=1 if again is None or again.value < 2 else round(again.value) - 1)
    elif again is not None and again.value >= 2:
        yield paced(slots, "repeat", times=round(again.value) - 1)
    else:
        yield now(slots, f"repeat the movement of {slots.whom}")


def _return(slots: Slots) -> Iterator[Wanted]:
    moves = slots.movement(slots.queries[0])
    if slots.goals and not slots.told and moves is None:
        return  # "roll to the wall and come back"
    slots.pass_goals()
    moment = plainly(slots.moment)
    ends = moment.lasting is not None or moment.stop is not None
    if moves is not None and not ends and slots.one("times", "%") and (factor := _factor(slots)) is not None:
        moment = replace(moment, lasting=round((moves.stop - moves.start) / factor, 4), taken=True)
        slots.repeated |= {own.said for own in slots.amounts}  # "back at double speed"
    if moment.always and any(tag == "to" for tag, _, _ in slots.spans):
        moment = replace(moment, stop="end", always=False)  # it is back by the end
    elif moment.start == "end":
        moment = replace(moment, start=None, stop="end")
    yield paced(slots, "return", moment)


# -- when and how fast -------------------------------------------------------------------------------------------------


def _begin(slots: Slots) -> Iterator[Wanted]:
    slots.used |= {goal.name for goal in slots.goals if slots.happening is None or _LEAVES_IT.search(slots.rest)}
    moment, by = plainly(slots.moment), slots.one("s", "")
    if by is not None and isinstance(moment.start, float) and slots.happening is None:
        slots.repeated.add(by.said)  # "0.4 s earlier: it begins at 3.1"
    elif by is not None:
        sign = _sign(slots)
        if sign is None and slots.tell(_BETWEEN) and whose_of(slots).pick == "all" and slots.happening is None:
            yield Wanted(ordered(whose_of(slots), "kept", gap=by.value), Moment(), None)
        elif sign is not None and slots.happening is None:
            yield Wanted(pace(whose_of(slots), "later", seconds=sign * by.value), Moment(), None)
        elif slots.happening is not None and moment.empty and slots.happening.during.part != "until":
            yield paced(slots, "begin", replace(moment, start=by.value))
        return
    if not slots.told:
        return
    if moment.stop is not None and moment.start is None and slots.happening is None and moment.lasting is None:
        if not slots.tell(_LATER) and not any(tag in ("from", "to") for tag, _, _ in slots.spans):
            return
        moment = replace(moment, start=moment.stop, stop=None)  # "it waits until 2 s"
    if is_opened(_noun(slots)) and _SHUTS.search(slots.rest) and isinstance(slots.moment.start, float):
        yield Wanted(f"close {slots.whom}", moment, slots.happening)
        return
    if isinstance(moment.start, float) and isinstance(moment.stop, float) and moment.stop <= moment.start:
        slots.repeated |= set(moment.said)
        moment = replace(moment, stop=None)  # "at rest for the first second, it starts at 1 s"
    if moment.lasting is not None and _BEFORE.search(slots.rest) and moment.start is None and slots.happening is None:
        if (moves := slots.movement(slots.queries[0])) is not None:  # "a second of stillness before the fan begins"
            slots.repeated |= set(moment.said)
            yield paced(slots, "begin", Moment(start=round(moves.start + moment.lasting, 4)))
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
    if faster is not None and (factor := _factor(slots)) is not None:  # "at 2 s, but at double speed"
        speed = Wanted(pace(whose_of(slots), "speed", factor=round(factor, 4)), Moment(), None)
        yield replace(speed, also=(paced(slots, "begin", moment),))
        return
    yield paced(slots, "begin", moment)


_BETWEEN = re.compile(r"\b(?:between|apart|intervals?|stagger\w*|spaced?)\b")
_STOPS_AGAIN = re.compile(r"\b(?:stops?|stopping|rests?|at rest|ends?|ending|finish\w*|off|still|halts?)\b")
_LEAVES_IT = re.compile(r"\b(?:leav\w+|left|quit\w*|depart\w*|go of|leave of|off|from) \|")
_BEFORE = re.compile(r"\b(?:before|until|till)\b")
_ENDED_BY: dict[Part, Part] = {"until": "from", "until_end": "after"}


def _noun(slots: Slots) -> str:
    return slots.queries[0].text


def _sign(slots: Slots) -> float | None:
    """1 if something is to be later, -1 if earlier; None if neither is said, or both."""
    whole = " ".join(slots.words)
    if (too := _TOO.search(whole)) is not None and not re.search(r"\b(?:earlier|sooner|later)\b", slots.said):
        return -1.0 if too["what"] == "late" else 1.0
    for later in (_STRICTLY_LATER, _LATER):
        late, early = (slots.tell(words) for words in (later, _EARLIER))
        if late != early:
            return 1.0 if late else -1.0
    return None


def _speed(slots: Slots) -> Iterator[Wanted]:
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
        yield from _duration(slots)
        return
    if (rate := slots.one("m/s")) is not None:
        moves = slots.movement(slots.queries[0])
        if moves is not None and moves.metres > 0:
            slots.repeated.add(rate.said)
            times = rate.value * (moves.stop - moves.start) / moves.metres
            yield paced(slots, "speed", factor=round(times, 4))
        return
    if (factor := _factor(slots)) is not None:
        yield paced(slots, "speed", factor=round(factor, 4))


def _factor(slots: Slots) -> float | None:
    """How many times as fast; None if that is not told."""
    said = _TOO_SLOW.sub(" faster ", _TOO_FAST.sub(" slower ", slots.said))
    slow, fast = _SLOWER.search(said) is not None, _FASTER.search(said) is not None
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


def _duration(slots: Slots) -> Iterator[Wanted]:
    if slots.goals and _SENT.match(slots.rest) and not slots.moves(slots.queries[0]):
        yield from _move(slots)  # "drive the truck over to the garage within four seconds"
        return
    slots.pass_goals()
    moment = plainly(slots.moment)
    moves = slots.movement(slots.queries[0])
    goes_on = moment.lasting is not None and not moment.taken and any(said.startswith("for ") for said in moment.said)
    if goes_on and (moves is None or moves.turns):
        return  # how long it goes on, or how long it takes
    if moment.lasting is None and moment.stop is None and (seconds := slots.one("s")) is not None:
        if slots.tell(re.compile(r"\b(?:longer|shorter|more|less|another|extra|additional|sooner|earlier|later)\b")):
            return
        moment = replace(moment, lasting=seconds.value)
    if moment.lasting is not None and _ends_itself(slots):
        yield Wanted(pace(whose_of(slots), "begin"), replace(moment, taken=True), None)
    elif moment.lasting is not None:
        yield paced(slots, "begin", replace(moment, taken=True))
    elif moment.stop not in (None, "end") or (moment.stop == "end" and moment.start is not None):
        yield paced(slots, "begin", moment)
    elif (factor := slots.one("times", "%")) is not None:
        value = factor.value / 100 if factor.unit == "%" else factor.value
        if value > 0:
            yield paced(slots, "speed", moment, factor=round(1 / value, 4))


def _ends_itself(slots: Slots) -> bool:
    """Whether what happens only tells that its own movement ends: "two whole seconds till it lands"."""
    during = None if slots.happening is None or slots.happening.until is not None else slots.happening.during
    return during is not None and during.part in _ENDED_BY and during.of in (None, IT, *slots.queries)


# -- rests -------------------------------------------------------------------------------------------------------------

_WIDE = {"state": "fully_open", "part": "from"}
_CLOSING = {"state": "closing"}


def _pause(slots: Slots) -> Iterator[Wanted]:
    slots.pass_goals()
    moment = replace(plainly(slots.moment), taken=False)
    if (
        moment.always
        and moment.lasting is not None
        and _has_stopped(slots)
        and _GOES_AGAIN.search(" ".join(slots.words))
    ):
        again = Moment(start=moment.lasting, stop="end")  # "after it stops, half a second's peace, then on to the end"
        yield paced(slots, "repeat", again, times=1)
        return
    if moment.lasting is None and (seconds := slots.one("s")) is not None:
        moment = replace(moment, lasting=seconds.value)
    begun = moment.start is not None or slots.happening is not None
    if not begun and (moment.lasting is None) != (moment.stop is None) and (there := _there(slots)) is not None:
        yield Wanted(replace(pace(whose_of(slots), "stop"), during=there), moment, None)
        return
    if not begun and (moment.lasting is None) != (moment.stop is None):
        if (where := far_along(slots)) is not None:
            yield Wanted(replace(pace(whose_of(slots), "stop"), during=where), moment, None)
            return
        if moment.lasting is not None:
            return
    if isinstance(moment.stop, float) and moment.start is None and slots.happening is None:
        moment = replace(moment, start=0.0)  # "for the first second"
    both = moment.stop is not None and (moment.start is not None or slots.happening is not None)
    moves = slots.movement(slots.queries[0])
    if both and moves is not None and moves.turns and slots.told_of("to", moves.stop):  # "then on until 4 s as before"
        yield replace(paced(slots, "stop", moment), also=(paced(slots, "stop", Moment(start=moves.stop)),))
        return
    if moment.lasting is not None or both or _has_ends(slots.happening):
        rest = paced(slots, "stop", moment)
        to_the_end = moves is not None and moves.turns and moment.always and moment.lasting is not None
        if moves is not None and to_the_end and moves.stop + (moment.lasting or 0.0) > moves.end:
            rest = replace(
                rest, also=(paced(slots, "stop", Moment(start=moves.end)),)
            )  # "then on till the film is over"
        yield rest


_GOES_AGAIN = re.compile(r"\b(?:again|restart\w*|resum\w*|back on|another (?:go|run)|once more)\b")


def _has_stopped(slots: Slots) -> bool:
    """Whether the time is from when what is meant has stopped."""
    during = None if slots.happening is None else slots.happening.during
    return (
        during is not None
        and (during.state, during.part) == ("moving", "after")
        and (during.of in (None, IT, *slots.queries))
    )


def _has_ends(happening: Happening | None) -> bool:
    """Whether a time told by what happens begins and ends."""
    return happening is not None and (happening.until is not None or happening.during.part in ("while", "unless"))


def _halt(slots: Slots) -> Iterator[Wanted]:
    slots.pass_goals()
    moment = plainly(slots.moment)
    if not is_opened(_noun(slots)) and not slots.told and (length := slots.one("m")) is not None:
        yield from goes_as_far(slots) if _SHORT_OF.search(slots.said) else ()
        yield paced(slots, "part", Moment(), distance={"value": length.value})
        return
    if moment.lasting is not None:
        return
    if (sooner := _stops_sooner(slots)) is not None:
        yield sooner
        return
    stop = moment.stop if isinstance(moment.stop, float) else math.inf
    ended = moment.start is None and math.isfinite(stop) and slots.happening is None
    if ended and not slots.amounts and (moves := slots.movement(slots.queries[0])) and stop < moves.stop:
        moment = replace(moment, start=stop, stop=None)  # "it only runs until 2 s"
    begins = moment.start is not None or slots.happening is not None
    if begins and moment.start != "end":
        far = {own.said for own in slots.amounts if own.unit in ("times", "%", "deg", "m")}
        slots.used |= far  # "half out, from 1.5 s on"
        slots.repeated |= far
        yield paced(slots, "stop", replace(moment, stop=None) if moment.stop == "end" else moment)
        return
    where = _there(slots) or far_along(slots)  # "it jams at 40 degrees till the film ends"
    if where is not None:
        yield Wanted(replace(pace(whose_of(slots), "stop"), during=where), Moment(), None)
    elif ended:
        yield paced(slots, "stop", replace(moment, start=moment.stop, stop=None))


_SHORT_OF = re.compile(r"\b(?:short|before|away)\b")


def _there(slots: Slots) -> dict[str, Any] | None:
    """The time from when something is at the other thing that is named, as fields: "it stops on the rug"; None if none
    is named, or several."""
    goals = [goal for goal in slots.goals if not goal.query.last]
    passed = next((part for part, words in _PASSES.items() if words.search(slots.rest)), None)
    if passed is not None and len(goals) == 1 and not slots.amounts and not is_opened(_noun(slots)):
        return {"state": passed, "anchors": (goals[0].query,), "part": "after" if passed == "on" else "from"}
    goals = [goal for goal in goals if goal.way != "from"]
    if len(goals) != 1 or is_opened(_noun(slots)) or slots.amounts or slots.tell(_HALFWAY):
        return None
    if goals[0].query.text in _TURNING_POINTS:
        return {"state": "turning", "part": "after" if _TURNS_FIRST.search(" ".join(slots.words)) else "from"}
    return {"state": "closest", "anchors": (goals[0].query,), "part": "from"}


_HALFWAY = re.compile(r"\b(?:half ?way|mid ?way|half)\b")
_PASSES = {
    "on": re.compile(r"\b(?:leav\w+|left|off|past|beyond|out of|after|across|clears?|clearing) \|"),
    "touches": re.compile(r"\b(?:reach\w*|entering|enters|onto|arriv\w+ (?:at|on)|edge of|touch\w*|hit\w*|meet\w*) \|"),
}
_TURNS_FIRST = re.compile(r"\b(?:mak\w+|does|doing|takes|after|completes) (?:its|his|her|the) turn\b")
_TURNING_POINTS = ("corner", "turn", "bend", "turning point")


def _stops_sooner(slots: Slots) -> Wanted | None:
    """What turns and stops so many seconds sooner than now; None for others."""
    moves = slots.movement(slots.queries[0])
    if moves is None or not moves.turns or slots.told or not slots.tell(_EARLIER):
        return None
    by = slots.one("s", "")
    if by is None or moves.stop - by.value <= moves.start:
        return None
    slots.repeated.add(by.said)
    return paced(slots, "stop", Moment(start=round(moves.stop - by.value, 4)))


def _still(slots: Slots) -> Iterator[Wanted]:
    slots.pass_goals()
    slots.used |= {own.said for own in slots.amounts if own.value == 0}  # "at 0 m/s"
    others = slots.happening is not None and _AS_OTHERS.search(slots.happening.said) is not None
    if not slots.told or slots.moment.always or others:
        yield Wanted(pace(whose_of(slots), "stop"), Moment(), None)
    elif slots.happening is None:
        yield paced(slots, "stop")


_AS_OTHERS = re.compile(r"\b(?:while|as|when) (?:the |all the |both )?(?:others?|rest)\b")  # that move as they do


def _stay(slots: Slots) -> Iterator[Wanted]:
    slots.pass_goals()
    if is_opened(_noun(slots)):
        moves, moment = slots.movement(slots.queries[0]), slots.moment
        slots.used |= {own.said for own in slots.amounts}  # "it stays at its 30 cm"
        slots.repeated |= slots.used
        if isinstance(moment.start, float) and slots.happening is None:
            yield paced(slots, "stop", Moment(start=moment.start))
            return
        if moves is not None and isinstance(moment.stop, float) and moment.stop >= moves.end:
            slots.repeated |= set(moment.said)
        yield Wanted(replace(pace(whose_of(slots), "stop"), during=_WIDE), Moment(), None)  # what opens by itself
        yield Wanted(f"keep {slots.whom} open", Moment(), None)
    else:
        yield from _halt(slots)


def _longer(slots: Slots) -> Iterator[Wanted]:
    slots.pass_goals()
    if slots.happening is not None:
        return
    stop = slots.moment.stop if isinstance(slots.moment.stop, float) else None
    if slots.moment.lasting is None and all(own.said in slots.used for own in slots.amounts):
        yield Wanted(pace(whose_of(slots), "go_on"), Moment(stop=stop), None)
        return
    moves, more = slots.movement(slots.queries[0]), slots.one("s", "")
    rate = 0.0 if moves is None else moves.degrees / 360 / max(moves.stop - moves.start, _AS_TOLD)
    slots.used |= {own.said for own in slots.amounts if own.unit == "turns/s" and abs(own.value - rate) < _AS_TOLD}
    seconds = slots.moment.lasting if more is None else more.value
    if moves is None or seconds is None:
        return  # only the scene tells when it stops now
    words = " ".join(slots.words)
    ends = round((moves.stop if more is not None or _EXTRA.search(words) else moves.start) + seconds, 4)
    if ends <= moves.stop or (stop is not None and abs(stop - ends) > _AS_TOLD):
        return
    slots.repeated |= {*slots.moment.said, *(() if more is None else (more.said,))}
    yield Wanted(pace(whose_of(slots), "go_on"), Moment(stop=ends), None)


_EXTRA = re.compile(
    r"\b(?:extra|more|another|longer|further|additional|beyond|prolong\w*|extend\w*|extension|add\w*)\b"
)
_AS_TOLD = 0.06  # seconds by which two tellings of one time may differ


_IN_TURN = re.compile(
    r"\bone (?:after|behind) (?:the )?(?:other|another)\b|\bone by one\b|\bin turn\b|\bstagger\w*|\bcascad\w+|"
    r"\bafter each other\b"
)


_SHUT_TILL = re.compile(r"\b(?:shut|closed) (?:till|until)\b")
_HELD = re.compile(r"\b(?:hold|wait|rest|pause|break|breather|hang\w*|stay\w*|linger\w*)\b")


def _opening(slots: Slots, verb: str) -> Iterator[Wanted]:
    moment = slots.moment
    if verb == "close" and isinstance(moment.stop, float) and _SHUT_TILL.search(" ".join(slots.words)):
        yield paced(slots, "begin", Moment(start=moment.stop))  # "hold the door shut till 2 s"
        return
    wide = slots.happening is None or slots.happening.during.state in ("fully_open", "open")
    held = verb == "close" and moment.start is None and wide and _HELD.search(slots.rest) is not None
    if held and moment.lasting is not None:  # "give the open door a one second hold, then swing it shut, closed by 4.5"
        once_open = Happening(During(state="fully_open", part="from"), "once it is open")
        ends = Moment(start=moment.lasting, stop=moment.stop, said=("then",))
        yield Wanted(f"close {slots.whom}", ends, once_open)
        return
    order = told_order(slots.words, slots.spans, slots.thing) if verb == "open" else None
    if order is not None and len(order.things) > 1:
        yield from in_turn(order.things, slots)
        return
    if verb == "open" and (together := in_step(slots)) is not None:
        yield together
        return
    if (apart := _beside_what_opens(slots, verb)) is not None:
        yield apart
        return
    if slots.goals or slots.moment.start == "end" or _IN_TURN.search(" ".join(slots.words)):
        return  # as another one does, or how it is at the end, or one after the other
    if _TOO.search(" ".join(slots.words)) and not slots.told:
        return  # by how much is not told
    by = slots.one("s")
    if by is not None and isinstance(slots.moment.start, float):
        slots.repeated.add(by.said)
    elif by is not None:
        sign = _sign(slots)
        if sign is not None and not slots.told:
            shift = pace(whose_of(slots), "later", seconds=sign * by.value)
            yield Wanted(replace(shift, during=_CLOSING) if verb == "close" else shift, Moment(), None)
        elif slots.happening is not None and slots.moment.empty:
            yield now(slots, f"{verb} {slots.whom}", start=by.value)
        return
    how = how_far(slots) if slots.amounts and verb == "open" else None
    moment = slots.moment if slots.moment.lasting is None else replace(slots.moment, taken=True)
    if moment.always and moment.start is not None:
        moment = replace(moment, stop="end", always=False)  # "at four, so that it is shut as the film ends"
    if isinstance(how, float):
        yield opened(whose_of(slots), plainly(moment), slots.happening, share=how)
    else:
        command = f"{verb} {slots.whom}" if how is None else f"open {slots.whom} {how}"
        yield Wanted(command, plainly(moment), slots.happening)


def _beside_what_opens(slots: Slots, verb: str) -> Wanted | None:
    """What opens so many seconds before or after another thing does: "half a second ahead of the top one"; None for
    others."""
    by = [own for own in slots.amounts if own.unit == "s"]
    goals = [goal for goal in slots.goals if is_opened(goal.query.text)]
    moves = slots.movement(goals[0].query) if len(goals) == 1 else None
    sign = -1 if _AHEAD.search(slots.rest) else 1 if _AFTER_IT.search(slots.rest) else 0
    if verb != "open" or slots.told or len(by) != 1 or moves is None or not sign or slots.moves(slots.queries[0]):
        return None
    start = moves.start + sign * by[0].value
    if start < 0:
        return None
    slots.used |= {by[0].said, goals[0].name}
    slots.repeated.add(by[0].said)
    return opened(whose_of(slots), Moment(start=round(start, 4)), None)


_AHEAD = re.compile(r"\b(?:before|ahead of|prior to|sooner than|earlier than) \|")


# -- one after the other -----------------------------------------------------------------------------------------------

_REVERSED = re.compile(
    r"\b(?:revers\w+|invert\w*|opposite|backwards?|other way (?:round|around)|flip\w*|contrary|inverse|"
    r"turn(?:ed)? (?:\w+ )*?(?:round|around)|swap\w*|back to front|other way about|topsy \w+|upside down|"
    r"last (?:one |in line )?(?:\w+ )?(?:lead\w*|first))\b"
)
_IN_FULL = re.compile(r"\b(?:only|last|end)\b|\bafter \| (?:has|have|is|are)\b")  # when the other one has done so
_AFTER_IT = re.compile(r"\b(?:after|behind|following) \|")
_SWAPS = re.compile(r"\b(?:swap\w*|exchang\w+|trad(?:e|es|ing)|switch\w*|permut\w+|interchang\w+|chang\w+ places)\b")


def _order(slots: Slots) -> Iterator[Wanted]:
    order = told_order(slots.words, slots.spans, slots.thing)
    goals = slots.goals
    slots.pass_goals()
    if (
        order is not None
        and all(is_opened(query.text) for query in order.things)
        and not all(map(slots.moves, order.things))
    ):
        yield from in_turn(order.things, slots)
        return
    gap, moves = gap_of(slots), slots.movement(ALL_MOVING)
    if moves is not None and slots.moment.start == round(moves.start, 2):
        slots.repeated |= set(slots.moment.said)  # "first of all, at 0.5 s", as the first one does now
    elif slots.told and (gap is None or slots.moment.start is not None or slots.happening is not None):
        return
    both = tuple(dict.fromkeys((*slots.queries, *(goal.query for goal in goals))))
    if (
        len(slots.names) == len(goals) == 1
        and _AFTER_IT.search(slots.rest)
        and goals[0].query.pick == "one"
        and (order is None or (order.alone and _IN_FULL.search(slots.rest)))
    ):
        after = During(state="moving", of=goals[0].query, part="after")
        yield Wanted(pace(whose_of(slots), "begin"), Moment(), Happening(after, f"after {goals[0].name}"))
    elif order is not None:
        yield Wanted(order.command(gap), Moment(), None)
    elif _SWAPS.search(slots.rest) and len(both) == 2 and not slots.told:
        pair = both[0].model_copy(update={"also": (both[1],)})
        yield Wanted(ordered(pair, "reversed"), Moment(), None)
    elif slots.tell(_REVERSED) and len(slots.names) == 1 and not goals:
        yield Wanted(f"let {slots.names[0]} move in reverse order", Moment(), None)


def _together(slots: Slots) -> Iterator[Wanted]:
    if (step := in_step(slots)) is not None:
        yield step
        return
    if _IN_TURN.search(slots.meant):
        return  # "one by one"
    if not slots.moves(slots.queries[0]) and slots.goals:
        yield from _move(slots)
        return
    others = [goal.query for goal in slots.goals if slots.moves(goal.query)]
    slots.pass_goals()
    who = tuple(dict.fromkeys((*slots.queries, *others)))
    hasty = slots.moment.slowly or slots.moment.quickly or slots.tell(_SLOWER) or slots.tell(_HASTE)
    several = len(who) > 1 or who[0].pick != "one" or bool(who[0].also)
    if not hasty and several and (slots.happening is None or slots.happening.until is None):
        things = replace(slots, queries=who)
        yield Wanted(ordered(whose_of(things), "together"), plainly(slots.moment), slots.happening)


_KINDS: dict[str, Callable[[Slots], Iterator[Wanted]]] = {
    "recolor": _recolor, "hide": _hide, "remove": _remove, "move": _move, "spin": _spin, "begin": _begin,
    "speed": _speed, "duration": _duration, "pause": _pause, "halt": _halt, "still": _still, "reverse": _reverse,
    "stay": _stay, "amount": goes_as_far, "open": partial(_opening, verb="open"),
    "close": partial(_opening, verb="close"),
    "order": _order, "together": _together, "repeat": _repeat, "return": _return, "longer": _longer,
}  # fmt: skip

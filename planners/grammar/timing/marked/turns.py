"""What turns, goes backwards, does so again or comes back: the commands of such wishes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from .....gaussians import late_re as re
from ..clauses import ALL_OF_IT
from ..command import pace
from ..moments import Moment
from .pacing import factor_of
from .slots import Slots
from .wanted import Wanted, now, paced, plainly, whose_of

_OTHER_WAY = re.compile(
    r"\b(?:(?:other|opposite|reverse|wrong|contrary) (?:way|direction|side|sense)|way (?:round|around)|direction|"
    r"sense|clockwise|anti ?clockwise|counter ?clockwise|counter|turns? (?:left|right))\b"
)

_BACKWARDS = re.compile(
    r"\b(?:backwards?|in reverse|rewind|rewound|back to front|from (?:the )?(?:end|back) to|end to start)\b"
)
_REWINDS_IT = re.compile(r"^(?:please |just )?(?:rewind|reverse|play|run) (?:it|this|that|it all|all of it)\b")
_THE_FILM = re.compile(  # "run the whole shot backwards, books fly up onto the board"
    r"\b(?:the|this|that|my|our) (?:(?:whole|entire|full|complete) )?"
    r"(?:film|clip|video|movie|shot|footage|recording|scene|take|animation)\b(?! (?:ends?|is over|stops))"
)

_TRAVELS = re.compile(
    r"\b(?:travel|roll|walk|driv|slid|march|fall|run|ris)(?:e?s|e|ing|ling)?\b|\bsetting (?:off|out)\b"
)


def spin(slots: Slots) -> Iterator[Wanted]:
    """What turns about itself."""
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


def reverse(slots: Slots) -> Iterator[Wanted]:
    """What moves or turns the other way."""
    slots.pass_goals()
    slots.used |= {own.said for own in slots.amounts if own.unit in ("deg", "%")}  # "from 80 degrees to 0"
    moves, moment, whose = slots.movement(slots.queries[0]), plainly(slots.moment), slots.queries[0]
    if slots.happening is not None or (slots.told and (moves is None or moves.turns)):
        return
    back = slots.goals or slots.told or slots.tell(_TRAVELS)  # "the wrong way round, from the wall to the sofa"
    if not back and slots.tell(_OTHER_WAY) and not slots.tell(_BACKWARDS):
        yield now(slots, f"let {slots.whom} turn the other way round")
        return
    film = not moment.told and (slots.tell(_THE_FILM) or slots.tell(_REWINDS_IT))
    every = whose.text == "everything" or film
    reverse = Wanted(pace(ALL_OF_IT if every else whose_of(slots), "reverse"), Moment(), None)
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


def repeat(slots: Slots) -> Iterator[Wanted]:
    """What does the same again."""
    slots.pass_goals()
    if slots.moment.always and slots.moment.start is not None:  # "again from 4.5 until the end"
        moment = replace(plainly(slots.moment), stop="end", always=False)
        yield Wanted(pace(whose_of(slots), "repeat", times=1), moment, slots.happening)
        return
    moves = slots.movement(slots.queries[0])
    if moves is not None and moves.turns and slots.moment.stop is None and _GOES_ON.search(slots.whole):
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


def go_back(slots: Slots) -> Iterator[Wanted]:
    """What comes back the way it came."""
    moves = slots.movement(slots.queries[0])
    if slots.goals and not slots.told and moves is None:
        return  # "roll to the wall and come back"
    slots.pass_goals()
    moment = plainly(slots.moment)
    ends = moment.lasting is not None or moment.stop is not None
    if moves is not None and not ends and slots.one("times", "%") and (factor := factor_of(slots)) is not None:
        moment = replace(moment, lasting=round((moves.stop - moves.start) / factor, 4), taken=True)
        slots.repeated |= {own.said for own in slots.amounts}  # "back at double speed"
    if moment.always and any(tag == "to" for tag, _, _ in slots.spans):
        moment = replace(moment, stop="end", always=False)  # it is back by the end
    elif moment.start == "end":
        moment = replace(moment, start=None, stop="end")
    yield paced(slots, "return", moment)

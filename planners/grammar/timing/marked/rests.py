"""What rests on its way, stops or does not move at all: the commands of such wishes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from .....gaussians import late_re as re
from ...vocabulary.nouns import is_opened
from ..command import pace
from ..happenings import IT, Happening
from ..moments import Moment
from .far import far_along, goes_as_far
from .pacing import EARLIER
from .slots import Slots
from .wanted import Wanted, paced, plainly, whose_of

_WIDE = {"state": "fully_open", "part": "from"}


def pause(slots: Slots) -> Iterator[Wanted]:
    """What rests on its way, and goes on."""
    slots.pass_goals()
    moment = replace(plainly(slots.moment), taken=False)
    if moment.always and moment.lasting is not None and _has_stopped(slots) and _GOES_AGAIN.search(slots.whole):
        again = Moment(start=moment.lasting, stop="end")  # "after it stops, half a second's peace, then on to the end"
        yield paced(slots, "repeat", again, times=1)
        return
    if moment.lasting is None and (seconds := slots.one("s")) is not None:
        moment = replace(moment, lasting=seconds.value)
    begun = moment.start is not None or slots.happening is not None
    if not begun and (moment.lasting is None) != (moment.stop is None):
        if (where := _where(slots)) is not None:
            yield _stopped(slots, where, moment)
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
        turns_on = moves is not None and moves.turns and moment.always
        if moves is not None and turns_on and moment.lasting is not None and moves.stop + moment.lasting > moves.end:
            over = paced(slots, "stop", Moment(start=moves.end))  # "then on till the film is over"
            rest = replace(rest, also=(over,))
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


def halt(slots: Slots) -> Iterator[Wanted]:
    """What stops for good on its way."""
    slots.pass_goals()
    moment = plainly(slots.moment)
    if not is_opened(slots.noun) and not slots.told and (length := slots.one("m")) is not None:
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
        if slots.happening is not None and slots.happening.until is not None and _ONLY.search(slots.whole):
            over = {"until": "from", "until_end": "after"}[slots.happening.until.part]
            ends = slots.happening.until.model_copy(update={"part": over})  # "it does the first leg only, then parks"
            yield Wanted(pace(whose_of(slots), "stop"), moment, Happening(ends, slots.happening.said))
            return
        yield paced(slots, "stop", replace(moment, stop=None) if moment.stop == "end" else moment)
        return
    if (where := _where(slots)) is not None:  # "it jams at 40 degrees till the film ends"
        yield _stopped(slots, where, Moment())
    elif ended:
        yield paced(slots, "stop", replace(moment, start=moment.stop, stop=None))


_ONLY = re.compile(r"\b(?:only|just|no (?:second|further|more|other))\b")
_SHORT_OF = re.compile(r"\b(?:short|before|away)\b")


def _where(slots: Slots) -> dict[str, Any] | None:
    """The time from when something is where it is to stop, as fields: at the other thing, or as far as is told; None if
    neither is told."""
    return _there(slots) or far_along(slots)


def _stopped(slots: Slots, during: dict[str, Any], moment: Moment) -> Wanted:
    """What stops, or rests, from when something is at a place.

    Args:
        during: the time from then on, as fields.
    """
    return Wanted(replace(pace(whose_of(slots), "stop"), during=during), moment, None)


def _there(slots: Slots) -> dict[str, Any] | None:
    """The time from when something is at the other thing that is named, as fields: "it stops on the rug"; None if none
    is named, or several."""
    goals = [goal for goal in slots.goals if not goal.query.last]
    passed = next((part for part, words in _PASSES.items() if words.search(slots.rest)), None)
    if passed is not None and len(goals) == 1 and not slots.amounts and not is_opened(slots.noun):
        return {"state": passed, "anchors": (goals[0].query,), "part": "after" if passed == "on" else "from"}
    goals = [goal for goal in goals if goal.way != "from"]
    if len(goals) != 1 or is_opened(slots.noun) or slots.amounts or slots.tell(_HALFWAY):
        return None
    if goals[0].query.text in _TURNING_POINTS:
        return {"state": "turning", "part": "after" if _TURNS_FIRST.search(slots.whole) else "from"}
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
    if moves is None or not moves.turns or slots.told or not slots.tell(EARLIER):
        return None
    by = slots.one("s", "")
    if by is None or moves.stop - by.value <= moves.start:
        return None
    slots.repeated.add(by.said)
    return paced(slots, "stop", Moment(start=round(moves.stop - by.value, 4)))


def still(slots: Slots) -> Iterator[Wanted]:
    """What does not move at all, or not at a time."""
    slots.pass_goals()
    slots.used |= {own.said for own in slots.amounts if own.value == 0}  # "at 0 m/s"
    others = slots.happening is not None and _AS_OTHERS.search(slots.happening.said) is not None
    if not slots.told or slots.moment.always or others:
        yield Wanted(pace(whose_of(slots), "stop"), Moment(), None)
    elif slots.happening is None:
        yield paced(slots, "stop")


_AS_OTHERS = re.compile(r"\b(?:while|as|when) (?:the |all the |both )?(?:others?|rest)\b")  # that move as they do


def stay(slots: Slots) -> Iterator[Wanted]:
    """What stays open, or where it has come to."""
    slots.pass_goals()
    if is_opened(slots.noun):
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
        yield from halt(slots)

"""What opens and closes, and what moves in an order or together: the commands of such wishes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from .....gaussians import late_re as re
from .....tools.when import During
from ...vocabulary.nouns import is_opened
from ..command import pace
from ..happenings import Happening
from ..moments import Moment
from .far import how_far
from .moves import move
from .orders import ordered, told_order
from .pacing import SLOWER, TOO, sign_of
from .slots import ALL_MOVING, Slots
from .steps import gap_of, in_step, in_turn, opened
from .wanted import Wanted, now, paced, plainly, whose_of

_HASTE = re.compile(r"\b(?:fast\w*|quick\w*|rapid\w*|swift\w*)\b")

_CLOSING = {"state": "closing"}

_IN_TURN = re.compile(
    r"\bone (?:after|behind) (?:the )?(?:other|another)\b|\bone by one\b|\bin turn\b|\bstagger\w*|\bcascad\w+|"
    r"\bafter each other\b"
)

_SHUT_TILL = re.compile(r"\b(?:shut|closed) (?:till|until)\b")

_HELD = re.compile(r"\b(?:hold|wait|rest|pause|break|breather|hang\w*|stay\w*|linger\w*)\b")


def opening(slots: Slots, verb: str) -> Iterator[Wanted]:
    """What opens or closes.

    Args:
        verb: "open" or "close".
    """
    moment = slots.moment
    if verb == "close" and isinstance(moment.stop, float) and _SHUT_TILL.search(slots.whole):
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
    if verb == "open" and (told := in_step(slots) or _beside_what_opens(slots)) is not None:
        yield told
        return
    if slots.goals or slots.moment.start == "end" or _IN_TURN.search(slots.whole):
        return  # as another one does, or how it is at the end, or one after the other
    if TOO.search(slots.whole) and not slots.told:
        return  # by how much is not told
    by = slots.one("s")
    if by is not None and isinstance(slots.moment.start, float):
        slots.repeated.add(by.said)
    elif by is not None:
        sign = sign_of(slots)
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


def _beside_what_opens(slots: Slots) -> Wanted | None:
    """What opens so many seconds before or after another thing does: "half a second ahead of the top one"; None for
    others."""
    by = [own for own in slots.amounts if own.unit == "s"]
    goals = [goal for goal in slots.goals if is_opened(goal.query.text)]
    moves = slots.movement(goals[0].query) if len(goals) == 1 else None
    sign = -1 if _AHEAD.search(slots.rest) else 1 if _AFTER_IT.search(slots.rest) else 0
    if slots.told or len(by) != 1 or moves is None or not sign or slots.moves(slots.queries[0]):
        return None
    start = moves.start + sign * by[0].value
    if start < 0:
        return None
    slots.used |= {by[0].said, goals[0].name}
    slots.repeated.add(by[0].said)
    return opened(whose_of(slots), Moment(start=round(start, 4)), None)


_AHEAD = re.compile(r"\b(?:before|ahead of|prior to|sooner than|earlier than) \|")

_REVERSED = re.compile(
    r"\b(?:revers\w+|invert\w*|opposite|backwards?|other way (?:round|around)|flip\w*|contrary|inverse|"
    r"turn(?:ed)? (?:\w+ )*?(?:round|around)|swap\w*|back to front|other way about|topsy \w+|upside down|"
    r"last (?:one |in line )?(?:\w+ )?(?:lead\w*|first))\b"
)

_IN_FULL = re.compile(r"\b(?:only|last|end)\b|\bafter \| (?:has|have|is|are)\b")  # when the other one has done so

_AFTER_IT = re.compile(r"\b(?:after|behind|following) \|")

_SWAPS = re.compile(r"\b(?:swap\w*|exchang\w+|trad(?:e|es|ing)|switch\w*|permut\w+|interchang\w+|chang\w+ places)\b")


def order(slots: Slots) -> Iterator[Wanted]:
    """What moves in another order."""
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


def together(slots: Slots) -> Iterator[Wanted]:
    """What moves when another thing does, or all at once."""
    if (step := in_step(slots)) is not None:
        yield step
        return
    if _IN_TURN.search(slots.meant):
        return  # "one by one"
    if not slots.moves(slots.queries[0]) and slots.goals:
        yield from move(slots)
        return
    others = [goal.query for goal in slots.goals if slots.moves(goal.query)]
    slots.pass_goals()
    who = tuple(dict.fromkeys((*slots.queries, *others)))
    hasty = slots.moment.slowly or slots.moment.quickly or slots.tell(SLOWER) or slots.tell(_HASTE)
    several = len(who) > 1 or who[0].pick in ("all", "any") or bool(who[0].also)
    if not hasty and several and (slots.happening is None or slots.happening.until is None):
        things = replace(slots, queries=who)
        yield Wanted(ordered(whose_of(things), "together"), plainly(slots.moment), slots.happening)

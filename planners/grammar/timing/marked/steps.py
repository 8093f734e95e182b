"""Things that open one after the other, or as another one does."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from .....gaussians import late_re as re
from .....gaussians.language.query.query import Query
from .....tools.when import During
from ...vocabulary.nouns import is_opened
from ..command import Command, pace
from ..happenings import IT, Happening
from ..moments import Moment
from .amounts import Amount
from .slots import Slots
from .wanted import Wanted

_APART = r"between|apart|gaps?|intervals?|distance|spaced|stagger\w*|each"
SPACED = re.compile(rf"\b(?:{_APART}|delay)\b")  # words by which seconds are those from one thing to the next
_LATER = re.compile(rf"\b(?:{_APART}|after|later|behind)\b")  # of things that open
_AS_ONE = re.compile(
    r"\b(?:same|together|with|as|like|sync\w*|step|unison|tandem|parallel|copy|copies|copying|mirror\w*|match\w*|"
    r"accompan\w+|follow\w*|alongside|simultaneous\w*|join\w*|both|does|doubles?)\b"
)
_STAYS = re.compile(
    r"\b(?:stays?|remains?|leave|left|keeps?|holds?) (?:\w+ )?(?:open|out)\b|\bnot (?:close|shut|go back)\b|"
    r"\bwhen (?:that|it|the [a-z ]+?) (?:slides? out|opens|comes? out)\b"
)
_OPENS_ALONE = re.compile(r"\b(?:open|opens|opening|slides? out|comes? out|pops? out)\b")
_CLOSES = re.compile(
    r"\b(?:clos\w+|shut\w*|back|in again|both|everything|motions?|movements?|moves?|copy|copies|copying|mirror\w*|"
    r"accompan\w+|does|together|sync\w*|step|tandem|same times?)\b"
)


def opened(query: Query, moment: Moment, happening: Happening | None, change: str = "open", **more: Any) -> Wanted:
    """What lets a thing open, or do another change of that; `more` tells how far."""
    command = Command(({"op": "articulate", "target": query, "change": change, **more},))
    return Wanted(command, moment, happening)


def gap_of(slots: Slots, words: re.Pattern[str] = SPACED) -> float | None:
    """The seconds from one thing of several to the next; None if none of some words says that there are any."""
    if words.search(slots.whole) is None:
        return None
    seconds = slots.one("s")
    return seconds.value if seconds is not None else slots.moment.lasting


def in_turn(things: Sequence[Query], slots: Slots) -> Iterator[Wanted]:
    """Things that open one after the other, in their order: each when the one before is open, or so many seconds after
    that began; what opens by itself begins then."""
    if not all(is_opened(query.text) for query in things) or slots.happening is not None:
        return
    slots.pass_goals()
    gap, start = gap_of(slots, _LATER), slots.moment.start
    steps = list[Wanted]()
    for at, query in enumerate(things):
        moves, moment, happening = slots.moves(query), Moment(), None
        if at:
            part = During(state="opening", of=things[at - 1], part="after" if gap is None else "from")
            moment, happening = Moment(start=gap), Happening(part, "after the one before")
        elif not moves or start is not None:
            moment = Moment(start=start if start is not None else 0.0)
        else:
            continue  # the first one opens when it does
        steps.append(Wanted(pace(query, "begin"), moment, happening) if moves else opened(query, moment, happening))
    if steps:
        yield replace(steps[0], also=tuple(steps[1:]))


def in_step(slots: Slots) -> Wanted | None:
    """What opens, and closes, when another does: "the middle drawer, in sync with the top one"; None for others."""
    movers = [query for query in slots.queries if slots.moves(query)]
    follow = tuple(query for query in slots.queries if query not in movers)
    other: Query | None = None
    during = None if slots.happening is None else slots.happening.during
    in_sync = during is None or (during.part == "while" and during.of in (None, IT))
    if len(movers) == 1 and follow and slots.moment.empty and in_sync and _AS_ONE.search(slots.whole):
        other = movers[0]  # "the middle drawer doubles the top one"
    elif movers:
        return None
    if not all(is_opened(query.text) for query in slots.queries):
        return None
    as_it_moves = slots.happening is not None and slots.happening.during.state in ("moving", "opening")
    if slots.happening is not None and as_it_moves and slots.happening.during.part == "while" and slots.moment.empty:
        of = slots.happening.during.of
        other = other if of in (None, IT) and other is not None else of
    elif not slots.told and len(slots.goals) == 1 and _AS_ONE.search(slots.rest):
        other = slots.goals[0].query
        slots.pass_goals()
    if other is None or not is_opened(other.text) or not slots.moves(other):
        return None
    words = slots.whole
    opening, closing = (
        Happening(During(state=state, of=other), f"as it is {state}") for state in ("opening", "closing")
    )
    length, angle = slots.one("m"), slots.one("deg")
    moves, share = slots.movement(other), slots.one("times")
    if length is None and moves is not None and share is not None and moves.metres:  # "half as far"
        length = Amount(round(moves.metres * share.value, 4), "m", share.said)
        slots.repeated.add(share.said)
    how_far: dict[str, Any] = {} if length is None else {"distance": {"value": length.value}}
    how_far |= {} if angle is None else {"degrees": angle.value}
    steps = [opened(query, Moment(), opening, **how_far) for query in follow]
    if not _STAYS.search(words) and _CLOSES.search(_OPENS_ALONE.sub(" ", words)):
        steps += [opened(query, Moment(), closing, "close") for query in follow]
    return replace(steps[0], also=tuple(steps[1:]))

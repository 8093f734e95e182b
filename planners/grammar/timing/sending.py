"""How what moves by itself goes on: where it is sent ("send the robot to the toy car"; "move the robot to the toy car"
shifts all of its way), what it does "then", and what opens in its place."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from ....tools.when import During, When
from ...plan import Movement
from .clauses import MOVING
from .command import Fields

_SENT = re.compile(
    r"(?:^|[.!?;:,] |\b(?:please|then|and|just|could you|can you) )"
    r"(?:(?:send|direct|steer|guide|route|dispatch) (?:the|my|our|this|that|him|her|it|them)\b|"
    r"(?:let|have|make) (?:the|my|our|this|that|him|her|it|them) (?:[a-z]+ ){0,3}?(?:go|come|head|travel|return)\b)"
)


_UP_TO = re.compile(r"\b(?:to|towards?|up to|over to) (?!the (?:top|left|right|front|back|other)\b)")
_THEN = re.compile(
    r"^(?:and )?(?:then|after that|after this|afterwards|subsequently|next)\b"
    r"(?! (?:to|door|time|one|frame))[ ,]*(?=\w)",
    re.IGNORECASE,
)
_GOES = ("move", "follow", "orbit", "spin", "tip", "sway", "articulate")


def without_then(cleaned: str) -> tuple[str, bool]:
    """An instruction without a word that puts it behind what was said before, and whether there was one."""
    shorter = _THEN.sub("", cleaned)
    return shorter, shorter != cleaned


def behind(ops: Sequence[Fields], moves: Callable[[Query], bool | None]) -> tuple[Fields, ...]:
    """Operations that begin when what they are about has moved; where that stands still, when all that moves has.

    Those with a time of their own, and those about something else than a movement, stay as they are.

    Args:
        moves: as `sent`.
    """
    if len(ops) != 1 or ops[0]["op"] not in _GOES:
        return tuple(ops)
    when = ops[0].get("when")
    timed = when is not None and (when.start, when.stop, when.during) != (None, None, None)
    if timed or (when is None and ops[0]["op"] == "move") or not moves(MOVING):
        return tuple(ops)
    of = None if moves(ops[0]["target"]) else MOVING
    after = During(state="moving", of=of, part="after")
    return ({**ops[0], "when": (when or When()).model_copy(update={"during": after})},)


def sent(cleaned: str, ops: Sequence[Fields], moves: Callable[[Query], bool | None]) -> tuple[Fields, ...]:
    """Operations in which what moves by itself is not put elsewhere, but goes there, if an instruction sends it.

    Args:
        moves: whether what a query names moves; None if that cannot be told.
    """
    if len(ops) != 1 or ops[0]["op"] != "move" or ops[0].get("when") is not None or not _SENT.search(cleaned.lower()):
        return tuple(ops)
    place = ops[0].get("place")
    if place is None or not moves(ops[0]["target"]):
        return tuple(ops)
    if not _UP_TO.search(cleaned.lower()) or len(place["anchors"]) != 1:
        return ({**ops[0], "when": When()},)
    return ({"op": "move", "target": ops[0]["target"], "when": When(), "toward": place["anchors"][0]},)


_IN_ITS_PLACE = re.compile(  # "pull out the bottom drawer instead of the top one"
    r"\b(?:open|pull|slide|draw|have|let|make)s? (?:out )?"
    r"(?P<x>the (?:[a-z]+ )?(?P<noun>drawer|door|lid|hatch|flap))\b[^.;]*?"
    r"\b(?:instead of|in place of|rather than|and not) the (?P<y>[a-z]+)(?: one| (?P=noun))?\b"
)


def in_its_place(
    cleaned: str, thing: Callable[[str], Query | None], movement: Callable[[Query], Movement | None]
) -> tuple[Fields, ...]:
    """The operations of a wish that one thing opens, and closes, when another one does by itself, which stays shut.

    None of other wishes.

    Args:
        thing: reads a phrase for things.
        movement: how what a query names moves; None if it does not.
    """
    if (said := _IN_ITS_PLACE.search(cleaned.lower())) is None:
        return ()
    own, other = thing(said["x"]), thing(f"the {said['y']} {said['noun']}")
    if own is None or other is None or own == other or movement(own) is not None:
        return ()
    if (moves := movement(other)) is None or moves.turns:
        return ()
    ways = {"open": "opening", "close": "closing"} if len(moves.edges) > 2 else {"open": "opening"}
    opened = tuple(
        {"op": "articulate", "target": own, "change": change, "when": When(during=During(state=state, of=other))}
        for change, state in ways.items()
    )
    return (*opened, {"op": "pace", "target": other, "change": "stop"})

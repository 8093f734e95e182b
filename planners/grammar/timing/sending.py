"""How what moves by itself goes on: where it is sent ("send the robot to the toy car"; "move the robot to the toy car"
shifts all of its way), what it does "then", and what opens in its place."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from ....tools.when import During, When
from ...plan import Movement
from ..parsing import Refusal
from .clauses import MOVING
from .command import Fields

_SENT = re.compile(
    r"(?:^|[.!?;:,] |\b(?:please|then|and|just|could you|can you) )"
    r"(?:(?:send|direct|steer|guide|route|dispatch) (?:the|my|our|this|that|him|her|it|them)\b|"
    r"(?:let|have|make) (?:the|my|our|this|that|him|her|it|them) (?:[a-z]+ ){0,3}?(?:go|come|head|travel|return)\b)",
    re.IGNORECASE,
)
_UP_TO = re.compile(r"\b(?:to|towards?) (?!the (?:top|left|right|front|back|other)\b)", re.IGNORECASE)
_DROPS = re.compile(r"\bdrop", re.IGNORECASE)
_THEN = re.compile(
    r"^(?:and )?(?:then|after that|after this|afterwards|subsequently|next)\b"
    r"(?! (?:to|door|time|one|frame))[ ,]*(?=\w)",
    re.IGNORECASE,
)
_NEAR = 0.05  # seconds before the end up to which something goes on to it
_GOES = ("move", "follow", "orbit", "spin", "tip", "sway", "articulate")


def without_then(cleaned: str) -> tuple[str, bool]:
    """An instruction without a word that puts it behind what was said before, and whether there was one."""
    shorter = _THEN.sub("", cleaned)
    return shorter, shorter != cleaned


def behind(ops: Sequence[Fields], movement: Callable[[Query], Movement | None]) -> tuple[Fields, ...]:
    """Operations that begin when what they are about has moved; where that stands still, when all that moves has.

    Those with a time of their own, those about something else than a movement, and those behind what goes on to the end
    of the scene stay as they are.

    Args:
        movement: how what a query names moves; None if it does not.
    """
    if len(ops) != 1 or ops[0]["op"] not in _GOES:
        return tuple(ops)
    when = ops[0].get("when")
    timed = when is not None and (when.start, when.stop, when.during) != (None, None, None)
    if timed or (when is None and ops[0]["op"] == "move"):
        return tuple(ops)
    own = movement(ops[0]["target"])
    moves = own or movement(MOVING)
    if moves is None or (moves.stop > moves.end - _NEAR and (own is None or own.turns)):
        return tuple(ops)
    after = During(state="moving", of=None if own else MOVING, part="after")
    return ({**ops[0], "when": (when or When()).model_copy(update={"during": after})},)


def require_no_loss(cleaned: str, ops: Sequence[Fields]) -> None:
    """Refuse operations that delete what is raised and dropped.

    Raises:
        Refusal: they do; with what to say instead.
    """
    lifted = any(op["op"] == "move" and op.get("direction") == "up" for op in ops[:-1])
    if lifted and ops[-1]["op"] == "delete" and _DROPS.search(cleaned):
        raise Refusal(
            "what is raised is dropped in its time: say when it is raised, as in 'raise it by 1 m at 1 s, then drop it'"
        )


def sent(cleaned: str, ops: Sequence[Fields], moves: Callable[[Query], bool | None]) -> tuple[Fields, ...]:
    """Operations in which what moves by itself is not put elsewhere, but goes there, if an instruction sends it.

    Args:
        moves: whether what a query names moves; None if that cannot be told.
    """
    if len(ops) != 1 or ops[0]["op"] != "move" or ops[0].get("when") is not None or not _SENT.search(cleaned):
        return tuple(ops)
    place = ops[0].get("place")
    if place is None or not moves(ops[0]["target"]):
        return tuple(ops)
    if not _UP_TO.search(cleaned) or len(place.get("anchors", ())) != 1:
        return ({**ops[0], "when": When()},)
    return ({"op": "move", "target": ops[0]["target"], "when": When(), "toward": place["anchors"][0]},)


_IN_ITS_PLACE = re.compile(  # "pull out the bottom drawer instead of the top one"
    r"\b(?:open|pull|slide|draw)(?: out| open)? "
    r"(?P<x>the (?:[a-z]+ )?(?P<noun>drawer|door|lid|hatch|flap))(?: out| open)? "
    r"(?:instead of|in place of|rather than|and not) the (?P<y>[a-z]+)(?: one| (?P=noun))?[ .!]*$"
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

"""What moves by itself and is sent somewhere goes there in its time: "send the robot to the toy car".

"Move the robot to the toy car" shifts all of its way.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from ....tools.when import When
from .command import Fields

_SENT = re.compile(
    r"(?:^|[.!?;:,] |\b(?:please|then|and|just|could you|can you) )"
    r"(?:(?:send|direct|steer|guide|route|dispatch) (?:the|my|our|this|that|him|her|it|them)\b|"
    r"(?:let|have|make) (?:the|my|our|this|that|him|her|it|them) (?:[a-z]+ ){0,3}?(?:go|come|head|travel|return)\b)"
)


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
    if place["relation"] != "next_to" or len(place["anchors"]) != 1:
        return ({**ops[0], "when": When()},)
    return ({"op": "move", "target": ops[0]["target"], "when": When(), "toward": place["anchors"][0]},)

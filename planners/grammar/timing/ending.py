"""An end that is to be earlier or later than it is: "the fan stops two seconds earlier than now".

Only the scene tells when that is. What turns round and round stops then, or goes on until then; what goes somewhere is
there then, at another speed, or stops on its way if that is said.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from ....tools.when import When
from ...plan import Movement
from .command import Fields

_ENDS = re.compile(
    r"\b(?:reach(?:es|ing)?|gets? (?:there|to)|stop(?:s|ping)?|halt\w*|finish\w*|end(?:s|ing)?|arriv\w+|be there|"
    r"(?:switch|turn|cut|go)\w* (?:off|out)|come\w* to (?:a |its )?(?:stop|halt|rest|standstill))\b"
)
_STARTS = re.compile(
    r"\b(?:start\w*|begin\w*|depart\w*|set\w* off|leav\w+|clos\w+|shut\w*|open\w*|back|fall\w*|drop\w*)\b"
)
_STOPS = re.compile(r"\b(?:stop|halt|standstill|rest|off)")
_SHORTEST = 0.05  # seconds of a movement

MovementOf = Callable[[Query], Movement | None]  # how what a query names moves; None if it does not, or if unknown


def with_end(said: str, ops: Sequence[Fields], movement: MovementOf) -> tuple[Fields, ...]:
    """Operations that move a whole movement in time, as ones that move its end, if that is what is said.

    Args:
        said: the instruction, in lower case.
        movement: how things move in the scene.
    """
    shifts = len(ops) == 1 and ops[0]["op"] == "pace" and ops[0].get("change") == "later" and ops[0].get("when") is None
    if not shifts or _STARTS.search(said) or not _ENDS.search(said):
        return tuple(ops)
    op = ops[0]
    moves = movement(op["target"])
    if moves is None:
        return tuple(ops)
    stop = round(moves.stop + op["seconds"], 4)
    if stop < moves.start + _SHORTEST:
        return tuple(ops)
    made = {"op": "pace", "target": op["target"]}
    if op["seconds"] < 0 and (moves.turns or _STOPS.search(said)):
        return ({**made, "change": "stop", "when": When(start=stop)},)
    if moves.turns:
        return ({**made, "change": "go_on", "when": When(stop=stop)},)
    return (between(op, round(moves.start, 4), stop),)


def stopping_later(ops: Sequence[Fields], movement: MovementOf) -> tuple[Fields, ...]:
    """A stop at seconds at which something rests already as one that it only comes to then, on the same way: "it is to
    come to rest only at 4.7 s"; none of others."""
    op = ops[0] if len(ops) == 1 else {}
    when = op.get("when")
    stop = when.start if when is not None and when == When(start=when.start) else None
    if op.get("change") != "stop" or not isinstance(stop, float) or (moves := movement(op["target"])) is None:
        return ()
    if stop <= moves.stop:
        return ()
    if moves.turns:
        return ({"op": "pace", "target": op["target"], "change": "go_on", "when": When(stop=stop)},)
    return (between(op, round(moves.start, 4), stop),)


def between(op: Fields, start: float, stop: float) -> Fields:
    """An operation on a movement as one that gives it another beginning and end."""
    return {"op": "pace", "target": op["target"], "change": "begin", "when": When(start=start, stop=stop)}

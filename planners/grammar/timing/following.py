"""Operations one after the other, where one says how another goes on, or says it once more."""

from __future__ import annotations

from collections.abc import Sequence

from ....tools.when import When
from .command import Fields
from .happenings import IT


def followed(ops: Sequence[Fields], more: Sequence[Fields]) -> list[Fields]:
    """Operations one after the other; "it stops at 1 s and starts again at 2 s" is one rest from 1 to 2 s."""
    last = ops[-1] if ops else {}
    then = more[0] if len(more) == 1 else {}
    if (
        _waits_until(last)
        and then.get("when") is None
        and then.get("change") in ("begin", "open", "go_on")
        and then["target"] in (IT, last["target"])
    ):
        return list(ops)  # "keep it closed until 3 s, then let it open"
    if last.get("change") == then.get("change") == "stop" and then.get("when") is None and _is_from(last):
        return list(ops)  # "freeze it at 2 s and do not let it move again"
    hidden = last.get("op") in ("opacity", "delete") and _is_from(last)
    if hidden and then.get("change") == "return" and isinstance(then.get("when"), When) and then["target"] == IT:
        if then["when"].start is None or then["when"].during is not None:
            return [*ops, *more]
        return [*ops[:-1], {**last, "when": last["when"].model_copy(update={"stop": then["when"].start})}]
    moves = last.get("op") in ("articulate", "move", "spin", "orbit", "follow")
    if moves and then.get("change") == "stop" and then.get("when") is None and then["target"] == IT:
        return list(ops)  # "swing to 45 degrees, then stop"
    stop, start = last.get("when"), then.get("when")
    if (last.get("change"), then.get("change")) != ("stop", "begin") or then["target"] not in (IT, last["target"]):
        return [*ops, *more]
    if not isinstance(stop, When) or not isinstance(start, When) or start.start is None or stop.stop or stop.lasting:
        return [*ops, *more]
    return [*ops[:-1], {**last, "when": stop.model_copy(update={"stop": start.start})}]


def _waits_until(op: Fields) -> bool:
    """Whether an operation holds a thing still until a time, so that it moves afterwards."""
    when = op.get("when")
    return op.get("change") == "stop" and isinstance(when, When) and when.start is None and when.stop is not None


def _is_from(op: Fields) -> bool:
    """Whether an operation holds from a time on to the end."""
    when = op.get("when")
    return isinstance(when, When) and when.stop is None and when.lasting is None and when != When()


def says_again(ops: Sequence[Fields], more: Sequence[Fields]) -> bool:
    """Whether one operation tells the time of the one before."""
    if len(ops) != 1 or len(more) != 1 or ops[0].get("when") is not None or more[0].get("when") is None:
        return False
    same = all(ops[0].get(k) == more[0].get(k) for k in ("op", "change"))
    return same and more[0].get("target") in (IT, ops[0].get("target"))

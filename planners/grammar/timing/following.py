"""Operations one after the other, where one says how another goes on, or says it once more."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ....gaussians import late_re as re
from ....gaussians.world.lengths import in_metres
from ....tools.when import Part, When
from ..parsing import Refusal
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
    if then and {**then, "target": last.get("target")} == last and then["target"] == IT:
        return list(ops)  # "the fan goes the wrong way round. Turn it the other way"
    if _colors_again(last, then) and isinstance(last.get("when"), When):
        return [*ops, {**then, "when": _afterwards(last["when"])}]
    at_all_times = last.get("change") == "stop" and last.get("when") is None
    if at_all_times and then.get("change") == "begin" and then.get("when") is not None and then["target"] == IT:
        return [*ops[:-1], {**then, "target": last["target"]}]  # "wait and fall at 3 s"
    if last.get("change") == then.get("change") == "stop" and then.get("when") is None and then["target"] == IT:
        return list(ops)  # "freeze it at 2 s and do not let it move again", "... for 1 s, then let it finish"
    rests = last.get("change") == "stop" and isinstance(last.get("when"), When) and last["when"].lasting is not None
    if rests and then.get("change") in ("go_on", "begin") and then.get("when") is None and then["target"] == IT:
        return list(ops)  # "freeze it for one second, then let it keep rolling"
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


def dropped(part: str, ops: Sequence[Fields]) -> str:
    """A command behind others: what was lifted and is dropped comes down as far, and is not deleted."""
    last = ops[-1] if ops else {}
    if last.get("op") != "move" or last.get("direction") != "up" or last.get("distance") is None:
        return part
    value, unit = last["distance"]["value"], last["distance"]["unit"]
    fallen = _FALL * math.sqrt(in_metres(value, "m" if unit == "units" else unit))
    return _DROPPED.sub(rf"move \g<np> {value:g} {unit} down in {fallen:.2g} s once it has stopped", part)


_DROPPED = re.compile(r"^(?:then )?(?:drop|let (?=\w+ fall)) ?(?P<np>it|him|her|the \w+(?: \w+)?)(?: fall)?$")
_FALL = (2 / 9.81) ** 0.5  # seconds in which something falls by a metre


def goes_back(last: Fields, more: Sequence[Fields]) -> bool:
    """Whether operations give a thing the look that it has when another operation ends: "then green again"."""
    return len(more) == 1 and _colors_again(last, more[0]) and isinstance(last.get("when"), When)


def _colors_again(last: Fields, then: Fields) -> bool:
    """Whether an operation without a time gives another look to what has just got one: "then yellow"."""
    same = last.get("op") in _LOOKS and then.get("op") in _LOOKS and then["target"] in (IT, last["target"])
    return same and then.get("when") is None


def _afterwards(when: When) -> When:
    """The time after another one.

    Raises:
        Refusal: it has no end.
    """
    if when.stop is not None:
        return When(start=when.stop)
    if when.until is not None and when.lasting is None:
        return When(during=when.until.model_copy(update={"part": _ENDS[when.until.part]}))
    if when.lasting is not None and when.during is None and not isinstance(when.start, str):
        return When(start=(when.start or 0.0) + when.lasting)
    if when.lasting is None and when.during is not None and when.during.part in _ENDS:
        return When(during=when.during.model_copy(update={"part": _ENDS[when.during.part]}))
    raise Refusal("say from when on it is to look like that", "then")


_LOOKS = ("recolor", "restyle")
_ENDS: dict[Part, Part] = {"while": "after", "until": "from", "until_end": "after"}


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

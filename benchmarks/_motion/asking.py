"""Written questions about the moving rooms, asked of a session and judged against what the rooms are known to do."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from statistics import median
from typing import Any, Literal

from ...agent.session.session import Session
from ...gaussians.world.words import singular
from ...planners.questions.answer import Answer
from ..harness import Metric
from . import rooms
from .written import cases

Outcome = Literal["right", "wrong", "refused"]

RIGHT, WRONG = 0.85, 0.03  # goals: at least, at most
DETAIL = 0.3  # of the rooms: what is asked does not depend on it
_SAME = {  # one of the first unit in the second
    ("m", "cm"): 100.0, ("cm", "m"): 0.01, ("turns/s", "rpm"): 60.0, ("turns/s", "deg/s"): 360.0,
    ("m/s", "cm/s"): 100.0, ("rpm", "turns/s"): 1 / 60, ("deg/s", "turns/s"): 1 / 360,
}  # fmt: skip
_COUNTED = ("turns", "times", "things", "steps")  # units of answers that are plain numbers
_PLACING = {"at", "on", "in", "by", "the", "near", "next", "to", "beside", "of"}
_ALIKE = 0.6  # of the words of an event in an order that must be told


@dataclass(frozen=True)
class Asked:
    """One question with what came of it.

    Attributes:
        case: as written.
        outcome: a question that has no answer is right if none is given, and wrong otherwise.
        answer: the answer.
        seconds: of the processor.
    """

    case: dict[str, Any]
    outcome: Outcome
    answer: Answer
    seconds: float


@cache
def session(room: str) -> Session:
    """One session for each room: nothing that is asked changes it."""
    return Session(rooms.moving_room(room, DETAIL))


def asked(which: Sequence[dict[str, Any]]) -> list[Asked]:
    """Each question asked by itself: "it" refers to nothing that was asked before."""
    found = []
    for case in which:
        own = session(case["room"])
        own.recall(None)
        started = time.process_time()
        answer = own.ask(case["text"])
        found.append(Asked(case, judged(case["expect"], answer), answer, time.process_time() - started))
    return found


def judged(expect: dict[str, Any], answer: Answer) -> Outcome:
    """Whether an answer is the one that is expected."""
    kind, value, given = expect["kind"], expect["value"], answer.answer
    if kind == "refuse":
        return "right" if given is None else "wrong"
    if given is None:
        return "refused"
    if kind in ("number", "seconds"):
        return _number(expect, answer)
    if kind == "yesno":
        return "right" if given == ("yes" if value else "no") else "wrong"
    if kind == "place":
        return "right" if _words(value) - _PLACING <= _words(f"{given} {answer.text}") else "wrong"
    told = [given] if isinstance(given, str) else list(given) if isinstance(given, tuple) else []
    if kind == "names":
        each = all(any(_names(v, t) for v in value) for t in told)
        several = any(singular(v.split()[-1]) != v.split()[-1] for v in value)  # "chairs" are all four
        fits = each and all(any(_names(v, t) for t in told) for v in value)
        return "right" if fits and (several or len(told) == len(value)) else "wrong"
    fits = len(told) == len(value) and all(_tells(v, t) or _names(v, t) for v, t in zip(value, told, strict=True))
    return "right" if fits else "wrong"


def _number(expect: dict[str, Any], answer: Answer) -> Outcome:
    unit = expect.get("unit", "s" if expect["kind"] == "seconds" else "")
    value = answer.answer
    if not isinstance(value, float):
        return "wrong"
    if unit and answer.unit != unit and not (unit in _COUNTED and not answer.unit):
        if (answer.unit, unit) not in _SAME:
            return "wrong"
        value *= _SAME[answer.unit, unit]
    return "right" if abs(value - expect["value"]) <= expect["tolerance"] + 1e-9 else "wrong"


def _words(said: str) -> set[str]:
    return {singular(w.strip(".,;:()")) for w in said.lower().split()}


def _names(wanted: str, told: str) -> bool:
    """Whether two names are of one thing: the words of one are among those of the other."""
    a, b = _words(wanted), _words(told)
    return a <= b or b <= a


def _tells(wanted: str, told: str) -> bool:
    """Whether an event is told: most of its words are."""
    return len(_words(wanted) & _words(told)) >= _ALIKE * len(_words(wanted))


def metrics(which: str) -> list[Metric]:
    """The shares of a set of questions; none if the set is not there.

    Args:
        which: "questions" or "held_questions".
    """
    found = asked(cases(which))
    if not found:
        return []
    counts = Counter(a.outcome for a in found)
    return [
        Metric(f"{which}.right", counts["right"] / len(found), "share", "higher", 0.02, RIGHT),
        Metric(f"{which}.wrong", counts["wrong"] / len(found), "share", "lower", 0.02, WRONG),
        Metric(f"{which}.asked", float(len(found)), "count"),
        Metric(f"{which}.cpu", median(a.seconds for a in found), "s", "lower", 0.5),
    ]

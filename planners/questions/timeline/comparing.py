"""Answers comparisons of times, speeds and ways, and of these with a number: "does it open faster than it closes?"."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from ....gaussians.world.lengths import METRES
from ..answer import Answer
from ..reading.time.comparing import Comparison
from ..telling import evidence
from .asked import SURE, cap, nothing

EQUAL = 0.05  # of the larger: numbers that differ by less are the same
_DIFFER = "They differ: "
_UNITS = {  # of a unit as said: the unit of answers, and how many of it one is
    "m": ("m", 1.0), "cm": ("m", 0.01), "mm": ("m", 0.001), "ft": ("m", METRES["ft"]), "in": ("m", METRES["in"]),
    "m/s": ("m/s", 1.0), "cm/s": ("m/s", 0.01), "km/h": ("m/s", 1 / 3.6), "mph": ("m/s", 0.44704),
    "turns/s": ("turns/s", 1.0), "rpm": ("turns/s", 1 / 60), "deg/s": ("turns/s", 1 / 360),
    "rad/s": ("turns/s", 0.15915494),
}  # fmt: skip
_SIGNS = {"milli": "mm", "mm": "mm", "centi": "cm", "cm": "cm", "f": "ft", "in": "in", "m": "m"}
_STILL = re.compile(r"The [\w ()]+ does not move\.|The [\w ()]+ never moves\.")
Asking = Callable[[str], Answer]


def compared(comparison: Comparison, ask: Asking) -> Answer | None:
    """The answer to a comparison; None if one of the two has no number here.

    Args:
        ask: answers a plain question about the scene.
    """
    first = _number(comparison.first, ask)
    if first is None:
        return None
    if comparison.relation == "same" and not comparison.second and not comparison.unit:
        return _yes_no(not first.text.startswith(_DIFFER), comparison, [first])
    if not isinstance(first.answer, float):
        return None
    if not comparison.second:
        if first.unit != _sign(comparison.unit):
            return None
        return _yes_no(_holds(comparison, first.answer, comparison.number), comparison, [first])
    second = _number(comparison.second, ask) or _nothing_moved(comparison.second, first, ask)
    if second is None or not isinstance(second.answer, float):
        return None
    a, b = _in_one_unit(first, second)
    if a is None or b is None or (first.text == second.text and comparison.relation != "same"):
        return None
    if comparison.asks == "difference":
        unit = first.unit if first.unit == second.unit else _UNITS[first.unit][0]
        return first.model_copy(update={
            "answer": abs(a - b), "answer_type": "metres" if unit == "m" else "number", "unit": unit,
            "text": f"By {abs(a - b):.2f} {unit}: {first.text} {second.text}",
        })  # fmt: skip
    if comparison.asks == "which":
        if _same(a, b):
            return nothing(f"They do not differ: {first.text} {second.text}"[:4000])
        best = (a > b) == (comparison.relation == "more")
        name = comparison.names[0 if best else 1]
        return _given(name, "label", f"{cap(name)}: {first.text} {second.text}", [first, second])
    return _yes_no(_holds(comparison, a, b * comparison.number), comparison, [first, second])


def _sign(unit: str) -> str:
    """The unit of the answer to a question that names its unit so; "" of what is counted."""
    rate = re.search(r"(?: per | a | an | / | each | every |^)(?=second$|sec$|s$|minute$|min$|hour$|h$)", unit)
    if unit.startswith(
        ("rpm", "rev", "turn", "rot", "round", "hz", "hertz", "rps", "full", "whole", "complete", "times ")
    ):
        if unit == "rpm" or (rate and "min" in unit):
            return "rpm"
        return "turns/s" if rate or unit in ("rps", "hz", "hertz") else ""
    if unit in ("things", "times"):
        return ""
    if unit.startswith("deg"):
        return "deg/s" if rate else "deg"
    if re.match(r"s$|sec", unit):
        return "s"
    if unit.startswith(("kmh", "kph", "mph")):
        return "mph" if unit == "mph" else "km/h"
    sign = next((sign for said, sign in _SIGNS.items() if unit.startswith(said)), "m")
    return f"{sign}/s" if rate or unit == "mps" else sign


def _number(ways: Sequence[str], ask: Asking) -> Answer | None:
    """The first answer that is a number, or tells that several differ."""
    for words in ways:
        answer = ask(words)
        if (isinstance(answer.answer, float) and "Read as" not in answer.text) or answer.text.startswith(_DIFFER):
            return answer
    return None


def _nothing_moved(ways: Sequence[str], like: Answer, ask: Asking) -> Answer | None:
    """None of it, in the unit of another answer, of what does not move."""
    for words in ways:
        answer = ask(words)
        if answer.answer is None and _STILL.fullmatch(answer.text):
            return like.model_copy(update={"answer": 0.0, "text": answer.text, "evidence": answer.evidence})
    return None


def _in_one_unit(first: Answer, second: Answer) -> tuple[float | None, float | None]:
    a, b = first.answer, second.answer
    assert isinstance(a, float) and isinstance(b, float)
    if first.unit == second.unit:
        return a, b
    if first.unit not in _UNITS or second.unit not in _UNITS:
        return None, None
    (one, scale), (other, by) = _UNITS[first.unit], _UNITS[second.unit]
    return (a * scale, b * by) if one == other else (None, None)


def _same(a: float, b: float) -> bool:
    return abs(a - b) <= EQUAL * max(abs(a), abs(b))


def _holds(comparison: Comparison, a: float, b: float) -> bool:
    said = comparison.unit != ""  # a number that is said is not rounded
    if comparison.relation == "same":
        return a == b if comparison.unit in ("things", "times") else _same(a, b)
    if comparison.relation == "at_least":
        return a >= b * (1 - 0.01)
    if comparison.relation == "at_most":
        return a <= b * (1 + 0.01)
    near = abs(a - b) <= 0.01 * max(abs(a), abs(b)) if said else _same(a, b)
    return not near and (a > b if comparison.relation == "more" else a < b)


def _yes_no(holds: bool, comparison: Comparison, answers: Sequence[Answer]) -> Answer:
    holds = holds != comparison.denied
    text = " ".join(a.text for a in answers)
    return _given("yes" if holds else "no", "yesno", f"{'Yes' if holds else 'No'}: {text}", answers)


def _given(said: str, kind: str, text: str, answers: Sequence[Answer]) -> Answer:
    ids = tuple(dict.fromkeys(i for a in answers for i in a.evidence.ids))
    shown = evidence(()).model_copy(update={"ids": ids, "time": answers[0].evidence.time})
    sure = min(SURE, *(a.confidence for a in answers))
    return Answer(answer=said, answer_type=kind, text=text[:4000], confidence=sure, evidence=shown)  # type: ignore[arg-type]

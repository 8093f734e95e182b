"""Questions that people wrote about composed rooms, and the judgement of answers by numbers, sets and key facts.

Sets in folders of their own, each with its rooms. The reader was developed with `dev` and `wider`. `held` was written
before the reader; its failures were read at the end. Of `later`, by a writer who saw no code, only totals were read. A
line of `questions.jsonl` holds room, question, answer_type, answer (null: it cannot be answered), accept (other right
answers), tolerance (relative, of numbers), kind and a note.
"""

from __future__ import annotations

import re
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from statistics import fmean
from typing import Any, Literal

from ...planners.questions import asking
from ...planners.questions.survey import Survey
from ...planners.rooms.graph import SceneGraph
from .. import _data
from ..harness import Metric
from .question import OVERLAP, overlap, plain

FOLDER = Path(__file__).resolve().parents[2] / "tests" / "planners" / "asked"
SETS = ("dev", "wider", "held", "later")
TOLERANCE = 0.06  # relative error of a number for which a line states none
UNITS = {  # to metres, square metres: words that a question asks a number in
    "feet": 0.3048, "foot": 0.3048, "ft": 0.3048, "inches": 0.0254, "inch": 0.0254, "cm": 0.01, "centimetres": 0.01,
    "centimeters": 0.01, "mm": 0.001, "square feet": 0.3048**2, "sq ft": 0.3048**2, "yards": 0.9144,
}  # fmt: skip
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
_EMPTY = ("nothing", "none")
Outcome = Literal["right", "wrong", "unanswered"]


@dataclass(frozen=True)
class Answered:
    """One written question answered.

    Attributes:
        case: as written.
        outcome: "right"; "wrong"; "unanswered": a refusal where there is an answer. A question that cannot be answered
            is right if it is refused, and wrong otherwise.
        answer, told: what came.
        seconds: that it took.
    """

    case: dict[str, Any]
    outcome: Outcome
    answer: Any
    told: str
    seconds: float = 0.0


def cases(which: str, folder: Path = FOLDER) -> list[dict[str, Any]]:
    """The questions of a set; none if the set is not there."""
    path = folder / which / "questions.jsonl"
    return _data.instructions(path) if path.is_file() else []


@cache
def survey(room: str, which: str, folder: Path = FOLDER) -> Survey:
    """A room of a set, ready to be asked."""
    return Survey.of_graph(SceneGraph.read(folder / which / room))


def judge(case: dict[str, Any], answer: Any, told: str) -> Outcome:
    """Whether an answer (a value of `Answer.answer`, and its sentence) is one of those that were written down."""
    wanted = case["answer"]
    empty = answer in (None, (), [])
    if wanted is None:
        absent = case["kind"] == "absent" and (answer == "no" or answer == 0)
        return "right" if empty or absent else "wrong"
    if wanted in ("no", 0) and empty:
        return "right" if case["kind"] == "absent" and _denies(told) else "unanswered"
    if empty:
        return "unanswered"
    return "right" if _agrees(case, answer, told) else "wrong"


def _denies(told: str) -> bool:
    return re.search(r"\b(no|not|none|nothing)\b", told.lower()) is not None and told != asking.NOT_READ


def _agrees(case: dict[str, Any], answer: Any, told: str) -> bool:
    wanted, accepted, kind = case["answer"], case["accept"], case["answer_type"]
    if kind == "yesno":
        return str(answer).lower() == wanted
    if kind in ("number", "metres"):
        return _is_number(case, answer, told)
    if kind == "list":
        given = list(answer) if isinstance(answer, tuple | list) else _parts(str(answer))
        return _is_list(given, wanted, accepted)
    given = list(answer) if isinstance(answer, tuple | list) else [answer]
    options = [str(o) for o in (wanted if isinstance(wanted, list) else [wanted]) + accepted]
    if kind == "label":
        return len({plain(str(g)) for g in given}) == 1 and _named(str(given[0]), options)
    return _mentions(f"{answer} {told}", options)


def _is_number(case: dict[str, Any], answer: Any, told: str) -> bool:
    """A number within the tolerance of an accepted one, in the unit asked for or in metres."""
    given = [float(answer)] if isinstance(answer, int | float) else [float(n) for n in _NUMBER.findall(str(answer))]
    options = [float(case["answer"]), *(float(a) for a in case["accept"] if isinstance(a, int | float))]
    tolerance = case["tolerance"]
    if case["answer_type"] == "number" and tolerance is None and float(case["answer"]).is_integer():
        return len(given) == 1 and given[0] in options
    within = TOLERANCE if tolerance is None else tolerance
    asked = case["question"].lower()
    factors = [1.0, *(f for word, f in UNITS.items() if re.search(rf"\b{word}\b", asked))]
    return any(abs(g - o * f) <= within * abs(o * f) for g in given[:1] for o in options for f in factors)


def _is_list(given: Sequence[Any], wanted: Any, accepted: Sequence[Any]) -> bool:
    """The same set of names but for spellings; `accepted` holds other names of members."""
    if not isinstance(wanted, list):
        wanted = [wanted]
    also = {plain(str(a)) for a in accepted}
    known = {plain(str(w)) for w in wanted}
    named = [g for g in given if plain(str(g)) not in also - known]
    return overlap(named, [str(w) for w in wanted]) >= OVERLAP or (not named and bool(given))


def _parts(text: str) -> list[str]:
    return [p for p in re.split(r",| and ", text) if p.strip()] if text.lower() not in _EMPTY else []


def _named(given: str, options: Sequence[str]) -> bool:
    """The same name as one of the options, or a longer one that ends with it or begins with it."""
    own = plain(given)
    for option in options:
        other = plain(option)
        longer = f" {own} ".find(f" {other} ") >= 0
        if own == other or longer:
            return True
    return False


def _mentions(text: str, options: Sequence[str]) -> bool:
    """Whether a free text holds one of the key facts: its words in this order, or a number near it."""
    told = " ".join(re.findall(r"[a-z0-9.]+", text.lower()))
    for option in options:
        words = " ".join(re.findall(r"[a-z0-9.]+", option.lower()))
        if f" {words} " in f" {told} " or f" {plain(words)} " in f" {told} ":
            return True
        if _NUMBER.fullmatch(words) and any(abs(float(n) - float(words)) < 0.06 for n in _NUMBER.findall(told)):
            return True
    return False


def measure(which: str, folder: Path = FOLDER) -> list[Answered]:
    """Every question of a set, asked."""
    found = []
    for case in cases(which, folder):
        room = survey(case["room"], which, folder)
        start = time.perf_counter()
        try:
            given = asking.answer(case["question"], room)
            answer, told = given.answer, given.text
            outcome = judge(case, answer, told)
        except Exception as error:  # one fault of the product must not hide what else it answers
            answer, told, outcome = None, f"{type(error).__name__}: {error}", "wrong"
        found.append(Answered(case, outcome, answer, told, time.perf_counter() - start))
    return found


def metrics(which: str, answered: Sequence[Answered]) -> list[Metric]:
    """Shares answered, wrong and right of a set; of `dev` also by kind. A refusal of what cannot be answered counts as
    answered and right."""
    if not answered:
        return []

    def share(of: Sequence[Answered], *outcomes: str) -> float:
        return fmean(a.outcome in outcomes for a in of) if of else 0.0

    given = [a for a in answered if a.outcome != "unanswered"]
    held = which == "later"
    found = [
        Metric(
            f"written.{which}.answered",
            share(answered, "right", "wrong"),
            "share",
            "higher",
            0.0,
            0.9 if held else None,
        ),
        Metric(f"written.{which}.wrong", share(answered, "wrong"), "share", "lower", 0.0, 0.03 if held else None),
        Metric(f"written.{which}.right", share(answered, "right"), "share", "higher"),
        Metric(f"written.{which}.right_of_answered", share(given, "right"), "share", "higher"),
        Metric(f"written.{which}.questions", len(answered), "count"),
    ]
    return found


def report(answered: Sequence[Answered]) -> str:
    """What is not right, for those who develop the reader with the set `dev`."""
    lines = []
    for a in answered:
        if a.outcome != "right":
            c = a.case
            lines.append(f"{a.outcome} [{c['room']} {c['kind']}] {c['question']}\n    {c['answer']} {c['accept']}; "
                         f"answer {a.answer}: {a.told}")  # fmt: skip
    return "\n".join(lines) + "\n"

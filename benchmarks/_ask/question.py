"""`Question` with its exact truth, and the judgement of the product's answer to it."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean
from typing import Any, Literal

from ...gaussians.world import kinds
from ...gaussians.world.words import singular

Type = Literal["yesno", "number", "metres", "label", "list", "none"]
Expect = Literal["answer", "absent", "undecidable", "several"]
STRICTNESS = tuple(0.5 + 0.05 * k for k in range(10))  # of the mean relative accuracy of VSI-Bench
CLOSE = 0.1  # relative error up to which a length or an area counts as right
OVERLAP = 0.8  # F1 from which a list counts as right
_NEGATIVE = re.compile(r"\b(no|not|none|nothing|without|never|neither|absent|missing|cannot find)\b|n't\b")


@dataclass(frozen=True)
class Question:
    """One question about one room.

    Attributes:
        room: name of its room.
        kind: kind of question.
        text: as asked.
        type: of its answer.
        truth: answers that are right; of several any is. A list is a tuple of labels; of what is absent,
            its name.
        expect: "answer", or how it is rightly refused.
        side: whether the answer depends on where the viewer stands.
        about: ids of the true things that decide the answer, those that the words name first.
        names: ids of the true things that the words name.
    """

    room: str
    kind: str
    text: str
    type: Type
    truth: tuple[Any, ...]
    expect: Expect = "answer"
    side: bool = False
    about: tuple[int, ...] = ()
    names: tuple[int, ...] = ()


@dataclass(frozen=True)
class Judged:
    """An answer and what it is worth.

    Attributes:
        question: as asked.
        answer: the answer's value.
        told: its sentence.
        right: whether it is right.
        refused: whether nothing was answered.
        accuracy: mean relative accuracy of a number, 0 if there is none; of other questions 1 or 0.
        seconds: that the answer took.
    """

    question: Question
    answer: Any
    told: str
    right: bool
    refused: bool
    accuracy: float
    seconds: float = 0.0


def judge(question: Question, answer: Any, told: str, seconds: float = 0.0, ids: Sequence[Any] = ()) -> Judged:
    """What an answer (a value of `Answer.answer`, its sentence, and the ids of its evidence) is worth."""
    refused = answer is None
    if question.expect == "undecidable":
        return Judged(question, answer, told, refused, refused, float(refused), seconds)
    if question.expect == "absent":
        empty = answer in (None, "no", 0, (), [])
        right = empty and _tells_absence(told, str(question.truth[0]))
        return Judged(question, answer, told, right, refused, float(right), seconds)
    if question.expect == "several":
        right = (refused and len(ids) > 1) or (isinstance(answer, tuple | list) and len(answer) > 1)
        return Judged(question, answer, told, right, refused, float(right), seconds)
    if question.type in ("number", "metres"):
        accuracy = max(relative_accuracy(answer, t) for t in question.truth)
        right = any(_close(answer, t, question.type == "number" and float(t).is_integer()) for t in question.truth)
        return Judged(question, answer, told, right, refused, accuracy, seconds)
    right = not refused and any(_same(answer, t, question.type) for t in question.truth)
    return Judged(question, answer, told, right, refused, float(right), seconds)


def relative_accuracy(answer: Any, truth: float) -> float:
    """Mean relative accuracy as VSI-Bench defines it: the share of thresholds t with an error below 1 - t."""
    if not isinstance(answer, int | float) or isinstance(answer, bool):
        return 0.0
    error = abs(answer - truth) / abs(truth) if truth else (0.0 if answer == 0 else 1.0)
    return fmean(error <= 1 - t + 1e-9 for t in STRICTNESS)


def _close(answer: Any, truth: float, whole: bool) -> bool:
    if not isinstance(answer, int | float) or isinstance(answer, bool):
        return False
    return answer == truth if whole else abs(answer - truth) <= CLOSE * abs(truth)


def _same(answer: Any, truth: Any, type: Type) -> bool:
    if type == "yesno":
        return bool(answer == truth)
    if type == "list":
        given = answer if isinstance(answer, tuple | list) else (answer,)
        return overlap(given, truth) >= OVERLAP
    if isinstance(answer, tuple | list):
        return len(answer) == 1 and plain(answer[0]) == plain(truth)
    return plain(str(answer)) == plain(truth)


def overlap(given: Sequence[Any], wanted: Sequence[str]) -> float:
    """F1 of two sets of names, each with its number where both lists repeat names."""
    a, b = Counter(plain(str(g)) for g in given), Counter(plain(w) for w in wanted)
    if not a and not b:
        return 1.0
    if max(a.values(), default=0) <= 1 or max(b.values(), default=0) <= 1:
        a, b = Counter(set(a)), Counter(set(b))
    hits = sum((a & b).values())
    return 2 * hits / (sum(a.values()) + sum(b.values()))


def _tells_absence(told: str, name: str) -> bool:
    """Whether a sentence names the kind and says that there is none."""
    words = {singular(w) for w in re.findall(r"[a-z]+", told.lower())}
    return singular(name.split()[-1]) in words and _NEGATIVE.search(told.lower()) is not None


_SIDES = {"left", "right", "front", "ahead", "behind", "back"}
_ALIKE = {"ahead": "front", "back": "behind", "grey": "gray"}
_ARTICLES = re.compile(
    r"^(?:the|a|an|on the|to the|in|at the|one|two|three|four|five|six|\d+|very|dark|light|pale|bright|deep|vivid) +"
)


def plain(name: str) -> str:
    """A name as the name of its kind, a side as one word, a colour in one spelling; articles, numbers and
    qualifiers of colours go."""
    text = " ".join(str(name).lower().replace(",", " ").split()).strip(" .")
    sides = [w for w in re.findall(r"[a-z]+", text) if w in _SIDES]
    if len(set(sides)) == 1:
        return _ALIKE.get(sides[0], sides[0])
    before = ""
    while before != text:
        before, text = text, _ARTICLES.sub("", text)
    text = _ALIKE.get(text, text)
    kind = kinds.of(text) or kinds.of(singular(text))
    return kind.name if kind is not None else singular(text)

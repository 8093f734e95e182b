"""Asks generated questions in rooms of Gaussians and of graphs, and reports what is right by kind of question."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from statistics import fmean

from ...gaussians import assets
from ...gaussians.language.encoders import Encoder
from ...gaussians.world import kinds
from ...planners.questions import asking
from .._select import cases
from ..harness import Metric
from . import rooms
from .generate import questions
from .question import Judged, Question, judge
from .rooms import Known

RIGHT = {"gaussians": 0.92, "graphs": 0.98}  # goals
REFUSED, ACCURATE = 0.95, 0.90
NUMBERS = ("number", "metres")


def ask(known: Known, question: Question) -> Judged:
    """One question answered from geometry; a question that raises an error counts as wrong."""
    start = time.process_time()
    try:
        given = asking.answer(question.text, known.survey)
    except Exception as error:  # one fault of the product must not hide what else it answers
        failed = judge(question, None, f"{type(error).__name__}: {error}", time.process_time() - start)
        return replace(failed, right=False, refused=False, accuracy=0.0)
    seconds = time.process_time() - start
    return judge(question, given.answer, given.text, seconds, given.evidence.ids)


def asked(known: Sequence[Known], vocabulary: Sequence[str], count: int, held: bool = False) -> list[Judged]:
    """`count` questions over the rooms, asked; with `held` in the wordings that were held back."""
    at = {k.table.name: k for k in known}
    return [ask(at[q.room], q) for q in questions([k.table for k in known], vocabulary, count, held)]


def graph_rooms(count: int, seed: int) -> list[Known]:
    """Composed rooms."""
    return rooms.of_graphs(count, seed)


def every_kind() -> tuple[str, ...]:
    """All kinds of things, from which absent ones are drawn for graphs."""
    return tuple(kinds.table().kinds)


def shown_kinds(encoder: Encoder) -> tuple[str, ...]:
    """The kinds that the encoder was trained with, from which absent ones are drawn for rooms of Gaussians."""
    return tuple(n for n in encoder.vocabulary.names if kinds.find(n) is not None)


@cache
def furnished(seed: int, detail: float) -> tuple[cases.Case, tuple[float, float, float]]:
    """A furnished room, not embedded, and its inner size."""
    room = assets.furnish(seed, detail=detail)
    return cases.case_of(room, seed), room.size


def gaussian_rooms(seeds: Sequence[int], encoder: Encoder, detail: float = 1.0) -> list[Known]:
    """Furnished rooms, embedded as users embed them."""
    found = []
    for seed in seeds:
        case, size = furnished(seed, detail)
        found.append(rooms.surveyed(cases.embedded(case, encoder), size, encoder))
    return found


def metrics(judged: Sequence[Judged], source: str, by_kind: bool = True) -> list[Metric]:
    """Shares of right answers, of rightly refused questions, and the mean relative accuracy of numbers."""

    def right(of: Sequence[Judged]) -> float:
        return fmean(j.right for j in of) if of else 0.0

    answerable = [j for j in judged if j.question.expect == "answer"]
    numbers = [j for j in judged if j.question.type in NUMBERS]
    found = [Metric(f"{source}.right", right(judged), "share", "higher", 0.02, RIGHT.get(source))]
    for name, expect in (
        ("absent_told", "absent"),
        ("undecidable_abstained", "undecidable"),
        ("several_told", "several"),
    ):
        own = [j for j in judged if j.question.expect == expect]
        if own:
            goal = REFUSED if expect != "several" else None
            found.append(Metric(f"{source}.{name}", right(own), "share", "higher", 0.03, goal))
    undecidable = [j for j in judged if j.question.expect == "undecidable"]
    if undecidable:
        said = fmean(j.refused and j.told != asking.NOT_READ for j in undecidable)
        found.append(Metric(f"{source}.undecidable_said", said, "share", "higher", 0.05))
    if numbers:
        goal = ACCURATE if source == "gaussians" else None
        accuracy = fmean(j.accuracy for j in numbers)
        found.append(Metric(f"{source}.numbers.mra", accuracy, "MRA", "higher", 0.03, goal))
    found.append(Metric(f"{source}.answered", fmean(not j.refused for j in answerable), "share", "higher", 0.02))
    found.append(
        Metric(f"{source}.wrong", fmean(not j.refused and not j.right for j in answerable), "share", "lower", 0.1)
    )
    found.append(Metric(f"{source}.questions", len(judged), "count"))
    if by_kind:
        for kind in sorted({j.question.kind for j in judged}):
            own = [j for j in judged if j.question.kind == kind]
            found.append(Metric(f"{source}.right.{kind}", right(own), "share", "higher", 0.1))
    return found


def report(judged: Sequence[Judged]) -> str:
    """The wrong answers by kind of question, for those who develop the reader."""
    lines = []
    for kind in sorted({j.question.kind for j in judged}):
        own = [j for j in judged if j.question.kind == kind]
        wrong = [j for j in own if not j.right]
        lines.append(f"== {kind}: {len(own) - len(wrong)} of {len(own)} right")
        for j in wrong:
            q = j.question
            truth = " | ".join(map(_shown, q.truth)) or q.expect
            lines.append(f"  [{q.room}] {q.text}\n      truth {truth}; answer {_shown(j.answer)}: {j.told}")
    return "\n".join(lines) + "\n"


def _shown(value: object) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)

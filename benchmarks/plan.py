"""bench plan: how often a planner is right on the written instructions, by kind, and how long it takes.

Knows the written set and what counts as right. Refuses to count an abstention as a wrong edit: right, abstained and
wrong are three figures, because a wrong edit costs a user more than a refusal.
"""

from __future__ import annotations

import json
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from ..gaussians.errors import FileError
from ..planners.plan import EditPlan, Planner
from ..tools import registry

CASES = Path(__file__).resolve().parent.parent / "tests" / "planners" / "instructions.jsonl"
Outcome = Literal["right", "abstained", "wrong"]


@dataclass(frozen=True)
class Answer:
    """One instruction answered.

    Attributes:
        kind: kind of instruction.
        outcome: "right" (operations equal to the expected, or the expected verdict), "abstained" (no operations where
            some were expected, or the wrong reason for having none) or "wrong" (other operations than expected).
        seconds: best of the repetitions.
    """

    kind: str
    outcome: Outcome
    seconds: float


def cases(path: Path = CASES) -> list[dict[str, Any]]:
    """The written instructions.

    Raises:
        FileError: the set is not there (it is in the repository, not in the installed package).
    """
    if not path.is_file():
        raise FileError(f"no instructions at {path}; run this benchmark from a checkout of the repository")
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def judge(plan: EditPlan, case: dict[str, Any]) -> Outcome:
    """Whether a plan is what was expected."""
    expected = tuple(registry.parse(op) for op in case.get("ops", ()))
    if plan.ops:
        return "right" if plan.ops == expected else "wrong"
    return "right" if plan.verdict == case.get("verdict", "ok") else "abstained"


def measure(planner: Planner, todo: Iterable[dict[str, Any]], repeat: int = 3) -> list[Answer]:
    """Every instruction planned `repeat` times; the fastest counts, as interruptions only ever slow down."""
    answers = []
    for case in todo:
        best = float("inf")
        for _ in range(repeat):
            started = time.perf_counter()
            plan = planner.plan(case["text"], previous=case.get("previous"))
            best = min(best, time.perf_counter() - started)
        answers.append(Answer(case["kind"], judge(plan, case), best))
    return answers


def share(answers: Sequence[Answer], outcome: Outcome) -> float:
    """Share of answers with this outcome, 0 for none."""
    return sum(a.outcome == outcome for a in answers) / len(answers) if answers else 0.0


def rows(answers: Sequence[Answer]) -> list[tuple[str, float, str, str, float]]:
    """Figures as `(key, value, unit, direction, tolerance)`: shares by kind and in all, milliseconds an instruction."""
    kinds = sorted({a.kind for a in answers})
    by_kind = [(f"right.{kind}", share([a for a in answers if a.kind == kind], "right")) for kind in kinds]
    overall = [("right", share(answers, "right")), ("abstained", share(answers, "abstained"))]
    # Shares depend on nothing but code and set, so no tolerance; times vary by half from run to run on a busy machine.
    figures = [
        (key, value, "share", "lower" if key == "abstained" else "higher", 0.0) for key, value in overall + by_kind
    ]
    figures.append(("wrong_edits", share(answers, "wrong"), "share", "lower", 0.0))
    times = sorted(1e3 * a.seconds for a in answers)
    for name, at in (("p50", 0.5), ("p95", 0.95), ("max", 1.0)):
        figures.append((f"ms.{name}", times[min(int(at * len(times)), len(times) - 1)], "ms", "lower", 0.5))
    return figures

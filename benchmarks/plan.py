"""bench plan: how often a planner is right on the written instructions, by kind, and how long it takes.

Knows the written set and what counts as right. Refuses to count an abstention as a wrong edit: right, abstained and
wrong are three figures, because a wrong edit costs a user more than a refusal.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from ..gaussians.errors import FileError
from ..planners import grammar, load
from ..planners.plan import EditPlan, Planner
from ..tools import registry
from .harness import Metric, Point, Result

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


def metrics(answers: Sequence[Answer]) -> tuple[Metric, ...]:
    """Shares right, abstained and wrong; right by kind; milliseconds an instruction."""
    found = [
        Metric("right", share(answers, "right"), "share", "higher"),
        Metric("abstained", share(answers, "abstained"), "share", "lower"),
        Metric("wrong_edits", share(answers, "wrong"), "share", "lower"),
    ]
    for kind in sorted({a.kind for a in answers}):
        found.append(Metric(f"right.{kind}", share([a for a in answers if a.kind == kind], "right"), "share", "higher"))
    times = sorted(1e3 * a.seconds for a in answers)
    for name, at in (("p50", 0.5), ("p95", 0.95), ("max", 1.0)):
        # Half: a tenth of a millisecond of Python varies that much with what else the machine does.
        found.append(Metric(f"ms.{name}", times[min(int(at * len(times)), len(times) - 1)], "ms", "lower", 0.5))
    return tuple(found)


def loading() -> float:
    """Seconds from import to a planner that is ready, in a fresh interpreter, without the import of the tools."""
    code = (
        "import time, scenewright.tools.registry; t = time.perf_counter(); "
        "from scenewright.planners import load; load('grammar'); print(time.perf_counter() - t)"
    )
    return float(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout)


def run(quick: bool = False) -> Result:
    """The grammar planner on the written set, with and without the instruction before.

    Raises:
        FileError: the set is not there.
    """
    todo = cases()
    planner = load("grammar")
    repeat = 1 if quick else 5
    told = measure(planner, todo, repeat)
    untold = measure(planner, [{k: v for k, v in c.items() if k != "previous"} for c in todo], repeat)
    held = sum(f.stat().st_size for f in Path(grammar.__file__).parent.iterdir() if f.suffix in (".py", ".lark"))
    points = tuple(
        Point("grammar", setting, statistics.median(a.seconds for a in answers), share(answers, "right"), held, default)
        for setting, answers, default in (("with context", told, True), ("without context", untold, False))
    )
    start = Metric("ms.loading", 1e3 * min(loading() for _ in range(repeat)), "ms", "lower", 0.5)
    notes = (
        f"{len(todo)} instructions written by the planner's own author: a regression set, not an estimate of how it "
        "does on other people's words.",
        "Right means the very same operations, or the expected kind of refusal; the scene is not looked at.",
    )
    return Result("plans of written instructions", "share right", (*metrics(told), start), points, notes)

"""The benchmark of planners: an abstention is not a wrong edit, and the shares add up."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenewright.benchmarks import _spoiled
from scenewright.benchmarks import plan as bench
from scenewright.gaussians.errors import FileError
from scenewright.planners import EditPlan
from scenewright.planners.grammar import GrammarPlanner
from scenewright.tools import registry


def plan(*ops: dict[str, object], verdict: str = "ok") -> EditPlan:
    parsed = tuple(registry.parse(op) for op in ops)
    return EditPlan(instruction="x", planner="test", ops=parsed, verdict=verdict)  # type: ignore[arg-type]


CHAIR = {"op": "delete", "target": {"text": "chair"}}
SOFA = {"op": "delete", "target": {"text": "sofa"}}


@pytest.mark.parametrize(
    ("given", "case", "outcome"),
    [
        (plan(CHAIR), {"ops": [CHAIR]}, "right"),
        (plan(SOFA), {"ops": [CHAIR]}, "wrong"),
        (plan(CHAIR, SOFA), {"ops": [CHAIR]}, "wrong"),
        (plan(CHAIR), {"verdict": "not_an_edit"}, "wrong"),
        (plan(verdict="not_understood"), {"ops": [CHAIR]}, "abstained"),
        (plan(verdict="not_understood"), {"verdict": "not_understood"}, "right"),
    ],
)
def test_judgement(given: EditPlan, case: dict[str, object], outcome: str) -> None:
    assert bench.judge(given, case) == outcome


def test_shares_add_up() -> None:
    answers = bench.measure(GrammarPlanner(), bench.cases()[::10], repeat=1)
    figures = {m.key: m.value for m in bench.metrics(answers)}
    assert figures["right"] + figures["abstained"] + figures["wrong_edits"] == pytest.approx(1.0)
    assert 0 < figures["ms.p50"] <= figures["ms.p95"] <= figures["ms.max"]


@pytest.mark.slow
def test_whole_benchmark() -> None:
    result = bench.run(quick=True)
    figures = {m.key: m.value for m in result.metrics}
    assert figures["right"] >= figures["right.without_context"]
    grammar, cascade, *models = result.points
    assert grammar.default and grammar.accuracy <= cascade.accuracy
    assert all(cascade.seconds < model.seconds / 5 for model in models)
    assert all("not a real model" in point.method for point in (cascade, *models))
    assert any("accounted, not slept" in note for note in result.notes)


def test_missing_set_is_told(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="checkout"):
        bench.cases(tmp_path / "none.jsonl")


@pytest.mark.slow
def test_spoiled_plans_are_wrong_and_are_not_carried_out() -> None:
    right = _spoiled.right_plans()
    assert len(right) > 500 and all(not one.how for one in right)
    wrong = _spoiled.spoiled_plans(right, 3)
    assert len({one.how for one in wrong}) == 10 and len(wrong) == 30
    passed = [one for one in wrong if _spoiled.carried_out(one, _spoiled.guarded) == "wrong_edit"]
    unasked = [
        (one.how, one.case["id"]) for one in passed if one.how != "missing"
    ]  # a part left undone is no unasked edit
    assert len(unasked) <= 1 and len(passed) <= 2, unasked
    assert sum(_spoiled.carried_out(one, _spoiled.guarded) != "right" for one in right[::20]) <= 1

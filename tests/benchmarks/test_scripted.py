"""The stand-in for a model: right by its script, wrong as often as it is told, and never called a model."""

from __future__ import annotations

from typing import Any

import pytest

from scenewright.agent.session.observation import GraphObservation
from scenewright.benchmarks import _cascade, _scripted, _written
from scenewright.gaussians.errors import BackendError
from scenewright.planners.cascade import Cascade
from scenewright.planners.grammar import GrammarPlanner
from scenewright.planners.plan import EditPlan

CASES = [c for c in _written.cases() if not _written.is_held(c)]


def test_without_errors_it_is_right_on_every_instruction_to_look_at() -> None:
    judged = _written.measure(_scripted.Scripted(0.0, 1), CASES)
    assert [(j.case["text"], j.told) for j in judged if j.outcome != "right"] == []
    assert all(j.asked for j in judged)


def test_it_errs_as_often_as_it_is_told() -> None:
    outcomes = [j.outcome for j in _written.measure(_scripted.Scripted(0.3, 1), CASES)]
    # 224 draws at 0.3: three standard deviations are 0.09
    assert 1 - outcomes.count("right") / len(outcomes) == pytest.approx(0.3, abs=0.09)
    assert outcomes.count("unanswered") > 10 and outcomes.count("wrong_edit") > 10
    every = [j.outcome for j in _written.measure(_scripted.Scripted(1.0, 1), CASES[::5])]
    assert "right" not in every


def test_its_latency_is_accounted_and_its_own() -> None:
    case = CASES[0]
    observation = GraphObservation(_written.stage(case["room"]))
    first, again = (_scripted.Scripted(0.0, 1).plan(case["text"], observation=observation) for _ in range(2))
    assert first.usage == again.usage and first.usage is not None
    other = _scripted.Scripted(0.0, 2).plan(case["text"], observation=observation)
    assert other.usage is not None and other.usage.seconds != first.usage.seconds
    (plain,) = _written.measure(_scripted.Scripted(0.0, 1), [case])
    (told,) = _written.measure(_scripted.Scripted(0.0, 1), [case], accounted=True)
    # planning itself takes milliseconds, the stated latency most of a second
    assert plain.seconds < first.usage.seconds <= told.seconds


def test_what_it_has_no_script_for_is_read_as_the_grammar_does() -> None:
    plan = _scripted.Scripted(1.0, 1).plan(
        "delete the unicorn", observation=GraphObservation(_written.stage("kitchen"))
    )
    assert plan.planner == "grammar" and plan.usage is None
    assert _scripted.Scripted(1.0, 1).plan(CASES[0]["text"]).planner == "grammar"  # it did not see the room


UNFIT = ("not_understood", "absent", "ambiguous")  # what a guessed reading may come to


@pytest.mark.slow
def test_the_cascade_asks_it_only_where_the_grammar_abstains_or_its_reading_does_not_fit_the_room() -> None:
    grammar = GrammarPlanner()
    cascade = Cascade(grammar, None, _scripted.Scripted(0.0, 1))
    for alone, both in zip(_written.measure(grammar, CASES), _written.measure(cascade, CASES), strict=True):
        assert both.outcome == ("right" if both.asked else alone.outcome)
        assert not both.asked or alone.outcome != "right" or alone.case["verdict"] in UNFIT


def test_a_model_that_fails_counts_as_an_abstention() -> None:
    class Down:
        name = "down"

        def plan(self, text: str, **_: Any) -> EditPlan:
            raise BackendError("the server is down")

    plan = _cascade._ModelAlone(Down()).plan("delete the sofa")
    assert (plan.verdict, plan.planner, plan.reason) == ("not_understood", "down", "the server is down")


@pytest.mark.slow
def test_a_real_model_is_measured_where_one_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(_cascade.VARIABLE, "openai:some-model")
    monkeypatch.setattr(_cascade, "QUICK_STRIDE", 60)
    monkeypatch.setattr(_cascade, "load", lambda spec: GrammarPlanner() if spec == "grammar" else _Named(spec))
    metrics, points, (note,) = _cascade.measure(quick=True)
    assert [p.method for p in points] == ["grammar", "cascade: grammar, then openai:some-model", "openai:some-model"]
    assert "the real model openai:some-model was asked" in note and "stand-in" not in note
    assert {m.key.split(".")[0] for m in metrics} == {"grammar", "cascade", "model"}


class _Named(_scripted.Scripted):
    """The stand-in under a model's name."""

    def __init__(self, name: str) -> None:
        super().__init__(0.0, 1)
        self.name = name  # type: ignore[misc]

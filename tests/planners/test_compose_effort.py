"""Rooms composed at an effort: words give the same room on every machine, seconds end the search."""

from __future__ import annotations

import time

import pytest

from scenewright.gaussians.effort import Dial
from scenewright.planners.compose.api import compose, composed
from scenewright.planners.compose.problems import problem_of
from scenewright.planners.compose.sampling import sample_brief
from scenewright.planners.layout.problem import Item, Problem
from scenewright.planners.layout.solver import attempt, solve

ROOM = "an office with two desks and a bookshelf"


@pytest.fixture(autouse=True)
def _without_calibration(monkeypatch: pytest.MonkeyPatch, tmp_path: object) -> None:
    monkeypatch.setenv("SCENEWRIGHT_EFFORT", f"{tmp_path}/effort.json")


def test_balanced_is_what_nobody_asks_for() -> None:
    assert compose(ROOM, effort="balanced") == compose(ROOM)


def test_the_choice_counts_the_things_of_the_room() -> None:
    dial = Dial(60.0)
    made = composed(ROOM, dial=dial)
    assert [c.size for c in dial.choices] == [len(made.problem.items)]


def test_a_search_ends_when_its_time_is_over() -> None:
    problem = problem_of(sample_brief("bedroom", 10, 3), 3).problem
    first = attempt(problem, 3, 4.0, until=time.perf_counter())
    assert first.layout.graph.nodes
    assert attempt(problem, 3, 4.0, until=time.perf_counter() + 1e6).layout.graph == solve(problem, 3, effort=4.0).graph


def test_an_attempt_is_explained_as_a_solution_is() -> None:
    wardrobe = Item(id="wardrobe", label="wardrobe", size=(1.0, 0.6, 2.6))
    low = Problem(size=(4, 4, 2.5), items=(wardrobe,))
    assert attempt(low).layout.conflicts == ()
    assert attempt(low).explained().conflicts == solve(low).conflicts != ()

"""Of commands that start cold the least of several runs is told, and one that fails is no measurement."""

from __future__ import annotations

import pytest

from scenewright.benchmarks import start
from scenewright.gaussians.errors import BackendError


def test_the_least_of_each_is_kept_without_the_first_run(monkeypatch: pytest.MonkeyPatch) -> None:
    costs = iter([(9, 1), (9, 1), (5, 4), (6, 3), (7, 2), (4, 4)])
    monkeypatch.setattr(start, "_timed", lambda command: start.Cost(*next(costs)))
    found = start.measured({"a": ["a"], "b": ["b"]}, runs=2)
    assert found == {"a": start.Cost(5, 2), "b": start.Cost(4, 3)}


def test_a_command_is_timed_and_its_modules_are_counted() -> None:
    cost = start._timed(["--version"])
    assert cost.processor > 0 and cost.elapsed > 0
    assert start._modules(["--version"]) > 50


def test_a_command_that_fails_is_no_measurement() -> None:
    with pytest.raises(BackendError, match=r"^nonsense ended with 2: .*--help"):
        start._timed(["nonsense"])

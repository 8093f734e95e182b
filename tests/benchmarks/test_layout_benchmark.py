"""The benchmark of layouts: its problems are what it says they are, and its judgement sees what is wrong."""

from __future__ import annotations

import numpy as np
import pytest

from scenewright.benchmarks import _rooms, _tasks, layout
from scenewright.planners.layout import Item, Problem, Wish


def test_rooms_are_of_twelve_kinds_and_repeatable() -> None:
    first, again = (list(_rooms.problems(12, 8000)) for _ in range(2))
    assert first == again and len({kind for kind, _ in first}) == 12
    assert all(8 <= len(problem.items) <= 30 for _, problem in first)
    assert any(w.hard for _, problem in first for w in problem.wishes)


def test_stated_relations_hold_in_the_witness() -> None:
    kind = "gym"
    rng = np.random.default_rng(8001)
    problem = _rooms.problem(kind, 8001)
    at = _rooms._witness(problem.size, problem.items, rng)
    assert len(at) == sum(i.stand is None and i.support == "floor" and i.size[2] > 0.05 for i in problem.items)
    boxes = {i.id: i.size for i in problem.items}
    for name, (x, y) in at.items():
        reach = min(boxes[name][:2]) / 2
        assert abs(x) <= problem.size[0] / 2 - reach and abs(y) <= problem.size[1] / 2 - reach


def test_the_tasks_are_problems_of_their_rooms() -> None:
    found = dict(_tasks.tasks())
    if not found:
        pytest.skip("the data are not here; set SCENEWRIGHT_DATA")
    assert len(found) == 11
    assert found["dining_room_0"].size[:2] == (5.0, 5.0)
    assert sum(w.name == "around" for w in found["dining_room_0"].wishes) == 6


def test_judgement_counts_what_is_kept_and_missing() -> None:
    items = (Item(id="a", label="a", size=(0.5, 0.5, 0.5)), Item(id="b", label="b", size=(9.0, 9.0, 1.0)))
    wishes = (Wish(subject="a", name="in_corner"), Wish(subject="a", name="next_to", objects=("b",), hard=False))
    found = layout.judge("x", Problem(size=(3, 3, 2.5), items=items, wishes=wishes))
    assert (found.hard, found.soft, found.left_out) == ((1, 1), (0, 1), 1)
    assert found.explained and not found.wrong
    told = {m.key: m.value for m in layout.metrics("x", [found])}
    assert told["x.relations_kept"] == 1.0 and told["x.habits_kept"] == 0.0 and told["x.left_out"] == 0.5

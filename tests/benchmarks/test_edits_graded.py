"""Graded edits: a grade holds for the pictures that were looked at, questions are answered only as committed, and
what changed is what the sheets show."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenewright.benchmarks import edits
from scenewright.benchmarks._edits.graded import carrying, grades, sheets
from scenewright.benchmarks._edits.graded.carrying import Carried, Instruction, Picture
from scenewright.benchmarks._edits.graded.scenes import SETTINGS, Place, Setting
from scenewright.gaussians.assets.furnishing.furnish import furnish
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.language import encoders
from scenewright.gaussians.language.field.embed import embed


def instruction(text: str, id: str = "T01") -> Instruction:
    return Instruction(id, "room", text, "as said", False)


def carried(outcome: carrying.Outcome = "done", questions: int = 0, look: str = "aa", key: str = "T01 room") -> Carried:
    return Carried(key, outcome, questions, "said", (), look)


def row(grade: int, **fields: object) -> grades.Row:
    made = carried(**fields)  # type: ignore[arg-type]
    return grades.Row(instruction("x"), made, grades.Grade(grade, False, "why"))


def test_a_grade_holds_only_for_the_pictures_that_were_looked_at() -> None:
    known = {"T01 room": {"look": "aa", "grade": 3, "silent": False, "why": "fine"}}
    assert grades.graded(instruction("x"), carried(look="aa"), known).counts == 3
    assert grades.graded(instruction("x"), carried(look="bb"), known).counts is None
    assert grades.graded(instruction("x"), carried(key="T02 room"), known).counts is None


@given(st.lists(st.integers(0, 3), min_size=1, max_size=9))
def test_the_mean_is_that_of_the_grades_and_ungraded_rows_are_told(given_grades: list[int]) -> None:
    rows = [row(g) for g in given_grades] + [grades.Row(instruction("x"), carried(), None)]
    found = {m.key: m.value for m in grades.metrics(rows)}
    assert found["graded.mean"] == pytest.approx(sum(given_grades) / len(given_grades))
    assert found["graded.ungraded"] == 1
    assert [found[f"graded.grade_{n}"] for n in range(4)] == [given_grades.count(n) for n in range(4)]


def test_what_needed_an_answer_counts_at_most_two() -> None:
    assert row(3).counts == 3
    assert row(3, questions=1).counts == 2
    assert row(3, outcome="asked").counts == 2
    assert row(1, questions=1).counts == 1


def test_committed_grades_and_answers_belong_to_committed_instructions() -> None:
    known = {f"{i.id} {s.name}" for i in edits.instructions() for s in SETTINGS if s.scene == i.scene}
    assert len({i.id for i in edits.instructions()}) == 60
    for data in (grades.read_grades(), carrying.read_answers()):
        assert set(data) <= known
    for found in grades.read_grades().values():
        assert found["grade"] in range(4) and found["why"]


def view(width: int = 120) -> Camera:
    return Camera.look_at((0.0, -4.5, 2.4), (0.0, 0.0, 0.6), (0.0, 0.0, 1.0), width, width * 3 // 4, 60.0)


def test_a_close_up_shows_what_changed_where_it_was() -> None:
    camera, changed = view(), np.zeros((90, 120), dtype=bool)
    changed[20:30, 70:90] = True
    closer = carrying._close_up(camera, changed)
    corners = np.array([[70, 20], [90, 30]])
    for point in np.random.default_rng(0).uniform(-1, 1, (20, 3)):
        (far,), _ = camera.project(point[None])
        (near,), _ = closer.project(point[None])
        inside = bool(((far >= corners[0]) & (far <= corners[1])).all())
        assert not inside or bool(((near >= 0) & (near <= [120, 90])).all())
    assert closer.fx > 2 * camera.fx
    assert carrying._close_up(camera, np.ones((90, 120), dtype=bool)) is camera


@pytest.fixture(scope="module")
def place() -> Place:
    room = embed(furnish(seed=7, detail=0.3).scene, encoders.load("auto"))
    return Place(Setting("room", "room"), room, (view(), view(96)))


@pytest.mark.slow
def test_an_edit_a_refusal_and_a_question(place: Place, tmp_path: object) -> None:
    assert place.scene.language is not None
    done, shown = carrying.carry_out(instruction("make everything red"), place, {})
    assert done.outcome == "done" and len(shown.rows) in (1, 2)
    before, after, changed = shown.rows[0]
    assert np.abs(before.astype(int) - after).max() > carrying.CHANGED < changed.max()
    again, _ = carrying.carry_out(instruction("make everything red"), place, {})
    assert again == done
    other, _ = carrying.carry_out(instruction("make everything blue"), place, {})
    assert other.look != done.look
    refused, _ = carrying.carry_out(instruction("delete the zebra crossing"), place, {})
    assert refused.outcome == "refused" and refused.said


@pytest.mark.slow
def test_only_a_committed_answer_to_this_very_question_is_given(place: Place) -> None:
    what = instruction("delete the thing")
    asked, shown = carrying.carry_out(what, place, {})
    assert asked.outcome == "asked" and [len(row) for row in shown.rows] == [2]
    assert carrying.carry_out(what, place, {asked.key: {"another question": "1"}})[0].outcome == "asked"
    answered, _ = carrying.carry_out(what, place, {asked.key: {asked.look: "1"}})
    assert (answered.outcome, answered.questions, answered.told) == ("done", 1, (asked.said, "1"))


def test_a_sheet_holds_the_words_and_the_pictures() -> None:
    tile: Picture = np.full((30, 40, 3), 200, dtype=np.uint8)
    from scenewright.benchmarks._edits.graded.carrying import Shown

    sheet = np.asarray(sheets.draw(instruction("x"), carried(), Shown(((tile, tile // 2, tile // 4),))))
    assert [int(sheet[-40, x, 0]) for x in (200, 600, 1000)] == [200, 100, 50]
    assert (sheet[:40] < 100).any()

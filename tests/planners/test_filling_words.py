"""What instructions say of holes: to fill them, and to leave what an edit reveals."""

from __future__ import annotations

import pytest

from scenewright.planners.grammar.planner import GrammarPlanner
from scenewright.planners.grammar.restating.changes import filling
from scenewright.planners.plan import EditPlan


def plan(text: str) -> EditPlan:
    return GrammarPlanner().plan(text)


@pytest.mark.parametrize(
    ("text", "thing", "where"),
    [
        ("fill the hole in the wall", "wall", "in"),
        ("Please fill in the gap in the floor.", "floor", "in"),
        ("patch up the holes in the wall", "wall", "in"),
        ("fill the black area on the floor", "floor", "in"),
        ("fill what is missing under the sofa", "sofa", "under"),
        ("fill the hole behind the bookcase", "bookcase", "behind"),
        ("fill in the floor beneath the rug", "rug", "under"),
        ("there is a gap behind the sofa, please close it", "sofa", "behind"),
        ("The hole under the table needs to be filled.", "table", "under"),
        ("a black spot on the ceiling bothers me, patch it", "ceiling", "in"),
        ("the floor under the bed is missing, fill it in", "bed", "under"),
        ("the wall has holes, patch them", "wall", "in"),
        ("make the hole in the floor disappear", "floor", "in"),
        ("patch the wall where the painting hung", "wall", "in"),
        ("close the round hole with more of the wall", "wall", "in"),
        ("fill the gap", "everything", "in"),
        ("I see a black hole where the box was, fill it", "everything", "in"),
    ],
)
def test_a_hole_is_filled(text: str, thing: str, where: str) -> None:
    (op,) = plan(text).ops
    assert (op.op, op.query().text, op.where) == ("infill", thing, where)  # type: ignore[attr-defined, union-attr]


@pytest.mark.parametrize(
    "text",
    [
        "delete the sofa without filling",
        "remove the sofa, don't fill the hole",
        "delete the sofa and leave the hole open",
        "without filling delete the sofa",
        "move the sofa 1 m to the left without filling it in",
        "replace the sofa with a green armchair, no infill",
        "delete the sofa, leave the gap",
        "take out the sofa but keep the hole",
        "don't fill anything in when you remove the sofa, I want to see the raw scan",
        "remove the sofa, no patching please",
    ],
)
def test_what_is_revealed_is_left(text: str) -> None:
    (op,) = plan(text).ops
    assert not op.infill and op.query().text == "sofa"  # type: ignore[attr-defined, union-attr]


def test_it_is_filled_unless_that_is_said() -> None:
    for text in ("delete the sofa", "move the sofa to the left", "replace the sofa with an armchair"):
        assert plan(text).ops[0].infill  # type: ignore[attr-defined]


def test_a_second_clause_fills() -> None:
    first, second = plan("delete the painting and then fill the hole in the wall").ops
    assert (first.op, second.op) == ("delete", "infill")


@pytest.mark.parametrize(
    "text",
    [
        "delete the sofa and fill in what is underneath",
        "remove the sofa, then close the hole it leaves",
        "get rid of the sofa and mend the wall and floor there",
        "move the sofa 1 m to the left and patch up what's behind",
    ],
)
def test_filling_that_comes_with_a_deletion_is_no_step_of_its_own(text: str) -> None:
    (op,) = plan(text).ops
    assert op.op in ("delete", "move") and op.infill and op.query().text == "sofa"  # type: ignore[attr-defined, union-attr]


@pytest.mark.parametrize(
    "text",
    [
        "fill the cup with water",
        "fill the room with plants",
        "fill the shelf",
        "fill the empty space under the window with a plant",
        "cover the hole in the wall with a picture",
        "close the curtains",
        "put a box on the table, fill it",
        "repair the chair",
    ],
)
def test_other_things_are_not_filled(text: str) -> None:
    assert all(op.op != "infill" for op in plan(text).ops)


def test_each_form_mends_or_names_a_hole() -> None:
    told = (filling._TOLD, filling._STATED, filling._HAS, filling._LACKS, filling._VANISH, filling._ANYWHERE)
    asked = (filling._SURFACE, filling._REQUEST, filling._LACK, filling._SURFACE_ONCE, filling._WITH_SURFACE)
    for form in (*told, *asked):  # they are tried only where one of these is said
        assert any(part in form.pattern for part in (filling._FILL, filling._FILLED, filling._KIND))

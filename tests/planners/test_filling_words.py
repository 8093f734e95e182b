"""What instructions say of holes: to fill them, and to leave what an edit reveals."""

from __future__ import annotations

import pytest

from scenewright.planners.grammar.planner import GrammarPlanner
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


@pytest.mark.parametrize("text", ["fill the cup with water", "fill the room with plants", "fill the shelf"])
def test_other_things_are_not_filled(text: str) -> None:
    assert all(op.op != "infill" for op in plan(text).ops)

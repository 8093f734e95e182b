"""What instructions say of shadows, and of new things that stay as they are."""

from __future__ import annotations

import pytest

from scenewright.planners.grammar.planner import GrammarPlanner
from scenewright.planners.grammar.restating.changes import shadows
from scenewright.planners.plan import EditPlan


def plan(text: str, previous: str | None = None) -> EditPlan:
    return GrammarPlanner().plan(text, previous=previous)


@pytest.mark.parametrize(
    ("text", "thing", "change"),
    [
        ("remove the shadow under the sofa", "sofa", "remove"),
        ("Please get rid of the sofa's shadow.", "sofa", "remove"),
        ("no shadow under the sofa pls", "sofa", "remove"),
        ("take away the dark patch beneath the sofa", "sofa", "remove"),
        ("there is still a shadow of the sofa on the floor, remove it", "sofa", "remove"),
        ("the shadow of the sofa is still on the wall after I removed it, can you clear it", "sofa", "remove"),
        ("erase the shadow that the sofa casts", "sofa", "remove"),
        ("the sofa shouldn't cast a shadow", "sofa", "remove"),
        ("give the sofa a shadow", "sofa", "cast"),
        ("add a shadow under the sofa", "sofa", "cast"),
        ("make the sofa cast a shadow", "sofa", "cast"),
        ("make the shadow under the sofa softer", "sofa", "lighter"),
        ("lighten the shadow behind the sofa", "sofa", "lighter"),
        ("make the sofa's shadow a bit darker", "sofa", "darker"),
    ],
)
def test_a_shadow_is_changed(text: str, thing: str, change: str) -> None:
    (op,) = plan(text).ops
    assert (op.op, op.query().text, op.change) == ("shadow", thing, change)  # type: ignore[attr-defined, union-attr]


def test_its_shadow_is_that_of_what_was_said_before() -> None:
    (op,) = plan("remove its shadow", previous="select the red chair").ops
    assert op.op == "shadow" and op.query().last  # type: ignore[union-attr]


def test_shadows_stand_beside_other_clauses() -> None:
    first, second = plan("make the sofa red and remove its shadow").ops
    assert (first.op, second.op) == ("recolor", "shadow")
    first, second = plan("remove the shadow under the sofa and make the sofa red").ops
    assert (first.op, second.op) == ("shadow", "recolor")


@pytest.mark.parametrize("text", ["delete the table and its shadow", "move the table 1 m to the left with its shadow"])
def test_a_shadow_goes_with_what_goes(text: str) -> None:
    (op,) = plan(text).ops
    assert op.op in ("delete", "move") and op.query().text == "table"  # type: ignore[union-attr]


@pytest.mark.parametrize(
    "text",
    [
        "insert a chair as is",
        "put a chair next to the sofa without a shadow",
        "add a chair without matching the light",
        "replace the stool with a chair in its own colours",
    ],
)
def test_new_things_stay_as_they_are(text: str) -> None:
    (op,) = plan(text).ops
    assert op.asset == "chair" and not op.harmony  # type: ignore[attr-defined]


def test_new_things_are_fitted_unless_that_is_said() -> None:
    assert plan("insert a chair").ops[0].harmony  # type: ignore[attr-defined]


@pytest.mark.parametrize("text", ["make the shadow corner darker", "delete the dark chair", "add a shadow box"])
def test_other_things_have_their_own_names(text: str) -> None:
    assert all(op.op != "shadow" for op in plan(text).ops)


def test_each_form_names_a_shadow() -> None:
    for _, form in shadows._FORMS:  # they are tried only where a shadow is named
        assert shadows._SHADE in form.pattern or shadows._PATCH in form.pattern

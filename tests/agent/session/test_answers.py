"""Laws of answers: numbers choose places of the list, and nothing that is only an answer is an edit."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenewright.agent.session.answers import chosen_numbers, only_an_answer
from scenewright.agent.session.refusal import NotUnderstoodError
from scenewright.agent.session.session import Session
from scenewright.gaussians.errors import AmbiguousError, UserError
from scenewright.gaussians.language import encoders
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.scene import Scene
from scenewright.tools.judging.appearance import is_looked_for


@given(st.lists(st.integers(1, 9), min_size=1, max_size=6), st.sampled_from((", ", " and ", " & ", " ", ",")))
def test_a_list_of_numbers_chooses_these_places_in_its_order(numbers: list[int], between: str) -> None:
    assert chosen_numbers(between.join(map(str, numbers)), 9) == tuple(dict.fromkeys(n - 1 for n in numbers))


@pytest.mark.parametrize(
    ("said", "places"),
    [
        ("2", (1,)), ("#2", (1,)), ("number 2.", (1,)), ("the 2nd one", (1,)), ("the second", (1,)),
        ("1 and 2", (0, 1)), ("1, 2 and 4", (0, 1, 3)), ("1, 2, and 4!", (0, 1, 3)), ("both 1 and 3", (0, 2)),
        ("numbers 1 and 3 please", (0, 2)), ("one and three", (0, 2)), ("the first and the last", (0, 3)),
        ("1-3", (0, 1, 2)), ("2 to 4", (1, 2, 3)), ("1 and 3 to 4", (0, 2, 3)), ("the first two", (0, 1)),
        ("last 2", (2, 3)), ("all but 2", (0, 2, 3)), ("everything except 1 and 2", (2, 3)), ("number two", (1,)),
    ],
)  # fmt: skip
def test_answers_that_number_things(said: str, places: tuple[int, ...]) -> None:
    assert chosen_numbers(said, 4) == places


@pytest.mark.parametrize(
    "said", ["5", "0", "1 and 5", "3-9", "3 to 1", "1 or 2", "two", "the left one", "", "1 metre", "-1", "all but 5",
             "the first 9", "all but all", "1 and the chair", "1." * 400]
)  # fmt: skip
def test_what_numbers_nothing_on_the_list(said: str) -> None:
    assert chosen_numbers(said, 4) is None


@pytest.mark.parametrize(
    "said", ["all", "All!", "both", "all of them", "everything", "every one", "3", "1 and 2", "yes"]
)
def test_an_answer_without_a_question_edits_nothing(boxes: Scene, encoder: Any, said: str) -> None:
    """After an edit, "all" could be read as that edit of everything."""
    session = Session(boxes, encoder=encoder)
    session.do("delete the green thing")
    before = session.scene
    with pytest.raises(NotUnderstoodError, match="no question is open"):
        session.do(said)
    assert session.scene is before and session.done == ("delete the green thing",)


@pytest.mark.parametrize("said", ["delete all", "delete everything", "the red one", "make all chairs red", "undo"])
def test_an_instruction_is_not_only_an_answer(said: str) -> None:
    assert not only_an_answer(said)


@pytest.mark.parametrize(("said", "left"), [("1 and 2", {1, 3}), ("all but 1", {1, 3, "other"}), ("all", {1, 3})])
def test_several_numbers_choose_several_things(boxes: Scene, encoder: Any, said: str, left: set[Any]) -> None:
    session = Session(boxes, encoder=encoder)
    with pytest.raises(AmbiguousError):
        session.do("delete the red thing")
    assert session.question is not None
    first = session.question.candidates[0].group
    session.answer(said)
    assert set(session.scene.cloud.group.unique().tolist()) == {first if g == "other" else g for g in left}


def test_what_a_person_has_chosen_is_confirmed_and_no_encoder_is_asked(boxes: Scene, encoder: Any) -> None:
    session = Session(boxes, encoder=encoder)
    with pytest.raises(AmbiguousError):
        session.do("delete the red thing")
    for said in ("1", "the left one"):
        query = session.answered(said).ops[0].query()
        assert query is not None and query.confirmed
        assert not is_looked_for(query.model_copy(update={"text": "chair", "groups": ()}), encoders.load("auto"))
    assert is_looked_for(Query(text="chair"), encoders.load("auto"))


def test_both_is_no_answer_among_three(boxes: Scene, encoder: Any) -> None:
    session = Session(boxes, encoder=encoder)
    with pytest.raises(AmbiguousError):
        session.do("delete the thing")
    assert session.question is not None and len(session.question.candidates) == 3
    with pytest.raises(UserError, match="does not say which"):
        session.answer("both")
    assert session.scene is boxes and session.question is not None

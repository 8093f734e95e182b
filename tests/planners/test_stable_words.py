"""Signs around an instruction, clauses out of order, and typing errors in what is not understood as it stands."""

from __future__ import annotations

import pytest

from scenewright.gaussians.world.spelling import best_slip
from scenewright.planners import load
from scenewright.planners.grammar.tagging.words import clean
from scenewright.planners.plan import EditPlan
from scenewright.planners.questions.reading.words import plain_words

GRAMMAR = load("grammar")


def plan(text: str) -> EditPlan:
    return GRAMMAR.plan(text)


@pytest.mark.parametrize(
    "text",
    ["**delete the rug**", "delete the **rug**", "- delete the rug", "1. delete the rug", "> delete the rug",
     "`delete the rug`",
     "delete the rug \U0001f642", "\U0001f44d\U0001f3fd delete the rug", "delete the rug :)", "_delete_ the rug"],
)  # fmt: skip
def test_markup_and_emoji_say_nothing(text: str) -> None:
    assert plan(text).ops == plan("delete the rug").ops != ()


@pytest.mark.parametrize(
    "text", ["paint it #ff0000", "rotate it by 90°", "move it -5 cm", "2*3", "make it 10~20 % bigger"]
)
def test_signs_that_say_something_stay(text: str) -> None:
    assert clean(text) == text


def test_a_list_is_as_many_sentences() -> None:
    listed, plain = plan("1. delete the rug\n2. paint the sofa red"), plan("delete the rug. paint the sofa red")
    assert listed.ops == plain.ops and len(plain.ops) == 2


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("before you delete the vase, duplicate the mug", "duplicate the mug. delete the vase"),
        ("copy the mug before you delete the vase", "copy the mug. delete the vase"),
        ("delete the clock after painting the bookshelf black", "paint the bookshelf black. delete the clock"),
        ("after painting the sofa red, delete the rug", "paint the sofa red. delete the rug"),
        ("next to the sofa, add a plant", "add a plant next to the sofa"),
        ("Delete the rug. In front of the sofa, add a table.", "delete the rug. add a table in front of the sofa"),
    ],
)
def test_orders_out_of_order_are_put_in_order(text: str, plain: str) -> None:
    assert plan(text).ops == plan(plain).ops != ()


@pytest.mark.parametrize("reason", ["before we go to bed", "before the neighbours complain", "before I forget"])
def test_what_is_no_order_stays_a_reason(reason: str) -> None:
    assert plan(f"delete the rug {reason}").ops == plan("delete the rug").ops


def test_what_it_means_is_not_guessed_from_behind() -> None:
    assert not plan("paint the sofa red after moving it to the left").ops


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("piant the sofa navy blue", "paint the sofa navy blue"),
        ("delete each cushion with the exception of the blue cushion", "delete each cushion except the blue cushion"),
        ("create an exact duplicate of the vase", "duplicate the vase"),
        ("remove mug + vase", "remove mug and vase"),
        ("the vase should be copied", "copy the vase"),
        ("apply a rotation of 30 degrees to the coffee table", "rotate the coffee table by 30 degrees"),
    ],
)
def test_other_words_for_the_same(text: str, plain: str) -> None:
    assert plan(text).ops == plan(plain).ops != ()


def test_a_free_correction_is_told_and_is_not_sure() -> None:
    told = plan("piant the sofa navy blue")
    assert "piant" in told.reason and not GRAMMAR.is_sure("piant the sofa navy blue")


def test_the_most_probable_word_counts_if_it_is_alone() -> None:
    words = {"paint", "plant", "print"}
    assert best_slip("piant", words) == "paint"  # two letters exchanged, before the neighbours i and l of "plant"
    assert best_slip("pkint", words) == ""  # any wrong letter: paint and print are as probable
    assert best_slip("xaint", words) == "" and best_slip("pai", words) == ""


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("how much cushions are in the room?", "how many cushions are in the room"),
        ("exists a television in the room?", "is there a television in the room"),
        ("television present?", "is there a television"),
        ("who is more tall, the lamp or the shelf?", "which is taller , the lamp or the shelf"),
        ("how much glass is there?", "how much glass is there"),
        ("who is there?", "who is there"),
        ("which lamps are present?", "which lamps are present"),
    ],
)
def test_questions_of_learners(text: str, plain: str) -> None:
    assert " ".join(plain_words(text)) == plain

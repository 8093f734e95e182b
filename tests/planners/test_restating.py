"""Sentences that ask without a plain command mean what the plain command means, and what is no wish stays none."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenewright.planners.grammar import GrammarPlanner
from scenewright.planners.grammar.restating.restating import restatements
from scenewright.planners.grammar.restating.speech.smoothing import smoothed
from scenewright.planners.grammar.tagging.words import clean, split

CASES = [
    json.loads(line) for line in (Path(__file__).parent / "restated.jsonl").read_text(encoding="utf-8").splitlines()
]
PLANNER = GrammarPlanner()


@pytest.mark.parametrize("case", CASES, ids=[c["text"] for c in CASES])
def test_a_sentence_means_its_plain_command(case: dict[str, str]) -> None:
    plain, said = PLANNER.plan(case["means"]), PLANNER.plan(case["text"])
    assert plain.ops, plain.reason
    assert said.ops == plain.ops, said.reason


@pytest.mark.parametrize("text", ["move the chair before the desk", "put the ottoman before the sofa"])
def test_a_place_is_no_reason(text: str) -> None:
    """ "Before it falls" is a reason and is left out; "before the desk" is where a thing shall be."""
    assert not PLANNER.plan(text).ops
    assert PLANNER.plan("delete the vase before it falls").ops == PLANNER.plan("delete the vase").ops


def test_a_number_that_is_not_understood_is_not_half_a_turn() -> None:
    assert not PLANNER.plan("give the chair a 7 furlong turn").ops


@pytest.mark.parametrize(
    "text",
    [
        "I really like the sofa",
        "the lamp stands next to the sofa, doesn't it?",
        "is there room for a second table?",
        "the rug used to be blue",
        "my wife painted the wall last year",
        "what would look better in the corner, the plant or the lamp?",
        "should the sofa be blue?",
        "I wonder why the table is so big",
        "do you think the vase belongs on the shelf?",
        "the chair looks nice next to the window",
        "I don't know where to put the lamp",
        "the pendant lamp hangs above the counter",
        "the doormat keeps sliding to the left",
        "without the doormat the floor gets dirty",
        "no stools were harmed",
        "you could have asked me first",
        "we had a bigger fridge before",
        "leave the oven where it is",
    ],
)
def test_what_is_no_wish_changes_nothing(text: str) -> None:
    plan = PLANNER.plan(text)
    assert not plan.ops
    assert plan.verdict in ("not_an_edit", "not_understood")


@pytest.mark.parametrize(
    "text",
    [
        "delete the rug, no wait, I don't know",
        "paint the sofa red, sorry, frobnicate it",
        "I'd like the desk moved to the left, and the lamp frobnicated",
        "the lamp needs frobnicating, delete the rug",
        "the sofa should be blue unless the rug is red",
    ],
)
def test_nothing_is_done_by_half(text: str) -> None:
    assert not PLANNER.plan(text).ops


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("er, um, delete the rug, please and thanks", "delete the rug"),
        ("delete the lamp with the green shade", "delete the lamp with the green shade"),
        ("make it half as big again", "make it 1.5 times as big"),
        ("put the mug away in the cupboard", "put the mug in the cupboard"),
    ],
)
def test_smoothing_drops_what_says_nothing(text: str, plain: str) -> None:
    assert " ".join(w.text for w in smoothed(split(clean(text)))) == plain


@given(st.text(alphabet="abcdefgh ,.-", max_size=60).filter(lambda t: bool(t.strip(" ,.-"))))
def test_smoothing_invents_no_word(text: str) -> None:
    words = split(clean(text))
    assert {w.text for w in smoothed(words)} <= {w.text for w in words} | {",", "."}


@given(
    st.lists(
        st.sampled_from(
            [
                "the",
                "rug",
                "sofa",
                "should",
                "be",
                "blue",
                "and",
                ",",
                "moved",
                "left",
                "no",
                "wait",
                "is",
                "gone",
                "I",
                "it",
            ]
        ),
        max_size=14,
    )
)
def test_no_text_has_endless_readings(words: list[str]) -> None:
    if words:
        assert sum(1 for _ in restatements([w.lower() for w in words], "", True)) < 2000


@pytest.mark.parametrize(
    "text",
    [
        "I don't want the bench to go",
        "we don't want the chairs gone",
        "I don't want the bench painted blue",
        "the bench should not go",
        "the bench can't go",
        "nobody wants the bench deleted",
        "nobody said the bench should go",
        "they put blue on the bench",
        "no black chairs?",
        "I use the lamp here",
        "if the bench is red, delete the lamp",
        "unless the bench is green, delete it",
        "if there is a sofa, delete the lamp",
    ],
)
def test_negated_wishes_reports_and_conditions_change_nothing(text: str) -> None:
    assert not PLANNER.plan(text).ops


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("don't delete the bench, move it to the left", "move the bench to the left"),
        ("do not move the bench but paint it red", "paint the bench red"),
        ("I don't want the blue basket deleted, I want the white one deleted", "delete the white basket"),
        ("if possible, delete the bench", "delete the bench"),
        ("if there is room, add a stool", "add a stool"),
        (
            "I'd rather have a stool where the armchair is, and two more chairs by the window",
            "put a stool where the armchair is, and add two more chairs by the window",
        ),
    ],
)
def test_what_is_asked_for_beside_what_is_not(text: str, plain: str) -> None:
    ops = PLANNER.plan(text).ops
    assert ops
    assert ops == PLANNER.plan(plain).ops


@pytest.mark.parametrize("text", ["I use the lamp too", "I need the lamp as well"])
def test_what_is_used_is_not_deleted_like_the_thing_before(text: str) -> None:
    assert all(op.op != "delete" for op in PLANNER.plan(text, previous="delete the bench").ops)

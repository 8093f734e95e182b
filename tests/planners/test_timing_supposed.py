"""Wishes about motion that no rule reads are told by their kind, and only where nothing that they name is left out."""

from __future__ import annotations

from typing import Any

import pytest

from scenewright.planners.grammar.planner import SUPPOSED, GrammarPlanner
from scenewright.planners.grammar.timing.supposed.kinds import likely, stored
from scenewright.training import timed_wishes

PLANNER = GrammarPlanner()


def planned(text: str) -> list[dict[str, Any]]:
    return [op.model_dump(exclude_defaults=True, mode="json") | {"op": op.op} for op in PLANNER.plan(text).ops]


KINDS = [
    ("the swing is much too wild for me, calm it down", "speed"),
    ("nobody should see the ladder until the cat jumps", "hide"),
    ("let's have the gate remain wide open, no shutting", "stay"),
    ("could the train hold for two seconds at the platform", "pause"),
    ("i'd rather the windmill ran the opposite way", "reverse"),
    ("those two cars ought to set off at the same moment", "together"),
    ("give the bench a coat of green once the tram has left", "recolor"),
    ("the lift goes up far too late, have it begin at one second", "begin"),
]


@pytest.mark.parametrize(("text", "kind"), KINDS)
def test_the_kind_of_a_wish_is_told(text: str, kind: str) -> None:
    """None of these was learned from."""
    assert text not in {sentence.said for sentence in timed_wishes.sentences()}
    assert likely(text)[0][0] == kind


@pytest.mark.parametrize(
    "text", ["what a lovely film", "when does the ball stop?", "the lamp could be a bit brighter", "is the door open?"]
)
def test_what_is_no_wish_about_motion_has_no_kind(text: str) -> None:
    assert likely(text) == []


@pytest.mark.parametrize(
    ("text", "plainly"),
    [
        ("It makes me dizzy, that fan, let it turn half as fast.", "play the fan at half speed"),
        ("While it's on the rug I'd love the ball to be yellow, then red again afterwards.",
         "make the ball yellow while it is on the rug"),
        ("Could the middle drawer be pink while the top one is sliding out, please?",
         "make the middle drawer pink while the top drawer is opening"),
        ("The robot, he should change to orange when he arrives at the bed.",
         "make the robot orange when it arrives at the bed"),
        ("Stretch the red book's fall to two seconds, I want to see it in the air.", "let the red book fall in 2 s"),
        ("The blue book stays up on the shelf, it doesnt fall.", "keep the blue book still"),
        ("Sorry, the coat rack looks so messy, can we not see it in the last two seconds",
         "hide the coat rack for the last two seconds"),
        ("ball is way too slow, i want it going twice as fast", "play the ball twice as fast"),
        ("Keep the fan going right to the end will you, no stopping at four", "let the fan keep turning"),
    ],
)  # fmt: skip
def test_a_wish_is_planned_as_a_plain_command_of_its_kind(text: str, plainly: str) -> None:
    assert planned(text) == planned(plainly) != []


@pytest.mark.parametrize(
    "text",
    [
        "have the lift rise one second earlier and more slowly",  # two wishes
        "the ball could go slower, and when the cat jumps, turn green",  # a time that belongs to one of them
        "i fancy the drawer coming out twice as far at 2 s",  # how far cannot be told in times
        "snorkle the fan until 3 s",  # no word
        "never paint the robot green while it walks",  # a prohibition
    ],
)
def test_nothing_that_is_named_is_left_out(text: str) -> None:
    assert PLANNER.plan(text).ops == ()


def test_a_plan_says_that_it_was_supposed_and_is_not_sure() -> None:
    text = "It makes me dizzy, that fan, let it turn half as fast."
    assert PLANNER.plan(text).reason == SUPPOSED
    assert not PLANNER.is_sure(text) and PLANNER.is_sure("play the fan at half speed")


@pytest.mark.slow
def test_the_weights_are_those_of_the_sentences() -> None:
    """Stored in steps of 1/127 of the largest: sentences whose kinds are nearly as likely may change places."""
    known = timed_wishes.sentences()
    model = timed_wishes.learned(known)
    told = [model.kinds_of(s.said)[0][0] for s in known]
    kept = [stored().kinds_of(s.said)[0][0] for s in known]
    assert sum(a == b for a, b in zip(told, kept, strict=True)) >= 0.995 * len(known)
    assert timed_wishes.right_of_unseen(known) > 0.8  # .835 measured, of 22 kinds

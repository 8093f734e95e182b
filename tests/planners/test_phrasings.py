"""Edits that a plainer sentence says as well mean what that sentence means; what only looks like them does not."""

from __future__ import annotations

import pytest

from scenewright.planners.grammar.planner import GrammarPlanner
from scenewright.planners.plan import EditPlan

SAME = {
    "put a copy of the mug on the table": "copy the mug and put it on the table",
    "place another copy of the red chair next to the desk": "copy the red chair and put it next to the desk",
    "I'd like a second lamp to the left of the sofa": "copy the lamp and put it to the left of the sofa",
    "take off the yellow box on the shelf": "remove the yellow box on the shelf",
    "make everything black and white": "make everything 100 % less saturated",
    "turn the rug grayscale": "make the rug 100 % less saturated",
    "make the vase dark purple here": "make the vase dark purple",
    "paint the door red, keep the rest as it is": "paint the door red",
    "delete the chairs and leave everything else alone": "delete the chairs",
    "make the plants look orange like in autumn": "make the plants look orange",
    "duplicate the chair and put the second one to the right of it": "copy the chair to the right",
    "copy the lamp, and put the copy to the left of the original": "copy the lamp to the left",
    "duplicate the chair and put the copy next to the original": "duplicate the chair",
}


def plan(text: str) -> EditPlan:
    return GrammarPlanner().plan(text)


@pytest.mark.parametrize("said", SAME)
def test_it_means_what_the_plainer_sentence_means(said: str) -> None:
    asked, plainer = plan(said), plan(SAME[said])
    assert plainer.ok and asked.ops == plainer.ops


def test_what_only_looks_like_it_stays_what_it_is() -> None:
    kept = plan("delete the chairs and keep the sofa")
    assert not kept.ok and kept.verdict == "not_an_edit"
    placed = plan("copy the chair and put it to the right of the table").ops[0]
    assert placed.model_dump()["place"]["relation"] == "right_of"
    two = plan("copy the chair and move the second lamp to the right of it")
    assert [op.op for op in two.ops] != ["duplicate"]
    assert not plan("twice as big").ok

"""Labelled wishes are taken with their marks as planners read words, and plans are made of what these hold."""

from __future__ import annotations

import pytest

from scenewright.benchmarks._motion.marks_read import _is_read, _room, marked_words
from scenewright.training.wording import Sentence


def words_of(kind: str, marked: str) -> tuple[list[str], list[tuple[str, int, int]]]:
    return marked_words(Sentence("1", kind, marked))


def test_marks_stand_at_the_words_that_planners_read() -> None:
    words, spans = words_of("hide", "Hide [x the Vase] [in from 1s to 2 secs][off , pls].")
    said = {tag: " ".join(words[start:stop]) for tag, start, stop in spans}
    assert said["x"] == "the vase" and said["in"].startswith("from 1") and "off" in said
    assert _room(words) == "fan" and _room(["nothing", "of", "ours"]) is None


@pytest.mark.slow
def test_a_plan_is_made_of_what_marks_hold_or_not_at_all() -> None:
    for room, kind, marked, read in (
        ("fan", "hide", "Hide [x the vase] [in from 1 to 2 s].", True),
        ("ball", "duration", "[x the ball] should take [for five seconds].", True),
        ("ball", "speed", "[x the ball] [by grumpily] faster than [y the zeppelin] [from once it snows].", False),
    ):
        assert _is_read(room, kind, *words_of(kind, marked)) is read

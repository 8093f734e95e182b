"""Tests of planners/grammar/timing/marked/plain.py: marked words of time in plain words."""

from __future__ import annotations

import pytest

from scenewright.gaussians.language.query.query import Query
from scenewright.planners.grammar.timing.marked.plain import loosely, plain
from scenewright.planners.grammar.timing.marked.times import told_by

THINGS = {"the ball", "the dog", "the drawer", "the robot", "it"}


def thing(phrase: str) -> Query | None:
    return Query(text=phrase.removeprefix("the ")) if phrase in THINGS else None


@pytest.mark.parametrize(
    ("tag", "said", "plainly"),
    [
        ("from", "when two seconds have passed", "at two seconds"),
        ("to", "until the first second is over", "at 1 seconds"),
        ("from", "no earlier than four seconds", "at four seconds"),
        ("from", "not before the door shuts", "once the door shuts"),
        ("in", "for only the first 2 seconds", "for the first 2 seconds"),
        ("for", "a good three seconds", "three seconds"),
        ("for", "half a second tops", "half a second"),
        ("for", "for a moment", "for 1 seconds"),
        ("in", "in the third second", "from 2 seconds to 3 seconds"),
        ("from", "at the second second", "at 2 seconds"),
        ("from", "once out", "once it is out"),
        ("from", "when its half open", "when it is half open"),
        ("in", "for the remainder of the film", "until the end"),
        ("in", "all five seconds of it", "the whole time"),
        ("from", "after its slide", "after it has stopped"),
        ("from", "when the ball stops", "when the ball stops"),
        ("for", "for two seconds", "for two seconds"),
        ("in", "in the first second", "in the first second"),
    ],
)
def test_words_of_time_are_put_plainly(tag: str, said: str, plainly: str) -> None:
    assert plain(tag, said) == plainly


@pytest.mark.parametrize(
    ("said", "loose"),
    [
        ("once the dog has trotted past", "once the dog has stopped"),
        ("when the robot parks at the bed", "when the robot has stopped"),
        ("while the dog trots by", "while the dog is moving"),
        ("while the ball is rolling over it", "while the ball is on it"),
        ("when the drawer is all tucked back in", "when the drawer has closed"),
        ("once the robot has finished the first part", None),
        ("while the robot stands there", None),
        ("as the dog vanishes", None),
        ("once the cat has gone", None),  # nothing of that name
    ],
)
def test_a_verb_that_is_not_known_is_one_of_moving_or_stopping(said: str, loose: str | None) -> None:
    assert loosely(said, thing) == loose


@pytest.mark.parametrize("said", ["clear the middle", "at the outset of the fourth second"])
def test_other_words_beside_the_name_of_a_moment_tell_no_moment(said: str) -> None:
    assert told_by("from", said, thing) is None


def test_names_of_moments() -> None:
    for said, start in (("from the midpoint of the clip", "middle"), ("at the very end", "end")):
        told = told_by("from", said, thing)
        assert told is not None and told[0] is not None and told[0].start == start

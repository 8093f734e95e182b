"""Sentences with marks, and what is learned from them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scenewright.planners.grammar.learned.network import networks as kept
from scenewright.planners.grammar.tagging.words import split
from scenewright.training.timed_words import FILES
from scenewright.training.wording import Sentence, Tasks, networks, sentences, told_of, without

MADE = [
    Sentence(str(at % 5), kind, text)
    for at, (kind, text) in enumerate(
        (kind, text.format(x=x, t=t))
        for kind, text in (
            ("stop", "stop [x {x}] [t {t}]"), ("stop", "[t {t}] let [x {x}] halt"), ("hide", "hide [x {x}] [t {t}]"),
            ("hide", "[x {x}] should not be seen [t {t}]"), ("stop", "halt [x {x}] [t {t}]"),
        )
        for x in ("the fan", "the old ferry", "a cat", "the small red bus", "my kite")
        for t in ("at 2 s", "once the bell has rung", "while it rains", "after 3 s", "when the tram stops", "from 1 s")
    )
]  # fmt: skip
TASKS: Tasks = {"wishes": MADE}


def test_marks_stand_in_the_words() -> None:
    sentence = Sentence("1", "stop", "[off well, ]stop [x the robot]'s walk [from at 2s]!")
    assert sentence.said == "well, stop the robot's walk at 2s!"
    assert sentence.words[:7] == ("well", ",", "stop", "the", "robot", "'s", "walk")
    assert sentence.spans == (("off", 0, 2), ("x", 3, 6), ("from", 7, 10))


@pytest.mark.slow
def test_what_is_learned_tells_the_kinds_and_marks_of_new_sentences() -> None:
    model = networks(TASKS, passes=20, count=1)
    words = [
        tuple(word.text for word in split(said))
        for said in ("halt the ferry at 2 s", "hide the old cat once the bell has rung")
    ]
    assert model.told("wishes", words[0]).kinds[0][0] == "stop"
    assert model.told("wishes", words[1]).spans == (("x", 1, 4), ("t", 4, 9))


@pytest.mark.slow
def test_the_same_sentences_give_the_same_weights() -> None:
    made = (networks(TASKS, passes=2).members for _ in range(2))
    for one, other in zip(*made, strict=True):
        assert all(np.array_equal(one.weights[name], other.weights[name]) for name in one.weights)


def test_each_of_them_begins_elsewhere() -> None:
    one, other = networks(TASKS, passes=1).members
    assert one.lists == other.lists
    assert not np.array_equal(one.weights["rows.words"], other.weights["rows.words"])


@pytest.mark.slow
def test_writers_are_told_by_what_others_wrote() -> None:
    left, held = without(TASKS, {"wishes": ["2"]})
    told = told_of(networks(left, passes=20, count=1), "wishes", held["wishes"])
    assert len(left["wishes"]) + len(held["wishes"]) == len(MADE)
    assert told.kinds > 0.9 and min(told.precision, told.recall, told.whole) > 0.7


@pytest.mark.parametrize("path", FILES.values())
@pytest.mark.slow
def test_every_sentence_has_its_marks_in_its_words(path: Path) -> None:
    known = sentences(path)
    for sentence in known:
        assert not set("[]") & set(sentence.said), sentence
        assert len(sentence.spans) == sentence.marked.count("["), sentence
        assert list(sentence.spans) == sorted(sentence.spans, key=lambda span: span[1:])


@pytest.mark.parametrize("task", FILES)
@pytest.mark.slow
def test_the_weights_are_those_of_the_sentences(task: str) -> None:
    """Every sixtieth is asked; all are learned from."""
    told = told_of(kept(), task, sentences(FILES[task])[::60])
    assert told.kinds > 0.95 and min(told.precision, told.recall) > 0.9

"""Sentences with marks, and what is learned from them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scenewright.planners.grammar.tagging.words import split
from scenewright.planners.questions.reading.time.supposed import kinds as question_kinds
from scenewright.training import timed_questions, timed_wishes
from scenewright.training.wording import Sentence, classifier, sentences, tagger, told_of_unseen

MADE = [
    Sentence(str(at % 3), kind, text)
    for at, (kind, text) in enumerate(
        (kind, text.format(x=x, t=t))
        for kind, text in (
            ("stop", "stop [x {x}] [t {t}]"), ("stop", "[t {t}] let [x {x}] halt"), ("hide", "hide [x {x}] [t {t}]"),
            ("hide", "[x {x}] should not be seen [t {t}]"),
        )
        for x in ("the fan", "the old ferry", "a cat")
        for t in ("at 2 s", "once the bell has rung", "while it rains")
    )
]  # fmt: skip


def test_marks_stand_in_the_words() -> None:
    sentence = Sentence("1", "stop", "[off well, ]stop [x the robot]'s walk [from at 2s]!")
    assert sentence.said == "well, stop the robot's walk at 2s!"
    assert sentence.words[:7] == ("well", ",", "stop", "the", "robot", "'s", "walk")
    assert sentence.spans == (("off", 0, 2), ("x", 3, 6), ("from", 7, 10))


def test_what_is_learned_tells_the_kinds_and_marks_of_new_sentences() -> None:
    kind_of, spans_of = classifier(MADE), tagger(MADE)
    assert kind_of.kinds_of("halt the ferry at 2 s")[0][0] == "stop"
    words = tuple(word.text for word in split("hide the old cat once the bell has rung"))
    assert spans_of.spans(words) == (("x", 1, 4), ("t", 4, 9))


def test_the_same_sentences_give_the_same_weights() -> None:
    one, other = tagger(MADE), tagger(MADE)
    assert np.array_equal(one.weights, other.weights) and np.array_equal(one.moves, other.moves)


def test_writers_are_told_by_what_others_wrote() -> None:
    told = told_of_unseen(MADE)
    assert told.kinds > 0.9 and min(told.precision, told.recall) > 0.7


@pytest.mark.parametrize("path", [timed_wishes.SENTENCES, timed_questions.SENTENCES])
def test_every_sentence_has_its_marks_in_its_words(path: Path) -> None:
    known = sentences(path)
    for sentence in known:
        assert not set("[]") & set(sentence.said), sentence
        assert len(sentence.spans) == sentence.marked.count("["), sentence
        assert list(sentence.spans) == sorted(sentence.spans, key=lambda span: span[1:])


@pytest.mark.slow
def test_the_weights_of_questions_are_those_of_the_sentences() -> None:
    """Stored in steps of 1/127 of the largest: sentences whose kinds are nearly as likely may change places."""
    known = sentences(timed_questions.SENTENCES)
    model = classifier(known, timed_questions.RIDGE)
    told = [model.kinds_of(s.said)[0][0] for s in known]
    kept = [question_kinds.kinds_of(s.said)[0][0] for s in known]
    assert sum(a == b for a, b in zip(told, kept, strict=True)) >= 0.995 * len(known)

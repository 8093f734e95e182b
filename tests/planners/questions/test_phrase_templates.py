"""Phrase templates: every way that fills one is found, and nothing is left over."""

from __future__ import annotations

import pytest

from scenewright.planners.questions.reading.phrase_templates import Words, parsed, templates

READERS = {"thing": " ".join, "number": lambda words: int(words[0]) if words[0].isdigit() and len(words) == 1 else None}


def fills(notation: str, text: str) -> list[dict[str, object]]:
    words: Words = tuple(text.split())
    return [slots for t in templates(notation) for slots in t.match(words, READERS)]


def test_a_hole_takes_the_words_between_the_fixed_ones() -> None:
    assert fills("how far is {a} from {b}", "how far is the sofa from the door") == [{"a": "the sofa", "b": "the door"}]


def test_a_template_consumes_every_word() -> None:
    assert not fills("how far is {a}", "is how far is the sofa")
    assert not fills("is it red", "is it red or blue")


def test_holes_backtrack_over_every_split() -> None:
    found = fills("between {a} and {b}", "between salt and pepper and oil")
    assert found == [{"a": "salt", "b": "pepper and oil"}, {"a": "salt and pepper", "b": "oil"}]


def test_alternatives_and_optional_parts() -> None:
    notation = "(how many|what number of) {x} [are there]"
    for text in ("how many chairs", "what number of chairs are there"):
        assert {"x": "chairs"} in fills(notation, text)


def test_a_reader_that_refuses_its_words_refuses_the_template() -> None:
    assert fills("{n:number} chairs", "4 chairs") == [{"n": 4}]
    assert not fills("{n:number} chairs", "red chairs")


@pytest.mark.parametrize("text", ["is the sofa red", "whether the sofa is red", "the sofa is red"])
def test_be_covers_the_orders_of_words(text: str) -> None:
    assert {"x": "the sofa"} in fills("BE {x} red", text)


@pytest.mark.parametrize("text", ["how tall is the lamp", "how tall the lamp is"])
def test_be_behind_a_question_word(text: str) -> None:
    assert {"x": "the lamp"} in fills("how tall BE {x}", text)


def test_commas_are_skipped_where_a_template_has_none() -> None:
    assert fills("in here is {x}", "in here , is a cat") == [{"x": "a cat"}]


@pytest.mark.parametrize("notation", ["(a|b", "a)", "[a", "a | b"])
def test_unmatched_brackets_are_refused(notation: str) -> None:
    with pytest.raises(ValueError, match="unmatched bracket"):
        parsed(notation)

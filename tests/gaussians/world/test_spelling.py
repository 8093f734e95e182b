"""Suggestions for misspelt names, and slips of the keyboard."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import scenewright
from scenewright.gaussians.world.spelling import did_you_mean, likely_slips, nearest, one_slip
from scenewright.planners.compose.sentence.tokenize import words_of
from scenewright.planners.grammar.tagging.spelling import correct_spelling
from scenewright.planners.grammar.tagging.words import split

_THERE = frozenset(
    {"basket", "bookshelf", "cushion", "lamp", "printer", "sofa", "stool", "table", "travel", "wardrobe"}
)


def test_suggestions_are_a_question() -> None:
    assert nearest("tael", ["teal", "red", "tan"]) == ("teal",)
    assert did_you_mean("tael", ["teal", "red"]) == "did you mean teal?"
    assert did_you_mean("whit", ["white", "wheat", "red"]) == "did you mean white or wheat?"
    assert did_you_mean("qqqq", ["white"]) == ""


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("cushon", "cushion"), ("cusshion", "cushion"), ("cushoin", "cushion"), ("bookshlef", "bookshelf"),
        ("wardrove", "wardrobe"), ("werdrove", ""), ("wardrabe", "wardrobe"), ("sfoa", "sofa"), ("soda", ""),
        ("gravel", ""), ("casket", ""), ("painter", ""), ("stood", ""), ("fable", ""), ("limp", ""), ("trave1", ""),
    ],
)  # fmt: skip
def test_a_word_that_may_be_spelt_right_is_no_slip(text: str, meant: str) -> None:
    assert likely_slips(text, _THERE) == ({meant} if meant else set())


@given(st.sampled_from(sorted(_THERE)), st.data())
def test_one_slip_away_is_symmetric(word: str, data: st.DataObject) -> None:
    at = data.draw(st.integers(0, len(word) - 1))
    cut = word[:at] + word[at + 1 :]
    assert len(cut) < 4 or word in one_slip(cut, _THERE)
    assert len(cut) < 4 or cut in one_slip(word, {cut})


@pytest.mark.parametrize(
    "text",
    [
        "move the lamp and the gravel to the bed", "delete the clover and rover", "select the greed", "hide the ranger",
        "put the vase next to the mover and paver", "paint the wall and trimming white",
    ],
)  # fmt: skip
def test_a_word_where_a_noun_is_expected_stays(text: str) -> None:
    fixed, told = correct_spelling(split(text))
    assert [w.text for w in fixed] == text.split() and told == ()


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("a garden with gravel and a bench", []),
        ("a bedroom with a travle bag", ["read “travle” as travel"]),
        ("a bedroom with a wardrove", ["read “wardrove” as wardrobe"]),
        ("an ofice with a desk", ["read “ofice” as office"]),
    ],
)
def test_a_description_is_corrected_to_whole_names(text: str, told: list[str]) -> None:
    assert words_of(text)[1] == told


def test_no_other_module_compares_spellings() -> None:
    package = Path(scenewright.__file__).parent
    found = [
        path.name
        for name in ("gaussians", "tools", "planners", "agent")
        for path in (package / name).resolve().rglob("*.py")
        if "difflib" in (text := path.read_text("utf-8"))
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Import | ast.ImportFrom)
        and "difflib" in {getattr(node, "module", None), *(a.name for a in node.names)}
    ]
    assert found == ["spelling.py"]

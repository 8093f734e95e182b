"""Colour words against measured Lab, and size words among rivals."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from scenewright.gaussians.color import BASIC, parse, rgb_to_lab
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.language.field.language_field import Group, LanguageField, Level
from scenewright.gaussians.language.query.attributes import (
    COLOR_HOLDS,
    PART_SHARE,
    color_scores,
    extent,
    group_color_scores,
    size_scores,
)
from scenewright.gaussians.world.box import Box

AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
HUED = tuple(n for n in BASIC if n not in ("black", "gray", "white", "beige", "orange"))


def paint(name: str) -> tuple[float, float, float]:
    lightness, a, b = rgb_to_lab(torch.tensor(parse(BASIC[name]), dtype=torch.float64)).tolist()
    return (lightness, a, b)


def group(
    index: int = 0, size: tuple[float, float, float] = (1, 1, 1), lab: tuple[float, float, float] = (50, 0, 0),
    parent: int = -1, count: int = 100, level: Level = "object",
) -> Group:  # fmt: skip
    return Group(index, level, parent, "", 0.0, Box((0, 0, 0), AXES, size), lab, count, 1, 1.0)


def best_name(lab: tuple[float, float, float]) -> str:
    return max(BASIC, key=lambda name: float(color_scores(name, np.array(lab))))


@pytest.mark.parametrize("name", BASIC)
def test_every_basic_term_wins_on_its_own_paint(name: str) -> None:
    assert best_name(paint(name)) == name
    assert float(color_scores(name, np.array(paint(name)))) > 0.5  # more likely than any other basic term


@pytest.mark.parametrize("name", HUED)
@pytest.mark.parametrize("shade", [0.6, 0.75, 0.9, 1.0, 1.1])
def test_a_hued_word_wins_on_its_paint_in_shade_and_in_light(name: str, shade: float) -> None:
    # Orange and beige in deep shade are browns to the eye as well, and greys differ in nothing but lightness: left out.
    lightness, a, b = paint(name)
    shown = (min(lightness * shade, 100.0), a * shade, b * shade)  # shading dims all of linear light alike
    assert best_name(shown) == name
    assert float(color_scores(name, np.array(shown))) >= COLOR_HOLDS


@pytest.mark.parametrize("pair", list(itertools.permutations(HUED, 2)))
def test_no_hued_word_holds_on_the_paint_of_another(pair: tuple[str, str]) -> None:
    word, other = pair
    assert float(color_scores(word, np.array(paint(other)))) < COLOR_HOLDS


@pytest.mark.parametrize(
    ("word", "other"), [("red", "green"), ("black", "white"), ("blue", "orange"), ("teal", "brown"), ("gray", "purple")]
)
def test_swapped_colours_are_told_apart_both_ways(word: str, other: str) -> None:
    for a, b in ((word, other), (other, word)):
        assert float(color_scores(a, np.array(paint(a)))) > 0.7  # twice what it takes to hold
        assert float(color_scores(b, np.array(paint(a)))) < 0.1


@given(st.sampled_from(sorted(BASIC)), st.tuples(st.floats(0, 100), st.floats(-90, 90), st.floats(-90, 90)))
def test_scores_are_shares_and_broadcast(word: str, lab: tuple[float, float, float]) -> None:
    one = color_scores(word, np.array(lab))
    many = color_scores(word, np.array([[lab, paint(word)]]))
    assert one.shape == () and many.shape == (1, 2)
    assert 0 <= float(one) <= 1
    assert float(many[0, 0]) == pytest.approx(float(one))


@pytest.mark.parametrize(("said", "same"), [("grey", "gray"), ("Red", "red"), (" TEAL ", "teal"), ("Grey", "gray")])
def test_spelling_and_case_do_not_change_a_basic_term(said: str, same: str) -> None:
    labs = np.array([paint(n) for n in BASIC])
    assert np.array_equal(color_scores(said, labs), color_scores(same, labs))


@pytest.mark.parametrize("word", ["mustard", "navy", "crimson", "dark green", "#128080", "light blue", "wooden"])
def test_any_parsable_colour_holds_on_its_own_paint(word: str) -> None:
    lab = rgb_to_lab(torch.tensor(parse(word), dtype=torch.float64)).numpy()
    assert float(color_scores(word, lab)) >= 0.5


@pytest.mark.parametrize("word", ["blurple-ish-ly", "chair", "", "x" * 200])
def test_an_unknown_colour_is_the_users_error(word: str) -> None:
    with pytest.raises(UserError, match="unknown colour"):
        color_scores(word, np.zeros(3))


def test_a_large_part_lends_its_colour_and_a_small_one_does_not() -> None:
    lamp, shade, foot = group(0, lab=paint("gray")), group(1, lab=paint("red"), parent=0), group(2, parent=0)
    for share, holds in ((PART_SHARE, True), (0.9 * PART_SHARE, False)):
        part = group(1, lab=paint("red"), parent=0, count=round(1000 * share), level="part")
        whole = group(0, lab=paint("gray"), count=1000)
        field = LanguageField((whole, part), np.zeros((2, 4), np.float32), "fake:1")
        assert (group_color_scores(field, "red")[0] >= COLOR_HOLDS) == holds
    field = LanguageField((lamp, shade, foot), np.zeros((3, 4), np.float32), "fake:1")
    # its own colour counts a little more than a part's, so that a red thing is preferred to one with a red part
    assert group_color_scores(field, "red")[1] > group_color_scores(field, "red")[0]


boxes = st.tuples(*[st.floats(0.05, 5.0)] * 3)


@given(st.lists(boxes, min_size=1, max_size=8), st.sampled_from(["small", "large", "tall", "short", "wide", "narrow"]))
def test_a_size_word_never_empties_and_never_contradicts_the_measure(
    sizes: list[tuple[float, float, float]], word: str
) -> None:
    groups = [group(i, size=s) for i, s in enumerate(sizes)]
    scores = size_scores(groups, word)
    assert set(scores) <= {0.0, 1.0} and 1.0 in scores
    sign = 1 if word in ("large", "tall", "wide") else -1
    kept = [sign * extent(g, word) for g, s in zip(groups, scores, strict=True) if s]
    out = [sign * extent(g, word) for g, s in zip(groups, scores, strict=True) if not s]
    assert not out or min(kept) > max(out)


@pytest.mark.parametrize(("big", "little"), [("large", "small"), ("tall", "short"), ("wide", "narrow")])
@given(sizes=st.lists(boxes, min_size=2, max_size=8))
def test_opposite_size_words_part_what_they_can_tell_apart(
    big: str, little: str, sizes: list[tuple[float, float, float]]
) -> None:
    groups = [group(i, size=s) for i, s in enumerate(sizes)]
    a, b = size_scores(groups, big), size_scores(groups, little)
    assert all(x != y for x, y in zip(a, b, strict=True)) or all(x == y == 1.0 for x, y in zip(a, b, strict=True))


def test_size_words_speak_of_their_own_measure() -> None:
    pole, slab = group(0, size=(0.2, 0.2, 2.0)), group(1, size=(3.0, 2.0, 0.1))
    assert size_scores([pole, slab], "tall") == [1.0, 0.0]
    assert size_scores([pole, slab], "wide") == [0.0, 1.0]
    assert size_scores([pole, slab], "narrow") == [1.0, 0.0]
    assert size_scores([pole, slab], "large") == [0.0, 1.0]  # 0.08 against 0.6 cubic metres
    assert size_scores([], "large") == []
    assert size_scores([pole], "small") == [1.0]  # alone, it is as small as any
    twins = [group(0, size=(1, 1, 1)), group(1, size=(1, 1, 1.05))]
    assert size_scores(twins, "tall") == [1.0, 1.0]  # five per cent cannot be seen

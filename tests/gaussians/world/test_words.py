"""Words before any encoder: normalisation, and which kinds a phrase means."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenewright.gaussians.language.encoders.vocabulary import Vocabulary
from scenewright.gaussians.world import kinds
from scenewright.gaussians.world.words import normalise, singular

_WORD = st.text(alphabet="abehiosuvxyzc", min_size=1, max_size=9)
_SMALL = Vocabulary(
    kinds={"sofa": ("couch",), "table": ("dining table",), "coffee table": ("low table",), "floor lamp": (), "mug": ()},
    broader={"lamp": ("floor lamp",), "table": ("table", "coffee table")},
    negatives=("part of something",),
    modifiers=frozenset({"red", "small"}),
)


@given(_WORD)
def test_singular_is_idempotent(word: str) -> None:
    assert singular(singular(word)) == singular(word)


@given(st.text(max_size=60))
def test_normalise_is_idempotent_and_plain(text: str) -> None:
    words = normalise(text)
    assert all(w and w == w.lower() and w.isalnum() for w in words)
    assert normalise(" ".join(words)) == words or "of" in words  # "photo of photo of x" may lose a second frame


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("A photo of the red Couches", ("red", "couch")),
        ("bookshelves", ("bookshelf",)),
        ("a picture of a chair", ("chair",)),
        ("picture", ("picture",)),
        ("the glasses' vases", ("glass", "vase")),
        ("chest of drawers", ("chest", "of", "drawer")),
        ("TV-stand!", ("tv", "stand")),
        ("", ()),
        ("the", ()),
    ],
)
def test_normalise_known_cases(text: str, words: tuple[str, ...]) -> None:
    assert normalise(text) == words


@pytest.mark.parametrize(
    ("text", "kinds"),
    [
        ("small red couches", {"sofa"}),
        ("coffee table", {"coffee table"}),  # the longest name wins over its head noun
        ("table", {"table"}),  # a kind's own name beats the broader term of the same spelling
        ("lamp", {"floor lamp"}),
        ("the table with red drawers", {"table"}),
        ("spaceship", set()),
        ("", set()),
    ],
)
def test_a_phrase_means_its_head(text: str, kinds: set[str]) -> None:
    assert _SMALL.covered(text) == kinds


def test_loosely_a_table_may_be_a_coffee_table() -> None:
    assert _SMALL.covered("table", loose=True) == {"table", "coffee table"}
    assert _SMALL.covered("red sofa", loose=True) == {"sofa"}


def test_vocabulary_survives_json() -> None:
    again = Vocabulary.from_json(_SMALL.to_json())
    assert again.to_json() == _SMALL.to_json()
    assert again.names == _SMALL.names


def test_everyday_names_add_to_the_household_and_take_nothing_away() -> None:
    home, everyday = Vocabulary.household().within(kinds.table().kinds), Vocabulary.everyday()
    assert everyday.names[: len(home.names)] == home.names and len(everyday.names) > len(home.names)
    for name in (*home.names, *home.broader):
        assert everyday.covered(name) == home.covered(name)
    for name in everyday.names[len(home.names) :]:
        assert everyday.covered(name) == {name}
        assert (
            home.covered(name) <= {"teddy bear", "toy car", "towel rack"} or " " in name
        )  # else a household name said it already

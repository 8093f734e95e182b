"""What words beyond an encoder's vocabulary come to."""

import json

import pytest

from scenewright.gaussians.language.encoders import known_words
from scenewright.gaussians.language.encoders.known_words import family_of, is_loose, known_as
from scenewright.gaussians.language.encoders.vocabulary import Vocabulary
from scenewright.gaussians.world import kinds
from scenewright.gaussians.world.words import normalise

FEW = Vocabulary(
    {"chair": ("seat",), "bookshelf": ("bookcase",), "bathtub": (), "teddy bear": ("teddy",), "sword": ()},
    {"weapon": ("sword",)},
    ("a piece of wall",),
)


def test_every_name_of_the_vocabulary_is_known_as_itself():
    for name in FEW.names:
        assert known_as(name, FEW) == ((name,), "same")
        assert known_as(f"the small red {name}", FEW) == ((name,), "same")


def test_what_is_returned_is_in_the_vocabulary():
    data = json.loads((known_words.Path(known_words.__file__).with_name("known_words.json")).read_text())
    for part in ("sorts", "alike"):
        for words in data[part].values():
            for word in words:
                found = known_as(word, FEW)
                assert set(found.kinds) <= set(FEW.names)
                assert found.kinds or found.relation in ("family", "none")


@pytest.mark.parametrize(
    ("text", "kinds_", "relation"),
    [
        ("folding chair", ("chair",), "sort"),
        ("two rocking chairs", ("chair",), "sort"),
        ("seat", ("chair",), "same"),
        ("bookcase with swords", ("bookshelf",), "same"),
        ("paddling pool", ("bathtub",), "alike"),
        ("koala", ("teddy bear",), "alike"),
        ("revolver", ("sword",), "family"),
        ("alligator", (), "family"),
        ("zyzzyva", (), "none"),
        ("", (), "none"),
    ],
)
def test_relations_are_told_apart(text, kinds_, relation):
    assert known_as(text, FEW) == (kinds_, relation)


COARSE = Vocabulary(
    {"vegetable": ("cucumber", "half tomato"), "knife": ("scissors",), "bucket": ("pail",), "chair": ("seat",)},
    {"food": ("vegetable",)},
    ("a piece of wall",),
)


@pytest.mark.parametrize(
    ("text", "kinds_", "relation"),
    [
        ("cucumber", ("vegetable",), "sort"),
        ("half tomato", ("vegetable",), "sort"),
        ("scissors", ("knife",), "alike"),
        ("vegetables", ("vegetable",), "same"),
        ("food", ("vegetable",), "same"),
        ("pail", ("bucket",), "same"),
        ("seat", ("chair",), "same"),
    ],
)
def test_words_of_a_coarse_kind_are_sorts_of_it_unless_the_table_says_otherwise(text, kinds_, relation):
    assert known_as(text, COARSE) == (kinds_, relation)
    assert is_loose(f"the old {text}", COARSE) == (relation != "same")


def test_families():
    assert family_of("a green alligator") == "animal"
    assert family_of("dogs") == "animal"
    assert family_of("table") is None


def test_the_embedded_vocabulary_is_the_default():
    assert known_as("couch") == (("sofa",), "same")


def test_the_table_holds_kinds_and_no_word_is_a_sort_of_itself():
    data = json.loads((known_words.Path(known_words.__file__).with_name("known_words.json")).read_text())
    for part in ("sorts", "alike"):
        for kind, words in data[part].items():
            assert len(words) == len(set(words)), kind
            assert normalise(kind) not in map(normalise, words), kind
            assert kind == kind.lower()
    furnishings = [k for k in data["sorts"] if kinds.find(k) is not None]
    assert len(furnishings) > 80

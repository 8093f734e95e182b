"""Generate captions for training images: names of the table of kinds, non-objects, and surrounding words.

Random colours are put before names, independent of the image, so that the embeddings learn to ignore them: colour is
measured on the Gaussians themselves.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from ..gaussians import color
from ..gaussians.language.encoders.vocabulary import Vocabulary
from ..gaussians.world import kinds
from ..gaussians.world.words import normalise

PART = "part of something"
SEVERAL = "several things together"
WALL = "a piece of wall"
FLOOR = "a piece of floor"
NEGATIVES: dict[str, tuple[str, ...]] = {
    PART: ("fragment of something", "piece of something", "incomplete thing", "part of furniture", "part of a thing"),
    SEVERAL: ("several objects together", "many things together", "two things together", "group of things", "clutter"),
    WALL: ("part of the wall", "wall", "piece of the wall", "bare wall", "ceiling", "piece of ceiling"),
    FLOOR: ("part of the floor", "floor", "piece of the floor", "bare floor", "ground", "piece of ground"),
}  # fmt: skip

# Terms that cover labels beyond the table of kinds.
FURTHER: dict[str, tuple[str, ...]] = {
    "food": (
        *("piece of fruit", "vegetable", "mushroom", "bread", "burger", "sandwich", "meat", "cheese", "egg", "fish"),
        *("sushi", "pizza", "donut", "cookie", "cupcake", "ice cream", "fries", "cake", "apple", "banana"),
    ),
    "fruit": ("apple", "banana", "piece of fruit"), "dessert": ("cake", "cupcake", "ice cream"),
    "weapon": ("sword", "shield"), "vehicle": ("bicycle", "toy car", "boat", "train"),
}  # fmt: skip

_SIZES = normalise("small large big little tiny huge tall short low high wide narrow long round square thin thick")
_MATERIALS = normalise(
    "wooden wood metal steel iron glass plastic leather fabric velvet wool woollen cotton ceramic clay stone marble "
    "wicker woven bamboo rattan paper cardboard brass copper silver gold golden chrome oak pine walnut linen silk"
)
_LOOKS = normalise(
    "old new modern antique vintage classic rustic simple plain comfy comfortable cozy cosy soft hard shiny bright "
    "dark light pale striped patterned dotted checkered colorful colourful empty open closed pretty nice beautiful "
    "ugly elegant fancy minimalist decorative painted upholstered folding dining living kitchen office bedroom "
    "bathroom garden room wall floor corner standing hanging framed full single double whole complete other one "
    "first second last same left right middle only entire"
)
_SHOWN = ("", "", "", "", "photo of ", "picture of the ", "one ")


def vocabulary(names: Sequence[str], further: Mapping[str, Sequence[str]] = MappingProxyType({})) -> Vocabulary:
    """The vocabulary: the names with their synonyms, and those of similar kinds that are not shown.

    Synonyms that are also the name of a family are dropped, since they would contradict its training phrases.

    Args:
        names: kinds of the table.
        further: labels that are no kinds of the table, and their synonyms; they belong to no family but `FURTHER`.
    """
    table = kinds.table()
    terms = {normalise(term) for term in table.families}
    unshown = [k for k in table.kinds.values() if k.name not in names]
    wanted = {
        name: (*table.kinds[name].names[1:], *(n for k in unshown if name in k.alike for n in k.names))
        for name in names
    }
    kept = {name: tuple(n for n in said if normalise(n) not in terms) for name, said in wanted.items()}
    broader = {
        term: covered
        for term, members in table.families.items()
        if (covered := tuple(k for k in members if k in names)) and (term not in names or len(covered) > 1)
    }
    taken = {normalise(n) for name, said in kept.items() for n in (name, *said)} | {normalise(n) for n in further}
    own = {label: tuple(n for n in said if normalise(n) not in terms | taken) for label, said in further.items()}
    broader |= {term: members for term, members in FURTHER.items() if set(members) <= {*own, *kept}}
    return Vocabulary(kept | own, broader, tuple(NEGATIVES), frozenset(_modifiers()))


def words(vocabulary: Vocabulary) -> list[str]:
    """All words that the text tower learns, sorted: words of names and captions, and modifiers."""
    phrases = [*vocabulary.names, *vocabulary.broader, *(s for v in vocabulary.kinds.values() for s in v)]
    phrases += [*NEGATIVES, *(s for v in NEGATIVES.values() for s in v)]
    return sorted({w for p in phrases for w in normalise(p)} | set(vocabulary.modifiers))


def phrase(rng: np.random.Generator, name: str, modifiers: list[str]) -> str:
    """A random caption of `name`: alone in 40 % of cases, else after one to three modifiers."""
    count = int(rng.choice(4, p=[0.4, 0.3, 0.2, 0.1]))
    before = [modifiers[i] for i in rng.integers(len(modifiers), size=count)]
    return " ".join([_SHOWN[rng.integers(len(_SHOWN))] + " ".join([*before, name])])


def names_of(vocabulary: Vocabulary, label: str) -> tuple[str, ...]:
    """All exact names of a kind or a non-object, the canonical one first."""
    return (label, *(vocabulary.kinds[label] if label in vocabulary.kinds else NEGATIVES[label]))


def _modifiers() -> set[str]:
    """Single words that may stand before a name."""
    shades = {w for name in (*color.EVERYDAY, *color.BASIC) for w in name.split()}
    css = {name for name in color.names() if re.fullmatch("[a-z]+", name)}
    return {
        n for word in shades | css | {"grey"} | set(_SIZES) | set(_MATERIALS) | set(_LOOKS) for n in normalise(word)
    }

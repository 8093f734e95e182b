"""Words for measures of things: dimensions ("wide", "height"), comparatives, superlatives, and units of length."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from ...grammar.vocabulary.quantities import ORDINALS
from ...grammar.vocabulary.quantities import read as quantities_read

Words = tuple[str, ...]
_FAR = 10**9
Measure = Literal["width", "depth", "height", "length", "thickness", "size", "footprint", "top", "volume"]


@dataclass(frozen=True)
class Unit:
    """A unit of length: its sign and its metres."""

    name: str
    metres: float


@dataclass(frozen=True)
class Dimension:
    """What is asked of a thing, and the adjective for it: width, "wide"."""

    measure: Measure
    adjective: str


@dataclass(frozen=True)
class More:
    """A comparative: "taller" has sign +1, "less wide" and "shorter" have -1; `word` is as said."""

    measure: Measure
    sign: int
    word: str


@dataclass(frozen=True)
class Superlative:
    """A superlative: `rank` 2 is the second; sign and word as in `More`."""

    measure: Measure
    sign: int
    rank: int
    word: str


_ADJECTIVES: Mapping[Measure, str] = {
    "width": "wide", "depth": "deep", "height": "tall", "length": "long", "thickness": "thick", "size": "big",
    "footprint": "big", "top": "high", "volume": "big",
}  # fmt: skip
_DIMENSIONS: Mapping[str, Measure] = {
    **dict.fromkeys(["wide", "width", "breadth", "broad", "across", "wideness", "horizontal width"], "width"),
    **dict.fromkeys(["deep", "depth"], "depth"),
    **dict.fromkeys(["tall", "height", "high", "tallness", "vertical height", "vertical size"], "height"),
    **dict.fromkeys(["long", "length"], "length"),
    **dict.fromkeys(["thick", "thickness"], "thickness"),
    **dict.fromkeys(["big", "large", "size", "dimensions", "measurements", "bulky", "small", "dimension", "sizes",
                     "measures", "physical size", "overall size", "overall dimensions", "proportions"], "size"),
    **dict.fromkeys(["footprint", "floor area", "area", "surface area", "floor space", "base area"], "footprint"),
    **dict.fromkeys(["volume"], "volume"),
}  # fmt: skip
# Adjective, comparative and superlative, measure and direction.
_DEGREES: tuple[tuple[str, str, str, Measure, int], ...] = (
    ("tall", "taller", "tallest", "height", 1), ("high", "higher", "highest", "top", 1),
    ("short", "shorter", "shortest", "height", -1), ("low", "lower", "lowest", "top", -1),
    ("big", "bigger", "biggest", "size", 1), ("large", "larger", "largest", "size", 1),
    ("small", "smaller", "smallest", "size", -1), ("little", "littler", "littlest", "size", -1),
    ("tiny", "tinier", "tiniest", "size", -1), ("bulky", "bulkier", "bulkiest", "size", 1),
    ("wide", "wider", "widest", "width", 1), ("broad", "broader", "broadest", "width", 1),
    ("narrow", "narrower", "narrowest", "width", -1), ("long", "longer", "longest", "length", 1),
    ("deep", "deeper", "deepest", "depth", 1), ("shallow", "shallower", "shallowest", "depth", -1),
    ("thick", "thicker", "thickest", "thickness", 1), ("thin", "thinner", "thinnest", "thickness", -1),
    ("slim", "slimmer", "slimmest", "width", -1), ("flat", "flatter", "flattest", "height", -1),
    ("huge", "huger", "hugest", "size", 1), ("compact", "", "", "size", -1), ("massive", "", "", "size", 1),
)  # fmt: skip
_SIDES = frozenset({"width", "depth", "height", "length"})
_MORE: dict[str, tuple[Measure, int]] = {}
_MOST: dict[str, tuple[Measure, int]] = {"greatest": ("size", 1), "max": ("size", 1), "min": ("size", -1)}
for _plain, _more, _most, _measure, _sign in _DEGREES:
    _MORE |= {_more: (_measure, _sign), f"more {_plain}": (_measure, _sign), f"less {_plain}": (_measure, -_sign)}
    _MOST |= {_most: (_measure, _sign), f"most {_plain}": (_measure, _sign), f"least {_plain}": (_measure, -_sign)}
_MUCH = frozenset({"much", "a", "bit", "little", "lot", "slightly", "far", "significantly", "any", "noticeably", "way"})
_RANKS = {**ORDINALS, "next": 2, "2nd": 2, "3rd": 3, "4th": 4, "5th": 5, "1st": 1}


def dimension(words: Words) -> Dimension | None:
    """A dimension by adjective or noun."""
    several = [w for w in words if w not in (",", "and", "the", "its", "their")]
    if len(several) > 1 and all(w in _DIMENSIONS and _DIMENSIONS[w] in _SIDES for w in several):
        return Dimension("size", _ADJECTIVES["size"])
    measure = _DIMENSIONS.get(" ".join(words))
    return Dimension(measure, _ADJECTIVES[measure]) if measure else None


def more(words: Words) -> More | None:
    """A comparative, with or without a word of degree: "much taller"."""
    rest = list(words)
    while len(rest) > 1 and rest[0] in _MUCH:
        rest = rest[1:]
    word = " ".join(rest)
    found = _MORE.get(word) if word else None
    return More("height" if found[0] == "top" else found[0], found[1], word) if found else None


def superlative(words: Words) -> Superlative | None:
    """A superlative with its rank: "the second tallest", "biggest"."""
    rest = words[1:] if words[:1] == ("the",) else words
    if rest[:2] == ("single", "most") or rest[:1] in (("very",), ("single",), ("absolute",), ("overall",)):
        rest = rest[1:]
    rank = _RANKS.get(rest[0], 0) if len(rest) > 1 else 0
    word = " ".join(rest[1:] if rank else rest)
    found = _MOST.get(word) if word else None
    return Superlative(found[0], found[1], max(rank, 1), word) if found else None


@dataclass(frozen=True)
class Amount:
    """A condition on a number: `low` to `high`, both included."""

    low: float
    high: float

    def holds(self, value: float) -> bool:
        """Whether a number satisfies it."""
        return self.low <= value <= self.high


_BOUNDS: tuple[tuple[str, int, int], ...] = (  # phrase, added to the number for the lowest and for the highest value
    ("more than", 1, _FAR), ("any more than", 1, _FAR), ("over", 1, _FAR), ("greater than", 1, _FAR),
    ("no more than", -_FAR, 0), ("not more than", -_FAR, 0), ("no less than", 0, _FAR), ("no fewer than", 0, _FAR),
    ("at least", 0, _FAR), ("a minimum of", 0, _FAR), ("as many as", 0, _FAR), ("at most", -_FAR, 0),
    ("a maximum of", -_FAR, 0), ("up to", -_FAR, 0), ("fewer than", -_FAR, -1), ("less than", -_FAR, -1),
    ("under", -_FAR, -1), ("exactly", 0, 0), ("only", 0, 0), ("precisely", 0, 0), ("no other than", 0, 0),
    ("a total of", 0, 0),
)  # fmt: skip


def amount(words: Words) -> Amount | None:
    """A condition on a number: "more than one", "at least 3", "two or more", "four"."""
    said = " ".join(words)
    if said in ("several", "multiple", "a couple of", "a pair of", "plenty of", "a few"):
        return Amount(2, 2) if "couple" in said or "pair" in said else Amount(2, _FAR)
    for ending, low, high in ((" or more", 0, _FAR), (" or fewer", -_FAR, 0), (" or less", -_FAR, 0)):
        if said.endswith(ending) and (n := _whole(said.removesuffix(ending))) is not None:
            return Amount(n + low, n + high)
    for phrase, low, high in sorted(_BOUNDS, key=lambda b: -len(b[0])):
        if said.startswith(f"{phrase} ") and (n := _whole(said.removeprefix(f"{phrase} "))) is not None:
            return Amount(n + low, n + high)
    n = _whole(said)
    return None if n is None or said in ("a", "an", "one") else Amount(n, n)


def _whole(said: str) -> float | None:
    words = said.split()
    if words[:1] == ["the"]:
        words = words[1:]
    if words in (["a"], ["an"], ["a", "single"], ["one"], ["single"]):
        return 1.0
    found = quantities_read(words) if words else None
    fits = found is not None and found.kind == "NUMBER" and found.taken == len(words)
    return found.value if found is not None and fits and found.value == int(found.value) else None

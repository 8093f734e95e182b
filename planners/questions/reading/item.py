"""Reads things that are not there yet, with their sizes: "a 2 m by 1 m table", "another bookcase, say 90 cm wide".

Every word must be understood: a measure, a word that says which side it measures, or the name of a thing. Sizes that
are not stated are those of the kind as sold.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

from ....gaussians import late_re as re
from ....gaussians.world import kinds
from ....gaussians.world.lengths import METRES
from ....gaussians.world.words import singular
from ...grammar.vocabulary import quantities
from ...grammar.vocabulary.quantities import NUMBERS
from .phrase_templates import Words
from .spans import length

Side = Literal["width", "depth", "height", "length", "diameter", ""]

_SIDES: dict[str, Side] = {
    "wide": "width", "broad": "width", "width": "width", "deep": "depth", "depth": "depth", "thick": "depth",
    "long": "length", "length": "length", "high": "height", "tall": "height", "height": "height", "across": "diameter",
    "diameter": "diameter",
}  # fmt: skip
_BY = frozenset(("by", "x", "*", "×", "times"))
_FILLERS = frozenset(
    [
        "say",
        "of",
        "that",
        "which",
        "is",
        "are",
        "it",
        "measuring",
        "measures",
        "measure",
        "with",
        "and",
        "a",
        "an",
        "about",
        "around",
        "roughly",
        "size",
        "sized",
        "dimensions",
        "footprint",
        "being",
        "having",
        "has",
        "in",
        "the",
        ",",
        "-",
        "standing",
        "its",
        "some",
        "maybe",
        "approximately",
        ",",
        "would",
        "be",
        "perhaps",
        "only",
        "just",
        "at",
        "least",
    ]
)
_DETERMINERS = re.compile(
    r"^(?:(?:a|an|another|one more|one extra|one|some|my|our|your|this|that|any|extra|new|additional|"
    r"second|third|further|more|whole|proper|"
    r"standard|normal|regular|typical|average|full size|small|little|big|large|huge|single) )+"
)
_GENERIC = frozenset(
    "something anything thing object item piece furniture one".split()  # noqa: SIM905
) | {"piece of furniture", "bit of furniture", "thing", "", "it"}
_NO_NAME = frozenset(
    [
        "fit",
        "fits",
        "go",
        "stand",
        "put",
        "place",
        "placed",
        "squeeze",
        "next",
        "under",
        "on",
        "between",
        "behind",
        "beside",
        "near",
        "against",
        "along",
        "above",
        "into",
        "through",
        "is",
        "are",
        "was",
        "be",
        "will",
        "would",
        "could",
        "can",
        "should",
        "may",
        "might",
        "do",
        "does",
        "did",
        "has",
        "have",
        "had",
        "there",
        "here",
        "what",
        "which",
        "who",
        "where",
        "how",
        "why",
        "when",
        "if",
        "whether",
        "and",
        "or",
        "not",
        "to",
        "for",
        "from",
        "at",
        "by",
        "with",
        "without",
        "me",
        "i",
        "we",
        "you",
        "they",
        "than",
        "then",
        "so",
        "as",
        "both",
        "either",
        "neither",
        "left",
        "right",
        "front",
        "back",
        "wall",
        "corner",
        "room",
    ]
)
_MOST_WORDS = 16


@dataclass(frozen=True)
class Item:
    """A thing that somebody would like to place.

    Attributes:
        name: as said, "" for "something".
        width, depth, height: metres as stated, None if not stated.
        facing_wall: whether the stated width is meant to run along the wall that the thing stands at.
        count: how many.
        definite: whether a thing that is there may be meant: "the sofa", "it".
    """

    name: str
    width: float | None = None
    depth: float | None = None
    height: float | None = None
    facing_wall: bool = False
    count: int = 1
    definite: bool = False

    @property
    def stated(self) -> bool:
        """Whether any side is stated."""
        return any(side is not None for side in (self.width, self.depth, self.height))

    @property
    def kind(self) -> kinds.Kind | None:
        """What kind of thing it is."""
        return kinds.of(self.name) if self.name else None


@dataclass(frozen=True)
class _Measure:
    """A stated length, the side that it measures, and whether it is one of "2 m by 1 m"."""

    value: float
    side: Side
    paired: bool = False


@lru_cache(maxsize=4096)
def read_item(words: Words) -> Item | None:
    """The thing that the words describe, None if they are none, or not all of them are understood."""
    if not words or len(words) > _MOST_WORDS:
        return None
    rest: list[str] = []
    found: list[_Measure] = []
    at = 0
    while at < len(words):
        group, at = _measures(words, at)
        if group:
            found += group
        else:
            rest.append(words[at])
            at += 1
    sized = _sized(found)
    name = _name(tuple(rest), bool(found))
    if sized is None or name is None:
        return None
    said, count, definite = name
    item = replace(sized, name=said, count=count, definite=definite)
    if not item.stated and (item.kind is None and not definite):
        return Item(said, count=count) if said and said in kinds.table().others else None
    return item


def _measures(words: Words, at: int) -> tuple[list[_Measure], int]:
    """The measures at a position, each with its side, and the position behind them: "2 m by 1 m", "90 cm wide"."""
    side: Side = ""
    start = at
    if words[at] in ("width", "depth", "height", "length", "diameter"):
        side, start = _SIDES[words[at]], at + 1
        while start < len(words) and words[start] in ("of", "is", "about", "around", "="):
            start += 1
    numbers: list[tuple[float, float]] = []  # value, and metres of its unit; 0 without one
    i = start
    while i < len(words):
        amount = _amount(words, i)
        if amount is None:
            break
        value, scale, i = amount
        numbers.append((value, scale))
        if i < len(words) - 1 and words[i] in _BY and _amount(words, i + 1):
            i += 1
            continue
        break
    shared = next((scale for _, scale in reversed(numbers) if scale), 0.0)
    if not numbers or not shared:
        return [], at
    lengths = [value * (scale or shared) for value, scale in numbers]
    if side:
        return [_Measure(lengths[0], side)], i
    if i < len(words) and words[i] in _SIDES:
        side, i = _SIDES[words[i]], i + 1
    elif words[i : i + 1] == ("in",) and words[i + 1 : i + 2] and words[i + 1] in _SIDES:
        side, i = _SIDES[words[i + 1]], i + 2
    elif words[i : i + 1] == ("square",):
        side, i = "diameter", i + 1
    if len(lengths) == 1:
        return [_Measure(lengths[0], side)], i
    sides: tuple[Side, ...] = ("width", "depth", "height")
    if len(lengths) > 3:
        return [], at
    return [_Measure(v, s, paired=True) for v, s in zip(lengths, sides, strict=False)], i


def _amount(words: Words, at: int) -> tuple[float, float, int] | None:
    """A number or length at a position: its value, the metres of its unit (0 without one), and the position behind."""
    stop = next((j for j in range(at + 1, min(len(words), at + 7)) if words[j] in _BY or words[j] in _SIDES), at + 7)
    for end in range(min(len(words), stop), at, -1):
        said = words[at:end]
        if said[0] in ("and", "of"):
            continue
        found = quantities.read(said)
        if found and found.kind == "LENGTH" and found.taken == len(said) and found.unit in METRES:
            return found.value, METRES[found.unit], end
        if (metres := length(said)) is not None:
            return metres, 1.0, end
        by = (words[end : end + 1] and words[end] in _BY) or (at > 0 and words[at - 1] in _BY)
        if by and found and found.kind == "NUMBER" and found.taken == len(said):
            return found.value, 0.0, end
    return None


def _sized(found: list[_Measure]) -> Item | None:
    """The stated sides; None if one is stated twice or is no length."""
    sides: dict[str, float] = {}
    for measure in found:
        key = measure.side or ("length" if "length" not in sides else "width")
        if key in sides or not 0 < measure.value < 1000:
            return None
        sides[key] = measure.value
    if "diameter" in sides:
        if sides.keys() & {"width", "depth", "length"}:
            return None
        sides["width"] = sides["depth"] = sides.pop("diameter")
    along = sides.pop("length", None)
    both = along is not None and "width" in sides
    if along is not None:
        if both and "depth" in sides:
            return None
        if both:
            sides["width"], sides["depth"] = max(along, sides["width"]), min(along, sides["width"])
        else:
            sides["width"] = along
    wall = not both and any(m.side in ("width", "length") and not m.paired for m in found)
    return Item("", sides.get("width"), sides.get("depth"), sides.get("height"), wall)


def _name(rest: Words, measured: bool) -> tuple[str, int, bool] | None:
    """The name, how many, and whether it may be a thing that is there; None if the words are no name."""
    words = [w for w in rest if w != ","]
    if measured:
        while words and words[-1] in _FILLERS:
            words.pop()
    said = " ".join(words)
    definite = said.startswith(("the ", "this ", "that ")) or said in ("it", "this", "that")
    count = 1
    if (words and words[0] in NUMBERS and words[0] != "one") or (words and words[0].isdigit()):
        count = NUMBERS.get(words[0]) or int(words[0])
        said = " ".join(words[1:])
        said = said.removeprefix("more ").removeprefix("extra ").removeprefix("additional ")
        if not 0 < count <= 20:
            return None
    said = _DETERMINERS.sub("", f"{said} ").strip().removeprefix("the ")
    if said in ("a", "an", "another", "one", "some"):
        said = ""
    if measured and kinds.find(said) is None:
        said = " ".join(w for w in said.split() if w not in _FILLERS)
    if not said and (not words or words[-1] not in _GENERIC):
        return None
    if said in _GENERIC:
        return ("", count, definite) if measured or definite else None
    tokens = said.split()
    if len(tokens) > 5 or any(t in _NO_NAME or not t.replace("'", "").isalpha() for t in tokens):
        return None
    if not measured and not definite and kinds.of(said) is None and singular(said) not in kinds.table().others:
        return None
    return said, count, definite

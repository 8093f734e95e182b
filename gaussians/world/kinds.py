"""The table of kinds of things: names, sizes, supports and usual places, read from `kinds.json` when first needed.

Sizes are those of things as sold, in metres. Every package reads kinds here: the asset builders, the composer,
the grammar, the wishes, the checker and the vocabularies of the encoders. Adding a kind is one entry of the file.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal

from .words import AFTER_HEAD, normalise, singular

Support = Literal["floor", "surface", "wall", "ceiling"]
Range = tuple[float, float]
Phrase = tuple[str, ...]

FARTHEST = 2.0  # factor beyond the largest and smallest size as sold; things outside are hardly of that kind
_FILE = Path(__file__).with_name("kinds.json")


@dataclass(frozen=True)
class Kind:
    """A kind of thing.

    Attributes:
        name: lower case, singular where English has one.
        size: lowest and highest width x, depth y and height z as sold, metres.
        also: other words for it.
        loosely: words that mean it only if they are the whole name: a "bag" is a backpack, a "sleeping bag" is not.
        labels: other words that mean it only as the label of a thing, because sentences use them otherwise: "watch".
        narrower: words that ask for it and mean less than it: a sort ("fern"), or what it holds ("towels").
        sorts: whether words before its name tell sorts of it apart: a "writing desk" is no "computer desk".
        one: for a collective name ("ceiling beams"), the kind of each single thing.
        like: the kind that it replaces in a room: a room with a queen bed needs no other bed.
        alike: kinds whose names people use for it, and the reverse: a "loveseat" may be called a sofa.
        support: what it stands on or hangs from; "surface": the top of another thing.
        asset: name of the builder that draws it, "" if it is drawn as a plain block.
        shown: whether the trained encoder was shown our own pictures of it.
        on: kinds that a small thing usually stands on, the likeliest first.
        backed: whether its back belongs against a wall.
        aisle: metres between its back and that wall, where people work behind it.
        front: whether it has a side that people look at or use.
        round: whether its width equals its depth and all sides are alike.
        top: whether small things are put on it.
        under: share of its height that is free beneath it: a box stands under a table, a bench under a tree.
        stores: whether things are kept in or on it: shelves, cabinets, chests.
        holds: whether things are put into it: boxes, bowls, sinks.
        fixed: whether it is part of the building or connected to it, so that it is not moved.
        opening: whether it is an opening in a wall, flush with its face.
        clear: metres kept free before, behind, left and right of it.
        seats: how many people sit on it.
        colors: usual colours.
    """

    name: str
    size: tuple[Range, Range, Range]
    also: tuple[str, ...] = ()
    loosely: tuple[str, ...] = ()
    labels: tuple[str, ...] = ()
    narrower: tuple[str, ...] = ()
    sorts: bool = True
    one: str | None = None
    like: str | None = None
    alike: tuple[str, ...] = ()
    support: Support = "floor"
    asset: str = ""
    shown: bool = False
    on: tuple[str, ...] = ()
    backed: bool = False
    aisle: float = 0.0
    front: bool = False
    round: bool = False
    top: bool = False
    under: float = 0.0
    stores: bool = False
    holds: bool = False
    fixed: bool = False
    opening: bool = False
    clear: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    seats: int = 0
    colors: tuple[str, ...] = ()

    @property
    def role(self) -> str:
        """The kind that it replaces in a room, or its own name."""
        return self.like or self.name

    @property
    def names(self) -> tuple[str, ...]:
        """Every word for it, its own name first."""
        return tuple(dict.fromkeys((self.name, *self.also, *self.loosely, *self.labels, *self.narrower)))

    @property
    def usual_size(self) -> tuple[float, float, float]:
        """Width, depth and height of a usual one, metres: the middle of the sizes as sold, as ratios go."""
        width, depth, height = (math.sqrt(low * high) if low > 0 else high / 2 for low, high in self.size)
        return width, depth, height

    @property
    def is_rug(self) -> bool:
        """Whether it lies flat on the floor, so that people and things stand on it."""
        return self.support == "floor" and self.size[2][1] <= 0.05


@dataclass(frozen=True)
class Table:
    """What `kinds.json` holds.

    Attributes:
        kinds: every kind by its name.
        families: words that cover several kinds or other things ("appliance"), and what they cover; the first is
            what the word means where it is also a word for one kind.
        others: things in scenes that are not furnishings: animals, vehicles, food, clothes.
    """

    kinds: Mapping[str, Kind]
    families: Mapping[str, tuple[str, ...]]
    others: tuple[str, ...]


@cache
def table(file: Path = _FILE) -> Table:
    """The table.

    Raises:
        AssertionError: the file names a kind twice, or refers to one that it does not hold.
    """
    data = json.loads(file.read_bytes())
    found = [_kind(entry) for entry in data["kinds"]]
    kinds = {k.name: k for k in found}
    assert len(kinds) == len(found), "a kind has two entries"
    asked = {r for k in found for r in (*k.on, *k.alike, *([k.like] if k.like else []), *([k.one] if k.one else []))}
    assert asked <= set(kinds), f"entries refer to kinds that the table lacks: {sorted(asked - set(kinds))}"
    families = {word: tuple(members) for word, members in data["families"].items()}
    strange = {m for members in families.values() for m in members} - set(kinds) - set(data["others"])
    assert not strange, f"families hold members that the table lacks: {sorted(strange)}"
    return Table(MappingProxyType(kinds), MappingProxyType(families), tuple(data["others"]))


def _kind(entry: Mapping[str, Any]) -> Kind:
    """One entry; lists become tuples, and a kind is drawn by the builder of its own name unless it names another."""
    values = {key: _frozen(value) for key, value in entry.items()}
    return Kind(**{"asset": entry["name"], **values})


def _frozen(value: Any) -> Any:
    return tuple(_frozen(v) for v in value) if isinstance(value, list) else value


def words_of(name: str) -> Phrase:
    """A name as its words in lower case, without hyphens and apostrophes: "Bar-Stool" to `("bar", "stool")`."""
    return tuple(name.lower().replace("_", " ").replace("-", " ").replace("'", "").split())


@cache
def by_words() -> Mapping[Phrase, Kind]:
    """Names as tuples of words, as written and with the last word in the singular, and the kinds they name."""
    written = {words_of(n): k for k in table().kinds.values() for n in k.names}
    return MappingProxyType({(*w[:-1], singular(w[-1])): k for w, k in written.items()} | written)


def find(name: str) -> Kind | None:
    """The kind that a whole name means, in singular or plural; None if no kind has this name."""
    words = words_of(name)
    return next((by_words()[form] for form in _numbers(words) if form in by_words()), None)


def of(label: str) -> Kind | None:
    """The kind that a label means by its longest ending that names one: "exposed brick fireplace" to
    fireplace, "table with drawers" to table.

    Loose words count only where they are the whole label.
    """
    if (kind := find(label)) is not None:
        return kind
    words = words_of(label)
    words = words[: next((i for i, w in enumerate(words) if i and (w == "of" or w in AFTER_HEAD)), len(words))]
    for start in range(len(words)):
        for form in _numbers(words[start:]):
            kind = by_words().get(form)
            if kind is not None and (start == 0 or not _is_loose(form, kind)):
                return kind
    return None


def is_opening(label: str) -> bool:
    """Whether a label names an opening in a wall: a door or a window."""
    kind = of(label)
    return kind is not None and kind.opening


def is_door(label: str) -> bool:
    """Whether a whole label names a door of a room; a "cabinet door" is not one."""
    kind = find(label)
    return kind is not None and kind.name == "door"


def _is_loose(words: Phrase, kind: Kind) -> bool:
    loose = {words_of(n) for n in (*kind.loosely, *kind.labels)}
    return words in loose or any((*w[:-1], singular(w[-1])) == words for w in loose)


def _numbers(words: Phrase) -> Iterator[Phrase]:
    """A phrase as it is and in the singular."""
    if words:
        yield words
        yield (*words[:-1], singular(words[-1]))


@cache
def heads() -> frozenset[str]:
    """The head noun of every name: the last word, or the one before "of"."""
    found = (words_of(n) for k in table().kinds.values() for n in k.names)
    cut = (w[: w.index("of")] if "of" in w[1:] else w for w in found)
    return frozenset(w[-1] for w in cut) | {w for word in table().families for w in words_of(word)[-1:]}


@cache
def every_word() -> frozenset[str]:
    """Every single word of the names of kinds and families."""
    names = (*(n for k in table().kinds.values() for n in k.names), *table().families)
    return frozenset(w for n in names for w in words_of(n))


@cache
def phrases() -> frozenset[str]:
    """Every name of a kind, as it is written."""
    return frozenset(n for k in table().kinds.values() for n in k.names)


@cache
def _alike() -> Mapping[str, tuple[Kind, ...]]:
    """By name of a kind: the kinds whose names people use for it, in either direction."""
    kinds = table().kinds
    pairs = {(k.name, other) for k in kinds.values() for other in k.alike}
    pairs |= {(b, a) for a, b in pairs}
    return {name: tuple(kinds[b] for a, b in sorted(pairs) if a == name) for name in kinds}


@cache
def same(phrase: Phrase) -> frozenset[Phrase]:
    """All phrases for the thing that a phrase names, the phrase itself among them (singular words, lower case).

    Words for the same family mean the same. A word for a family also names a kind if it is that kind's own name, or
    another word for the first of its members ("cupboard": cabinet, wardrobe). Sorts of a kind that are named by a word
    before its name ("writing desk", "computer desk") are told apart.
    """
    members = _families().get(phrase)
    found = {phrase} | {word for word, others in _families().items() if others == members}
    kind = _by_phrase().get(phrase)
    if kind is None or phrase in _narrower(kind) or not _names_kind(phrase, kind):
        return frozenset(found)
    own = normalise(kind.name)
    names = {normalise(n) for n in kind.names if _names_kind(normalise(n), kind)}
    if members is None:  # a word for a family does not mean kinds that are only like the one it names
        names |= {normalise(n) for other in _alike()[kind.name] for n in other.names} - _families().keys()
    names -= _narrower(kind).union(*(_narrower(other) for other in _alike()[kind.name]))
    sort = kind.sorts and len(phrase) > len(own) and phrase[-len(own) :] == own
    return frozenset(found | {n for n in names if not (sort and len(n) > len(own) and n[-len(own) :] == own)})


def _names_kind(phrase: Phrase, kind: Kind) -> bool:
    """Whether a word for a kind means that kind alone, and not only a family that the kind belongs to."""
    members = _families().get(phrase)
    own = normalise(kind.name)
    return members is None or phrase == own or (members[0] == own and not _is_loose(phrase, kind))


@cache
def narrower(phrase: Phrase) -> frozenset[Phrase]:
    """What a word for a family covers, with every synonym; empty for other words."""
    members = _families().get(phrase, ())
    kinds = (_by_phrase()[member] for member in members if member in _by_phrase())
    named = frozenset(p for member in members for p in same(member) - whole_labels() | {member})
    return named.union(*(_narrower(kind) for kind in kinds))


def _narrower(kind: Kind) -> frozenset[Phrase]:
    return frozenset(normalise(n) for n in kind.narrower)


@cache
def whole_labels() -> frozenset[Phrase]:
    """Words for a kind that name it only where they are the whole label."""
    return frozenset(normalise(n) for k in table().kinds.values() for n in (*k.loosely, *k.labels))


@cache
def _by_phrase() -> Mapping[Phrase, Kind]:
    """Normalised names; a kind's own name beats another's synonym of the same words."""
    kinds = table().kinds.values()
    return {normalise(n): k for k in kinds for n in k.names} | {normalise(k.name): k for k in kinds if k.one is None}


@cache
def _families() -> Mapping[Phrase, tuple[Phrase, ...]]:
    return {normalise(word): tuple(normalise(m) for m in members) for word, members in table().families.items()}


@cache
def extent(name: str) -> tuple[Range, Range, Range]:
    """Smallest and largest width, depth and height, metres, of things that may have this name.

    They are `FARTHEST` times smaller and larger than the sizes as sold, of the kind itself and of all kinds with the
    same builder ("piano": also grand pianos).
    """
    sizes = [k.size for k in table().kinds.values() if name in (k.name, k.asset)]
    low = (min(s[i][0] for s in sizes) / FARTHEST for i in range(3))
    high = (max(s[i][1] for s in sizes) * FARTHEST for i in range(3))
    width, depth, height = zip(low, high, strict=True)
    return width, depth, height

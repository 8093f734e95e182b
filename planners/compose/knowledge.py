"""What rooms are like: kinds of rooms and what belongs in them, things with their sizes, styles. Read from three files.

Knows names, ranges and habits. Refuses to know sentences (reading.py) and places (the layout solver).
Sizes are those of furniture as it is sold and of rooms as they are built, rounded ranges from common knowledge.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, model_validator

from ...gaussians.world.relations import WishName
from ...gaussians.world.words import singular

Name = Annotated[str, Field(min_length=1, max_length=60, pattern=r"^[a-z][a-z' ]*$")]
Share = Annotated[float, Field(ge=0, le=3, allow_inf_nan=False)]
Side = Annotated[float, Field(gt=0, le=30, allow_inf_nan=False)]
Span = tuple[Side, Side]
Number = Annotated[int, Field(ge=0, le=60)]
Counts = tuple[Number, Number]


class _Entry(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class ThingKind(_Entry):
    """A kind of thing.

    Attributes:
        name, also: what it is called, singular and lower case, and other words for it.
        size: lowest and highest width, depth and height, metres.
        support: what it is put on or hung from; "surface": the top of another thing.
        like: what it stands in for: who asks for a queen bed needs no other "bed".
        on: names of the things that a small one is usually found on, the likeliest first.
        backed: its back belongs against a wall.
        aisle: metres between its back and that wall, where somebody works behind it.
        front: whether it has a side that people look at or use.
        round: whether all its sides are alike.
        top: whether small things are put on it.
        clear: metres kept free before, behind, left and right of it.
        seats: how many people sit on it.
        colors: that it usually has.
    """

    name: Name
    also: tuple[Name, ...] = ()
    size: tuple[Span, Span, Span]
    support: Literal["floor", "surface", "wall", "ceiling"] = "floor"
    like: Name | None = None
    on: tuple[Name, ...] = ()
    backed: bool = False
    aisle: Share = 0.0
    front: bool = False
    round: bool = False
    top: bool = False
    clear: tuple[Share, Share, Share, Share] = (0.0, 0.0, 0.0, 0.0)
    seats: Annotated[int, Field(ge=0, le=12)] = 0
    colors: tuple[Name, ...] = ()

    @property
    def role(self) -> str:
        """What it is in a room, whatever sort of it."""
        return self.like or self.name

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if any(low > high for low, high in self.size):
            raise ValueError(f"{self.name}: a range of sizes runs from high to low")
        return self


class Habit(_Entry):
    """What a kind of room usually holds.

    Attributes:
        thing: name of a kind of thing.
        count: fewest and most; for each one of `each`, where that is said.
        each: name of another thing of the same room.
        wishes: relation names with the thing that they are to, if they are to any: ["next_to", "bed"].
    """

    thing: Name
    count: Counts
    each: Name | None = None
    wishes: tuple[tuple[WishName] | tuple[WishName, Name], ...] = ()


class Seat(_Entry):
    """Who is to be seated gets these: `holds` people on each, `most` of them."""

    thing: Name
    holds: Annotated[int, Field(ge=1, le=12)]
    most: Number


class RoomKind(_Entry):
    """A kind of room.

    Attributes:
        name, also: what it is called.
        width, depth, height: usual ranges, metres.
        windows: fewest and most.
        must: without which it would not be such a room.
        usual: what else is found there, the likeliest first.
        seats: what guests are seated on, filled in this order.
    """

    name: Name
    also: tuple[Name, ...] = ()
    width: Span
    depth: Span
    height: Span
    windows: Counts
    must: tuple[Habit, ...]
    usual: tuple[Habit, ...]
    seats: tuple[Seat, ...] = ()

    @property
    def habits(self) -> tuple[Habit, ...]:
        return self.must + self.usual

    @model_validator(mode="after")
    def _closed(self) -> Self:
        named = {h.thing for h in self.habits} | {"door", "window"}
        for habit in self.habits:
            asked = {habit.thing, *(w[1] for w in habit.wishes if len(w) > 1), *([habit.each] if habit.each else [])}
            if strange := sorted(asked - named):
                raise ValueError(f"{self.name}: {habit.thing} is related to {strange}, which the room does not hold")
        return self


class Style(_Entry):
    """What a word of style changes.

    Attributes:
        share: of the usual number of things.
        adds: things that are taken in first.
        colors: that things have where nothing else is said.
        unshown: what the word also means and boxes cannot show.
    """

    name: Name
    also: tuple[Name, ...] = ()
    share: Share = 1.0
    adds: tuple[Name, ...] = ()
    colors: tuple[Name, ...] = ()
    unshown: Annotated[str, Field(max_length=80)] = ""


@cache
def _things() -> tuple[ThingKind, ...]:
    return TypeAdapter(tuple[ThingKind, ...]).validate_json(_text("things.json"))


@cache
def things() -> Mapping[str, ThingKind]:
    """Every kind of thing by its name."""
    return MappingProxyType({t.name: t for t in _things()})


@cache
def rooms() -> Mapping[str, RoomKind]:
    """Every kind of room by its name; what they hold is among `things`."""
    found = TypeAdapter(tuple[RoomKind, ...]).validate_json(_text("rooms.json"))
    strange = {h.thing for room in found for h in room.habits} - set(things())
    assert not strange, f"rooms hold things that nobody described: {sorted(strange)}"
    return MappingProxyType({r.name: r for r in found})


@cache
def styles() -> Mapping[str, Style]:
    """Every style by its name."""
    found = TypeAdapter(tuple[Style, ...]).validate_json(_text("styles.json"))
    return MappingProxyType({s.name: s for s in found})


def _text(file: str) -> bytes:
    return Path(__file__).with_name(file).read_bytes()


def _words(name: str) -> tuple[str, ...]:
    return tuple(name.replace("-", " ").replace("'", "").split())


Table = Mapping[tuple[str, ...], str]


@cache
def thing_words() -> Table:
    """Names of things as tuples of words, the last one singular, and what they name."""
    told = {_words(a): t.name for t in _things() for a in (*t.also, t.name)}
    return MappingProxyType({(*w[:-1], singular(w[-1])): name for w, name in told.items()} | told)


@cache
def room_words() -> Table:
    """Names of rooms as tuples of words, and what they name."""
    return MappingProxyType({_words(a): r.name for r in rooms().values() for a in (*r.also, r.name)})


@cache
def style_words() -> Table:
    """Words of style and what they name."""
    return MappingProxyType({_words(a): s.name for s in styles().values() for a in (*s.also, s.name)})


@cache
def every_word() -> frozenset[str]:
    """Every single word of the names of things, rooms and styles."""
    return frozenset(w for table in (thing_words(), room_words(), style_words()) for name in table for w in name)


def lookup(table: Table, words: Sequence[str], i: int) -> tuple[str, int] | None:
    """The longest name of a table at position `i`, in singular or plural, and how many words it has."""
    for taken in range(min(4, len(words) - i), 0, -1):
        said = tuple(words[i : i + taken])
        for form in (said, (*said[:-1], singular(said[-1]))):
            if form in table:
                return table[form], taken
    return None


def longest_name(words: Sequence[str], i: int) -> int:
    """How many words the longest name of a thing, a room or a style has at position `i`; 0 if none stands there."""
    found = (lookup(table, words, i) for table in (thing_words(), room_words(), style_words()))
    return max((f[1] for f in found if f), default=0)


def thing(name: str) -> ThingKind | None:
    """The kind that a name means, in singular or plural, by any of its words; None if nobody described it."""
    words = _words(" ".join(name.lower().split()))
    found = lookup(thing_words(), words, 0) if words else None
    return things()[found[0]] if found and found[1] == len(words) else None


def room(name: str) -> RoomKind:
    """The kind of room that a name means; just a room if nobody described it."""
    words = _words(" ".join(name.lower().split()))
    found = lookup(room_words(), words, 0) if words else None
    return rooms()[found[0] if found and found[1] == len(words) else "room"]


def summary(kind: RoomKind) -> str:
    """What is known of a kind of room, as few lines for a language model: sizes in metres, things with usual sizes."""
    lines = [f"{kind.name}: {_span(kind.width)} wide, {_span(kind.depth)} deep, {_span(kind.height)} high"]
    for habit in kind.habits:
        low, high = habit.count
        size = " x ".join(_span(s) for s in things()[habit.thing].size)
        wished = "; ".join(" ".join(w) for w in habit.wishes)
        each = f" for each {habit.each}" if habit.each else ""
        must = "must" if habit in kind.must else "usual"
        counted = str(low) if low == high else f"{low}-{high}"
        lines.append(f"- {habit.thing} ({must}, {counted}{each}, {size}){': ' + wished if wished else ''}")
    return "\n".join(lines)


def _span(span: Sequence[float]) -> str:
    return f"{span[0]:g}-{span[1]:g} m"

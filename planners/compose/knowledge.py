"""Kinds of rooms with their usual sizes and things, and styles, read from `rooms.json` and `styles.json`.

Things are those of the table of kinds. Sizes are rounded ranges of built rooms, from common knowledge.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, model_validator

from ...gaussians.world import everyday, everyday_names, kinds
from ...gaussians.world.kinds import Kind
from ...gaussians.world.relations import WishName
from ...gaussians.world.styles import STYLES, Role
from ...gaussians.world.words import singular

Name = Annotated[str, Field(min_length=1, max_length=60, pattern=r"^[a-z][a-z' ]*$")]
Share = Annotated[float, Field(ge=0, le=3, allow_inf_nan=False)]
Side = Annotated[float, Field(gt=0, le=30, allow_inf_nan=False)]
Span = tuple[Side, Side]
Number = Annotated[int, Field(ge=0, le=60)]
Counts = tuple[Number, Number]


class _Entry(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Habit(_Entry):
    """A thing that a kind of room usually holds.

    Attributes:
        thing: name of a kind of thing.
        count: fewest and most; for each one of `each`, where that is set.
        each: name of another thing of the same room.
        wishes: names of relations, each with its object if it has one: ["next_to", "bed"].
    """

    thing: Name
    count: Counts
    each: Name | None = None
    wishes: tuple[tuple[WishName] | tuple[WishName, Name], ...] = ()


class Seat(_Entry):
    """Seats that are added for people: `holds` people on each, at most `most` of them."""

    thing: Name
    holds: Annotated[int, Field(ge=1, le=12)]
    most: Number


class RoomKind(_Entry):
    """A kind of room.

    Attributes:
        name, also: its names.
        width, depth, height: usual ranges, metres.
        windows: fewest and most.
        must: habits that every such room has.
        usual: further habits, the likeliest first.
        seats: seats for guests, filled in this order.
        outdoor: whether it is outdoors: without walls, ceiling, door and windows.
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
    outdoor: bool = False

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
    """What a style word changes.

    Attributes:
        share: factor on the usual number of things.
        adds: things that are added first.
        colors: preferred colours of things without a stated colour.
        unshown: what the word also means and boxes cannot show.
        materials: surfaces of what nothing else is said of, by role, see `gaussians.world.styles`.
    """

    name: Name
    also: tuple[Name, ...] = ()
    share: Share = 1.0
    adds: tuple[Name, ...] = ()
    colors: tuple[Name, ...] = ()
    unshown: Annotated[str, Field(max_length=80)] = ""
    materials: dict[Role, Annotated[str, Field(max_length=60)]] = {}


@cache
def things() -> Mapping[str, Kind]:
    """Every kind of thing by its name, without names for several things as one."""
    return MappingProxyType({k.name: k for k in kinds.table().kinds.values() if k.one is None})


@cache
def rooms() -> Mapping[str, RoomKind]:
    """Every kind of room by its name; what they hold is among `things`."""
    found = TypeAdapter(tuple[RoomKind, ...]).validate_json(_text("rooms.json"))
    strange = {n for room in found for n in _asked(room)} - set(things())
    assert not strange, f"rooms hold things that the table of kinds lacks: {sorted(strange)}"
    return MappingProxyType({r.name: r for r in found})


def _asked(room: RoomKind) -> set[str]:
    """Names of the things that a room holds or seats people on."""
    return {h.thing for h in room.habits} | {s.thing for s in room.seats}


@cache
def styles() -> Mapping[str, Style]:
    """Every style by its name."""
    found = TypeAdapter(tuple[Style, ...]).validate_json(STYLES.read_bytes())
    strange = {name for style in found for name in style.adds} - set(things())
    assert not strange, f"styles add things that the table of kinds lacks: {sorted(strange)}"
    return MappingProxyType({s.name: s for s in found})


def _text(file: str) -> bytes:
    return Path(__file__).with_name(file).read_bytes()


def _words(name: str) -> tuple[str, ...]:
    return tuple(name.replace("-", " ").replace("'", "").split())


Table = Mapping[tuple[str, ...], str]
_ALIASES = {
    ("mobile",): "baby mobile",
    ("towel",): "folded towel",
}  # words that mean another thing as the label of a thing


@cache
def thing_words() -> Table:
    """Names of things as tuples of words, the last one singular, and what they name."""
    every = kinds.table().kinds.values()
    told = {_words(a): k.one or k.name for k in every for a in k.names if a not in k.labels}
    more = {w: " ".join(w if "of" in w else (*w[:-1], singular(w[-1]))) for w in everyday.by_words()}
    told = {(*w[:-1], singular(w[-1])): name for w, name in told.items()} | told
    every_name = told | more
    more |= {
        (word,): every_name[(same,)] if (same,) not in more else same
        for word in everyday_names.words()
        for same in sorted(everyday_names.same_name(word))
        if (word,) not in every_name and (same,) in every_name
    }
    taken = room_words().keys() | style_words().keys()  # here a closet is a room, not a wardrobe
    return MappingProxyType({w: name for w, name in (more | told | _ALIASES).items() if w not in taken})


@cache
def room_words() -> Table:
    """Names of rooms as tuples of words, and what they name."""
    return MappingProxyType({_words(a): r.name for r in rooms().values() for a in (*r.also, r.name)})


@cache
def style_words() -> Table:
    """Style words as tuples of words, and the styles that they name."""
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
    """The number of words of the longest name of a thing, room or style at position `i`; 0 if there is none."""
    found = (lookup(table, words, i) for table in (thing_words(), room_words(), style_words()))
    return max((f[1] for f in found if f), default=0)


@cache
def thing(name: str) -> Kind | None:
    """The kind that a name means, in singular or plural: of the table of kinds or of the everyday things, else that of
    the longest ending that one of them has ("stone lantern"); None if there is none."""
    words = _words(" ".join(name.lower().split()))
    if not words:
        return None
    found = lookup(thing_words(), words, 0)
    if found and found[1] == len(words):
        return things().get(found[0]) or everyday.find(found[0])
    if found := _ending(words):
        kind = things().get(found[0]) or everyday.find(found[0])
        return replace(kind, name=" ".join(words), like=kind.role) if kind else None
    return None


def _ending(words: Sequence[str]) -> tuple[str, int] | None:
    """The longest name of a thing that some words end with, before "of"."""
    head = list(words[: words.index("of")] if "of" in words[1:] else words)
    if found := next((f for i in range(len(head)) if (f := _whole(head[i:]))), None):
        return found
    return next((f for i in range(1, len(words)) if (f := _whole(words[i:]))), None)


def _whole(words: Sequence[str]) -> tuple[str, int] | None:
    found = lookup(thing_words(), words, 0)
    return found if found and found[1] == len(words) else None


def room(name: str) -> RoomKind:
    """The kind of room that a name means; "room" if the name is unknown."""
    words = _words(" ".join(name.lower().split()))
    found = lookup(room_words(), words, 0) if words else None
    return rooms()[found[0] if found and found[1] == len(words) else "room"]


def summary(kind: RoomKind) -> str:
    """A kind of room in a few lines for a language model: sizes in metres, and things with their usual sizes."""
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

"""A room of a true table with the phrases that mean its things, and the parts of questions about them."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from ...gaussians.world import kinds
from ...gaussians.world.words import is_plural, plural
from . import sentences, sentences_held
from .question import Question
from .truth import FLAT, Table, Thing

Made = Iterator[Question]


@dataclass
class Room:
    """A table with the names of its things and a source of chance.

    Attributes:
        table: the truth.
        vocabulary: names of kinds from which absent ones are drawn.
        rng: the only source of chance.
        held: whether the wordings are those that were held back.
    """

    table: Table
    vocabulary: Sequence[str]
    rng: np.random.Generator
    held: bool = False
    names: dict[int, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for thing in self.table.things:
            if name := self._name(thing):
                self.names[thing.id] = name

    def _name(self, thing: Thing) -> str:
        """A phrase that means this thing and no other: its label, or its colour and label; "" if neither does.

        Labels without a singular ("books") are left out, as the wordings are for one thing.
        """
        if is_many(thing.label):
            return ""
        rivals = [t for t in self.table.things if t.id != thing.id and t.label in covered(thing.label)]
        if not rivals:
            return thing.label
        alike = all(t.label == thing.label for t in rivals)
        if thing.color and alike and not any(thing.color in t.shades for t in rivals):
            return f"{thing.color} {thing.label}"
        return ""

    @property
    def named(self) -> list[Thing]:
        """The things that a phrase means, in random order."""
        things = [t for t in self.table.things if t.id in self.names]
        return [things[i] for i in self.rng.permutation(len(things))]

    @property
    def standing(self) -> list[Thing]:
        """Of these the ones that stand on the floor and are no rugs."""
        return [t for t in self.named if self.table.on_floor(t) and t.size[2] > FLAT]

    def pairs(self, things: Sequence[Thing] | None = None) -> Iterator[tuple[Thing, Thing]]:
        """Pairs of different things in random order, both ways round at random."""
        things = self.named if things is None else things
        pairs = list(itertools.permutations(things, 2))
        for i in self.rng.permutation(len(pairs)):
            yield pairs[int(i)]

    def triples(self, things: Sequence[Thing]) -> Iterator[tuple[Thing, Thing, Thing]]:
        """Some triples of different things."""
        if len(things) < 3:
            return
        for _ in range(300):
            a, b, c = (things[int(i)] for i in self.rng.choice(len(things), 3, replace=False))
            yield a, b, c

    def wordings(self, seen: Sequence[str]) -> Sequence[str]:
        """The wordings in use for a kind of question: those of `sentences`, or their counterparts in the held ones."""
        return _held().get(tuple(seen), seen) if self.held else seen

    def word(self, wordings: Sequence[str], **values: object) -> str:
        """One of the wordings, filled: things as "the sofa", `A` at the start of a sentence, `a_one` as "a sofa"."""
        wordings = self.wordings(wordings)
        text = wordings[int(self.rng.integers(len(wordings)))]
        filled: dict[str, object] = {}
        for key, value in values.items():
            if isinstance(value, Thing):
                name = self.names[value.id]
                filled |= {key: f"the {name}", f"{key}_bare": name, f"{key}_one": one(name), key.upper(): f"The {name}"}
            else:
                filled[key] = value
        return text.format(**filled)


@cache
def _held() -> Mapping[tuple[str, ...], tuple[str, ...]]:
    """Held wordings by the wordings that they stand beside."""
    names = [n for n in vars(sentences_held) if n.isupper()]
    return {getattr(sentences, n): getattr(sentences_held, n) for n in names}


@cache
def covered(label: str) -> frozenset[str]:
    """The kinds that a label may be used for: its own, kinds that go by its name, members of its family, and kinds
    whose name ends with it."""
    table = kinds.table()
    own = table.kinds.get(label)
    found = {label, *table.families.get(label, ())}
    for kind in table.kinds.values():
        ends = kind.name.split()[-1] == label
        if ends or label in kind.alike or kind.like == label or label in kind.names:
            found.add(kind.name)
    if own is not None:
        found |= {*own.alike, *([own.like] if own.like else [])}
    return frozenset(found)


def one(name: str) -> str:
    """A noun with "a" or "an"; of plurals "any"."""
    if is_many(name):
        return f"any {name}"
    return f"{'an' if name[0] in 'aeiou' else 'a'} {name}"


def is_many(name: str) -> bool:
    """Whether a label is a plural or a mass noun, so that it is not counted."""
    return plural(name) == name or is_plural(name)


def asked(room: Room, kind: str, type: str, text: str, *truth: object, **more: object) -> Question:
    return Question(room.table.name, kind, text, type, tuple(truth), **more)  # type: ignore[arg-type]


def named(*things: Thing) -> dict[str, object]:
    ids = tuple(t.id for t in things)
    return {"about": ids, "names": ids}


def yes_no(holds: bool) -> str:
    return "yes" if holds else "no"

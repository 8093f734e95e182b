"""Everyday things that the table of kinds lacks: nouns in classes with a usual size, a support and a shape.

`everyday.json` lists the classes; a boulder is a "large rock" and is as large and as round as one. Sizes are rounded
from common knowledge, metres.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

from . import kinds
from .kinds import Kind, Phrase, Range, words_of
from .words import singular

_FILE = Path(__file__).with_name("everyday.json")
_SPREAD = 0.1  # share by which things of a class differ from its size
_FIELDS = frozenset("support under on backed front round top stores holds clear seats colors".split())  # noqa: SIM905


@cache
def _classes() -> tuple[Mapping[str, Any], ...]:
    return tuple(json.loads(_FILE.read_bytes()))


@cache
def by_words() -> Mapping[Phrase, int]:
    """Every noun as a tuple of words, the last one singular and as written, and the row of its class. Words that mean a
    kind only as labels are here too: in a sentence a car is no toy car."""
    taken = {words_of(n) for k in kinds.table().kinds.values() for n in k.names if n not in k.labels}
    taken |= {(*w[:-1], singular(w[-1])) for w in taken}
    found: dict[Phrase, int] = {}
    for row, entry in enumerate(_classes()):
        for noun in entry["words"].split(", "):
            words = words_of(noun)
            for form in (words, (*words[:-1], singular(words[-1]))):
                if form not in taken:
                    found.setdefault(form, row)
    return MappingProxyType(found)


def find(name: str) -> Kind | None:
    """The thing that a whole name means, in singular or plural, as a kind of that name; None if the table lacks it."""
    words = words_of(name)
    row = _row(words) if words else None
    return None if row is None else _kind(" ".join(words), row)


def of(label: str) -> Kind | None:
    """The thing that a label means by its longest ending that the table holds: "old oak tree" to a tree."""
    words = words_of(label)
    rows = (_row(words[start:]) for start in range(len(words)))
    row = next((r for r in rows if r is not None), None)
    return None if row is None else _kind(" ".join(words), row)


def shape(label: str) -> str:
    """The shape of the class of a label: the name of a builder of assets or of a plain solid; "" if there is none.

    Kinds that no builder draws have one too.
    """
    words = words_of(label)
    meant = kinds.of(label)
    if meant is not None and meant.name in _drawn():
        return _drawn()[meant.name]
    rows = (_row(words[start:]) for start in range(len(words)))
    row = next((r for r in rows if r is not None), None)
    return "" if row is None else str(_classes()[row]["shape"])


@cache
def _drawn() -> Mapping[str, str]:
    """Shapes of kinds without a builder, by name."""
    return {name: entry["shape"] for entry in _classes() for name in entry.get("drawn", "").split(", ") if name}


def stands_otherwise(label: str) -> bool:
    """Whether a label names a kind that is drawn as its class says, whatever its builder: an open parasol stands."""
    meant = kinds.of(label)
    return meant is not None and meant.name in _drawn()


def free_beneath(label: str, height: float) -> float:
    """Metres of height that are free beneath a thing of this label and height: between a table's legs, under a tree."""
    kind = kinds.of(label) or of(label)
    return kind.under * height if kind is not None else 0.0


def _row(words: Phrase) -> int | None:
    table = by_words()
    found = table.get(words)
    return table.get((*words[:-1], singular(words[-1]))) if found is None and words else found


@cache
def _kind(name: str, row: int) -> Kind:
    entry = _classes()[row]
    given: dict[str, Any] = {key: tuple(v) if isinstance(v, list) else v for key, v in entry.items() if key in _FIELDS}
    low, high = 1.0 - _SPREAD, 1.0 + _SPREAD
    width, depth, height = ((side * low, side * high) for side in entry["size"])
    size: tuple[Range, Range, Range] = (width, depth, height)
    return Kind(name=name, size=size, asset="", **given)

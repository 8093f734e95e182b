"""Names of parts that say of which thing: "wardrobe door" is a door of a wardrobe; a "kitchen door" is a door.

`compounds.json` lists which things have which parts. A word before a part that names no such thing is a place, a
material or a sort ("garage door", "oak door", "sliding door") and says nothing about a whole. A name that has its own
entry among the kinds ("wall shelf", "window seat") is a kind.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache, lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from . import kinds
from .words import AFTER_HEAD, normalise, singular

_FILE = Path(__file__).with_name("compounds.json")
_OF = AFTER_HEAD | {"of"}


class Compound(NamedTuple):
    """The name of a part with the thing that it is of.

    Attributes:
        whole: the thing, as it is said before the part: "kitchen cabinet".
        part: the part, singular: "door".
        place: whether the whole may also be a place of the building: a "closet door" is often a door in a wall.
    """

    whole: str
    part: str
    place: bool


@lru_cache(maxsize=1 << 12)
def split(name: str) -> Compound | None:
    """A name as the part of a thing: "fridge door" to `("fridge", "door")`; None if it is no part of a thing.

    Args:
        name: lower case, without an article.
    """
    *before, last = kinds.words_of(name) or ("",)
    part = singular(last)
    if not before or _OF.intersection(before) or not is_part(part):
        return None
    if any(kinds.find(" ".join((*before[start:], part))) for start in range(len(before))):
        return None
    endings = (" ".join(normalise(" ".join(before[start:]))) for start in range(len(before)))
    whole = next((ending for ending in endings if ending in _wholes(part)), None)
    return None if whole is None else Compound(" ".join(before), part, whole in _table()["places"])


def is_part(name: str) -> bool:
    """Whether a word names a part that things have: "door", "drawer", "wheel"."""
    return name in _table()["parts"]


def same_thing(a: str, b: str) -> bool:
    """Whether two names may be of one thing: words for one kind, or a word for a family and one for a member."""
    if normalise(a) == normalise(b):
        return True
    first, second = kinds.of(a), kinds.of(b)
    if first is None or second is None:
        return False
    return first is second or first.name in _members(b) or second.name in _members(a)


def _members(name: str) -> tuple[str, ...]:
    return kinds.table().families.get(" ".join(normalise(name)), ())


@cache
def _table() -> Mapping[str, Any]:
    data: Mapping[str, Any] = json.loads(_FILE.read_text(encoding="utf-8"))
    return data


@cache
def _wholes(part: str) -> frozenset[str]:
    """Every name, as normal words, of the things that have a part.

    Loose words for a kind are no names of it here: a "glass door" is no door of a wine glass.
    """
    groups = _table()["things"]
    listed = [name for entry in _table()["parts"][part] for name in groups.get(entry, (entry,))]
    members = {*listed, *(member for name in listed for member in kinds.table().families.get(name, ()))}
    found = set(members)
    for kind in (kinds.table().kinds[name] for name in members if name in kinds.table().kinds):
        found.update((*kind.also, *kind.narrower))
    return frozenset(" ".join(normalise(name)) for name in found)

"""Words of questions that cover things of several kinds by their use: seats, lights, storage, furniture, appliances."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache

from ....gaussians.world import kinds
from ....gaussians.world.kinds import Kind
from ....gaussians.world.words import normalise
from ...grammar.vocabulary.nouns import is_furniture

SEAT, LIGHT, STORAGE, FURNITURE = "place to sit", "light source", "storage place", "piece of furniture"
_BY_TABLE = (
    "appliance", "electronics", "device", "crockery", "tableware", "container", "decoration", "instrument",
    "musical instrument", "toy", "vehicle", "animal", "clothing", "greenery",
)  # fmt: skip
_STANDING = ("appliance", "electronics", "instrument")  # things with a use of their own, which nobody calls furniture
_SMALL_FAMILY = 12  # members up to which those of a family are alike
_LIGHT_WORDS = frozenset({"lamp", "light", "chandelier", "lantern", "spotlight", "sconce"})

# What the grammar reads in a noun phrase, and the word of this module for it.
SAID: Mapping[str, str] = {
    "seat": SEAT, "seating": SEAT, "light": LIGHT, "lighting": LIGHT, "storage": STORAGE, "storage unit": STORAGE,
    "storage furniture": STORAGE, "furniture": FURNITURE, "furnishing": FURNITURE, "light fixture": LIGHT,
    "light fitting": LIGHT, "furniture piece": FURNITURE, "furniture item": FURNITURE,
    "household appliance": "appliance",
    "kitchen appliance": "appliance", "electrical appliance": "appliance", "electronic device": "electronics",
    "electronic": "electronics", "gadget": "electronics", "seating option": SEAT, "seating place": SEAT,
    "sitting place": SEAT, "home appliance": "appliance", "ornament": "decoration", "soft toy": "toy",
}  # fmt: skip


@cache
def named() -> frozenset[str]:
    """Every word that `holds` knows."""
    return frozenset({SEAT, LIGHT, STORAGE, FURNITURE, *_BY_TABLE})


@cache
def holds(family: str, label: str) -> bool:
    """Whether a thing with this label belongs to a family."""
    if family in _USES:
        kind = kinds.of(label)
        return (family == LIGHT and _is_light(label)) or (kind is not None and _USES[family](kind))
    return normalise(label) == normalise(family) or _is_in(family, kinds.of(label))


def _is_in(family: str, kind: Kind | None) -> bool:
    return kind is not None and kind.name in kinds.table().families[family]


def _is_light(label: str) -> bool:
    words = normalise(label)
    return bool(words) and words[-1] in _LIGHT_WORDS and "traffic" not in words


def _is_storage(kind: Kind) -> bool:
    return kind.stores or (kind.holds and kind.support == "floor" and not kind.fixed and kind.size[2][0] > 0.4)


def _is_furniture(kind: Kind) -> bool:
    if _is_in("furniture", kind):
        return True
    loose = kind.support == "floor" and not (kind.fixed or kind.opening or kind.is_rug)
    own_use = any(_is_in(family, kind) for family in _STANDING) and "piano" not in kind.name
    return loose and not own_use and is_furniture(kind.name)


_USES: Mapping[str, Callable[[Kind], bool]] = {
    SEAT: lambda kind: kind.seats > 0,
    LIGHT: lambda kind: _is_in("light", kind),
    STORAGE: _is_storage,
    FURNITURE: _is_furniture,
}


@cache
def related(text: str, label: str) -> bool:
    """Whether a label names something that a person who asked in vain for `text` may think of: a kind with the same
    role, of the same family, or with the same head noun."""
    asked, own = normalise(text), normalise(label)
    if not asked or not own:
        return False
    if asked[-1] == own[-1]:
        return True
    one, other = kinds.of(text), kinds.of(label)
    if one is None or other is None:
        return text in named() and holds(text, label)
    if one.role == other.role or (one.seats and other.seats):
        return True
    groups = (members for members in kinds.table().families.values() if len(members) <= _SMALL_FAMILY)
    return any(one.name in members and other.name in members for members in groups)

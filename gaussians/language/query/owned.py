"""Which groups are parts of a thing: by what they are called, by the table of groups, or by where they lie.

"The wardrobe door" is a door that belongs to a wardrobe. The door of the room is none, however near it stands.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...world import compounds, kinds
from ...world.box import Box, Boxes, lattice, penetration
from ..field.language_field import Group, LanguageField
from .readings import OWN_NAME, label_matches
from .selection import Selection
from .terms import MIN_LABEL_SCORE, OWNED, Scored

F64 = NDArray[np.float64]

REACH = 0.06  # of the longest side of a thing: how far its parts may stand out of it, and what touches it may be apart
WITHIN = 0.6  # share of a part's box in that of the thing
_LATTICE = lattice(4, 5)  # places in a box at which the share is counted


@dataclass(frozen=True, eq=False)
class Whole:
    """The things of which a part is asked for.

    Attributes:
        name: what they are called in the query: "wardrobe".
        part: what the part is called: "door".
        groups: the things; empty if there are none.
        found: how they were found.
    """

    name: str
    part: str
    groups: tuple[Group, ...]
    found: Selection

    @property
    def ids(self) -> frozenset[int]:
        return frozenset(g.id for g in self.groups)


def named_parts(field: LanguageField, whole: Whole) -> tuple[Group, ...]:
    """Parts in the table of the things that have the name of the part themselves."""
    parts = (g for g in field.groups if g.level == "part" and g.count > 0 and label_matches(g.label, whole.part))
    return tuple(g for g in parts if _descends(field, g, whole.ids))


def restricted(rank: Scored, whole: Whole, field: LanguageField) -> Scored:
    """Candidates for the name of a part, with the further term whether they belong to the thing that is named.

    A candidate that is called a part of such a thing has that name, whatever else it looks like.
    """
    belong = np.array([float(belongs(field, g, whole)) for g in rank.groups])
    terms = {**rank.terms, OWNED: belong}
    if "text" in terms:
        called = np.array([_is_called(g, whole) for g in rank.groups], dtype=bool)
        terms["text"] = np.where(called, np.maximum(terms["text"], rank.limits["text"]), terms["text"])
    return replace(rank, terms=terms, limits={**rank.limits, OWNED: 0.5})


def belongs(field: LanguageField, group: Group, whole: Whole) -> bool:
    """Whether a group, which may have the name of the part, is a part of one of the things."""
    if group.id in whole.ids:
        return False
    if (said := _said_of(group, whole.part)) is not None:
        return compounds.same_thing(said, whole.name)
    if not whole.groups or _is_another(group, whole.part):
        return False
    if _descends(field, group, whole.ids):
        return True
    if any(_share(group.box, thing.box) >= WITHIN for thing in whole.groups):
        return True
    near = [thing for thing in whole.groups if _touches(group.box, thing.box)]
    return bool(near) and not _held_elsewhere(field, group, whole)


def _is_called(group: Group, whole: Whole) -> bool:
    """Whether the label of a group names the part of the thing, as "refrigerator door" does for "fridge door"."""
    said = _said_of(group, whole.part)
    return said is not None and compounds.same_thing(said, whole.name)


def _said_of(group: Group, part: str) -> str | None:
    """The thing whose part the label of a group names: "wardrobe" of a "wardrobe door"; None if it names none."""
    said = compounds.split(group.label) if group.label_score >= MIN_LABEL_SCORE else None
    return said.whole if said is not None and said.part == part else None


def _is_another(group: Group, part: str) -> bool:
    """Whether a group surely is a thing of another name: a dresser may be called "drawer", and is none of a desk."""
    return group.label_score >= OWN_NAME and not label_matches(_plain(group.label), part)


def _plain(label: str) -> str:
    """A label, or the name of its kind where that ends in the label's sense: "doorway" is a door."""
    kind = kinds.find(label)
    return kind.name if kind is not None and compounds.is_part(kind.name) else label


def _descends(field: LanguageField, group: Group, ids: frozenset[int]) -> bool:
    """Whether a group is below one of these in the table."""
    at = group.parent
    while at >= 0:
        if at in ids:
            return True
        at = field.groups[at].parent
    return False


def _share(part: Box, thing: Box) -> float:
    """Share of a box that lies in that of a thing, which reaches out by `REACH`."""
    points = Boxes.of([part]).spread(_LATTICE)[0]
    half = np.array(thing.size) / 2 + REACH * max(thing.size)
    return float((np.abs(thing.local(points)) <= half).all(axis=1).mean())


def _touches(part: Box, thing: Box) -> bool:
    """Whether a box touches a thing as its open door or its lid does: it is no larger, and beside or above it."""
    slack = REACH * max(thing.size)
    up = np.array(thing.axes[2])
    larger = np.sort(part.size) > np.sort(thing.size) + slack
    low = part.bottom(up) < thing.bottom(up) - slack
    over = bool(thing.covers(np.array([part.center]))[0])
    high = part.top(up) > thing.top(up) + slack and not over
    return not (larger.any() or low or high) and penetration(part, thing) >= -slack


def _held_elsewhere(field: LanguageField, group: Group, whole: Whole) -> bool:
    """Whether a group that touches a thing lies in a wall, or in another object: it is a part of that."""
    others = (g for g in field.groups if g.count > 0 and g.id != group.id and g.id not in whole.ids)
    for other in others:
        if other.level == "object" and _share(group.box, other.box) >= WITHIN:
            return True
        wall = other.level == "structure" and other.label == "wall"
        if wall and penetration(group.box, other.box) >= -REACH * max(group.box.size):
            return True
    return False

"""A plant and the pot that it stands in: one thing in words, often two objects of a scene.

"The potted plant" and "the plant with its pot" mean both; "the plant" means what grows, where the pot is an object of
its own. A pot is told by its name, of which little is asked, and by its place: below or around the plant, no larger.
Where nothing names what stands there, it is the pot only to who asks for the pot, and is not confirmed.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ...world import kinds
from ...world.words import normalise
from ..field.language_field import Group, LanguageField
from .selection import Candidate

F64 = NDArray[np.float64]

BOTH = frozenset({"potted plant", "pot plant", "potted flowers"})  # phrases that mean a plant with its pot
MIN_NAMED = 0.15  # probability of the names of vessels from which what stands below a plant is its pot
LARGEST = 1.25  # of the plant's extent: width and height of a pot
SUNK = 0.6  # of the plant's height: how far up a pot may reach, whose plant hides in it
_MOST_PIECES = 6
TOUCHING = 0.15  # of the smaller height: gap between a pot and its plant


@cache
def plants() -> frozenset[str]:
    """Kinds that stand in pots and vases."""
    return frozenset({*kinds.table().families["plant"], "flowers"})


@cache
def vessels() -> frozenset[str]:
    """Kinds that plants stand in: flower pots, and what is round and holds something."""
    return frozenset({"flower pot", *(k.name for k in kinds.table().kinds.values() if k.round and k.holds)})


@cache
def names_plant(text: str) -> bool:
    """Whether a phrase names a plant."""
    return _is(text, plants())


@cache
def names_vessel(text: str) -> bool:
    """Whether a phrase names something that a plant may stand in."""
    return _is(text, vessels())


def means_both(text: str) -> bool:
    """Whether a phrase means a plant together with its pot."""
    return " ".join(normalise(text)) in BOTH


def vessel_of(field: LanguageField, plant: int, up: F64) -> int | None:
    """The object that a plant stands in, by id; None if it has none of its own.

    Args:
        plant: id of a group, whatever its name.
        up: unit vector `[3]`.
    """
    grown = field.groups[plant]
    sure = {g.id: _vessel_probability(g) for g in field.objects() if g.count and g.id != plant}
    near = [i for i, p in sure.items() if p >= MIN_NAMED and _stands_in(grown, field.groups[i], up)]
    return max(near, key=lambda i: (sure[i], -i)) if near else None


def named(things: Sequence[Candidate]) -> str:
    """Things by their labels: "the vase", "the vase and the flower pot"."""
    return " and ".join(f"the {label}" for label in dict.fromkeys(t.label for t in things))


def without(text: str, pots: Sequence[Candidate]) -> str:
    """A sentence that plants were taken without the pots they stand in, and how to say both."""
    both = f"the {text} with its pot" if len(pots) == 1 else "the potted plants"
    return f'without {named(pots)}, which is a thing of its own; say "{both}" for both'


def beneath(field: LanguageField, plant: int, up: F64) -> int | None:
    """The object that a plant stands in by its place alone, where nothing tells what that is; None if there is none.

    Args:
        plant: id of a group, whatever its name.
        up: unit vector `[3]`.
    """
    grown = field.groups[plant]
    unnamed = [g for g in field.objects() if g.count and g.id != plant and g.label_score < MIN_NAMED]
    near = [g for g in unnamed if _stands_in(grown, g, up)]
    return max(near, key=lambda g: (g.count, -g.id)).id if near else None


def rooted(field: LanguageField, plant: int, up: F64) -> tuple[int, ...]:
    """The pieces that hold a plant, by their place alone: trunk, soil and pot, each below one that was found before and
    touching it, over one another, and none wider than the plant. Only objects that nothing names count.

    Args:
        plant: id of a group, whatever its name.
        up: unit vector `[3]`.
    """
    crown = field.groups[plant]
    found = [crown]
    open_ = [g for g in field.objects() if g.count and g.id != plant and g.label_score < MIN_NAMED]
    while len(found) <= _MOST_PIECES:
        below = [g for g in open_ if any(_carries(g, upper, crown, up) for upper in found)]
        if not below:
            break
        found.append(max(below, key=lambda g: (g.count, -g.id)))
        open_.remove(found[-1])
    return tuple(g.id for g in found[1:])


def _carries(lower: Group, upper: Group, crown: Group, up: F64) -> bool:
    """Whether one piece of a plant stands in another: it reaches lower, touches it or overlaps it in height, and
    lies within its outline or around it, no wider than the crown."""
    gap = upper.box.bottom(up) - lower.box.top(up)
    slack = TOUCHING * min(upper.box.size[2], lower.box.size[2])
    if gap > slack or lower.box.bottom(up) >= upper.box.bottom(up) or lower.box.top(up) >= crown.box.top(up):
        return False
    middles = np.array([upper.box.center, lower.box.center])
    over = bool(lower.box.covers(middles[:1])[0]) or bool(upper.box.covers(middles[1:])[0])
    return over and max(lower.box.size[:2]) <= max(crown.box.size[:2]) and lower.box.size[2] <= crown.box.size[2]


def _is(text: str, of: frozenset[str]) -> bool:
    kind = kinds.of(text)
    plain = " ".join(normalise(text))
    members = (plain, *kinds.table().families.get(plain, ()))
    return (kind is not None and kind.name in of) or bool(of.intersection(members))


def _vessel_probability(group: Group) -> float:
    """Probability by its names that a group is a vessel."""
    return sum(p for name, p in group.names if (kind := kinds.of(name)) is not None and kind.name in vessels())


def _stands_in(plant: Group, pot: Group, up: F64) -> bool:
    """Whether a plant stands in or on a pot: one above the other, touching, the pot no larger than the plant."""
    low, high, bottom, top = plant.box.bottom(up), plant.box.top(up), pot.box.bottom(up), pot.box.top(up)
    tall, deep = high - low, top - bottom
    slack = TOUCHING * min(tall, deep)
    if not (bottom < low + slack and low - slack <= top <= low + SUNK * tall):
        return False
    wide = max(pot.box.size[:2]) <= LARGEST * max(plant.box.size[:2])
    middles = np.array([plant.box.center, pot.box.center])
    over = bool(pot.box.covers(middles[:1])[0]) or bool(plant.box.covers(middles[1:])[0])
    return wide and deep <= LARGEST * tall and over

"""Definite descriptions of things: by label, colour, what they stand on, what they are next to, or their side."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ...gaussians.world.relation_geometry import Stand
from ...gaussians.world.support import NO_THINGS
from .things import Thing, gap

_BY = 1.0  # metres: largest gap to what a thing is said to be by
_CLEAR = 0.3  # metres by which the next of its kind must be farther from it, or less far to the side
_STACK = 0.6  # of a thing's width: things of one label so near to one another in plan are one above the other
_MOST_ALIKE = 12  # things of one label and colour beyond which only their number tells them apart


def named(thing: Thing, things: Sequence[Thing], stand: Stand) -> str:
    """A description that holds of this thing only: "the sofa", "the red chair", "the chair by the window"."""
    if thing.node is None:
        return f"the {thing.name}"
    if not thing.label:
        return f"the {thing.color} thing ({thing.id})" if thing.color else f"the unnamed thing ({thing.id})"
    label = f"the {thing.label}"
    alike = [t for t in things if t.label == thing.label]
    if len(alike) <= 1:
        return label
    colored = [t for t in alike if t.color == thing.color]
    if thing.color and len(colored) < len(alike):
        label, alike = f"the {thing.color} {thing.label}", colored
    if len(alike) == 1:
        return label
    others = [t for t in alike if t.id != thing.id]
    if (level := _level(thing, others)) is not None:
        return f"the {level} {label.removeprefix('the ')}"
    if len(alike) > _MOST_ALIKE:
        return f"{label} ({thing.id})"
    return next(_by_place(thing, others, label, things, stand), f"{label} ({thing.id})")


def _by_place(
    thing: Thing, others: Sequence[Thing], label: str, things: Sequence[Thing], stand: Stand
) -> Iterator[str]:
    """Ways of telling a thing from others of its label and colour by where it is, the plainest first."""
    support = _support(thing)
    if support is not None and all(_support(o) != support for o in others):
        yield f"{label} on {_once(support, things)}"
    for side, axis in (("left", -stand.right), ("right", stand.right)):
        if _leads(thing, others, axis):
            yield f"{label} on the {side}"
    marks = [t for t in things if t.label and t.label != thing.label and _is_mark(t, things)]
    for mark in sorted(marks, key=lambda m: gap(thing, m)):
        own = gap(thing, mark)
        if own > _BY:
            break
        if all(gap(o, mark) > own + _CLEAR for o in others):
            yield f"{label} by the {mark.label}"
    for side, axis in (("at the front", -stand.forward), ("at the back", stand.forward)):
        if _leads(thing, others, axis):
            yield f"{label} {side}"


def _level(thing: Thing, others: Sequence[Thing]) -> str | None:
    """Where a thing is in a stack of things of its label, such as drawers; None if they are no stack, or too many."""
    middle = np.array(thing.group.box.center)
    aside = [np.linalg.norm((np.array(o.group.box.center) - middle)[:2]) for o in others]
    if len(others) > 2 or max(aside) > _STACK * max(thing.group.box.size[:2]):
        return None
    below = sum(o.group.box.center[2] < middle[2] for o in others)
    return ("bottom", "top")[below] if len(others) == 1 else ("bottom", "middle", "top")[below]


def _support(thing: Thing) -> str | int | None:
    on = thing.node.support if thing.node else None
    return None if on in NO_THINGS else on


def _once(id: int | str, things: Sequence[Thing]) -> str:
    """What a thing stands on in words, without saying where that is in turn."""
    below = next(t for t in things if t.id == id)
    alike = [t for t in things if t.label == below.label]
    if len(alike) == 1 or not below.label:
        return f"the {below.name}"
    plain = below.color and sum(t.color == below.color for t in alike) == 1
    return f"the {below.color} {below.label}" if plain else f"the {below.label} ({below.id})"


def _is_mark(thing: Thing, things: Sequence[Thing]) -> bool:
    return sum(t.label == thing.label for t in things) == 1 and max(thing.group.box.size) > _CLEAR


def _leads(thing: Thing, others: Sequence[Thing], axis: np.ndarray) -> bool:
    """Whether a thing is farther along a direction than all the others, clearly."""
    own = float(np.array(thing.group.box.center) @ axis)
    return all(own > float(np.array(o.group.box.center) @ axis) + _CLEAR for o in others)

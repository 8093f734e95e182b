"""Statements of a problem as sentences for a person."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ...gaussians.world import relations
from ..rooms.node import NodeId
from .problem import Item, Keepout, Wish


def describe_item(item: Item) -> str:
    """A thing by its label and id: "the bed (3)"."""
    return f"the {item.label or 'thing'} ({item.id})"


def describe_room(size: Sequence[float]) -> str:
    """The size of the room in words."""
    return "the room is {:g} m wide, {:g} m deep and {:g} m high".format(*size)


def describe_wish(wish: Wish, item: Callable[[NodeId], Item]) -> str:
    """A wish in words: "the bed (3) is against a wall"."""
    kind = relations.named(wish.name)
    words = kind.at_wall.format(wish.wall) if wish.wall else kind.says(*(describe_item(item(o)) for o in wish.objects))
    apart = f", {wish.distance:g} m away" if wish.distance is not None else ""
    if wish.name == "far_from" and wish.distance is not None:
        words, apart = f"is {wish.distance:g} m from {describe_item(item(wish.objects[0]))}", ""
    return f"{describe_item(item(wish.subject))} {words}{apart}"


def describe_keepout(keepout: Keepout) -> str:
    """A disc that is kept free, in words."""
    return f"{keepout.radius:g} m around a point are kept free: {keepout.name}"

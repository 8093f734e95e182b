"""Statements of a problem as sentences for a person."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ...gaussians.world import relations
from ..rooms.node import NodeId
from .problem import Item, Keepout, Wish


def said_item(item: Item) -> str:
    """A thing by its label and id."""
    return f"the {item.label or 'thing'} ({item.id})"


def said_room(size: Sequence[float]) -> str:
    """The size of the room."""
    return "the room is {:g} m wide, {:g} m deep and {:g} m high".format(*size)


def said_wish(wish: Wish, item: Callable[[NodeId], Item]) -> str:
    """A wish: "the bed (3) is against a wall"."""
    kind = relations.named(wish.name)
    words = kind.at_wall.format(wish.wall) if wish.wall else kind.says(*(said_item(item(o)) for o in wish.objects))
    return f"{said_item(item(wish.subject))} {words}"


def said_keepout(keepout: Keepout) -> str:
    """A disc that is kept free."""
    return f"{keepout.radius:g} m around a point are kept free: {keepout.name}"

"""Statements of a problem as sentences for a person. Knows words; refuses to judge."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ..rooms.node import NodeId
from .problem import Item, Keepout, Wish

_WORDS = {
    "left_of": "is left of {}", "right_of": "is right of {}", "in_front_of": "is in front of {}",
    "behind": "is behind {}", "next_to": "is next to {}", "on": "is on {}", "under": "is under {}",
    "above": "is above {}", "below": "is below {}", "inside": "is inside {}", "between": "is between {} and {}",
    "facing": "faces {}", "around": "stands around {}", "against_wall": "is against a wall",
    "in_corner": "is in a corner", "in_center": "is in the middle of the room", "at_window": "is at a window",
    "far_from": "is far from {}", "aligned_with": "is in line with {}",
}  # fmt: skip

_AT_WALL = {
    "against_wall": "is against the {} wall",
    "in_corner": "is in a corner at the {} wall",
    "at_window": "is at a window in the {} wall",
}


def said_item(item: Item) -> str:
    """A thing by its label and id."""
    return f"the {item.label or 'thing'} ({item.id})"


def said_room(size: Sequence[float]) -> str:
    """The size of the room."""
    return "the room is {:g} m wide, {:g} m deep and {:g} m high".format(*size)


def said_wish(wish: Wish, item: Callable[[NodeId], Item]) -> str:
    """A wish: "the bed (3) is against a wall"."""
    others = (said_item(item(o)) for o in wish.objects)
    words = _WORDS[wish.name].format(*others)
    if wish.wall:
        words = _AT_WALL[wish.name].format(wish.wall)
    return f"{said_item(item(wish.subject))} {words}"


def said_keepout(keepout: Keepout) -> str:
    """A disc that is kept free."""
    return f"{keepout.radius:g} m around a point are kept free: {keepout.name}"

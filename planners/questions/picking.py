"""Picks one of several things by a superlative of a query: the largest, the leftmost, the second from the left."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from ...gaussians.language.query.query import Query
from ...gaussians.world.relation_geometry import Stand
from .things import Thing


def picked(query: Query, things: Sequence[Thing], stand: Stand) -> Thing | None:
    """The thing that the `pick` of a query means, None if it picks none of them."""

    def at(thing: Thing) -> np.ndarray:
        return np.array(thing.group.box.center)

    keys: dict[str, Callable[[Thing], float]] = {
        "largest": lambda t: -math.prod(t.group.box.size),
        "smallest": lambda t: math.prod(t.group.box.size),
        "tallest": lambda t: -t.group.box.size[2],
        "shortest": lambda t: t.group.box.size[2],
        "highest": lambda t: -float(at(t)[2]),
        "lowest": lambda t: float(at(t)[2]),
        "leftmost": lambda t: float(at(t) @ stand.right),
        "rightmost": lambda t: -float(at(t) @ stand.right),
        "nearest": lambda t: float(np.linalg.norm(at(t) - stand.eye)),
        "farthest": lambda t: -float(np.linalg.norm(at(t) - stand.eye)),
        "front left": lambda t: float(at(t) @ (stand.right + stand.forward)),
        "front right": lambda t: float(at(t) @ (stand.forward - stand.right)),
        "back left": lambda t: float(at(t) @ (stand.right - stand.forward)),
        "back right": lambda t: -float(at(t) @ (stand.right + stand.forward)),
    }
    order = "leftmost" if query.pick in ("nth", "middle") else query.pick
    if order not in keys:
        return None
    row = sorted(things, key=keys[order])
    if query.pick == "middle":
        return row[len(row) // 2] if len(row) % 2 else None
    rank = query.ordinal or 1
    return row[rank - 1 if rank > 0 else rank] if abs(rank) <= len(row) else None

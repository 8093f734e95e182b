"""Procedural furniture and props as Gaussians, and rooms furnished with them.

`make` gives one object, `furnish` a room with its ground truth beside it. The catalogue is one file a family of kinds.
"""

from __future__ import annotations

from . import (  # noqa: F401
    appliances,
    bathing,
    carried,
    decor,
    electronics,
    halls,
    kitchen,
    leisure,
    lighting,
    offices,
    openings,
    overhead,
    pastimes,
    plants,
    seating,
    shops,
    stands,
    storage,
    tables,
    training,
    wares,
)  # fmt: skip
from .forge import Asset, Parts, kinds, make
from .registry import KINDS, Kind, find
from .rooms import Room, Truth, TruthObject, furnish, room_kinds

__all__ = [
    "KINDS", "Asset", "Kind", "Parts", "Room", "Truth", "TruthObject", "find", "furnish", "kinds", "make", "room_kinds",
]  # fmt: skip

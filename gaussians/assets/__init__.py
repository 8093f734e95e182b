"""Procedural furniture and props as Gaussians, and rooms furnished with them.

`make` gives one object, `furnish` a room with its ground truth beside it. The catalogue is one file a family of kinds.
"""

from __future__ import annotations

from . import families as families  # registers every kind
from .furnishing.furnish import Room, Truth, TruthObject, furnish, room_kinds
from .modeling.make import Asset, Parts, kinds, make
from .registry import KINDS, Kind, find

__all__ = [
    "KINDS", "Asset", "Kind", "Parts", "Room", "Truth", "TruthObject", "find", "furnish", "kinds", "make", "room_kinds",
]  # fmt: skip

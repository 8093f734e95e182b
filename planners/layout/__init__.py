"""The layout solver: things with sizes and wishes to a scene graph. `solve` is its one door."""

from __future__ import annotations

from .problem import Conflict, Item, Keepout, Layout, Problem, Stand, Wish
from .solver import solve

__all__ = ["Conflict", "Item", "Keepout", "Layout", "Problem", "Stand", "Wish", "solve"]

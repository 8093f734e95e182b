"""The layout solver: it turns things with sizes and wishes into a scene graph. Callers use `solve`."""

from __future__ import annotations

from .problem import Conflict, Item, Keepout, Layout, Problem, Stand, Wish
from .solver import solve

__all__ = ["Conflict", "Item", "Keepout", "Layout", "Problem", "Stand", "Wish", "solve"]

"""Keep the last few results that were computed from objects which are never changed, such as columns of a cloud."""

from __future__ import annotations

import weakref
from collections import OrderedDict
from collections.abc import Callable
from typing import Any, Generic, TypeVar

Value = TypeVar("Value")


class Kept(Generic[Value]):
    """The results for the last `most` sets of objects. Objects are told apart by identity and are not kept alive.

    A result must not hold the objects that it was computed from, or they are never freed.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._known: OrderedDict[tuple[int, ...], tuple[tuple[weakref.ref[Any], ...], Value]] = OrderedDict()

    def get(self, objects: tuple[Any, ...], make: Callable[[], Value]) -> Value:
        """The result for some objects; `make` computes it if it is not known."""
        key = tuple(map(id, objects))
        known = self._known.get(key)
        if known is not None and all(r() is o for r, o in zip(known[0], objects, strict=True)):
            self._known.move_to_end(key)
            return known[1]
        made = make()
        self._known[key] = tuple(map(weakref.ref, objects)), made
        while len(self._known) > self._most:
            self._known.popitem(last=False)
        return made

"""Remembers by which specification an encoder or a source of masks was loaded, so that a field can say what made it."""

from __future__ import annotations

import weakref

_loaded: dict[int, tuple[weakref.ref[object], str]] = {}


def remember(thing: object, spec: str) -> None:
    """Note the specification of a thing for as long as the thing exists. Things are told apart by identity."""
    key = id(thing)
    _loaded[key] = (weakref.ref(thing, lambda _: _loaded.pop(key, None)), spec)


def spec_of(thing: object) -> str:
    """The specification that a thing was loaded by; for one that was made otherwise the name of its class."""
    known = _loaded.get(id(thing))
    return known[1] if known is not None and known[0]() is thing else type(thing).__name__

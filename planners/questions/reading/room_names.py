"""Reads names of kinds of rooms: "a bedroom", "an office", as the table of rooms has them."""

from __future__ import annotations

from ...compose.knowledge import room_words
from .phrase_templates import Words


def room_name(words: Words) -> str | None:
    """The kind of room that the words name; None if they name none."""
    said = tuple(w for w in words if w not in ("a", "an", "the", "some", "kind", "of", "sort"))
    return room_words().get(said)

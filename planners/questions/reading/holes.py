"""Readers of the holes of templates: noun phrases, numbers, lengths, colours and free words, by type."""

from __future__ import annotations

from collections.abc import Mapping

from ....gaussians.color import parse as parse_color
from ....gaussians.errors import UserError
from ....gaussians.world.lengths import in_metres
from ...grammar.vocabulary import quantities
from . import noun_phrase
from .phrase_templates import HoleReader, Words


def number(words: Words) -> float | None:
    """A number in digits or words."""
    found = quantities.read(words)
    return found.value if found and found.kind == "NUMBER" and found.taken == len(words) else None


def length(words: Words) -> float | None:
    """A length with its unit, in metres."""
    found = quantities.read(words)
    return (
        in_metres(found.value, found.unit) if found and found.kind == "LENGTH" and found.taken == len(words) else None
    )


def color(words: Words) -> str | None:
    """A colour word, as written."""
    said = " ".join(words)
    try:
        parse_color(said)
    except UserError:
        return None
    return said


def free(words: Words) -> str | None:
    """Any words."""
    return " ".join(words) or None


READERS: Mapping[str, HoleReader] = {
    "thing": noun_phrase.thing,
    "number": number,
    "length": length,
    "color": color,
    "words": free,
}

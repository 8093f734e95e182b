"""Splits a clause about light into phrases of the vocabulary, amounts and colour temperatures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ..tagging.lookahead import color_at
from ..vocabulary import quantities
from .vocabulary import longest, meanings

Token = tuple[tuple[str, ...], dict[str, Any]]


def tokens_of(words: Sequence[str]) -> list[Token] | None:
    """The clause as phrases with their slots; None if a word has no meaning here."""
    found: list[Token] = []
    at = 0
    while at < len(words):
        amount = quantities.read(words[at:])
        if (kelvin := _kelvin(words[at:])) is not None:
            found.append((tuple(words[at : at + kelvin[1]]), {"kelvin": kelvin[0]}))
            at += kelvin[1]
            continue
        if amount is not None and amount.kind in ("PERCENT", "FRACTION", "TIMES", "NUMBER"):
            phrase = tuple(words[at : at + amount.taken])
            # "half", "double"; "a bit" is a degree, and "a" an article
            if phrase not in meanings() and not (amount.kind == "NUMBER" and phrase[0] in ("a", "an", "one")):
                found.append((phrase, {"amount": amount}))
                at += amount.taken
                continue
        for size in range(min(longest(), len(words) - at), 0, -1):
            phrase = tuple(words[at : at + size])
            if (known := meanings().get(phrase)) is not None:
                slots = {m.slot: m.value for m in reversed(known)}
                if "thing" in slots:
                    return None
                found.append((phrase, slots))
                at += size
                break
        else:
            hue = color_at(words, at)
            if hue is None:
                return None
            found.append((tuple(words[at : at + hue[1]]), {"hue": hue[0]}))
            at += hue[1]
    return found


def _kelvin(words: Sequence[str]) -> tuple[float, int] | None:
    """A temperature and how many words it takes: "2700 kelvin", "3,000 k"."""
    if len(words) < 2 or words[1] not in ("k", "kelvin", "kelvins", "degrees"):
        return None
    if words[1] == "degrees" and words[2:3] != ["kelvin"]:
        return None
    try:
        value = float(words[0].replace(",", ""))
    except ValueError:
        return None
    return (value, 3 if words[1] == "degrees" else 2) if 500 <= value <= 40_000 else None

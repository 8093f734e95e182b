"""Sizes of rooms and things in a description: "4 by 5 metres", "12 ft x 15 ft", "20 square metres", "2 m wide".

All results are in metres. `read.py` finds the room or thing that a size belongs to.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

from ....gaussians.world.lengths import SQUARE_METRES, in_metres
from ...grammar.tagging.words import bag
from ...grammar.vocabulary import quantities

Side = Literal["width", "long", "depth", "height", "area", "any"]
_TIMES = bag("x by × *")
_SIDES: dict[str, Side] = {
    "wide": "width", "width": "width", "across": "width", "long": "long", "length": "long", "deep": "depth",
    "depth": "depth", "high": "height", "tall": "height", "height": "height",
}  # fmt: skip


@dataclass(frozen=True)
class Extents:
    """Stated lengths (metres) and area (square metres) by side; `taken`: how many words were read."""

    sides: dict[Side, float] = field(default_factory=dict)
    taken: int = 0


def read(words: Sequence[str]) -> Extents | None:
    """The lengths that `words` begin with; None if they begin with none, or with a number without a unit."""
    return _area(words) or _product(words) or _single(words)


def _area(words: Sequence[str]) -> Extents | None:
    number = _amount(words[:1])
    if not number:
        return None
    for taken in (2, 1):
        if factor := SQUARE_METRES.get(" ".join(words[1 : 1 + taken])):
            return Extents({"area": number[0] * factor}, 1 + taken)
    return None


def _amount(words: Sequence[str]) -> tuple[float, str, int] | None:
    """A number with or without a unit: its value, the unit or "", and how many words it has."""
    end = next((i for i, w in enumerate(words) if w in _TIMES), len(words))
    found = quantities.read(words[: min(end, 8)])
    if not found or found.kind not in ("NUMBER", "LENGTH") or found.value <= 0:
        return None
    return found.value, found.unit, found.taken


def _product(words: Sequence[str]) -> Extents | None:
    """Two or three lengths with "x" or "by" between them; a unit that is stated once holds for all."""
    found: list[tuple[float, str]] = []
    i = 0
    while len(found) < 3 and (amount := _amount(words[i:])):
        value, unit, taken = amount
        found.append((value, unit))
        i += taken
        if tuple(words[i : i + 1]) in (("wide",), ("long",), ("deep",)):
            i += 1
        if i >= len(words) or words[i] not in _TIMES or not _amount(words[i + 1 :]):
            break
        i += 1
    if len(found) < 2:
        return None
    said = next((u for _, u in reversed(found) if u), "m")
    lengths = [in_metres(value, unit or said) for value, unit in found]
    names: tuple[Side, ...] = ("width", "depth", "height")
    return Extents(dict(zip(names, lengths, strict=False)), i)


def _single(words: Sequence[str]) -> Extents | None:
    """A length, optionally with its side, and further ones after "and": "3.5 m wide and 4 m long"."""
    amount = _amount(words)
    if not amount or not amount[1]:
        return None
    value, unit, i = amount
    side: Side = _SIDES.get(words[i], "any") if i < len(words) else "any"
    i += side != "any"
    sides: dict[Side, float] = {side: in_metres(value, unit)}
    joined = i + (tuple(words[i : i + 1]) in (("and",), (",",)))
    if side != "any" and joined > i and (more := _single(words[joined:])) and not set(more.sides) & {side, "any"}:
        return Extents(sides | more.sides, joined + more.taken)
    return Extents(sides, i)

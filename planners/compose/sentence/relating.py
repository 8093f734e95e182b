"""Phrases for two opposite sides, and what a preposition means between two things of a description."""

from __future__ import annotations

from collections.abc import Sequence

from ....gaussians.world.relations import WishName
from .drafts import Draft

PREPOSITIONS = ("on", "at", "down", "along", "to", "by")
_LEFT_AND_RIGHT = [
    tuple(f"{p} the {a} and one {p} the {b} of".split())
    for p in ("on", "to", "at") for a, b in (("left", "right"), ("right", "left"))
]  # fmt: skip


def sides_at(texts: Sequence[str], i: int) -> int:
    """The number of words of a phrase for two opposite sides at position `i`, with "of" where it follows; else 0."""
    for phrase in _LEFT_AND_RIGHT:
        if tuple(texts[i : i + len(phrase)]) == phrase:
            return len(phrase)
    if texts[i] in ("flanking", "framing"):
        return 1
    j = i + (texts[i] in PREPOSITIONS)
    if texts[j : j + 1] and texts[j] in ("either", "each", "both", "every", "opposite"):
        j += 1
    else:
        return 0
    j += texts[j : j + 1] == ["long"]
    if texts[j : j + 1] and texts[j] in ("side", "sides", "end", "ends"):
        return j + 1 + (texts[j + 1 : j + 2] == ["of"]) - i
    return 0


def layout_name(name: str, subject: Draft, other: Draft, sides: bool = False) -> WishName:
    """The layout name of a relation between these two things."""
    small, large = subject.kind, other.kind
    seated = small and small.seats == 1 and large and large.top and not large.seats and small.support == "floor"
    if seated and (name in ("at", "behind") or sides):
        return "around"
    if name == "at":
        return "next_to"
    if name == "around" and small and not small.seats and not subject.several and small.support == "floor":
        return "next_to"
    if sides and small and small.support == "surface" and large and large.top:
        return "on"
    if name == "against":
        return "next_to"
    if name == "inside" and small and small.support == "surface" and large and large.top:
        return "on"
    return name

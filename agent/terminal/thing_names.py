"""Describes the things of a scene: by name where the name is likely right, else only as a number."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...gaussians.language.field.language_field import Group

NAME_THRESHOLD = 0.5  # calibrated probability from which a name is more often right than wrong


def name_of_thing(group: Group) -> str:
    """The thing's label if it is likely right, else "unnamed thing"."""
    return group.label if group.label and group.label_score >= NAME_THRESHOLD else "unnamed thing"


def describe_things(groups: Iterable[Group]) -> str:
    """How many things there are and their names, e.g. "3 things: box ×2, lamp; 4 more without a sure name"."""
    names = [name_of_thing(g) for g in groups]
    counts = Counter(names)
    nameless = counts.pop("unnamed thing", 0)
    if not names:
        return "no things"
    listed = ", ".join(f"{name} ×{n}" if n > 1 else name for name, n in sorted(counts.items()))
    if not counts:
        return f"{_things(nameless)}, none with a sure name"
    more = f"; {nameless} more without a sure name" if nameless else ""
    return f"{_things(counts.total())}: {listed}{more}"


def _things(number: int) -> str:
    return f"{number} thing" + ("s" if number != 1 else "")

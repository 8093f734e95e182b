"""How many examples a property is tried with: a share of them in the default run, all in the slow one."""

from __future__ import annotations

from hypothesis import settings

ALL, SHARE = 100, 0.3  # hypothesis' own number, and the share of the default run


def some(count: int) -> int:
    """Of `count` examples in the slow run, how many there are in this one."""
    return count if settings().max_examples == ALL else max(4, round(SHARE * count))

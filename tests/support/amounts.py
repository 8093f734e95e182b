"""How much is tried: a share of seeds, cases and examples in the default run, all in the slow one."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest
from hypothesis import settings

ALL, SHARE = 100, 0.2  # hypothesis' own number of examples, and the share of the default run


def some(count: int) -> int:
    """Of `count` examples in the slow run, how many there are in this one."""
    return count if settings().max_examples == ALL else max(4, round(SHARE * count))


def spread(values: Iterable[Any], every: int) -> list[Any]:
    """Values of one parameter: the first of each few, and the others marked as slow."""
    return [pytest.param(v, marks=pytest.mark.slow if k % every else ()) for k, v in enumerate(values)]

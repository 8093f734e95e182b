"""The part of Python's `re` that readers of words use, whose `compile` waits until the pattern is first used.

They hold some 600 patterns, of which a sentence needs 200. A module that holds many says `import late_re as re`.
"""

from __future__ import annotations

import re
from re import IGNORECASE, I, Match, Pattern, escape, findall, finditer, fullmatch, match, search, split, sub
from typing import Any, cast

__all__ = [
    "IGNORECASE",
    "I",
    "Match",
    "Pattern",
    "compile",
    "escape",
    "findall",
    "finditer",
    "fullmatch",
    "match",
    "search",
    "split",
    "sub",
]  # fmt: skip


def compile(pattern: str, flags: int = 0) -> Pattern[str]:
    """The pattern, compiled when one of its methods or attributes is first asked for; `re.error` comes as late.

    It is not an instance of `re.Pattern`: call its methods, and do not give it to functions of `re`.
    """
    return cast("Pattern[str]", LatePattern(pattern, flags))


class LatePattern:
    """Stands for a compiled pattern, whose attributes become its own as they are asked for."""

    def __init__(self, pattern: str, flags: int) -> None:
        self._given = pattern, flags
        self._compiled: Pattern[str] | None = None

    def __reduce__(self) -> tuple[type[LatePattern], tuple[str, int]]:
        return LatePattern, self._given

    def __getattr__(self, name: str) -> Any:  # asked only for what is not there yet
        if self._compiled is None:
            self._compiled = re.compile(*self._given)
        value = getattr(self._compiled, name)
        setattr(self, name, value)
        return value

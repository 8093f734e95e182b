"""Puts turns of phrase about time and motion into words that the readers know.

A rule covers a way of saying something, not a sentence: what it drops is said already by what it keeps. Rules are used
in the order of the files and of their lines; a new one goes into the file of what it is about.
"""

from __future__ import annotations

from .....gaussians import late_re as re
from . import asking, names, pace, places, times

_COMPILED = tuple(
    (re.compile(pattern), plain)
    for rules in (asking.RULES, pace.RULES, places.RULES, times.RULES, names.RULES)
    for pattern, plain in rules
)


def restated(said: str) -> str:
    """An instruction in words that the readers know.

    >>> restated("half speed on the fan")
    'play the fan at half speed'
    """
    for pattern, plain in _COMPILED:
        said = pattern.sub(plain, said)
    return said.strip(" ,.;")

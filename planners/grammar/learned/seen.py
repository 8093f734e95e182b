"""How the models see words: as classes of what is alike."""

from __future__ import annotations

from functools import cache

from ....gaussians import color
from ....gaussians.world.shades import DYES
from ..timing.verbs import SENSES, has_form
from ..vocabulary.nouns import is_known
from ..vocabulary.quantities import NUMBERS

STEM = 5  # letters of a word by which its forms are alike
_SECONDS = frozenset(("s", "sec", "secs", "second", "seconds"))


@cache
def hues() -> frozenset[str]:
    """Colours of one word."""
    return frozenset(name for name in color.names() if " " not in name) | DYES


def amount_or_color(word: str) -> str:
    """One word for all numbers, one for seconds, one for colours; else the word."""
    if word in _SECONDS:
        return "#s"
    if word in NUMBERS or word[:1].isdigit():
        return "#"
    return "#color" if word in hues() else word


@cache
def classed(word: str) -> str:
    """As `amount_or_color`, with one word for all things, and for each form of verbs of motion; else ""."""
    seen = amount_or_color(word)
    if seen != word:
        return seen
    if is_known(word):
        return "#thing"
    forms = (form for form in ("s", "past", "ing", "plain") if has_form(word, tuple(SENSES), form))
    return next((f"#v-{form}" for form in forms), "")

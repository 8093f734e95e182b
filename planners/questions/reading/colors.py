"""Reads colour words of questions; words for materials are none, as whether they hold is seen, not measured."""

from __future__ import annotations

from functools import cache, lru_cache

from ....gaussians.color import BASIC, names
from ....gaussians.color import parse as parse_color
from ....gaussians.errors import UserError
from ...grammar.tagging.words import bag

Words = tuple[str, ...]

# Colour words that say what a thing is made of; whether they hold is seen, not measured.
MATERIALS = bag(
    "wood wooden oak walnut mahogany chestnut pine teak cherry maple birch bamboo timber rattan wicker cane straw "
    "jute metal metallic steel stainless iron aluminium aluminum chrome brass bronze copper leather marble stone "
    "concrete porcelain ceramic denim reclaimed glass plastic fabric velvet linen cotton wool paper wine sand peach "
    "rose rust amber ruby sapphire emerald mint"
)
_MIXED = {"multicolored", "multicolor", "colorful"}


@cache
def _words() -> frozenset[str]:
    """Last words of all colour names."""
    return frozenset(name.split()[-1] for name in (*names(), *BASIC))


@lru_cache(maxsize=4096)
def color(words: Words) -> str | None:
    """A colour word, in American spelling; words for materials are none."""
    said = " ".join(words).removesuffix(" colored").removesuffix(" in color")
    last = said.split()[-1] if said.split() else ""
    if last in MATERIALS or last in _MIXED or len(words) > 4:
        return None
    if not ({last, last.replace("gray", "grey")} & _words() or last.endswith("ish")):
        return None
    try:
        parse_color(said)
    except UserError:
        return None
    return said

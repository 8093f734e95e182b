"""The kinds of things that can be made. Knows names, sizes and where things live; the builders register themselves.

Adding a kind is one decorated function in one family file:

    @kind("stool", sizes=((0.3, 0.5), (0.3, 0.5), (0.4, 0.8)), synonyms=("bar stool",), palette="wood")
    def stool(rng, tone): return [box(...).named("seat", tone.main), ...]
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..errors import UserError
from ..world.spelling import did_you_mean
from ..world.words import singular
from .modeling.materials import Tone
from .modeling.shapes import Piece

Builder = Callable[[np.random.Generator, Tone], list[Piece]]
Support = Literal["floor", "surface", "wall", "ceiling"]
Range = tuple[float, float]


@dataclass(frozen=True)
class Kind:
    """What is known of a kind before one is made.

    Attributes:
        name: as it is said, lower case, singular ("floor lamp").
        build: makes the pieces of one design.
        sizes: typical (lowest, highest) width x, depth y and height z, metres.
        support: what it normally stands on or hangs from.
        against_wall: whether it belongs with its back to a wall.
        synonyms: other words for it.
        palette: where its main colour is drawn from (see `materials.PALETTES`).
        shown: whether the embedded encoder was shown it when it was trained. Of the others it knows no picture and
            often no name; they are found by the name they are given, not by their looks.
    """

    name: str
    build: Builder
    sizes: tuple[Range, Range, Range]
    support: Support = "floor"
    against_wall: bool = False
    synonyms: tuple[str, ...] = ()
    palette: str = "any"
    shown: bool = True


KINDS: dict[str, Kind] = {}


def kind(
    name: str,
    sizes: tuple[Range, Range, Range],
    support: Support = "floor",
    synonyms: tuple[str, ...] = (),
    palette: str = "any",
    against_wall: bool = False,
    shown: bool = True,
) -> Callable[[Builder], Builder]:
    """Register a builder under `name`."""

    def keep(build: Builder) -> Builder:
        assert name not in KINDS, f"kind {name!r} is registered twice"
        KINDS[name] = Kind(name, build, sizes, support, against_wall, synonyms, palette, shown)
        return build

    return keep


def find(name: str) -> Kind:
    """The kind called `name`, by its name or a synonym, singular or plural; a kind's own name beats a synonym.

    Raises:
        UserError: for an unknown kind, naming the closest known ones.
    """
    said = " ".join(name.lower().replace("_", " ").replace("-", " ").split())
    words = {s: k for k in KINDS.values() for s in k.synonyms} | {k.name: k for k in KINDS.values()}
    if found := words.get(said) or {singular(w): k for w, k in words.items()}.get(singular(said)):
        return found
    hint = did_you_mean(said, words, likeness=0.55) or f"known kinds: {', '.join(sorted(KINDS))}"
    raise UserError(f"no asset is called {name!r}; {hint}")

"""The builders of things, by the name of the kind that each draws.

What a kind is like stands in `world/kinds.json`. A look of its own is one function in a family file:

    @kind("stool", palette="wood")
    def stool(rng, tone): return [box(...).named("seat", tone.main), ...]
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..errors import UserError
from ..world import kinds
from ..world.spelling import did_you_mean
from .modeling.materials import Tone
from .modeling.shapes import Piece

Builder = Callable[[np.random.Generator, Tone], list[Piece]]


@dataclass(frozen=True)
class Kind:
    """How a kind is drawn.

    Attributes:
        name: of the kind in the table.
        build: makes the pieces of one design.
        palette: where its main colour is drawn from (see `materials.PALETTES`).
    """

    name: str
    build: Builder
    palette: str = "any"

    @property
    def known(self) -> kinds.Kind:
        """Its entry in the table."""
        return kinds.table().kinds[self.name]


KINDS: dict[str, Kind] = {}


def kind(name: str, palette: str = "any") -> Callable[[Builder], Builder]:
    """Register a builder under `name`."""

    def keep(build: Builder) -> Builder:
        assert name not in KINDS, f"kind {name!r} is registered twice"
        KINDS[name] = Kind(name, build, palette)
        return build

    return keep


def find(name: str) -> Kind:
    """What draws the kind called `name`, by its name or a synonym, singular or plural.

    Raises:
        UserError: for an unknown kind, or one that nothing draws, naming the closest ones that can be drawn.
    """
    said = " ".join(kinds.words_of(name))
    if (meant := kinds.find(said)) is not None and meant.asset:
        return KINDS[meant.asset]
    drawn = [n for k in kinds.table().kinds.values() if k.asset for n in k.names]
    hint = did_you_mean(said, drawn, likeness=0.55) or f"known kinds: {', '.join(sorted(KINDS))}"
    raise UserError(f"no asset is called {name!r}; {hint}")

"""Make the asset for a node of a scene graph: choose its kind, design and colour, and fit it to the node's size.

Of several designs it takes the one that has to be stretched least and supports the things that the graph puts on it.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...gaussians.assets import registry
from ...gaussians.assets.modeling import make
from ...gaussians.assets.modeling.make import Asset
from ...gaussians.assets.modeling.materials import Material
from ...gaussians.assets.modeling.shapes import Piece, bounds, box
from ...gaussians.assets.modeling.solids import solid
from ...gaussians.camera import Vec3
from ...gaussians.color import BASIC, Rgb, parse, plain_color, shade_of
from ...gaussians.world import everyday, kinds
from .color_words import NO_COLOR, color_of, hex_of
from .node import Node
from .own_assets import OwnAssets
from .rest_heights import Load, level_error

Array = NDArray[np.float64]
MAX_DESIGNS = 10  # designs looked at; their proportions spread enough that the nearest is within a third of most sizes
GOOD_STRETCH = 0.15  # a stretch of one side against another by e^0.15, 16 %, is not seen
REPORTED_STRETCH = 0.8  # one by e^0.8, more than twice, is told
_SLIGHT = 0.2  # of the longest side: shorter ones are thicknesses
_TURNED = 0.5  # a quarter turn has to save this much: it also turns the front
_DRAFT = 0.3  # detail at which a design is asked whether it carries something
_THIN = 0.005  # metres: the least side that can be made
_MOST = 50.0  # metres: the longest


@dataclass(frozen=True, eq=False)
class Made:
    """An asset with notes for the user. `block`: no kind has this name, so the asset is a plain block."""

    asset: Asset
    notes: tuple[str, ...] = ()
    block: bool = False


@dataclass(eq=False)
class AssetMaker:
    """Makes the assets of one scene; nodes with the same label, colour and size get the same design.

    Attributes:
        seed: what varies between two scenes of one graph.
        detail: factor on the number of Gaussians.
        own: a user's own assets, or None.
    """

    seed: int
    detail: float
    own: OwnAssets | None = None
    _done: dict[tuple[object, ...], Made] = field(default_factory=dict)

    def make(self, node: Node, loads: Sequence[Load] = ()) -> Made:
        """The thing for a node.

        Args:
            loads: what the graph puts on it.
        """
        w, d, h = (min(max(side, _THIN), _MOST) for side in node.size)
        size = (w, d, h)
        key = (node.label.lower(), node.color.lower(), tuple(round(s, 3) for s in size))
        if key not in self._done:
            self._done[key] = self._made(node, size, loads)
        return self._done[key]

    def _made(self, node: Node, size: Vec3, loads: Sequence[Load]) -> Made:
        said = f"{node.label or 'thing'} ({node.id})"
        rgb, notes = _shade(node, said)
        if self.own is not None:
            taken = self.own.take(node.label, size, rgb, exact=kind_of(node.label) is not None)
            notes += taken.notes
            if taken.asset is not None:
                return Made(taken.asset, notes)
        kind = None if everyday.stands_otherwise(node.label) else kind_of(node.label)
        if kind is None:
            kind = registry.KINDS.get(everyday.shape(node.label))
            if kind is None:
                return self._plain(node, size, rgb, notes)
            notes = (*notes, f"no asset is called {node.label!r}: {said} is drawn as a {kind.name}")
        elif _is_stand_in(node.label):
            notes = (*notes, f"no asset is called {node.label!r}: {said} is drawn as a {kind.name}")
        best = self._nearest(kind, size, rgb, loads, f"{node.label}{node.color}")
        if best.stretch > REPORTED_STRETCH:
            times = math.exp(best.stretch)
            notes = (*notes, f"{said} is stretched: one side {times:.1f} times as much as another of our {kind.name!r}")
        return Made(best.finished(size, kind.name, self.detail), notes)

    def _plain(self, node: Node, size: Vec3, rgb: Rgb | None, notes: tuple[str, ...]) -> Made:
        """A thing of no kind, as the solid of its class of nouns, else as a block."""
        said, shape = f"{node.label or 'thing'} ({node.id})", everyday.shape(node.label)
        pieces = solid(shape, size, rgb)
        if pieces is None:
            why = f"no asset is called {node.label!r}: {said} is drawn as a plain block"
            return Made(_block(size, shade_of("gray") if rgb is None else rgb, self.detail), (*notes, why), True)
        made = make.to_asset(make.fit_to_size(pieces, size), "block", rgb or shade_of("gray"), 0, self.detail)
        return Made(made, (*notes, f"no asset is called {node.label!r}: {said} is drawn as a plain {shape}"))

    def _nearest(self, kind: registry.Kind, size: Vec3, rgb: Rgb | None, loads: Sequence[Load], salt: str) -> _Design:
        """The design that has to be stretched least; with loads, one that supports them is preferred."""
        start = (zlib.crc32(salt.lower().encode()) + 7919 * self.seed) & 0xFFFFFF
        tried: list[_Design] = []
        for k in range(MAX_DESIGNS):
            tried.append(_Design.drawn(kind, start + k, size, rgb))
            if tried[-1].stretch < GOOD_STRETCH and not loads:
                return tried[-1]
        tried.sort(key=lambda design: design.stretch)
        if not loads:
            return tried[0]
        judged = []
        for design in tried[: MAX_DESIGNS // 2 + 1]:
            draft = design.finished(size, kind.name, _DRAFT)
            off = max(level_error(draft, load) for load in loads)
            if off < 0.02 and design.stretch < 2 * GOOD_STRETCH:
                return design
            judged.append((design.stretch + 4 * off, design))
        return min(judged, key=lambda pair: pair[0])[1]


@dataclass(frozen=True, eq=False)
class _Design:
    """One design: its pieces as drawn (perhaps turned by a quarter), and how far they have to be stretched.

    `stretch` is the logarithm of the largest gain of a side over the smallest.
    """

    pieces: Sequence[Piece]
    rgb: Rgb
    seed: int
    stretch: float

    @classmethod
    def drawn(cls, kind: registry.Kind, seed: int, size: Vec3, rgb: Rgb | None) -> _Design:
        pieces, tone = make.design(kind, seed, rgb)
        low, high = bounds(pieces)
        span = np.maximum(high - low, 1e-6)
        straight, turned = _stretch(span, size), _stretch(span[[1, 0, 2]], size)
        if turned + _TURNED < straight:
            return cls([p.turned("z", 90) for p in pieces], tone.color, seed, turned)
        return cls(pieces, tone.color, seed, straight)

    def finished(self, size: Vec3, kind: str, detail: float) -> Asset:
        return make.to_asset(make.fit_to_size(self.pieces, size), kind, self.rgb, self.seed, detail)


def _stretch(span: Array, size: Vec3) -> float:
    """Logarithm of the largest gain over the smallest; how thin a thin side is (a rug's, a cord's) does not count."""
    wanted = np.array(size)
    thin = (wanted < _SLIGHT * wanted.max()) & (span < 2 * _SLIGHT * span.max())
    gain = np.log(wanted / span)[~thin]
    return float(gain.max() - gain.min())


def kind_of(label: str) -> registry.Kind | None:
    """What draws the kind that a label names: itself, a synonym of it, or without the words before its head.

    "exposed wooden beams", "round café table" and "velvet couch" have one; a "sleeping bag" has none.
    """
    meant = kinds.of(label)
    return registry.KINDS[meant.asset] if meant is not None and meant.asset else None


def _is_stand_in(label: str) -> bool:
    """Whether a label's kind is drawn as one of another sort: a banquette as a sofa, but not a queen bed as a bed."""
    meant = kinds.of(label)
    if meant is None or meant.asset == meant.name:
        return False
    related = (meant.like, meant.one, *meant.alike)
    return meant.asset not in related and meant.asset.split()[-1] != meant.name.split()[-1]


def _shade(node: Node, said: str) -> tuple[Rgb | None, tuple[str, ...]]:
    """The colour of a node as it is painted; None leaves it to the design."""
    plain = plain_color(node.color)
    if not plain:
        return None, ()
    if plain in BASIC:
        return shade_of(plain), ()
    lab = color_of(plain)
    if lab == NO_COLOR:
        return None, (f"no colour is called {node.color!r}: {said} is drawn in one of its own",)
    return parse(hex_of(lab)), ()


def _block(size: Vec3, rgb: Rgb, detail: float) -> Asset:
    w, d, h = size
    piece = box(w, d, h, bevel=min(0.01, 0.2 * min(size))).named("block", Material(rgb, main=True))
    return make.to_asset([piece], "block", rgb, 0, detail)

"""From a node of a scene graph to a thing of that size: which kind, which design, which colour.

Knows names, proportions and what stands on a thing. Refuses to know where it stands. A design is chosen by its
proportions, so that little has to be stretched, and by whether it carries what the graph puts on it.
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
from ...gaussians.camera import Vec3
from ...gaussians.color import BASIC, Rgb, parse, plain_color, shade_of
from ...gaussians.errors import UserError
from ...gaussians.world import synonyms
from ...gaussians.world.words import normalise
from .asset_folder import Shelf
from .color_words import NO_COLOR, color_of, hex_of
from .node import Node
from .rest_heights import Load, level_error

Array = NDArray[np.float64]
TRIES = 10  # designs looked at; their proportions spread enough that the nearest is within a third of most sizes
ENOUGH = 0.15  # a stretch of one side against another by e^0.15, 16 %, is not seen
TOLD = 0.8  # one by e^0.8, more than twice, is told
_SLIGHT = 0.2  # of the longest side: shorter ones are thicknesses
_TURNED = 0.5  # a quarter turn has to save this much: it also turns the front
_DRAFT = 0.3  # detail at which a design is asked whether it carries something
_THIN = 0.005  # metres: the least side that can be made
_MOST = 50.0  # metres: the longest


@dataclass(frozen=True, eq=False)
class Made:
    """A thing, and what is to be told of it. `block`: nothing is called so, and a plain block stands for it."""

    asset: Asset
    notes: tuple[str, ...] = ()
    block: bool = False


@dataclass(eq=False)
class Workshop:
    """Makes the things of one scene: alike nodes get one design.

    Attributes:
        seed: what varies between two scenes of one graph.
        detail: factor on the number of Gaussians.
        shelf: a folder of other people's assets, or None.
    """

    seed: int
    detail: float
    shelf: Shelf | None = None
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
        if self.shelf is not None:
            taken = self.shelf.take(node.label, size, rgb, exact=kind_of(node.label) is not None)
            notes += taken.notes
            if taken.asset is not None:
                return Made(taken.asset, notes)
        kind = kind_of(node.label)
        if kind is None:
            color = shade_of("gray") if rgb is None else rgb
            why = f"no asset is called {node.label!r}: {said} is drawn as a plain block"
            return Made(_block(size, color, self.detail), (*notes, why), True)
        if " ".join(normalise(node.label)) in _LIKE:
            notes = (*notes, f"no asset is called {node.label!r}: {said} is drawn as a {kind.name}")
        best = self._nearest(kind, size, rgb, loads, f"{node.label}{node.color}")
        if best.stretch > TOLD:
            times = math.exp(best.stretch)
            notes = (*notes, f"{said} is stretched: one side {times:.1f} times as much as another of our {kind.name!r}")
        return Made(best.finished(size, kind.name, self.detail), notes)

    def _nearest(self, kind: registry.Kind, size: Vec3, rgb: Rgb | None, loads: Sequence[Load], salt: str) -> _Design:
        """The design that has to be stretched least, and among those that carry what stands on it, if any does."""
        start = (zlib.crc32(salt.lower().encode()) + 7919 * self.seed) & 0xFFFFFF
        tried: list[_Design] = []
        for k in range(TRIES):
            tried.append(_Design.drawn(kind, start + k, size, rgb))
            if tried[-1].stretch < ENOUGH and not loads:
                return tried[-1]
        tried.sort(key=lambda design: design.stretch)
        if not loads:
            return tried[0]
        judged = []
        for design in tried[: TRIES // 2 + 1]:
            draft = design.finished(size, kind.name, _DRAFT)
            off = max(level_error(draft, load) for load in loads)
            if off < 0.02 and design.stretch < 2 * ENOUGH:
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
        return make.finished(make.fitted(self.pieces, size), kind, self.rgb, self.seed, detail)


def _stretch(span: Array, size: Vec3) -> float:
    """Logarithm of the largest gain over the smallest; how thin a thin side is (a rug's, a cord's) does not count."""
    wanted = np.array(size)
    thin = (wanted < _SLIGHT * wanted.max()) & (span < 2 * _SLIGHT * span.max())
    gain = np.log(wanted / span)[~thin]
    return float(gain.max() - gain.min())


def kind_of(label: str) -> registry.Kind | None:
    """The kind that a label names: itself, a synonym of it, or without the words before its head.

    "exposed wooden beams", "round café table" and "velvet couch" have one; a "sleeping bag" has none, though "bag" is a
    loose word for backpacks: of the words that close a longer label, only those that hardly change their meaning count.
    """
    spoken, words = label.lower().split(), normalise(label)
    for start in range(len(spoken)):
        if (found := _known(" ".join(spoken[start:]), own=start > 0)) is not None:
            return found
        if start == 0 and (found := _by_synonym(words)) is not None:
            return found
    return next((k for i in range(1, len(words)) if (k := _known(" ".join(words[i:]), own=True)) is not None), None)


def _by_synonym(words: tuple[str, ...]) -> registry.Kind | None:
    """The kind that a phrase names in other words, or that looks enough like it."""
    others = sorted(synonyms.same(words)) if words else []
    others += [normalise(_LIKE[" ".join(words)])] if " ".join(words) in _LIKE else []
    return next((k for other in others if (k := _known(" ".join(other), own=False)) is not None), None)


def _known(phrase: str, own: bool) -> registry.Kind | None:
    """The kind that is called so; with `own`, only by its own name or a synonym of several words."""
    try:
        found = registry.find(phrase)
    except UserError:
        return None
    plain = " ".join(normalise(found.name))
    return found if not own or phrase == plain or " " in phrase or phrase in _PLAIN else None


# What has no kind of its own is drawn as what it resembles most.
_LIKE = {
    "banquette": "sofa",
    "booth": "sofa",
    "daybed": "sofa",
    "kitchen island": "counter",
    "island": "counter",
    "host stand": "lectern",
    "pedestal": "side table",
    "sculpture pedestal": "side table",
    "blanket": "cushion",
    "dog bed": "cushion",
    "projector screen": "whiteboard",
    "disco ball": "pendant lamp",
    "ceiling fan": "pendant lamp",
    "air hockey table": "pool table",
    "flower bucket": "flowers",
    "watering can": "kettle",
    "pen holder": "mug",
    "tip jar": "vase",
    "umbrella stand": "bin",
    "safe": "nightstand",
    "server rack": "wardrobe",
    "fitting room": "shower",
    "toy": "toy car",
    "elliptical": "treadmill",
    "game console": "radio",
    "projector": "radio",
    "food warmer": "microwave",
    "coffee grinder": "kettle",
    "napkin holder": "box",
    "popcorn machine": "arcade machine",
    "medicine cabinet": "cabinet",
}
# Synonyms of one word that may close a longer label: "velvet couch" is a couch, a "parking space bench" still a bench.
_PLAIN = frozenset({
    "couch", "settee", "loveseat", "plant", "fern", "palm", "bookcase", "cupboard", "sideboard", "credenza", "lamp",
    "bike", "refrigerator", "freezer", "oven", "carpet", "mat", "picture", "photo", "poster", "tv", "screen", "till",
    "closet", "armoire", "planter", "pouf", "chandelier", "heater", "basin", "tub", "bath", "drape", "balloon", "beam",
    "rafter", "garland", "bunting", "chalkboard", "blackboard", "drawer", "shelf", "chest", "crate", "hamper",
    "barstool",
})  # fmt: skip


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
    return make.finished([piece], "block", rgb, 0, detail)

"""Rows of staged rooms: swapped colours, things alike side by side, things that touch, low things on a noisy floor."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import fmean

import numpy as np

from ...gaussians import assets
from ...gaussians.assets import Asset
from ...gaussians.color import BASIC
from ...gaussians.world.box import YawBox
from .._iou import iou
from .._rows import Row
from .._select import cases, floor_noise, pairs, staged
from .._select.cases import Case
from .ground import Ground

GAPS = (0.2, 0.1, 0.05, 0.02, 0.0)  # metres between two things side by side
SIDE_BY_SIDE = ("box", "cabinet", "nightstand", "suitcase", "bin", "armchair", "stool", "potted plant")
PAIRS = 4  # of a room
NOISES = (0.5, 1.0, 2.0, 3.0, 5.0)  # centimetres
RIGHT = 0.5  # IoU from which a thing is a group of its own


def rows(ground: Ground) -> Iterator[Row]:
    """All of them; none in a quick run."""
    if ground.quick:
        return
    yield _swaps(ground)
    yield from _colors(ground)
    yield from _side_by_side(ground)
    yield from _floor(ground)


def _swaps(ground: Ground) -> Row:
    """A red chair and a green table: asked for, and for the green chair and the red table."""
    known = [(ground.embedded([case])[0], meant) for case, meant in pairs.swap_rooms(ground.seeds[0])]
    good = [(one.object is None, pairs.right(case, one, ground.encoder)) for case, meant in known for one in meant]
    there = fmean(right for absent, right in good if not absent)
    swapped = fmean(right for absent, right in good if absent)
    values = [("as they are", there), ("swapped", swapped)]
    return ground.row("staged.colours_swapped", 1.0, values, "share right", len(good))


def _colors(ground: Ground) -> Iterator[Row]:
    """Two of a kind that differ in colour alone, and in size alone."""
    known = [(ground.embedded([case])[0], meant) for case, meant in map(pairs.attribute_room, ground.seeds[:2])]
    good = [(bool(one.query.size), pairs.right(case, one, ground.encoder)) for case, meant in known for one in meant]
    for name, wanted in (("staged.told_by_colour", False), ("staged.told_by_size", True)):
        own = [right for size, right in good if size == wanted]
        yield ground.row(name, 1.0, [("two of a kind", fmean(own))], "share right", len(own))


# -- side by side ---------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Neighbours:
    """A room of pairs with a gap, and which objects are a pair of the same design."""

    case: Case
    alike: tuple[tuple[int, int], ...]
    unlike: tuple[tuple[int, int], ...]


def _side_by_side(ground: Ground) -> Iterator[Row]:
    found: dict[str, list[float]] = {"alike": [], "unlike": []}
    asked = 0
    for gap in GAPS:
        rooms = [neighbours(seed, gap) for seed in ground.seeds[:2]]
        own = list(zip(rooms, ground.embedded([r.case for r in rooms]), strict=True))
        for name in found:
            shares = [_apart(case, pair) for room, case in own for pair in getattr(room, name)]
            found[name].append(fmean(shares))
            asked = len(shares)
    for name, title in (("alike", "staged.near_duplicates"), ("unlike", "staged.touching")):
        first, *others = found[name]
        values = [(f"{gap * 100:g} cm", value) for gap, value in zip(GAPS[1:], others, strict=True)]
        yield ground.row(title, first, values, "share apart", asked)


def _apart(case: Case, pair: tuple[int, int]) -> float:
    """1 if each of a pair is a group of its own."""
    groups = case.groups()
    each = [max(iou(mask, case.ids == i) for mask in groups) for i in pair]
    return float(min(each) >= RIGHT)


def neighbours(seed: int, gap: float) -> _Neighbours:
    """Pairs of things side by side, the gap between their boxes; half of them of the same design and colour."""
    layout = staged.bare("neighbours", seed)
    rng = np.random.default_rng([zlib.crc32(b"neighbours"), seed])
    kinds = [str(k) for k in rng.permutation(SIDE_BY_SIDE)]
    alike, unlike = list[tuple[int, int]](), list[tuple[int, int]]()
    for i in range(PAIRS):
        first = _made(kinds[i], rng)
        second = first if i % 2 else _made(kinds[(i + PAIRS) % len(kinds)], rng)
        pair = (
            layout.put(first, _beside(i, first, -1, gap), "floor"),
            layout.put(second, _beside(i, second, 1, gap), "floor"),
        )
        (alike if i % 2 else unlike).append(pair)
    return _Neighbours(staged.built(layout, seed), tuple(alike), tuple(unlike))


def _made(kind: str, rng: np.random.Generator) -> Asset:
    return assets.make(kind, int(rng.integers(1 << 20)), color=str(rng.choice(sorted(BASIC))))


def _beside(quarter: int, thing: Asset, side: int, gap: float) -> YawBox:
    """The place of one of a pair, at one side of the middle of a quarter of the room."""
    x, y = ((-1.4, -1.2), (1.4, -1.2), (-1.4, 1.2), (1.4, 1.2))[quarter]
    w, d, h = thing.size
    return YawBox(x + side * (w + gap) / 2, y, 0.0, w, d, h, 0.0)


# -- the floor ------------------------------------------------------------------------------------------------------


def _floor(ground: Ground) -> Iterator[Row]:
    """The floor and low things on it, where heights of the floor's Gaussians are noisy."""
    rooms = [
        cases.case_of(assets.furnish(seed, detail=ground.detail, include=floor_noise.ADDED), seed)
        for seed in ground.seeds[:2]
    ]

    def measured(noise: float) -> tuple[float, float]:
        spoiled = ground.embedded([floor_noise.with_noise(room, noise / 100) for room in rooms])
        pairs_ = [floor_noise.agreement(case, room) for case, room in zip(spoiled, rooms, strict=True)]
        return fmean(f for f, _ in pairs_), fmean(v for _, low in pairs_ for v in low)

    (floor, low), along = measured(0.0), [measured(noise) for noise in NOISES]
    labels = [f"{noise:g} cm" for noise in NOISES]
    yield ground.row("staged.noisy_floor", floor, list(zip(labels, (f for f, _ in along), strict=True)), n=len(rooms))
    yield ground.row("staged.low_things_on_noisy_floor", low, list(zip(labels, (v for _, v in along), strict=True)))

"""Which superpoints near a plane of the structure belong to it, and which to objects that lie in the plane.

Paint, boards and shadows belong to the plane. The frame of a door in a wall and the underside of a box on the floor do
not: they differ slightly in colour and in what they touch. A small network, fitted on furnished rooms
(`training/coplanar.py`), decides from these features.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .learned_rule import load_rule
from .surface import Surface

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
Mask = NDArray[np.bool_]

FEATURES = (
    "within", "off", "roughness", "facing", "breadth", "width", "height", "points", "lightness", "chroma",
    "nearest lightness", "nearest chroma", "first guess", "touches paint", "touches things", "touches others",
    "lightness beside paint", "chroma beside paint", "lightness beside things", "chroma beside things",
    "reach across", "reach along", "pattern", "paint's pattern", "upright", "bottom", "top",
)  # fmt: skip
MIN_NEAR = 0.3  # share of a superpoint's points near the plane; below it the superpoint only touches the plane
SAME_CHROMA = 5.0  # Lab chroma difference up to which superpoints count as one colour
MIN_KEPT = 0.25  # of the first guess: a network that keeps less of a plane than this was not fitted on such a scene


@dataclass(frozen=True)
class PlaneSuperpoints:
    """The superpoints near one plane.

    Attributes:
        near: `[K]` points near the plane.
        own: `[M]` superpoint of every surface point.
        cell: `[K]` grid cell of the plane for each near point.
        off, along: `[K]` and `[K, 2]`, signed distance from the plane and coordinates in it.
        facing: `[M]` |cosine| between each point's normal and the plane's.
        guess: `[S]` first guess: the superpoints that most probably belong to the plane.
        band: largest distance of a point of the plane: a sole on the floor has the floor's colour only by its shadow.
        upright: whether the plane is a wall.
    """

    near: I64
    own: NDArray[np.int32]
    cell: I64
    off: F64
    along: F64
    facing: F64
    guess: Mask
    band: float
    upright: bool


def plane_superpoints(surface: Surface, near: PlaneSuperpoints) -> Mask:
    """Which superpoints belong to the plane `[S]`.

    The fitted network decides. Where it keeps less than MIN_KEPT of the first guess, as on the many shades of a real
    floor, the first guess is the result.
    """
    chosen, features = describe(surface, near)
    kept = np.zeros(len(near.guess), bool)
    if len(chosen):
        kept[chosen] = load_rule("coplanar", FEATURES).probability(features) > 0.5
    count = np.bincount(near.own[near.near], minlength=len(kept))
    return kept if count[kept].sum() >= MIN_KEPT * count[near.guess].sum() else near.guess


def describe(surface: Surface, p: PlaneSuperpoints) -> tuple[I64, F64]:
    """The superpoints that may belong to the plane `[C]` and their features `[C, len(FEATURES)]`."""
    count = len(p.guess)
    own, spacing = p.own[p.near], max(surface.spacing, 1e-12)
    total, inside = np.bincount(p.own, minlength=count), np.bincount(own, minlength=count)
    share = inside / np.maximum(total, 1)
    chosen = np.flatnonzero(share > MIN_NEAR)
    if not len(chosen) or not p.guess.any():
        return np.zeros(0, np.int64), np.zeros((0, len(FEATURES)))
    lab = surface.lab.astype(np.float64)
    mean = _mean(lab, p.own, count)
    pattern = np.sqrt(np.maximum(_mean(lab[:, 1:] ** 2, p.own, count) - mean[:, 1:] ** 2, 0).sum(1))
    paint = np.average(mean[p.guess], axis=0, weights=total[p.guess])
    ground = float(np.average(pattern[p.guess], weights=total[p.guess]))
    off = _mean(p.off[:, None], own, count)[:, 0]
    rough = np.sqrt(np.maximum(_mean(p.off[:, None] ** 2, own, count)[:, 0] - off**2, 0))
    breadth = np.bincount(np.unique(own.astype(np.int64) * 2**20 + p.cell) // 2**20, minlength=count)
    low, high = np.full((count, 2), np.inf), np.full((count, 2), -np.inf)
    np.minimum.at(low, own, p.along)
    np.maximum.at(high, own, p.along)
    start, end = np.quantile(p.along, [0.01, 0.99], axis=0)
    span = np.maximum(end - start, 1e-9)
    gap = mean[chosen] - paint
    rivals = np.flatnonzero(p.guess)
    each = mean[chosen][:, None] - mean[rivals][None]
    distance = np.linalg.norm(each, axis=2) + 1e6 * (chosen[:, None] == rivals[None])
    nearest = each[np.arange(len(chosen)), distance.argmin(1)]
    sides = _neighbour_features(surface, p, share > MIN_NEAR)[:, chosen]
    reach = _reach(mean, chosen, low, high, span)
    facing = _mean(p.facing[:, None], p.own, count)[chosen, 0]
    columns = [
        share[chosen],
        np.minimum(np.abs(off[chosen]) / spacing, 3),
        np.minimum(rough[chosen] / spacing, 3),
        facing,
        np.log(breadth[chosen] / max(breadth.sum(), 1) + 1e-4),
        (high - low)[chosen, 0] / span[0],
        (high - low)[chosen, 1] / span[1],
        np.log(total[chosen]),
        np.clip(gap[:, 0] / 10, -4, 4),
        np.minimum(np.linalg.norm(gap[:, 1:], axis=1) / 5, 5),
        np.clip(nearest[:, 0] / 10, -4, 4),
        np.minimum(np.linalg.norm(nearest[:, 1:], axis=1) / 5, 5),
        p.guess[chosen].astype(np.float64),
        *sides,
        *reach.T,
        np.minimum(pattern[chosen] / 5, 3),
        np.full(len(chosen), min(ground / 5, 3)),
        np.full(len(chosen), float(p.upright)),
        np.clip((low[chosen, 1] - start[1]) / span[1], -0.2, 1.2),
        np.clip((high[chosen, 1] - start[1]) / span[1], -0.2, 1.2),
    ]
    return chosen, np.stack(columns, axis=1)


def _mean(values: F64, own: NDArray[np.int32], count: int) -> F64:
    """Mean `[S, C]` of values `[K, C]` over the points of each superpoint."""
    size = np.maximum(np.bincount(own, minlength=count), 1)[:, None]
    return np.stack([np.bincount(own, weights=v, minlength=count) for v in values.T], axis=1) / size


def _neighbour_features(surface: Surface, p: PlaneSuperpoints, level: Mask) -> F64:
    """Features `[7, S]` of the neighbours outside each superpoint.

    The shares of them that are in the first guess, off the plane, and near the plane but not in the first guess; then
    the mean differences in lightness and chroma to the first kind and to the second.
    """
    count = len(p.guess)
    k = min(6, surface.neighbours.shape[1])
    first = np.repeat(np.arange(len(p.own)), k)
    second = surface.neighbours[:, :k].ravel()
    across = (p.own[first] != p.own[second]) & level[p.own[first]]
    a, b = first[across], second[across]
    own, other = p.own[a], p.own[b]
    kind = np.where(p.guess[other], 0, np.where(level[other], 2, 1))
    hits = [np.bincount(own[kind == c], minlength=count).astype(np.float64) for c in range(3)]
    whole = np.maximum(sum(hits), 1)
    difference = surface.raw_lab[a].astype(np.float64) - surface.raw_lab[b]
    steps = np.stack([np.abs(difference[:, 0]) / 10, np.linalg.norm(difference[:, 1:], axis=1) / 5])
    contrast = [
        np.where(hits[c] > 0, np.bincount(own[kind == c], weights=s[kind == c], minlength=count)
                 / np.maximum(hits[c], 1), 1.5)
        for c in (0, 1)
        for s in steps
    ]  # fmt: skip
    return np.stack([*(h / whole for h in hits), *(np.minimum(c, 4) for c in contrast)])


def _reach(mean: F64, chosen: I64, low: F64, high: F64, span: F64) -> F64:
    """Extent `[C, 2]`, as a share of the plane's, of all candidates that have each candidate's colour."""
    chroma = mean[chosen][:, 1:]
    alike = np.linalg.norm(chroma[:, None] - chroma[None], axis=2) < SAME_CHROMA
    first = np.where(alike[:, :, None], low[chosen][None], np.inf).min(axis=1)
    last = np.where(alike[:, :, None], high[chosen][None], -np.inf).max(axis=1)
    result: F64 = np.minimum((last - first) / span, 1.2)
    return result

"""Refinement of the borders between objects, point by point.

Superpoints are too coarse at contacts: the foot of a chair and the shadow on the floor around it end up in one
superpoint. A small network, fitted on furnished rooms (`training/borders.py`), gives the probability that a point
belongs to each object near it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .learned_rule import load_rule
from .surface import Surface

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

FEATURES = (
    "share", "distance", "least lightness", "mean lightness", "least chroma", "mean chroma", "facing", "off own plane",
    "off its plane", "owner", "structure", "nothing", "flat", "piece lightness", "piece chroma", "piece pattern",
    "own piece lightness", "own piece chroma",
)  # fmt: skip
PASSES = 3  # a border moves by at most one point a pass
MARGIN = 1.0  # log-odds (nats) by which another object must be more probable than the present one


def refine_borders(
    surface: Surface, labels: NDArray[np.int32], owner: NDArray[np.int32], structure: NDArray[np.bool_]
) -> NDArray[np.int32]:
    """Superpoint of each point `[M]` after points were reassigned to adjacent, more probable objects.

    Args:
        labels: `[M]` superpoint of each point.
        owner: `[S]` object of each superpoint; -1 for none, smaller numbers for structure.
        structure: `[S]` whether a superpoint is floor, wall or ceiling.
    """
    for _ in range(PASSES):
        points, things, nearest, features = describe(surface, labels, owner, structure)
        if not len(points):
            break
        likely = np.clip(load_rule("borders", FEATURES).probability(features), 1e-9, 1 - 1e-9)
        stays = things == owner[labels[points]]
        odds = np.log(likely / (1 - likely)) + MARGIN * stays
        order = np.lexsort((things, -odds, points))
        best = order[np.r_[True, np.diff(points[order]) > 0]]
        # a point that has no neighbour of its own object is part of something thin and is not reassigned
        moved = best[~stays[best] & np.isin(points[best], points[stays])]
        if not len(moved):
            break
        labels = labels.copy()
        labels[points[moved]] = labels[nearest[moved]]
    return labels


def describe(
    surface: Surface, labels: NDArray[np.int32], owner: NDArray[np.int32], structure: NDArray[np.bool_]
) -> tuple[I64, I64, I64, F64]:
    """The candidates for reassignment: each point that has neighbours of another object, with each object near it.

    Returns the point, the object and the object's nearest point, `[C]` each, and the features `[C, len(FEATURES)]`.
    """
    own = owner[labels]
    rows = np.flatnonzero((own[surface.neighbours] != own[:, None]).any(axis=1))
    k = surface.neighbours.shape[1]
    if not len(rows):
        return rows, rows, rows, np.zeros((0, len(FEATURES)))
    first, second = np.repeat(rows, k), surface.neighbours[rows].ravel().astype(np.int64)
    least_thing = int(owner.min(initial=-1))
    many = int(owner.max(initial=-1)) - least_thing + 1
    key, pair = np.unique(first * many + own[second] - least_thing, return_inverse=True)
    point, thing = key // many, key % many + least_thing
    count = len(key)
    size = np.bincount(pair, minlength=count).astype(np.float64)

    def mean(values: NDArray[np.floating]) -> F64:
        return np.bincount(pair, weights=values, minlength=count) / size

    def least(values: NDArray[np.floating]) -> F64:
        lowest = np.full(count, np.inf)
        np.minimum.at(lowest, pair, values)
        return lowest

    step = surface.points[second] - surface.points[first]
    length = np.maximum(np.linalg.norm(step, axis=1), 1e-9)
    gap = surface.raw_lab[first].astype(np.float64) - surface.raw_lab[second]
    light, chroma = np.abs(gap[:, 0]) / 10, np.linalg.norm(gap[:, 1:], axis=1) / 5
    order = np.lexsort((surface.gaps[rows].ravel(), pair))
    nearest = second[order[np.r_[True, np.diff(pair[order]) > 0]]]
    lab, pattern = _superpoint_colors(surface, labels, len(owner))
    piece = surface.raw_lab[point] - lab[labels[nearest]]
    mine = surface.raw_lab[point] - lab[labels[point]]
    local = np.maximum(surface.gaps[point].mean(axis=1), 1e-9)
    columns = [
        size / k,
        np.minimum(least(length) / local, 3),
        np.minimum(least(light), 4),
        np.minimum(mean(light), 4),
        np.minimum(least(chroma), 4),
        np.minimum(mean(chroma), 4),
        mean(np.abs((surface.normals[first] * surface.normals[second]).sum(1))),
        mean(np.abs((surface.normals[first] * step).sum(1)) / length),
        mean(np.abs((surface.normals[second] * step).sum(1)) / length),
        (own[point] == thing).astype(np.float64),
        structure[labels[nearest]].astype(np.float64),
        (thing == -1).astype(np.float64),
        surface.flatness[point],
        np.minimum(np.abs(piece[:, 0]) / 10, 4),
        np.minimum(np.linalg.norm(piece[:, 1:], axis=1) / 5, 4),
        np.minimum(pattern[labels[nearest]] / 5, 3),
        np.minimum(np.abs(mine[:, 0]) / 10, 4),
        np.minimum(np.linalg.norm(mine[:, 1:], axis=1) / 5, 4),
    ]
    return point, thing, nearest, np.stack(columns, axis=1).astype(np.float64)


def _superpoint_colors(surface: Surface, labels: NDArray[np.int32], count: int) -> tuple[F64, F64]:
    """Mean Lab `[S, 3]` and standard deviation of the colour `[S]` of each superpoint."""
    size = np.maximum(np.bincount(labels, minlength=count), 1)[:, None]
    lab = surface.raw_lab.astype(np.float64)

    def mean(values: F64) -> F64:
        return np.stack([np.bincount(labels, weights=v, minlength=count) for v in values.T], axis=1) / size

    middle = mean(lab)
    return middle, np.sqrt(np.maximum(mean(lab**2) - middle**2, 0).sum(axis=1))

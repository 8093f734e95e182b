"""Find patches of one colour in a cloud, by the colours of single Gaussians and without groups."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ...camera import Vec3
from ...cloud import GaussianCloud
from ..segmentation.surface import MIN_OPACITY, base_lab
from .attributes import color_scores

F64 = NDArray[np.float64]

CELLS = 260  # voxels along the robust diagonal of the scene, in which colour is averaged
SEED_SCORE = 0.5  # colour score of seed cells: no other basic term is nearer
GROW_SCORE = 0.08  # score down to which a patch grows into adjacent cells: folds and shadows of one material
LINK_DISTANCE = 0.012  # of the diagonal: cells this near each other are linked
LINK_SIGMAS = 3.0  # standard deviations of a typical Gaussian, likewise for coarsely sampled surfaces
MIN_SCORE = 0.03  # of a Gaussian: below it the Gaussian only shares the cell


@dataclass(frozen=True)
class Patch:
    """One connected region of a colour.

    Attributes:
        rows: `[M]` int64, ascending.
        weight: geometric mean of its shares of the scene's Gaussians and of their footprint, times its score. Captures
            have many small Gaussians in the centre of attention and a few very large ones in the background.
        score: mean colour score, weighted by footprint.
        center, size: `[3]` median and robust extent of its Gaussians, world axes, scene units.
    """

    rows: NDArray[np.int64]
    weight: float
    score: float
    center: Vec3
    size: Vec3


def patches(cloud: GaussianCloud, words: tuple[str, ...], among: NDArray[np.bool_]) -> list[Patch]:
    """The patches that match all colour words, largest weight first.

    Args:
        words: colour words; the minimum of their scores counts.
        among: `[N]` bool, rows that may be selected.

    Raises:
        UserError: a colour word is unknown.
    """
    rows = np.flatnonzero(among & (cloud.opacities > MIN_OPACITY).numpy())
    if not len(rows):
        return []
    part = cloud[torch.from_numpy(rows)]
    lab = base_lab(part).double().numpy()
    ordered = part.scales.sort(dim=1, descending=True).values
    footprint = (ordered[:, 0] * ordered[:, 1] * part.opacities).double().numpy()
    weight = np.minimum(footprint, np.quantile(footprint, 0.98))
    points = part.means.double().numpy()
    diagonal = _diagonal(cloud)
    cell, place, mean = _cells(points, lab, weight, diagonal / CELLS)
    score = np.min([color_scores(w, mean) for w in words], axis=0)
    own = np.min([color_scores(w, lab) for w in words], axis=0)
    reach = max(LINK_DISTANCE * diagonal, LINK_SIGMAS * float(ordered[:, 0].median()))
    of_cell = _places(place, score, reach)
    of_row = np.where(own >= MIN_SCORE, of_cell[cell], -1)
    order = np.argsort(of_row, kind="stable")  # rows ascend within a patch
    found = np.split(order, np.searchsorted(of_row[order], np.arange(int(of_cell.max(initial=-1)) + 2)))[1:-1]
    total = float(weight.sum()) + 1e-20
    made = [_patch(rows[k], points[k], own[k], weight[k], total, len(cloud)) for k in found if len(k)]
    return sorted(made, key=lambda p: (-p.weight, int(p.rows[0])))


def _diagonal(cloud: GaussianCloud) -> float:
    """Diagonal of the bounds of the scene without the outermost 2 % on each side, scene units."""
    sample = cloud.means[:: max(1, len(cloud) // 50_000)].double().numpy()
    low, high = np.quantile(sample, [0.02, 0.98], axis=0)
    return float(np.linalg.norm(high - low)) + 1e-12


def _patch(
    rows: NDArray[np.int64], points: F64, score: F64, weight: F64, total: float, count: int
) -> Patch:  # fmt: skip
    mean = float(np.average(score, weights=weight + 1e-20))
    share = float(np.sqrt(weight.sum() / total * len(rows) / count))
    spread = np.ptp(np.quantile(points, [0.02, 0.98], axis=0), axis=0)
    return Patch(rows, share * mean, mean, _vec(np.median(points, axis=0)), _vec(spread))


def _vec(values: F64) -> Vec3:
    x, y, z = (float(v) for v in values)
    return (x, y, z)


def _cells(points: F64, lab: F64, weight: F64, side: float) -> tuple[NDArray[np.int64], F64, F64]:
    """Voxel of each point `[M]`, and centre `[C, 3]` and mean Lab `[C, 3]` of each voxel."""
    key = np.floor((points - points.min(axis=0)) / side).astype(np.int64)
    code = (key[:, 0] << 42) + (key[:, 1] << 21) + key[:, 2]
    _, cell = np.unique(code, return_inverse=True)
    total = np.bincount(cell, weights=weight) + 1e-20

    def mean(values: F64) -> F64:
        return np.stack([np.bincount(cell, weights=values[:, c] * weight) for c in range(3)], axis=1) / total[:, None]

    return cell, mean(points), mean(lab)


def _places(centers: F64, score: F64, reach: float) -> NDArray[np.int64]:
    """Patch of each cell `[C]`, -1 for none: seed cells linked within `reach`, then grown into adjacent cells."""
    place = np.full(len(centers), -1)
    seeds = np.flatnonzero(score >= SEED_SCORE)
    if not len(seeds):
        return place
    place[seeds] = _components(centers[seeds], reach)
    border = seeds
    waiting = np.flatnonzero((score >= GROW_SCORE) & (place < 0))
    while len(waiting) and len(border):
        distance, nearest = cKDTree(centers[border]).query(centers[waiting], distance_upper_bound=0.6 * reach)
        near = np.isfinite(distance)
        place[waiting[near]] = place[border[nearest[near]]]
        border, waiting = waiting[near], waiting[~near]
    return place


def _components(points: F64, reach: float) -> NDArray[np.int64]:
    """Connected component `[M]` of each point, with links between points within `reach`."""
    if not len(points):
        return np.zeros(0, np.int64)
    pairs = cKDTree(points).query_pairs(reach, output_type="ndarray")
    links = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(points),) * 2)
    label: NDArray[np.int64] = connected_components(links, directed=False)[1].astype(np.int64)
    return label

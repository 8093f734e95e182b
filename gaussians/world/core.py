"""The core of a selection: its connected main body, told from the stray Gaussians that selections of captures hold.

A trained scene has floaters, and a segmentation gives some of them to things that they lie far from. The least and
greatest coordinates of a selection, its mean and its box then say where the strays are. Everything that is measured
to edit a thing (pivot, box, underside) is measured on the core; strays are left where they are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..cloud import GaussianCloud
from ..kept import Kept

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Bool = NDArray[np.bool_]

OPAQUE = 0.3  # Gaussians below it are haze and not solid, unless the whole selection is faint
LEAST_SOLID = 0.25  # share of a selection that is solid at least: short fits leave most Gaussians faint
CELLS = 32  # voxels along the longest side of the core, at most
_PER_CELL = 6  # solid points for each voxel of a side, squared: a coarser grid for few points, so that it has no gaps
_GAP = 1  # voxels by which occupied ones grow before they are joined: gaps of twice that are bridged
_NEAR = 4  # voxels from the core within which a Gaussian belongs to it, besides its own standard deviation
PIECE = 0.05  # of the largest piece's weight: lighter pieces apart from it do not extend the core
LOOSE = 0.01  # of all weight: lighter pieces far from the core do not move with it
_DENSE = 0.06  # of the typical coverage of a voxel: thinner ones are haze, which joins nothing
_CAP = 0.9  # quantile of the sides' product at which it is capped
_TRIM = 0.002  # share of the points beyond the first grid at each end
_SHRUNK = 0.8  # of the sides of the grid: a core smaller than that is divided again, more finely
_ROUNDS = 6
_SAMPLE = 60_000  # solid points from which the core is found
FEW = 24  # solid points below which no piece can be told from a stray


@dataclass(frozen=True, eq=False)
class Core:
    """Which Gaussians of a selection extend it, and which of them go where it goes.

    Attributes:
        solid: `[M]` bool, the solid Gaussians of the connected main body: what boxes are measured on.
        belongs: `[M]` bool, all but the strays: light pieces that lie far from the core.
        unity: share of what the selection covers that is in its heaviest connected piece; 1 for a thing in one piece.
    """

    solid: Bool
    belongs: Bool
    unity: float = 1.0

    @property
    def strays(self) -> int:
        """How many Gaussians do not belong to the thing."""
        return int((~self.belongs).sum())


def least_opacity(opacities: Tensor) -> float:
    """The opacity from which Gaussians `[M]` are solid: `OPAQUE`, or less where few of them are so opaque."""
    count = len(opacities)
    need = int(LEAST_SOLID * count)
    if need == 0 or int((opacities >= OPAQUE).sum()) >= need:
        return OPAQUE
    return float(torch.kthvalue(opacities, count - need + 1).values)


_known: Kept[Core] = Kept(8)


def core_of(cloud: GaussianCloud, rows: Tensor) -> Core:
    """The core of some rows `[M]` of a cloud; the last few are kept, as an edit and its checks ask for the same.

    Solid Gaussians are binned into a grid of voxels, whose occupied ones are joined over small gaps. Light pieces are
    dropped and the grid is fitted to the rest, until it stops shrinking; a thing without strays is whole in the first
    round. Takes time linear in M.
    """
    return _known.get((cloud.means, cloud.scales, cloud.opacities, rows), lambda: _core(cloud, rows))


def _core(cloud: GaussianCloud, rows: Tensor) -> Core:
    opacity = cloud.opacities[rows]
    solid: Bool = (opacity >= least_opacity(opacity)).cpu().numpy()
    if not solid.any():
        solid = np.ones(len(rows), dtype=bool)
    chosen = np.flatnonzero(solid)
    grid: _Grid | None = None
    unity = 1.0
    if len(chosen) >= FEW:
        some = rows[torch.from_numpy(chosen[:: max(1, len(chosen) // _SAMPLE)]).to(rows.device)]
        weight = coverage(cloud.scales[some], cloud.opacities[some])
        grid, unity = _converged(cloud.means[some].cpu().numpy(), weight)
    if grid is None:
        return Core(solid, np.ones(len(rows), dtype=bool), unity)
    away, heavy = grid.distance(cloud.means[rows].cpu().numpy())
    inner = away <= 0
    belongs = inner | heavy | (away <= _NEAR * grid.cell)
    far = np.flatnonzero(~belongs)
    if len(far):
        own = cloud.scales[rows[torch.from_numpy(far).to(rows.device)]].amax(dim=1).cpu().numpy()
        belongs[far] = away[far] <= _NEAR * grid.cell + own
    return Core(solid & inner, belongs, unity)


def coverage(scales: Tensor, opacities: Tensor) -> F32:
    """How much surface each Gaussian covers, `[M]`: opacity times the product of its two longer sides.

    It is the same for a few large Gaussians and for many small ones. Of the widest tenth it is capped, so that a single
    large Gaussian in the air weighs no more than a piece of surface.
    """
    area: F32 = (scales.prod(dim=1) / scales.amin(dim=1)).cpu().numpy()
    cap = np.partition(area, int(_CAP * (len(area) - 1)))[int(_CAP * (len(area) - 1))]
    return np.asarray(np.minimum(area, cap) * opacities.cpu().numpy(), dtype=np.float32)


@dataclass(frozen=True, eq=False)
class _Grid:
    """Voxels of one round: `low` `[3]` their corner, `cell` their side, `kept` and `heavy` `[X, Y, Z]` bool: those of
    the core, and those of pieces that are too heavy to be strays; and the weight of the `heaviest` piece."""

    low: F64
    cell: float
    kept: Bool
    heavy: Bool
    heaviest: float = 0.0

    def index(self, points: F32) -> tuple[NDArray[np.int32], NDArray[np.intp], F32]:
        """The nearest voxel `[M]` of points `[M, 3]`, flattened; and which of them lie beyond the grid, how far,
        scene units."""
        flat = np.zeros(len(points), dtype=np.int32)
        beyond: F32 | None = None
        for axis, count in enumerate(self.kept.shape):
            place = (points[:, axis] - np.float32(self.low[axis])) / np.float32(self.cell)
            over = np.flatnonzero(~((place >= 0) & (place < count)))
            if len(over):
                beyond = np.zeros(len(points), dtype=np.float32) if beyond is None else beyond
                beyond[over] += np.maximum(-place[over], place[over] - count) ** 2
                place[over] = np.clip(np.nan_to_num(place[over]), 0, count - 1)
            flat *= count
            flat += place.astype(np.int32)
        outside = np.flatnonzero(beyond) if beyond is not None else np.zeros(0, dtype=np.intp)
        away = np.sqrt(beyond[outside]) * np.float32(self.cell) if beyond is not None else np.zeros(0, np.float32)
        return flat, outside, away

    def distance(self, points: F32) -> tuple[F32, Bool]:
        """Distance `[M]` of points `[M, 3]` from the voxels of the core, 0 in them, scene units; and whether they lie
        in a piece that is too heavy for a stray."""
        from scipy import ndimage

        flat, outside, beyond = self.index(points)
        table = (ndimage.distance_transform_edt(~self.kept) * self.cell).astype(np.float32).ravel()
        away, heavy = table[flat], self.heavy.ravel()[flat]
        away[outside] += beyond
        heavy[outside] = False
        return away, heavy


def _converged(points: F32, weight: F32) -> tuple[_Grid | None, float]:
    """The grid around the core of solid points `[M, 3]`, None if they have no extent or hold no strays; and the share
    of all weight in its heaviest piece."""
    skip = int(_TRIM * len(points))
    ordered = np.sort(points, axis=0)
    low, high = ordered[skip].astype(np.float64), ordered[len(points) - 1 - skip].astype(np.float64)
    whole = skip == 0 or bool((ordered[[0, -1]] == ordered[[skip, -1 - skip]]).all())
    cells = float(np.clip(np.sqrt(len(points) / _PER_CELL), 2, CELLS))
    grid: _Grid | None = None
    for _ in range(_ROUNDS):
        side = float((high - low).max())
        if not side > 0:
            break
        grid, inside = _divided(points, weight, low, high, side / cells)
        kept = points[inside]
        now_low, now_high = kept.min(axis=0).astype(np.float64), kept.max(axis=0).astype(np.float64)
        whole = whole and bool(inside.all())
        shrunk = float((now_high - now_low).max()) < _SHRUNK * side
        low, high = now_low, now_high
        if not shrunk:
            break
    return None if whole else grid, 1.0 if grid is None else grid.heaviest / max(float(weight.sum()), 1e-30)


def _divided(points: F32, weight: F32, low: F64, high: F64, cell: float) -> tuple[_Grid, Bool]:
    """The grid from `low` to `high`, and which points lie in its core."""
    from scipy import ndimage

    margin = _GAP + 1
    shape = np.floor((high - low) / cell).astype(np.intp) + 1 + 2 * margin
    corner = low - margin * cell
    empty = np.zeros(tuple(shape), dtype=bool)
    grid = _Grid(corner, cell, empty, empty)
    flat, outside, _ = grid.index(points)
    within = np.ones(len(points), dtype=bool)
    within[outside] = False
    mass: F64 = (
        np.bincount(flat[within], weights=weight[within], minlength=int(np.prod(shape)))
        .reshape(shape)
        .astype(np.float64)
    )
    block = np.ones((3, 3, 3), dtype=bool)
    near = ndimage.uniform_filter(mass, 3, mode="constant")
    occupied = (mass > 0) & (near >= _DENSE * _typical(near[mass > 0], mass[mass > 0]))
    labels, count = ndimage.label(ndimage.binary_dilation(occupied, block, iterations=_GAP), block)
    total = np.bincount(labels.ravel(), weights=mass.ravel(), minlength=count + 1)
    total[0] = 0.0
    kept = (total >= PIECE * total.max()) & (total > 0)
    heavy = total >= LOOSE * float(weight.sum())
    grid = _Grid(corner, cell, kept[labels], heavy[labels], float(total.max()))
    return grid, within & grid.kept.ravel()[flat]


def _typical(values: F64, weight: F64) -> float:
    """The weighted median of values `[M]`."""
    order = np.argsort(values)
    total = np.cumsum(weight[order])
    return float(values[order[np.searchsorted(total, 0.5 * total[-1])]])

"""`merge`: fewer Gaussians that look alike from everywhere, by merging neighbours of like colour, size and orientation.

Pairs of neighbours are merged in rounds, those first that change pictures least (`cost.py`). The result depends only on
which rows became one: their mass, mean position, covariance and mean colour are kept (`merged_by`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..camera import Camera, Vec3
from ..cloud import GaussianCloud
from ..compiled import run, run_alone, workers
from ..errors import UserError
from ..harmonics import SH_C0
from ..render.cpu import gradient
from ..rotations import from_matrix, to_matrix
from .cost import OPAQUE, disjoint, mean_areas, pair_costs

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

NEIGHBOURS = 6  # of each Gaussian that it may be merged with
ROUND_SHARE = 0.35  # of the Gaussians, at most, that a round merges into others
UPPER = ((0, 0, 0, 1, 1, 2), (0, 1, 2, 1, 2, 2))  # rows and columns of `cost.Covariance`
FAINT = 1e-4  # of the visibility of what shows well, which every Gaussian has: other views may show it
WELL = 0.95  # quantile of the visibilities that stands for what shows well
PROBES = 2  # pictures of random signs for each view
BACKGROUNDS: tuple[Vec3, Vec3] = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))  # of the views in turn
SEED = 16
FLAT = 1e-6  # smallest standard deviation of a merged Gaussian by its largest


@dataclass(frozen=True, eq=False)
class Merged:
    """A cloud with fewer Gaussians.

    Attributes:
        cloud: `M` Gaussians in the order of the first row of each; the id is that of the row with most mass. A
            Gaussian that was not merged is unchanged bit for bit.
        rows: `[N]`, for each row of the original its row in `cloud`.
        shown: `[M]` to merge further with; None if none was given. `visibility` of the merged cloud is better by up to
            1 dB after several levels.
    """

    cloud: GaussianCloud
    rows: I64
    shown: F64 | None


def merge(
    cloud: GaussianCloud, count: int, shown: NDArray[np.floating] | None = None, across_groups: bool = False
) -> Merged:
    """A cloud merged into at most `count` Gaussians. Same input, same result, with any number of threads.

    Args:
        cloud: the original; nothing in it is changed.
        shown: `[N]`, how much a change of each Gaussian shows (see `visibility`); without it all show alike, and
            what lies within things costs as much as their surface: on a captured guitar that loses 6 dB at a quarter
            of the Gaussians.
        across_groups: whether Gaussians of two groups may become one, of the group of the one with most mass. A
            language field is true only without.

    Raises:
        UserError: `count` is less than one, or than the number of groups, or a value of the cloud is not finite.
    """
    groups = np.zeros(len(cloud), np.int64) if across_groups else _dense(cloud.group.cpu().numpy())
    least = int(groups.max(initial=-1)) + 1
    if count < max(1, least):
        raise UserError(
            f"{len(cloud)} Gaussians of {least} groups cannot be merged into {count}: each group keeps at least one"
        )
    if shown is not None and len(shown) != len(cloud):
        raise UserError(f"`shown` must have {len(cloud)} values, one for each Gaussian, got {len(shown)}")
    rows = np.arange(len(cloud))
    state = _State.of(cloud, groups, shown)
    while len(state.mass) > count:
        smaller, onto = state.reduced(len(state.mass) - count)
        rows, state = onto[rows], smaller
    return Merged(merged_by(cloud, rows), rows, None if shown is None else state.shown)


def visibility(cloud: GaussianCloud, cameras: Sequence[Camera]) -> F64:
    """`[N]` in (0, 1]: how much a change of each Gaussian changes these views. Same input, same result.

    It is the squared change of the pictures by leaving a Gaussian out, estimated from pictures of random signs (see
    `slim/importance.py`), relative to that of one alone of its size and opacity, and to what shows well. What is
    hidden, and what lies before its own colour, shows little.
    """
    columns = tuple(
        c.detach().cpu().contiguous().numpy()
        for c in (cloud.means, cloud.quats, cloud.scales, cloud.opacities, cloud.sh)
    )
    state = _State.of(cloud, np.zeros(len(cloud), np.int64), None)
    rng, removal = np.random.default_rng(SEED), np.zeros(len(cloud))
    for number, camera in enumerate(cameras):
        drawn = gradient.draw(columns, camera, BACKGROUNDS[number % 2])
        for _ in range(PROBES):
            signs = rng.integers(0, 2, drawn.rgb.shape).astype(np.float32) * 2 - 1
            slopes = gradient.draw_backward(drawn, signs, np.zeros(signs.shape[:2], np.float32)).opacities
            removal += (slopes.astype(np.float64) * columns[3]) ** 2
    seen = removal * state.area / np.maximum(state.mass**2, np.finfo(np.float64).tiny)
    well = float(np.quantile(seen, WELL)) if len(seen) else 0.0
    return np.clip(seen / well, FAINT, 1.0) if well > 0 else np.ones(len(cloud))


def masses(cloud: GaussianCloud) -> F64:
    """`[N]`, opacity times mean projected area (in units of 2 pi): what merging keeps."""
    return _State.of(cloud, np.zeros(len(cloud), np.int64), None).mass


def merged_by(cloud: GaussianCloud, rows: I64) -> GaussianCloud:
    """The cloud `[M]` in which the rows with equal `rows` `[N]`, numbers 0 to M - 1, are one Gaussian each.

    With the mass of a Gaussian, opacity times mean projected area, as weight, it keeps mean position, covariance and
    mean harmonics; and it keeps the mass, as far as opacities may reach. Group and id are those of the row of most
    mass.
    """
    many = int(rows.max(initial=-1)) + 1
    state = _State.of(cloud, np.zeros(len(cloud), np.int64), None)
    order = np.lexsort((np.arange(len(rows)), -state.mass, rows))  # of each new row, the row of most mass first
    heads = order[np.searchsorted(rows[order], np.arange(many))]
    new = cloud[torch.from_numpy(heads)]
    joined = np.flatnonzero(np.bincount(rows, minlength=many) > 1)
    if not len(joined):
        return new
    inside = np.isin(rows, joined)
    part, to = state.taken(np.flatnonzero(inside)), np.searchsorted(joined, rows[inside])
    mean, covariance, color, mass = _moments(part, to, len(joined))
    scales, axes = _axes(covariance)
    opacity = np.minimum(mass / mean_areas(covariance), OPAQUE)
    index = torch.from_numpy(joined)

    def put(column: torch.Tensor, values: F64 | torch.Tensor) -> torch.Tensor:
        found = torch.as_tensor(values).reshape(-1, *column.shape[1:]).to(column)
        return column.index_copy(0, index.to(column.device), found)

    return new.replace(
        means=put(new.means, mean), quats=put(new.quats, from_matrix(torch.from_numpy(axes))),
        scales=put(new.scales, scales), opacities=put(new.opacities, opacity), sh=put(new.sh, color / SH_C0),
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class _State:
    """Gaussians as the kernels read them; see `cost.pair_costs`. `groups` `[N]` are numbers from zero on."""

    means: F64
    covariances: F64
    frames: F64
    mass: F64
    area: F64
    colors: F64
    shown: F64
    groups: I64

    @classmethod
    def of(cls, cloud: GaussianCloud, groups: I64, shown: NDArray[np.floating] | None) -> _State:
        if not all(bool(torch.isfinite(column).all()) for _, column in cloud.columns()):
            raise UserError("a Gaussian that is not finite cannot be merged; leave it out first")
        means, quats, scales, opacities, sh = (
            c.detach().cpu().double() for c in (cloud.means, cloud.quats, cloud.scales, cloud.opacities, cloud.sh)
        )
        frames = to_matrix(quats)
        stretched = frames * scales[:, None]
        full = (stretched @ stretched.transpose(1, 2)).numpy()
        covariances = np.ascontiguousarray(full[:, UPPER[0], UPPER[1]])
        area = mean_areas(covariances)
        return cls(
            means.numpy(), covariances, frames.numpy(), opacities.numpy() * area, area,
            SH_C0 * sh.reshape(len(cloud), sh.shape[1] * 3).numpy(),
            np.ones(len(cloud)) if shown is None else np.asarray(shown, np.float64), groups,
        )  # fmt: skip

    def taken(self, rows: I64) -> _State:
        return _State(
            self.means[rows], self.covariances[rows], self.frames[rows], self.mass[rows], self.area[rows],
            self.colors[rows], self.shown[rows], self.groups[rows],
        )  # fmt: skip

    def reduced(self, most: int) -> tuple[_State, I64]:
        """The state after one round of at most `most` merges, and for each row its new one."""
        first, second = self._neighbours()
        cost = np.empty(len(first))
        run(
            pair_costs, workers(), first, second, self.means, self.covariances, self.frames, self.mass, self.area,
            self.colors, self.shown, cost,
        )  # fmt: skip
        count = len(self.mass)
        most = min(most, max(1, int(ROUND_SHARE * count)))
        picked = np.empty(most, np.int64)
        order = np.argsort(cost, kind="stable")
        found = run_alone(disjoint, order, first, second, most, np.zeros(count, np.bool_), picked)
        first, second = first[picked[:found]], second[picked[:found]]
        onto = np.arange(count)
        onto[second] = first
        kept = onto == np.arange(count)
        return self._joined(first, second).taken(np.flatnonzero(kept)), (np.cumsum(kept) - 1)[onto]

    def _neighbours(self) -> tuple[I64, I64]:
        """Pairs of near rows of one group, `first < second`, each pair once."""
        count = len(self.means)
        apart = 2 * float(np.ptp(self.means, axis=0).max()) + 1  # so that those of one group are nearest
        places = np.column_stack([self.means, self.groups * apart]) if self.groups.any() else self.means
        near = cKDTree(places).query(places, k=min(NEIGHBOURS + 1, count))[1].reshape(count, -1)
        rows = np.broadcast_to(np.arange(count)[:, None], near.shape)
        low, high = np.minimum(rows, near), np.maximum(rows, near)
        use = (low < high) & (self.groups[low] == self.groups[high])
        keys = np.unique(low[use] * count + high[use])
        return keys // count, keys % count

    def _joined(self, first: I64, second: I64) -> _State:
        """The rows `first` merged with the rows `second`; the rows `second` are still there."""
        pairs = np.concatenate([first, second])
        part, to = self.taken(pairs), np.tile(np.arange(len(first)), 2)
        columns = [column.copy() for column in (self.means, self.covariances, self.colors, self.mass)]
        for column, values in zip(columns, _moments(part, to, len(first)), strict=True):
            column[first] = values
        means, covariances, colors, mass = columns
        frames, area, shown = self.frames.copy(), self.area.copy(), self.shown.copy()
        larger = np.where(area[first] >= area[second], first, second)
        frames[first] = frames[larger]
        area[first] = mean_areas(covariances[first])
        weight = self.mass[first] / mass[first]
        shown[first] = weight * shown[first] + (1 - weight) * shown[second]
        return _State(means, covariances, frames, mass, area, colors, shown, self.groups)


def _moments(part: _State, to: I64, many: int) -> tuple[F64, F64, F64, F64]:
    """Mean position `[M, 3]`, covariance `[M, 6]`, mean colour `[M, C]` and mass `[M]` of the rows of each of `many`
    Gaussians; row i belongs to `to[i]`."""
    order = np.argsort(to, kind="stable")
    starts = np.searchsorted(to[order], np.arange(many))
    mass = np.add.reduceat(part.mass[order], starts)
    weight = (part.mass / mass[to])[:, None]
    mean, color = (np.add.reduceat((weight * c)[order], starts) for c in (part.means, part.colors))
    off = part.means - mean[to]
    spread = part.covariances + off[:, UPPER[0]] * off[:, UPPER[1]]
    return mean, np.add.reduceat((weight * spread)[order], starts), color, mass


def _axes(covariances: F64) -> tuple[F64, F64]:
    """Standard deviations `[M, 3]` and axes `[M, 3, 3]` (columns, right-handed) of covariances `[M, 6]`."""
    full = covariances[:, (0, 1, 2, 1, 3, 4, 2, 4, 5)].reshape(-1, 3, 3)
    squares, axes = np.linalg.eigh(full)
    scales = np.sqrt(np.maximum(squares, 0))
    axes[np.linalg.det(axes) < 0, :, 0] *= -1
    return np.maximum(scales, FLAT * scales[:, 2:]), axes


def _dense(group: NDArray[np.int32]) -> I64:
    """`[N]` the groups numbered from zero on."""
    return np.unique(group, return_inverse=True)[1].astype(np.int64)

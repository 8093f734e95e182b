"""Surface points of a cloud, with normals, colours and neighbours: the input of the segmentation."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray

from ...cloud import GaussianCloud
from ...color import rgb_to_lab
from ...harmonics import SH_C0
from ...rotations import to_matrix

F32 = NDArray[np.float32]

NEIGHBOURS = 10
MIN_OPACITY = 0.08  # Gaussians below this are not surface points,
HAZY = 0.15  # or below this share of the scene's typical opacity: short fits make surfaces of many faint Gaussians
COVERED = 0.05  # of the area of the scene's box: what faint Gaussians cover together where they are surfaces
GRAIN = 0.5  # of the typical extent of a Gaussian: least spacing, where Gaussians overlap far more than they must
DENSE = 4.0  # spacings within which three neighbours must lie for a point of any size to be kept
OVERLAP = 2.0  # own standard deviations within which they must lie otherwise
PRUNINGS = 3  # passes: floaters may be near each other, so removing some isolates more
MAX_POINTS = 220_000  # more points cost time and add nothing to objects seen at this scale


@dataclass(frozen=True)
class Surface:
    """M surface points.

    Attributes:
        rows: `[M]` int64, row of the cloud each point came from.
        points: `[M, 3]` world, scene units.
        normals: `[M, 3]` unit, sign arbitrary, smoothed over the neighbours.
        flatness: `[M]` in [0, 1], 1 where the neighbourhood is a plane.
        lab: `[M, 3]` colour, smoothed over the neighbours.
        raw_lab: `[M, 3]` colour as stored.
        area: `[M]` footprint of the Gaussian, scene units squared, weighted by opacity.
        neighbours: `[M, K]` int32, nearest points; a point with fewer repeats itself.
        gaps: `[M, K]` distances to them, scene units.
        spacing: median distance to the nearest neighbours, scene units.
        layer: `[M]` int8, structure code of a point known to lie in a noisy plane, else 0; see `settle.py`.
    """

    rows: NDArray[np.int64]
    points: F32
    normals: F32
    flatness: F32
    lab: F32
    raw_lab: F32
    area: F32
    neighbours: NDArray[np.int32]
    gaps: F32
    spacing: float
    layer: NDArray[np.int8]

    def __len__(self) -> int:
        return len(self.rows)


@dataclass(frozen=True)
class Known:
    """What is known about M surface points before they are measured.

    Attributes:
        rows: `[M]` of the cloud.
        points: `[M, 3]` world, scene units.
        normals: `[M, 3]` unit, of the planes that some of them lie in.
        trust: `[M]` in [0, 1], share of that normal in the result; the rest is measured.
        layer: `[M]` see `Surface`.
    """

    rows: NDArray[np.int64]
    points: F32
    normals: F32
    trust: F32
    layer: NDArray[np.int8]


def base_lab(cloud: GaussianCloud) -> torch.Tensor:
    """`[N, 3]` CIE Lab of the view-independent colour of each Gaussian."""
    return rgb_to_lab((cloud.sh[:, 0] * SH_C0 + 0.5).clamp(0, 1))


def surface_of(cloud: GaussianCloud, most: int = MAX_POINTS) -> Surface:
    """The surface points of a cloud: Gaussians that are opaque enough, not oversized and not isolated.

    At most `most` points, taken at even steps over the rows.
    """
    rows = solid_rows(cloud)
    if len(rows) > most:
        rows = rows[np.linspace(0, len(rows) - 1, most).astype(np.int64)]
    points = cloud.means[rows].numpy()
    k = min(NEIGHBOURS, max(len(rows) - 1, 1))
    gaps, neighbours = _nearest(points, k)
    spacing = float(np.median(gaps[:, : max(1, k // 2)])) if len(rows) else 0.0
    passes = PRUNINGS if least_opacity(cloud) == MIN_OPACITY else 0  # faint Gaussians are alike, floaters or not
    for _ in range(passes):
        kept = _not_isolated(gaps, cloud.scales[rows].amax(dim=1).numpy(), spacing)
        if kept.all():
            break
        rows, points = rows[kept], points[kept]  # drop floaters and search the neighbours again
        gaps, neighbours = _nearest(points, k)
    if len(rows):
        spacing = max(spacing, GRAIN * float(cloud.scales[rows].amax(dim=1).median()))
    return _measured(cloud[torch.from_numpy(rows)], rows, neighbours, gaps, spacing)


def least_opacity(cloud: GaussianCloud) -> float:
    """Opacity from which a Gaussian may be a surface point.

    MIN_OPACITY, or less in a scene whose surfaces consist of many faint Gaussians, as after a short fit. There they
    overlap so much that together they cover the scene's box; haze alone does not.
    """
    step = max(1, len(cloud) // 50_000)
    part = cloud[torch.arange(0, len(cloud), step)]
    if not len(part):
        return MIN_OPACITY
    opacity = part.opacities.numpy().astype(np.float64)
    low, high = np.quantile(part.means.numpy(), [0.05, 0.95], axis=0)
    w, d, h = high - low
    footprint = _footprint(part)
    footprint = np.minimum(footprint, np.quantile(footprint, 0.95))
    if step * float(footprint.sum()) < COVERED * 2 * float(w * d + d * h + w * h):
        return MIN_OPACITY
    order = np.argsort(opacity)
    total = np.cumsum(opacity[order])
    typical = float(opacity[order][np.searchsorted(total, 0.5 * total[-1])])
    return min(MIN_OPACITY, HAZY * typical)


def surface_at(cloud: GaussianCloud, known: Known) -> Surface:
    """The surface of Gaussians whose points are known to lie elsewhere than they do."""
    k = min(NEIGHBOURS, max(len(known.rows) - 1, 1))
    gaps, neighbours = _nearest(known.points, k)
    part = cloud[torch.from_numpy(known.rows)].replace(means=torch.from_numpy(known.points))
    spacing = max(float(np.median(gaps[:, : max(1, k // 2)])), GRAIN * float(part.scales.amax(dim=1).median()))
    found = _measured(part, known.rows, neighbours, gaps, spacing)
    against = (found.normals * known.normals).sum(axis=1, keepdims=True) < 0
    same = np.where(against, -known.normals, known.normals)
    trust = known.trust[:, None]
    mixed = (1 - trust) * found.normals + trust * same
    mixed /= np.maximum(np.linalg.norm(mixed, axis=1, keepdims=True), 1e-9)
    flatness = np.maximum(found.flatness, known.trust)
    return replace(found, normals=mixed.astype(np.float32), flatness=flatness, layer=known.layer)


def _measured(
    part: GaussianCloud, rows: NDArray[np.int64], neighbours: NDArray[np.int32], gaps: F32, spacing: float
) -> Surface:
    raw_lab = base_lab(part).numpy()
    normals, flatness = _smoothed_normals(part, neighbours)
    return Surface(
        rows, part.means.numpy(), normals, flatness, _smoothed_lab(raw_lab, neighbours), raw_lab, _footprint(part),
        neighbours, gaps, spacing, np.zeros(len(rows), np.int8),
    )  # fmt: skip


def solid_rows(cloud: GaussianCloud) -> NDArray[np.int64]:
    """Rows `[K]` of the Gaussians that are opaque enough and not oversized."""
    largest = cloud.scales.amax(dim=1)
    if len(cloud) == 0:
        return np.zeros(0, np.int64)
    sample = largest[:: max(1, len(cloud) // 50_000)]
    bound = 12 * float(torch.quantile(sample, 0.8))
    return ((cloud.opacities > least_opacity(cloud)) & (largest < bound)).nonzero().squeeze(1).numpy()


def _not_isolated(gaps: F32, reach: F32, spacing: float) -> NDArray[np.bool_]:
    """Whether each point `[M]` has close neighbours: close for the scene, or, on a coarse surface, for its own size.

    Splats of a surface overlap; floaters do not.

    Args:
        gaps: `[M, K]` distances to neighbours.
        reach: `[M]` largest standard deviation.
        spacing: typical distance of neighbours.
    """
    m, k = gaps.shape
    if m <= 4 * k:
        return np.ones(m, bool)
    few = gaps[:, min(3, k - 1)]
    return (few < 12 * max(spacing, 1e-12)) & ((few < DENSE * spacing) | (few < OVERLAP * reach))


def _nearest(points: F32, k: int) -> tuple[F32, NDArray[np.int32]]:
    """Distances and indices `[M, k]` of the nearest other points."""
    if len(points) < 2:
        return np.zeros((len(points), k), np.float32), np.zeros((len(points), k), np.int32)
    from scipy.spatial import cKDTree

    gaps, index = cKDTree(points).query(points, k=k + 1, workers=-1)
    return gaps[:, 1:].astype(np.float32), index[:, 1:].astype(np.int32)


def _footprint(cloud: GaussianCloud) -> F32:
    """Area of the two largest axes times opacity."""
    ordered = cloud.scales.sort(dim=1, descending=True).values
    area: F32 = (ordered[:, 0] * ordered[:, 1] * cloud.opacities * torch.pi).numpy()
    return area


def _smoothed_normals(cloud: GaussianCloud, neighbours: NDArray[np.int32]) -> tuple[F32, F32]:
    """Normals `[M, 3]` and flatness `[M]`, from the mean `n n^T` of the neighbours' thin axes and the points' scatter.

    The thin axis of a trained Gaussian is noisy; positions of neighbours are noisy across the surface but not along it.
    The sum is correct where one of the two is.
    """
    axes = to_matrix(cloud.quats)  # [M, 3, 3], columns are the local axes in the world
    thin = cloud.scales.argmin(dim=1)
    normal = torch.gather(axes, 2, thin[:, None, None].expand(-1, 3, 1)).squeeze(2)  # [M, 3]
    ordered = cloud.scales.sort(dim=1).values
    weight = (1 - ordered[:, 0] / ordered[:, 1].clamp(min=1e-12)).clamp(0, 1)  # 0 for needles and balls
    index = torch.from_numpy(neighbours.astype(np.int64))
    outer = normal[:, :, None] * normal[:, None, :] * weight[:, None, None]  # [M, 3, 3]
    tensor = outer[index].sum(dim=1) + outer
    offsets = cloud.means[index] - cloud.means[:, None, :]  # [M, K, 3]
    scatter = torch.einsum("mki,mkj->mij", offsets, offsets)
    scatter = scatter / scatter.diagonal(dim1=1, dim2=2).sum(1).clamp(min=1e-20)[:, None, None]
    values, vectors = torch.linalg.eigh(tensor / (1 + neighbours.shape[1]) - scatter)
    flat = ((values[:, 2] - values[:, 1]) / (values[:, 2] - values[:, 0]).clamp(min=1e-9)).clamp(0, 1)
    return vectors[:, :, 2].contiguous().numpy(), flat.numpy()


def _smoothed_lab(lab: F32, neighbours: NDArray[np.int32]) -> F32:
    """Colours `[M, 3]` after one bilateral filter step over the neighbours, which reduces noise and keeps edges."""
    near = lab[neighbours]  # [M, K, 3]
    distance = ((near - lab[:, None]) ** 2).sum(2)
    weight = np.exp(-distance / (2 * 12.0**2))
    smooth: F32 = ((near * weight[..., None]).sum(1) + lab) / (weight.sum(1)[:, None] + 1)
    return smooth

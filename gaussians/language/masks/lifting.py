"""Lift 2D masks to Gaussians without training, by their blending weights (alpha times transmittance).

One pass of the rasteriser per view gives the blending weight of each Gaussian inside each mask. Its cost does not
depend on the width of feature vectors: these enter after masks have been grouped, or for `Lifted.features`. The method
is that of training-free uplifting such as Occam's LGS (Cheng et al. 2024): a mean over views, weighted by the blending
weights. `statements.py` says what the masks of a source tell about pairs of regions.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from ...cloud import GaussianCloud
from ...errors import UserError
from ...render import split
from . import ViewMasks

F32 = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Lifted:
    """M masks of V views, lifted to N Gaussians.

    Attributes:
        weights: `[N, M]` sparse float32, blending weight of each Gaussian summed over each mask's pixels.
        seen: `[N, V]` sparse float32, the same summed over all pixels of each view.
        view: `[M]` int32, ascending: the view of each mask.
        labels: M names, "" for unknown.
        scores: `[M]` float32.
        vectors: `[M, D]` float32, unit or zero rows; None if no view has any.
        places: `[N, 3]` centres of the Gaussians, world.
        eyes: `[V, 3]` position of each view's camera, world.
        focal: `[V]` its focal length, pixels.
    """

    weights: csr_matrix
    seen: csr_matrix
    view: NDArray[np.int32]
    labels: tuple[str, ...]
    scores: F32
    vectors: F32 | None
    places: F32
    eyes: NDArray[np.float64]
    focal: NDArray[np.float64]

    def features(self) -> F32:
        """Unit mean vector `[N, D]` of the masks that contain each Gaussian, by weight; zero where none does.

        This is the per-Gaussian feature field that groups replace. It is kept for comparison.

        Raises:
            UserError: the masks have no vectors.
        """
        if self.vectors is None:
            raise UserError("the masks have no vectors to lift")
        total = np.asarray(self.weights @ self.vectors, dtype=np.float32)
        norms = np.linalg.norm(total, axis=1, keepdims=True)
        units: F32 = (total / np.where(norms > 1e-12, norms, 1)).astype(np.float32)
        return units

    def at(self, rows: NDArray[np.int64]) -> Lifted:
        """The same for some of the Gaussians."""
        return replace(self, weights=self.weights[rows], seen=self.seen[rows], places=self.places[rows])


def lift(cloud: GaussianCloud, views: Iterable[ViewMasks]) -> Lifted:
    """Lift the masks of some views to the Gaussians. Views without masks count as seen.

    Raises:
        UserError: the views' vectors have different widths, or only some views have any.
    """
    weights, seen, taken = [], [], []
    for view in views:
        masks, whole = _lift_view(cloud, view)
        weights.append(masks)
        seen.append(whole)
        taken.append(view)
    count = len(cloud)
    return Lifted(
        weights=_side_by_side(weights, count),
        seen=_side_by_side(seen, count),
        view=np.repeat(np.arange(len(taken), dtype=np.int32), [len(v) for v in taken]),
        labels=tuple(label for view in taken for label in view.labels),
        scores=np.concatenate([np.zeros(0, np.float32), *(v.scores for v in taken)]),
        vectors=_vectors(taken),
        places=cloud.means.numpy(),
        eyes=np.array([view.camera.position for view in taken], np.float64).reshape(-1, 3),
        focal=np.array([view.camera.fx for view in taken], np.float64),
    )


def _lift_view(cloud: GaussianCloud, view: ViewMasks) -> tuple[csr_matrix, csr_matrix]:
    """`weights` `[N, M]` and `seen` `[N, 1]` of one view."""
    cell, inside = view.cells
    shares = split(cloud, view.camera, cell)
    by_cell = csr_matrix((shares.weights, (shares.rows, shares.labels)), shape=(len(cloud), len(inside)))
    cells, layers = np.nonzero(inside >= 0)
    pairs = np.unique(np.stack([cells, inside[cells, layers]], axis=1), axis=0)  # a mask in several layers counts once
    member = csr_matrix((np.ones(len(pairs), np.float32), (pairs[:, 0], pairs[:, 1])), shape=(len(inside), len(view)))
    whole = csr_matrix(by_cell.sum(axis=1).astype(np.float32))
    return csr_matrix(by_cell @ member, dtype=np.float32), whole


def _side_by_side(parts: list[csr_matrix], count: int) -> csr_matrix:
    """The columns `[count, …]` float32 of some matrices beside each other. The list is emptied on the way, so that its
    matrices are not held twice."""
    lengths = sum((np.diff(part.indptr) for part in parts), np.zeros(count, np.int64))
    starts = np.concatenate([[0], np.cumsum(lengths)])
    columns = np.empty(int(starts[-1]), np.int32)
    values = np.empty(len(columns), np.float32)
    place, width = starts[:-1].copy(), 0
    parts.reverse()
    while parts:
        part = parts.pop()
        own = np.diff(part.indptr)
        at = np.repeat(place - part.indptr[:-1], own) + np.arange(len(part.indices))
        columns[at], values[at] = part.indices + width, part.data
        place += own
        width += part.shape[1]
    return csr_matrix((values, columns, starts), shape=(count, width))


def _vectors(views: list[ViewMasks]) -> F32 | None:
    given = [v.vectors for v in views if v.vectors is not None]
    if not given:
        return None
    if len({v.shape[1] for v in given}) > 1:
        raise UserError(f"masks have vectors of different widths: {sorted({v.shape[1] for v in given})}")
    if any(v.vectors is None and len(v) for v in views):
        raise UserError("some views' masks have vectors and others' have none; give all or none")
    return np.concatenate(given)

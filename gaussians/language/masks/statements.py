"""What the masks of one source say about pairs of regions: together in one mask, in different ones, or one in none.

Two regions that every mask of a view contains or leaves out alike are one thing to that view, two that share no mask
are two things, and a hierarchy of masks lies between: the finer the mask that joins two regions, the larger the share
of their masks that they have in common. So one number tells of flat masks and of layers of masks, the Jaccard index of
the masks of both regions. A view that covers neither region says nothing about them.

All counts are bilinear in the regions, so those of merged regions are sums over the regions merged.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from .lifting import Lifted

F32 = NDArray[np.float32]
I64 = NDArray[np.int64]

UNDECIDED = 0.3  # share of a region in a mask up to which it is outside, and from one minus which it is inside
CLEAR = 0.5  # of the best view's share of a region's surface, below which a view sees it through something else
HALF_SEEN = 4.0  # pixels of blending weight at which a view's word on a region counts for half


@dataclass(frozen=True)
class Counts:
    """Sums over views about some pairs of regions; arrays of one shape.

    Attributes:
        common: masks that contain both.
        either: masks that contain at least one of them, the common ones counted once.
        alone: of these, masks of one region where the other is in no mask of the view.
        views: views that see both and cover at least one of them, each times the share of views that cover it: a mask
            that other views do not confirm is chance.
    """

    common: F32
    either: F32
    alone: F32
    views: F32

    def at(self, index: Any) -> Counts:
        """The counts at some places of the arrays."""
        return Counts(*(getattr(self, f.name)[index] for f in fields(self)))


@dataclass(frozen=True, eq=False)
class Cover:
    """R regions in the masks of one source.

    Attributes:
        inside: `[R, M]` sparse: share of a region, as its view sees it, inside a mask; times `seen`.
        depth: `[R, V]` number of masks over a region in a view, times `seen`.
        covered: `[R, V]` share of a region in any mask of a view, times `seen`.
        confirmed: `[R, V]` the same times the share of the views of the region that cover it.
        seen: `[R, V]` in [0, 1], how well a view sees a region.
        view: `[M]` view of each mask.
    """

    inside: csr_matrix
    depth: F32
    covered: F32
    confirmed: F32
    seen: F32
    view: NDArray[np.int32]

    def rows(self, regions: I64) -> Cover:
        """Some of the regions."""
        return replace(
            self,
            inside=self.inside[regions],
            depth=self.depth[regions],
            covered=self.covered[regions],
            confirmed=self.confirmed[regions],
            seen=self.seen[regions],
        )

    def between(self, first: I64, second: I64) -> Counts:
        """Counts `[E]` of pairs of regions."""
        common = np.asarray(self.inside[first].multiply(self.inside[second]).sum(axis=1), np.float32).ravel()
        d, c, k, s = ((a[first], a[second]) for a in (self.depth, self.covered, self.confirmed, self.seen))

        def both(a: F32, b: F32) -> F32:
            return np.einsum("ev,ev->e", a, b)

        return Counts(
            common,
            both(d[0], s[1]) + both(s[0], d[1]) - common,
            both(d[0], s[1] - c[1]) + both(s[0] - c[0], d[1]),
            both(k[0], s[1]) + both(s[0], k[1]) - both(k[0], k[1]),
        )

    def of_all(self) -> Counts:
        """Counts `[R, R]` of all pairs."""
        common = (self.inside @ self.inside.T).toarray().astype(np.float32)
        depth, confirmed = self.depth @ self.seen.T, self.confirmed @ self.seen.T
        alone = self.depth @ (self.seen - self.covered).T
        views = confirmed + confirmed.T - self.confirmed @ self.confirmed.T
        return Counts(common, depth + depth.T - common, alone + alone.T, views)

    def by_view(self, first: I64, second: I64) -> tuple[F32, F32]:
        """The Jaccard index `[E, V]` of pairs of regions in each view, and the weight of its word."""
        products = self.inside[first].multiply(self.inside[second]).tocsc()
        views = csr_matrix(
            (np.ones(len(self.view), np.float32), (np.arange(len(self.view)), self.view)),
            shape=(len(self.view), self.seen.shape[1]),
        )
        common = (products @ views).toarray()
        d, k, s = ((a[first], a[second]) for a in (self.depth, self.confirmed, self.seen))
        either = d[0] * s[1] + s[0] * d[1] - common
        weight = k[0] * s[1] + s[0] * k[1] - k[0] * k[1]
        return common / np.maximum(either, 1e-9), weight


def decided(share: F32) -> F32:
    """Shares pushed to 0 and 1: a mask that overlaps the rim of a region says nothing about the region."""
    return np.clip((share - UNDECIDED) / (1 - 2 * UNDECIDED), 0, 1)


def cover(lifted: Lifted, labels: NDArray[np.int32], count: int) -> Cover:
    """The regions of some points in the masks of one source.

    Args:
        lifted: masks lifted to the points.
        labels: `[P]` region of each point, in 0..count.
    """
    points = len(labels)
    sums = csr_matrix((np.ones(points, np.float32), (labels, np.arange(points))), shape=(count, points))
    whole = np.asarray((sums @ lifted.seen).todense(), dtype=np.float32)
    inside = (sums @ lifted.weights).tocsr()
    rows = np.repeat(np.arange(count), np.diff(inside.indptr))
    views = lifted.view[inside.indices]
    share = inside.data / np.maximum(whole[rows, views], 1e-9)
    masked = np.zeros_like(whole)
    np.add.at(masked, (rows, views), share)
    seen = _clearness(lifted, sums, whole) * whole / (whole + HALF_SEEN)
    seen *= np.abs(2 * np.minimum(masked, 1) - 1)  # half in masks is neither in nor out
    share = decided(share) * seen[rows, views]
    inside = csr_matrix((share.astype(np.float32), inside.indices, inside.indptr), shape=inside.shape)
    depth = np.zeros_like(seen)
    np.add.at(depth, (rows, views), inside.data)
    covered = np.minimum(depth, seen)
    confirmed = covered * (covered.sum(axis=1) / np.maximum(seen.sum(axis=1), 1e-9))[:, None]
    return Cover(inside, depth, covered, confirmed, seen, lifted.view)


def _clearness(lifted: Lifted, sums: csr_matrix, whole: F32) -> F32:
    """How clearly each view sees each region `[R, V]`, in [0, 1].

    A view that looks through foliage or a thin wall sees less of a region than others do at the same distance, and its
    masks are of what stands before it.
    """
    count = np.maximum(np.asarray(sums.sum(axis=1)), 1)
    middle = (sums @ lifted.places) / count
    distance = ((middle[:, None] - lifted.eyes[None]) ** 2).sum(axis=2)
    share = whole * distance / lifted.focal**2
    best = np.maximum(share.max(axis=1, initial=0, keepdims=True), 1e-12)
    clear: F32 = np.minimum(share / (CLEAR * best), 1).astype(np.float32)
    return clear

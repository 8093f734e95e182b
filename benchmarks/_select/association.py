"""Associate masks across views: cluster masks of one object into a track and find the Gaussians that it contains.

The similarity of two masks is their intersection over union on the Gaussians that both views see. Masks are clustered
agglomeratively, the most similar first. A track that too few of the views of its place confirm is discarded, and so is
a label that too few of them give. The view consensus rate is that of MaskClustering (Yan et al., CVPR 2024), with
blending weights instead of point clouds. It is the baseline that benchmarks compare with.
"""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix, diags

from ...gaussians.language.masks.lifting import Lifted

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

INSIDE = 0.5  # share of its weight in a view, or in a track's views, from which a Gaussian is inside a mask or track
MIN_SEEN = 0.05  # pixels of blending weight from which a view sees a Gaussian
MIN_COMMON = 0.3  # share of either mask that the other's view must see for the two to be compared
JOIN_IOU = 0.5  # intersection over union, among the Gaussians both see, from which two tracks are joined
DIFFERENCE_PENALTY = 0.15  # of the intersection, for masks with different labels or orthogonal vectors
JOIN_CONTAINED = 0.5  # share of a track inside another of the same label from which they are two ends of one object
MIN_CONSENSUS = 0.2  # share of the views that see a track's place which must have a mask of it
MIN_LABEL_SHARE = 1 / 3  # share of those views which must give its label
CONTAINED = 0.8  # share of a track inside a larger one from which it is a part, or an object in front of the other


@dataclass(frozen=True)
class Track:
    """The masks of one object.

    Attributes:
        masks: indices into the lifted masks, ascending.
        views: number of views that have a mask of it.
        visible_in: number of views that see at least half of it.
        label: the label with the most votes of its masks, weighted by their scores; "" if too few views give it.
        votes: each label that its masks give with the sum of their scores, highest first.
        vector: `[D]` unit mean of its masks' vectors, weighted by score and pixels; None if they have none.
        parent: the track it is a part of, -1 for an object.
    """

    masks: tuple[int, ...]
    views: int
    visible_in: int
    label: str
    votes: tuple[tuple[str, float], ...]
    vector: F32 | None
    parent: int = -1


@dataclass(frozen=True, eq=False)
class Tracks:
    """K tracks over N Gaussians.

    Attributes:
        tracks: the tracks kept, most masks first.
        share: `[N, K]` sparse: share of a Gaussian's blending weight in a track's views that lies in its masks.
        votes: `[N, K]` sparse: sum of the scores of the masks a Gaussian lies in, each times its share in the mask.
        seen: `[N]` float32, blending weight of the Gaussian over all views; where it is 0, masks carry no information.
        discarded: number of tracks that too few views confirm.
    """

    tracks: tuple[Track, ...]
    share: csr_matrix
    votes: csr_matrix
    seen: F32
    discarded: int


def associate(lifted: Lifted) -> Tracks:
    """The tracks of the lifted masks that enough views confirm. The cost is quadratic in the number of masks."""
    evidence = _Evidence(lifted)
    joined = _join_named(lifted, evidence, _join_similar(evidence.overlap, evidence.union, evidence.likeness))
    least = min(2, len(evidence.views))
    kept: list[Track] = []
    found: list[tuple[NDArray[np.int64], F64, F64]] = []
    for masks in sorted(joined, key=lambda m: (-len(m), m)):
        views = len(np.unique(lifted.view[masks]))
        if views < least:
            continue
        rows, share, vote = evidence.membership(masks)
        inside = rows[share > INSIDE]
        visible_in = max(views, evidence.visible_in(inside))
        if views >= MIN_CONSENSUS * visible_in and len(inside):
            kept.append(_track(lifted, masks, visible_in, evidence.weight))
            found.append((rows, share, vote))
    count = lifted.weights.shape[0]
    whole = _table([(rows, share) for rows, share, _ in found], count)
    said = _table([(rows, vote) for rows, _, vote in found], count)
    seen = np.asarray(lifted.seen.sum(axis=1), dtype=np.float32).ravel()
    return Tracks(_with_parents(kept, whole, evidence.mass), whole, said, seen, len(joined) - len(kept))


class _Evidence:
    """Pairwise comparison of masks.

    Attributes:
        mass: `[N]` mean blending weight in the views that see a Gaussian: its size in the image.
        weight: `[M]` blending weight of each mask.
        overlap, union: `[M, M]` float32 mass among the Gaussians both masks' views see; zero where not comparable.
        likeness: `[M, M]` 1 where labels and vectors agree or are missing, less where they differ.
        left: `[M, M]` mass of a mask that another's view sees; zero where not comparable.
    """

    def __init__(self, lifted: Lifted) -> None:
        self.lifted = lifted
        self.views = np.unique(lifted.view)
        masks = lifted.weights.tocsc()
        self._starts, self._rows, self._weights = masks.indptr, masks.indices, masks.data
        self._masks = np.repeat(np.arange(len(lifted.labels)), np.diff(masks.indptr))
        seen = _seen_at(lifted, self._rows, lifted.view[self._masks])
        self._shares = np.minimum(self._weights / np.maximum(seen, 1e-12), 1.0)
        self._visible = (lifted.seen > MIN_SEEN).astype(np.float32).tocsr()
        often = np.asarray(self._visible.sum(axis=1)).ravel()
        whole = np.asarray(lifted.seen.multiply(self._visible).sum(axis=1)).ravel()
        self.mass: F32 = (whole / np.maximum(often, 1)).astype(np.float32)
        self.weight: F64 = np.bincount(self._masks, self._weights, len(lifted.labels)).astype(np.float64)
        held = (self._shares >= INSIDE) & (seen > MIN_SEEN)
        inside = csr_matrix(
            (np.ones(int(held.sum()), np.float32), (self._rows[held], self._masks[held])), shape=lifted.weights.shape
        )
        weighed = diags(self.mass) @ inside
        overlap: F32 = (inside.T @ weighed).toarray()
        left: F32 = (weighed.T @ self._visible).toarray()[:, lifted.view]
        size = np.diag(overlap)
        comparable = (left >= MIN_COMMON * size[:, None]) | (MIN_COMMON * size[None, :] <= left.T)
        comparable &= (size[:, None] > 0) & (size[None, :] > 0)
        np.fill_diagonal(comparable, False)
        self.left = np.where(comparable, left, 0)
        self.overlap = np.where(comparable, overlap, 0)
        self.union = self.left + self.left.T - self.overlap

    @cached_property
    def likeness(self) -> F32:
        names = np.unique(self.lifted.labels, return_inverse=True)[1]
        known = np.array([bool(label) for label in self.lifted.labels], dtype=bool)
        unlike = ((names[:, None] != names[None, :]) & known[:, None] & known[None, :]).astype(np.float32)
        if self.lifted.vectors is not None:
            unlike = np.maximum(unlike, np.clip(1 - self.lifted.vectors @ self.lifted.vectors.T, 0, 1))
        return 1 - DIFFERENCE_PENALTY * unlike

    def membership(self, masks: Sequence[int]) -> tuple[NDArray[np.int64], F64, F64]:
        """The Gaussians in any mask of a track, ascending, with their share and votes, `[R]` each."""
        entries = np.concatenate([np.arange(self._starts[m], self._starts[m + 1]) for m in masks])
        rows, at = np.unique(self._rows[entries], return_inverse=True)
        within = np.bincount(at, weights=self._weights[entries], minlength=len(rows))
        said = self._shares[entries] * self.lifted.scores[self._masks[entries]]
        votes: F64 = np.bincount(at, weights=said, minlength=len(rows)).astype(np.float64)
        looked = np.zeros(self.lifted.seen.shape[1])
        looked[self.lifted.view[list(masks)]] = 1
        whole = np.asarray(self.lifted.seen[rows] @ looked).ravel()
        share: F64 = np.where(whole > MIN_SEEN, np.minimum(within / np.maximum(whole, 1e-12), 1), 0.0)
        return rows.astype(np.int64), share, votes

    def visible_in(self, rows: NDArray[np.int64]) -> int:
        """Number of views that see at least half of some Gaussians, by mass."""
        seen = np.asarray(self._visible[rows].T @ self.mass[rows]).ravel()
        return int((seen > 0.5 * self.mass[rows].sum()).sum())


def _seen_at(lifted: Lifted, rows: NDArray[np.int32], views: NDArray[np.int32]) -> F32:
    """Blending weight `[E]` of Gaussian `rows[e]` in view `views[e]`; `views` ascend."""
    whole = lifted.seen.tocsc()
    ends = np.searchsorted(views, np.arange(whole.shape[1] + 1))
    found, column = np.zeros(len(rows), np.float32), np.zeros(whole.shape[0], np.float32)
    for v in range(whole.shape[1]):
        held = slice(whole.indptr[v], whole.indptr[v + 1])
        column[whole.indices[held]] = whole.data[held]
        found[ends[v] : ends[v + 1]] = column[rows[ends[v] : ends[v + 1]]]
        column[whole.indices[held]] = 0
    return found


def _table(columns: Sequence[tuple[NDArray[np.int64], F64]], count: int) -> csr_matrix:
    """Sparse matrix `[count, K]` from the rows and values of each column."""
    if not columns:
        return csr_matrix((count, 0), dtype=np.float32)
    rows, values = (np.concatenate([c[i] for c in columns]) for i in (0, 1))
    place = np.repeat(np.arange(len(columns)), [len(c[0]) for c in columns])
    return csr_matrix((values.astype(np.float32), (rows, place)), shape=(count, len(columns)))


def _join_similar(overlap: F32, union: F32, likeness: F32) -> list[list[int]]:
    """Join the two most similar tracks until no two reach JOIN_IOU. The similarity of tracks is summed over all pairs
    of their masks, so that one wrong mask cannot chain two objects."""
    shared, whole = (overlap * likeness).astype(np.float64), union.astype(np.float64)
    members = {i: [i] for i in range(len(shared))}
    version = np.zeros(len(shared), np.int64)
    first, second = np.nonzero(np.triu(shared >= JOIN_IOU * np.maximum(whole, 1e-9), 1))
    heap = [(-shared[i, j] / whole[i, j], i, j, 0, 0) for i, j in zip(first.tolist(), second.tolist(), strict=True)]
    heapq.heapify(heap)
    while heap:
        _, i, j, at_i, at_j = heapq.heappop(heap)
        if i not in members or j not in members or (version[i], version[j]) != (at_i, at_j):
            continue
        members[i] += members.pop(j)
        version[i] += 1
        for table in (shared, whole):
            table[i] += table[j]
            table[:, i] = table[i]
            table[j] = table[:, j] = table[i, i] = 0
        for k in np.flatnonzero(shared[i] >= JOIN_IOU * np.maximum(whole[i], 1e-9)).tolist():
            a, b = min(i, k), max(i, k)
            heapq.heappush(heap, (-shared[i, k] / whole[i, k], a, b, int(version[a]), int(version[b])))
    return [sorted(m) for m in members.values()]


def _join_named(lifted: Lifted, evidence: _Evidence, tracks: list[list[int]]) -> list[list[int]]:
    """Join tracks of one label where the smaller lies mostly in the larger: views of different ends of one object."""
    names = [_top_label(lifted, masks) for masks in tracks]
    order = sorted(range(len(tracks)), key=lambda t: (-len(tracks[t]), tracks[t]))
    joined: list[list[int]] = []
    for t in order:
        home = next(
            (h for h in joined if names[t] and _top_label(lifted, h) == names[t] and _within(evidence, tracks[t], h)),
            None,
        )
        if home is None:
            joined.append(list(tracks[t]))
        else:
            home.extend(tracks[t])
    return [sorted(m) for m in joined]


def _within(evidence: _Evidence, small: Sequence[int], large: Sequence[int]) -> bool:
    pair = np.ix_(small, large)
    views = evidence.lifted.view
    if set(views[list(small)].tolist()) & set(views[list(large)].tolist()):
        return False  # a view with a mask of each shows two objects
    return bool(evidence.overlap[pair].sum() >= JOIN_CONTAINED * max(float(evidence.left[pair].sum()), 1e-9))


def _top_label(lifted: Lifted, masks: Sequence[int]) -> str:
    return next((name for name, _ in _votes(lifted, masks)), "")


def _votes(lifted: Lifted, masks: Sequence[int]) -> tuple[tuple[str, float], ...]:
    """The labels of some masks with the sum of their scores, highest first."""
    votes: dict[str, float] = {}
    for m in masks:
        if lifted.labels[m]:
            votes[lifted.labels[m]] = votes.get(lifted.labels[m], 0.0) + float(lifted.scores[m])
    return tuple(sorted(votes.items(), key=lambda vote: (-vote[1], vote[0])))


def _track(lifted: Lifted, masks: Sequence[int], visible_in: int, weight: F64) -> Track:
    """A track with the label and vector that its masks give."""
    votes = _votes(lifted, masks)
    name = votes[0][0] if votes else ""
    views = len({int(lifted.view[m]) for m in masks})
    naming = len({int(lifted.view[m]) for m in masks if lifted.labels[m] == name})
    label = name if name and naming >= MIN_LABEL_SHARE * visible_in else ""
    return Track(tuple(masks), views, visible_in, label, votes, _mean_vector(lifted, list(masks), weight))


def _mean_vector(lifted: Lifted, masks: list[int], weight: F64) -> F32 | None:
    if lifted.vectors is None:
        return None
    mean = (lifted.scores[masks] * weight[masks]) @ lifted.vectors[masks].astype(np.float64)
    norm = float(np.linalg.norm(mean))
    return (mean / norm).astype(np.float32) if norm > 1e-12 else None


def _with_parents(tracks: Sequence[Track], share: csr_matrix, mass: F32) -> tuple[Track, ...]:
    """The tracks with parents set: a part lies in a larger track and has no label of its own."""
    held = (share > INSIDE).astype(np.float32)
    common: F32 = (held.T @ diags(mass) @ held).toarray()
    size = np.diag(common)
    made = []
    for i, track in enumerate(tracks):
        around = [
            j
            for j, other in enumerate(tracks)
            if size[i] < CONTAINED * size[j]
            and common[i, j] >= CONTAINED * size[i]
            and (not track.label or track.label == other.label)
        ]
        outer = max(around, key=lambda j: (size[j], -j), default=-1)
        made.append(replace(track, parent=outer))
    return tuple(made)

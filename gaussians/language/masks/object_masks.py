"""Which masks show which object: gives objects the labels and vectors of their masks, and masks the Gaussians off the
surface to the objects they show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from .lifting import Lifted

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

MIN_IOU = 0.3  # of a mask and an object as the view sees it, from which the mask is of this object
MIN_LABEL_SHARE = 1 / 3  # of the views that see an object which must give a label
SEEN_SHARE = 0.5  # of what the best view sees of an object, from which another view sees it
MIN_SEEN = 1.0  # pixels of blending weight over all views from which masks decide about a Gaussian


@dataclass(frozen=True)
class Said:
    """What masks say of one object.

    Attributes:
        label: the label with the most votes, "" if too few of the views that see the object give it.
        votes: as `Group.votes`: each label with the sum of its scores over views, highest first, and "" with the views
            that see the object and give it no name; () without labels.
        vector: `[D]` unit mean of the vectors of its masks, weighted by score and agreement; None if they have none.
    """

    label: str
    votes: tuple[tuple[str, float], ...]
    vector: F32 | None


@dataclass(frozen=True, eq=False)
class Matches:
    """The masks of one source and objects.

    Attributes:
        owner: `[M]` the object that each mask agrees with most, -1 for none.
        iou: `[M]` intersection over union with it, of blending weight in the mask's view.
        seen: `[K]` number of views that see each object.
    """

    owner: I32
    iou: F64
    seen: I32


def match(lifted: Lifted, owner: I32, count: int) -> Matches:
    """Match masks with objects.

    Args:
        lifted: masks lifted to P points.
        owner: `[P]` object of each point, -1 for none.
        count: number of objects K.
    """
    rows = np.flatnonzero(owner >= 0)
    sums = csr_matrix((np.ones(len(rows), np.float32), (owner[rows], rows)), shape=(count, len(owner)))
    shared = (sums @ lifted.weights).toarray().astype(np.float64)
    size = (sums @ lifted.seen).toarray().astype(np.float64)
    whole = np.asarray(lifted.weights.sum(axis=0)).ravel()
    iou = shared / np.maximum(size[:, lifted.view] + whole[None] - shared, 1e-9)
    if not count or not iou.size:
        return Matches(
            np.full(len(lifted.labels), -1, np.int32), np.zeros(len(lifted.labels)), np.zeros(count, np.int32)
        )
    best = iou.max(axis=0)
    views = (size >= SEEN_SHARE * np.maximum(size.max(axis=1, keepdims=True), 1e-9)).sum(axis=1)
    return Matches(np.where(best >= MIN_IOU, iou.argmax(axis=0), -1).astype(np.int32), best, views.astype(np.int32))


def said_of(sources: Sequence[Lifted], matches: Sequence[Matches], thing: int) -> Said:
    """What all sources say of one object."""
    heard: dict[tuple[int, int, str], float] = {}  # the best score of each label in each view
    total: F64 | None = None
    seen = 0
    for s, (lifted, found) in enumerate(zip(sources, matches, strict=True)):
        own = np.flatnonzero(found.owner == thing)
        for m in own.tolist():
            if lifted.labels[m]:
                key = (s, int(lifted.view[m]), lifted.labels[m])
                heard[key] = max(heard.get(key, 0.0), float(lifted.scores[m]))
        seen += int(found.seen[thing]) if any(lifted.labels) else 0
        if lifted.vectors is not None and len(own):
            part = (lifted.scores[own] * found.iou[own]) @ lifted.vectors[own].astype(np.float64)
            total = part if total is None else total + part
    votes: dict[str, float] = {}
    for (_, _, name), score in sorted(heard.items()):
        votes[name] = votes.get(name, 0.0) + score
    ranked = sorted(votes.items(), key=lambda vote: (-vote[1], vote[0]))
    first = ranked[0][0] if ranked else ""
    naming = sum(name == first for _, _, name in heard)
    silent = max(seen - sum(votes.values()), 0.0)
    norm = 0.0 if total is None else float(np.linalg.norm(total))
    return Said(
        first if naming >= MIN_LABEL_SHARE * seen else "",
        (*ranked, ("", silent)) if ranked else (),
        None if total is None or norm < 1e-12 else (total / norm).astype(np.float32),
    )


def voted_objects(sources: Sequence[Lifted], matches: Sequence[Matches], count: int) -> I32:
    """The object with the most blending weight in its masks for each Gaussian `[N]`: at least half of what
    views see of it; -1 for none.

    Args:
        sources: masks lifted to all Gaussians.
    """
    best = np.zeros(sources[0].seen.shape[0], np.float32)
    chosen = np.full(len(best), -1, np.int32)
    seen = sum((np.asarray(one.seen.sum(axis=1)).ravel() for one in sources), np.zeros(len(best)))
    total = csr_matrix((len(best), count), dtype=np.float32)
    for lifted, found in zip(sources, matches, strict=True):
        good = np.flatnonzero(found.owner >= 0)
        places = (good, found.owner[good])
        total = total + lifted.weights @ csr_matrix((np.ones(len(good), np.float32), places), (len(found.owner), count))
    rows = np.repeat(np.arange(len(best)), np.diff(total.indptr))
    order = np.lexsort((-total.indices, total.data, rows))  # the last of each row: most votes, then the smaller number
    last = order[np.r_[np.diff(rows[order]) > 0, True]] if len(order) else order
    best[rows[last]], chosen[rows[last]] = total.data[last], total.indices[last]
    return np.where((seen > MIN_SEEN) & (best > 0.5 * seen), chosen, -1).astype(np.int32)

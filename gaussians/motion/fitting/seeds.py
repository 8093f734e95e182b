"""Which Gaussians of the scene at its start move (`seeds`): those whose pixels change in every picture that shows them.

A pixel also changes where something arrives. What is only covered for a while is told apart later, since no path of it
explains a picture.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ...camera import Camera
from ...harmonics import SH_C0
from ...render.cpu import gradient
from .bodies import Columns
from .footage import Footage

F32 = NDArray[np.float32]
Flags = NDArray[np.bool_]

SEEN = 0.2  # of the largest weight of a Gaussian in any picture, from which a picture counts as showing it
GONE = 0.75  # share of a Gaussian's weight on changed pixels, over the pictures that show it, from which it is gone
PARTLY = 0.3  # the same of what may bend with others that are gone
FAINT = 0.15  # opacity below which a Gaussian says nothing
ALIKE = 0.8  # overlap of the times at which two neighbours are gone, from which they are of one thing
NEAR = 5.0  # pixels, at the distance of the cameras' radius: as near are Gaussians that touch
BRIEF = 0.15  # share of the times: what one camera sees gone for less is taken to be covered
LEAST = 12  # Gaussians of the smallest thing


def weights(columns: Columns, camera: Camera, masks: Sequence[Flags | F32]) -> F32:
    """`[N, M]` blending weight of each Gaussian within masks `[H, W]` of a picture, pixels."""
    plain = (*columns[:4], np.zeros_like(columns[4][:, :1]))  # gray, so that no colour is clipped
    drawn = gradient.draw(plain, camera, (0.0, 0.0, 0.0))
    found = []
    for k in range(0, len(masks), 3):
        slope = np.zeros((camera.height, camera.width, 3), np.float32)
        for channel, mask in enumerate(masks[k : k + 3]):
            slope[..., channel] = mask
        back = gradient.draw_backward(drawn, slope, np.zeros(slope.shape[:2], np.float32))
        found.append(back.sh[:, 0, : len(masks[k : k + 3])] / np.float32(SH_C0))
    return np.concatenate(found, axis=1)


def gone(columns: Columns, footage: Footage, share: float = GONE) -> Flags:
    """`[N, T]` whether each Gaussian of the start is gone at each time: hidden or elsewhere.

    Args:
        share: of its weight that is on changed pixels then.
    """
    count, times = len(columns[0]), len(footage.times)
    total, changed, known = np.zeros((3, count, times), np.float32)
    each, most = [], np.zeros(count, np.float32)
    for c, camera in enumerate(footage.cameras):
        own = [t for t in range(times) if (c, t) in footage.frames]
        everything = np.ones((camera.height, camera.width), bool)
        masks = [footage.moved(c, t) for t in own]
        found = weights(columns, camera, [everything, *masks])
        each.append((own, found))
        most = np.maximum(most, found[:, 0])
    for own, found in each:
        shows = np.where(found[:, 0] >= SEEN * np.maximum(most, 1e-6), found[:, 0], 0)
        total[:, own] += shows[:, None]
        changed[:, own] += np.where(shows[:, None] > 0, found[:, 1:], 0)
        known[:, own] += shows[:, None] > 0
    opaque = (columns[3] > FAINT) & (most > 0.02)
    flags: Flags = np.asarray(opaque[:, None] & (known > 0) & (changed > share * total))
    if footage.at_first:  # one picture a time does not show all sides: they are as they were when they were seen last
        last = np.maximum.accumulate(np.where(known > 0, np.arange(times), 0), axis=1)
        flags = np.take_along_axis(flags, last, axis=1)
    return flags


def reach(footage: Footage) -> float:
    """How near Gaussians are that touch, scene units."""
    return NEAR * footage.radius / footage.cameras[0].fx


def together(pairs: NDArray[np.integer], count: int) -> NDArray[np.int32]:
    """`[count]` the number of the part that each is of, where pairs `[P, 2]` are of one part."""
    graph = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1])


def seeds(columns: Columns, footage: Footage, flags: Flags) -> list[NDArray[np.int64]]:
    """Rows of the start that may be of one moving thing each, the most evident first.

    Args:
        flags: what `gone` found.
    """
    least = min(2, len(footage.times) - 1)
    if footage.at_first:
        least = max(least, round(BRIEF * len(footage.times)))
    rows = np.flatnonzero(flags.sum(axis=1) >= least)
    if len(rows) < LEAST:
        return []
    means, own = columns[0][rows], flags[rows].astype(np.float32)
    pairs = cKDTree(means).query_pairs(reach(footage), output_type="ndarray")
    both = (own[pairs[:, 0]] * own[pairs[:, 1]]).sum(axis=1)
    either = np.maximum(own[pairs[:, 0]], own[pairs[:, 1]]).sum(axis=1)
    pairs = pairs[both >= ALIKE * either]
    labels = together(pairs, len(rows))
    found = [rows[labels == k] for k in np.flatnonzero(np.bincount(labels) >= LEAST)]
    return sorted(found, key=lambda r: -float(flags[r].sum()))


def changing_partly(columns: Columns, footage: Footage) -> NDArray[np.bool_]:
    """`[N]` Gaussians of which a part changes now and then."""
    return np.asarray(gone(columns, footage, PARTLY).sum(axis=1) >= 2)


def around(
    columns: Columns, footage: Footage, rows: NDArray[np.int64], partly: NDArray[np.bool_]
) -> NDArray[np.int64]:  # fmt: skip
    """Rows, and those beside them of which a part changes (`partly`), from one to the next, with all that touches
    these: what bends hardly changes where it is fastened, and within an even colour."""
    own = np.zeros(len(columns[0]), bool)
    own[rows] = True
    some = np.flatnonzero(own | partly)
    means = columns[0]
    pairs = cKDTree(means[some]).query_pairs(reach(footage), output_type="ndarray")
    labels = together(pairs, len(some))
    joined = some[np.isin(labels, labels[own[some]])]
    away, _ = cKDTree(means[joined]).query(means, distance_upper_bound=reach(footage))
    return np.flatnonzero((np.isfinite(away) & (columns[3] > FAINT)) | own)


def halves(rows: NDArray[np.int64], flags: Flags) -> list[NDArray[np.int64]]:
    """The rows in two parts by the times at which they are gone: what moves, and what it covers meanwhile; none if they
    are all alike or a part would be too small."""
    own = flags[rows].astype(np.float32)
    counts = own.sum(axis=1)
    middles = np.stack(
        [own[counts <= np.quantile(counts, 0.3)].mean(axis=0), own[counts >= np.quantile(counts, 0.7)].mean(axis=0)]
    )
    nearer = np.zeros(len(rows), np.int64)
    for _ in range(10):
        nearer = np.abs(own[:, None] - middles).sum(axis=2).argmin(axis=1)
        if min(np.bincount(nearer, minlength=2)) < LEAST:
            return []
        middles = np.stack([own[nearer == k].mean(axis=0) for k in (0, 1)])
    return [rows[nearer == k] for k in (1, 0)]

"""Points where pictures show something that no chosen point covers (`uncovered`)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ...camera import Camera
from .stereo import AGREE, Points

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

WIDEST = 13  # pixels, the side of what a point covers at most
DARK = 0.02  # colour up to which what no other picture confirms adds nothing: where nothing is drawn, it is black


def uncovered(found: Points, cameras: Sequence[Camera], chosen: I64, width: float, block: int) -> I64:
    """Rows of points to add, picture after picture: the most confirmed point of each block of pixels that no point
    covers so far, unless more pictures look through it than confirm it.

    Args:
        found: points of all pixels of the cameras' pictures, in their order.
        chosen: rows of the points there are.
        width: of each of them, scene units; what is added is as wide as its block.
        block: pixels, the side.
    """
    wrong = (found.denied > found.agreed) | ((found.agreed == 0) & (found.colors.max(axis=1) < DARK))
    scores = np.where(wrong, -1, found.agreed)
    widths, rows, start = np.full(len(chosen), width), chosen, 0
    for camera in cameras:
        pixels = slice(start, start + camera.height * camera.width)
        depth = found.depths[pixels].reshape(camera.height, camera.width)
        best = _best(scores[pixels].reshape(depth.shape), block)
        best = best[~_covered(found.means[rows], widths, camera, depth).reshape(-1)[best]] + start
        best = best[scores[best] >= 0]
        rows, widths = np.concatenate([rows, best]), np.concatenate([widths, block * found.sizes[best]])
        start = pixels.stop
    return rows[len(chosen) :]


def _best(scores: I64, block: int) -> I64:
    """The pixel of the highest score in each block of a picture, as its index; of equals, the nearest to the middle."""
    y, x = (a.reshape(-1) for a in np.indices(scores.shape))
    middle = (block - 1) / 2
    off = np.abs(y % block - middle) + np.abs(x % block - middle)
    blocks = y // block * scores.shape[1] + x // block
    order = np.lexsort((off, -scores.reshape(-1), blocks))
    return order[np.flatnonzero(np.diff(blocks[order], prepend=-1))]


def _covered(means: F64, widths: F64, camera: Camera, depth: F64) -> NDArray[np.bool_]:
    """`[H, W]` whether a point is seen there: a square of its width around it, where its depth is that of the pixel."""
    pixels, z = camera.project(means)
    inside = np.flatnonzero(camera.contains(pixels, z))
    x, y = pixels[inside].astype(np.int64).T
    seen = np.abs(depth[y, x] - z[inside]) < AGREE * z[inside]
    x, y, inside = x[seen], y[seen], inside[seen]
    sides = 2 * np.round(0.5 * widths[inside] * camera.fx / z[inside]).astype(np.int64) + 1
    sides = np.clip(sides, 3, WIDEST)
    found = np.zeros(depth.shape, bool)
    for side in np.unique(sides):
        own = np.zeros(depth.shape, bool)
        own[y[sides == side], x[sides == side]] = True
        found |= ndimage.maximum_filter(own, side)
    return found

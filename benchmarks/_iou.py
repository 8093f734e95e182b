"""Intersection over union of two selections: of all their Gaussians or only near their borders, in 3D or in pixels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from scipy.spatial import cKDTree

Mask = NDArray[np.bool_]
BORDER = 0.03  # metres from a border within which a Gaussian belongs to it
CONTOUR = 0.02  # of a picture's diagonal, likewise for a pixel: what Cheng et al. 2021 take


def iou(a: Mask, b: Mask) -> float:
    """Intersection over union of two masks `[N]`; 0 if both are empty."""
    return float((a & b).sum()) / max(float((a | b).sum()), 1.0)


def border(mask: Mask, points: NDArray[np.floating], distance: float = BORDER) -> Mask:
    """`[N]`: the members of `mask [N]` that have a non-member within `distance`, among `points [N, 3]`."""
    found = np.zeros(len(mask), bool)
    own = np.flatnonzero(mask)
    if not len(own):
        return found
    low, high = points[own].min(axis=0) - distance, points[own].max(axis=0) + distance
    others = points[~mask & ((points >= low) & (points <= high)).all(axis=1)]
    if len(others):
        gap, _ = cKDTree(others).query(points[own], distance_upper_bound=np.nextafter(distance, np.inf))
        found[own[gap <= distance]] = True
    return found


def border_iou(truth: Mask, found: Mask, points: NDArray[np.floating], distance: float = BORDER) -> float | None:
    """Boundary IoU (Cheng et al. 2021) in 3D: the IoU of the two masks' borders.

    None if the true object touches nothing and so has no border.
    """
    edge = border(truth, points, distance)
    return iou(edge, border(found, points, distance)) if edge.any() else None


def trimap_iou(truth: Mask, found: Mask, points: NDArray[np.floating], distance: float = BORDER) -> float | None:
    """IoU of the two masks among the Gaussians on both sides of the true border only (Kohli et al. 2009's trimap).

    Unlike `border_iou` it does not fall to nothing where one layer of splats wider than `distance` joins an object and
    so moves its border by a whole splat. None where the true object has no border.
    """
    band = border(truth, points, distance) | border(~truth, points, distance)
    return iou(truth & band, found & band) if band.any() else None


def contour(mask: Mask, share: float = CONTOUR) -> Mask:
    """`[H, W]`: the pixels of a silhouette within `share` of the picture's diagonal of its contour; the picture's own
    edge is a contour too."""
    inside = distance_transform_edt(np.pad(mask, 1))[1:-1, 1:-1]
    near: Mask = mask & (inside <= share * np.hypot(*mask.shape))
    return near


def contour_iou(truth: Mask, found: Mask, share: float = CONTOUR) -> float:
    """Boundary IoU of two silhouettes `[H, W]` as Cheng et al. 2021 define it, in pixels."""
    return iou(contour(truth, share), contour(found, share))

"""Cut a hierarchy of regions into layers of masks with scores."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ....camera import Camera
from ..view import ViewMasks
from .hierarchy import Hierarchy
from .watershed import Regions

F64 = NDArray[np.float64]

THRESHOLDS = (0.05, 0.1, 0.2, 0.3, 0.45, 0.6)  # probabilities that a contour is real, at which layers are cut
MAX_MASKS = 160  # in the finest layer


def layers(regions: Regions, hierarchy: Hierarchy, sure: F64, camera: Camera) -> ViewMasks:
    """The layers of regions of a picture, finest first; each layer partitions it and is made of regions of the layer
    before. A region that several layers share is one mask.

    Args:
        sure: `[R - 1]` probability that the contour which each merge of the hierarchy removes is real, ascending.

    Returns:
        Masks without labels. The score of a mask is the probability of the weakest contour around it, 0 where the whole
        picture is one.
    """
    count = hierarchy.count
    merges = np.searchsorted(sure, THRESHOLDS, side="right")
    merges = np.unique(np.clip(merges, max(count - MAX_MASKS, 0), max(count - 1, 0)))
    nodes = np.stack([hierarchy.nodes_after(int(m)) for m in merges]) if count else np.zeros((1, 0), np.int32)
    used, place = np.unique(nodes, return_inverse=True)
    ids = place.reshape(nodes.shape).astype(np.int32)[:, regions.labels]
    above = hierarchy.parent[used].astype(np.int64) - count
    scores = np.where(above >= 0, np.append(sure, 0.0)[np.maximum(above, -1)], 0.0)
    return ViewMasks(camera, ids, ("",) * len(used), scores.astype(np.float32))

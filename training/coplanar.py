"""Fit the rule that decides which superpoints near a plane are floor, wall or ceiling, on furnished rooms.

    python -m scenewright.training.coplanar --rooms 70 --seed 9000

Writes `coplanar.json` beside `coplanar.py`. Every fourth room has a ceiling.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gaussians.assets import furnish
from ..gaussians.language.segmentation import coplanar, planes, structure
from ..gaussians.language.segmentation.settle import settled
from ..gaussians.language.segmentation.superpoints import links_of, superpoints
from ..gaussians.language.segmentation.surface import surface_of
from ..gaussians.scene import Scene
from .rules import Examples, Rooms, command, fit_and_evaluate, joined

STEPS = 3000


def piece_examples(scene: Scene, truth: NDArray[np.int32]) -> Examples:
    """Superpoints near the planes of a room and whether they are structure, with the cost of a mistake by their size.

    Args:
        truth: `[N]` object of each Gaussian, -1 for structure.
    """
    surface = settled(surface_of(scene.cloud), scene.cloud, scene.frame)
    labels = superpoints(surface, links_of(surface))
    flat = planes.level(surface, scene.frame)
    free = (truth[surface.rows] < 0).astype(np.float64)
    total = np.bincount(labels)
    share = np.bincount(labels, weights=free) / np.maximum(total, 1)
    examples = []
    for _, plane in structure.planes_of(surface, flat)[1]:
        if (pieces := structure.superpoints_near(surface, labels, flat, plane)) is not None:
            chosen, features = coplanar.describe(surface, pieces)
            cost = np.sqrt(total[chosen]) * np.abs(share[chosen] - 0.5)
            examples.append(Examples(features, share[chosen] > 0.5, cost))
    return joined(examples)


def fit_rooms(rooms: Rooms, seed: int) -> dict[str, Any]:
    """The table of the rule. A sixth of the rooms is held out for evaluation."""
    return fit_and_evaluate([piece_examples(scene, truth) for scene, truth in rooms], coplanar.FEATURES, seed, STEPS)


if __name__ == "__main__":
    command(coplanar, 70, fit_rooms, lambda seed, number: furnish(seed, ceiling=number % 4 == 3))

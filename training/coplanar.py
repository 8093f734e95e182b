"""Fit the rule that says which pieces near a plane are floor, wall or ceiling, on furnished rooms.

    python -m scenewright.training.coplanar --rooms 70 --seed 9000

Writes `paint.json` beside `paint.py`. Every fourth room has a ceiling.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gaussians.assets import furnish
from ..gaussians.language.segmentation import coplanar, planes, structure
from ..gaussians.language.segmentation.superpoints import links_of, superpoints
from ..gaussians.language.segmentation.surface import surface_of
from ..gaussians.scene import Scene
from .rules import Met, Rooms, command, fit_and_judge, joined

STEPS = 3000


def pieces_met(scene: Scene, truth: NDArray[np.int32]) -> Met:
    """Pieces near the planes of a room with known objects (-1: structure), whether they are structure, and their size
    as the cost of a mistake."""
    surface = surface_of(scene.cloud)
    labels = superpoints(surface, links_of(surface))
    flat = planes.level(surface, scene.frame)
    free = (truth[surface.rows] < 0).astype(np.float64)
    total = np.bincount(labels)
    share = np.bincount(labels, weights=free) / np.maximum(total, 1)
    met = []
    for _, plane in structure.planes_of(surface, flat)[1]:
        if (pieces := structure.superpoints_near(surface, labels, flat, plane)) is not None:
            chosen, features = coplanar.describe(surface, pieces)
            cost = np.sqrt(total[chosen]) * np.abs(share[chosen] - 0.5)
            met.append(Met(features, share[chosen] > 0.5, cost))
    return joined(met)


def fit_rooms(rooms: Rooms, seed: int) -> dict[str, Any]:
    """The table of the rule; a sixth of the rooms is held out and judged."""
    return fit_and_judge([pieces_met(scene, truth) for scene, truth in rooms], coplanar.FEATURES, seed, STEPS)


if __name__ == "__main__":
    command(coplanar, 70, fit_rooms, lambda seed, number: furnish(seed, ceiling=number % 4 == 3))

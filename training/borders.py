"""Fit the rule that draws borders point by point, on furnished rooms cut as well as their superpoints allow.

    python -m scenewright.training.borders --rooms 40 --seed 9000

Writes `borders.json` beside `borders.py`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gaussians.language.segmentation import borders, structure
from ..gaussians.language.segmentation.segment import superpoints_and_structure
from ..gaussians.language.segmentation.superpoints import links_of, touching
from ..gaussians.language.segmentation.surface import surface_of
from ..gaussians.scene import Scene
from .rules import Met, Rooms, command, fit_and_judge, joined

STEPS = 6000
TAKEN = 0.5  # of the pieces of floor that were not recognised, those that went to a thing they touch


def points_met(scene: Scene, truth: NDArray[np.int32], rng: np.random.Generator) -> Met:
    """Points at borders with each thing near them, and whether it is theirs, over the passes that embedding makes."""
    surface = surface_of(scene.cloud)
    links = links_of(surface)
    labels, codes = superpoints_and_structure(surface, links, scene.frame)
    kinds = structure.kind_of(codes)
    owner = _owners(labels, truth[surface.rows], kinds, touching(labels, links), rng)
    wanted = truth[surface.rows] + structure.CEILING  # things are numbered after floor, wall and ceiling
    level = kinds != structure.NONE
    met = []
    for _ in range(2):
        point, thing, nearest, features = borders.describe(surface, labels, owner, level)
        of_thing = np.where(level[labels[nearest]], structure.CEILING - 1, thing)
        same = np.where(thing < 0, wanted[point] == structure.CEILING - 1, of_thing == wanted[point])
        met.append(Met(features, same, np.ones(len(same))))
        keep = same & (rng.random(len(same)) < 0.7)  # the next pass starts nearer to the truth
        labels = labels.copy()
        labels[point[keep]] = labels[nearest[keep]]
    return joined(met)


def _owners(
    labels: NDArray[np.int32], truth: NDArray[np.int32], kinds: NDArray[np.int8], near: dict[int, set[int]],
    rng: np.random.Generator,
) -> NDArray[np.int32]:  # fmt: skip
    """Thing of each superpoint `[S]`: what most of its points are; structure is numbered by its kind less one."""
    many = int(truth.max(initial=-1)) + 2
    counts = np.bincount(labels.astype(np.int64) * many + truth + 1, minlength=len(kinds) * many).reshape(-1, many)
    most = counts.argmax(axis=1) - 1
    owner = np.where(kinds > 0, kinds.astype(np.int64) - 1, np.where(most < 0, -1, most + structure.CEILING))
    for s in np.flatnonzero(owner < 0):
        things = [t for t in sorted(near.get(int(s), ())) if owner[t] >= structure.CEILING]
        if things and rng.random() < TAKEN:
            owner[s] = owner[things[int(rng.integers(len(things)))]]
    return owner.astype(np.int32)


def fit_rooms(rooms: Rooms, seed: int) -> dict[str, Any]:
    """The table of the rule; a sixth of the rooms is held out and judged."""
    rng = np.random.default_rng(seed)
    return fit_and_judge([points_met(scene, truth, rng) for scene, truth in rooms], borders.FEATURES, seed, STEPS)


if __name__ == "__main__":
    command(borders, 40, fit_rooms)

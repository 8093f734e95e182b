"""Fit the rule that refines object borders point by point, on furnished rooms with the best labels of superpoints.

    python -m scenewright.training.borders --rooms 40 --seed 9000

Writes `borders.json` beside `borders.py`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gaussians.language.segmentation import borders, planes, structure
from ..gaussians.language.segmentation.segment import superpoints_and_structure
from ..gaussians.language.segmentation.settle import settled
from ..gaussians.language.segmentation.superpoints import links_of, touching
from ..gaussians.language.segmentation.surface import surface_of
from ..gaussians.scene import Scene
from .rules import Examples, Rooms, command, fit_and_evaluate, joined

STEPS = 6000
ABSORBED = 0.5  # share of the unrecognised pieces of floor that are assigned to an object that they touch


def point_examples(scene: Scene, truth: NDArray[np.int32], rng: np.random.Generator) -> Examples:
    """Points at borders paired with each object near them, and whether they belong to it, over two passes."""
    surface = settled(surface_of(scene.cloud), scene.cloud, scene.frame)
    links = links_of(surface)
    labels, codes = superpoints_and_structure(surface, links, scene.frame)
    kinds = structure.kind_of(codes)
    owner = _owners(labels, truth[surface.rows], kinds, touching(labels, links), rng)
    wanted = truth[surface.rows] + planes.CEILING  # things are numbered after floor, wall and ceiling
    level = kinds != planes.NONE
    examples = []
    for _ in range(2):
        point, thing, nearest, features = borders.describe(surface, labels, owner, level)
        of_thing = np.where(level[labels[nearest]], planes.CEILING - 1, thing)
        same = np.where(thing < 0, wanted[point] == planes.CEILING - 1, of_thing == wanted[point])
        examples.append(Examples(features, same, np.ones(len(same))))
        keep = same & (rng.random(len(same)) < 0.7)  # the next pass starts closer to the true labels
        labels = labels.copy()
        labels[point[keep]] = labels[nearest[keep]]
    return joined(examples)


def _owners(
    labels: NDArray[np.int32], truth: NDArray[np.int32], kinds: NDArray[np.int8], near: dict[int, set[int]],
    rng: np.random.Generator,
) -> NDArray[np.int32]:  # fmt: skip
    """Object of each superpoint `[S]` by majority of its points; structure is numbered by its kind minus one."""
    many = int(truth.max(initial=-1)) + 2
    counts = np.bincount(labels.astype(np.int64) * many + truth + 1, minlength=len(kinds) * many).reshape(-1, many)
    most = counts.argmax(axis=1) - 1
    owner = np.where(kinds > 0, kinds.astype(np.int64) - 1, np.where(most < 0, -1, most + planes.CEILING))
    for s in np.flatnonzero(owner < 0):
        things = [t for t in sorted(near.get(int(s), ())) if owner[t] >= planes.CEILING]
        if things and rng.random() < ABSORBED:
            owner[s] = owner[things[int(rng.integers(len(things)))]]
    return owner.astype(np.int32)


def fit_rooms(rooms: Rooms, seed: int) -> dict[str, Any]:
    """The table of the rule. A sixth of the rooms is held out for evaluation."""
    rng = np.random.default_rng(seed)
    return fit_and_evaluate(
        [point_examples(scene, truth, rng) for scene, truth in rooms], borders.FEATURES, seed, STEPS
    )


if __name__ == "__main__":
    command(borders, 40, fit_rooms)

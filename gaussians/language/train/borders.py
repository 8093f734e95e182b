"""Fit the rule that draws borders point by point, on furnished rooms cut as well as their superpoints allow.

    python -m scenewright.gaussians.language.train.borders --rooms 40 --seed 9000

Writes `borders.json` beside `borders.py`.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...assets import furnish
from ...scene import Scene
from .. import borders, structure
from ..affinity import rule_of
from ..segment import superpoints_and_structure
from ..superpoints import links_of, touching
from ..surface import surface_of
from .affinity import Met, fit, joined, judge

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


def fit_rooms(rooms: Iterable[tuple[Scene, NDArray[np.int32]]], seed: int) -> dict[str, Any]:
    """The table of the rule; a sixth of the rooms is held out and judged."""
    rng = np.random.default_rng(seed)
    met = [points_met(scene, truth, rng) for scene, truth in rooms]
    kept = max(1, len(met) * 5 // 6)
    table = fit(joined(met[:kept]), borders.FEATURES, seed, STEPS)
    held = met[kept:]
    return {**table, "held_out": judge(rule_of(table, borders.FEATURES), joined(held)) if held else {}}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rooms", type=int, default=40)
    parser.add_argument("--seed", type=int, default=9000)
    parser.add_argument("--out", type=Path, default=Path(borders.__file__).with_suffix(".json"))
    args = parser.parse_args()
    rooms = (furnish(args.seed + i) for i in range(args.rooms))
    table = fit_rooms(((r.scene, r.truth.ids.numpy()) for r in rooms), args.seed)
    args.out.write_text(json.dumps(table) + "\n")


if __name__ == "__main__":
    main()

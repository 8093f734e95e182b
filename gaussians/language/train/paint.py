"""Fit the rule that says which pieces near a plane are floor, wall or ceiling, on furnished rooms.

    python -m scenewright.gaussians.language.train.paint --rooms 70 --seed 9000

Writes `paint.json` beside `paint.py`. Every fourth room has a ceiling.
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
from .. import paint, planes, structure
from ..affinity import rule_of
from ..superpoints import links_of, superpoints
from ..surface import surface_of
from .affinity import Met, fit, joined, judge

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
        if (pieces := structure.pieces_of(surface, labels, flat, plane)) is not None:
            chosen, features = paint.describe(surface, pieces)
            cost = np.sqrt(total[chosen]) * np.abs(share[chosen] - 0.5)
            met.append(Met(features, share[chosen] > 0.5, cost))
    return joined(met)


def fit_rooms(rooms: Iterable[tuple[Scene, NDArray[np.int32]]], seed: int) -> dict[str, Any]:
    """The table of the rule; a sixth of the rooms is held out and judged."""
    met = [pieces_met(scene, truth) for scene, truth in rooms]
    kept = max(1, len(met) * 5 // 6)
    table = fit(joined(met[:kept]), paint.FEATURES, seed, STEPS)
    held = met[kept:]
    return {**table, "held_out": judge(rule_of(table, paint.FEATURES), joined(held)) if held else {}}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rooms", type=int, default=70)
    parser.add_argument("--seed", type=int, default=9000)
    parser.add_argument("--out", type=Path, default=Path(paint.__file__).with_suffix(".json"))
    args = parser.parse_args()
    rooms = (furnish(args.seed + i, ceiling=i % 4 == 3) for i in range(args.rooms))
    table = fit_rooms(((r.scene, r.truth.ids.numpy()) for r in rooms), args.seed)
    args.out.write_text(json.dumps(table) + "\n")


if __name__ == "__main__":
    main()

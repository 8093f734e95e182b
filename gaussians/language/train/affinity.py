"""Fit the rule that says whether two touching regions are one thing, on furnished rooms whose objects are known.

    python -m scenewright.gaussians.language.train.affinity --rooms 24 --seed 9000

Writes `affinity.json` beside `regions.py`. A logistic regression by Newton's method over a dozen features of a border;
the borders are those between superpoints and those met while regions grow along the truth.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...assets import furnish
from ...scene import Scene
from .. import regions, structure
from ..embed import split_by
from ..superpoints import links_of, superpoints
from ..surface import surface_of

F64 = NDArray[np.float64]
RIDGE = 1e-3


def borders_of(scene: Scene, truth: NDArray[np.int32], rng: np.random.Generator) -> tuple[F64, NDArray[np.bool_]]:
    """Features `[B, F]` and whether both sides are one object `[B]`, of a scene with known objects (-1: structure)."""
    surface = surface_of(scene.cloud)
    flat = structure.level(surface, scene.frame)
    links = links_of(surface)
    kinds = structure.structures(surface, labels := superpoints(surface, links), scene.frame)
    labels = split_by(labels, kinds)
    count = int(labels.max()) + 1
    kind_of = np.zeros(count, np.int8)
    kind_of[labels] = kinds
    graph = regions.build_graph(labels, flat.points, surface.lab, flat.normals, links, kind_of == structure.NONE)
    owner = {i: _majority(truth[surface.rows[labels == r.members[0]]]) for i, r in graph.regions.items()}
    rows, same = [], []

    def note(i: int, j: int) -> None:
        rows.append(graph.features(i, j))
        same.append(owner[i] == owner[j])

    pairs = [(i, j) for i, near in graph.around.items() for j in near if i < j]
    for i, j in pairs:
        note(i, j)
    new = max(graph.regions, default=-1) + 1
    while pairs := [(i, j) for i, near in graph.around.items() for j in near if i < j and owner[i] == owner[j]]:
        for k in rng.permutation(len(pairs))[: max(1, len(pairs) // 3)]:
            i, j = pairs[k]
            if i not in graph.regions or j not in graph.regions:
                continue
            owner[new] = owner[i]
            graph.merge(i, j, new)
            for other in graph.around[new]:
                note(new, other)
            new += 1
    return np.array(rows).reshape(-1, len(regions.FEATURES)), np.array(same, dtype=bool)


def _majority(owners: NDArray[np.int32]) -> int:
    values, counts = np.unique(owners, return_counts=True)
    return int(values[np.argmax(counts)])


def fit(features: F64, same: NDArray[np.bool_]) -> dict[str, object]:
    """Weights of the rule; both classes count equally, so that the bias does not follow how often each occurs."""
    mean, spread = features.mean(axis=0), features.std(axis=0) + 1e-6
    x = np.concatenate([(features - mean) / spread, np.ones((len(features), 1))], axis=1)
    y = same.astype(np.float64)
    weight = np.where(same, 0.5 / max(same.mean(), 1e-9), 0.5 / max(1 - same.mean(), 1e-9))
    w = np.zeros(x.shape[1])
    for _ in range(40):
        p = 1 / (1 + np.exp(-np.clip(x @ w, -30, 30)))
        gradient = x.T @ (weight * (p - y)) / len(y) + RIDGE * w
        hessian = (x * (weight * p * (1 - p))[:, None]).T @ x / len(y) + RIDGE * np.eye(len(w))
        w = w - np.linalg.solve(hessian, gradient)
    p = 1 / (1 + np.exp(-(x @ w)))
    return {
        "features": list(regions.FEATURES),
        "mean": [round(float(v), 6) for v in mean],
        "spread": [round(float(v), 6) for v in spread],
        "weights": [round(float(v), 6) for v in w[:-1]],
        "bias": round(float(w[-1]), 6),
        "borders": len(y),
        "balanced_accuracy": round(float(((p > 0.5) == same)[same].mean() + ((p > 0.5) == same)[~same].mean()) / 2, 4),
    }


def collect(rooms: Iterable[tuple[Scene, NDArray[np.int32]]], seed: int) -> tuple[F64, NDArray[np.bool_]]:
    """Borders of many rooms."""
    rng = np.random.default_rng(seed)
    parts = [borders_of(scene, truth, rng) for scene, truth in rooms]
    return np.concatenate([p[0] for p in parts]), np.concatenate([p[1] for p in parts])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rooms", type=int, default=24)
    parser.add_argument("--seed", type=int, default=9000)
    parser.add_argument("--out", type=Path, default=Path(regions.__file__).with_name("affinity.json"))
    args = parser.parse_args()
    rooms = (furnish(args.seed + i) for i in range(args.rooms))
    table = fit(*collect(((r.scene, r.truth.ids.numpy()) for r in rooms), args.seed))
    args.out.write_text(json.dumps(table, indent=2) + "\n")


if __name__ == "__main__":
    main()

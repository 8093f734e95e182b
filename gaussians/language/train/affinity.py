"""Fit the rule that says whether two touching regions are one thing, on furnished rooms whose objects are known.

    python -m scenewright.gaussians.language.train.affinity --rooms 24 --seed 9000

Writes `affinity.json` beside `regions.py`. A small network over the features of a
border; the borders are those between superpoints and those met while regions grow along the truth.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from ...assets import furnish
from ...scene import Scene
from .. import regions
from ..segment import graph_of, superpoints_and_structure
from ..superpoints import links_of
from ..surface import surface_of

F64 = NDArray[np.float64]
HIDDEN, STEPS, BATCH = 24, 3000, 2048


def borders_of(scene: Scene, truth: NDArray[np.int32], rng: np.random.Generator) -> tuple[F64, NDArray[np.bool_]]:
    """Features `[B, F]` and whether both sides are one object `[B]`, of a scene with known objects (-1: structure)."""
    surface = surface_of(scene.cloud)
    links = links_of(surface)
    labels, kind_of = superpoints_and_structure(surface, links, scene.frame)
    graph = graph_of(surface, links, labels, kind_of, scene.frame)
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


def fit(features: F64, same: NDArray[np.bool_], seed: int = 0) -> dict[str, object]:
    """The rule; both classes count equally, so that it does not follow how often each occurs. A fifth is held out."""
    torch.manual_seed(seed)
    rng = np.random.default_rng(seed)
    mean, spread = features.mean(axis=0), features.std(axis=0) + 1e-6
    x = torch.from_numpy((features - mean) / spread).float()
    y = torch.from_numpy(same).float()
    weight = torch.where(y > 0, 0.5 / y.mean(), 0.5 / (1 - y.mean()))
    held = torch.from_numpy(np.arange(len(y)) >= 0.8 * len(y))  # the last rooms
    inner, outer = torch.nn.Linear(x.shape[1], HIDDEN), torch.nn.Linear(HIDDEN, 1)
    optimizer = torch.optim.AdamW([*inner.parameters(), *outer.parameters()], lr=5e-3, weight_decay=1e-2)
    rows = np.flatnonzero(~held.numpy())
    for step in range(STEPS):
        for group in optimizer.param_groups:
            group["lr"] = 5e-3 * (1 - step / STEPS)
        pick = torch.from_numpy(rng.choice(rows, BATCH))
        logit = outer(torch.tanh(inner(x[pick]))).squeeze(1)
        loss = torch.nn.functional.binary_cross_entropy_with_logits(logit, y[pick], weight[pick])
        optimizer.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        optimizer.step()
    with torch.no_grad():
        right = (outer(torch.tanh(inner(x))).squeeze(1) > 0) == (y > 0)
    one, other = right[held & (y > 0)].float().mean(), right[held & (y == 0)].float().mean()
    return {
        "features": list(regions.FEATURES),
        "mean": _rounded(mean),
        "spread": _rounded(spread),
        "inner": _rounded(inner.weight.detach().numpy().T),
        "inner_bias": _rounded(inner.bias.detach().numpy()),
        "outer": _rounded(outer.weight.detach().numpy()[0]),
        "outer_bias": round(float(outer.bias), 5),
        "borders": len(y),
        "held_out": {"joined when one thing": round(float(one), 4), "parted when two": round(float(other), 4)},
    }


def _rounded(values: NDArray[np.floating]) -> list[Any]:
    rounded: list[Any] = np.round(values.astype(np.float64), 5).tolist()
    return rounded


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
    args.out.write_text(json.dumps(table) + "\n")


if __name__ == "__main__":
    main()

"""Fit the rule that says whether two touching regions are one thing, on furnished rooms whose objects are known.

    python -m scenewright.gaussians.language.train.affinity --rooms 70 --seed 9000

Writes `affinity.json` beside `affinity.py`. A rule that merges greedily meets borders of its own making, so it is
fitted in rounds: each walks the rooms in the order of the rule so far, sometimes into its mistakes, and adds the
borders it meets to those of all rounds (DAgger: Ross, Gordon & Bagnell 2011).
"""

from __future__ import annotations

import argparse
import copy
import heapq
import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from ...assets import furnish
from ...scene import Scene
from .. import affinity
from ..regions import Graph
from ..segment import graph_of, superpoints_and_structure
from ..superpoints import links_of
from ..surface import surface_of

F64 = NDArray[np.float64]
HIDDEN, STEPS, BATCH, RATE = 32, 8000, 2048, 5e-3
ROUNDS = 2
JITTER = 0.25  # standard deviations of a feature: captures are noisier than furnished rooms
STRAY = 0.3  # of the wrong merges that the rule would make are made, so that it learns not to add to them
LEAST = 0.2  # weight of a border of a crumb against one that decides over a whole object


@dataclass(frozen=True)
class Known:
    """A graph and `owners [R, K]`, how many points of each region each known object (and, first, none) has."""

    graph: Graph
    owners: F64


@dataclass(frozen=True)
class Met:
    """Borders met on the way: features `[B, F]`, whether both sides are one object, and what a mistake would cost."""

    features: F64
    same: NDArray[np.bool_]
    cost: F64


def known_graph(scene: Scene, truth: NDArray[np.int32]) -> Known:
    """The graph that embedding would build, with the objects (-1: structure) its regions belong to."""
    surface = surface_of(scene.cloud)
    links = links_of(surface)
    labels, kind_of = superpoints_and_structure(surface, links, scene.frame)
    graph = graph_of(surface, links, labels, kind_of, scene.frame)
    many = int(truth.max(initial=-1)) + 2
    counts = np.bincount(labels.astype(np.int64) * many + truth[surface.rows] + 1, minlength=len(kind_of) * many)
    rows = [m[0] for m in graph.members.values()]
    return Known(graph, counts.reshape(-1, many)[rows].astype(np.float64))


def walk(known: Known, rule: affinity.Rule | None, rng: np.random.Generator) -> Met:
    """Merge as the rule would (at random if None) but only within objects, bar a stray; note every border met."""
    graph, owners = copy.deepcopy(known.graph), {i: row for i, row in enumerate(known.owners)}
    total = known.owners.sum(axis=0)
    features: list[F64] = []
    same: list[bool] = []
    cost: list[float] = []
    heap: list[tuple[float, int, int]] = []

    def meet(pairs: list[tuple[int, int]]) -> None:
        if not pairs:
            return
        found = graph.features(pairs)
        order = rng.random(len(pairs)) if rule is None else -rule.probability(found)
        features.append(found)
        for (i, j), p in zip(pairs, order.tolist(), strict=True):
            a, b = owners[i], owners[j]
            first, second = int(a.argmax()), int(b.argmax())
            share = min(a.sum(), b.sum()) / max(min(total[first], total[second]), 1.0)
            pure = a.max() / a.sum() * b.max() / b.sum()
            same.append(first == second)
            cost.append(float(pure * (LEAST + (1 - LEAST) * min(2 * share, 1.0))))
            heapq.heappush(heap, (p, i, j))

    meet(graph.pairs())
    while heap:
        order, i, j = heapq.heappop(heap)
        if i not in graph.members or j not in graph.members:
            continue
        right = owners[i].argmax() == owners[j].argmax()
        if right or (rule is not None and order < -0.5 and rng.random() < STRAY):
            new = graph.merge(i, j)
            owners[new] = owners.pop(i) + owners.pop(j)
            meet([(other, new) for other in graph.around[new]])
    return Met(np.concatenate(features) if features else np.zeros((0, len(affinity.FEATURES))),
               np.array(same, bool), np.array(cost))  # fmt: skip


def joined(met: Sequence[Met]) -> Met:
    """All of them."""
    return Met(*(np.concatenate([getattr(m, name) for m in met]) for name in ("features", "same", "cost")))


def fit(met: Met, names: tuple[str, ...], seed: int = 0, steps: int = STEPS) -> dict[str, Any]:
    """The rule as a table; both classes count equally, so that it does not follow how often each occurs."""
    torch.manual_seed(seed)
    rng = np.random.default_rng(seed)
    mean, spread = met.features.mean(axis=0), met.features.std(axis=0) + 1e-6
    x = torch.from_numpy((met.features - mean) / spread).float()
    y = torch.from_numpy(met.same).float()
    weight = torch.from_numpy(met.cost).float()
    weight = torch.where(y > 0, weight / (weight * y).mean(), weight / (weight * (1 - y)).mean())
    layers = [torch.nn.Linear(len(names), HIDDEN), torch.nn.Linear(HIDDEN, HIDDEN), torch.nn.Linear(HIDDEN, 1)]
    model = torch.nn.Sequential(layers[0], torch.nn.Tanh(), layers[1], torch.nn.Tanh(), layers[2])
    optimizer = torch.optim.AdamW(model.parameters(), lr=RATE, weight_decay=1e-2)
    for step in range(steps):
        for group in optimizer.param_groups:
            group["lr"] = RATE * (1 - step / steps)
        pick = torch.from_numpy(rng.integers(len(y), size=BATCH))
        jitter = torch.from_numpy(rng.normal(size=(BATCH, x.shape[1])).astype(np.float32)) * JITTER
        logit = model(x[pick] + jitter).squeeze(1)
        loss = torch.nn.functional.binary_cross_entropy_with_logits(logit, y[pick], weight[pick])
        optimizer.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        optimizer.step()
    return {
        "features": list(names),
        "mean": _rounded(mean),
        "spread": _rounded(spread),
        "weights": [_rounded(layer.weight.detach().numpy().T) for layer in layers],
        "biases": [_rounded(layer.bias.detach().numpy()) for layer in layers],
        "borders": len(y),
    }


def judge(rule: affinity.Rule, met: Met) -> dict[str, float]:
    """Shares of borders judged right, each weighted by what a mistake would cost."""
    joined = rule.probability(met.features) > 0.5
    return {
        name: round(float(np.average(joined[rows] == wanted, weights=met.cost[rows])), 4)
        for name, rows, wanted in (("joined when one thing", met.same, True), ("parted when two", ~met.same, False))
    }


def _rounded(values: NDArray[np.floating]) -> list[Any]:
    rounded: list[Any] = np.round(values.astype(np.float64), 5).tolist()
    return rounded


def fit_in_rounds(rooms: Iterable[tuple[Scene, NDArray[np.int32]]], seed: int) -> dict[str, Any]:
    """The table of the rule after all rounds; a sixth of the rooms is held out and judged as the rule meets them."""
    rng = np.random.default_rng(seed)
    graphs = [known_graph(scene, truth) for scene, truth in rooms]
    kept = graphs[: max(1, len(graphs) * 5 // 6)]
    met = [walk(g, None, rng) for g in kept]
    table = fit(joined(met), affinity.FEATURES, seed)
    for _ in range(ROUNDS):
        met += [walk(g, affinity.rule_of(table), rng) for g in kept]
        table = fit(joined(met), affinity.FEATURES, seed)
    rule = affinity.rule_of(table)
    held = [walk(g, rule, rng) for g in graphs[len(kept) :]]
    return {**table, "held_out": judge(rule, joined(held)) if held else {}}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rooms", type=int, default=70)
    parser.add_argument("--seed", type=int, default=9000)
    parser.add_argument("--out", type=Path, default=Path(affinity.__file__).with_suffix(".json"))
    args = parser.parse_args()
    rooms = (furnish(args.seed + i) for i in range(args.rooms))
    table = fit_in_rounds(((r.scene, r.truth.ids.numpy()) for r in rooms), args.seed)
    args.out.write_text(json.dumps(table) + "\n")


if __name__ == "__main__":
    main()

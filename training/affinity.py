"""Fit the rule that decides whether two touching regions are one object, on furnished rooms with known objects.

    python -m scenewright.training.affinity --rooms 70 --seed 9000

Writes `affinity.json` beside `affinity.py`. The features of a border depend on earlier merges, so the rule is fitted
in rounds. Each round merges the regions of all rooms in the order of the current rule, executes some of its wrong
merges, and adds the borders that occur to the training set (DAgger: Ross, Gordon & Bagnell 2011).
"""

from __future__ import annotations

import copy
import heapq
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gaussians.language.segmentation import affinity
from ..gaussians.language.segmentation.haze import HazyRule
from ..gaussians.language.segmentation.learned_rule import Rule, rule_of
from ..gaussians.language.segmentation.regions import Graph
from ..gaussians.language.segmentation.segment import graph_of, superpoints_and_structure
from ..gaussians.language.segmentation.settle import settled
from ..gaussians.language.segmentation.superpoints import links_of
from ..gaussians.language.segmentation.surface import surface_of
from ..gaussians.scene import Scene
from .rules import Examples, Rooms, command, fit, joined, training_count, with_held_out

F64 = NDArray[np.float64]
STEPS = 8000
ROUNDS = 2
WRONG_MERGES = 0.3  # share of the wrong merges of the rule that are executed, so that it learns to recover from them
MIN_WEIGHT = 0.2  # weight of a border of a tiny region; a border that decides about a whole object has weight 1


@dataclass(frozen=True)
class LabelledGraph:
    """A region graph with `owners [R, K]`: number of points of each region that belong to each known object. Column 0
    counts points of no object."""

    graph: Graph
    owners: F64


def labelled_graph(scene: Scene, truth: NDArray[np.int32]) -> LabelledGraph:
    """The region graph that embedding would build, with the true objects of its regions.

    Args:
        truth: `[N]` object of each Gaussian, -1 for structure.
    """
    surface = settled(surface_of(scene.cloud), scene.cloud, scene.frame)
    links = links_of(surface)
    labels, kind_of = superpoints_and_structure(surface, links, scene.frame)
    graph = graph_of(scene.cloud, surface, links, labels, kind_of, scene.frame)
    many = int(truth.max(initial=-1)) + 2
    counts = np.bincount(labels.astype(np.int64) * many + truth[surface.rows] + 1, minlength=len(kind_of) * many)
    rows = [m[0] for m in graph.members.values()]
    return LabelledGraph(graph, counts.reshape(-1, many)[rows].astype(np.float64))


def collect_borders(known: LabelledGraph, rule: Rule | HazyRule | None, rng: np.random.Generator) -> Examples:
    """Merge regions in the order of the rule (random if None) and return every border that occurs.

    Merges across objects are skipped, except for the share `WRONG_MERGES` of those that the rule would make.
    """
    graph, owners = copy.deepcopy(known.graph), {i: row for i, row in enumerate(known.owners)}
    total = known.owners.sum(axis=0)
    features: list[F64] = []
    same: list[bool] = []
    cost: list[float] = []
    heap: list[tuple[float, int, int]] = []

    def add_borders(pairs: list[tuple[int, int]]) -> None:
        if not pairs:
            return
        found = affinity.features(graph, pairs)
        order = rng.random(len(pairs)) if rule is None else -rule.probability(found)
        features.append(found)
        for (i, j), p in zip(pairs, order.tolist(), strict=True):
            a, b = owners[i], owners[j]
            first, second = int(a.argmax()), int(b.argmax())
            share = min(a.sum(), b.sum()) / max(min(total[first], total[second]), 1.0)
            pure = a.max() / a.sum() * b.max() / b.sum()
            same.append(first == second)
            cost.append(float(pure * (MIN_WEIGHT + (1 - MIN_WEIGHT) * min(2 * share, 1.0))))
            heapq.heappush(heap, (p, i, j))

    add_borders(graph.pairs())
    while heap:
        order, i, j = heapq.heappop(heap)
        if i not in graph.members or j not in graph.members:
            continue
        right = owners[i].argmax() == owners[j].argmax()
        if right or (rule is not None and order < -0.5 and rng.random() < WRONG_MERGES):
            new = graph.merge(i, j)
            owners[new] = owners.pop(i) + owners.pop(j)
            add_borders([(other, new) for other in graph.around[new]])
    return Examples(np.concatenate(features) if features else np.zeros((0, len(affinity.FEATURES))),
               np.array(same, bool), np.array(cost))  # fmt: skip


def fit_in_rounds(rooms: Rooms, seed: int) -> dict[str, Any]:
    """The table of the rule after all rounds. A sixth of the rooms is held out for evaluation."""
    rng = np.random.default_rng(seed)
    graphs = [labelled_graph(scene, truth) for scene, truth in rooms]
    known, held = graphs[: training_count(len(graphs))], graphs[training_count(len(graphs)) :]
    examples = [collect_borders(g, None, rng) for g in known]
    table = fit(joined(examples), affinity.FEATURES, seed, STEPS)
    for _ in range(ROUNDS):
        examples += [collect_borders(g, rule_of(table, affinity.FEATURES), rng) for g in known]
        table = fit(joined(examples), affinity.FEATURES, seed, STEPS)
    rule = rule_of(table, affinity.FEATURES)
    return with_held_out(table, affinity.FEATURES, [collect_borders(g, rule, rng) for g in held])


if __name__ == "__main__":
    command(affinity, 70, fit_in_rounds)

"""Fit the rule that says whether two touching regions are one thing, on furnished rooms whose objects are known.

    python -m scenewright.training.affinity --rooms 70 --seed 9000

Writes `affinity.json` beside `affinity.py`. A rule that merges greedily meets borders of its own making, so it is
fitted in rounds: each walks the rooms in the order of the rule so far, sometimes into its mistakes, and adds the
borders it meets to those of all rounds (DAgger: Ross, Gordon & Bagnell 2011).
"""

from __future__ import annotations

import copy
import heapq
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gaussians.language.segmentation import affinity
from ..gaussians.language.segmentation.learned_rule import Rule, rule_of
from ..gaussians.language.segmentation.regions import Graph
from ..gaussians.language.segmentation.segment import graph_of, superpoints_and_structure
from ..gaussians.language.segmentation.superpoints import links_of
from ..gaussians.language.segmentation.surface import surface_of
from ..gaussians.scene import Scene
from .rules import Met, Rooms, command, fit, joined, kept, with_judgement

F64 = NDArray[np.float64]
STEPS = 8000
ROUNDS = 2
STRAY = 0.3  # of the wrong merges that the rule would make are made, so that it learns not to add to them
LEAST = 0.2  # weight of a border of a crumb against one that decides over a whole object


@dataclass(frozen=True)
class Known:
    """A graph and `owners [R, K]`, how many points of each region each known object (and, first, none) has."""

    graph: Graph
    owners: F64


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


def walk(known: Known, rule: Rule | None, rng: np.random.Generator) -> Met:
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
        found = affinity.features(graph, pairs)
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


def fit_in_rounds(rooms: Rooms, seed: int) -> dict[str, Any]:
    """The table of the rule after all rounds; a sixth of the rooms is held out and judged as the rule meets them."""
    rng = np.random.default_rng(seed)
    graphs = [known_graph(scene, truth) for scene, truth in rooms]
    known, held = graphs[: kept(len(graphs))], graphs[kept(len(graphs)) :]
    met = [walk(g, None, rng) for g in known]
    table = fit(joined(met), affinity.FEATURES, seed, STEPS)
    for _ in range(ROUNDS):
        met += [walk(g, rule_of(table, affinity.FEATURES), rng) for g in known]
        table = fit(joined(met), affinity.FEATURES, seed, STEPS)
    rule = rule_of(table, affinity.FEATURES)
    return with_judgement(table, affinity.FEATURES, [walk(g, rule, rng) for g in held])


if __name__ == "__main__":
    command(affinity, 70, fit_in_rounds)

"""The probability that two adjacent regions are one object, from the features of their border, and the merge tree.

The small network that computes the probability was fitted on furnished rooms with known objects
(`training/affinity.py`); in scenes fitted from photographs it is corrected (`haze.py`).
"""

from __future__ import annotations

import heapq

import numpy as np

from ..masks.evidence import Ledger
from .haze import HazyRule, load_correction
from .learned_rule import load_rule
from .regions import F64, I64, Borders, Graph, Node, Regions

FEATURES = (
    "color", "lightness", "border weight", "border contrast", "contrast over pattern", "smaller pattern",
    "larger pattern", "shared border", "border length", "rests on", "resting footprint", "height overlap",
    "plan overlap", "size ratio", "box growth", "smaller size", "larger size", "plan ratio", "contact height",
    "contact at edge", "contact footprint", "contact level", "smaller flat", "larger flat", "smaller on floor",
    "larger on floor", "smaller on wall", "larger on wall", "gap", "touching", "concentric", "feet apart", "tops apart",
    "same facing", "smaller plane", "larger plane", "smaller line", "larger line", "off the plane",
)  # fmt: skip

APART = -1.0  # log-odds of two regions without a border


def features(graph: Graph, pairs: list[tuple[int, int]]) -> F64:
    """Features `[len(pairs), len(FEATURES)]` of pairs of adjacent regions."""
    rows = np.array([graph.around[i][j] for i, j in pairs], np.int64)
    first, second = np.array(pairs, np.int64).reshape(-1, 2).T
    return describe(graph.regions, graph.borders, first, second, rows, graph.scale)


def describe(regions: Regions, borders: Borders, first: I64, second: I64, rows: I64, scale: float) -> F64:
    """Features `[P, len(FEATURES)]` of borders; they do not depend on the order of the two regions.

    Args:
        first, second: `[P]` the regions of each border, as the border's sides are ordered.
        rows: `[P]` the borders.
        scale: typical size of a region, scene units.
    """
    swap = regions.count[first] > regions.count[second]
    one, two = np.where(swap, second, first), np.where(swap, first, second)  # the smaller and the larger region
    b = borders
    pairs, links = b.pairs[rows], b.touching[rows]
    level = np.where(swap[:, None], b.level[rows, ::-1], b.level[rows]) / pairs[:, None]
    small, large = _Shape(regions, one), _Shape(regions, two)
    color = small.lab - large.lab
    contact, contrast = b.height[rows] / pairs, b.contrast[rows] / pairs
    rests = np.maximum(_rests(small, large, contact, level[:, 1]), _rests(large, small, contact, level[:, 0]))
    overlap = np.minimum(small.high, large.high) - np.maximum(small.low, large.low)
    share = np.clip(overlap / np.minimum(small.size, large.size), 0, 1)
    plan = share[:, 0] * share[:, 1]
    grown = np.maximum(small.high, large.high) - np.minimum(small.low, large.low)
    growth = np.log(grown.prod(1) / (small.size.prod(1) + large.size.prod(1)) + 1e-3)
    middle, reach = (b.low[rows] + b.high[rows]) / 2, b.high[rows] - b.low[rows]
    aside = np.abs(middle - (large.low + large.high)[:, :2] / 2) / (large.size[:, :2] / 2 + 1e-6)
    apart = np.abs(small.middle - large.middle)[:, :2].max(1) / large.size[:, :2].max(1)
    offset = np.abs(((small.middle - large.middle) * large.normal).sum(1))
    return np.stack(
        [
            np.minimum(np.linalg.norm(color[:, 1:], axis=1) / 20, 3),
            np.minimum(np.abs(color[:, 0]) / 30, 2),
            np.minimum(b.weight[rows] / pairs, 6),
            np.minimum(contrast / 20, 3),
            np.minimum(contrast / (small.pattern + large.pattern + 3), 6),
            np.minimum(small.pattern / 10, 3),
            np.minimum(large.pattern / 10, 3),
            links / np.maximum(np.minimum(regions.leaving[one], regions.leaving[two]), 1),
            np.log((links + 1) / np.sqrt(small.count)),
            rests,
            rests * plan,
            share[:, 2],
            plan,
            np.log(large.count / small.count),
            np.clip(growth, -1, 3),
            np.log(small.size.max(1) / scale + 1e-3),
            np.log(large.size.max(1) / scale + 1e-3),
            np.log((large.size[:, :2] + 1e-3).prod(1) / (small.size[:, :2] + 1e-3).prod(1)),
            np.clip((contact - large.low[:, 2]) / large.size[:, 2], -0.5, 1.5),
            np.clip(aside.max(1), 0, 2),
            np.clip((reach + 1e-3).prod(1) / (small.size[:, :2] + 1e-3).prod(1), 0, 1.5),
            level[:, 0] - level[:, 1],
            np.log(small.size[:, 2] / small.size[:, :2].max(1) + 1e-2),
            np.log(large.size[:, 2] / large.size[:, :2].max(1) + 1e-2),
            np.log1p(regions.floor[one] / np.sqrt(small.count)),
            np.log1p(regions.floor[two] / np.sqrt(large.count)),
            np.log1p(regions.wall[one] / np.sqrt(small.count)),
            np.log1p(regions.wall[two] / np.sqrt(large.count)),
            np.minimum(b.gap[rows] / scale, 3),
            (links > 0).astype(np.float64),
            np.minimum(apart, 2),
            np.clip((small.low - large.low)[:, 2] / (grown[:, 2] + 1e-9), -1, 1),
            np.clip((small.high - large.high)[:, 2] / (grown[:, 2] + 1e-9), -1, 1),
            (small.facing * large.facing).sum((1, 2)),
            small.thinness,
            large.thinness,
            small.slimness,
            large.slimness,
            np.minimum(offset / small.size.max(1), 2) * large.thinness,
        ],
        axis=1,
    )


class _Shape:
    """Colour, extent and shape of some regions `[P]`, computed from their sums."""

    def __init__(self, regions: Regions, rows: I64) -> None:
        self.count = regions.count[rows]
        per = 1 / self.count[:, None]
        self.lab = regions.lab[rows] * per
        self.pattern = np.sqrt(np.maximum(regions.lab_squared[rows] * per - self.lab**2, 0).sum(1))
        self.low, self.high = regions.low[rows], regions.high[rows]
        self.size = np.maximum(self.high - self.low, 1e-6)
        self.middle = regions.place[rows] * per
        scatter = _square(regions.spread[rows] * per) - self.middle[:, :, None] * self.middle[:, None, :]
        values, axes = np.linalg.eigh(scatter)
        root = np.sqrt(np.maximum(values, 0)) + 1e-9
        self.normal = axes[:, :, 0]
        self.thinness = 1 - root[:, 0] / root[:, 1]  # 1 for a plane
        self.slimness = 1 - root[:, 1] / root[:, 2]  # 1 for a rod
        facing = _square(regions.turn[rows] * per)
        self.facing = facing / np.maximum(np.sqrt((facing**2).sum((1, 2), keepdims=True)), 1e-9)


def _square(upper: F64) -> F64:
    """Symmetric matrices `[P, 3, 3]` of their upper triangles `[P, 6]`."""
    return upper[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3)


def _rests(upper: _Shape, lower: _Shape, contact: F64, level: F64) -> F64:
    """Score `[P]` in [0, 1] that `upper` rests on a level surface of `lower`: contact at its foot, its body above."""
    height = upper.size[:, 2]
    foot = np.clip(1 - np.abs(contact - upper.low[:, 2]) / (0.15 * height + 1e-6), 0, 1)
    result: F64 = foot * level * (upper.high[:, 2] - contact > 0.8 * height)
    return result


def probability(described: F64, haze: float = 0.0) -> F64:
    """Probability `[...]` that the regions on both sides of a border are one object, from its features `[..., F]`.

    Args:
        haze: of the scene, see `haze.py`.
    """
    rule = HazyRule(load_rule("affinity", FEATURES), load_correction("affinity", FEATURES), haze)
    return rule.probability(described)


def merge_tree(graph: Graph, ledger: Ledger | None = None) -> list[Node]:
    """Merge the regions with the most probable border first, until no border is left.

    Args:
        ledger: what masks say about the regions; it also joins regions that do not touch. Its tables are used up.

    Returns the nodes of the merge tree, children before parents.
    """
    nodes = [Node(members, (), 1.0) for _, members in sorted(graph.members.items())]
    heap: list[tuple[float, int, int]] = []
    linked = {} if ledger is None else _linked_by_masks(graph, ledger)

    def offer(region: int, others: list[int]) -> None:
        if others:
            likely = _joint_probability(graph, ledger, region, others)
            for other, p in zip(others, likely.tolist(), strict=True):
                heapq.heappush(heap, (-p, min(region, other), max(region, other)))

    for i in sorted(graph.members):
        offer(i, [j for j in sorted({*graph.around[i], *linked.get(i, ())}) if i < j])
    while heap:
        negative, i, j = heapq.heappop(heap)
        if i not in graph.members or j not in graph.members:
            continue
        new = graph.merge(i, j)
        if ledger is not None:
            ledger.merge(i, j, new)
            near = (linked.pop(i, set()) | linked.pop(j, set())) - {i, j}
            for other in near:
                linked[other] = (linked[other] - {i, j}) | {new}
            linked[new] = near
        nodes.append(Node(graph.members[new], (i, j), -negative))
        offer(new, sorted({*graph.around[new], *linked.get(new, ())}))
    return nodes


def _joint_probability(graph: Graph, ledger: Ledger | None, region: int, others: list[int]) -> F64:
    """Probability that a region and each of some others are one object, from geometry and from masks."""
    pairs = [(min(region, o), max(region, o)) for o in others]
    if ledger is None:
        return probability(features(graph, pairs), graph.haze)
    touching = np.array([o in graph.around[region] for o in others])
    odds = np.full(len(others), APART)
    if touching.any():
        near = [q for q, t in zip(pairs, touching, strict=True) if t]
        odds[touching] = _log_odds(probability(features(graph, near), graph.haze))
    return 1 / (1 + np.exp(-np.clip(ledger.joined(region, others, odds), -30, 30)))


def border_odds(graph: Graph) -> tuple[I64, I64, F64]:
    """The two superpoints `[B]` of each border of a graph that is not merged yet, and geometry's log-odds `[B]` that
    they are one object."""
    pairs = graph.pairs()
    ends = np.array([[graph.members[i][0], graph.members[j][0]] for i, j in pairs], np.int64).reshape(-1, 2)
    if not pairs:
        return ends[:, 0], ends[:, 1], np.zeros(0)
    return ends[:, 0], ends[:, 1], _log_odds(probability(features(graph, pairs), graph.haze))


def _log_odds(likely: F64) -> F64:
    bounded = np.clip(likely, 1e-9, 1 - 1e-9)
    result: F64 = np.log(bounded / (1 - bounded))
    return result


def _linked_by_masks(graph: Graph, ledger: Ledger) -> dict[int, set[int]]:
    """Pairs of regions without a border that masks hold for one object, such as the back and the seat of a chair."""
    likely = ledger.all_pairs() > -APART
    linked: dict[int, set[int]] = {}
    for i, j in np.argwhere(np.triu(likely, 1)).tolist():
        if j not in graph.around[i]:
            linked.setdefault(i, set()).add(j)
            linked.setdefault(j, set()).add(i)
    return linked

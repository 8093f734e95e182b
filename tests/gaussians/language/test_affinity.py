"""Regions under merging, borders seen from both sides, and the fitted rules' tables."""

from __future__ import annotations

import numpy as np
import pytest

from scenewright.gaussians.language.segmentation import affinity
from scenewright.gaussians.language.segmentation.adjacency import build_graph
from scenewright.gaussians.language.segmentation.affinity import border_odds, features, merge_tree
from scenewright.gaussians.language.segmentation.borders import FEATURES as BORDER_FEATURES
from scenewright.gaussians.language.segmentation.coplanar import FEATURES as PAINT_FEATURES
from scenewright.gaussians.language.segmentation.haze import HazyRule, correction_of
from scenewright.gaussians.language.segmentation.learned_rule import load_rule, rule_of
from scenewright.gaussians.language.segmentation.regions import Graph
from scenewright.gaussians.language.segmentation.superpoints import Links
from scenewright.training.affinity import LabelledGraph, collect_borders
from scenewright.training.hazy_affinity import accuracy, fit_correction

STEP = 0.1
KINDS = np.zeros(4, np.int8)


def strip(order: tuple[int, ...] = (0, 1, 2, 3), apart: float = 0.0, haze: float = 0.0) -> Graph:
    """Four blocks of 5 x 5 points in a row, numbered as told; the last is moved away by `apart`."""
    grid = np.stack(np.meshgrid(*[np.arange(5) * STEP] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    along = [5 * STEP * b + (apart if b == 3 else 0.0) for b in range(4)]
    blocks = [np.c_[grid[:, 0] + x, grid[:, 1], np.zeros(25)] for x in along]
    points = np.concatenate(blocks)
    labels = np.repeat(np.array(order, np.int32), 25)
    lab = np.repeat([[50.0, 10.0 * b, 0.0] for b in range(4)], 25, axis=0)
    gaps = np.linalg.norm(points[:, None] - points[None], axis=2)
    pairs = np.argwhere(np.triu((gaps < 1.01 * STEP) & (gaps > 0))).astype(np.int32)
    normals = np.tile([0.0, 0.0, 1.0], (100, 1))
    links = Links(pairs, np.ones(len(pairs), np.float32))
    return build_graph(labels, points, lab, normals, links, KINDS, STEP, haze)


def test_merging_adds_what_is_summed_and_joins_borders() -> None:
    graph = strip()
    assert graph.pairs() == [(0, 1), (1, 2), (2, 3)]
    new = graph.merge(0, 1)
    assert graph.members[new] == (0, 1) and graph.around[new].keys() == {2}
    assert graph.regions.count[new] == 50 and np.allclose(graph.regions.lab[new] / 50, [50, 5, 0])
    assert graph.regions.leaving[new] == 5  # the five links to the third block, and none to itself
    last = graph.merge(new, 2)
    assert graph.merge(last, 3) == 6 and not graph.pairs()
    assert np.allclose(graph.regions.high[6] - graph.regions.low[6], [1.9, 0.4, 0])


@pytest.mark.parametrize("order", [(3, 2, 1, 0), (1, 0, 3, 2)])
def test_a_border_is_the_same_whichever_side_is_numbered_first(order: tuple[int, ...]) -> None:
    # The ends of the strip differ in nothing but what they are beside: sorting the features compares the same borders.
    one, two = (features(g, g.pairs()) for g in (strip(), strip(order)))
    assert np.allclose(np.sort(one, axis=0), np.sort(two, axis=0), atol=1e-9)


def test_the_order_of_merging_does_not_change_the_sums() -> None:
    one, two = strip(), strip()
    a, b = one.merge(one.merge(0, 1), 2), two.merge(0, two.merge(1, 2))
    assert np.allclose(features(one, [(3, a)]), features(two, [(3, b)]))


def test_what_touches_nothing_is_tied_to_what_is_near() -> None:
    near, far = strip(apart=0.3), strip(apart=5.0)
    tied = near.around[3]
    assert 2 in tied and near.borders.touching[tied[2]] == 0
    assert near.borders.gap[tied[2]] == pytest.approx(0.4)  # one step and the gap
    assert not far.around[3]


def test_the_tree_holds_every_region_once_and_is_the_same_each_time() -> None:
    nodes = merge_tree(strip())
    assert sorted(nodes[-1].members) == [0, 1, 2, 3] and len(nodes) == 7
    assert all(0 <= n.affinity <= 1 for n in nodes)
    assert [(n.members, n.affinity) for n in merge_tree(strip())] == [(n.members, n.affinity) for n in nodes]


def test_the_tree_and_the_odds_of_borders_follow_the_haze_of_the_scene() -> None:
    clear, hazy = strip(), strip(haze=1.0)
    for graph, haze in ((clear, 0.0), (hazy, 1.0)):
        likely = affinity.probability(features(graph, graph.pairs()), haze)
        assert np.allclose(border_odds(graph)[2], np.log(likely / (1 - likely)))
    assert np.abs(border_odds(clear)[2] - border_odds(hazy)[2]).max() > 0.1
    assert [n.affinity for n in merge_tree(clear)] != [n.affinity for n in merge_tree(hazy)]


def test_a_fitted_correction_explains_the_borders_of_its_rooms_better_than_the_rule() -> None:
    owners = np.array([[0.0, 25.0, 0.0]] * 2 + [[0.0, 0.0, 25.0]] * 2)  # the strip is two objects of two blocks
    rule, rooms = load_rule("affinity", affinity.FEATURES), [LabelledGraph(strip(haze=1.0), owners)]
    table = fit_correction(rule, rooms, seed=3)
    assert table == fit_correction(rule, rooms, seed=3) and table["borders"] > 3
    correction = correction_of(table, affinity.FEATURES)
    found = collect_borders(rooms[0], None, np.random.default_rng(0))
    before, after = (
        np.where(found.same, p, 1 - p)
        for p in (HazyRule(rule, correction, haze).probability(found.features) for haze in (0.0, 1.0))
    )
    assert np.log(after).mean() > np.log(before).mean()
    assert set(accuracy(rule, correction, rooms, 1)) == {"joined when one thing", "parted when two"}


@pytest.mark.parametrize("names", [affinity.FEATURES, PAINT_FEATURES, BORDER_FEATURES])
def test_a_rule_is_refused_for_other_features(names: tuple[str, ...]) -> None:
    width = len(names)
    table = {
        "features": list(names), "mean": [0.0] * width, "spread": [1.0] * width,
        "weights": [np.zeros((width, 2)).tolist(), np.zeros((2, 2)).tolist(), [[1.0], [1.0]]],
        "biases": [[0.0, 0.0], [0.0, 0.0], [0.0]],
    }  # fmt: skip
    assert rule_of(table, names).probability(np.ones((3, width))).tolist() == [0.5] * 3
    with pytest.raises(AssertionError, match="other features"):
        rule_of(table, names[1:])

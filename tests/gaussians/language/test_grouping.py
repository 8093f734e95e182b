"""The best cut of a merge tree against brute force; nodes that share a render; parts as patches of one colour."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from scenewright.gaussians.language.segmentation.grouping import (
    CERTAIN,
    GEOMETRY_WEIGHT,
    MINOR_SHARE,
    PATCH_COLOR,
    PATCH_POINTS,
    RULED_OUT,
    SAME_SHARE,
    best_cut,
    nearly_same_ancestor,
    parts_of,
    undecided_nodes,
)
from scenewright.gaussians.language.segmentation.regions import Node


@st.composite
def forests(draw: st.DrawFn) -> list[Node]:
    """Merge trees as `merge_tree` makes them: leaves first, then merges of two roots, at most eight leaves."""
    leaves = draw(st.integers(1, 8))
    nodes = [Node((i,), (), 1.0) for i in range(leaves)]
    roots = list(range(leaves))
    for _ in range(draw(st.integers(0, leaves - 1))):
        a = roots.pop(draw(st.integers(0, len(roots) - 1)))
        b = roots.pop(draw(st.integers(0, len(roots) - 1)))
        nodes.append(Node(nodes[a].members + nodes[b].members, (a, b), draw(st.floats(0, 1))))
        roots.append(len(nodes) - 1)
    return nodes


def roots_of(nodes: Sequence[Node]) -> list[int]:
    return sorted(set(range(len(nodes))) - {c for n in nodes for c in n.children})


def cuts(nodes: Sequence[Node], roots: list[int]) -> Iterator[list[int]]:
    """Every set of disjoint nodes that covers all leaves below `roots`."""
    if not roots:
        yield []
        return
    first, rest = roots[0], roots[1:]
    for others in cuts(nodes, rest):
        yield [first, *others]
    if nodes[first].children:
        yield from cuts(nodes, [*nodes[first].children, *rest])


def stays_whole(nodes: Sequence[Node], i: int, points: NDArray[np.int64], evidence: dict[int, float]) -> bool:
    """The rule of `best_cut`: own evidence and geometry against the mean evidence of the best cut below."""
    if not nodes[i].children:
        return True
    a = min(max(weakest(nodes, i, points, own=True), 1e-4), 1 - 1e-4)  # clipped as in `weakest_merges`
    if a >= CERTAIN or a < RULED_OUT:
        return a >= CERTAIN
    below = [j for c in nodes[i].children for j in best_below(nodes, c, points, evidence)]
    mean = sum(float(points[j]) * evidence.get(j, 0.0) for j in below) / float(points[i])
    return evidence.get(i, 0.0) + GEOMETRY_WEIGHT * math.log(a / (1 - a)) >= mean - 1e-12


def weakest(nodes: Sequence[Node], i: int, points: NDArray[np.int64], own: bool) -> float:
    """Smallest affinity inside a node; a merge with a minor child counts only if it is the node's own."""
    children = nodes[i].children
    if not children:
        return 1.0
    minor = min(points[c] for c in children) < MINOR_SHARE * points[i]
    below = min(weakest(nodes, c, points, own=False) for c in children)
    return below if minor and not own else min(below, nodes[i].affinity)


def best_below(nodes: Sequence[Node], i: int, points: NDArray[np.int64], evidence: dict[int, float]) -> list[int]:
    """Slow reference: the best cut of the tree under one node, computed anew at every level."""
    if stays_whole(nodes, i, points, evidence):
        return [i]
    return [j for c in nodes[i].children for j in best_below(nodes, c, points, evidence)]


def points_of(nodes: Sequence[Node], weights: Sequence[int]) -> NDArray[np.int64]:
    return np.array([sum(weights[m] for m in n.members) for n in nodes], dtype=np.int64)


sizes = st.lists(st.integers(1, 60), min_size=8, max_size=8)
odds = st.dictionaries(st.integers(0, 14), st.integers(-24, 24).map(lambda v: v / 4))


@given(forests(), sizes, odds)
def test_the_best_cut_follows_its_rule_at_every_node(
    nodes: list[Node], weights: list[int], evidence: dict[int, float]
) -> None:
    points = points_of(nodes, weights)
    expected = sorted(j for r in roots_of(nodes) for j in best_below(nodes, r, points, evidence))
    assert best_cut(nodes, points, evidence) == expected
    assert expected in [sorted(c) for c in cuts(nodes, roots_of(nodes))]


@given(forests(), sizes, odds)
def test_evidence_of_decided_nodes_does_not_change_the_cut(
    nodes: list[Node], weights: list[int], evidence: dict[int, float]
) -> None:
    points = points_of(nodes, weights)
    asked = set(undecided_nodes(nodes, points))
    assert best_cut(nodes, points, {i: e for i, e in evidence.items() if i in asked}) == best_cut(
        nodes, points, evidence
    )


@given(forests(), sizes, odds)
def test_a_cut_covers_every_superpoint_exactly_once(
    nodes: list[Node], weights: list[int], evidence: dict[int, float]
) -> None:
    members = [m for i in best_cut(nodes, points_of(nodes, weights), evidence) for m in nodes[i].members]
    assert sorted(members) == sorted(m for i in roots_of(nodes) for m in nodes[i].members)


@given(forests(), sizes, odds)
def test_where_geometry_is_neutral_no_cut_has_a_higher_mean_evidence(
    nodes: list[Node], weights: list[int], evidence: dict[int, float]
) -> None:
    points = points_of(nodes, weights)
    even = [replace(n, affinity=0.5) for n in nodes]

    def mean(cut: list[int]) -> float:
        return sum(float(points[i]) * evidence.get(i, 0.0) for i in cut)

    chosen = mean(best_cut(even, points, evidence))
    assert chosen == pytest.approx(max(mean(c) for c in cuts(even, roots_of(even))), abs=1e-9)


def test_without_evidence_geometry_decides_and_strong_evidence_overrules_it() -> None:
    nodes = [Node((0,), (), 1.0), Node((1,), (), 1.0), Node((0, 1), (0, 1), 0.8)]
    points = np.array([50, 50, 100])
    assert best_cut(nodes, points, {}) == [2]
    assert best_cut(nodes, points, {2: -6.0}) == [0, 1]
    assert best_cut(nodes, points, {0: 6.0, 1: 6.0, 2: 6.0}) == [2]  # two halves do not defeat a probable whole
    assert best_cut(nodes, points, {0: 6.0, 1: 6.0}) == [0, 1]
    assert best_cut([], np.zeros(0, np.int64), {}) == []


def test_a_minor_child_does_not_make_a_wrong_merge_right() -> None:
    nodes = [Node((i,), (), 1.0) for i in range(3)]
    nodes += [Node((0, 1), (0, 1), 0.02), Node((0, 1, 2), (3, 2), 0.9)]
    points = np.array([500, 500, 10, 1000, 1010])
    assert best_cut(nodes, points, {0: 5.0, 1: 5.0, 3: 5.5, 4: 5.5}) == [0, 1, 2]


@given(forests(), st.lists(st.integers(1, 60), min_size=8, max_size=8))
def test_the_nearly_same_ancestor_holds_nearly_the_same_points(nodes: list[Node], weights: list[int]) -> None:
    points = points_of(nodes, weights)
    same = nearly_same_ancestor(nodes, points)
    parent = {c: i for i, n in enumerate(nodes) for c in n.children}
    for i, target in enumerate(same.tolist()):
        above = {i}
        while (last := max(above)) in parent:
            above.add(parent[last])
        assert target in above
        assert same[target] == target  # a node that is rendered represents itself
        assert points[i] >= SAME_SHARE * points[target]


def test_a_chain_of_small_additions_is_followed_no_farther_than_the_share() -> None:
    nodes = [Node((0,), (), 1.0), Node((1,), (), 1.0), Node((0, 1), (0, 1), 0.5), Node((2,), (), 1.0)]
    nodes.append(Node((0, 1, 2), (2, 3), 0.5))
    assert nearly_same_ancestor(nodes, np.array([96, 4, 100, 2, 102])).tolist() == [4, 1, 4, 3, 4]
    assert nearly_same_ancestor(nodes, np.array([94, 6, 100, 5, 105])).tolist() == [0, 1, 4, 3, 4]  # below the share


@st.composite
def patchworks(draw: st.DrawFn) -> tuple[list[int], dict[int, set[int]], np.ndarray, np.ndarray]:
    count = draw(st.integers(1, 12))
    pairs = draw(st.sets(st.tuples(st.integers(0, count - 1), st.integers(0, count - 1)), max_size=30))
    near: dict[int, set[int]] = {}
    for a, b in pairs:
        if a != b:
            near.setdefault(a, set()).add(b)
            near.setdefault(b, set()).add(a)
    lab = np.array(draw(st.lists(st.tuples(*[st.floats(0, 60)] * 3), min_size=count, max_size=count)))
    size = np.array(draw(st.lists(st.integers(1, 200), min_size=count, max_size=count)), dtype=np.int64)
    members = draw(st.sets(st.integers(0, count - 1), min_size=1))
    return sorted(members), near, lab, size


def connected(members: list[int], near: dict[int, set[int]]) -> bool:
    reached, stack = {members[0]}, [members[0]]
    while stack:
        for other in near.get(stack.pop(), set()) & set(members) - reached:
            reached.add(other)
            stack.append(other)
    return reached == set(members)


@given(patchworks())
def test_parts_keep_every_member_once_and_are_connected(
    world: tuple[list[int], dict[int, set[int]], np.ndarray, np.ndarray],
) -> None:
    members, near, lab, size = world
    before = {k: set(v) for k, v in near.items()}
    parts = parts_of(members, near, lab, size)
    assert sorted(m for part in parts for m in part) == members
    assert all(connected(part, near) for part in parts)
    weights = [sum(int(size[m]) for m in part) for part in parts]
    assert weights == sorted(weights, reverse=True)
    assert near == before  # an argument is never changed
    assert parts_of(members, near, lab, size) == parts


@given(patchworks())
def test_a_small_patch_remains_only_where_it_touches_nothing(
    world: tuple[list[int], dict[int, set[int]], np.ndarray, np.ndarray],
) -> None:
    members, near, lab, size = world
    parts = parts_of(members, near, lab, size)
    for part in parts:
        alone = not any(near.get(m, set()) & set(members) - set(part) for m in part)
        assert alone or sum(int(size[m]) for m in part) >= PATCH_POINTS


def test_a_lamp_is_its_shade_and_its_foot() -> None:
    red, gray = [45.0, 60.0, 40.0], [50.0, 0.0, 0.0]
    lab = np.array([red, red, gray, gray, red])
    size = np.full(5, 100)
    near = {0: {1}, 1: {0, 2}, 2: {1, 3}, 3: {2, 4}, 4: {3}}
    # the last red piece touches only grey: one colour, but two patches
    assert parts_of(range(5), near, lab, size) == [[0, 1], [2, 3], [4]]
    assert parts_of(range(4), near, lab, size) == [[0, 1], [2, 3]]
    close = lab + np.array([[0, 0, 0], [PATCH_COLOR - 1, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]])
    assert parts_of([0, 1], near, close, size) == [[0, 1]]  # shading does not part a shade
    assert parts_of([], near, lab, size) == []


@given(patchworks())
def test_parts_stay_on_one_side_of_a_border_that_masks_divide_surely(
    world: tuple[list[int], dict[int, set[int]], np.ndarray, np.ndarray],
) -> None:
    members, near, lab, size = world
    large = np.maximum(size, 1000)  # small patches join whatever they touch
    odd = {(s, t): 1.0 for s in near for t in near[s] if s < t and (s % 2) != (t % 2)}
    parts = parts_of(members, near, lab, large, odd)
    assert all(len({m % 2 for m in part}) == 1 for part in parts)
    assert parts_of(members, near, lab, size, {}) == parts_of(members, near, lab, size)

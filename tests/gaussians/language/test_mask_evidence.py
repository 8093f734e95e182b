"""Evidence of masks on pairs of regions, and what each source is worth: laws, a slow reference, simulated sources."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from scenewright.gaussians.language.masks.evidence import Ledger, Witness
from scenewright.gaussians.language.masks.lifting import Lifted
from scenewright.gaussians.language.masks.reliability import MOST, Reliability, estimate
from scenewright.gaussians.language.masks.statements import CLEAR, HALF_SEEN, Counts, cover, decided
from scenewright.gaussians.language.segmentation.mask_cuts import dividing
from scenewright.gaussians.language.segmentation.superpoints import Links

REGIONS, PER_REGION, OBJECTS = 60, 5, 12


def lifted(ids: NDArray[np.int64], seen: NDArray[np.bool_]) -> Lifted:
    """A source that gives region r in view v the masks `ids[v, layer, r]` (-1 for none) where `seen[v, r]`.

    Each region has PER_REGION points, each point ten pixels in each view that sees it.
    """
    views, layers, regions = ids.shape
    rows, columns, names, view = [], [], 0, []
    for v in range(views):
        for layer in range(layers):
            for name in np.unique(ids[v, layer][(ids[v, layer] >= 0) & seen[v]]).tolist():
                own = np.flatnonzero((ids[v, layer] == name) & seen[v])
                points = (own[:, None] * PER_REGION + np.arange(PER_REGION)).ravel()
                rows += points.tolist()
                columns += [names] * len(points)
                view.append(v)
                names += 1
    points = regions * PER_REGION
    weights = csr_matrix((np.full(len(rows), 10, np.float32), (rows, columns)), shape=(points, names))
    whole = csr_matrix(np.repeat(seen.T, PER_REGION, axis=0).astype(np.float32) * 10)
    labels, scores = ("",) * names, np.ones(names, np.float32)
    eyes = np.random.default_rng(9).uniform(3, 5, (views, 3))
    places = np.zeros((points, 3), np.float32)
    return Lifted(weights, whole, np.array(view, np.int32), labels, scores, None, places, eyes, np.full(views, 500.0))


@pytest.fixture
def truth() -> NDArray[np.int64]:
    return np.repeat(np.arange(OBJECTS), REGIONS // OBJECTS)


def pairs_and_prior(truth: NDArray[np.int64], right: float = 0.9) -> tuple[Any, Any, Any]:
    """All pairs of regions with a geometry that is right as often as said."""
    first, second = np.triu_indices(REGIONS, 1)
    rng = np.random.default_rng(0)
    keep = (truth[first] == truth[second]) | (rng.random(len(first)) < 0.1)  # as many of the one kind as of the other
    first, second = first[keep], second[keep]
    same = truth[first] == truth[second]
    said = np.where(rng.random(len(first)) < right, same, ~same)
    return first, second, np.where(said, 3.0, -3.0)


def odds_of(source: Lifted, truth: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.bool_], Reliability]:
    """The log-odds of a source for pairs, and whether they are one object."""
    labels = np.repeat(np.arange(REGIONS), PER_REGION).astype(np.int32)
    first, second, prior = pairs_and_prior(truth)
    about = cover(source, labels, REGIONS)
    (worth,) = estimate([about], first, second, prior)
    return worth.log_odds(about.between(first, second)), truth[first] == truth[second], worth


def flat(truth: NDArray[np.int64], views: int) -> NDArray[np.int64]:
    return np.tile(truth, (views, 1))[:, None]


def words(source: Lifted, own: Sequence[int]) -> tuple[list[float], list[NDArray[np.float64]]]:
    """How well each view sees some points, and how far they lie in each mask of the view."""
    weights, seen = source.weights.toarray(), source.seen.toarray()
    whole = [float(seen[list(own), v].sum()) for v in range(seen.shape[1])]
    middle = source.places[list(own)].mean(axis=0)
    distance = [float(np.linalg.norm(middle - eye)) for eye in source.eyes]
    surface = [w * d**2 / f**2 for w, d, f in zip(whole, distance, source.focal, strict=True)]
    shares = [weights[np.ix_(list(own), np.flatnonzero(source.view == v))].sum(axis=0) / max(w, 1e-9)
              for v, w in enumerate(whole)]  # fmt: skip
    said = []
    for w, clear, share in zip(whole, surface, shares, strict=True):
        in_masks = min(float(share.sum()), 1.0)
        said.append(min(clear / max(CLEAR * max(surface), 1e-12), 1) * w / (w + HALF_SEEN) * abs(2 * in_masks - 1))
    return said, [np.asarray(decided(share), np.float64) for share in shares]


def reference_counts(source: Lifted, first: Sequence[int], second: Sequence[int]) -> tuple[float, float, float, float]:
    """The counts of two sets of points, view by view and mask by mask."""
    (words_a, shares_a), (words_b, shares_b) = (words(source, own) for own in (first, second))
    views = range(source.seen.shape[1])
    cover_a, cover_b = ([min(float(s.sum()), 1.0) for s in shares] for shares in (shares_a, shares_b))
    sure_a = sum(w * c for w, c in zip(words_a, cover_a, strict=True)) / max(sum(words_a), 1e-9)
    sure_b = sum(w * c for w, c in zip(words_b, cover_b, strict=True)) / max(sum(words_b), 1e-9)
    common = either = alone = confirmed = 0.0
    for v in views:
        word = words_a[v] * words_b[v]  # how well this view sees both
        depth_a, depth_b = float(shares_a[v].sum()), float(shares_b[v].sum())
        both = float(shares_a[v] @ shares_b[v])
        common += word * both
        either += word * (depth_a + depth_b - both)
        alone += word * (depth_a * (1 - cover_b[v]) + (1 - cover_a[v]) * depth_b)
        a, b = cover_a[v] * sure_a, cover_b[v] * sure_b
        confirmed += word * (a + b - a * b)
    return common, either, alone, confirmed


def test_counts_agree_with_the_reference() -> None:
    rng = np.random.default_rng(3)
    ids = np.sort(rng.integers(-1, 5, (6, 2, REGIONS)), axis=1)
    source = lifted(ids, rng.random((6, REGIONS)) < 0.7)
    noisy = source.weights.copy()
    noisy.data *= rng.uniform(0.2, 1, len(noisy.data)).astype(np.float32)  # masks that cover points in part
    source = replace(source, weights=noisy)
    labels = rng.integers(0, 9, REGIONS * PER_REGION).astype(np.int32)
    about = cover(source, labels, 9)
    first, second = np.triu_indices(9, 1)
    each, table = about.between(first, second), about.of_all()
    for e, (i, j) in enumerate(zip(first, second, strict=True)):
        true = reference_counts(source, np.flatnonzero(labels == i).tolist(), np.flatnonzero(labels == j).tolist())
        for counts, at in ((each, (e,)), (table, (i, j)), (table, (j, i))):
            found = (counts.common[at], counts.either[at], counts.alone[at], counts.views[at])
            assert found == pytest.approx(true, abs=1e-3)  # float32 sums of 6 views


def test_counts_of_merged_regions_are_sums() -> None:
    rng = np.random.default_rng(4)
    source = lifted(rng.integers(-1, 4, (5, 1, 4)), rng.random((5, 4)) < 0.8)
    about = cover(source, np.repeat(np.arange(4), PER_REGION).astype(np.int32), 4)
    size = np.array([3.0, 1.0, 2.0, 4.0])
    worth = Reliability(np.linspace(-3, 3, 9), np.linspace(-1, 1, 9), 0.5)
    ledger = Ledger([Witness(about, worth)], np.arange(4), size, 5.0)
    ledger.merge(0, 1, 4)
    each = about.between(np.array([0, 1]), np.array([2, 2]))
    whole = Counts(*(np.array([3 * 2 * a[0] + 1 * 2 * a[1]]) for a in vars(each).values()))
    assert ledger.joined(4, [2], np.zeros(1)) == pytest.approx(worth.log_odds(whole, 4 * 2.0), abs=1e-4)


def test_geometry_is_bounded_as_far_as_masks_speak() -> None:
    views = 40
    covered = np.zeros((views, 3), bool)
    covered[:, :2] = True  # region 2 is in no mask, and region 1 is seen by one view only
    seen = np.ones((views, 3), bool)
    seen[1:, 1] = False
    source = lifted(np.where(covered, 0, -1)[:, None], seen)
    about = cover(source, np.repeat(np.arange(3), PER_REGION).astype(np.int32), 3)
    silent = Reliability(np.zeros(9), np.zeros(9), 0.5)  # what it says is worth nothing, but it speaks

    def left_of(log_odds: float, pair: tuple[int, int], sources: list[Witness]) -> float:
        ledger = Ledger(sources, np.arange(3), np.ones(3), 2.0)
        return float(ledger.joined(pair[0], [pair[1]], np.array([log_odds]))[0])

    known = [Witness(about, silent)]
    assert left_of(9.0, (0, 1), []) == 9.0
    assert left_of(1.5, (0, 2), known) == 1.5 and left_of(-1.5, (0, 2), known) == -1.5
    often, once = left_of(9.0, (0, 2), known), left_of(9.0, (0, 1), known)
    assert 2.0 <= often < 2.2 < once <= 9.0
    assert left_of(-9.0, (0, 2), known) == -often


def test_right_masks_outvote_geometry_both_ways(truth: NDArray[np.int64]) -> None:
    odds, same, _ = odds_of(lifted(flat(truth, 12), np.ones((12, REGIONS), bool)), truth)
    assert odds[same].min() > 2.5 and odds[~same].max() < -2.5  # geometry is wrong in a tenth of these pairs


def test_masks_at_random_mean_nothing(truth: NDArray[np.int64]) -> None:
    ids = np.random.default_rng(1).integers(0, OBJECTS, (12, 1, REGIONS))
    odds, _, worth = odds_of(lifted(ids, np.ones((12, REGIONS), bool)), truth)
    assert np.abs(odds).mean() < 0.5 and worth.agreement < 0.1


def test_patches_of_objects_mean_little_by_apart_and_much_by_together(truth: NDArray[np.int64]) -> None:
    ids = flat(np.arange(REGIONS) // 2, 12)  # pairs of regions: every object is cut in pieces, some across its border
    ids = np.where(truth * 100 + ids > 0, truth * 100 + ids, ids)
    odds, same, worth = odds_of(lifted(ids, np.ones((12, REGIONS), bool)), truth)
    assert worth.covered[-1] > 1.5 and worth.covered[0] > -1.5
    assert odds[~same].mean() < 0 < odds[same].max()


def test_joined_objects_mean_little_by_together_and_much_by_apart(truth: NDArray[np.int64]) -> None:
    odds, same, worth = odds_of(lifted(flat(truth // 4, 12), np.ones((12, REGIONS), bool)), truth)
    assert worth.covered[0] < -2.5 and worth.covered[-1] < 1.5 and odds[same].min() > 0


def test_layers_tell_by_the_level_that_joins_two_regions(truth: NDArray[np.int64]) -> None:
    layers = np.stack([np.arange(REGIONS), truth, truth // 4, truth // 12])  # finest first
    ids = np.tile(layers, (12, 1, 1))
    odds, same, worth = odds_of(lifted(ids, np.ones((12, REGIONS), bool)), truth)
    assert odds[same].min() > 1.5 and odds[~same].max() < -1.5
    assert (np.diff(worth.covered) >= 0).all()


def test_a_source_without_masks_says_nothing(truth: NDArray[np.int64]) -> None:
    nothing = lifted(np.full((4, 1, REGIONS), -1), np.ones((4, REGIONS), bool))
    odds, _, _ = odds_of(nothing, truth)
    assert not odds.any()


def test_views_that_repeat_each_other_raise_certainty_within_bounds(truth: NDArray[np.int64]) -> None:
    rng = np.random.default_rng(2)
    wrong = rng.random((3, REGIONS)) < 0.2
    ids = np.where(wrong, rng.integers(0, OBJECTS, wrong.shape), truth)[:, None]
    few, same, _ = odds_of(lifted(ids, np.ones((3, REGIONS), bool)), truth)
    many, _, _ = odds_of(lifted(np.tile(ids, (40, 1, 1)), np.ones((120, REGIONS), bool)), truth)
    assert np.abs(many).max() <= MOST
    assert np.abs(many).mean() < 2.5 * np.abs(few).mean()  # forty times the views
    assert (np.sign(many[same]) == np.sign(few[same])).mean() > 0.9


def test_the_order_of_views_does_not_matter(truth: NDArray[np.int64]) -> None:
    rng = np.random.default_rng(5)
    ids, seen = rng.integers(-1, OBJECTS, (8, 1, REGIONS)), rng.random((8, REGIONS)) < 0.8
    turned = rng.permutation(8)
    one, other = (odds_of(lifted(i, s), truth)[0] for i, s in ((ids, seen), (ids[turned], seen[turned])))
    assert one == pytest.approx(other, abs=1e-3)  # float32 sums in another order


def test_a_bad_source_beside_a_good_one_does_not_harm(truth: NDArray[np.int64]) -> None:
    seen = np.ones((12, REGIONS), bool)
    good = lifted(flat(truth, 12), seen)
    bad = lifted(np.random.default_rng(6).integers(0, OBJECTS, (12, 1, REGIONS)), seen)
    labels = np.repeat(np.arange(REGIONS), PER_REGION).astype(np.int32)
    first, second, prior = pairs_and_prior(truth)
    covers = [cover(s, labels, REGIONS) for s in (good, bad)]
    worth = estimate(covers, first, second, prior)
    total = np.sum([r.log_odds(c.between(first, second)) for c, r in zip(covers, worth, strict=True)], axis=0)
    assert ((total > 0) == (truth[first] == truth[second])).all()


def test_borders_that_all_views_show_divide_and_others_do_not(truth: NDArray[np.int64]) -> None:
    """Neighbours in one line of regions: divided where the object changes, not at all without masks."""
    labels = np.repeat(np.arange(REGIONS), PER_REGION).astype(np.int32)
    line = np.arange(len(labels) - 1, dtype=np.int32)
    links = Links(np.stack([line, line + 1], axis=1), np.ones(len(line), np.float32))
    seen = np.ones((8, REGIONS), bool)
    shown = dividing(labels, links, [lifted(flat(truth, 8), seen)])
    border = {(r, r + 1) for r in range(REGIONS - 1) if truth[r] != truth[r + 1]}
    assert border and all(shown[pair] > 0.9 for pair in border)
    assert all(d < 0.05 for pair, d in shown.items() if pair not in border)
    assert dividing(labels, links, [lifted(np.full((8, 1, REGIONS), -1), seen)]) == {}
    assert dividing(labels, links, []) == {}

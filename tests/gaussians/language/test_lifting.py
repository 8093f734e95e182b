"""Lifting of masks to Gaussians: the fast pass against the reference renderer, and the laws of shares."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from masked_yard import THINGS, around, seen_by, yard
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.language.masks import ViewMasks
from scenewright.gaussians.language.masks.lifting import Lifted, _side_by_side, lift
from scenewright.gaussians.render import contributions, split


def random_cloud(count: int, seed: int) -> GaussianCloud:
    g = torch.Generator().manual_seed(seed)
    quats = torch.nn.functional.normalize(torch.randn(count, 4, generator=g), dim=1)
    return GaussianCloud.create(
        torch.randn(count, 3, generator=g), quats, torch.rand(count, 3, generator=g) * 0.2 + 0.01,
        torch.rand(count, generator=g) * 0.98 + 0.01, torch.randn(count, 1, 3, generator=g),
    )  # fmt: skip


def view(width: int = 70, height: int = 45, side: float = 0.0) -> Camera:
    """Sizes that are no multiple of a tile, so that tiles are cut by the border."""
    return Camera.look_at([side, -4, 1], [0, 0, 0], [0, 0, 1], width, height)


def table(cloud: GaussianCloud, camera: Camera, labels: NDArray[np.int32], backend: str) -> NDArray[np.float64]:
    """`[N, labels]` dense weights."""
    shares = split(cloud, camera, labels, backend)
    assert (shares.weights > 0).all()
    order = np.lexsort((shares.labels, shares.rows))
    assert (order == np.arange(len(order))).all()
    names = np.unique(labels)
    out = np.zeros((len(cloud), len(names)))
    out[shares.rows, np.searchsorted(names, shares.labels)] = shares.weights
    return out


@pytest.mark.parametrize("kinds", [1, 2, 300], ids=["one label", "two", "one in nearly every pixel"])
def test_the_fast_split_equals_the_readable_one(kinds: int) -> None:
    cloud, camera = random_cloud(400, 1), view()
    labels = np.random.default_rng(2).integers(-1, kinds, (camera.height, camera.width)).astype(np.int32) * 1000
    fast, slow = table(cloud, camera, labels, "cpu"), table(cloud, camera, labels, "reference")
    # weights are sums of float32 products over up to 3150 pixels: 1e-6 of relative error each, and they partly add up
    assert np.abs(fast - slow).max() < 2e-3 and np.abs(fast - slow).sum() < 1e-4 * slow.sum()


@given(st.integers(0, 2**31), st.integers(1, 90), st.integers(1, 60), st.integers(1, 9))
def test_the_shares_of_all_labels_add_up_to_the_contribution(seed: int, width: int, height: int, kinds: int) -> None:
    cloud, camera = random_cloud(60, seed % 7), view(width, height)
    labels = np.random.default_rng(seed).integers(-1, kinds, (height, width)).astype(np.int32)
    whole = contributions(cloud, camera).numpy()
    shares = split(cloud, camera, labels)
    total = np.bincount(shares.rows, weights=shares.weights, minlength=len(cloud))
    assert np.allclose(total, whole, rtol=1e-5, atol=1e-4)  # two orders of adding float32


def test_the_same_input_gives_the_same_bytes_on_any_number_of_threads() -> None:
    cloud, camera = random_cloud(3000, 5), view(200, 150)
    labels = np.random.default_rng(0).integers(0, 5, (150, 200)).astype(np.int32)
    before, seen = torch.get_num_threads(), []
    try:
        for threads in (1, 2, 3):
            torch.set_num_threads(threads)
            shares = split(cloud, camera, labels)
            seen.append(shares.rows.tobytes() + shares.labels.tobytes() + shares.weights.tobytes())
    finally:
        torch.set_num_threads(before)
    assert len(set(seen)) == 1


@pytest.mark.parametrize("labels", [np.zeros((3, 3), np.int32), np.zeros((45, 70), np.float32)])
def test_labels_that_are_no_picture_of_the_view_are_refused(labels: NDArray[Any]) -> None:
    with pytest.raises(UserError, match="labels must be integers"):
        split(random_cloud(3, 0), view(), labels)


def masks_of(camera: Camera, ids: NDArray[np.int32], vectors: NDArray[np.float32] | None = None) -> ViewMasks:
    count = int(ids.max(initial=-1)) + 1 if vectors is None else len(vectors)
    return ViewMasks(camera, ids, ("",) * count, np.ones(count, np.float32), vectors)


def test_lifting_counts_what_each_view_shows_of_each_mask() -> None:
    cloud = random_cloud(200, 3)
    views = []
    for side in (-1.0, 0.5):
        camera = view(side=side)
        ids = np.random.default_rng(1).integers(-1, 3, (camera.height, camera.width)).astype(np.int32)
        views.append(masks_of(camera, ids))
    lifted = lift(cloud, views)
    assert lifted.weights.shape == (200, 6) and lifted.seen.shape == (200, 2)
    assert lifted.view.tolist() == [0, 0, 0, 1, 1, 1]
    for v, one in enumerate(views):
        dense = table(cloud, one.camera, one.ids, "reference")
        assert np.allclose(lifted.weights[:, 3 * v : 3 * v + 3].toarray(), dense[:, 1:], rtol=1e-4, atol=1e-3)
        assert np.allclose(lifted.seen[:, [v]].toarray()[:, 0], dense.sum(axis=1), rtol=1e-4, atol=1e-3)


def test_overlapping_masks_each_get_all_that_lies_in_them() -> None:
    cloud, camera = random_cloud(200, 4), view()
    inner, outer = np.zeros((2, camera.height, camera.width), np.int32)
    inner[10:20, 20:40], outer[5:30, 10:60] = 1, 1
    layers = np.stack([np.where(inner, 0, -1), np.where(outer, 1, -1)]).astype(np.int32)
    both = lift(cloud, [masks_of(camera, layers)]).weights.toarray()
    for i, mask in enumerate((inner, outer)):
        alone = lift(cloud, [masks_of(camera, (mask - 1).astype(np.int32))]).weights.toarray()[:, 0]
        assert np.allclose(both[:, i], alone, rtol=1e-5, atol=1e-4)
    assert (both[:, 0] <= both[:, 1] + 1e-4).all()


def test_a_mask_in_two_layers_counts_once() -> None:
    cloud, camera = random_cloud(100, 4), view()
    ids = np.where(np.arange(camera.width) < 30, 0, -1).astype(np.int32) * np.ones((camera.height, 1), np.int32)
    once, twice = (lift(cloud, [masks_of(camera, i)]).weights for i in (ids, np.stack([ids, ids])))
    assert abs(once - twice).max() < 1e-4


def test_views_without_masks_count_as_seen_and_no_views_give_nothing() -> None:
    cloud, camera = random_cloud(50, 6), view()
    empty = masks_of(camera, np.full((camera.height, camera.width), -1, np.int32))
    lifted = lift(cloud, [empty])
    assert lifted.weights.shape == (50, 0) and np.allclose(
        lifted.seen.toarray()[:, 0], contributions(cloud, camera).numpy(), rtol=1e-5, atol=1e-4
    )
    assert lift(cloud, []).weights.shape == (50, 0) and lift(cloud[:0], [empty]).seen.shape == (0, 1)


def test_features_are_the_weighted_mean_of_the_masks_vectors() -> None:
    cloud, camera = random_cloud(150, 8), view()
    ids = np.random.default_rng(3).integers(-1, 4, (camera.height, camera.width)).astype(np.int32)
    vectors = np.random.default_rng(4).normal(size=(4, 6)).astype(np.float32)
    lifted = lift(cloud, [masks_of(camera, ids, vectors)])
    unit = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    expected = lifted.weights.toarray() @ unit
    norms = np.linalg.norm(expected, axis=1)
    found = lifted.features()
    assert np.allclose(found[norms > 1e-6], (expected / norms[:, None].clip(1e-12))[norms > 1e-6], atol=1e-5)
    assert not found[norms == 0].any()


def test_vectors_must_agree_among_views() -> None:
    cloud, camera = random_cloud(20, 8), view()
    ids = np.zeros((camera.height, camera.width), np.int32)
    wide, narrow = (masks_of(camera, ids, np.ones((1, d), np.float32)) for d in (5, 3))
    with pytest.raises(UserError, match="different widths"):
        lift(cloud, [wide, narrow])
    with pytest.raises(UserError, match="all or none"):
        lift(cloud, [wide, masks_of(camera, ids)])
    with pytest.raises(UserError, match="no vectors"):
        lifted: Lifted = lift(cloud, [masks_of(camera, ids)])
        lifted.features()


@pytest.mark.parametrize("times", [12, pytest.param(40, marks=pytest.mark.slow)])
def test_the_same_masks_give_the_same_bytes_wherever_their_arrays_lie(times: int) -> None:
    """Compiled loops may come in two versions, of which the addresses of their arrays choose one (seen once in 60)."""
    made = yard()
    cloud, truth = made.cloud(), made.labels(THINGS)
    views, rng = seen_by(cloud, truth, around(9)), np.random.default_rng(0)
    held: list[Any] = []
    seen = set()
    for _ in range(times):
        held += [np.empty(rng.integers(1, 200_000), np.uint8), bytearray(int(rng.integers(1, 3000)))]
        held = [held[i] for i in rng.permutation(len(held))[:40]]
        seen.add(lift(cloud, views).seen.data.tobytes())
    assert len(seen) == 1


@given(st.lists(st.integers(0, 4), max_size=5), st.integers(0, 2**31))
def test_masks_of_views_lie_side_by_side(widths: list[int], seed: int) -> None:
    rng = np.random.default_rng(seed)
    parts = [rng.integers(0, 3, (6, w)).astype(np.float32) for w in widths]
    made = _side_by_side([csr_matrix(p) for p in parts], 6)
    assert made.dtype == np.float32 and made.has_sorted_indices
    assert np.array_equal(made.toarray(), np.concatenate([np.zeros((6, 0), np.float32), *parts], axis=1))

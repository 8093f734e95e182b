"""Regions of a picture and their hierarchy: laws, a slow reference of the merging, and layers of masks."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from scipy import ndimage

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.errors import BackendError
from scenewright.gaussians.language.masks import ViewMasks
from scenewright.gaussians.language.masks.contours import detector, hierarchy, network, watershed
from scenewright.gaussians.language.masks.contours.classical import contours
from scenewright.gaussians.language.masks.contours.layers import MAX_MASKS
from scenewright.gaussians.language.masks.contours.watershed import Regions


def eye(width: int, height: int) -> Camera:
    return Camera(np.eye(4), float(width), float(width), width / 2, height / 2, width, height)


def noise(seed: int, height: int = 48, width: int = 64) -> Any:
    rough = np.random.default_rng(seed).random((height, width)).astype(np.float32)
    return ndimage.gaussian_filter(rough, 1.5) * 2 - 0.5


def contour_maps() -> Any:
    return arrays.arrays(
        np.float32, st.tuples(st.integers(1, 24), st.integers(1, 24)), elements=st.floats(0, 1, width=16)
    )


@given(contour_maps())
@settings(max_examples=40, deadline=None)
def test_regions_partition_the_picture_and_are_connected(contour: Any) -> None:
    found = watershed.regions_of(contour)
    assert found.labels.shape == contour.shape and set(np.unique(found.labels)) == set(range(found.count))
    for i in range(found.count):
        assert ndimage.label(found.labels == i)[1] == 1
    size = np.bincount(found.labels.ravel())
    assert found.count == 1 or size.min() >= watershed.MIN_PIXELS
    assert (found.pairs[:, 0] < found.pairs[:, 1]).all() and (found.length > 0).all()
    assert (found.total >= 0).all() and (found.total <= found.length + 1e-6).all()


def test_a_closed_contour_is_never_crossed() -> None:
    contour = np.zeros((60, 80), np.float32)
    contour[15:45, [20, 60]] = contour[[15, 44], 20:61] = 1.0
    found = watershed.regions_of(contour)
    inner, outer = np.zeros(contour.shape, bool), np.ones(contour.shape, bool)
    inner[16:44, 21:60] = True
    outer[15:45, 20:61] = False
    assert not set(found.labels[inner]) & set(found.labels[outer])


def test_a_gap_in_a_contour_still_divides_regions() -> None:
    contour = np.zeros((60, 80), np.float32)
    contour[:, 40] = 1.0
    contour[28:32, 40] = 0.0
    found = watershed.regions_of(contour)
    assert not set(found.labels[5:20, :35].ravel()) & set(found.labels[5:20, 46:].ravel())


def test_the_number_of_regions_is_bounded() -> None:
    assert watershed.regions_of(np.clip(noise(1), 0, 1), 10).count == 10


def slow_merge(regions: Regions) -> list[tuple[frozenset[int], float]]:
    """The sets of regions that the merges make, and their strengths, by the definition: all pairs are compared anew."""
    size = dict(enumerate(np.bincount(regions.labels.ravel(), minlength=regions.count).astype(float).tolist()))
    table = {
        (int(a), int(b)): (float(t), float(n))
        for (a, b), t, n in zip(regions.pairs, regions.total, regions.length, strict=True)
    }
    holds = {i: frozenset([i]) for i in size}
    full = hierarchy.FULL_SIZE * regions.labels.size
    made = []

    def gain(i: int) -> float:
        return float(np.minimum(size[i] / full, 1.0) ** hierarchy.SIZE_POWER)

    while table:
        strength = {pair: t / n * min(gain(pair[0]), gain(pair[1])) for pair, (t, n) in table.items()}
        a, b = min(strength, key=lambda pair: (strength[pair], pair))
        holds[a] |= holds.pop(b)
        size[a] += size.pop(b)
        made.append((holds[a], strength[a, b]))
        del table[a, b]
        for pair in [p for p in table if b in p]:
            t, n = table.pop(pair)
            other = pair[0] if pair[1] == b else pair[1]
            new = (min(a, other), max(a, other))
            before = table.get(new, (0.0, 0.0))
            table[new] = (before[0] + t, before[1] + n)
    return made


@pytest.mark.parametrize("seed", range(4))
def test_merging_agrees_with_the_definition(seed: int) -> None:
    regions = watershed.regions_of(np.clip(noise(seed), 0, 1))
    assert regions.count > 20
    found = hierarchy.merge(regions)
    holds = [frozenset([i]) for i in range(regions.count)]
    for k in range(regions.count - 1):
        children = np.flatnonzero(found.parent == regions.count + k)
        assert len(children) == 2
        holds.append(holds[children[0]] | holds[children[1]])
    slow = slow_merge(regions)
    assert holds[regions.count :] == [sets for sets, _ in slow]
    # The order of additions is the same, so only the power function may round differently.
    np.testing.assert_allclose(found.height, [strength for _, strength in slow], rtol=1e-9)


@given(contour_maps())
@settings(max_examples=40, deadline=None)
def test_strengths_never_fall_and_stay_in_range(contour: Any) -> None:
    found = hierarchy.merge(watershed.regions_of(contour))
    assert (np.diff(found.height) >= 0).all() and (found.height >= 0).all() and (found.height <= 1 + 1e-6).all()
    assert len(found.parent) == 2 * found.count - 1 and (found.parent[:-1] >= found.count).all()
    saliency = found.saliency()
    assert saliency[-1] == 0 and len(saliency) == len(found.parent)


def test_equal_strengths_merge_the_first_regions_first() -> None:
    labels = np.repeat(np.arange(4, dtype=np.int32), 500)[None]
    found = hierarchy.merge(watershed.borders(labels, np.full(labels.shape, 0.5, np.float32)))
    assert found.parent.tolist() == [4, 4, 5, 6, 5, 6, -1]


# -- masks


def masks_of(picture: Any, name: str = "network") -> ViewMasks:
    return detector.load(name).masks(picture, eye(picture.shape[2], picture.shape[1]))


def colored(seed: int = 0, height: int = 60, width: int = 80) -> Any:
    """A picture with a noisy disc before a noisy ground of two colours."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[:height, :width]
    picture = np.zeros((8, height, width), np.float32)
    picture[:3] = np.where(x < width / 2, 0.3, 0.7)
    picture[:3][:, (x - 25) ** 2 + (y - 30) ** 2 < 15**2] = np.array([0.8, 0.2, 0.2])[:, None]
    picture[:3] += rng.normal(0, 0.03, picture[:3].shape).astype(np.float32)
    return picture.clip(0, 1)


@pytest.mark.parametrize("seed", range(3))
def test_layers_are_laminar_and_each_partitions_the_picture(seed: int) -> None:
    view = masks_of(colored(seed))
    layers = view.layers
    assert (layers >= 0).all() and len(layers) >= 2 and len(np.unique(layers[0])) <= MAX_MASKS
    assert set(np.unique(layers)) == set(range(len(view)))  # no mask without pixels
    for fine, coarse in pairwise(layers):
        pairs = np.unique(np.stack([fine.ravel(), coarse.ravel()]), axis=1)
        assert len(pairs[0]) == len(np.unique(fine))  # a fine region lies in one coarse region
        assert len(np.unique(coarse)) < len(np.unique(fine))


def test_scores_are_probabilities_and_grow_towards_whole_things() -> None:
    view = masks_of(colored())
    assert set(view.labels) == {""} and (view.scores >= 0).all() and (view.scores <= 1).all()
    top = view.scores[np.unique(view.layers[-1])]
    assert view.scores[np.unique(view.layers[0])].mean() < (top.mean() if len(top) > 1 else 1)


@pytest.mark.parametrize("name", detector.NAMES)
def test_the_disc_is_one_mask(name: str) -> None:
    view = masks_of(colored(), name)
    y, x = np.mgrid[:60, :80]
    disc = (x - 25) ** 2 + (y - 30) ** 2 < 15**2
    best = max(
        float(((layer == i) & disc).sum() / ((layer == i) | disc).sum())
        for layer in view.layers
        for i in np.unique(layer)
    )
    assert best > 0.85  # the rim is three pixels wide


def test_masks_are_the_same_every_time() -> None:
    one, again = masks_of(colored()), masks_of(colored())
    assert one.ids.tobytes() == again.ids.tobytes() and one.scores.tobytes() == again.scores.tobytes()


def test_a_plain_picture_is_one_region_by_the_classical_method() -> None:
    view = masks_of(np.zeros((8, 40, 50), np.float32), "classical")
    assert view.ids.shape == (1, 40, 50) and (view.ids == 0).all() and view.scores.tolist() == [0.0]


def test_contours_follow_depth_where_it_is_known() -> None:
    picture = np.zeros((8, 60, 80), np.float32)
    picture[3], picture[6], picture[7] = 1.0, -1.0, 1.0
    picture[3, :, 40:] = 0.5
    assert contours(picture)[10:50, 38:43].max(axis=1).min() > 0.5
    picture[3:] = 0
    assert contours(picture).max() < 0.01


@pytest.mark.parametrize("name", detector.NAMES)
def test_probabilities_rise_with_strength(name: str) -> None:
    found = detector.load(name).probability(np.linspace(0, 1, 50))
    assert (np.diff(found) >= 0).all() and found[0] < 0.01 and found[-1] > 0.9


@pytest.mark.parametrize(("height", "width"), [(32, 48), (33, 47), (5, 9), (100, 30)])
def test_the_network_takes_pictures_of_any_size(height: int, width: int) -> None:
    picture = np.random.default_rng(0).random((8, height, width)).astype(np.float32)
    found = network.contours(picture)
    assert found.shape == (height, width) and found.dtype == np.float32 and 0 <= found.min() <= found.max() <= 1
    assert found.tobytes() == network.contours(picture).tobytes()
    whole = network.padded(picture)
    assert all(side % network.STRIDE == 0 for side in whole.shape[1:]) and (whole[:, :height, :width] == picture).all()


def test_broken_weights_are_a_back_end_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(network, "WEIGHTS", tmp_path / "contours.onnx")
    network.session.cache_clear()
    with pytest.raises(BackendError, match="reinstall"):
        detector.load("network")
    network.session.cache_clear()


def test_an_unknown_detector_is_a_back_end_error() -> None:
    with pytest.raises(BackendError, match="unknown detector of contours"):
        detector.load("magic")

"""Training of the contour network: true borders, augmentation, the loss, and the measure."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from scenewright.gaussians.errors import UserError
from scenewright.training.contours import augment, calibrate, fit, measure, raster, shading, solids, textures, worlds
from scenewright.training.contours.dataset import Pictures
from scenewright.training.contours.model import STRIDE, Contours


def pictures(count: int = 3, height: int = 48, width: int = 64) -> Pictures:
    """Squares of random colours on a grey ground, each a thing of its own."""
    rng = np.random.default_rng(1)
    picture = np.full((count, height, width, 3), 128, np.uint8)
    things = np.ones((count, height, width), np.uint8)
    for n in range(count):
        for k in range(3):
            row, col = rng.integers(4, 20), rng.integers(4, 40)
            window = (n, slice(row, row + 14), slice(col, col + 18))
            picture[window], things[window] = rng.integers(0, 255, 3), 7 + k
    inverse = np.full((count, height, width), 0.5, np.float16)
    return Pictures(picture, things, inverse, np.full(count, 60.0, np.float32))


@settings(max_examples=30)
@given(st.integers(0, 1000))
def test_borders_lie_on_both_sides_of_every_change_and_nowhere_else(seed: int) -> None:
    things = np.random.default_rng(seed).integers(7, 10, (9, 11))
    border = augment.borders(things)
    for row in range(9):
        for col in range(11):
            beside = [(row + r, col + c) for r, c in ((1, 0), (-1, 0), (0, 1), (0, -1))]
            inside = [p for p in beside if 0 <= p[0] < 9 and 0 <= p[1] < 11]
            assert border[row, col] == any(things[p] != things[row, col] for p in inside)


def test_where_two_walls_meet_is_left_open_but_wall_against_floor_is_a_border() -> None:
    things = np.array([[2, 2, 3, 3], [2, 2, 3, 3], [1, 1, 1, 1], [1, 1, 1, 1]])
    assert augment.borders(things).tolist() == [[0, 2, 2, 0], [1, 1, 1, 1], [1, 1, 1, 1], [0, 0, 0, 0]]


def test_a_sample_depends_on_its_seed_only_and_leaves_the_pictures_alone() -> None:
    data = pictures()
    before = replace(data, picture=data.picture.copy(), things=data.things.copy())
    one, two = (augment.sample(data, np.random.default_rng(4), 32) for _ in range(2))
    assert (one.channels == two.channels).all() and (one.border == two.border).all()
    assert (data.picture == before.picture).all() and (data.things == before.things).all()
    other = augment.sample(data, np.random.default_rng(5), 32)
    assert (one.channels != other.channels).any()


def test_samples_stay_in_the_ranges_of_the_interface_and_half_lack_depth() -> None:
    data = pictures()
    samples = [augment.sample(data, np.random.default_rng(seed), 32).channels for seed in range(40)]
    known = [bool(s[7].any()) for s in samples]
    assert 8 <= sum(known) <= 32  # binomial(40, 1/2): outside with a chance of 1e-4
    for channels in samples:
        assert np.isfinite(channels).all()
        assert channels[:3].min() >= 0 and channels[:3].max() <= 1
        assert not channels[3:7][:, channels[7] == 0].any()
        length = np.linalg.norm(channels[4:7], axis=0)[channels[7] == 1]
        np.testing.assert_allclose(length, 1, atol=1e-4)


def test_normals_of_a_plane_facing_the_camera_point_at_it() -> None:
    layers = augment.geometry_of(np.full((20, 30), 0.25, np.float32), 40.0)
    np.testing.assert_allclose(layers[0], 1, atol=1e-6)
    np.testing.assert_allclose(layers[1:4].reshape(3, -1).T, np.tile([0, 0, -1.0], (600, 1)), atol=1e-5)


def test_the_loss_ignores_open_pixels_and_prefers_the_truth() -> None:
    border = torch.zeros(1, 16, 16, dtype=torch.uint8)
    border[:, :, 8] = 1
    border[:, 3] = 2
    right = (border == 1).float()[:, None] * 12 - 6
    other = right.clone()
    other[:, :, 3] = 99.0
    assert fit.loss_of([right], border) == fit.loss_of([other], border)
    assert fit.loss_of([right], border) < 0.3 * fit.loss_of([torch.zeros_like(right)], border)


@pytest.mark.slow  # the first step of an optimiser loads much of torch
def test_training_takes_the_given_steps_and_repeats_by_seed() -> None:
    data = pictures()
    effort = fit.Effort(minutes=0, steps=2, seed=3, side=32, batch=2)
    small = Contours((4, 4, 8, 8, 8), (0, 0, 1, 1, 1))
    threads = torch.get_num_threads()
    torch.set_num_threads(1)  # sums over threads vary by rounding
    one, two = (fit.train(data, effort, lambda line: None, small) for _ in range(2))
    torch.set_num_threads(threads)
    assert one.steps == 2
    for a, b in zip(one.net.state_dict().values(), two.net.state_dict().values(), strict=True):
        assert torch.equal(a, b)


def test_calibration_finds_the_scale_and_shift_of_logits() -> None:
    g = torch.Generator().manual_seed(0)
    logits = torch.randn(40_000, generator=g) * 2
    truth = (torch.rand(40_000, generator=g) < torch.sigmoid(0.6 * logits - 1)).float()
    scale, shift = calibrate._fitted(logits, truth)
    assert scale == pytest.approx(0.6, abs=0.03) and shift == pytest.approx(-1, abs=0.05)  # three standard errors


def test_the_network_returns_logits_of_three_scales() -> None:
    with torch.inference_mode():
        outputs = Contours().eval()(torch.zeros(2, 8, 2 * STRIDE, 3 * STRIDE))
    assert [tuple(o.shape) for o in outputs] == [(2, 1, 32, 48), (2, 1, 16, 24), (2, 1, 8, 12)]


def test_figures_are_perfect_for_the_truth_and_drop_with_what_is_wrong() -> None:
    things = pictures(1).things[0]
    case = measure.Case(np.zeros((8, *things.shape), np.float32), measure.lines(things), np.ones(things.shape, bool))
    exact = measure.figures([case], lambda channels: (augment.borders(things) == 1).astype(np.float32), 2.0)
    assert exact["f_best"] == 1.0 and exact["average_precision"] == 1.0
    half = case.line.astype(np.float32).copy()
    half[: things.shape[0] // 2] = 0
    lost = measure.figures([case], lambda channels: half, 2.0)
    assert lost["precision_best"] == 1.0 and 0.2 < lost["recall_best"] < 0.9
    noise = measure.figures([case], lambda channels: np.random.default_rng(0).random(things.shape).astype("f4"), 2.0)
    assert noise["precision_best"] < 0.8


def test_the_rasteriser_keeps_the_nearer_triangle_and_its_weights() -> None:
    wide = np.array([[-9, -9, 4], [9, -9, 4], [0, 18, 4]], np.float32)
    near = wide * 0.25
    near[:, 0] += 1.2
    inverse, face, bary = raster.rasterise(np.stack([wide, near]), 20.0, 40, 30)
    assert set(np.unique(face)) == {0, 1}
    np.testing.assert_allclose(inverse[face == 0], 0.25, rtol=1e-5)
    np.testing.assert_allclose(inverse[face == 1], 1.0, rtol=1e-5)
    rows, cols = np.nonzero(face == 0)
    b, c = bary[rows, cols].T
    point = (1 - b - c)[:, None] * wide[0] + b[:, None] * wide[1] + c[:, None] * wide[2]
    np.testing.assert_allclose(point[:, 0] / 4 * 20 + 20, cols + 0.5, atol=1e-3)
    np.testing.assert_allclose(point[:, 1] / 4 * 20 + 15, rows + 0.5, atol=1e-3)


def test_normals_of_a_block_point_outward() -> None:
    block = solids.block(1.0, 2.0, 0.5)
    middle = block.corners - np.array([0, 0, 0.25], np.float32)
    assert ((middle * block.normals).sum(axis=2) > 0).all()
    np.testing.assert_allclose(block.size, [1, 2, 0.5], atol=1e-6)


def test_a_folder_without_an_index_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"index\.json is missing; give --meshes a folder"):
        solids.foreign(tmp_path)


@pytest.mark.slow  # compiles the kernels of light and texture
@pytest.mark.parametrize("name", sorted(worlds.MAKERS))
def test_photographs_of_a_world_repeat_by_seed_and_show_several_things(name: str) -> None:
    pool = (solids.block(0.3, 0.2, 0.4), solids.own("chair", 1), solids.own("mug", 2))
    shots = []
    for _ in range(2):
        rng = np.random.default_rng(7)
        prints = textures.random_prints(rng, count=4)
        world = worlds.MAKERS[name][0](rng, pool)
        shots.append(next(s for _ in range(20) if (s := shading.photograph(world, rng, prints)) is not None))
    one, two = shots
    for column in ("picture", "things", "inverse"):
        assert (getattr(one, column) == getattr(two, column)).all()
    assert len(np.unique(one.things)) >= 4
    assert one.picture.std() > 5  # neither black nor burnt out
    assert ((one.inverse > 0) == (one.things > 0)).mean() > 0.999  # half precision rounds no depth to 0


@pytest.mark.slow
def test_textures_repeat_and_stay_in_range() -> None:
    uv = np.random.default_rng(0).uniform(-2, 2, (500, 2)).astype(np.float32)
    prints = textures.random_prints(np.random.default_rng(1), count=2, side=16)
    own, rows = np.full((500, 3), 0.5, np.float32), np.zeros(500, np.int32)
    flat = None
    for kind in textures.Kind:
        table = np.zeros((1, textures.WIDTH), np.float32)
        table[0, :9] = [kind, 0.2, 0.3, 0.4, 0.9, 0.8, 0.7, 3.0, 5.0]
        table[0, textures.Slot.AMOUNT] = 1
        one, two = (textures.paint(table, rows, uv, own, prints) for _ in range(2))
        assert (one == two).all() and one.min() >= 0 and one.max() <= 1
        if kind == textures.Kind.FLAT:
            flat = one
            np.testing.assert_allclose(one, np.tile([0.2, 0.3, 0.4], (500, 1)), atol=1e-6)
        else:
            assert flat is not None and np.abs(one - flat).max() > 0.02, kind

"""Fits by blocks: space is divided once, parts of photographs are views, blocks learn among what stays, stops cost
nothing."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import FileError, UserError
from scenewright.gaussians.files.captures.colmap import Points
from scenewright.gaussians.fit import Photos, Settings, fit
from scenewright.gaussians.fit import blocks as by_blocks
from scenewright.gaussians.fit.blocks import blocks_for, cells, cropped, fit_by_blocks, parts_of
from scenewright.gaussians.fit.densify import MCMCStrategy
from scenewright.gaussians.fit.engine import CpuEngine, EngineFactory
from scenewright.gaussians.fit.engine_torch import TorchEngine
from scenewright.gaussians.fit.layers import Layers
from scenewright.gaussians.fit.parameters import Parameters
from scenewright.gaussians.fit.train import Shot
from scenewright.gaussians.render import differentiable, render
from scenewright.gaussians.render.cpu import gradient


def street(count: int = 240, seed: int = 1) -> GaussianCloud:
    """Coloured blobs along x, 6 units long."""
    g = torch.Generator().manual_seed(seed)
    means = (torch.rand(count, 3, generator=g) - 0.5) * torch.tensor([6.0, 1.0, 1.0])
    quats = torch.nn.functional.normalize(torch.randn(count, 4, generator=g), dim=1)
    return GaussianCloud.create(
        means, quats, torch.rand(count, 3, generator=g) * 0.08 + 0.05, torch.rand(count, generator=g) * 0.5 + 0.4,
        torch.randn(count, 1, 3, generator=g),
    )  # fmt: skip


def photos(count: int = 20) -> Photos:
    """Photographs on both sides of the street, each of about half of it."""
    cloud = street()
    shots = []
    for i, x in enumerate(np.linspace(-2.5, 2.5, count)):
        eye = (float(x), 2.5 if i % 2 else -2.5, 0.6 * math.sin(i))
        camera = Camera.look_at(eye, (float(x), 0, 0), (0, 0, 1), 72, 40, name=f"p{i:03d}")
        shots.append(Shot(camera, render(cloud, camera).to_uint8()))
    rng = np.random.default_rng(0)
    points = Points(cloud.means.double().numpy() + rng.normal(0, 0.02, (len(cloud), 3)), rng.random((len(cloud), 3)))
    held_out = tuple(shots[3::8])
    return Photos(tuple(s for s in shots if s not in held_out), held_out, points, 3.8)


SETTINGS = Settings(steps=500, max_gaussians=400, degree=0, gain=None)


def bytes_of(cloud: GaussianCloud) -> bytes:
    return b"".join(column.numpy().tobytes() for _, column in cloud.columns())


@given(st.integers(1, 9), st.integers(9, 60), st.integers(0, 10))
def test_every_point_lies_in_one_cell_and_cells_hold_about_as_many(count: int, points: int, seed: int) -> None:
    where = np.random.default_rng(seed).normal(size=(points, 3)).astype(np.float32)
    division = cells(where, count)
    held = np.stack([cell.holds(where) for cell in division])
    assert len(division) == count and (held.sum(axis=0) == 1).all()
    assert (np.abs(held.sum(axis=1) - points / count) <= 1 + math.log2(count)).all()
    far = np.array([[1e6, -1e6, 0], [-1e6, 1e6, 1e6]], np.float32)  # space has no end
    assert (np.stack([cell.holds(far) for cell in division]).sum(axis=0) == 1).all()


def test_a_part_of_a_photograph_is_what_its_camera_sees() -> None:
    shot = photos().shots[0]
    part = cropped(shot, 10, 5, 50, 33)
    assert part.photo.shape == (28, 40, 3)
    np.testing.assert_array_equal(part.photo, render(street(), part.camera).to_uint8())


def test_parts_show_the_block_and_photographs_that_do_not_are_left_out() -> None:
    shown, cloud = photos().shots, street(2_000)
    division = cells(cloud.means.numpy(), 4)
    end = max(range(4), key=lambda i: float(division[i].low[0]))
    parts = parts_of(shown, cloud, division)
    assert len(parts) == 4 and 0 < len(parts[end]) < len(shown)
    assert {p.camera.name for p in parts[end]} <= {s.camera.name for s in shown if s.camera.position[0] > 0}
    assert min(p.camera.width for p in parts[end]) < 72  # some are cut
    covered = sum(p.camera.width * p.camera.height for each in parts for p in each)
    assert covered >= 0.6 * sum(s.camera.width * s.camera.height for s in shown)


def test_points_seen_are_where_the_surface_is() -> None:
    camera, there = photos().shots[0].camera, np.array([-2.4, 0.2, 0.1])
    x, y, z = camera.world_to_camera[:3, :3] @ there + camera.world_to_camera[:3, 3]
    row, column = int(camera.fy * y / z + camera.cy), int(camera.fx * x / z + camera.cx)
    depth = np.full((camera.height, camera.width), z, np.float32)
    pixel = z / camera.fx
    assert np.linalg.norm(by_blocks.points_seen(camera, depth)[row, column] - there) <= pixel


def test_cells_hide_one_another_in_the_order_in_which_rays_meet_them() -> None:
    rng = np.random.default_rng(3)
    division = cells(rng.normal(size=(200, 3)).astype(np.float32), 7)
    for eye, toward in rng.normal(size=(300, 2, 3)):
        points = eye + np.linspace(0, 4, 200)[:, None] * toward
        met = np.argmax([cell.holds(points) for cell in division], axis=0)
        order = [int(met[0]), *(int(k) for k, before in zip(met[1:], met[:-1], strict=True) if k != before)]
        for i, first in enumerate(order):
            for second in order[i + 1 :]:
                assert by_blocks.hides(division[first], division[second], eye)
                assert not by_blocks.hides(division[second], division[first], eye)


def along_camera() -> Camera:
    """Looks along the street from its end."""
    return Camera.look_at((-5.0, 0.0, 0.0), (0, 0, 0), (0, 0, 1), 72, 40, name="along")


def along() -> tuple[GaussianCloud, list[by_blocks.Cell], Shot]:
    """The street, its three cells, and a photograph along it, in which depths are sorted as the cells are.

    It is faint, so that no ray ends: among layers, each ends by itself.
    """
    cloud = street()
    cloud = cloud.replace(opacities=0.15 * cloud.opacities)
    camera = along_camera()
    return cloud, cells(cloud.means.numpy(), 3), Shot(camera, render(cloud, camera).to_uint8(), share=0.5)


def own_and_around(block: int) -> tuple[NDArray[np.bool_], Layers]:
    """The rows of a cell of the street, and what is around it in the photograph."""
    cloud, division, shot = along()
    inside = division[block].holds(cloud.means.numpy())
    (layered,) = by_blocks.among([shot], cloud[torch.from_numpy(~inside)], block, division)
    assert layered.around is not None
    return inside, layered.around


@pytest.mark.parametrize("block", [0, 1, 2])
def test_a_block_among_layers_is_drawn_and_learns_as_among_the_gaussians(block: int) -> None:
    cloud, _, shot = along()
    inside, layers = own_and_around(block)
    columns = Parameters.of(cloud).columns()
    whole, own = (gradient.draw(c, shot.camera, (0, 0, 0)) for c in (columns, tuple(c[inside] for c in columns)))
    # Each of three numbers is rounded by at most half of 1/8192.
    np.testing.assert_allclose(layers.merge(own.rgb, own.alpha), whole.rgb, atol=2e-4)
    slope = np.random.default_rng(1).normal(size=whole.rgb.shape).astype(np.float32)
    wanted = gradient.draw_backward(whole, slope, np.zeros(slope.shape[:2], np.float32))
    found = gradient.draw_backward(own, *layers.split(slope))
    for name, values in vars(found).items():
        expected = vars(wanted)[name][inside] * layers.share
        assert np.abs(values - expected).max() <= 5e-4 * np.abs(expected).max(), name  # of rounding, as above


def test_engines_learn_the_same_among_layers() -> None:
    cloud, _, shot = along()
    inside, layers = own_and_around(1)
    made = []
    factories: list[EngineFactory] = [CpuEngine, partial(TorchEngine, device="cpu", draw=differentiable.draw)]
    for factory in factories:
        quiet = MCMCStrategy(400, np.random.default_rng(0), noise_lr=0.0)
        engine = factory(Parameters.of(cloud[torch.from_numpy(inside)]), quiet, 0.2)
        made.append((engine.train_step(shot.camera, 1 - shot.colors, 1e-3, layers), engine.fetch()))
    (loss, one), (other_loss, other) = made
    assert loss == pytest.approx(other_loss, rel=1e-5)
    for name, values in one.optimisers.items():
        expected = other.optimisers[name].first
        assert np.abs(values.first - expected).max() <= 1e-4 * np.abs(expected).max(), name  # sums in another order


def test_layers_of_half_the_size_are_those_of_a_photograph_of_half_the_size() -> None:
    _, layers = own_and_around(1)
    half = layers.half_size()
    assert half.values.shape == (20, 36, 7) and half.share == layers.share
    np.testing.assert_allclose(half.values[3, 5], layers.values[6:8, 10:12].mean(axis=(0, 1)), atol=0.5)


@given(st.integers(3, 40), st.integers(0, 50), st.integers(0, 1))
def test_some_photographs_are_different_ones_all_along(parts: int, count: int, lap: int) -> None:
    camera = along_camera()
    shots = [Shot(camera, np.full((1, 1, 3), i, np.uint8)) for i in range(parts)]
    chosen = sorted(int(s.photo[0, 0, 0]) for s in by_blocks._some(shots, count, lap))
    assert len(chosen) == len(set(chosen)) == min(parts, max(3, count))
    assert max(np.diff([*chosen, chosen[0] + parts])) <= math.ceil(parts / len(chosen))


@pytest.mark.slow
def test_counted_in_seconds_layers_are_drawn_for_as_many_photographs_as_their_time_allows() -> None:
    shots = tuple(Shot(along_camera(), np.full((1, 1, 3), i, np.uint8)) for i in range(60))

    def slow(parts: Sequence[Shot], others: GaussianCloud) -> list[Shot]:
        time.sleep(0.01 * len(parts))
        return list(parts)

    turn = by_blocks._Turn(0, 0, 0.5, 0.5, shots, slow)
    shown, taken = by_blocks._within(0.3, turn, street(3))
    assert 3 <= len(shown) <= 30 and taken >= 0.01 * (3 + len(shown))  # a sleep is never shorter than it says
    done = fit_by_blocks(photos(), Settings(seconds=1.5, max_gaussians=400, degree=0, gain=None), 3)
    assert done.steps >= 7 and math.isfinite(done.quality.psnr)  # everything, and three blocks twice


@pytest.mark.slow
def test_blocks_learn_what_they_are_shown_to_the_same_bytes_and_go_on_after_a_stop(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = photos()
    whole, coarse = fit(shown, SETTINGS), fit(shown, replace(SETTINGS, steps=200, max_gaussians=160))
    once = fit_by_blocks(shown, SETTINGS, 3)
    assert once.quality.psnr > coarse.quality.psnr + 1  # dB: the blocks learnt more
    assert once.quality.psnr > whole.quality.psnr - 1.5  # a third of 500 steps, each with less than a third to learn
    assert len(once.scene.cloud) <= 400 and len(once.scene.cameras) == 20

    folder, made = tmp_path / "out.blocks", by_blocks._block
    calls = []

    def stopped(*given: object) -> object:
        calls.append(given)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return made(*given)  # type: ignore[arg-type]

    monkeypatch.setattr(by_blocks, "_block", stopped)
    with pytest.raises(KeyboardInterrupt):
        fit_by_blocks(shown, SETTINGS, 3, folder=folder)
    assert sorted(p.name for p in folder.iterdir()) == ["coarse", "round-1-block-1"]
    statuses: list[float] = []
    again = fit_by_blocks(shown, SETTINGS, 3, folder=folder, on_status=lambda s: statuses.append(s.share))
    assert len(calls) == 2 + 5  # the first of six was kept
    assert bytes_of(again.scene.cloud) == bytes_of(once.scene.cloud)
    assert statuses == sorted(statuses) and statuses[0] > 0.4 and statuses[-1] == pytest.approx(1)
    with pytest.raises(FileError, match=r"of another training.*delete it"):
        fit_by_blocks(shown, replace(SETTINGS, seed=1), 3, folder=folder)
    with pytest.raises(FileError, match="or length"):
        fit_by_blocks(shown, replace(SETTINGS, steps=600), 3, folder=folder)
    (folder / "round-1-block-2").write_bytes(b"torn")
    with pytest.raises(FileError, match=r"cannot resume from .*block-2"):
        fit_by_blocks(shown, SETTINGS, 3, folder=folder)
    (folder / "mine.txt").write_text("x")
    by_blocks.delete(folder)
    assert [p.name for p in folder.iterdir()] == ["mine.txt"]


def test_numbers_of_blocks() -> None:
    assert blocks_for(200_000) == 1 and blocks_for(500_001) == 2 and blocks_for(10**9) == by_blocks.MOST_BLOCKS
    with pytest.raises(UserError, match="--blocks must be from 2 to"):
        fit_by_blocks(photos(), SETTINGS, 1)
    with pytest.raises(UserError, match="cannot be divided into 300 blocks"):
        cells(np.zeros((20, 3), np.float32), 300)

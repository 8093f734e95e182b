"""bench render: the pairs that must be blended, the bare block that is timed, the garden, and what is told of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from scenewright.benchmarks import _floor, _garden
from scenewright.benchmarks import render as bench
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.render import cpu, reference
from scenewright.gaussians.render.cpu import lanes, layout, simd, touch


def layers(count: int, opacity: float) -> tuple[GaussianCloud, Camera]:
    """So many Gaussians one behind the other, each far wider than the picture of 20x13 pixels."""
    means = torch.zeros(count, 3)
    means[:, 2] = torch.arange(count) / 10
    columns = (means, torch.tensor([[1.0, 0, 0, 0]]).repeat(count, 1), torch.full((count, 3), 1e3))
    cloud = GaussianCloud.create(*columns, torch.full((count,), opacity), torch.zeros(count, 1, 3))
    return cloud, Camera.look_at([0, 0, -5], [0, 0, 0], [0, -1, 0], 20, 13)


# The pixel is finished before the layer that would leave it 1e-4: 0.5^13 is above that, 0.5^14 is not.
@pytest.mark.parametrize(("count", "opacity", "each"), [(8, 0.5, 8), (30, 0.5, 13), (5, 0.9999, 1), (5, 1 / 300, 0)])
def test_pairs_are_what_pixels_blend(count: int, opacity: float, each: int) -> None:
    assert reference.count_blends(*layers(count, opacity)) == 20 * 13 * each


def test_the_bare_block_blends_every_pair_that_is_counted() -> None:
    chunk = np.zeros((touch.CHUNK, layout.RECORD), np.float32)
    chunk[:, layout.SHIFT] = -np.log(_floor.ALPHA) / 8
    state = np.zeros(simd.STATE, np.float32)
    _floor._blend_often(chunk.reshape(-1), np.uint64(2**touch.CHUNK - 1), state, cpu.LIMITS, 3)
    left = (1 - _floor.ALPHA) ** touch.CHUNK
    # float32, 64 products, and an exponential good to 1e-6 of alpha
    np.testing.assert_allclose(state[: lanes.LANES], left, rtol=1e-4)
    assert left > cpu.LIMITS[1]


def test_the_garden_is_its_points_with_shapes_of_one_seed(tmp_path: Path) -> None:
    rng, path = np.random.default_rng(3), tmp_path / _garden.FILE
    pose = Camera.look_at([0, 0, -4], [0, 0, 0], [0, -1, 0]).world_to_camera.astype(np.float32)
    lens = np.array([[480, 0, 320], [0, 481, 210], [0, 0, 1]], np.float32)
    points, colors = rng.normal(size=(50, 3)).astype(np.float32), rng.integers(0, 256, (50, 3), dtype=np.uint8)
    np.savez(
        path,
        means3d=points,
        colors=colors,
        viewmats=pose[None],
        Ks=lens[None],
        width=np.int64(640),
        height=np.int64(420),
    )
    cloud, camera = _garden.load(path, 0)
    assert torch.equal(cloud.means, torch.from_numpy(points)) and cloud.scales.max() <= _garden.LARGEST
    shown = (cloud.sh[:, 0] * 0.28209479177387814 + 0.5) * 256
    assert torch.equal(shown.floor().to(torch.uint8), torch.from_numpy(colors))
    assert (camera.fx, camera.fy, camera.cx, camera.cy, camera.width, camera.height) == (480, 481, 320, 210, 640, 420)
    again, other = _garden.load(path, 0)[0], _garden.load(path, 1)[0]
    assert torch.equal(again.quats, cloud.quats) and not torch.equal(other.quats, cloud.quats)


def test_raster_and_floor_are_told_of_every_case(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SCENEWRIGHT_DATA", str(tmp_path))
    monkeypatch.setattr(bench, "SYNTHETIC", 4000)
    monkeypatch.setattr(bench, "QUICK_SIZES", ((64, 48),))
    found = {metric.key: metric.value for metric in bench.run(quick=True).metrics}
    key = "spheres.64x48"
    assert found[f"{key}.raster"] == found[f"{key}.stage.draw"] > 0
    assert found[f"{key}.raster_over_floor"] == pytest.approx(found[f"{key}.raster"] / found[f"{key}.floor"])
    assert 64 * 48 < found[f"{key}.pairs"] < 64 * 48 * 400


def test_goals_are_of_scenes_and_sizes_that_are_measured() -> None:
    for goal in bench.GOALS:
        scene, size, _ = goal.split(".", 2)
        assert scene in {*bench.VIEWS, "garden"}
        assert size in {f"{wide}x{high}" for wide, high in bench.SIZES}

"""No input breaks a renderer: degenerate numbers, near planes, huge footprints, odd memory, several threads."""

from __future__ import annotations

import logging
import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest
import torch
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scenewright.gaussians import compiled, files
from scenewright.gaussians.camera import Camera, Render
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.render import backends, contributions, cpu, render
from scenewright.gaussians.render.cpu import layout, project, simd

every_backend = pytest.mark.parametrize("backend", [b for b in backends() if b != "cuda"])  # test_cuda.py
CAMERA = Camera.look_at([0, -3, 0.5], [0, 0, 0], [0, 0, 1], 37, 29)
# Everything that has ever upset a rasteriser.
WILD = [0.0, -0.0, 1e-45, 1e-30, 1e-8, 1e-3, 0.5, 1.0, -1.0, 3.0, 1e4, 1e10, -1e19, 1e19, 3e38, math.inf, -math.inf]
wild = st.sampled_from([*WILD, math.nan])


def cloud_of(rows: list[list[float]], k: int = 1) -> GaussianCloud:
    """Rows of mean 3, quat 4, scale 3, opacity 1, colour 3; harmonics above the constant repeat the colour."""
    table = torch.tensor(rows, dtype=torch.float32).reshape(-1, 14)
    columns = table[:, 0:3], table[:, 3:7], table[:, 7:10], table[:, 10], table[:, None, 11:14].repeat(1, k, 1)
    return GaussianCloud.create(*(column.contiguous() for column in columns))


def assert_sound(picture: Render) -> None:
    for channel in (picture.rgb, picture.alpha, picture.depth):
        assert bool(torch.isfinite(channel).all())
    assert float(picture.alpha.min()) >= 0 and float(picture.alpha.max()) <= 1
    assert float(picture.rgb.min()) >= 0 and float(picture.depth.min()) >= 0


def same_bytes(a: Render, b: Render) -> bool:
    return all(torch.equal(x, y) for x, y in zip(vars(a).values(), vars(b).values(), strict=True))


def blob(mean: tuple[float, float, float], scale: float, opacity: float = 0.9) -> list[float]:
    return [*mean, 1, 0, 0, 0, scale, scale, scale, opacity, 1, 0.5, 0]


@every_backend
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(rows=st.lists(st.lists(wild, min_size=14, max_size=14), max_size=5), k=st.sampled_from([1, 4, 9, 16]))
def test_wild_numbers_never_give_nan(backend: str, rows: list[list[float]], k: int) -> None:
    sane = [blob((0.1, 0, 0), 0.2), blob((-0.2, 0.5, 0), 0.1)]
    cloud = cloud_of(rows + sane, k)
    assert_sound(render(cloud, CAMERA, backend=backend))
    seen = contributions(cloud, CAMERA, backend=backend)
    assert bool(torch.isfinite(seen).all()) and float(seen.min()) >= 0


@every_backend
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("place", range(14))
def test_rows_that_are_not_finite_are_left_out(backend: str, place: int, value: float) -> None:
    sane = [blob((0.1, 0, 0), 0.2), blob((-0.2, 0.5, 0), 0.1)]
    broken = blob((0, -0.5, 0), 0.3)
    broken[place] = value
    picture = render(cloud_of([sane[0], broken, sane[1]]), CAMERA, backend=backend)
    assert same_bytes(picture, render(cloud_of(sane), CAMERA, backend=backend))


@every_backend
def test_behind_at_and_across_the_near_plane(backend: str) -> None:
    rows = [blob((0, -3 + along, 0.5), 0.5, 0.5) for along in (-2, -0.5, -1e-6, 0, 1e-6, 0.005, 0.011, 0.1, 0.5)]
    picture = render(cloud_of(rows), CAMERA, backend=backend)
    assert_sound(picture)
    behind = render(cloud_of(rows[:5]), CAMERA, backend=backend)
    assert not behind.alpha.any()


@every_backend
def test_flat_huge_and_unturned_gaussians_are_drawn(backend: str) -> None:
    flat = [*blob((0, 0, 0), 0.0)]
    picture = render(cloud_of([flat]), CAMERA, backend=backend)
    assert_sound(picture)
    assert 0 < float(picture.alpha.sum()) < 4  # a point is as large as the dilation: about two pixels
    huge = render(cloud_of([blob((0, 0, 0), 1e4, 0.5)]), CAMERA, backend=backend)
    # sigma is 1e5 px: constant over the picture; its group and depth are those of the one Gaussian
    torch.testing.assert_close(huge.alpha, torch.full((29, 37), 0.5), rtol=0, atol=1e-4)
    unturned = blob((0, 0, 0), 0.2)
    unturned[3:7] = [0, 0, 0, 0]
    assert same_bytes(
        render(cloud_of([unturned]), CAMERA, backend=backend),
        render(cloud_of([blob((0, 0, 0), 0.2)]), CAMERA, backend=backend),
    )


@every_backend
def test_opacity_at_its_ends(backend: str) -> None:
    solid, gone = blob((0, 0, 0), 0.3, 1.0), blob((0, -1, 0), 0.3, 0.0)
    picture = render(cloud_of([solid, gone]), CAMERA, backend=backend)
    assert_sound(picture)
    assert float(picture.alpha.max()) == pytest.approx(0.999, abs=1e-6)
    assert same_bytes(picture, render(cloud_of([solid]), CAMERA, backend=backend))


# The CPU back end


def crowd(n: int = 3000, seed: int = 0) -> GaussianCloud:
    rng = np.random.default_rng(seed)
    table = np.concatenate(
        [
            rng.normal(size=(n, 3)) * 0.4, rng.normal(size=(n, 4)), np.exp(rng.uniform(-5, -2, (n, 3))),
            rng.uniform(0.05, 0.99, (n, 1)), rng.normal(size=(n, 3)),
        ],
        axis=1,
    )  # fmt: skip
    cloud = cloud_of(table.tolist())
    return cloud.replace(group=torch.tensor(rng.integers(-1, 9, n), dtype=torch.int32))


def test_bytes_do_not_depend_on_the_number_of_workers(monkeypatch: pytest.MonkeyPatch) -> None:
    cloud, camera = crowd(5000), CAMERA.resized(200, 130)
    pictures, seen = [], []
    for count in (1, 2, 3, 7):
        monkeypatch.setattr(compiled, "workers", lambda count=count: count)
        pictures.append(render(cloud, camera, backend="cpu"))
        seen.append(contributions(cloud, camera, backend="cpu"))
    assert all(same_bytes(pictures[0], other) for other in pictures[1:])
    assert all(torch.equal(seen[0], other) for other in seen[1:])


def test_a_picture_in_strips_is_the_same_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    cloud, camera = crowd(), CAMERA.resized(160, 150)
    whole, seen = render(cloud, camera, backend="cpu"), contributions(cloud, camera, backend="cpu")
    monkeypatch.setattr(cpu, "MAX_ENTRIES", 500)
    strips = render(cloud, camera, backend="cpu")
    # Rows are counted from the strip's top, which rounds differently: 1e-5 px.
    assert float((whole.rgb - strips.rgb).square().mean()) < 1e-8
    assert (whole.group == strips.group).float().mean() > 0.999
    torch.testing.assert_close(contributions(cloud, camera, backend="cpu"), seen, rtol=1e-3, atol=1e-3)


def test_several_threads_may_draw_at_once() -> None:
    clouds = [crowd(2000, seed) for seed in range(4)]
    alone = [render(cloud, CAMERA) for cloud in clouds]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda i: render(clouds[i % 4], CAMERA), range(24)))
    assert all(same_bytes(alone[i % 4], picture) for i, picture in enumerate(together))


def test_equal_depths_keep_the_order_of_rows() -> None:
    """Depth ties are broken by row, in a crowd that fills several chunks and workers."""
    rows = [blob((0.0, 0.0, 0.0), 0.3, 0.5) for _ in range(4500)]
    for i, row in enumerate(rows):
        row[10] = 0.5 if i in (17, 4400) else 0.0
    rows[17][11:14], rows[4400][11:14] = [1, 0, 0], [-1, 0, 0]
    cloud = cloud_of(rows).replace(group=torch.arange(4500, dtype=torch.int32))
    assert int(render(cloud, CAMERA).group[14, 18]) == 17


def test_footprints_of_every_tile_span() -> None:
    """One to many tiles in each direction, around the 8x8 limit of the mask: against the readable renderer."""
    camera = Camera.look_at([0, -3, 0], [0, 0, 0], [0, 0, 1], 401, 299)
    rng = np.random.default_rng(5)
    rows = []
    for wide in np.exp(np.linspace(-4, 0.5, 14)):
        for high in (0.01, 0.1, 0.6):
            row = blob(tuple(rng.uniform(-0.8, 0.8, 3)), 0.1, 0.3)
            row[3:7] = list(rng.normal(size=4))
            row[7:10] = [wide, high, 0.02]
            rows.append(row)
    fast, slow = render(cloud_of(rows), camera, backend="cpu"), render(cloud_of(rows), camera, backend="reference")
    assert float((fast.rgb - slow.rgb).square().mean()) < 1e-8  # 80 dB
    assert float((fast.alpha - slow.alpha).square().mean()) < 1e-8


def test_exponential_is_accurate_to_three_millionths() -> None:
    q = np.linspace(0, layout.Q_MAX, 100_001, dtype=np.float32)
    value = np.full_like(q, np.float32(simd.EXP_COEFFICIENTS[-1]))
    for coefficient in simd.EXP_COEFFICIENTS[-2::-1]:
        value = value * q + np.float32(coefficient)
    value = ((value**2) ** 2) ** 2
    # 0.9e-6 of the fit, and eight times the rounding of a float32 (6e-8, a few of them) that is squared three times.
    assert np.abs(value / np.exp(-8 * q.astype(np.float64)) - 1).max() < 3e-6


@pytest.mark.parametrize("count", [0, 1, 7, 5000])
def test_each_record_lies_on_one_cache_line(count: int) -> None:
    records = compiled.make_lines(count, layout.RECORD, np.float32)
    assert records.shape == (count, layout.RECORD) and records.flags.c_contiguous
    assert records.ctypes.data % 64 == 0 or count == 0


def test_footprints_at_the_last_tile_are_counted_in_it() -> None:
    """Each image ends with the tile that the dots lie in: the places beside and below it belong to no tile."""
    cloud = cloud_of([blob((x / 8, 0, z / 8), 0.01) for x in range(-8, 9) for z in range(-6, 7)])
    for width, height in ((16, 16), (17, 17), (32, 16), (16, 32), (48, 48)):
        camera = Camera.look_at([0, -3, 0], [0, 0, 0], [0, 0, 1], width, height)
        fast, slow = (render(cloud, camera, backend=name) for name in ("cpu", "reference"))
        assert float((fast.alpha - slow.alpha).abs().max()) < 1e-4  # float32 rounding of sums over 221 dots


def test_machine_code_is_kept_under_the_name_of_all_sources() -> None:
    folder = Path(project.__file__).parent
    assert compiled.fingerprint(folder) in project.project.py_func.__qualname__


def test_kernels_compile_where_machine_code_cannot_be_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """numba raises when no cache folder can be written; the renderer must start all the same."""

    def no_folder(**options: object) -> Any:
        if options.pop("cache", False):
            raise RuntimeError("cannot cache function: no locator available")
        return numba.njit(**options)

    monkeypatch.setattr(compiled, "njit", no_folder)

    def add_one(x: int) -> int:
        return x + 1

    assert compiled.kernel(add_one)(41) == 42


def test_compiling_is_announced_in_the_log(caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
    def fresh() -> None: ...

    made = compiled.kernel(fresh)
    fresh.__qualname__ = "fresh_absent"  # as if nothing of its folder had ever been compiled
    monkeypatch.setattr(compiled, "_announced", set())
    with caplog.at_level(logging.INFO):
        compiled._announce(made)
        compiled._announce(made)
    assert [record.message for record in caplog.records if "compiling" in record.message] == [caplog.records[0].message]


@pytest.mark.slow
def test_an_8k_picture() -> None:
    camera = CAMERA.resized(7680, 4320)
    picture = render(crowd(200), camera)
    assert picture.rgb.shape == (4320, 7680, 3)
    small = render(crowd(200), CAMERA.resized(960, 540))
    # Dilation widens the smallest footprints of the small picture by about a pixel.
    assert float(picture.alpha.mean()) == pytest.approx(float(small.alpha.mean()), abs=0.01)


# Real scenes

VIEWS = {
    "guitar.compressed.ply": ([1.3, -1.2, 3.2], [0, -0.9, 0.1]),
    "playbot/2_0": ([1.1, -0.9, 1.5], [0, -0.4, 0]),
    "bonsai_room.ply": ([-0.6, -1.5, 3.9], [0.5, 0.5, 0]),
}


@pytest.mark.parametrize("name", VIEWS)
@pytest.mark.slow
def test_fast_and_readable_agree_on_real_scenes(data_dir: Path, name: str) -> None:
    cloud = files.load(data_dir / "scenes" / name).cloud
    eye, target = VIEWS[name]
    camera = Camera.look_at(eye, target, [0, -1, 0], 96, 64, 40)
    fast, slow = render(cloud, camera, backend="cpu"), render(cloud, camera, backend="reference")
    # Thousands of Gaussians a pixel ray: some alphas flip across 1/255, each worth up to 4e-3 in its pixel.
    error = (fast.rgb - slow.rgb).square().mean()
    assert float(error) < 10**-7.5  # 75 dB
    assert float((fast.alpha - slow.alpha).abs().mean()) < 1e-4
    assert float((fast.depth - slow.depth).abs().median()) < 1e-4 * float(slow.depth.max())
    assert float(fast.alpha.max()) > 0.5  # the view shows something


@pytest.mark.parametrize("name", VIEWS)
def test_a_crop_is_a_piece_of_the_picture(data_dir: Path, name: str) -> None:
    """Moving the principal point crops: the same pixels from other tiles, blocks and lanes."""
    cloud = files.load(data_dir / "scenes" / name).cloud
    eye, target = VIEWS[name]
    camera = Camera.look_at(eye, target, [0, -1, 0], 160, 120, 40)
    whole = render(cloud, camera)
    x, y, width, height = 37, 21, 75, 51
    crop = render(cloud, replace(camera, cx=camera.cx - x, cy=camera.cy - y, width=width, height=height))
    error = (crop.rgb - whole.rgb[y : y + height, x : x + width]).square().mean()
    # The Jacobian's clamp follows the image, so large Gaussians beyond the crop's border look different inside it.
    assert float(error) < 1e-5


@every_backend
def test_a_world_in_other_units_gives_the_same_picture(backend: str) -> None:
    """Its near plane too: a hundredth of a unit is a metre where a metre is a hundredth of a unit."""
    g = torch.Generator().manual_seed(5)
    rows = [blob((x, y, z), 0.03) for x, y, z in torch.rand(200, 3, generator=g).mul(4).sub(2).tolist()]
    rows += [blob((0.0, -2.7, 0.5), 0.02), blob((0.05, -2.6, 0.48), 0.01)]  # 30 and 40 cm from the eye
    cloud, step = cloud_of(rows), 2.0**-7
    small = cloud.replace(means=cloud.means * step, scales=cloud.scales * step)
    camera = replace(CAMERA, world_to_camera=CAMERA.world_to_camera * np.array([[1, 1, 1, step]] * 3 + [[1, 1, 1, 1]]))
    one, other = render(cloud, CAMERA, backend=backend), render(small, camera, backend=backend)
    assert float((one.alpha - other.alpha).abs().max()) < 1e-5
    assert float((one.rgb - other.rgb).abs().max()) < 1e-5

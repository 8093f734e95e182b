"""Training: that it learns a scene it is shown, goes on where it ended to the same bytes, and says what is wrong."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from scenewright.gaussians import rotations
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import FileError, UserError
from scenewright.gaussians.files.captures.colmap import Points
from scenewright.gaussians.fit import Photos, Settings, fit, take_photos
from scenewright.gaussians.fit.densify import Budgeted, Classic, shared
from scenewright.gaussians.fit.parameters import Parameters, chained
from scenewright.gaussians.fit.quality import beside, measure
from scenewright.gaussians.fit.train import Shot, along_a_curve, halved
from scenewright.gaussians.render import render


def world(count: int = 300) -> GaussianCloud:
    """Coloured blobs in a ball."""
    g = torch.Generator().manual_seed(1)
    means = torch.nn.functional.normalize(torch.randn(count, 3, generator=g), dim=1) * torch.rand(count, 1, generator=g)
    quats = torch.nn.functional.normalize(torch.randn(count, 4, generator=g), dim=1)
    return GaussianCloud.create(
        means, quats, torch.rand(count, 3, generator=g) * 0.1 + 0.03, torch.rand(count, generator=g) * 0.5 + 0.4,
        torch.randn(count, 1, 3, generator=g),
    )  # fmt: skip


def around(count: int, side: int = 48) -> list[Camera]:
    angles = np.linspace(0, 2 * math.pi, count, endpoint=False)
    return [
        Camera.look_at((3 * math.cos(a), 3 * math.sin(a), 0.8 * math.sin(3 * a)), (0, 0, 0), (0, 0, 1), side, side - 8,
                       name=f"p{i:03d}")
        for i, a in enumerate(angles)
    ]  # fmt: skip


def photos(count: int = 16) -> Photos:
    cloud = world()
    shots = [Shot(c, render(cloud, c).to_uint8()) for c in around(count)]
    rng = np.random.default_rng(0)
    points = Points(cloud.means.double().numpy() + rng.normal(0, 0.02, (len(cloud), 3)), rng.random((len(cloud), 3)))
    return Photos(tuple(shots[1:]), tuple(shots[:1]), points, 3.3)


@pytest.mark.parametrize("growth", ["budgeted", "classic"])
def test_training_learns_what_it_is_shown(growth: Any) -> None:
    shown = photos()
    short, long = (fit(shown, Settings(steps=n, most=400, degree=1, growth=growth)) for n in (1, 450))
    assert long.quality.psnr > short.quality.psnr + 8  # dB on a photograph that it never saw
    assert long.quality.ssim > short.quality.ssim and len(long.scene.cloud) <= 400
    assert long.scene.cloud.degree == 1 and [c.name for c in long.scene.cameras] == sorted(c.name for c in around(16))


def test_counted_in_steps_the_same_seed_gives_the_same_bytes_and_another_one_does_not() -> None:
    shown, settings = photos(8), Settings(steps=320, most=360)
    clouds = [fit(shown, s).scene.cloud for s in (settings, settings, replace(settings, seed=1))]
    first, again, other = (b"".join(c.numpy().tobytes() for _, c in cloud.columns()) for cloud in clouds)
    assert first == again != other


def test_training_goes_on_from_its_checkpoint_to_the_same_bytes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown, kept = photos(8), tmp_path / "scene.ply.checkpoint"
    settings = Settings(steps=620, most=360, gain=0.1)  # tries a band at 300, leaves out Gaussians at 500
    whole = fit(shown, settings).scene.cloud

    class Killed(Exception): ...

    def killed(status: Any) -> None:
        if status.steps > 530:
            raise Killed

    monkeypatch.setattr("scenewright.gaussians.fit.fitting.KEEP_EVERY", 0.0)
    monkeypatch.setattr("scenewright.gaussians.fit.fitting.TELL_EVERY", 0.0)
    with pytest.raises(Killed):
        fit(shown, settings, kept=kept, told=killed)
    assert kept.exists()
    begun: list[int] = []
    resumed = fit(shown, settings, kept=kept, told=lambda status: begun.append(status.steps)).scene.cloud
    assert begun[0] == 501 and kept.exists()  # until whoever saves the scene drops it
    assert all(torch.equal(a, b) for (_, a), (_, b) in zip(whole.columns(), resumed.columns(), strict=True))


def test_checkpoints_of_another_training_and_broken_ones_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = tmp_path / "c"
    kept.write_bytes(b"nonsense")
    with pytest.raises(FileError, match=r"is no checkpoint to go on from .*; delete it"):
        fit(photos(8), Settings(steps=2, most=300), kept=kept)
    kept.unlink()
    monkeypatch.setattr("scenewright.gaussians.fit.fitting.KEEP_EVERY", 0.0)
    monkeypatch.setattr(Path, "unlink", lambda *_, **__: None)
    fit(photos(8), Settings(steps=301, most=300), kept=kept)
    with pytest.raises(FileError, match="is of another training"):
        fit(photos(8), Settings(steps=301, most=300, seed=4), kept=kept)


def test_a_full_disk_ends_training_with_a_clear_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scenewright.gaussians.fit.fitting.KEEP_EVERY", 0.0)
    (tmp_path / "file").write_text("")
    with pytest.raises(FileError):
        fit(photos(8), Settings(steps=310, most=300), kept=tmp_path / "file" / "checkpoint")


def test_without_points_training_starts_from_scattered_ones() -> None:
    shown = replace(photos(), points=Points(np.zeros((0, 3)), np.zeros((0, 3))))
    short, long = (fit(shown, Settings(steps=n, most=4000)) for n in (1, 400))
    assert long.quality.psnr > short.quality.psnr + 1 and long.quality.ssim > short.quality.ssim + 0.3


@pytest.mark.parametrize("wrong", [{}, {"seconds": 1.0, "steps": 1}, {"steps": 0}, {"seconds": math.inf},
                                   {"steps": 1, "most": 0}, {"steps": 1, "degree": 4}])  # fmt: skip
def test_impossible_settings_are_refused(wrong: Any) -> None:
    with pytest.raises(UserError):
        Settings(**wrong)


# -- growth ----------------------------------------------------------------------------------------------------------


@given(st.floats(0.01, 0.99), st.integers(2, 20))
def test_copies_together_let_through_what_the_one_did(opacity: float, times: int) -> None:
    each, scales = shared(np.float32([opacity]), np.ones((1, 3), np.float32), np.array([times]))
    assert (1 - each[0]) ** times == pytest.approx(1 - np.float32(opacity), rel=1e-5)
    assert 0 < each[0] < opacity and np.isfinite(scales).all() and (scales > 0).all()


def test_copies_look_like_the_one_they_came_from() -> None:
    """One wide Gaussian against three in its place, drawn: the same picture within a few hundredths."""
    camera = Camera.look_at((0, -4, 0), (0, 0, 0), (0, 0, 1), 64, 64)
    each, scales = shared(np.float32([0.8]), np.full((1, 3), 0.5, np.float32), np.array([3]))

    def drawn(count: int, opacity: float, scale: float) -> torch.Tensor:
        quats = torch.tensor([[1.0, 0, 0, 0]]).repeat(count, 1)
        cloud = GaussianCloud.create(
            torch.zeros(count, 3), quats, torch.full((count, 3), scale), torch.full((count,), opacity),
            torch.ones(count, 1, 3),
        )  # fmt: skip
        return render(cloud, camera).alpha

    one, three = drawn(1, 0.8, 0.5), drawn(3, float(each[0]), float(scales[0, 0]))
    assert float((one - three).abs().max()) < 0.08 and float((one - three).mean().abs()) < 0.01


def test_budgeted_growth_keeps_to_its_number_and_moves_what_has_faded() -> None:
    rng = np.random.default_rng(0)
    parameters = Parameters.of(world(100))
    parameters.logits[:20] = -9.0
    strategy = Budgeted(104, rng)
    strategy.change(parameters, 300)
    assert len(parameters) == 104 and (parameters.opacities > 0.005).all()
    strategy.change(parameters, 400)
    assert len(parameters) == 104


def test_budgeted_growth_copies_where_the_pictures_pull() -> None:
    rng = np.random.default_rng(0)
    parameters = Parameters.of(world(100))
    strategy = Budgeted(140, rng, share=0.4)
    before = parameters.opacities.copy()
    pulled = np.zeros((100, 2), np.float32)
    pulled[10:20] = 1e-3
    strategy.stepped(parameters, pulled, (100, 100), 0.0)
    strategy.change(parameters, 300)
    changed = np.flatnonzero(parameters.opacities[:100] != before)
    assert len(parameters) == 140 and set(changed) <= set(range(10, 20)) and len(changed) > 5


def test_classic_growth_clones_small_ones_splits_large_ones_and_prunes_faint_ones() -> None:
    cloud = world(4)
    scales = torch.tensor([[0.001] * 3, [0.5] * 3, [0.05] * 3, [0.05] * 3])
    parameters = Parameters.of(cloud.replace(scales=scales))
    parameters.logits[3] = -9.0
    strategy = Classic(1.0, np.random.default_rng(0))
    pulled = np.float32([[1, 0], [1, 0], [0, 0], [0, 0]])
    strategy.stepped(parameters, pulled, (100, 100), 0.1)
    strategy.change(parameters, 300)
    widths = np.sort(np.exp(parameters.logs)[:, 0])
    assert np.allclose(widths, [0.001, 0.001, 0.05, 0.5 / 1.6, 0.5 / 1.6])


def test_classic_growth_makes_everything_faint_now_and_then() -> None:
    parameters = Parameters.of(world(50))
    Classic(1.0, np.random.default_rng(0)).change(parameters, 3000)
    assert parameters.opacities.max() <= 0.0101


# -- parameters ------------------------------------------------------------------------------------------------------


def test_parameters_are_the_cloud_in_other_numbers() -> None:
    cloud = world(80)
    back = Parameters.of(cloud).cloud()
    for name, column in cloud.columns():
        assert torch.allclose(getattr(back, name), column, atol=1e-6), name


def test_gradients_by_parameters_are_those_of_autograd() -> None:
    cloud = world(30)
    parameters = Parameters.of(cloud)
    logs, logits = (torch.from_numpy(p).requires_grad_() for p in (parameters.logs, parameters.logits))
    (logs.exp().square().sum() + logits.sigmoid().pow(3).sum()).backward()  # type: ignore[no-untyped-call]
    _, _, scales, opacities, sh = parameters.columns()

    class Found:
        means = quats = np.zeros((30, 3), np.float32)

    Found.scales, Found.opacities, Found.sh = 2 * scales, 3 * opacities**2, sh  # type: ignore[attr-defined]
    made = chained(Found, scales, opacities)
    assert logs.grad is not None and np.allclose(made["logs"], logs.grad, rtol=1e-5)
    assert logits.grad is not None and np.allclose(made["logits"], logits.grad, rtol=1e-4)


def test_states_hold_everything() -> None:
    parameters = Parameters.of(world(10))
    parameters.widen(2)
    parameters.step({n: np.ones_like(v) for n, v in parameters.arrays().items()}, 0.1)
    again = Parameters.load(parameters.state())
    for name, value in parameters.arrays().items():
        assert np.array_equal(value, getattr(again, name))
        assert np.array_equal(parameters.memory[name].second, again.memory[name].second)
        assert parameters.memory[name].steps == again.memory[name].steps == 1


@given(st.integers(0, 300), st.integers(0, 100))
def test_the_curve_is_a_permutation(count: int, seed: int) -> None:
    means = np.random.default_rng(seed).normal(size=(count, 3)).astype(np.float32)
    if count:
        assert np.array_equal(np.sort(along_a_curve(means)), np.arange(count))


def test_a_halved_photograph_is_the_view_of_a_halved_camera() -> None:
    cloud, camera = world(), replace(around(1, 51)[0], cx=24.0)
    small, photo = halved(Shot(camera, render(cloud, camera).to_uint8()))
    right, left = (render(cloud, replace(small, cx=small.cx + shift)).rgb.numpy() for shift in (0.0, 0.5))
    assert photo.shape == (21, 25, 3)
    # not zero: footprints are widened by 0.3 px whatever the size
    assert np.abs(photo - right).mean() < 0.8 * np.abs(photo - left).mean()


def test_quality_of_the_scene_itself_is_that_of_8_bits() -> None:
    found = measure(world(), photos(8).shots)
    assert found.psnr > 50 and found.ssim > 0.99 and len(found.each) == 7
    assert math.isnan(measure(world(), []).psnr)
    assert beside(world(), photos(8).held[0]).shape == (40, 144, 3)


# -- photographs -----------------------------------------------------------------------------------------------------


def capture(folder: Path, count: int = 10, change: Callable[[dict[str, Any]], None] = lambda told: None) -> Path:
    """A capture of the world: photographs, transforms.json, and points as COLMAP's text."""
    cloud, cameras = world(), around(count)
    (folder / "images").mkdir(parents=True)
    (folder / "sparse/0").mkdir(parents=True)
    frames = []
    for camera in cameras:
        Image.fromarray(render(cloud, camera).to_uint8()).save(folder / "images" / f"{camera.name}.png")
        pose = np.linalg.inv(camera.world_to_camera) @ np.diag([1.0, -1.0, -1.0, 1.0])
        frames.append({"file_path": f"images/{camera.name}.png", "transform_matrix": pose.tolist()})
    one = cameras[0]
    told = {"fl_x": one.fx, "fl_y": one.fy, "cx": one.cx, "cy": one.cy, "w": one.width, "h": one.height,
            "frames": frames}  # fmt: skip
    change(told)
    (folder / "transforms.json").write_text(json.dumps(told))
    (folder / "sparse/0/cameras.txt").write_text("1 PINHOLE 48 40 50 50 24 20\n")
    (folder / "sparse/0/points3D.txt").write_text(
        "".join(f"{i} {x} {y} {z} 200 100 50 0.5\n" for i, (x, y, z) in enumerate(cloud.means.tolist()))
    )
    return folder


def test_photographs_are_read_and_one_in_eight_is_held_out(tmp_path: Path) -> None:
    taken = take_photos(capture(tmp_path))
    assert [s.camera.name for s in taken.held] == ["p000", "p008"] and len(taken.shots) == 8
    assert len(taken.points.means) == 300 and taken.shots[0].photo.shape == (40, 48, 3)
    half = take_photos(tmp_path, 0.5)
    assert half.shots[0].photo.shape == (20, 24, 3) and half.shots[0].camera.fx == taken.shots[0].camera.fx / 2


def _missing(told: dict[str, Any]) -> None:
    told["frames"][3]["file_path"] = "images/gone.png"


def _turned(told: dict[str, Any]) -> None:
    for frame in told["frames"]:
        frame["transform_matrix"] = (np.array(frame["transform_matrix"]) @ np.diag([1.0, -1, -1, 1])).tolist()


def _elsewhere(told: dict[str, Any]) -> None:
    for frame in told["frames"]:
        frame["transform_matrix"][0][3] += 500.0


def _other_size(told: dict[str, Any]) -> None:
    told["w"] = 100


def _few(told: dict[str, Any]) -> None:
    told["frames"] = told["frames"][:2]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (_missing, "gone.png is not there"),
        (_turned, "its poses are in OpenCV axes"),
        (_elsewhere, "poses and points are in different frames"),
        (_other_size, "is 48x40, its camera says 100x40; correct the intrinsics"),
        (_few, "has 2 photographs; at least 4 are needed"),
    ],
)
def test_what_is_wrong_with_a_capture_is_said(tmp_path: Path, change: Callable[..., None], said: str) -> None:
    with pytest.raises(FileError, match=said):
        take_photos(capture(tmp_path, change=change))


def test_a_photograph_that_is_none_is_named(tmp_path: Path) -> None:
    capture(tmp_path)
    (tmp_path / "images/p004.png").write_bytes(b"no picture")
    with pytest.raises(FileError, match=r"cannot read the photograph .*p004\.png"):
        take_photos(tmp_path)


def test_scales_beyond_the_whole_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="--scale must lie between 0 and 1"):
        take_photos(capture(tmp_path), 1.5)


def test_faint_gaussians_wander_along_their_axes_and_others_stay() -> None:
    parameters = Parameters.of(world(60))
    parameters.logs[:] = np.log(np.float32([0.1, 0.001, 0.001]))  # needles
    parameters.logits[:30] = -7.0
    before = parameters.means.copy()
    Budgeted(60, np.random.default_rng(0)).stepped(parameters, np.zeros((60, 2), np.float32), (9, 9), 1e-3)
    moved = parameters.means - before
    assert not moved[30:].any()
    quats = torch.nn.functional.normalize(torch.from_numpy(parameters.quats), dim=1)
    needle = rotations.to_matrix(quats)[:30, :, 0].numpy()
    along = np.abs((moved[:30] * needle).sum(axis=1))
    assert (np.linalg.norm(moved[:30], axis=1) <= along + 0.02).all() and along.mean() > 0.05

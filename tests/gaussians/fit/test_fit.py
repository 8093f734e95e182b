"""Training: it reproduces a known scene, resumes to the same bytes, and reports errors of captures and settings."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
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
from scenewright.gaussians.files.captures.capture import is_capture
from scenewright.gaussians.files.captures.colmap import Points
from scenewright.gaussians.fit import Photos, Settings, fit, load_photos
from scenewright.gaussians.fit.densify import DefaultStrategy, MCMCStrategy, compute_relocation
from scenewright.gaussians.fit.parameters import Parameters, parameter_gradients
from scenewright.gaussians.fit.quality import comparison, measure
from scenewright.gaussians.fit.train import Shot, half_size, morton_order
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
@pytest.mark.slow
def test_training_learns_what_it_is_shown(growth: Any) -> None:
    shown = photos()
    short, long = (fit(shown, Settings(steps=n, max_gaussians=400, degree=1, growth=growth)) for n in (1, 450))
    assert long.quality.psnr > short.quality.psnr + 8  # dB on a photograph that it never saw
    assert long.quality.ssim > short.quality.ssim and len(long.scene.cloud) <= 400
    assert long.scene.cloud.degree == 1 and [c.name for c in long.scene.cameras] == sorted(c.name for c in around(16))


@pytest.mark.slow
def test_counted_in_steps_the_same_seed_gives_the_same_bytes_and_another_one_does_not() -> None:
    shown, settings = photos(8), Settings(steps=320, max_gaussians=360)
    clouds = [fit(shown, s).scene.cloud for s in (settings, settings, replace(settings, seed=1))]
    first, again, other = (b"".join(c.numpy().tobytes() for _, c in cloud.columns()) for cloud in clouds)
    assert first == again != other


@pytest.mark.slow
def test_training_goes_on_from_its_checkpoint_to_the_same_bytes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown, kept = photos(8), tmp_path / "scene.ply.checkpoint"
    settings = Settings(steps=620, max_gaussians=360, gain=0.1)  # tries a band at 300, leaves out Gaussians at 500
    whole = fit(shown, settings).scene.cloud

    class Killed(Exception): ...

    def killed(status: Any) -> None:
        if status.steps > 530:
            raise Killed

    monkeypatch.setattr("scenewright.gaussians.fit.fitting.CHECKPOINT_EVERY", 0.0)
    monkeypatch.setattr("scenewright.gaussians.fit.fitting.REPORT_EVERY", 0.0)
    with pytest.raises(Killed):
        fit(shown, settings, checkpoint_path=kept, on_status=killed)
    assert kept.exists()
    begun: list[int] = []
    resumed = fit(
        shown, settings, checkpoint_path=kept, on_status=lambda status: begun.append(status.steps)
    ).scene.cloud
    assert begun[0] == 501 and kept.exists()  # until whoever saves the scene drops it
    assert all(torch.equal(a, b) for (_, a), (_, b) in zip(whole.columns(), resumed.columns(), strict=True))


def test_checkpoints_of_another_training_and_broken_ones_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = tmp_path / "c"
    kept.write_bytes(b"nonsense")
    with pytest.raises(FileError, match=r"cannot resume from .*; delete it"):
        fit(photos(8), Settings(steps=2, max_gaussians=300), checkpoint_path=kept)
    kept.unlink()
    monkeypatch.setattr("scenewright.gaussians.fit.fitting.CHECKPOINT_EVERY", 0.0)
    monkeypatch.setattr(Path, "unlink", lambda *_, **__: None)
    fit(photos(8), Settings(steps=301, max_gaussians=300), checkpoint_path=kept)
    with pytest.raises(FileError, match="is of another training"):
        fit(photos(8), Settings(steps=301, max_gaussians=300, seed=4), checkpoint_path=kept)


def test_a_full_disk_ends_training_with_a_clear_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scenewright.gaussians.fit.fitting.CHECKPOINT_EVERY", 0.0)
    (tmp_path / "file").write_text("")
    with pytest.raises(FileError):
        fit(photos(8), Settings(steps=310, max_gaussians=300), checkpoint_path=tmp_path / "file" / "checkpoint")


@pytest.mark.slow
def test_without_points_training_starts_from_scattered_ones() -> None:
    shown = replace(photos(), points=Points(np.zeros((0, 3)), np.zeros((0, 3))))
    short, long = (fit(shown, Settings(steps=n, max_gaussians=4000)) for n in (1, 400))
    assert long.quality.psnr > short.quality.psnr + 1 and long.quality.ssim > short.quality.ssim + 0.3


@pytest.mark.parametrize("wrong", [{}, {"seconds": 1.0, "steps": 1}, {"steps": 0}, {"seconds": math.inf},
                                   {"steps": 1, "max_gaussians": 0}, {"steps": 1, "degree": 4}])  # fmt: skip
def test_impossible_settings_are_refused(wrong: Any) -> None:
    with pytest.raises(UserError):
        Settings(**wrong)


# -- growth ----------------------------------------------------------------------------------------------------------


@given(st.floats(0.01, 0.99), st.integers(2, 20))
def test_relocated_copies_have_the_transmittance_of_the_original(opacity: float, times: int) -> None:
    each, scales = compute_relocation(np.float32([opacity]), np.ones((1, 3), np.float32), np.array([times]))
    assert (1 - each[0]) ** times == pytest.approx(1 - np.float32(opacity), rel=1e-5)
    assert 0 < each[0] < opacity and np.isfinite(scales).all() and (scales > 0).all()


def test_relocated_copies_look_like_the_original() -> None:
    """One wide Gaussian against three in its place, drawn: the same picture within a few hundredths."""
    camera = Camera.look_at((0, -4, 0), (0, 0, 0), (0, 0, 1), 64, 64)
    each, scales = compute_relocation(np.float32([0.8]), np.full((1, 3), 0.5, np.float32), np.array([3]))

    def drawn(count: int, opacity: float, scale: float) -> torch.Tensor:
        quats = torch.tensor([[1.0, 0, 0, 0]]).repeat(count, 1)
        cloud = GaussianCloud.create(
            torch.zeros(count, 3), quats, torch.full((count, 3), scale), torch.full((count,), opacity),
            torch.ones(count, 1, 3),
        )  # fmt: skip
        return render(cloud, camera).alpha

    one, three = drawn(1, 0.8, 0.5), drawn(3, float(each[0]), float(scales[0, 0]))
    assert float((one - three).abs().max()) < 0.08 and float((one - three).mean().abs()) < 0.01


def test_mcmc_keeps_to_cap_max_and_relocates_faint_gaussians() -> None:
    rng = np.random.default_rng(0)
    parameters = Parameters.of(world(100))
    parameters.logit_opacities[:20] = -9.0
    strategy = MCMCStrategy(104, rng)
    strategy.refine(parameters, 300)
    assert len(parameters) == 104 and (parameters.opacities > 0.005).all()
    strategy.refine(parameters, 400)
    assert len(parameters) == 104


def test_mcmc_copies_gaussians_with_large_centre_gradients() -> None:
    rng = np.random.default_rng(0)
    parameters = Parameters.of(world(100))
    strategy = MCMCStrategy(140, rng, grow_share=0.4)
    before = parameters.opacities.copy()
    pulled = np.zeros((100, 2), np.float32)
    pulled[10:20] = 1e-3
    strategy.after_step(parameters, pulled, (100, 100), 0.0)
    strategy.refine(parameters, 300)
    changed = np.flatnonzero(parameters.opacities[:100] != before)
    assert len(parameters) == 140 and set(changed) <= set(range(10, 20)) and len(changed) > 5


def test_default_strategy_clones_small_splits_large_and_prunes_faint_gaussians() -> None:
    cloud = world(4)
    scales = torch.tensor([[0.001] * 3, [0.5] * 3, [0.05] * 3, [0.05] * 3])
    parameters = Parameters.of(cloud.replace(scales=scales))
    parameters.logit_opacities[3] = -9.0
    strategy = DefaultStrategy(1.0, np.random.default_rng(0))
    pulled = np.float32([[1, 0], [1, 0], [0, 0], [0, 0]])
    strategy.after_step(parameters, pulled, (100, 100), 0.1)
    strategy.refine(parameters, 300)
    widths = np.sort(np.exp(parameters.log_scales)[:, 0])
    assert np.allclose(widths, [0.001, 0.001, 0.05, 0.5 / 1.6, 0.5 / 1.6])


def test_default_strategy_resets_opacities() -> None:
    parameters = Parameters.of(world(50))
    DefaultStrategy(1.0, np.random.default_rng(0)).refine(parameters, 3000)
    assert parameters.opacities.max() <= 0.0101


# -- parameters ------------------------------------------------------------------------------------------------------


def test_parameters_convert_back_to_the_cloud() -> None:
    cloud = world(80)
    back = Parameters.of(cloud).cloud()
    for name, column in cloud.columns():
        assert torch.allclose(getattr(back, name), column, atol=1e-6), name


def test_parameter_gradients_equal_those_of_autograd() -> None:
    cloud = world(30)
    parameters = Parameters.of(cloud)
    logs, logits = (torch.from_numpy(p).requires_grad_() for p in (parameters.log_scales, parameters.logit_opacities))
    (logs.exp().square().sum() + logits.sigmoid().pow(3).sum()).backward()  # type: ignore[no-untyped-call]
    _, _, scales, opacities, sh = parameters.columns()

    class Found:
        means = quats = np.zeros((30, 3), np.float32)

    Found.scales, Found.opacities, Found.sh = 2 * scales, 3 * opacities**2, sh  # type: ignore[attr-defined]
    made = parameter_gradients(Found, scales, opacities)
    assert logs.grad is not None and np.allclose(made["log_scales"], logs.grad, rtol=1e-5)
    assert logits.grad is not None and np.allclose(made["logit_opacities"], logits.grad, rtol=1e-4)


def test_states_are_complete() -> None:
    parameters = Parameters.of(world(10))
    parameters.raise_degree(2)
    parameters.step({n: np.ones_like(v) for n, v in parameters.arrays().items()}, 0.1)
    again = Parameters.load(parameters.state())
    for name, value in parameters.arrays().items():
        assert np.array_equal(value, getattr(again, name))
        assert np.array_equal(parameters.optimisers[name].second, again.optimisers[name].second)
        assert parameters.optimisers[name].steps == again.optimisers[name].steps == 1


@given(st.integers(0, 300), st.integers(0, 100))
def test_morton_order_is_a_permutation(count: int, seed: int) -> None:
    means = np.random.default_rng(seed).normal(size=(count, 3)).astype(np.float32)
    if count:
        assert np.array_equal(np.sort(morton_order(means)), np.arange(count))


def test_a_halved_photograph_is_the_view_of_a_halved_camera() -> None:
    cloud, camera = world(), replace(around(1, 51)[0], cx=24.0)
    small, photo = half_size(Shot(camera, render(cloud, camera).to_uint8()))
    right, left = (render(cloud, replace(small, cx=small.cx + shift)).rgb.numpy() for shift in (0.0, 0.5))
    assert photo.shape == (21, 25, 3)
    # not zero: footprints are widened by 0.3 px whatever the size
    assert np.abs(photo - right).mean() < 0.8 * np.abs(photo - left).mean()


def test_quality_of_the_scene_itself_is_that_of_8_bits() -> None:
    found = measure(world(), photos(8).shots)
    assert found.psnr > 50 and found.ssim > 0.99 and len(found.each) == 7
    assert math.isnan(measure(world(), []).psnr)
    assert comparison(world(), photos(8).held_out[0]).shape == (40, 144, 3)


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
    taken = load_photos(capture(tmp_path))
    assert [s.camera.name for s in taken.held_out] == ["p000", "p008"] and len(taken.shots) == 8
    assert len(taken.points.means) == 300 and taken.shots[0].photo.shape == (40, 48, 3)
    half = load_photos(tmp_path, 0.5)
    assert half.shots[0].photo.shape == (20, 24, 3) and half.shots[0].camera.fx == taken.shots[0].camera.fx / 2


def divided(folder: Path, tests: Sequence[str] = ("test", "val")) -> Path:
    """The capture as D-NeRF and Blender's scenes are written: a file and a folder for each part, names from r_000 on,
    one angle, no size, times from 0 to 1."""
    cloud, cameras = world(), around(12)
    parts = {"train": cameras[:8], **{name: cameras[8 + 2 * i : 10 + 2 * i] for i, name in enumerate(tests)}}
    for name, taken in parts.items():
        (folder / name).mkdir(parents=True)
        frames = []
        for i, camera in enumerate(taken):
            Image.fromarray(render(cloud, camera).to_uint8()).save(folder / name / f"r_{i:03d}.png")
            pose = np.linalg.inv(camera.world_to_camera) @ np.diag([1.0, -1.0, -1.0, 1.0])
            place = {"file_path": f"./{name}/r_{i:03d}", "transform_matrix": pose.tolist()}
            frames.append({**place, "time": i / max(len(taken) - 1, 1)})
        told = {"camera_angle_x": 2 * math.atan(cameras[0].width / 2 / cameras[0].fx), "frames": frames}
        (folder / f"transforms_{name}.json").write_text(json.dumps(told))
    return folder


@pytest.mark.parametrize("tests", [("test", "val"), ("val",), ()])
def test_a_capture_that_is_divided_is_held_out_as_its_makers_say(tmp_path: Path, tests: tuple[str, ...]) -> None:
    photos = load_photos(divided(tmp_path, tests))
    if not tests:  # then as any other film
        assert len(photos.shots) == 7 and len(photos.held_out) == 1
    else:
        assert len(photos.shots) == 8
        assert [shot.camera.name for shot in photos.held_out] == [f"{tests[0]}-r_000", f"{tests[0]}-r_001"]
        assert photos.notes[0].endswith(f"transforms_train.json; held out are those of transforms_{tests[0]}.json")
    assert photos.film and photos.notes[-1] == "times run from 0 to 1: taken as seconds"
    assert photos.shots[0].camera.fx == pytest.approx(around(12)[0].fx)
    assert is_capture(tmp_path)
    alone = load_photos(tmp_path / "transforms_train.json")
    assert len(alone.shots) == 7 and len(alone.held_out) == 1


def test_photographs_for_testing_that_are_not_there_are_not_asked_for(tmp_path: Path) -> None:
    folder = divided(tmp_path)
    (folder / "test" / "r_000.png").unlink()
    with pytest.raises(FileError, match="r_000 is missing"):
        load_photos(folder)
    photos = load_photos(folder, strict=False)
    assert photos.missing == ("r_000",) and [shot.camera.name for shot in photos.held_out] == ["test-r_001"]
    (folder / "test" / "r_001.png").unlink()
    assert [shot.camera.name for shot in load_photos(folder).held_out] == ["val-r_000", "val-r_001"]


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
        (_missing, "gone.png is missing"),
        (_turned, "its poses are in OpenCV axes"),
        (_elsewhere, "poses and points are in different frames"),
        (_other_size, "is 48x40, its camera says 100x40; correct the intrinsics"),
        (_few, "has 2 photographs; at least 4 are needed"),
    ],
)
def test_errors_of_a_capture_are_reported(tmp_path: Path, change: Callable[..., None], said: str) -> None:
    with pytest.raises(FileError, match=said):
        load_photos(capture(tmp_path, change=change))


def test_a_file_that_is_no_image_is_named(tmp_path: Path) -> None:
    capture(tmp_path)
    (tmp_path / "images/p004.png").write_bytes(b"no picture")
    with pytest.raises(FileError, match=r"cannot read the photograph .*p004\.png"):
        load_photos(tmp_path)


def test_scales_above_one_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="--scale must lie between 0 and 1"):
        load_photos(capture(tmp_path), 1.5)


def test_noise_moves_faint_gaussians_along_their_axes_only() -> None:
    parameters = Parameters.of(world(60))
    parameters.log_scales[:] = np.log(np.float32([0.1, 0.001, 0.001]))  # needles
    parameters.logit_opacities[:30] = -7.0
    before = parameters.means.copy()
    MCMCStrategy(60, np.random.default_rng(0)).after_step(parameters, np.zeros((60, 2), np.float32), (9, 9), 1e-3)
    moved = parameters.means - before
    assert not moved[30:].any()
    quats = torch.nn.functional.normalize(torch.from_numpy(parameters.quats), dim=1)
    needle = rotations.to_matrix(quats)[:30, :, 0].numpy()
    along = np.abs((moved[:30] * needle).sum(axis=1))
    assert (np.linalg.norm(moved[:30], axis=1) <= along + 0.02).all() and along.mean() > 0.05

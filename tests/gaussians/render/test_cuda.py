"""The GPU renderer against the CPU renderer: with a stand-in for gsplat's kernels (see conftest), and with gsplat on a
device where both are available."""

from __future__ import annotations

import importlib.util
import inspect
import math
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import gsplat_standin
import numpy as np
import pytest
import torch

from scenewright.gaussians import files
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import BackendError
from scenewright.gaussians.render import contributions, cuda, differentiable, render, split
from scenewright.gaussians.render.cuda import heaviest, splatting


@pytest.fixture
def gpu() -> None:
    """Skip without a GPU. Checked inside the test, since the check compiles gsplat's kernels."""
    if cuda.missing():
        pytest.skip(cuda.missing())


def cloud_of(seed: int, n: int = 150, degree: int = 1, groups: int = 5) -> GaussianCloud:
    """Gaussians of mixed shapes around the origin, some needles, some opaque, in `groups` groups and none."""
    rng = np.random.default_rng(seed)
    quats = rng.normal(size=(n, 4))
    quats /= np.linalg.norm(quats, axis=1, keepdims=True)
    columns = (
        rng.normal(size=(n, 3)) * 0.5, quats, np.exp(rng.uniform(-4.5, -1.5, (n, 3))), rng.uniform(0.02, 0.999, n),
        rng.normal(size=(n, (degree + 1) ** 2, 3)) * 0.3,
    )  # fmt: skip
    group = torch.tensor(rng.integers(-1, groups, n), dtype=torch.int32)
    return GaussianCloud.create(*(torch.tensor(c, dtype=torch.float32) for c in columns), group=group)


def camera_of(seed: int, width: int = 61, height: int = 45) -> Camera:
    """Three units away, the principal point off the centre, unequal focal lengths."""
    rng = np.random.default_rng(seed + 1000)
    eye = rng.normal(size=3)
    camera = Camera.look_at(3 * eye / np.linalg.norm(eye), rng.normal(size=3) * 0.2, rng.normal(size=3), width, height)
    return replace(camera, fx=camera.fx * 1.1, cx=camera.cx + 5.3, cy=camera.cy - 3.1)


def psnr(a: torch.Tensor, b: torch.Tensor) -> float:
    error = float((a.double() - b.double()).square().mean())
    return math.inf if error == 0 else -10 * math.log10(error)


# Through the stand-in


@pytest.mark.parametrize("seed, degree", [(0, 0), (1, 1), (2, 2), (3, 3)])
def test_pictures_are_those_of_the_cpu(gsplat: ModuleType, seed: int, degree: int) -> None:
    cloud, camera = cloud_of(seed, degree=degree), camera_of(seed)
    theirs, ours = (render(cloud, camera, (0.2, 0.5, 1.5), backend) for backend in ("cuda", "cpu"))
    # two float32 renderers agree to 1e-5 but where an alpha falls on the other side of 1/255
    assert psnr(theirs.rgb, ours.rgb) >= 80 and psnr(theirs.alpha, ours.alpha) >= 80
    assert psnr(theirs.depth, ours.depth) >= 70
    assert float((theirs.group == ours.group).float().mean()) >= 0.999  # two weights may tie to rounding
    assert all(
        a.dtype == b.dtype and a.shape == b.shape
        for a, b in zip(vars(theirs).values(), vars(ours).values(), strict=True)
    )


def test_gsplat_gets_arguments_in_its_own_conventions(gsplat: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[dict[str, Any]] = []
    plain = gsplat.rasterization

    def noted(**arguments: Any) -> Any:
        asked.append(arguments)
        return plain(**arguments)

    cloud, camera = cloud_of(4, n=20, degree=2), camera_of(4)
    render(cloud, camera)
    cuda.require()
    monkeypatch.setattr(gsplat, "rasterization", noted)
    render(cloud, camera, (0.25, 0.5, 0.75), "cuda")
    (told,) = asked
    assert told["sh_degree"] == 2 and told["colors"].shape == (20, 9, 3) and told["packed"] is False
    assert told["render_mode"] == "RGB+ED" and told["rasterize_mode"] == "classic"
    assert (told["width"], told["height"]) == (61, 45) and told["backgrounds"].tolist() == [[0.25, 0.5, 0.75]]
    wanted = torch.tensor([[camera.fx, 0, camera.cx], [0, camera.fy, camera.cy], [0, 0, 1]])
    assert torch.equal(told["Ks"][0], wanted)
    # world to camera, whichever of the two carries the eye
    seen = told["means"].double() @ told["viewmats"][0, :3, :3].double().T + told["viewmats"][0, :3, 3].double()
    pose = torch.from_numpy(camera.world_to_camera.copy())
    assert torch.allclose(seen, cloud.means.double() @ pose[:3, :3].T + pose[:3, 3], atol=1e-6)
    assert all(told[name].dtype == torch.float32 for name in ("means", "viewmats", "Ks", "backgrounds"))


def test_the_stand_in_refuses_unknown_arguments(gsplat: Any) -> None:
    with pytest.raises(TypeError, match="unexpected keyword"):
        gsplat.rasterization(background=None)


def test_contributions_and_shares_are_those_of_the_cpu(gsplat: ModuleType) -> None:
    cloud, camera = cloud_of(5), camera_of(5)
    # sums of some hundred float32 weights
    assert torch.allclose(contributions(cloud, camera, "cuda"), contributions(cloud, camera), rtol=1e-4, atol=1e-4)
    labels = np.random.default_rng(0).integers(-3, 70, (45, 61)) * 1000  # more than go in one pass
    theirs, ours = (split(cloud, camera, labels, backend) for backend in ("cuda", "cpu"))
    tables = [{(r, n): w for r, n, w in zip(s.rows, s.labels, s.weights, strict=True)} for s in (theirs, ours)]
    assert all(abs(tables[0].get(k, 0) - tables[1].get(k, 0)) < 1e-3 for k in tables[0].keys() | tables[1].keys())
    order = [(int(r), int(n)) for r, n in zip(theirs.rows, theirs.labels, strict=True)]
    assert order == sorted(order) and theirs.labels.dtype == np.int32 and theirs.weights.dtype == np.float32
    assert len(ours.rows) > 300


def test_a_cloud_of_one_group_skips_the_search_for_groups(gsplat: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cuda, "heaviest_rows", None)
    cloud, camera = cloud_of(6, groups=0), camera_of(6)
    for group in (-1, 3):
        alike = cloud.replace(group=torch.full_like(cloud.group, group))
        assert torch.equal(render(alike, camera, backend="cuda").group, render(alike, camera).group)


def test_layers_of_opaque_gaussians_finish_pixels(gsplat: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(heaviest, "MAX_ALPHAS", 1 << 12)  # few tiles at a time
    cloud = cloud_of(7, n=400)
    cloud = cloud.replace(opacities=torch.full((400,), 0.95), scales=cloud.scales * 0 + 0.4)
    theirs, ours = (render(cloud, camera_of(7), backend=backend) for backend in ("cuda", "cpu"))
    assert float((theirs.group == ours.group).float().mean()) >= 0.999
    assert psnr(theirs.rgb, ours.rgb) >= 75  # whether the transmittance clears 1e-4 can flip by rounding


def test_non_finite_values_and_huge_footprints_are_skipped(gsplat: ModuleType) -> None:
    """The stand-in refuses them, as the kernels cannot."""
    cloud, camera = cloud_of(8, n=60), camera_of(8)
    wild = [column.clone() for column in (cloud.means, cloud.quats, cloud.scales, cloud.opacities, cloud.sh)]
    wild[0][0], wild[1][1], wild[2][2], wild[3][3], wild[4][4, 2, 1] = math.nan, math.inf, math.inf, math.nan, math.nan
    wild[2][5], wild[1][6], wild[3][7] = 1e15, 0.0, 7.0
    broken = GaussianCloud.create(*wild, group=cloud.group)
    theirs, ours = (render(broken, camera, backend=backend) for backend in ("cuda", "cpu"))
    assert psnr(theirs.rgb, ours.rgb) >= 80 and float((theirs.group == ours.group).float().mean()) >= 0.999


def test_precision_is_kept_far_from_the_origin(gsplat: ModuleType) -> None:
    cloud, camera = cloud_of(9), camera_of(9)
    shift = np.array([8192.0, -4096.0, 2048.0])
    far = cloud.replace(means=cloud.means + torch.tensor(shift, dtype=torch.float32))
    pose = camera.world_to_camera.copy()
    pose[:3, 3] -= pose[:3, :3] @ shift
    there = replace(camera, world_to_camera=pose)
    assert psnr(render(far, there, backend="cuda").rgb, render(far, there).rgb) >= 75


def test_an_empty_cloud_is_rendered(gsplat: ModuleType) -> None:
    camera = camera_of(0)
    for cloud in (GaussianCloud.empty(2), cloud_of(0, n=3).replace(means=torch.full((3, 3), 1e4))):
        theirs, ours = (render(cloud, camera, (0.1, 0.2, 0.3), backend) for backend in ("cuda", "cpu"))
        assert all(torch.equal(a, b) for a, b in zip(vars(theirs).values(), vars(ours).values(), strict=True))
        seen = contributions(cloud, camera, "cuda")
        assert len(seen) == len(cloud) and not seen.any()
        assert len(split(cloud, camera, np.zeros((45, 61), np.int32), "cuda").rows) == 0


def test_columns_stay_on_the_device_while_the_cloud_lives(gsplat: ModuleType) -> None:
    cloud, other = cloud_of(10), cloud_of(11)
    first = cuda._on_device(cloud)
    assert cuda._on_device(cloud) is first
    assert torch.equal(cuda._on_device(other)[0], other.means)
    assert cuda._on_device(cloud) is not first
    del cloud
    assert cuda._cached is None


def test_gradients_are_those_of_the_cpu(gsplat: ModuleType) -> None:
    cloud, camera = cloud_of(12, n=60), camera_of(12)
    weight = torch.randn(45, 61, 3, generator=torch.Generator().manual_seed(0))
    found = []
    for draw in (splatting.draw, differentiable.draw):
        leaves = [
            c.clone().requires_grad_() for c in (cloud.means, cloud.quats, cloud.scales, cloud.opacities, cloud.sh)
        ]
        centers = torch.zeros(60, 2, requires_grad=True)
        rgb, alpha = draw(*leaves, camera, (0.2, 0.4, 0.6), centers)
        ((rgb * weight).sum() + alpha.sum()).backward()  # type: ignore[no-untyped-call]
        found.append([leaf.grad for leaf in (*leaves, centers)])
    for theirs, ours in zip(*found, strict=True):
        assert theirs is not None and ours is not None
        # float32 on both sides, sums over thousands of pixels with cancellation
        assert float((theirs - ours).norm()) <= 1e-3 * float(ours.norm()) and float(ours.norm()) > 0


# What can be missing


def test_without_gsplat_the_error_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    found = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name, *rest: None if name == "gsplat" else found(name, *rest)
    )
    cloud, camera = cloud_of(0, n=3), camera_of(0)
    for call in (render, contributions):
        with pytest.raises(BackendError, match=r"gsplat is not installed; pip install .scenewright\[cuda\]"):
            call(cloud, camera, backend="cuda")
    with pytest.raises(BackendError, match="--backend cpu"):
        split(cloud, camera, np.zeros((45, 61), np.int32), "cuda")


def test_without_a_device_the_error_says_so(gsplat: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(splatting, "DEVICE", "cuda")
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    with pytest.raises(BackendError, match="finds no CUDA device; install a driver"):
        render(cloud_of(0, n=3), camera_of(0), backend="cuda")


def test_kernels_that_do_not_compile_are_reported(gsplat: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: Any, **__: Any) -> None:
        raise AttributeError("'NoneType' object has no attribute 'CameraModelType'\nand more")

    monkeypatch.setattr(gsplat, "rasterization", broken)
    with pytest.raises(
        BackendError, match=r"kernels do not run \(AttributeError: 'NoneType'.*install the CUDA toolkit"
    ):
        render(cloud_of(0, n=3), camera_of(0), backend="cuda")


def test_out_of_memory_on_the_device_is_reported(gsplat: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    cuda.require()

    def full(**_: Any) -> None:
        raise torch.cuda.OutOfMemoryError("no")

    monkeypatch.setattr(gsplat, "rasterization", full)
    for call in (render, contributions):
        with pytest.raises(BackendError, match="does not fit the GPU's memory; use a smaller image"):
            call(cloud_of(0, n=3), camera_of(0), backend="cuda")


# With gsplat, and on a device


@pytest.mark.skipif(importlib.util.find_spec("gsplat") is None, reason="gsplat is not installed")
def test_the_stand_in_has_the_signature_of_gsplat() -> None:
    import gsplat as real

    here = inspect.signature(gsplat_standin.rasterization).parameters
    assert list(here) == list(inspect.signature(real.rasterization).parameters)


VIEWS = {"guitar.compressed.ply": ((1.3, -1.2, 3.2), (0, -0.9, 0.1)), "playbot/0_0": ((1.1, -0.9, 1.5), (0, -0.4, 0))}


def agree(cloud: GaussianCloud, camera: Camera) -> None:
    theirs, ours = (render(cloud, camera, backend=backend) for backend in ("cuda", "cpu"))
    # needles' footprints and alphas at 1/255 differ (see the back end's docstring); 45 dB is an error of 0.6 %
    assert psnr(theirs.rgb, ours.rgb) >= 45 and psnr(theirs.alpha, ours.alpha) >= 45
    assert float((theirs.group == ours.group).float().mean()) >= 0.99
    a, b = contributions(cloud, camera, "cuda"), contributions(cloud, camera)
    assert float((a - b).norm()) <= 1e-2 * float(b.norm())
    again = render(cloud, camera, backend="cuda")
    assert all(torch.equal(x, y) for x, y in zip(vars(theirs).values(), vars(again).values(), strict=True))


def test_on_a_device_pictures_and_sums_are_those_of_the_cpu(gpu: None) -> None:
    agree(cloud_of(20, n=5000, degree=3), camera_of(20, 640, 480))


@pytest.mark.parametrize("name", VIEWS)
def test_on_a_device_real_scenes_look_as_on_the_cpu(gpu: None, data_dir: Path, name: str) -> None:
    eye, target = VIEWS[name]
    agree(files.load(data_dir / "scenes" / name).cloud, Camera.look_at(eye, target, (0, -1, 0), 640, 480, 45))


def test_on_a_device_gradients_are_those_of_the_cpu(gpu: None) -> None:
    cloud, camera = cloud_of(21, n=500), camera_of(21, 160, 120)
    weight = torch.randn(120, 160, 3, generator=torch.Generator().manual_seed(0))
    found = []
    for draw, device in ((splatting.draw, "cuda"), (differentiable.draw, "cpu")):
        columns = (cloud.means, cloud.quats, cloud.scales, cloud.opacities, cloud.sh)
        leaves = [c.to(device).clone().requires_grad_() for c in columns]
        centers = torch.zeros(500, 2, device=device, requires_grad=True)
        rgb, _ = draw(*leaves, camera, (0.0, 0.0, 0.0), centers)
        (rgb * weight.to(device)).sum().backward()  # type: ignore[no-untyped-call]
        found.append([leaf.grad.cpu() for leaf in (*leaves, centers) if leaf.grad is not None])
    for theirs, ours in zip(*found, strict=True):
        assert float((theirs - ours).norm()) <= 1e-2 * float(ours.norm())  # atomics and the fast exponential

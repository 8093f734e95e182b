"""Every renderer against a slow float64 oracle and against invariants.

The oracle shares nothing with the back ends: numpy, every Gaussian in every pixel, no tiles, no culling by reach,
harmonics from Legendre functions.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from scipy.special import lpmv

from scenewright.gaussians import harmonics, rotations
from scenewright.gaussians.camera import Camera, Render
from scenewright.gaussians.cloud import GaussianCloud, concat
from scenewright.gaussians.errors import BackendError, UserError
from scenewright.gaussians.render import backends, contributions, render

Array = NDArray[np.float64]

pytestmark = pytest.mark.filterwarnings("error")
every_backend = pytest.mark.parametrize("backend", [b for b in backends() if b != "cuda"])  # test_cuda.py


def random_cloud(seed: int, n: int = 150, degree: int = 0, group: bool = True) -> GaussianCloud:
    """Gaussians of mixed shapes around the origin, some needles, some opaque."""
    rng = np.random.default_rng(seed)
    scales = np.exp(rng.uniform(-4.5, -1.5, (n, 3)))
    quats = rng.normal(size=(n, 4))
    quats /= np.linalg.norm(quats, axis=1, keepdims=True)
    sh = rng.normal(size=(n, (degree + 1) ** 2, 3)) * 0.3
    columns = (rng.normal(size=(n, 3)) * 0.5, quats, scales, rng.uniform(0.02, 0.999, n), sh)
    return GaussianCloud.create(
        *(torch.tensor(c, dtype=torch.float32) for c in columns),
        group=torch.tensor(rng.integers(-1, 5, n), dtype=torch.int32) if group else None,
    )


def random_camera(seed: int, width: int = 61, height: int = 45) -> Camera:
    """A camera three units away with its principal point off the centre and unequal focal lengths."""
    rng = np.random.default_rng(seed + 1000)
    eye = rng.normal(size=3)
    camera = Camera.look_at(3 * eye / np.linalg.norm(eye), rng.normal(size=3) * 0.2, rng.normal(size=3), width, height)
    shift = rng.uniform(-8, 8, 2)
    return replace(camera, fx=camera.fx * 1.1, cx=camera.cx + shift[0], cy=camera.cy + shift[1])


def psnr(a: torch.Tensor | Array, b: torch.Tensor | Array) -> float:
    """Decibels for a peak of 1."""
    error = float(np.mean((np.asarray(a, dtype=np.float64) - np.asarray(b, dtype=np.float64)) ** 2))
    return math.inf if error == 0 else -10 * math.log10(error)


def same_bytes(a: Render, b: Render) -> bool:
    return all(torch.equal(x, y) for x, y in zip(vars(a).values(), vars(b).values(), strict=True))


# The oracle


def oracle_basis(direction: Array, degree: int) -> Array:
    """Real harmonics `[K]` from associated Legendre functions; `lpmv` carries the Condon-Shortley sign."""
    x, y, z = direction
    phi, values = math.atan2(y, x), []
    for band in range(degree + 1):
        for m in range(-band, band + 1):
            k = abs(m)
            norm = math.sqrt((2 * band + 1) / (4 * math.pi) * math.factorial(band - k) / math.factorial(band + k))
            turn = 1.0 if m == 0 else math.sqrt(2) * (math.cos(k * phi) if m > 0 else math.sin(k * phi))
            values.append(norm * turn * float(lpmv(k, band, z)))
    return np.array(values)


def oracle_rotation(quat: Array) -> Array:
    """Rotation matrix by rotating the axes: v' = v + 2 w (u x v) + 2 u x (u x v)."""
    w, u = quat[0], quat[1:]
    axes = np.eye(3)
    return np.stack([v + 2 * w * np.cross(u, v) + 2 * np.cross(u, np.cross(u, v)) for v in axes], axis=1)


def oracle(cloud: GaussianCloud, camera: Camera) -> tuple[Array, Array, Array, NDArray[np.int32], Array]:
    """rgb, alpha, depth, group and contributions by brute force over a black background."""
    columns = {name: column.numpy().astype(np.float64) for name, column in cloud.columns()}
    pose, offset = camera.world_to_camera[:3, :3], camera.world_to_camera[:3, 3]
    ys, xs = np.mgrid[: camera.height, : camera.width] + 0.5
    rgb, depth = np.zeros((*xs.shape, 3)), np.zeros(xs.shape)
    T, best = np.ones(xs.shape), np.zeros(xs.shape)
    open_, group = np.ones(xs.shape, bool), np.full(xs.shape, -1, np.int32)
    seen = np.zeros(len(cloud))
    z = columns["means"] @ pose[2] + offset[2]
    for n in np.argsort(z, kind="stable"):
        if z[n] <= 0.01:
            continue
        local = pose @ columns["means"][n] + offset
        u, v = local[0] / z[n], local[1] / z[n]
        # The convention's one oddity: the Jacobian is taken at most 15 % of the image outside it.
        cu = np.clip(u, (-0.15 * camera.width - camera.cx) / camera.fx, (1.15 * camera.width - camera.cx) / camera.fx)
        cv = np.clip(v, (-0.15 * camera.height - camera.cy) / camera.fy, (1.15 * camera.height - camera.cy) / camera.fy)
        jacobian = np.array([[camera.fx, 0, -camera.fx * cu], [0, camera.fy, -camera.fy * cv]]) / z[n]
        axes = jacobian @ pose @ oracle_rotation(columns["quats"][n]) @ np.diag(columns["scales"][n])
        inverse = np.linalg.inv(axes @ axes.T + 0.3 * np.eye(2))
        dx, dy = xs - (camera.fx * u + camera.cx), ys - (camera.fy * v + camera.cy)
        power = inverse[0, 0] * dx * dx + 2 * inverse[0, 1] * dx * dy + inverse[1, 1] * dy * dy
        alpha = np.minimum(columns["opacities"][n] * np.exp(-power / 2), 0.999)
        alpha[alpha < 1 / 255] = 0
        open_ &= T * (1 - alpha) > 1e-4
        weight = np.where(open_, alpha * T, 0)
        direction = columns["means"][n] - camera.position
        basis = oracle_basis(direction / np.linalg.norm(direction), cloud.degree)
        rgb += weight[..., None] * np.maximum(0, 0.5 + basis @ columns["sh"][n])
        depth += weight * z[n]
        group = np.where(weight > best, np.int32(columns["group"][n]), group)
        best, T = np.maximum(best, weight), np.where(open_, T * (1 - alpha), T)
        seen[n] = weight.sum()
    return rgb, 1 - T, np.where(T < 1, depth / np.maximum(1 - T, 1e-12), 0), group, seen


@every_backend
@pytest.mark.parametrize("seed, degree", [(0, 0), (1, 1), (2, 2), (3, 3), (4, 0), (5, 3)])
def test_agrees_with_brute_force(backend: str, seed: int, degree: int) -> None:
    cloud, camera = random_cloud(seed, degree=degree), random_camera(seed)
    picture = render(cloud, camera, backend=backend)
    rgb, alpha, depth, group, seen = oracle(cloud, camera)
    # float32 places a centre to about 1e-5 px, so pixels agree to 1e-5 unless an alpha flips across 1/255.
    assert psnr(picture.rgb, rgb) >= 80
    assert psnr(picture.alpha, alpha) >= 80
    assert psnr(picture.depth, depth) >= 70  # units of scene, a few units deep, divided by alphas down to 1/255
    assert (picture.group.numpy() == group).mean() >= 0.999  # two weights may tie to rounding
    np.testing.assert_allclose(contributions(cloud, camera, backend=backend), seen, rtol=1e-3, atol=1e-3)


@every_backend
def test_opaque_layers_finish_pixels(backend: str) -> None:
    """Many opaque Gaussians on top of each other: transmittance stops above 1e-4 and later ones add nothing."""
    cloud = random_cloud(7, n=400)
    cloud = cloud.replace(opacities=torch.full((400,), 0.95), scales=cloud.scales * 0 + 0.4)
    camera = random_camera(7)
    rgb, alpha, _, _, seen = oracle(cloud, camera)
    picture = render(cloud, camera, backend=backend)
    # Whether T * (1 - alpha) clears 1e-4 can flip by rounding; such a pixel changes by less than 1e-3.
    assert psnr(picture.rgb, rgb) >= 75 and psnr(picture.alpha, alpha) >= 75
    assert float(picture.alpha.max()) < 1
    assert ((contributions(cloud, camera, backend=backend).numpy() > 0) == (seen > 0)).mean() > 0.98


# Laws


@every_backend
@pytest.mark.parametrize("degree", [0, 3])
def test_turning_and_moving_the_world_with_the_camera_changes_nothing(backend: str, degree: int) -> None:
    cloud, camera = random_cloud(11, degree=degree), random_camera(11)
    turn = rotations.to_matrix(rotations.normalize(torch.tensor([0.3, -0.5, 0.7, 0.2], dtype=torch.float64)))
    shift = torch.tensor([0.7, -0.2, 0.4], dtype=torch.float64)
    quat = rotations.from_matrix(turn[None]).float()
    moved = cloud.replace(
        means=(cloud.means.double() @ turn.T + shift).float(),
        quats=rotations.multiply(quat, cloud.quats),
        sh=harmonics.rotate(cloud.sh, turn),
    )
    world = np.eye(4)
    world[:3, :3], world[:3, 3] = turn.numpy(), shift.numpy()
    there = replace(camera, world_to_camera=camera.world_to_camera @ np.linalg.inv(world))
    a, b = render(cloud, camera, backend=backend), render(moved, there, backend=backend)
    # Both sides are float32; means differ by 1e-7 units, 1e-5 px.
    assert psnr(a.rgb, b.rgb) >= 75 and psnr(a.depth, b.depth) >= 65
    assert (a.group == b.group).float().mean() >= 0.999


@every_backend
def test_the_order_of_rows_does_not_matter(backend: str) -> None:
    cloud, camera = random_cloud(12), random_camera(12)
    order = torch.randperm(len(cloud), generator=torch.Generator().manual_seed(0))
    assert same_bytes(render(cloud, camera, backend=backend), render(cloud[order], camera, backend=backend))
    seen = contributions(cloud, camera, backend=backend)
    assert torch.equal(seen[order], contributions(cloud[order], camera, backend=backend))


@every_backend
def test_contributions_add_up_to_alpha_and_the_unseen_can_go(backend: str) -> None:
    cloud, camera = random_cloud(13, n=500), random_camera(13)
    picture, seen = render(cloud, camera, backend=backend), contributions(cloud, camera, backend=backend)
    assert seen.shape == (500,) and seen.dtype == torch.float32
    # Sums of some thousand float32 weights, rounded at 1e-7 each.
    assert float(seen.sum()) == pytest.approx(float(picture.alpha.double().sum()), rel=1e-5)
    assert 0 < int((seen == 0).sum()) < 500
    # Chunks of the blend may fall differently, so sums may round differently; nothing else may change.
    assert psnr(picture.rgb, render(cloud[seen > 0], camera, backend=backend).rgb) >= 110


@every_backend
def test_background_shows_through_what_is_left(backend: str) -> None:
    cloud, camera = random_cloud(14, n=40), random_camera(14)
    black, sky = render(cloud, camera, backend=backend), render(cloud, camera, (0.2, 0.5, 1.5), backend=backend)
    expected = black.rgb + (1 - black.alpha)[..., None] * torch.tensor([0.2, 0.5, 1.5])
    torch.testing.assert_close(sky.rgb, expected, rtol=0, atol=1e-6)
    assert torch.equal(sky.alpha, black.alpha) and torch.equal(sky.group, black.group)


@every_backend
def test_channels_of_an_empty_pixel(backend: str) -> None:
    camera = random_camera(0)
    for cloud in (GaussianCloud.empty(), GaussianCloud.empty(degree=3)):
        picture = render(cloud, camera, (0.1, 0.2, 0.3), backend=backend)
        assert torch.equal(picture.rgb, torch.tensor([0.1, 0.2, 0.3]).expand(45, 61, 3))
        assert not picture.alpha.any() and not picture.depth.any() and bool((picture.group == -1).all())
        assert contributions(cloud, camera, backend=backend).shape == (0,)


@every_backend
def test_the_nearer_one_hides_the_other(backend: str) -> None:
    camera = Camera.look_at([0, -5, 0], [0, 0, 0], [0, 0, 1], 33, 33)
    means = torch.tensor([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
    cloud = GaussianCloud.create(
        means, torch.tensor([[1.0, 0, 0, 0]]).expand(2, 4), torch.full((2, 3), 0.5), torch.tensor([0.99, 0.99]),
        torch.zeros(2, 1, 3), group=torch.tensor([7, 3], dtype=torch.int32),
    )  # fmt: skip
    picture = render(cloud, camera, backend=backend)
    assert int(picture.group[16, 16]) == 3
    assert float(picture.depth[16, 16]) == pytest.approx(4.0, abs=0.03)  # the far one's share is 1 %, two units on
    seen = contributions(cloud, camera, backend=backend)
    assert float(seen[1]) > 2 * float(seen[0])


@every_backend
@pytest.mark.parametrize("width, height", [(1, 1), (1, 40), (17, 1), (15, 15), (16, 16), (33, 31), (8, 2), (9, 3)])
def test_any_image_size(backend: str, width: int, height: int) -> None:
    cloud, camera = random_cloud(15, n=60), random_camera(15, width, height)
    picture = render(cloud, camera, backend=backend)
    rgb, alpha, _, group, _ = oracle(cloud, camera)
    assert picture.rgb.shape == (height, width, 3) and picture.group.shape == (height, width)
    assert psnr(picture.rgb, rgb) >= 75 and psnr(picture.alpha, alpha) >= 75  # few pixels: one flip weighs more
    assert (picture.group.numpy() == group).mean() >= 0.99


@every_backend
def test_inputs_are_not_modified(backend: str) -> None:
    cloud, camera = random_cloud(16, degree=2), random_camera(16)
    before = cloud.digest()
    render(cloud, camera, backend=backend)
    contributions(cloud, camera, backend=backend)
    assert cloud.digest() == before


def test_columns_that_are_not_contiguous() -> None:
    cloud, camera = random_cloud(17, degree=1), random_camera(17)
    strided = cloud.replace(
        means=cloud.means.T.contiguous().T, sh=cloud.sh.permute(2, 1, 0).contiguous().permute(2, 1, 0)
    )
    assert same_bytes(render(cloud, camera), render(strided, camera))


def test_a_float32_cloud_far_from_the_origin() -> None:
    """A georeferenced scene: coordinates near 10,000 leave 1e-3 of a unit; the eye is subtracted before anything."""
    cloud, camera = random_cloud(18), random_camera(18)
    shift = np.array([8192.0, -4096.0, 2048.0])  # powers of two: the shift itself loses only low digits
    far = cloud.replace(means=cloud.means + torch.tensor(shift, dtype=torch.float32))
    pose = camera.world_to_camera.copy()
    pose[:3, 3] -= pose[:3, :3] @ shift
    back = far.replace(means=far.means - torch.tensor(shift, dtype=torch.float32))  # the same rounded means
    eye = np.float32(camera.position + shift) - shift  # the same rounded eye
    near_pose = camera.world_to_camera.copy()
    near_pose[:3, 3] = -near_pose[:3, :3] @ eye
    a = render(far, replace(camera, world_to_camera=pose))
    b = render(back, replace(camera, world_to_camera=near_pose))
    assert psnr(a.rgb, b.rgb) >= 75


def test_bad_requests_are_refused() -> None:
    cloud, camera = random_cloud(0, n=3), random_camera(0)
    with pytest.raises(BackendError, match="cpu, reference, cuda"):
        render(cloud, camera, backend="metal")
    with pytest.raises(BackendError, match="auto"):
        contributions(cloud, camera, backend="")
    for background in ((0.0, float("nan"), 0.0), (0.0, 0.0), (0.0, 0.0, float("inf"))):
        with pytest.raises(UserError, match="three finite numbers"):
            render(cloud, camera, background)  # type: ignore[arg-type]


@pytest.mark.parametrize("group", [-1, 0, 5])
def test_a_cloud_of_one_group_is_drawn_as_one_of_several(group: int) -> None:
    """The group of a pixel is not searched for where there is only one; one more that nobody sees makes it two."""
    cloud, camera = random_cloud(3, 300), random_camera(3)
    cloud = cloud.replace(group=torch.full((len(cloud),), group, dtype=torch.int32))
    unseen = cloud[:1].replace(
        opacities=torch.tensor([1e-4]), group=torch.tensor([9], dtype=torch.int32), ids=torch.tensor([len(cloud)])
    )
    pair = concat([cloud, unseen])
    alone, several = (render(drawn, camera, (0.2, 0.4, 0.6)) for drawn in (cloud, pair))
    assert same_bytes(alone, several)
    assert set(alone.group.unique().tolist()) == {-1, group}

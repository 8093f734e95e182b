"""Orbit rings: that of the photographs, on the spot if they look outward, or the best-scored ring."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.scene import Frame, Scene
from scenewright.gaussians.viewpoints.orbit import Ring, choose_ring

UP = (0.0, 0.0, 1.0)
FRAME = Frame(UP, 0.0, 1.0, "given", "given")
PLACE = np.array([3.0, -2.0, 0.5])
ABOVE = PLACE + np.array([0.0, 0.0, 1.0])  # where eyes are level


def cloud_of(points: torch.Tensor, scale: float) -> GaussianCloud:
    n = len(points)
    turns = torch.tensor([1.0, 0, 0, 0]).expand(n, 4).contiguous()
    return GaussianCloud.create(points, turns, torch.full((n, 3), scale), torch.full((n,), 0.95), torch.zeros(n, 1, 3))


def ball(center: tuple[float, float, float], radius: float) -> torch.Tensor:
    points = torch.randn(1500, 3, generator=torch.Generator().manual_seed(8001))
    return points / points.norm(dim=1, keepdim=True) * radius + torch.tensor(center)


def walls(half: float, height: float) -> torch.Tensor:
    """Four closed walls and a ceiling around the origin."""
    steps = torch.linspace(-half, half, 50)
    heights = torch.linspace(0, height, 20)
    sides = [torch.cartesian_prod(torch.tensor([s * half]), steps, heights) for s in (-1.0, 1.0)]
    sides += [torch.cartesian_prod(steps, torch.tensor([s * half]), heights) for s in (-1.0, 1.0)]
    return torch.cat([*sides, torch.cartesian_prod(steps, steps, torch.tensor([height]))])


def standing(azimuths: np.ndarray, radius: float, inward: bool = True) -> list[Camera]:
    eyes = [ABOVE + radius * np.array([np.cos(a), np.sin(a), 0.0]) for a in np.radians(azimuths)]
    return [Camera.look_at(e, PLACE if inward else 2 * e - ABOVE - np.array([0, 0, 0.2]), UP, 60, 40, 45) for e in eyes]


def test_photographs_from_all_sides_give_their_own_ring() -> None:
    scene = Scene(cloud_of(ball((3, -2, 0.5), 0.3), 0.05), FRAME)
    ring = choose_ring(scene, standing(np.arange(0, 360, 30.0), 2.0))
    assert ring.radius == pytest.approx(2.0) and np.allclose(ring.center, ABOVE)
    assert ring.target is not None and np.allclose(ring.target, PLACE) and ring.arc == 360
    assert ring.fov == pytest.approx(45)
    for camera in ring.cameras(7, 90, 60):
        pixels, depth = camera.project(PLACE[None])
        assert np.allclose(pixels, [[45, 30]]) and depth[0] == pytest.approx(np.hypot(2, 1))


def test_photographs_from_one_side_are_swung_along_and_never_left() -> None:
    scene = Scene(cloud_of(ball((3, -2, 0.5), 0.3), 0.05), FRAME)
    ring = choose_ring(scene, standing(np.arange(150, 271, 10.0), 2.0))
    assert ring.arc == pytest.approx(120)
    eyes = np.stack([c.position for c in ring.cameras(12, 10, 10)]) - PLACE
    azimuths = np.degrees(np.arctan2(eyes[:, 1], eyes[:, 0])) % 360
    assert azimuths.min() == pytest.approx(150) and azimuths.max() == pytest.approx(270)
    assert np.abs(np.diff(np.append(azimuths, azimuths[0]))).max() < 40  # no jump, not even where the film begins again


def test_photographs_that_look_outward_are_turned_among() -> None:
    scene = Scene(cloud_of(walls(4.0, 3.0), 0.08), FRAME)
    ring = choose_ring(scene, standing(np.arange(0, 360, 45.0), 0.5, inward=False))
    assert ring.target is None and ring.radius == 0 and np.allclose(ring.center, ABOVE, atol=1e-6)
    forward = np.stack([c.forward for c in ring.cameras(4, 10, 10)])
    assert np.allclose(forward[:, 2], forward[0, 2]) and forward[0] @ forward[2] < 0


@pytest.mark.parametrize("aim", ["parallel", "every way"])
def test_photographs_that_agree_in_nothing_leave_it_to_the_scene(aim: str) -> None:
    scene = Scene(cloud_of(ball((0, 0, 1), 1.0), 0.1), FRAME)
    eyes = np.random.default_rng(8002).uniform(-3, 3, (12, 3))
    turned = [e + np.eye(3)[0] if aim == "parallel" else e + np.roll(e, 1) for e in eyes]
    cameras = [Camera.look_at(e, t, UP) for e, t in zip(eyes, turned, strict=True)]
    ring = choose_ring(scene, cameras)
    assert ring.target is not None and np.allclose(ring.target, (0, 0, 1), atol=0.3)


def test_a_thing_alone_is_wholly_in_every_picture() -> None:
    points = ball((5, 5, 1), 1.0) * torch.tensor([1.0, 1.0, 2.0])
    ring = choose_ring(Scene(cloud_of(points, 0.06), FRAME))
    for camera in ring.cameras(9, 60, 40):
        pixels, depth = camera.project(points.numpy().astype(np.float64))
        assert (depth > 0).all() and (pixels >= 0).all() and (pixels <= [60, 40]).all()


def test_a_closed_room_is_seen_from_within() -> None:
    points = torch.cat([walls(4.0, 3.0), ball((0.5, 0, 0.6), 0.6)])
    ring = choose_ring(Scene(cloud_of(points, 0.1), FRAME))
    eyes = np.stack([c.position for c in ring.cameras(8, 10, 10)])
    assert np.abs(eyes[:, :2]).max() < 4 and eyes[:, 2].min() > 0 and eyes[:, 2].max() < 3


@pytest.mark.parametrize("points", [torch.zeros(1, 3), torch.zeros(40, 3), torch.rand(2, 3)])
def test_a_scene_of_next_to_nothing_has_a_ring_too(points: torch.Tensor) -> None:
    for camera in choose_ring(Scene(cloud_of(points, 0.01), FRAME)).cameras(3, 10, 10):
        assert np.isfinite(camera.world_to_camera).all()


def test_the_picture_after_the_last_would_be_the_first() -> None:
    ring = Ring(FRAME, np.array([0.0, 0, 1]), 2.0, np.zeros(3))
    azimuths = [np.arctan2(*c.position[1::-1]) for c in ring.cameras(8, 10, 10)]
    steps = np.diff(np.unwrap([*azimuths, azimuths[0] + 2 * np.pi]))
    assert np.allclose(steps, 2 * np.pi / 8)

"""Laws of moving a camera: what stays, stays, and what was asked for is what changes."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.scene import Frame, Scene
from scenewright.gaussians.viewpoints.moving import (
    STEEPEST,
    from_azimuth_of,
    nearer,
    orbited,
    pivot_of,
    turned,
    with_clear_sight,
)

_UPS = st.sampled_from([(0.0, 0.0, 1.0), (0.0, -1.0, 0.0), (0.6, 0.0, 0.8)])
_PIVOT = np.array([0.3, -0.2, 0.5])


def _camera(up: tuple[float, float, float]) -> Camera:
    away = np.cross(up, (0.9, 0.3, 0.1)) + 0.4 * np.array(up)
    return Camera.look_at(_PIVOT + 4 * away, _PIVOT, up, 120, 80, 50)


def _elevation(camera: Camera, up: tuple[float, float, float]) -> float:
    offset = camera.position - _PIVOT
    return float(np.degrees(np.arcsin(offset @ np.array(up) / np.linalg.norm(offset))))


@given(up=_UPS, azimuth=st.floats(-400, 400), elevation=st.floats(-200, 200))
def test_an_orbit_keeps_distance_aim_and_lens(up: tuple[float, float, float], azimuth: float, elevation: float) -> None:
    camera = _camera(up)
    moved = orbited(camera, _PIVOT, np.array(up), azimuth=azimuth, elevation=elevation)
    before, after = np.linalg.norm(camera.position - _PIVOT), np.linalg.norm(moved.position - _PIVOT)
    assert after == pytest.approx(before)
    pixel, _ = moved.project(_PIVOT[None])
    assert pixel[0] == pytest.approx((60, 40), abs=1e-6)
    assert (moved.fx, moved.fy, moved.width, moved.height) == (camera.fx, camera.fy, camera.width, camera.height)
    assert abs(moved.right @ np.array(up)) < 1e-9  # level
    assert _elevation(moved, up) <= STEEPEST + 1e-6


@given(up=_UPS, azimuth=st.floats(-180, 180))
def test_an_orbit_back_is_where_it_began(up: tuple[float, float, float], azimuth: float) -> None:
    camera = orbited(_camera(up), _PIVOT, np.array(up))
    there = orbited(camera, _PIVOT, np.array(up), azimuth=azimuth)
    back = orbited(there, _PIVOT, np.array(up), azimuth=-azimuth)
    np.testing.assert_allclose(back.world_to_camera, camera.world_to_camera, atol=1e-9)
    turn = from_azimuth_of(there, camera, np.array(up), 0.0)
    np.testing.assert_allclose(
        orbited(there, _PIVOT, np.array(up), azimuth=turn).world_to_camera, camera.world_to_camera, atol=1e-9
    )


def test_right_is_the_cameras_right_and_above_is_above() -> None:
    up = np.array([0.0, 0.0, 1.0])
    camera = Camera.look_at([0, -5, 1], [0, 0, 1], up, 120, 80, 50)
    pivot = np.array([0.0, 0, 1])
    assert orbited(camera, pivot, up, azimuth=90).position == pytest.approx((5, 0, 1))
    assert orbited(camera, pivot, up, to=75).position[2] == pytest.approx(1 + 5 * np.sin(np.radians(75)))
    assert turned(camera, up, left=90).forward == pytest.approx((-1, 0, 0))
    assert turned(camera, up, upward=30).forward[2] == pytest.approx(0.5)
    assert turned(camera, up, upward=200).forward[2] < 1
    assert nearer(camera, pivot, 0.5).position == pytest.approx((0, -2.5, 1))


def _wall(y: float, size: float) -> torch.Tensor:
    steps = torch.linspace(-size, size, 30)
    grid = torch.cartesian_prod(steps, torch.tensor([y]), steps)
    return grid + torch.tensor([0.0, 0.0, 1.0])


def _scene(*walls: torch.Tensor) -> Scene:
    means = torch.cat(walls)
    n = len(means)
    cloud = GaussianCloud.create(
        means, torch.tensor([1.0, 0, 0, 0]).expand(n, 4).contiguous(), torch.full((n, 3), 0.08),
        torch.full((n,), 0.98), torch.zeros(n, 1, 3),
    )  # fmt: skip
    return Scene(cloud, Frame((0, 0, 1), 0.0, 1.0, "given", "given"))


def test_the_pivot_is_what_the_middle_of_the_picture_shows() -> None:
    camera = Camera.look_at([0, -5, 1], [0, 0, 1], [0, 0, 1], 120, 80, 50)
    assert pivot_of(_scene(_wall(0.0, 1.0)), camera)[1] == pytest.approx(0, abs=0.1)
    away = Camera.look_at([0, -5, 1], [0, -9, 1], [0, 0, 1], 120, 80, 50)
    assert np.isfinite(pivot_of(_scene(_wall(0.0, 1.0)), away)).all()  # the picture is empty


def test_a_camera_comes_before_what_stands_in_its_way() -> None:
    camera = Camera.look_at([0, -5, 1], [0, 0, 1], [0, 0, 1], 120, 80, 50)
    pivot = np.array([0.0, 0, 1])
    clear, free = with_clear_sight(_scene(_wall(0.0, 1.0)), camera, pivot)
    assert free and clear.position == pytest.approx(camera.position)
    clear, free = with_clear_sight(_scene(_wall(0.0, 1.0), _wall(-3.0, 2.0)), camera, pivot)
    assert free and -3 < clear.position[1] < -0.5

"""The parts of meshing: depth of surfaces, marching tetrahedra, decimation and the rasteriser, each against a law or a
slow reference."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch
import trimesh
from flat_boxes import box
from numpy.typing import NDArray

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.meshing.decimating import decimate
from scenewright.gaussians.meshing.outlines import fitted
from scenewright.gaussians.meshing.raster import draw
from scenewright.gaussians.meshing.shaping import Shape, sphere_cameras
from scenewright.gaussians.meshing.tetrahedra import surface
from scenewright.gaussians.render import cpu, render

F64 = NDArray[np.float64]


def _ball(count: int = 24) -> tuple[F64, NDArray[np.int64]]:
    """A ball of radius 8 grid steps."""
    at = np.stack(np.meshgrid(*[np.arange(count) - count / 2 + 0.3] * 3, indexing="ij"), axis=-1)
    return surface(np.linalg.norm(at, axis=-1) - 8.0)


def test_a_field_becomes_a_closed_surface_that_faces_out() -> None:
    vertices, faces = _ball()
    made = trimesh.Trimesh(vertices, faces, process=False)
    assert made.is_watertight and made.is_winding_consistent
    assert made.euler_number == 2
    assert made.volume == pytest.approx(4 / 3 * math.pi * 8**3, rel=0.02)  # positive: faces out; chords cut off 1 %


def test_a_random_field_becomes_a_closed_surface_too() -> None:
    field = np.random.default_rng(0).normal(size=(9, 8, 7))
    for axis in range(3):
        side = np.moveaxis(field, axis, 0)
        side[0] = side[-1] = 1.0
    vertices, faces = surface(field)
    made = trimesh.Trimesh(vertices, faces, process=False)
    assert made.is_watertight and made.is_winding_consistent


def test_a_field_without_a_sign_change_has_no_surface() -> None:
    vertices, faces = surface(np.ones((4, 4, 4)))
    assert len(vertices) == len(faces) == 0


def test_decimation_keeps_the_surface_closed_and_where_it_is() -> None:
    vertices, faces = _ball()
    fewer = trimesh.Trimesh(*decimate(vertices, faces, 400, 0.0), process=False)
    assert len(fewer.faces) <= 400
    assert fewer.is_watertight and fewer.is_winding_consistent and fewer.euler_number == 2
    assert fewer.volume == pytest.approx(4 / 3 * math.pi * 8**3, rel=0.03)


def test_decimation_by_tolerance_leaves_few_faces_of_a_cube_and_its_corners() -> None:
    at = np.stack(np.meshgrid(*[np.arange(20) - 9.7] * 3, indexing="ij"), axis=-1)
    vertices, faces = surface(np.abs(at).max(axis=-1) - 7.0)
    kept, left = decimate(vertices, faces, len(faces), 0.05)
    made = trimesh.Trimesh(kept, left, process=False)
    assert made.is_watertight
    assert len(left) < len(faces) / 10
    assert made.volume == pytest.approx(14.0**3, rel=0.02)


def test_decimation_does_not_take_a_closed_surface_apart() -> None:
    vertices, faces = _ball()
    kept, left = decimate(vertices, faces, 4, 0.0)
    made = trimesh.Trimesh(kept, left, process=False)
    assert made.is_watertight and 4 <= len(left) < 60


def test_the_rasteriser_agrees_with_rays() -> None:
    camera = Camera.look_at([20, -30, 15], [0, 0, 0], [0, 0, 1], 26, 20, 40)
    vertices, faces = decimate(*_ball(), 300, 0.0)
    vertices = vertices - vertices.mean(axis=0)
    seen = draw(vertices, faces, camera)
    depth, face = _by_rays(vertices, faces, camera)
    # A ray on an edge may take either face; depths are float32.
    assert (seen.face == face).mean() > 0.999
    both = np.isfinite(depth) & np.isfinite(seen.depth)
    assert np.allclose(seen.depth[both], depth[both], rtol=1e-5)
    assert both.sum() > 80
    rows, columns = np.nonzero(seen.face >= 0)
    corners = vertices[faces[seen.face[rows, columns]]]
    pixels, _ = camera.project(np.einsum("rk,rkc->rc", seen.weights[rows, columns], corners))
    assert np.allclose(pixels, np.stack([columns, rows], axis=1) + 0.5, atol=1e-3)


def _by_rays(vertices: F64, faces: NDArray[np.int64], camera: Camera) -> tuple[F64, NDArray[np.int64]]:
    """Depth and face of every pixel's ray (Möller and Trumbore 1997), all triangles for all rays."""
    x, y = np.meshgrid(np.arange(camera.width) + 0.5, np.arange(camera.height) + 0.5)
    local = np.stack([(x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, np.ones_like(x)], axis=-1)
    way = (local @ camera.world_to_camera[:3, :3]).reshape(-1, 1, 3)
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    p = np.cross(way, c - a)
    scale = (p * (b - a)).sum(axis=-1)
    s = camera.position - a
    u = (p * s).sum(axis=-1) / scale
    q = np.cross(s, b - a)
    v = (way * q).sum(axis=-1) / scale
    t = np.where((u >= 0) & (v >= 0) & (u + v <= 1), ((c - a) * q).sum(axis=-1) / scale, np.inf)
    face = t.argmin(axis=1)
    depth = t.min(axis=1)
    size = camera.height, camera.width
    return depth.reshape(size), np.where(np.isfinite(depth), face, -1).reshape(size)


def test_the_depth_of_a_wall_seen_at_an_angle_is_that_of_its_plane() -> None:
    wall = box((-1, -1, -0.001), (1, 1, 0.0), (0.5, 0.5, 0.5))
    camera = Camera.look_at([1.0, -1.5, 1.2], [0, 0, 0], [0, 0, 1], 64, 64, 40)
    ((depth, slant),) = cpu.surface_depth(wall, [camera])
    x, y = np.meshgrid(np.arange(64) + 0.5, np.arange(64) + 0.5)
    rays = np.stack([(x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, np.ones_like(x)], axis=-1)
    downward = (rays @ camera.world_to_camera[:3, :3])[..., 2]
    plane = -camera.position[2] / downward
    inner = np.s_[20:44, 20:44]  # of the picture: away from the wall's borders
    assert np.allclose(depth[inner], plane[inner], atol=0.003)  # the wall is 0.001 thick
    assert np.allclose(slant[inner], -downward[inner], atol=1e-3)
    assert np.abs(render(wall, camera).depth.numpy()[inner] - plane[inner]).max() > 0.02  # which blends centres


def test_the_depth_is_infinite_exactly_where_light_is_left() -> None:
    rng = torch.Generator().manual_seed(3)
    n = 300
    cloud = GaussianCloud.create(
        torch.randn(n, 3, generator=rng) * 0.4, torch.nn.functional.normalize(torch.randn(n, 4, generator=rng), dim=1),
        torch.rand(n, 3, generator=rng) * 0.1 + 0.01, torch.rand(n, generator=rng) * 0.9 + 0.05, torch.zeros(n, 1, 3),
    )  # fmt: skip
    camera = Camera.look_at([0, -3, 0], [0, 0, 0], [0, 0, 1], 48, 48, 40)
    alpha = render(cloud, camera).alpha.numpy()
    for level in (0.3, 0.5):
        ((depth, _),) = cpu.surface_depth(cloud, [camera], level)
        clear = np.abs(1 - alpha - level) > 1e-3  # where rounding does not decide
        assert (np.isfinite(depth) == (1 - alpha <= level))[clear].all()
        assert np.isfinite(depth).any() and not np.isfinite(depth).all()


def test_outlines_go_to_where_the_splats_end() -> None:
    sigma, opacity = 0.3, 0.95
    ball = GaussianCloud.create(
        torch.zeros(1, 3), torch.tensor([[1.0, 0, 0, 0]]), torch.full((1, 3), sigma), torch.tensor([opacity]),
        torch.zeros(1, 1, 3),
    )  # fmt: skip
    nodes, faces = decimate(*_ball(), 600, 0.0)
    nodes = nodes - (nodes.max(axis=0) + nodes.min(axis=0)) / 2
    small = Shape(nodes * 0.3 / 8, faces)
    moved = fitted(small, ball, sphere_cameras(np.zeros(3), 0.5, 24, 96), far=0.1)
    # Half of the light is stopped where opacity * exp(-d^2 / 2) = 0.5; a pixel is a twelfth of the ball's radius.
    wanted = sigma * math.sqrt(2 * math.log(opacity / 0.5))
    assert np.linalg.norm(moved.vertices, axis=1).mean() == pytest.approx(wanted, abs=0.01)
    still = fitted(small, ball, sphere_cameras(np.zeros(3), 0.5, 24, 96), far=0.0)
    assert np.array_equal(still.vertices, small.vertices)

"""Meshes are cut into cells without holes, whose Gaussians end where the mesh ends."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from scenewright.gaussians.assets.modeling.imported import SAMPLES, read
from scenewright.gaussians.assets.modeling.make import flat_gaussians
from scenewright.gaussians.assets.modeling.sampling import COVER, Samples
from scenewright.gaussians.assets.modeling.triangles import Cells, cut, merged, outlines
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.render import render

Array = NDArray[np.float64]
trimesh = pytest.importorskip("trimesh")


def box(*sides: float) -> Array:
    """`[12, 3, 3]` triangles of a box about the origin."""
    return np.asarray(trimesh.creation.box(sides).triangles, dtype=np.float64)


SHAPES = {
    "cube": box(1, 1, 1),
    "plate": box(1.2, 0.8, 0.02),
    "rod": box(0.03, 0.03, 1.2),
    "cylinder": np.asarray(trimesh.creation.cylinder(0.3, 1.0, sections=24).triangles),
    "cone of slivers": np.asarray(trimesh.creation.cone(0.5, 1.0, sections=120).triangles),
    "ball of many triangles": np.asarray(trimesh.creation.icosphere(5, 0.5).triangles),
}


def spacing_of(triangles: Array, count: int = 4000) -> float:
    one, other = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    return float(np.sqrt(np.linalg.norm(np.cross(one, other), axis=1).sum() / 2 / count))


def beyond(triangles: Array, camera: Camera) -> Array:
    """`[H, W]` signed distance in pixels of each pixel's centre from the outline of a convex shape; negative inside."""
    corners, _ = camera.project(triangles.reshape(-1, 3))
    planes = ConvexHull(corners).equations
    y, x = np.mgrid[: camera.height, : camera.width] + 0.5
    away: Array = np.max(planes[:, 0, None, None] * x + planes[:, 1, None, None] * y + planes[:, 2, None, None], axis=0)
    return away


@pytest.mark.parametrize("name", SHAPES)
def test_what_is_seen_is_the_shape_and_nothing_around_it(name: str) -> None:
    """Solid inside, clear from one and a half pixels beyond the outline, from four sides; a cell has two to three
    pixels, and a renderer widens every Gaussian by about half of one."""
    triangles = SHAPES[name]
    cells = cut(triangles, spacing_of(triangles))
    count = len(cells.xyz)
    samples = Samples(cells.xyz, cells.frame, cells.size, np.zeros((count, 2)), np.zeros(count, np.int64))
    cloud = flat_gaussians(samples, np.full((count, 3), 0.5))
    reach = 1.4 * float(np.linalg.norm(np.ptp(triangles.reshape(-1, 3), axis=0)))
    for eye in ((1, 0.6, 0.5), (-0.7, 1, 0.3), (0.2, -1, 0.9), (-1, -0.5, -0.4)):
        at = np.array(eye) / np.linalg.norm(eye) * reach
        camera = Camera.look_at(tuple(at), (0, 0, 0), (0, 0, 1), 160, 160, 50)
        alpha, away = render(cloud, camera).alpha.numpy(), beyond(triangles, camera)
        assert alpha[away < -0.5].mean() > 0.97 and alpha[away < -0.5].min() > 0.6
        assert alpha[(away > 0.5) & (away < 1.5)].mean() < 0.75
        assert alpha[(away > 1.5) & (away < 2.5)].mean() < 0.05 and alpha[away > 3].max() < 0.15


@pytest.mark.parametrize("name", SHAPES)
def test_cells_lie_on_their_triangles_and_are_bounded_in_number(name: str) -> None:
    triangles = SHAPES[name]
    spacing = spacing_of(triangles)
    cells = cut(triangles, spacing)
    assert 500 < len(cells.xyz) < 20_000
    assert np.allclose(np.einsum("nij,nik->njk", cells.frame, cells.frame), np.eye(3), atol=1e-9)
    assert (cells.weights >= -1e-9).all() and np.allclose(cells.weights.sum(axis=1), 1)
    on_it = (cells.weights[:, :, None] * triangles[cells.face]).sum(axis=1)
    assert np.linalg.norm(on_it - cells.xyz, axis=1).max() < 1.5 * spacing  # of merged cells: the largest of them
    again = cut(triangles, spacing)
    assert all(np.array_equal(getattr(cells, n), getattr(again, n)) for n in ("xyz", "frame", "size", "face"))


def test_no_gaussian_is_wider_across_an_outline_than_it_is_far_from_it() -> None:
    """The rule, cell by cell and side by side: two standard deviations reach the outline and no further."""
    triangles = box(1, 0.7, 0.4)
    cells = cut(triangles, 0.06)
    hard, patch = outlines(triangles)
    for i in range(0, len(cells.xyz), 7):
        axes = COVER * cells.size[i, :, None] * cells.frame[i, :, :2].T  # [2, 3]
        for face, side in zip(*np.nonzero(hard), strict=True):
            a, b = triangles[face, side], triangles[face, (side + 1) % 3]
            along = (b - a) / np.linalg.norm(b - a)
            at = float((cells.xyz[i] - a) @ along)
            gap = a + at * along - cells.xyz[i]
            away = float(np.linalg.norm(gap))
            if patch[face] != patch[cells.face[i]] or not 0 <= at <= np.linalg.norm(b - a) or away > 0.06:
                continue
            assert np.linalg.norm(axes @ (gap / away)) <= away / 2 * 1.001


def test_the_edges_of_a_cube_are_outlines_and_its_diagonals_are_not() -> None:
    hard, patch = outlines(box(1, 1, 1))
    assert hard.sum() == 24 and (hard.sum(axis=1) == 2).all()  # each of the twelve edges belongs to two triangles
    assert len(np.unique(patch)) == 6 and (np.bincount(patch) == 2).all()


def test_surfaces_end_at_open_borders_and_where_the_material_changes() -> None:
    sheet = np.array([[[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [1, 1, 0], [0, 1, 0]]], dtype=np.float64)
    hard, patch = outlines(sheet)
    assert hard.sum() == 4 and patch[0] == patch[1]
    hard, patch = outlines(sheet, np.array([0, 1]))
    assert hard.all() and patch[0] != patch[1]


def test_a_triangle_without_area_has_no_cell() -> None:
    flat = np.array([[[0, 0, 0], [1, 0, 0], [0.5, 0, 0]]], dtype=np.float64)
    both = np.concatenate([flat, box(1, 1, 1)])
    assert len(cut(both, 0.1).xyz) == len(cut(box(1, 1, 1), 0.1).xyz) and not (cut(both, 0.1).face == 0).any()


def test_merged_cells_keep_area_middle_and_moments() -> None:
    """Against a plain sum over the cells of one voxel."""
    g = np.random.default_rng(0)
    count = 30
    frame = np.tile(np.eye(3), (count, 1, 1))
    xyz = np.column_stack([g.random((count, 2)) * 0.9, np.zeros(count)])
    size = 0.05 + 0.1 * g.random((count, 2))
    cells = Cells(xyz, frame, size, np.zeros(count, np.int64), np.full((count, 3), 1 / 3))
    one = merged(cells, np.zeros(1, np.int64), 1.0)
    area = size.prod(axis=1)
    middle = (area[:, None] * xyz).sum(axis=0) / area.sum()
    moments = np.zeros((3, 3))
    for a, d, x in zip(area, size, xyz, strict=True):
        moments += a * (np.diag([*(d**2 / 12), 0]) + np.outer(x - middle, x - middle))
    assert len(one.xyz) == 1 and np.allclose(one.xyz[0], middle)
    spread = one.frame[0, :, :2] * one.size[0] / np.sqrt(12)
    assert np.allclose(spread @ spread.T, moments / area.sum(), atol=1e-12)
    assert one.weights[0] == pytest.approx(cells.weights[area.argmax()])


@pytest.mark.slow
def test_a_tree_of_many_leaves_keeps_its_trunk(tmp_path: Path) -> None:
    """Every leaf takes a cell; a spacing so wide that the others are few would leave a trunk of six large Gaussians."""
    rng = np.random.default_rng(0)
    foot = rng.uniform((-1, -1, 2), (1, 1, 4), (SAMPLES + 1000, 3))[:, None]
    leaves = (foot + rng.normal(size=(len(foot), 3, 3)) * 0.03).reshape(-1, 3)
    crown = trimesh.Trimesh(leaves, np.arange(len(leaves)).reshape(-1, 3), process=False)
    trunk = trimesh.creation.box((0.2, 0.2, 4)).apply_translation((0, 0, 2))
    trimesh.util.concatenate([trunk, crown]).export(tmp_path / "tree.ply")
    cloud = read(tmp_path / "tree.ply", (2, 2, 4), "tree", up="z").cloud
    below = cloud[cloud.means[:, 2] < 1.5]
    assert len(cloud) <= 1.01 * SAMPLES  # each mesh rounds its number of points
    assert len(below) > 50 and float(below.scales.max()) < 0.15

"""A part of a scene as a file of its own: the same Gaussians, or a closed mesh of the same size and colour."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch
import trimesh

from scenewright.gaussians.assets import make
from scenewright.gaussians.assets.exporting import export
from scenewright.gaussians.assets.modeling.meshing import surface_net
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.files import load
from scenewright.gaussians.scene import Frame, Scene


def test_a_surface_net_of_a_ball_is_closed_faces_outward_and_has_its_volume() -> None:
    grid = np.stack(np.meshgrid(*[np.arange(40.0)] * 3, indexing="ij"), axis=-1)
    vertices, faces = surface_net(12.0 - np.linalg.norm(grid - 20, axis=-1))
    ball = trimesh.Trimesh(vertices, faces, process=False)
    assert ball.is_watertight and ball.is_winding_consistent
    assert ball.volume == pytest.approx(4 / 3 * np.pi * 12**3, rel=0.01)  # positive: outward
    assert np.abs(np.linalg.norm(vertices - 20, axis=1) - 12).max() < 0.2


@pytest.fixture
def scene() -> Scene:
    stool = make("stool", 1, color="red").cloud
    return Scene(stool.replace(ids=torch.arange(len(stool))), Frame((0, 0, 1), 0.0, 2.0, "given", "given"))


def test_gaussians_of_a_part_are_written_as_they_are(scene: Scene, tmp_path: Path) -> None:
    ids = scene.cloud.ids[scene.cloud.means[:, 2] > 0.2]
    export(scene, ids, tmp_path / "part.ply")
    part = load(tmp_path / "part.ply")
    assert torch.equal(part.cloud.means, scene.cloud.means[ids]) and part.frame.metres_per_unit == 2.0


def test_a_mesh_stands_on_its_origin_in_metres_with_the_colours_of_the_part(scene: Scene, tmp_path: Path) -> None:
    export(scene, scene.cloud.ids, tmp_path / "a.glb")
    mesh = trimesh.load(tmp_path / "a.glb", force="mesh")
    size = np.ptp(scene.cloud.means.numpy(), axis=0) * 2.0
    assert mesh.extents == pytest.approx((size[0], size[2], size[1]), rel=0.12)  # y is up
    assert mesh.bounds[0][1] == pytest.approx(0, abs=1e-4)
    red, green, blue = np.median(mesh.visual.vertex_colors[:, :3], axis=0)
    assert red > 1.5 * green and red > 1.5 * blue
    before = (tmp_path / "a.glb").read_bytes()
    export(scene, scene.cloud.ids, tmp_path / "a.glb", force=True)
    assert (tmp_path / "a.glb").read_bytes() == before


def test_nothing_and_unknown_names_are_refused(scene: Scene, tmp_path: Path) -> None:
    with pytest.raises(UserError, match="nothing is selected"):
        export(scene, scene.cloud.ids[:0], tmp_path / "a.ply")
    with pytest.raises(UserError, match="cannot write"):
        export(scene, scene.cloud.ids, tmp_path / "a.xyz")
    assert not list(tmp_path.iterdir())

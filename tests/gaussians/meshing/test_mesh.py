"""Meshes of Gaussians: closed, in metres, upright, rightly coloured, the same bytes each time; and errors."""

from __future__ import annotations

import importlib.util
import io
import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
import trimesh
from flat_boxes import box, joined

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import BackendError, UserError
from scenewright.gaussians.meshing import Mesh, mesh, texturing
from scenewright.gaussians.scene import Frame, Scene

RED, BLUE, GREEN = (0.8, 0.1, 0.1), (0.1, 0.2, 0.8), (0.1, 0.7, 0.2)
CELLS = 48
needs_xatlas = pytest.mark.skipif(importlib.util.find_spec("xatlas") is None, reason="xatlas is not installed")


@pytest.fixture(scope="module")
def letter() -> Scene:
    """An L in scene units of half a metre, far from the origin: red upright to the west, a blue foot to the east and a
    green nose to the south, which is the front."""
    cloud = joined(
        box((10.0, 5.0, 3.0), (10.5, 5.6, 5.0), RED),
        box((10.5, 5.0, 3.0), (11.4, 5.6, 3.5), BLUE),
        box((10.1, 4.4, 4.3), (10.4, 5.0, 4.7), GREEN),
    )
    return Scene(cloud, Frame(metres_per_unit=0.5))


@pytest.fixture(scope="module")
def made(letter: Scene) -> Mesh:
    return mesh(letter, letter.cloud.ids, texture=0, cells=CELLS, watertight=True)


def _loaded(made: Mesh) -> Any:
    return trimesh.load(io.BytesIO(made.encode()), file_type="glb", force="mesh", process=False)


@pytest.mark.slow
def test_a_watertight_mesh_has_two_faces_at_every_edge_and_faces_out(made: Mesh) -> None:
    loaded = _loaded(made)
    assert loaded.is_watertight and loaded.is_winding_consistent
    volume = 0.5**3 * (0.5 * 0.6 * 2.0 + 0.9 * 0.6 * 0.5 + 0.3 * 0.6 * 0.4)
    assert loaded.volume == pytest.approx(volume, rel=0.06)  # edges are rounded within a cell of 2 cm


@pytest.mark.slow
def test_the_mesh_is_in_metres_stands_on_its_own_and_y_is_up(made: Mesh) -> None:
    low, high = _loaded(made).bounds
    # 1.4 x 1.2 x 2 units of half a metre; a cell is 2 cm.
    assert high - low == pytest.approx([0.7, 1.0, 0.6], abs=0.03)
    assert low[1] == pytest.approx(0, abs=1e-6)
    assert (low + high)[[0, 2]] == pytest.approx([0, 0], abs=1e-6)


def test_left_stays_left_and_the_front_faces_plus_z(made: Mesh) -> None:
    """glTF: y up, an object's front faces +z; a scene's front is -y (south)."""
    loaded = _loaded(made)
    color = _display(_colors(made))
    red, blue, green = ((np.abs(color - np.array(c)).max(axis=1) < 0.15) for c in (RED, BLUE, GREEN))
    at = loaded.vertices
    assert at[red][:, 0].mean() < at[blue][:, 0].mean() - 0.2  # west to east is -x to +x
    assert at[red][:, 1].max() > 0.9 and at[blue][:, 1].max() < 0.35
    assert at[green][:, 2].mean() > at[red][:, 2].mean() + 0.15
    assert red.sum() + blue.sum() + green.sum() > 0.8 * len(at)


def _colors(made: Mesh) -> Any:
    """`[V, 3]` uint16, the linear colours in the file; trimesh passes over those of a mesh with a material."""
    data = made.encode()
    size = struct.unpack("<I", data[12:16])[0]
    document = json.loads(data[20 : 20 + size])
    accessor = document["accessors"][document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"]]
    start = 28 + size + document["bufferViews"][accessor["bufferView"]]["byteOffset"]
    return np.frombuffer(data, "<u2", 4 * accessor["count"], start).reshape(-1, 4)[:, :3]


def _display(of_16_bits: Any) -> Any:
    """Display colours of linear ones."""
    linear = np.asarray(of_16_bits) / 65535
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


@pytest.mark.slow
def test_a_scene_with_another_up_gives_the_same_upright_mesh(letter: Scene, made: Mesh) -> None:
    turn = torch.tensor([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])  # z up becomes y up
    cloud = letter.cloud
    s = cloud.scales[:, [0, 2, 1]]
    turned = letter.replace(
        cloud=cloud.replace(means=cloud.means @ turn.T, scales=s), frame=Frame((0, 1, 0), metres_per_unit=0.5)
    )
    other = mesh(turned, cloud.ids, texture=0, cells=CELLS, watertight=True)
    assert other.size == pytest.approx(made.size, abs=0.02)
    low, high = _loaded(other).bounds
    assert high[1] - low[1] == pytest.approx(1.0, abs=0.03)


@pytest.mark.slow
def test_in_place_keeps_the_origin_of_the_scene(letter: Scene) -> None:
    part = letter.cloud.ids[:1536]  # the red upright
    low, high = _loaded(mesh(letter, part, texture=0, cells=CELLS, in_place=True)).bounds
    # x is east, y up, z south: half a metre a unit.
    assert low == pytest.approx([5.0, 1.5, -2.8], abs=0.03)
    assert high == pytest.approx([5.25, 2.5, -2.5], abs=0.03)


@pytest.mark.slow
def test_the_same_input_gives_the_same_bytes(letter: Scene, made: Mesh) -> None:
    again = mesh(letter, letter.cloud.ids, texture=0, cells=CELLS, watertight=True)
    assert again.encode() == made.encode()


@pytest.mark.slow
def test_faces_are_at_most_what_is_asked_for_and_the_mesh_stays_closed(letter: Scene) -> None:
    few = mesh(letter, letter.cloud.ids, texture=0, cells=CELLS, faces=60, watertight=True)
    assert len(few.faces) <= 60
    assert _loaded(few).is_watertight


def test_the_file_follows_gltf(made: Mesh) -> None:
    data = made.encode()
    magic, version, length = struct.unpack("<4sII", data[:12])
    assert (magic, version, length) == (b"glTF", 2, len(data))
    size, kind = struct.unpack("<I4s", data[12:20])
    document = json.loads(data[20 : 20 + size])
    assert kind == b"JSON" and size % 4 == 0
    (primitive,) = document["meshes"][0]["primitives"]
    place = document["accessors"][primitive["attributes"]["POSITION"]]
    assert place["min"] == made.placed.astype(np.float32).min(axis=0).tolist()
    assert place["max"] == made.placed.astype(np.float32).max(axis=0).tolist()
    assert document["materials"][0]["extensions"] == {"KHR_materials_unlit": {}}
    assert all(view["byteOffset"] % 4 == 0 for view in document["bufferViews"])


@pytest.mark.slow
def test_a_wall_is_a_thin_sheet(letter: Scene) -> None:
    wall = box((0, 0, 0), (2, 0.0005, 1.5), GREEN)
    made = mesh(Scene(wall), wall.ids, texture=0, cells=24, watertight=True)
    width, height, depth = made.size
    assert (width, height) == pytest.approx((2, 1.5), abs=2.5 * made.cell)  # its rim grows
    assert 0 < depth < 1.5 * made.cell
    assert _loaded(made).is_watertight


def test_one_gaussian_is_an_ellipsoid() -> None:
    one = GaussianCloud.create(
        torch.tensor([[1.0, 2.0, 3.0]]), torch.tensor([[1.0, 0, 0, 0]]), torch.tensor([[0.4, 0.2, 0.1]]),
        torch.tensor([0.95]), torch.zeros(1, 1, 3),
    )  # fmt: skip
    made = mesh(Scene(one), one.ids, texture=0, watertight=True)
    # Opacity .95 stops half the light within sqrt(2 ln(.95 / .5)) = 1.13 standard deviations.
    assert np.ptp(made.vertices, axis=0) == pytest.approx(2 * 1.13 * np.array([0.4, 0.2, 0.1]), rel=0.15)
    assert _loaded(made).is_watertight


@pytest.mark.slow
def test_a_floater_neither_widens_the_grid_nor_is_in_the_mesh(letter: Scene, made: Mesh) -> None:
    far = box((60, 60, 60), (60.1, 60.1, 60.1), RED, across=1)
    near = box((11.2, 5.2, 4.6), (11.22, 5.22, 4.62), RED, across=1)
    cloud = joined(letter.cloud, far, near)
    with_floaters = mesh(letter.replace(cloud=cloud), cloud.ids, texture=0, cells=CELLS, watertight=True)
    assert with_floaters.size == pytest.approx(made.size, abs=0.03)


@pytest.mark.slow
def test_a_hollow_thing_is_filled() -> None:
    cube = box((0, 0, 0), (1, 1, 1), BLUE)
    made = mesh(Scene(cube), cube.ids, texture=0, cells=CELLS, watertight=True)
    assert _loaded(made).volume == pytest.approx(1.0, rel=0.05)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"faces": 3}, "at least 4 faces"),
        ({"texture": 7}, "16 to 4096 texels"),
        ({"cells": 4}, "8 to 512 cells"),
    ],
)
def test_arguments_out_of_range_are_refused(letter: Scene, change: dict[str, int], message: str) -> None:
    with pytest.raises(UserError, match=message):
        mesh(letter, **{"texture": 0, **change})  # type: ignore[arg-type]


def test_nothing_faint_and_broken_are_told(letter: Scene) -> None:
    with pytest.raises(UserError, match="nothing is selected"):
        mesh(letter, torch.tensor([], dtype=torch.int64), texture=0)
    with pytest.raises(UserError, match="nothing is selected"):
        mesh(letter, [], texture=0)
    for wrong in ([0.5], letter.cloud.ids > 3, "the chair", [None], np.ones(3, bool)):
        with pytest.raises(UserError, match="whole numbers"):
            mesh(letter, wrong, texture=0)  # type: ignore[arg-type]
    faint = box((0, 0, 0), (1, 1, 1), RED, opacity=0.05)
    with pytest.raises(UserError, match="too faint"):
        mesh(Scene(faint), faint.ids, texture=0, cells=CELLS)
    broken = faint.replace(means=torch.full_like(faint.means, float("nan")))
    with pytest.raises(UserError, match="not finite"):
        mesh(Scene(broken), texture=0)


def test_a_file_of_another_kind_or_that_exists_is_refused(made: Mesh, tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"name it chair\.glb"):
        made.save(tmp_path / "chair.obj")
    made.save(tmp_path / "chair.glb")
    with pytest.raises(UserError, match="exists"):
        made.save(tmp_path / "chair.glb")
    made.save(tmp_path / "chair.glb", force=True)
    assert (tmp_path / "chair.glb").read_bytes() == made.encode()


def test_a_missing_extra_says_what_to_install(letter: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(texturing, "installed", lambda: False)
    with pytest.raises(BackendError, match=r'pip install "scenewright\[mesh\]".*--texture 0'):
        mesh(letter)


@needs_xatlas
@pytest.mark.slow
def test_a_texture_has_the_colours_of_the_splats_and_the_same_bytes_each_time(letter: Scene) -> None:
    def make() -> Mesh:
        return mesh(letter, letter.cloud.ids, texture=128, cells=CELLS, watertight=True)

    textured = make()
    assert textured.texture is not None and textured.texture.shape == (128, 128, 3)
    loaded = _loaded(textured)
    loaded.merge_vertices(merge_tex=True)
    assert loaded.is_watertight  # but for the seams of the texture
    assert make().encode() == textured.encode()
    shown = _loaded(textured)
    points, rows = trimesh.sample.sample_surface(shown, 400, seed=0)
    uv = (
        trimesh.triangles.points_to_barycentric(shown.triangles[rows], points)[:, :, None]
        * shown.visual.uv[shown.faces[rows]]
    )
    color = trimesh.visual.color.uv_to_interpolated_color(uv.sum(axis=1), shown.visual.material.baseColorTexture)
    upper = points[:, 1] > 0.9  # above the foot and the nose: only red is there
    assert np.abs(color[upper][:, :3] / 255 - RED).max(axis=1).mean() < 0.06


def test_colours_are_the_least_squares_solution() -> None:
    rng = np.random.default_rng(5)
    truth = rng.random((40, 3))
    at = rng.integers(0, 40, (900, 3)).astype(np.int32)
    share = rng.dirichlet(np.ones(3), 900).astype(np.float32)
    rgb = np.einsum("rk,rkc->rc", share, truth[at]).astype(np.float32)
    seen = texturing.Observations(at, share, rgb, np.ones(900, np.float32))
    keep: Callable[..., Any] = lambda colors, known: colors  # noqa: E731
    assert np.abs(texturing.solve(seen, 40, keep) - truth).max() < 0.03  # colours are held to the mean a little

"""Pictures of tiles are those of the whole scene, bit for bit, in however many slabs of depth they are drawn."""

from __future__ import annotations

from pathlib import Path

import pytest
import torch
from street import saved_street

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.errors import FileError
from scenewright.gaussians.files import load, save
from scenewright.gaussians.render import render
from scenewright.gaussians.render.convention import NEAR, near_plane
from scenewright.gaussians.tiles import drawing
from scenewright.gaussians.tiles.making import make
from scenewright.gaussians.tiles.store import TILES, Tiles

INSIDE = Camera.look_at([0.5, -1.8, 1.6], [4, 1, 0.5], [0, 0, 1], 96, 64, 70)
ABOVE = Camera.look_at([6, -9, 9], [6, 0, 0], [0, 0, 1], 101, 67, 60)
AWAY = Camera.look_at([0, -9, 9], [0, -20, 20], [0, 0, 1], 32, 32)


@pytest.fixture
def tiles(tmp_path: Path) -> Tiles:
    return make([saved_street(tmp_path)], tmp_path / "a.tiles", most=1000)


@pytest.mark.parametrize(
    ("camera", "room"),
    [
        pytest.param(INSIDE, 700, id="inside in slabs"),
        pytest.param(INSIDE, 1 << 18, id="inside", marks=pytest.mark.slow),
        pytest.param(ABOVE, 700, id="above in slabs", marks=pytest.mark.slow),
        pytest.param(ABOVE, 1 << 18, id="above", marks=pytest.mark.slow),
    ],
)
def test_a_picture_has_the_bytes_of_that_of_the_whole(
    tiles: Tiles, camera: Camera, room: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(drawing, "_LEAST", room)
    drawn = drawing.draw(tiles, camera, (0.2, 0.3, 0.4), memory=1)
    whole = render(load(tiles.folder), camera, (0.2, 0.3, 0.4))
    for name in ("rgb", "alpha", "depth", "group"):
        assert torch.equal(getattr(drawn.render, name), getattr(whole, name)), name
    assert (drawn.slabs > 5) == (room == 700)


@pytest.mark.slow
def test_footprints_of_one_depth_follow_each_other_by_id(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = load(saved_street(tmp_path))
    flat = scene.cloud.means.clone()
    flat[:, 1] = 2.0  # all at one depth for a camera that looks along y
    save(scene.replace(cloud=scene.cloud.replace(means=flat)), tmp_path / "flat.ply")
    made = make([tmp_path / "flat.ply"], tmp_path / "b.tiles", most=1000)
    camera = Camera.look_at([6, -12, 1], [6, 2, 1], [0, 0, 1], 96, 64)
    whole = render(load(tmp_path / "flat.ply"), camera)
    assert torch.equal(drawing.draw(made, camera).render.rgb, whole.rgb)


def test_tiles_out_of_view_are_not_read(tiles: Tiles) -> None:
    nothing = drawing.draw(tiles, AWAY)
    assert nothing.tiles == nothing.read == nothing.gaussians == 0 and not nothing.render.alpha.any()
    far = max(range(len(tiles.state.tiles)), key=lambda k: tiles.state.tiles[k].low[0])
    (tiles.folder / TILES / tiles.state.tiles[far].columns["sh"].file).unlink()
    near = Camera.look_at([0, -8, 2], [-1, 0, 0.5], [0, 0, 1], 64, 48, 30)
    assert 0 < drawing.draw(tiles, near).tiles < len(tiles.state.tiles)
    with pytest.raises(FileError, match="--undo"):
        drawing.draw(tiles, ABOVE)


@pytest.mark.slow
def test_drawing_stops_where_no_pixel_takes_more(tiles: Tiles, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drawing, "_LEAST", 200)
    wall = Camera.look_at([0, 0, 1.3], [-2, 0, 1.3], [0, 0, 1], 32, 32, 20)
    drawn = drawing.draw(tiles, wall, memory=1)
    assert drawn.render.alpha.min() > 0.99
    assert drawn.read <= drawn.tiles * drawn.slabs


@pytest.mark.slow
def test_the_near_plane_is_that_of_the_whole_of_a_tiny_scene(tmp_path: Path) -> None:
    scene = load(saved_street(tmp_path))
    tiny = scene.cloud.replace(means=scene.cloud.means * 0.01, scales=scene.cloud.scales * 0.01)
    save(scene.replace(cloud=tiny), tmp_path / "tiny.ply")
    made = make([tmp_path / "tiny.ply"], tmp_path / "b.tiles", most=1000)
    whole = load(tmp_path / "tiny.ply").cloud
    assert drawing.near_plane(made) == near_plane(whole.means) < NEAR
    camera = Camera.look_at([0.005, -0.018, 0.016], [0.04, 0.01, 0.005], [0, 0, 1], 96, 64, 70)
    assert torch.equal(drawing.draw(made, camera).render.rgb, render(whole, camera).rgb)

"""Fewer Gaussians of a scene in tiles, part by part: the promise holds in pictures of the whole, what is kept stays as it
was, and things keep enough to be found."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from street import saved_street

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.slim import Settings
from scenewright.gaussians.slim.loss import Truth
from scenewright.gaussians.slim.reductions import KEPT_OF_GROUP
from scenewright.gaussians.tiles import window
from scenewright.gaussians.tiles.making import make
from scenewright.gaussians.tiles.slimming import SlimmedTiles, ranking, slim_tiles, slimming
from scenewright.gaussians.tiles.store import Tiles

PROMISED = 30.0
SMALL = Settings(PROMISED, 48)


@pytest.fixture(scope="module")
def tiles(tmp_path_factory: pytest.TempPathFactory) -> Tiles:
    folder = tmp_path_factory.mktemp("street")
    return make([saved_street(folder)], folder / "a.tiles", most=1000)


@pytest.fixture(scope="module")
def slimmed(tiles: Tiles, tmp_path_factory: pytest.TempPathFactory) -> SlimmedTiles:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(slimming, "ROWS", 2500)
        return slim_tiles(tiles, tmp_path_factory.mktemp("out") / "b.tiles", SMALL, 1 << 30)


def test_every_part_keeps_the_promise_in_pictures_of_the_whole(tiles: Tiles, slimmed: SlimmedTiles) -> None:
    assert len(slimmed.parts) >= 3 and len(slimmed.tiles) < 0.9 * len(tiles)
    assert all(part is not None and part.psnr >= PROMISED for part in slimmed.parts)
    assert slimmed.orbit is not None and slimmed.orbit.psnr >= PROMISED
    again = Truth(tiles.every_row(), slimmed.views).loss(slimmed.tiles.every_row())  # in memory, by the usual renderer
    assert again == slimmed.held_out and again.psnr >= PROMISED


def test_what_is_kept_stays_and_things_keep_enough(tiles: Tiles, slimmed: SlimmedTiles) -> None:
    before, after = tiles.every_row(), slimmed.tiles.every_row()
    rows = torch.from_numpy(np.searchsorted(before.ids.numpy(), slimmed.ids))
    assert torch.equal(before.ids[rows], torch.from_numpy(slimmed.ids))
    assert after.ids.tolist() == list(range(len(after)))
    assert after.digest() == before[rows].replace(ids=after.ids).digest()
    assert tiles.field is not None and slimmed.tiles.field is not None
    sizes = np.bincount(after.group[after.group >= 0].numpy(), minlength=len(tiles.field.groups))
    assert (sizes >= np.minimum(tiles.sizes(len(sizes)), KEPT_OF_GROUP)).all()
    for old, new in zip(tiles.field.groups, slimmed.tiles.field.groups, strict=True):
        assert new == replace(old, count=int(sizes[old.id]))
    homes = window.homes_of(slimmed.tiles, np.arange(len(after)))
    assert [int(np.sum(homes == k)) for k in range(len(slimmed.tiles.state.tiles))] == [
        tile.rows for tile in slimmed.tiles.state.tiles
    ]
    assert not (slimmed.tiles.folder / "pieces").exists()


def test_parts_that_lack_something_get_more(
    tiles: Tiles, slimmed: SlimmedTiles, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def too_few(cloud: Any, order: Any, least: int, truth: Any, target: float) -> tuple[int, float]:
        return least, 40.0

    monkeypatch.setattr(slimming, "ROWS", 2500)
    monkeypatch.setattr(slimming, "RAISES", 2)
    monkeypatch.setattr(ranking, "_fewest", too_few)
    done = slim_tiles(tiles, tmp_path / "b.tiles", SMALL, 1 << 30)
    assert done.raised > 2 and done.held_out.psnr >= PROMISED
    assert all(part is not None and part.psnr >= PROMISED for part in done.parts)


def test_the_scene_itself_is_not_overwritten_and_optimisation_is_refused(tiles: Tiles, tmp_path: Path) -> None:
    known = tiles.digest()
    with pytest.raises(UserError, match="is the scene itself"):
        slim_tiles(tiles, tiles.folder, SMALL, 1 << 30, force=True)
    with pytest.raises(UserError, match="can be optimised"):
        slim_tiles(tiles, tmp_path / "b.tiles", replace(SMALL, steps=1), 1 << 30)
    assert Tiles.open(tiles.folder).digest() == known and not list(tmp_path.iterdir())


def test_of_many_cameras_those_near_a_part_look_at_it(tiles: Tiles, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ranking, "MOST", 5)
    cloud = tiles.every_row()
    first = cloud[torch.from_numpy(np.flatnonzero(cloud.means[:, 0].numpy() < 3))]

    def camera(x: float, toward: float) -> Camera:
        return Camera.look_at([x, 0.0, 1.0], [x + toward, 0.0, 1.0], [0, 0, 1], 64, 64)

    away = [camera(float(x), 1.0) for x in range(4, 10)]
    far = [camera(float(x), -1.0) for x in range(20, 30)]
    near = [camera(4 + x / 10, -1.0) for x in range(10)]
    assert ranking.seeing(first, [*away, *far, *near]) == tuple(near)
    assert ranking.seeing(first, away) == ()

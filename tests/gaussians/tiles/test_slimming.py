"""Fewer Gaussians of a scene in tiles, part by part: the promise holds in pictures of the whole, what is kept stays as
it was, and things keep enough to be found."""

from __future__ import annotations

import os
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
from scenewright.gaussians.tiles.blocks import divided, part_of, sampled
from scenewright.gaussians.tiles.making import make, new_folder
from scenewright.gaussians.tiles.slimming import SlimmedTiles, checking, ranking, slim_tiles, slimming
from scenewright.gaussians.tiles.slimming.ranking import Places
from scenewright.gaussians.tiles.slimming.writing import write_kept
from scenewright.gaussians.tiles.store import Tiles

PROMISED = 30.0
SMALL = Settings(PROMISED, 48)


@pytest.fixture(scope="module")
def tiles(tmp_path_factory: pytest.TempPathFactory) -> Tiles:
    folder = tmp_path_factory.mktemp("street")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda handle: None)
        return make([saved_street(folder)], folder / "a.tiles", most=4000)


@pytest.fixture(scope="module")
def slimmed(tiles: Tiles, tmp_path_factory: pytest.TempPathFactory) -> SlimmedTiles:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda handle: None)
        patch.setattr(slimming, "ROWS", 6000)
        return slim_tiles(tiles, tmp_path_factory.mktemp("out") / "b.tiles", SMALL, 1 << 30)


@pytest.mark.slow
def test_every_part_keeps_the_promise_in_pictures_of_the_whole(tiles: Tiles, slimmed: SlimmedTiles) -> None:
    assert len(slimmed.parts) == 3 and len(slimmed.tiles) < 0.6 * len(tiles)
    assert all(part is not None and part.psnr >= PROMISED for part in slimmed.parts)
    assert slimmed.orbit is not None and slimmed.orbit.psnr >= PROMISED
    again = Truth(tiles.every_row(), slimmed.views).loss(slimmed.tiles.every_row())  # in memory, by the usual renderer
    assert again == slimmed.held_out and again.psnr >= PROMISED


@pytest.mark.slow
def test_equal_input_gives_equal_tiles(
    tiles: Tiles, slimmed: SlimmedTiles, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(slimming, "ROWS", 6000)
    assert slim_tiles(tiles, tmp_path / "c.tiles", SMALL, 1 << 30).tiles.digest() == slimmed.tiles.digest()


@pytest.mark.slow
def test_things_keep_enough_to_be_found(tiles: Tiles, slimmed: SlimmedTiles) -> None:
    assert tiles.field is not None
    sizes, left = (found.sizes(len(tiles.field.groups)) for found in (tiles, slimmed.tiles))
    assert (left >= np.minimum(sizes, KEPT_OF_GROUP)).all()


@pytest.mark.slow
def test_parts_that_lack_something_get_more(tiles: Tiles, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def too_few(cloud: Any, order: Any, least: int, truth: Any, target: float) -> tuple[int, float]:
        return least, 18.0

    monkeypatch.setattr(slimming, "ROWS", 6000)
    monkeypatch.setattr(checking, "RAISES", 2)
    monkeypatch.setattr(ranking, "_fewest", too_few)
    done = slim_tiles(tiles, tmp_path / "b.tiles", SMALL, 1 << 30)
    assert done.raised > 2 and all(part is not None and part.psnr >= PROMISED for part in done.parts)


def test_what_is_kept_stays_as_it_was(tiles: Tiles, tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    kept = [rng.random(tile.rows) < 0.3 for tile in tiles.state.tiles]
    kept[1][:] = False  # a tile of which nothing is kept
    with new_folder(tmp_path / "b.tiles", False) as folder:
        write_kept(tiles, [rows | True for rows in kept], folder)
        ids = write_kept(tiles, kept, folder)  # in place of what was written before
    found = Tiles.open(tmp_path / "b.tiles")
    before, after = tiles.every_row(), found.every_row()
    assert np.array_equal(ids, np.sort(np.concatenate([tiles.column(k, "ids")[own] for k, own in enumerate(kept)])))
    assert after.ids.tolist() == list(range(len(ids))) and len(found.state.tiles) == len(tiles.state.tiles) - 1
    assert after.replace(first_free=0).digest() == before[ids].replace(ids=after.ids, first_free=0).digest()
    homes = window.homes_of(found, np.arange(len(after)))
    assert np.bincount(homes).tolist() == [tile.rows for tile in found.state.tiles]
    assert tiles.field is not None and found.field is not None
    sizes = np.bincount(after.group[after.group >= 0].numpy(), minlength=len(tiles.field.groups))
    assert found.field.groups == tuple(replace(g, count=int(sizes[g.id])) for g in tiles.field.groups)


def test_places_tell_the_first_rows_of_each_part(tiles: Tiles, tmp_path: Path) -> None:
    sample = sampled(tiles, 10**6)
    parts = divided(tiles, sample, 1.0, 6000, 0.0)
    places, first = Places(tmp_path, tiles, parts), []
    for number in range(len(parts)):
        block = part_of(tiles, parts, number)
        order = np.random.default_rng(number).permutation(len(block.cloud))
        places.keep(block.tile, block.row, order)
        first.append(block.cloud.ids.numpy()[order[: 100 * number]])
    counts = np.arange(len(parts)) * 100
    kept = [tiles.column(k, "ids")[places.kept(k, counts)] for k in range(len(tiles.state.tiles))]
    assert len(parts) == 3 and np.array_equal(np.sort(np.concatenate(kept)), np.sort(np.concatenate(first)))


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

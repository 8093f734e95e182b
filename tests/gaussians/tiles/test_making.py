"""Tiling: every row in one tile with its bytes, tiles of space, sources joined; and what is torn, full or wrong."""

from __future__ import annotations

import errno
import os
import shutil
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import torch
from street import saved_street

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import FileError, UserError
from scenewright.gaussians.files import load as load_file
from scenewright.gaussians.files import save
from scenewright.gaussians.language.field.loading import load
from scenewright.gaussians.scene import Scene
from scenewright.gaussians.tiles.making import make
from scenewright.gaussians.tiles.store import TILES, Tiles


@pytest.fixture
def source(tmp_path: Path) -> Path:
    return saved_street(tmp_path)


def same(a: GaussianCloud, b: GaussianCloud) -> bool:
    return all(torch.equal(column, getattr(b, name)) for name, column in a.columns())


def test_every_row_is_in_one_tile_as_a_file_holds_it_and_tiles_divide_space(source: Path, tmp_path: Path) -> None:
    made = make([source], tmp_path / "a.tiles", most=1000)
    whole = load(source)
    assert same(made.every_row(), whole.cloud) and same(load(made.folder).cloud, whole.cloud)
    assert made.field is not None and whole.language is not None and made.field.groups == whole.language.groups
    assert made.frame == load_file(source).frame and len(made.cameras) == 1
    assert all(0 < tile.rows <= 1000 for tile in made.state.tiles) and len(made.state.tiles) > 5
    for number, tile in enumerate(made.state.tiles):
        means = made.column(number, "means")
        assert (means >= tile.low).all() and (means <= tile.high).all()
    extents = [np.prod(np.subtract(tile.high, tile.low)[:2]) for tile in made.state.tiles]
    assert np.median(extents) < 0.2 * np.prod(np.subtract(*made.bounds[::-1])[:2])


@pytest.mark.slow
def test_the_same_file_gives_the_same_bytes(source: Path, tmp_path: Path) -> None:
    one, two = (make([source], tmp_path / name, most=1000) for name in ("a.tiles", "b.tiles"))
    assert one.digest() == two.digest()
    assert one.state == two.state


@pytest.mark.slow
def test_groups_are_found_in_the_tiles_that_hold_them(source: Path, tmp_path: Path) -> None:
    made = make([source], tmp_path / "a.tiles", most=1000)
    group = made.every_row().group
    assert made.field is not None
    for g in (0, 6, 13):
        assert made.count([g]) == int((group == g).sum()) == made.field.groups[g].count
        holding = {k for k in range(len(made.state.tiles)) if (made.column(k, "group") == g).any()}
        assert set(made.holding([g])) == holding


def test_several_files_become_one_scene_with_one_table(source: Path, tmp_path: Path) -> None:
    made = make([source, source], tmp_path / "a.tiles", most=1000)
    one = load(source)
    assert one.language is not None and made.field is not None
    many, n = len(one.language.groups), len(one.cloud)
    both = made.every_row()
    assert len(both) == 2 * n and both.ids.tolist() == list(range(2 * n))
    assert torch.equal(both.means[n:], one.cloud.means)
    assert torch.equal(both.group[n:], torch.where(one.cloud.group >= 0, one.cloud.group + many, -1))
    assert [g.label for g in made.field.groups] == 2 * [g.label for g in one.language.groups]


@pytest.mark.slow
def test_files_of_which_one_has_no_names_are_one_scene_without(source: Path, tmp_path: Path) -> None:
    save(load_file(source), tmp_path / "bare.ply")
    made = make([source, tmp_path / "bare.ply"], tmp_path / "a.tiles")
    assert made.field is None and (made.every_row().group == -1).all()
    assert "bare.ply has no language field" in made.state.notes[-1]


@pytest.mark.slow
def test_rows_that_no_file_may_hold_are_dropped_and_ids_stay_row_numbers(tmp_path: Path) -> None:
    scene = load_file(saved_street(tmp_path))
    means = scene.cloud.means.clone()
    means[[3, 700]] = float("nan")
    save(Scene(scene.cloud.replace(means=means)), tmp_path / "holes.ply")
    made = make([tmp_path / "holes.ply"], tmp_path / "a.tiles", most=1000)
    assert same(made.every_row(), load_file(tmp_path / "holes.ply").cloud)
    assert made.state.missing == 2 and "2 of" in made.state.notes[0]


@pytest.mark.slow
def test_a_million_rows_in_one_place_are_divided_too(tmp_path: Path) -> None:
    scene = load_file(saved_street(tmp_path))
    save(Scene(scene.cloud.replace(means=torch.zeros_like(scene.cloud.means))), tmp_path / "heap.ply")
    made = make([tmp_path / "heap.ply"], tmp_path / "a.tiles", most=1000)
    assert max(tile.rows for tile in made.state.tiles) <= 1000 and len(made) == len(scene.cloud)
    assert same(made.every_row(), load_file(tmp_path / "heap.ply").cloud)


@pytest.mark.parametrize("harm", ["flip", *(pytest.param(h, marks=pytest.mark.slow) for h in ("cut", "gone"))])
def test_a_torn_tile_is_never_read(source: Path, tmp_path: Path, harm: str) -> None:
    made = make([source], tmp_path / "a.tiles", most=1000)
    path = made.folder / TILES / made.state.tiles[2].columns["sh"].file
    stored = bytearray(path.read_bytes())
    stored[-1] ^= 1
    path.unlink() if harm == "gone" else path.write_bytes(stored if harm == "flip" else stored[:-4])
    again = Tiles.open(made.folder)
    with pytest.raises(FileError, match=r"2\.sh\.0.*(damaged|bytes|No such).*--undo"):
        again.cloud(2)
    assert len(again.cloud(1)) == again.state.tiles[1].rows
    with pytest.raises(FileError):
        again.digest()


def test_a_disk_without_room_is_told_before_anything_is_written(
    source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda path: SimpleNamespace(free=1000))
    with pytest.raises(FileError, match="make room"):
        make([source], tmp_path / "a.tiles")
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted([source.name, f"{source.name}.field.safetensors"])


def test_a_disk_that_fills_up_meanwhile_is_told_and_nothing_is_left(
    source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is mapped has its room on the disk before a page is written, as a full disk would end the process then."""

    def full(handle: int, start: int, size: int) -> None:
        assert size == 4 * len(load_file(source).cloud)
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "posix_fallocate", full)
    with pytest.raises(FileError, match="No space left on device; make room"):
        make([source], tmp_path / "a.tiles", most=1000)
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted([source.name, f"{source.name}.field.safetensors"])


@pytest.mark.slow
def test_what_exists_is_replaced_only_on_request_and_only_if_it_is_tiles(source: Path, tmp_path: Path) -> None:
    made = make([source], tmp_path / "a.tiles")
    with pytest.raises(UserError, match="exists"):
        make([source], made.folder)
    (made.folder / "diary.txt").write_text("mine")
    with pytest.raises(UserError, match=r"diary\.txt"):
        make([source], made.folder, force=True)
    (made.folder / "diary.txt").unlink()
    assert make([source], made.folder, force=True).state == made.state


def test_a_folder_that_is_none_is_told(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="folder of tiles"):
        Tiles.open(tmp_path)
    (tmp_path / "HEAD.json").write_text('{"version": 1, "present": 3}')
    with pytest.raises(FileError, match=r"HEAD\.json is no index"):
        Tiles.open(tmp_path)

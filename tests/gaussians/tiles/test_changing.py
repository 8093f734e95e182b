"""Changes go back to the touched tiles alone; undo is exact; whatever stops a change leaves the scene before it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from street import saved_street

from scenewright.gaussians.cloud import NO_GROUP, GaussianCloud, concat
from scenewright.gaussians.errors import FileError, UserError
from scenewright.gaussians.files import save
from scenewright.gaussians.language.field.loading import load
from scenewright.gaussians.motion.motion import Motion, Track
from scenewright.gaussians.scene import Scene
from scenewright.gaussians.tiles import changing, files, window
from scenewright.gaussians.tiles.changing import change, redo, undo
from scenewright.gaussians.tiles.exporting import write_ply
from scenewright.gaussians.tiles.locking import locked
from scenewright.gaussians.tiles.making import make
from scenewright.gaussians.tiles.store import TILES, Tiles
from scenewright.tools.field_update import recount

MEMORY = 1 << 30
ARMCHAIR = 5  # of the first room


@pytest.fixture
def tiles(tmp_path: Path) -> Tiles:
    return make([saved_street(tmp_path)], tmp_path / "a.tiles", most=1000)


def edited(cloud: GaussianCloud) -> GaussianCloud:
    """The first ten rows gone, the next ten red, and two new ones at the end."""
    sh = cloud.sh.clone()
    sh[10:20] = 1.5
    kept = cloud.replace(sh=sh)[10:]
    free = max(cloud.first_free, int(cloud.ids.max()) + 1)
    new = kept[:2].replace(ids=torch.tensor([free + 1, free + 4]))
    return concat([kept, new])


def names(tiles: Tiles) -> set[str]:
    return {stored.file for tile in tiles.state.tiles for stored in tile.columns.values()}


def test_a_change_is_that_of_the_whole_scene_and_touches_only_its_tiles(tiles: Tiles) -> None:
    before = tiles.every_row()
    taken = window.of_groups(tiles, [ARMCHAIR], MEMORY)
    outside = {p: p.read_bytes() for p in (tiles.folder / TILES).iterdir()}
    after = change(taken, taken.scene.replace(cloud=edited(taken.scene.cloud)), "change")
    gone, red = (taken.scene.cloud.ids[s].tolist() for s in (slice(10), slice(10, 20)))
    now = Tiles.open(tiles.folder).every_row()
    assert now.ids.tolist() == [i for i in before.ids.tolist() if i not in set(gone)] + now.ids.tolist()[-2:]
    assert now.ids.tolist()[-2:] == [len(before) + 1, len(before) + 4]
    rows = torch.isin(now.ids, torch.tensor(red))
    assert (now.sh[rows] == 1.5).all() and len(now) == len(before) - 8
    others = torch.isin(before.ids, now.ids[~rows])
    assert torch.equal(before.sh[others], now.sh[~rows][:-2])
    assert all(path.read_bytes() == stored for path, stored in outside.items())
    touched = {name.split(".")[0] for name in names(after) - names(tiles)}
    assert touched <= {str(k) for k in (*taken.tiles_read, len(tiles.state.tiles))}
    assert after.count([ARMCHAIR]) == len(taken.scene.cloud) - 8


@pytest.mark.slow
def test_only_columns_that_differ_are_written(tiles: Tiles) -> None:
    taken = window.of_groups(tiles, [ARMCHAIR], MEMORY)
    cloud = taken.scene.cloud
    after = change(taken, taken.scene.replace(cloud=cloud.replace(sh=cloud.sh + 1)), "brighter")
    assert {name.split(".")[1] for name in names(after) - names(tiles)} == {"sh"}
    assert after.state.gone == tiles.state.gone and after.state.table == tiles.state.table


def test_undo_and_redo_give_the_same_files_again(tiles: Tiles) -> None:
    first = tiles.digest()
    taken = window.of_groups(tiles, [ARMCHAIR], MEMORY)
    second = change(taken, taken.scene.replace(cloud=edited(taken.scene.cloud)), "change").digest()
    back, text = undo(tiles.folder)
    assert (back.digest(), text) == (first, "change") and second != first
    assert redo(tiles.folder)[0].digest() == second
    with pytest.raises(UserError, match="nothing to redo"):
        redo(tiles.folder)
    undo(tiles.folder)
    with pytest.raises(UserError, match="nothing to undo"):
        undo(tiles.folder)
    taken = window.of_groups(Tiles.open(tiles.folder), [ARMCHAIR], MEMORY)
    change(taken, taken.scene.replace(cloud=taken.scene.cloud[5:]), "another")
    with pytest.raises(UserError, match="nothing to redo"):
        redo(tiles.folder)


@pytest.mark.parametrize("stage", ["head", *(pytest.param(s, marks=pytest.mark.slow) for s in ("files", "state"))])
def test_a_stop_at_any_stage_leaves_the_scene_before(tiles: Tiles, stage: str, monkeypatch: pytest.MonkeyPatch) -> None:
    first = tiles.digest()
    taken = window.of_groups(tiles, [ARMCHAIR], MEMORY)
    real, written = files.write, 0

    def full(folder: Path, name: str, content: files.Array | bytes) -> files.Stored:
        nonlocal written
        written += 1
        if (stage == "files" and written == 4) or (stage == "state" and folder.name == "states"):
            raise FileError("cannot write: No space left on device")
        return real(folder, name, content)

    def no_switch(folder: Path, head: object) -> None:
        raise FileError("cannot write: No space left on device")

    monkeypatch.setattr(files, "write", full)
    if stage == "head":
        monkeypatch.setattr(changing, "_switch", no_switch)
    with pytest.raises(FileError, match="No space"):
        change(taken, taken.scene.replace(cloud=edited(taken.scene.cloud)), "change")
    monkeypatch.undo()
    again = Tiles.open(tiles.folder)
    assert again.digest() == first and not again.head.past
    taken = window.of_groups(again, [ARMCHAIR], MEMORY)
    after = change(taken, taken.scene.replace(cloud=edited(taken.scene.cloud)), "change")
    on_disk = {p.name for p in (tiles.folder / TILES).iterdir()}
    owners = {tile.owners.file for t in (tiles, after) for tile in t.state.tiles}
    assert on_disk == names(tiles) | names(after) | owners


@pytest.mark.slow
def test_two_programs_do_not_change_one_scene(tiles: Tiles) -> None:
    one, two = (window.of_groups(tiles, [g], MEMORY) for g in (ARMCHAIR, ARMCHAIR + 1))
    with locked(tiles.folder), pytest.raises(FileError, match="being changed by another program"):
        change(one, one.scene.replace(cloud=one.scene.cloud[3:]), "one")
    change(one, one.scene.replace(cloud=one.scene.cloud[3:]), "one")
    with pytest.raises(FileError, match="meanwhile"):
        change(two, two.scene.replace(cloud=two.scene.cloud[3:]), "two")
    assert [step.text for step in Tiles.open(tiles.folder).head.steps] == ["", "one"]


@pytest.mark.slow
def test_states_out_of_reach_are_removed(tiles: Tiles, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(changing, "KEPT", 2)
    for k in range(4):
        taken = window.of_groups(Tiles.open(tiles.folder), [ARMCHAIR], MEMORY)
        cloud = taken.scene.cloud
        change(taken, taken.scene.replace(cloud=cloud.replace(sh=cloud.sh + 1)), str(k))
    assert [step.text for step in Tiles.open(tiles.folder).head.steps] == ["1", "2", "3"]
    assert len([p for p in (tiles.folder / "states").iterdir()]) == 3
    undo(tiles.folder)
    assert undo(tiles.folder)[0].digest()


@pytest.mark.slow
def test_a_window_is_whole_groups_and_what_is_around_them(tiles: Tiles) -> None:
    whole = tiles.every_row()
    near = window.around(tiles, [ARMCHAIR], MEMORY)
    cloud = near.scene.cloud
    assert {0, 5, 6} <= near.whole and 13 not in near.whole
    for g in near.whole:
        assert int((cloud.group == g).sum()) == int((whole.group == g).sum())
    assert 0 < int((cloud.group == NO_GROUP).sum()) < int((whole.group == NO_GROUP).sum())
    assert (np.diff(cloud.ids.numpy()) > 0).all() and cloud.rest is not None
    with pytest.raises(UserError, match="--memory"):
        window.around(tiles, [ARMCHAIR], 1000)


@pytest.mark.slow
def test_rows_of_the_whole_scene_are_those_of_a_file_after_an_edit(tiles: Tiles) -> None:
    whole = tiles.every_row()
    taken = window.of_groups(tiles, [ARMCHAIR], MEMORY).scene.cloud
    now = edited(taken.replace(first_free=len(whole))).replace(rest=taken.rest)
    changed = torch.isin(whole.ids, taken.ids)
    expected = concat([whole[~changed], now])
    expected = expected[torch.from_numpy(np.argsort(expected.ids.numpy(), kind="stable"))]
    assert taken.rest is not None
    assert taken.rest.count(now) == len(expected)
    for step in (1, 7, 100):
        found = taken.rest.evenly(now, step)
        for name, column in expected[::step].columns():
            assert torch.equal(column, getattr(found, name)), (name, step)
    point = whole.means[0]
    found = taken.rest.evenly(now, 3, (point, 1.0))
    near = expected[::3]
    near = near[torch.linalg.vector_norm(near.means - point, dim=1) < 1.0]
    assert torch.isin(near.ids, found.ids).all() and len(found) < len(expected[::3])


@pytest.mark.slow
def test_groups_outside_of_a_window_keep_their_rows_of_the_table(tiles: Tiles) -> None:
    taken = window.of_groups(tiles, [ARMCHAIR], MEMORY)
    field = tiles.field
    assert field is not None
    shy = replace(field, groups=tuple(replace(g, label="thing") for g in field.groups))
    now = taken.scene.cloud[4:].replace(rest=taken.scene.cloud.rest)
    after = change(taken, Scene(now, tiles.frame, tiles.cameras, recount(shy, now)), "named")
    assert after.field is not None
    for was, g in zip(field.groups, after.field.groups, strict=True):
        assert g == (replace(was, label="thing", count=was.count - 4) if g.id == ARMCHAIR else was)


@pytest.mark.slow
def test_a_scene_that_is_written_from_its_tiles_is_that_of_all_of_it(tiles: Tiles, tmp_path: Path) -> None:
    taken = window.of_groups(tiles, [ARMCHAIR], MEMORY)
    after = change(taken, taken.scene.replace(cloud=edited(taken.scene.cloud)), "change")
    write_ply(after, tmp_path / "streamed.ply")
    save(load(tiles.folder).replace(language=None), tmp_path / "whole.ply")
    assert (tmp_path / "streamed.ply").read_bytes() == (tmp_path / "whole.ply").read_bytes()
    with pytest.raises(UserError, match="exists"):
        write_ply(after, tmp_path / "streamed.ply")


@pytest.mark.slow
def test_a_scene_that_is_embedded_in_its_folder_has_its_table_there(tmp_path: Path) -> None:
    named = load(saved_street(tmp_path))
    save(named.replace(language=None), tmp_path / "bare.ply")
    bare = make([tmp_path / "bare.ply"], tmp_path / "b.tiles", most=1000)
    assert bare.field is None and load(bare.folder).language is None
    after = changing.embed(bare, named, "embed")
    assert after.field is not None and named.language is not None
    assert after.field.groups == named.language.groups
    assert torch.equal(after.every_row().group, named.cloud.group)
    assert load(bare.folder).language is not None
    assert {name.split(".")[1] for name in names(after) - names(bare)} == {"group"}
    assert undo(bare.folder)[0].field is None


def test_motion_is_refused_and_a_damaged_history_stops_no_edit(tiles: Tiles) -> None:
    whole = window.everything(tiles, 1 << 40)
    track = Track.along(whole.scene.cloud.ids[:10].numpy(), [0, 1], [[0, 0, 0], [1, 0, 0]])
    with pytest.raises(UserError, match="keeps no motion"):
        change(whole, whole.scene.replace(motion=Motion((track,), stop=1.0)), "let it roll")
    once = change(whole, whole.scene.replace(cloud=edited(whole.scene.cloud)), "first")
    (tiles.folder / "states" / tiles.head.present.state.file).write_bytes(b"torn")
    again = window.everything(once, 1 << 40)
    cloud = again.scene.cloud
    change(again, again.scene.replace(cloud=cloud.replace(opacities=cloud.opacities * 0.5)), "second")
    assert len(Tiles.open(tiles.folder)) == len(cloud)


def test_an_edited_scene_is_divided_again(tiles: Tiles, tmp_path: Path) -> None:
    whole = window.everything(tiles, 1 << 40)
    changed = change(whole, whole.scene.replace(cloud=edited(whole.scene.cloud)), "first")
    made = make([tiles.folder, tiles.folder], tmp_path / "twice.tiles")
    assert len(made) == 2 * len(changed)
    ids = made.scene(made.every_row()).cloud.ids
    assert len(torch.unique(ids)) == len(made)

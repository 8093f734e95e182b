"""`scenewright tile`, and the verbs on the folder that it makes."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from scenewright.gaussians import files
from scenewright.gaussians.language.field.loading import load
from scenewright.gaussians.tiles import embedding, window


@pytest.fixture(autouse=True)
def unsynced(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "fsync", lambda handle: None)


@pytest.fixture
def folder(call: Any, room: Path, tmp_path: Path) -> Path:
    answer = call("tile", room, "-o", tmp_path / "boxes.tiles", "--json")
    assert answer.code == 0, answer.err
    assert (answer.data["gaussians"], answer.data["tiles"], answer.data["things"]) == (1173, 1, 3)
    return tmp_path / "boxes.tiles"


@pytest.mark.slow
def test_a_folder_of_tiles_is_told_selected_from_drawn_and_converted(
    call: Any, room: Path, folder: Path, tmp_path: Path
) -> None:
    told = call("info", folder, "--json").data
    assert told["format"] == "tiles" and told["gaussians"] == 1173 and len(told["language"]["things"]) == 3
    assert "3 things" in call("info", folder).out
    chosen = call("select", folder, "the green thing", "--ids", tmp_path / "ids.npy", "--json")
    assert chosen.code == 0, chosen.err
    whole = call("select", room, "the green thing", "--ids", tmp_path / "whole.npy", "--json")
    assert chosen.data["groups"] == whole.data["groups"]
    assert np.array_equal(np.load(tmp_path / "ids.npy"), np.load(tmp_path / "whole.npy"))
    drawn = call("render", folder, "-o", tmp_path / "tiled.png", "--view", "door", "--json")
    assert drawn.code == 0 and drawn.data["tiles"]["exact"] and drawn.data["tiles"]["in_view"] == 1
    assert call("render", room, "-o", tmp_path / "whole.png", "--view", "door").code == 0
    assert (tmp_path / "tiled.png").read_bytes() == (tmp_path / "whole.png").read_bytes()
    written = call("convert", folder, tmp_path / "back.ply", "--json")
    assert written.code == 0 and written.data["gaussians"] == 1173, written.err
    assert (tmp_path / "back.ply").read_bytes() == room.read_bytes()
    field = tmp_path / "back.ply.field.safetensors"  # the names go along
    assert written.data["field"] == str(field)
    back, before = load(tmp_path / "back.ply"), load(room)
    assert back.language is not None and before.language is not None
    assert back.language.groups == before.language.groups and torch.equal(back.cloud.group, before.cloud.group)
    assert call("convert", folder, tmp_path / "back.splat", "--views", "0").code == 0
    assert call("convert", room, tmp_path / "other.tiles").code == 2


@pytest.mark.slow
def test_edits_stay_in_the_folder_until_they_are_undone(call: Any, room: Path, folder: Path, tmp_path: Path) -> None:
    answer = call("edit", folder, "make the green thing blue", "--no-infill", "--json")
    assert answer.code == 0 and answer.data["gaussians"] == 1173, answer.err
    assert call("edit", room, "make the green thing blue", "-o", tmp_path / "out.ply", "--no-infill").code == 0
    assert (
        load(folder).cloud.digest()
        == files.load(tmp_path / "out.ply").cloud.replace(group=load(folder).cloud.group).digest()
    )
    assert call("info", folder, "--json").data["edits"] == ["make the green thing blue"]
    undone = call("edit", folder, "--undo", "--json")
    assert undone.code == 0 and undone.data["text"] == "make the green thing blue"
    assert load(folder).cloud.digest() == load(room).cloud.digest()
    assert call("info", folder, "--json").data["undone"] == ["make the green thing blue"]
    assert "done again" in call("edit", folder, "--redo").out
    assert call("edit", folder, "--redo").code == 2


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("edit", "FOLDER", "delete it", "-o", "x.ply"), "leave out -o"),
        (("edit", "FOLDER", "delete it", "--undo"), "stand alone"),
        (("edit", "ROOM", "--undo"), "for scenes in tiles"),
        (("edit", "FOLDER", "delete it", "--memory", "lots"), "4GB"),
        (("render", "FOLDER", "-o", "x.png", "--backend", "cuda"), "leave out --backend"),
        (("select", "FOLDER", "the green thing", "--memory", "3"), "amount of memory"),
        (("tile", "ROOM", "-o", "x.ply"), ".tiles"),
    ],
)
def test_what_does_not_fit_together_is_told(
    call: Any, room: Path, folder: Path, arguments: tuple[str, ...], said: str
) -> None:
    names = {"FOLDER": folder, "ROOM": room}
    answer = call(*(names.get(word, word) for word in arguments))
    assert answer.code == 2 and said in answer.err


@pytest.mark.slow
def test_what_needs_all_of_a_scene_that_does_not_fit_says_what_to_do(
    call: Any, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(embedding, "BYTES", 10**7)
    monkeypatch.setattr(window, "WORKING", 10**6)
    answer = call("embed", folder, "--masks", "pictures")
    assert answer.code == 2 and "when the files are embedded" in answer.err
    refused = (("less.sog",), "encoded as a whole"), (("less.ply", "--psnr", "inf"), "write it as it is"), (
        ("less.tiles", "--optimise", "1steps"), "needs the whole scene",
    )  # fmt: skip
    for (name, *more), said in refused:
        answer = call("slim", folder, "-o", tmp_path / name, *more)
        assert answer.code == 2 and said in answer.err
    answer = call("convert", folder, tmp_path / "out.lod", "--levels", "2", "--json")
    assert answer.code == 0 and [level["gaussians"] for level in answer.data["levels"]] == [1173, 293], answer.err
    assert answer.data["notes"][1] == "levels of detail hold no names"
    assert call("embed", folder, "--json").data["was_there"]


SLIM = ("--psnr", 30, "--pixels", 64, "--json")


@pytest.mark.slow
def test_tiles_are_slimmed_by_parts_to_tiles_and_to_ply(
    call: Any, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(window, "WORKING", 10**6)
    smaller, ids = tmp_path / "less.tiles", tmp_path / "ids.npy"
    answer = call("slim", folder, "-o", smaller, "--ids", ids, *SLIM)
    assert answer.code == 0, answer.err
    before, after, kept = load(folder), load(smaller), np.load(ids)
    assert answer.data["gaussians"] == len(after.cloud) == len(kept) < answer.data["gaussians_before"] == 1173
    assert answer.data["held_out"]["psnr"] >= 30 and [part["psnr"] >= 30 for part in answer.data["parts"]] == [True]
    assert answer.data["bytes"] == sum(p.stat().st_size for p in smaller.rglob("*") if p.is_file())
    assert torch.equal(after.cloud.means, before.cloud.means[kept])
    answer = call("slim", folder, "-o", tmp_path / "less.ply", *SLIM)
    assert answer.code == 0 and answer.data["gaussians"] == len(kept), answer.err
    written = load(tmp_path / "less.ply")
    assert written.cloud.digest() == after.cloud.digest()
    assert written.language is not None and after.language is not None
    assert written.language.groups == after.language.groups
    assert [p.name for p in tmp_path.iterdir() if p.name.startswith(".")] == []
    monkeypatch.undo()
    found = [call("select", scene, "the green thing", "--json").data["groups"] for scene in (folder, smaller)]
    assert found[0] == found[1]


@pytest.mark.slow
def test_tiles_that_fit_are_slimmed_as_their_file_is(call: Any, room: Path, folder: Path, tmp_path: Path) -> None:
    for scene, name in ((room, "a.ply"), (folder, "b.ply"), (folder, "c.tiles"), (room, "d.tiles")):
        assert call("slim", scene, "-o", tmp_path / name, *SLIM).code == 0
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()
    known = load(tmp_path / "a.ply")
    for name in ("c.tiles", "d.tiles"):
        found = load(tmp_path / name)
        assert found.cloud.digest() == known.cloud.digest() and found.language is not None
        assert known.language is not None and found.language.groups == known.language.groups

"""`scenewright convert`: formats, fewer Gaussians, crops, and what it says of loss and failure."""

from __future__ import annotations

import errno
import json
import os
from pathlib import Path
from typing import Any

import pytest

from scenewright.gaussians import files
from scenewright.gaussians.language.field.loading import load
from scenewright.gaussians.language.field.saving import save
from scenewright.gaussians.language.field.store import field_path
from scenewright.gaussians.reduce import MAX_PSNR
from scenewright.gaussians.scene import Scene

SUFFIXES = (".ply", ".compressed.ply", ".splat", ".sog", ".spz")
COUNT = 3 * 343 + 144  # Gaussians of the boxes


@pytest.fixture
def room(boxes: Scene, tmp_path: Path) -> Path:
    files.save(boxes.replace(language=None), tmp_path / "room.ply")
    return tmp_path / "room.ply"


@pytest.fixture
def named_room(boxes: Scene, tmp_path: Path) -> Path:
    save(boxes, tmp_path / "named.ply")
    return tmp_path / "named.ply"


def told(answer: tuple[int, str, str]) -> dict[str, Any]:
    assert answer[0] == 0, answer[2]
    found: dict[str, Any] = json.loads(answer[1])
    return found


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_every_format_and_back(call: Any, room: Path, tmp_path: Path, suffix: str) -> None:
    there = told(call("convert", room, tmp_path / f"b{suffix}", "--json"))
    assert there["gaussians"] == there["gaussians_before"] == COUNT
    assert there["bytes_before"] == room.stat().st_size and there["bytes"] == (tmp_path / f"b{suffix}").stat().st_size
    assert there["psnr"] >= there["psnr_least"] > 35 and there["views"] > 0
    assert (there["psnr"] == MAX_PSNR) == (suffix == ".ply")
    kept = suffix.endswith(".ply")  # of which both kinds have comments for frame and cameras
    assert any("cameras" in note for note in there["notes"]) != kept
    back = told(call("convert", tmp_path / f"b{suffix}", tmp_path / "c.ply", "--json"))
    assert back["gaussians"] == COUNT


def test_the_text_tells_size_loss_and_time(call: Any, room: Path, tmp_path: Path) -> None:
    code, out, err = call("convert", room, tmp_path / "b.splat")
    assert code == 0 and "bytes" in out and "dB PSNR" in out and "written" in out
    assert "harmonics" not in err  # the boxes have none above the constant one


def test_fewer_gaussians_and_harmonics(call: Any, room: Path, tmp_path: Path) -> None:
    scene = files.load(room)
    files.save(scene.replace(cloud=scene.cloud.with_degree(2)), tmp_path / "deep.ply")
    found = told(call("convert", tmp_path / "deep.ply", tmp_path / "b.ply", "--max-gaussians", 900, "--sh-degree", 1,
                      "--json"))  # fmt: skip
    cloud = files.load(tmp_path / "b.ply").cloud
    assert found["gaussians"] == len(cloud) == 900 and cloud.degree == 1 and found["gaussians_before"] == COUNT
    found = told(call("convert", tmp_path / "deep.ply", tmp_path / "b.splat", "--views", 0, "--json"))
    assert found["psnr"] is None and any("degree 2 were cut to 0" in note for note in found["notes"])


def test_crops(call: Any, room: Path, tmp_path: Path) -> None:
    found = told(call("convert", room, tmp_path / "b.ply", "--crop=-3,-1,0.05,-1,1,2", "--json"))
    assert 0 < found["gaussians"] <= 343
    found = told(call("convert", room, tmp_path / "c.ply", "--crop-sphere=2,0,0.5,0.9", "--json"))
    assert 300 < found["gaussians"] < 400


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--crop", "0,0,0,1,1"), "--crop takes 6 numbers"),
        (("--crop", "0,0,0,1,1,nan"), "--crop takes 6 numbers"),
        (("--crop-sphere", "a,b"), "--crop-sphere takes 4 numbers"),
        (("--crop", "1,1,1,0,0,0"), "lower corner first"),
        (("--crop-sphere", "50,50,50,1"), "scene spans"),
        (("--sh-degree", "4"), "--sh-degree"),
        (("--max-gaussians", "0"), "--max-gaussians"),
    ],
)
def test_what_cannot_be_meant_is_refused(
    call: Any, room: Path, tmp_path: Path, arguments: tuple[str, str], message: str
) -> None:
    code, out, err = call("convert", room, tmp_path / "b.ply", *arguments)
    assert code == 2 and message in err and not out and not (tmp_path / "b.ply").exists()


def test_a_format_that_is_not_written_is_refused_before_the_work(call: Any, tmp_path: Path) -> None:
    code, _, err = call("convert", tmp_path / "gone.ply", tmp_path / "b.glb")
    assert code == 2 and "written as" in err


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_full_disk_leaves_the_old_file(
    call: Any, room: Path, tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    target = tmp_path / f"b{suffix}"
    target.write_text("precious")
    monkeypatch.setattr(os, "fsync", full)
    code, _, err = call("convert", room, target, "--force", "--views", 0)
    assert code == 4 and "No space left" in err and target.read_text() == "precious"
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted([room.name, target.name])


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_cut_file_is_said_to_be_cut(call: Any, room: Path, tmp_path: Path, suffix: str) -> None:
    told(call("convert", room, tmp_path / f"b{suffix}", "--views", 0, "--json"))
    content = (tmp_path / f"b{suffix}").read_bytes()
    (tmp_path / f"b{suffix}").write_bytes(content[: len(content) * 2 // 3 + 1])
    code, _, err = call("convert", tmp_path / f"b{suffix}", tmp_path / "c.ply")
    assert code == 4 and "cut off" in err and not (tmp_path / "c.ply").exists()


@pytest.mark.parametrize("version", [2, 3])
def test_older_spz(call: Any, room: Path, tmp_path: Path, version: int) -> None:
    found = told(call("convert", room, tmp_path / "b.spz", "--spz-version", version, "--json"))
    assert found["psnr"] > 35
    assert files.load_with_report(tmp_path / "b.spz")[1].format == f"Niantic SPZ {version}"


def labels_of(scene: Scene) -> list[str]:
    """The label of each row's group."""
    assert scene.language is not None
    return [scene.language.groups[i].label for i in scene.cloud.group.tolist()]


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_names_go_along_row_for_row(call: Any, named_room: Path, tmp_path: Path, suffix: str) -> None:
    out = tmp_path / f"b{suffix}"
    found = told(call("convert", named_room, out, "--views", 0, "--json"))
    assert found["field"] == str(field_path(out))
    scene, before = load(out), load(named_room)
    assert scene.language is not None and before.language is not None
    assert scene.language.groups == before.language.groups and scene.frame == before.frame
    for group in before.language.groups:  # rows may be in another order, and positions rounded
        own, was = (s.cloud.means[s.cloud.group == group.id].mean(dim=0) for s in (scene, before))
        assert (own - was).abs().max() < 0.02
    assert len(files.load(out).cloud) == COUNT


def test_an_older_spz_keeps_the_names(call: Any, named_room: Path, tmp_path: Path) -> None:
    out = tmp_path / "b.spz"
    told(call("convert", named_room, out, "--spz-version", 2, "--views", 0, "--json"))
    assert sorted(labels_of(load(out))) == sorted(labels_of(load(named_room)))


def test_a_part_of_a_scene_has_its_things_measured_again(call: Any, named_room: Path, tmp_path: Path) -> None:
    told(call("convert", named_room, tmp_path / "b.ply", "--crop=-3,-1,0.05,-1,1,2", "--views", 0, "--json"))
    part = load(tmp_path / "b.ply")
    assert part.language is not None and set(labels_of(part)) == {"box"}
    assert [g.count for g in part.language.groups] == [len(part.cloud), 0, 0, 0]


def test_names_that_cannot_go_along_are_told(call: Any, named_room: Path, tmp_path: Path) -> None:
    answer = call("convert", named_room, tmp_path / "b.lod", "--levels", 1, "--views", 0)
    assert answer.code == 0 and "levels of detail hold no names" in answer.err
    scene = files.load(named_room)
    files.save(scene.replace(cloud=scene.cloud[10:]), named_room, force=True)
    answer = call("convert", named_room, tmp_path / "c.ply", "--views", 0)
    assert "was made for another version of this file: it is left out" in answer.err
    assert not field_path(tmp_path / "c.ply").exists()

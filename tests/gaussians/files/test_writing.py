"""Saving is atomic and overwrites existing files only on request."""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path
from typing import Any

import pytest
import torch

from scenewright.gaussians import files
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import FileError, UserError
from scenewright.gaussians.files.formats import inria_ply
from scenewright.gaussians.scene import Scene


def make_scene(n: int = 3) -> Scene:
    quats = torch.tensor([[1.0, 0, 0, 0]]).repeat(n, 1)
    ones = torch.ones(n, 3)
    return Scene(GaussianCloud.create(ones, quats, ones, torch.full((n,), 0.5), torch.zeros(n, 1, 3)))


def only(folder: Path, *names: str) -> bool:
    """Whether the folder holds nothing else, hidden files included."""
    return sorted(p.name for p in folder.iterdir()) == sorted(names)


def test_overwriting_needs_to_be_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "a.ply"
    path.write_text("precious")
    with pytest.raises(UserError, match="--force"):
        files.save(make_scene(), path)
    assert path.read_text() == "precious" and only(tmp_path, "a.ply")
    files.save(make_scene(), path, force=True)
    assert len(files.load(path).cloud) == 3 and only(tmp_path, "a.ply")


@pytest.mark.parametrize("stage", ["write", "fsync", "replace"])
def test_a_full_disk_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, stage: str) -> None:
    path = tmp_path / "a.ply"
    path.write_text("precious")

    def full(*_: Any) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    if stage == "write":
        monkeypatch.setattr(inria_ply.values, "logits_from_opacities", full)  # after the header went out
    else:
        monkeypatch.setattr(os, stage, full)
    with pytest.raises(FileError, match=r"No space left.*not changed"):
        files.save(make_scene(), path, force=True)
    monkeypatch.undo()
    assert path.read_text() == "precious" and only(tmp_path, "a.ply")


def test_an_interruption_leaves_nothing_behind(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt), files.writing(tmp_path / "a.bin") as file:
        file.write(b"half")
        raise KeyboardInterrupt
    assert only(tmp_path)


def test_a_file_that_appears_meanwhile_is_not_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "a.bin"
    with pytest.raises(UserError, match="--force"), files.writing(path) as file:
        file.write(b"ours")
        path.write_text("theirs")
    assert path.read_text() == "theirs" and only(tmp_path, "a.bin")


def test_a_link_is_followed_and_permissions_stay(tmp_path: Path) -> None:
    real, link = tmp_path / "real.ply", tmp_path / "link.ply"
    real.write_text("old")
    real.chmod(0o640)
    link.symlink_to(real)
    files.save(make_scene(), link, force=True)
    assert link.is_symlink() and len(files.load(real).cloud) == 3
    assert stat.S_IMODE(real.stat().st_mode) == 0o640


def test_new_files_follow_the_umask(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        files.save(make_scene(), tmp_path / "a.ply")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "a.ply").stat().st_mode) == 0o640


def test_places_that_cannot_be_written(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="does not exist"):
        files.save(make_scene(), tmp_path / "no" / "a.ply")
    (tmp_path / "folder.ply").mkdir()
    with pytest.raises(UserError, match="folder"):
        files.save(make_scene(), tmp_path / "folder.ply", force=True)


@pytest.mark.parametrize("name", ["a.glb", "a.ksplat", "a"])
def test_formats_that_are_not_written(tmp_path: Path, name: str) -> None:
    with pytest.raises(UserError, match=r"written as .*\.ply.*\.spz"):
        files.save(make_scene(), tmp_path / name)
    assert only(tmp_path)


def test_an_empty_scene_is_not_saved(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="zero Gaussians"):
        files.save(Scene(GaussianCloud.empty()), tmp_path / "a.ply")
    assert only(tmp_path)


def test_two_writers_of_one_file_do_not_disturb_each_other(tmp_path: Path) -> None:
    path = tmp_path / "a.bin"
    with files.writing(path, force=True) as first, files.writing(path, force=True) as second:
        first.write(b"first")
        second.write(b"second")
    assert path.read_bytes() == b"first" and only(tmp_path, "a.bin")  # the outer one ends last


def test_tensors_that_are_being_fitted_can_be_saved(tmp_path: Path) -> None:
    cloud = make_scene().cloud
    fitted = cloud.replace(
        means=cloud.means.requires_grad_(True), sh=cloud.sh.transpose(0, 2).contiguous().transpose(0, 2)
    )
    files.save(Scene(fitted), tmp_path / "a.ply")
    assert torch.equal(files.load(tmp_path / "a.ply").cloud.means, cloud.means)


def test_saving_does_not_touch_the_scene(tmp_path: Path) -> None:
    scene = make_scene()
    before = scene.cloud.digest()
    files.save(scene, tmp_path / "A.PLY")
    assert scene.cloud.digest() == before

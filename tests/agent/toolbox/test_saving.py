"""Files are written to the folder of the scene and nowhere else."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

import pytest

from scenewright.agent.session.session import Session
from scenewright.agent.toolbox.folder import Folder
from scenewright.agent.toolbox.limits import ArgumentError
from scenewright.agent.toolbox.toolbox import Toolbox
from scenewright.gaussians.files import load
from scenewright.gaussians.language.field.store import load_field

ESCAPES = [
    "/etc/passwd.ply", "../out.ply", "a/../../out.ply", "..", ".", "", "~/out.ply", "~root/out.ply", "C:\\out.ply",
    "..\\out.ply", "\\\\server\\share.ply", "C:out.ply", "out.ply\x00.png", "out\n.ply", "link/out.ply", "file.ply",
    "to_parent.ply", "x" * 300 + ".ply", "//host/out.ply", "\u202eylp.ply", "folder/../..", "file:///tmp/out.ply",
]  # fmt: skip


def _snapshot(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


@pytest.fixture
def outside(tmp_path: Path) -> Path:
    """A folder beside the one of the scenes, to which links in that one lead."""
    other = tmp_path / "outside"
    other.mkdir()
    (other / "kept.ply").write_bytes(b"kept")
    scenes = tmp_path / "scenes"
    scenes.mkdir(exist_ok=True)
    os.symlink(other, scenes / "link")
    os.symlink(other / "kept.ply", scenes / "file.ply")
    os.symlink("../kept.ply", scenes / "to_parent.ply")
    return other


@pytest.mark.parametrize("name", ESCAPES)
def test_a_name_that_leads_out_of_the_folder_is_refused(
    name: str, toolbox: Toolbox, outside: Path, tmp_path: Path
) -> None:
    with pytest.raises(ArgumentError):
        Folder(tmp_path / "scenes").file(name)
    before = _snapshot(tmp_path)
    for force in (False, True):
        reply = toolbox.call("save", {"file": name, "force": force})
        assert reply.failed and reply.data["verdict"] == "invalid", reply.text
    assert _snapshot(tmp_path) == before


def test_a_saved_scene_is_what_it_was_and_is_not_overwritten_unasked(toolbox: Toolbox, tmp_path: Path) -> None:
    reply = toolbox.call("save", {"file": "out.ply"})
    path = tmp_path / "scenes" / "out.ply"
    assert reply.data["sha256"] == hashlib.sha256(path.read_bytes()).hexdigest()
    assert len(load(path).cloud) == reply.data["scene"]["gaussians"]
    toolbox.call("do", {"instruction": "delete the green thing"})
    assert "force" in toolbox.call("save", {"file": "out.ply"}).text
    assert hashlib.sha256(path.read_bytes()).hexdigest() == reply.data["sha256"]
    assert toolbox.call("save", {"file": "out.ply", "force": True}).data["sha256"] != reply.data["sha256"]
    toolbox.call("undo")
    assert toolbox.call("save", {"file": "again.ply"}).data["sha256"] == reply.data["sha256"]


def test_only_formats_of_scenes_are_written(toolbox: Toolbox, tmp_path: Path) -> None:
    for name in ("out.sh", "out", ".bashrc", "out.py", "out.png"):
        assert toolbox.call("save", {"file": name, "force": True}).failed
    assert not _snapshot(tmp_path)


def test_the_language_field_is_kept_beside_the_scene_and_never_through_a_link(
    toolbox: Toolbox, outside: Path, tmp_path: Path
) -> None:
    keeping = Toolbox(toolbox.session, tmp_path / "scenes", keep_field=True)
    reply = keeping.call("save", {"file": "out.ply"})
    path = tmp_path / "scenes" / "out.ply"
    found = load_field(load(path), path)
    assert found is not None and found.language is not None and (path.parent / reply.data["field"]).is_file()
    os.symlink(outside / "field", tmp_path / "scenes" / "evil.ply.field.safetensors")
    assert keeping.call("save", {"file": "evil.ply"}).failed
    assert sorted(p.name for p in outside.iterdir()) == ["kept.ply"]
    assert not (tmp_path / "scenes" / "evil.ply").exists()


def test_without_a_folder_there_is_no_tool_that_writes(session_of_toolbox: Session) -> None:
    toolbox = Toolbox(session_of_toolbox)
    assert "save" not in toolbox.tools
    assert "there is no tool" in toolbox.call("save", {"file": "out.ply"}).text


@pytest.fixture
def session_of_toolbox(toolbox: Toolbox) -> Session:
    return toolbox.session

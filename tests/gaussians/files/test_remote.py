"""Files by URL: copies follow the content, hold what is beside a scene, and tell no secrets."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import scenewright as sw
from scenewright.gaussians.assets import make
from scenewright.gaussians.errors import BackendError, FileError, UserError
from scenewright.gaussians.files import remote, save
from scenewright.gaussians.files.remote import cleaned, copied, fetched, is_url, local, sent, version
from scenewright.gaussians.scene import Scene

fsspec = pytest.importorskip("fsspec")


@pytest.fixture
def memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """An empty store in memory, and a cache of its own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    fs = fsspec.filesystem("memory")
    fs.store.clear()
    yield fs
    fs.store.clear()


def test_urls_are_told_from_paths_and_sentences() -> None:
    assert all(map(is_url, ("s3://b/room.ply", "file:///a", "zip://a.ply::s3://b/c.zip", "gs://b")))
    assert not any(map(is_url, ("room.ply", "/a/b", "make it like s3://b", "c:/room.ply", "a: //b", "://b")))
    assert local("a/b.ply") == Path("a/b.ply")


@pytest.mark.parametrize(
    ("url", "said"),
    [
        ("sftp://me:pass@host/a.ply", "sftp://host/a.ply"),
        ("https://h/a.ply?X-Amz-Signature=abc", "https://h/a.ply?..."),
        ("cannot read s3://key:secret@b/c, sorry", "cannot read s3://b/c, sorry"),
        ("s3://b/c d@e", "s3://b/c d@e"),
    ],
)
def test_texts_lose_the_secrets_of_urls(url: str, said: str) -> None:
    assert cleaned(url) == said


def test_a_copy_is_made_once_and_again_when_the_content_changes(memory: Any) -> None:
    memory.pipe_file("/b/room.ply", b"one")
    memory.pipe_file("/b/room.ply.field.safetensors", b"field")
    first, mark, plain = fetched("memory://b/room.ply"), version("memory://b/room.ply"), _plain("memory://b/room.ply")
    assert first.name == "room.ply" and first.read_bytes() == b"one"
    assert first.with_name("room.ply.field.safetensors").read_bytes() == b"field"
    assert fetched("memory://b/room.ply") == first
    memory.pipe_file("/b/room.ply.field.safetensors", b"other")
    assert version("memory://b/room.ply") != mark and _plain("memory://b/room.ply") == plain
    memory.pipe_file("/b/room.ply", b"two")
    assert fetched("memory://b/room.ply").read_bytes() == b"two" and first.read_bytes() == b"one"
    assert _plain("memory://b/room.ply") != plain
    assert version("memory://b/nothing.ply") is None
    with pytest.raises(FileError, match="no such file"):
        fetched("memory://b/nothing.ply")


def _plain(url: str) -> str | None:
    return version(url, field=False)


def test_folders_come_whole_and_copies_may_be_written_to(memory: Any, tmp_path: Path) -> None:
    memory.pipe_file("/b/street.tiles/HEAD.json", b"{}")
    memory.pipe_file("/b/street.tiles/tiles/0.means.0", b"rows")
    got = copied("memory://b/street.tiles", tmp_path / "own")
    assert (got / "tiles" / "0.means.0").read_bytes() == b"rows"
    (got / "HEAD.json").write_text("changed")
    assert (fetched("memory://b/street.tiles") / "HEAD.json").read_bytes() == b"{}"
    assert sent(got, "memory://c/out") == {"HEAD.json": 7, "tiles/0.means.0": 4}
    assert memory.cat_file("/c/out/tiles/0.means.0") == b"rows"
    with pytest.raises(UserError, match="whole store"):
        fetched("memory://")


def test_a_store_that_tells_no_version_is_read(memory: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(remote, "_VERSIONS", ())
    memory.pipe_file("/b/a.ply", b"one")
    mark = version("memory://b/a.ply")
    memory.pipe_file("/b/a.ply", b"two")
    assert version("memory://b/a.ply") != mark


def test_what_changes_all_the_time_is_refused(memory: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    memory.pipe_file("/b/a.ply", b"0")
    real, count = type(memory).get_file, [0]

    def changing(fs: Any, source: str, target: str) -> None:
        real(fs, source, target)
        count[0] += 1
        fs.pipe_file(source, str(count[0]).encode())

    monkeypatch.setattr(type(memory), "get_file", changing)
    with pytest.raises(FileError, match="changes while it is read"):
        fetched("memory://b/a.ply")
    assert not [p for p in remote.user_cache("fetched").iterdir() if p.suffix == ".part"]


def test_errors_say_what_to_do_and_no_passwords(monkeypatch: pytest.MonkeyPatch, memory: Any) -> None:
    with pytest.raises(UserError, match="no URL of a file"):
        fetched("nonsense://b/a.ply")

    def refused(fs: Any, path: str, **_: Any) -> None:
        raise PermissionError(f"denied for me with pass-word at {path}")

    memory.pipe_file("/b/a.ply", b"0")
    monkeypatch.setattr(type(memory), "info", refused)
    with pytest.raises(FileError, match=r"cannot read memory://b/a\.ply") as caught:
        fetched("memory://me:pass-word@b/a.ply")
    assert "pass-word" not in str(caught.value)
    monkeypatch.setitem(sys.modules, "fsspec.core", None)
    with pytest.raises(BackendError, match=r"scenewright\[remote\]"):
        fetched("s3://b/a.ply")


def test_copies_that_were_used_longest_ago_make_room(memory: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(remote.VARIABLE, "100MB")
    for name in "abc":
        memory.pipe_file(f"/b/{name}.ply", bytes(60 * 10**6))
    old, new = (fetched(f"memory://b/{name}.ply") for name in "ab")
    assert old.exists()  # it was used a moment ago
    os.utime(old.parent, (0, 0))
    last = fetched("memory://b/c.ply")
    assert (old.exists(), new.exists(), last.exists()) == (False, True, True)


def test_scenes_load_by_url(memory: Any, tmp_path: Path) -> None:
    scene = Scene(make("stool", 0, detail=0.1).cloud)
    save(scene, tmp_path / "a.ply")
    memory.put_file(str(tmp_path / "a.ply"), "/b/a.ply")
    assert len(sw.load("memory://b/a.ply").cloud) == len(scene.cloud)
    assert len(sw.load(f"file://{tmp_path}/a.ply").cloud) == len(scene.cloud)

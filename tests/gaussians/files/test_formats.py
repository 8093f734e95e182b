"""Which format a file has: content first, name second; and formats are found by scanning."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from scenewright.gaussians import files
from scenewright.gaussians.errors import FileError


def test_formats_have_distinct_names_and_suffixes() -> None:
    found = files.known_formats()
    assert {f.name for f in found} == {
        "INRIA .ply",
        "PlayCanvas compressed .ply",
        "SOG version 2",
        "Niantic SPZ",
        "antimatter15 .splat",
        "Streamed SOG",
        "tiles",
    }
    suffixes = [s for f in found for s in f.suffixes]
    assert len(set(suffixes)) == len(suffixes) and all(s == s.lower() and s.startswith(".") for s in suffixes)


def test_a_format_is_one_new_module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "toy.py").write_text(
        "from scenewright.gaussians.files.format import Format\n"
        "def read(path): raise NotImplementedError\n"
        "FORMAT = Format('toy', ('.toy',), lambda path, head: head[:3] == b'toy', read)\n"
    )
    monkeypatch.setattr(files.formats, "__path__", [*files.formats.__path__, str(tmp_path)])
    files.known_formats.cache_clear()
    try:
        assert "toy" in [f.name for f in files.known_formats()]
    finally:
        files.known_formats.cache_clear()
        sys.modules.pop("scenewright.gaussians.files.formats.toy", None)


def test_content_decides_before_the_name(data_dir: Path, tmp_path: Path) -> None:
    misnamed = tmp_path / "guitar.sog"
    misnamed.symlink_to(data_dir / "scenes" / "guitar.compressed.ply")
    assert files.load_with_report(misnamed)[1].format == "PlayCanvas compressed .ply"


def test_the_name_decides_where_the_content_does_not_say(tmp_path: Path) -> None:
    (tmp_path / "a.ply").write_bytes(b"junk")
    with pytest.raises(FileError, match="not a PLY"):
        files.load(tmp_path / "a.ply")
    (tmp_path / "a.sog").write_bytes(b"junk")
    with pytest.raises(FileError, match="zip"):
        files.load(tmp_path / "a.sog")


def test_unknown_formats_list_the_known_ones(tmp_path: Path) -> None:
    (tmp_path / "a.xyz").write_bytes(b"junk")
    with pytest.raises(FileError, match=r"unknown format.*INRIA.*\.compressed\.ply.*\.sog"):
        files.load(tmp_path / "a.xyz")


def test_missing_files_and_plain_folders(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="no such file"):
        files.load(tmp_path / "gone.ply")
    with pytest.raises(FileError, match="unknown format"):
        files.load(tmp_path)
    os.mkfifo(tmp_path / "pipe.ply")
    with pytest.raises(FileError, match="neither"):
        files.load(tmp_path / "pipe.ply")
    (tmp_path / "pipe.ply").unlink()
    (tmp_path / "point_cloud.ply").write_bytes(b"")
    (tmp_path / "level_0").mkdir()
    (tmp_path / "level_0" / "meta.json").write_text("{}")
    with pytest.raises(FileError, match=r"name one of them: level_0, point_cloud\.ply"):
        files.load(tmp_path)

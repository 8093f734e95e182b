"""Levels of detail of a scene in tiles, written part by part: a folder as any, with every row in it once."""

from __future__ import annotations

from pathlib import Path

import pytest
from scipy.spatial import cKDTree
from street import saved_street

from scenewright.gaussians.files.formats import streamed_sog_writing
from scenewright.gaussians.files.formats.streamed_sog import Streamed
from scenewright.gaussians.levels.making import make as levels_of
from scenewright.gaussians.tiles import leveling
from scenewright.gaussians.tiles.making import make


@pytest.mark.slow
def test_parts_become_one_folder_of_levels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tiles = make([saved_street(tmp_path)], tmp_path / "a.tiles", most=1000)
    monkeypatch.setattr(leveling, "_MOST", 1500)
    monkeypatch.setattr(leveling, "_LEAST", 100)
    with streamed_sog_writing.replacing(tmp_path / "a.lod") as folder:
        leaves = leveling.write_levels(tiles, folder, 3, 1 << 30, 1024)
    found, whole = Streamed.open(tmp_path / "a.lod"), tiles.every_row()
    assert leaves > 5 and found.levels == 3 and found.frame == tiles.frame and len(found.cameras) == 1
    assert found.counts[0] == len(whole) and found.counts[1] == pytest.approx(len(whole) / 4, rel=0.02)
    finest, _ = found.level(0)
    assert cKDTree(finest.means).query(whole.means)[0].max() < 1e-3  # positions are rounded to 16 bits of a chunk
    assert max(run.count for leaf in found.leaves for run in leaf.runs.values()) <= 1024
    one = tmp_path / "one.lod"
    with streamed_sog_writing.replacing(one) as folder:
        monkeypatch.setattr(leveling, "_MOST", 10**6)
        leveling.write_levels(tiles, folder, 3, 1 << 30, 1024)
    with streamed_sog_writing.replacing(tmp_path / "memory.lod") as folder:
        scene = tiles.scene(whole)
        streamed_sog_writing.write(levels_of(scene, 3, (), 1024), folder, 1024)
        streamed_sog_writing.annotate(folder, scene, ())
    assert _bytes(one) == _bytes(tmp_path / "memory.lod")  # one part is the scene in memory


def _bytes(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}

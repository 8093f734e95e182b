"""A process that is killed while it tiles, edits or undoes leaves a scene as it was before or after, never another."""

from __future__ import annotations

import random
import subprocess
import sys
import time
from pathlib import Path

import pytest
from street import saved_street

from scenewright.gaussians.tiles import window
from scenewright.gaussians.tiles.changing import change, undo
from scenewright.gaussians.tiles.making import make
from scenewright.gaussians.tiles.store import Tiles, is_tiles

KILLS = 8
CHANGES = """
import sys
from pathlib import Path
from scenewright.gaussians.tiles import window
from scenewright.gaussians.tiles.changing import change, undo
from scenewright.gaussians.tiles.store import Tiles
folder = Path(sys.argv[1])
print("ready", flush=True)
while True:
    if Tiles.open(folder).head.past:
        undo(folder)
    taken = window.of_groups(Tiles.open(folder), [5, 12], 1 << 30)
    change(taken, taken.scene.replace(cloud=taken.scene.cloud[7:]), "fewer")
    undo(folder)
"""
TILES = """
import sys
from pathlib import Path
from scenewright.gaussians.tiles.making import make
print("ready", flush=True)
for k in range(1000):
    make([Path(sys.argv[1])], Path(sys.argv[2]) / f"{k}.tiles", most=1000)
"""


SLIMS = """
import sys
from pathlib import Path
from scenewright.gaussians.slim import Settings
from scenewright.gaussians.tiles.slimming import slim_tiles, slimming
from scenewright.gaussians.tiles.store import Tiles
slimming.ROWS = 6000
tiles, out = Tiles.open(Path(sys.argv[1])), Path(sys.argv[2])
print("ready", flush=True)
slim_tiles(tiles, out, Settings(60.0, 256), 1 << 30)
"""


def killed_after(script: str, seconds: float, *arguments: Path) -> None:
    """Run a script and kill it so many seconds after it began its work."""
    process = subprocess.Popen([sys.executable, "-c", script, *map(str, arguments)], stdout=subprocess.PIPE)
    assert process.stdout is not None and process.stdout.readline() == b"ready\n"
    time.sleep(seconds)
    assert process.poll() is None, "it ended by itself"
    process.kill()
    process.wait()
    process.stdout.close()


@pytest.mark.slow
def test_a_kill_at_any_moment_of_edits_and_undo_leaves_one_of_the_two_scenes(tmp_path: Path) -> None:
    tiles = make([saved_street(tmp_path)], tmp_path / "a.tiles", most=1000)
    taken = window.of_groups(tiles, [5, 12], 1 << 30)
    known = {tiles.digest(), change(taken, taken.scene.replace(cloud=taken.scene.cloud[7:]), "fewer").digest()}
    undo(tiles.folder)
    moments = random.Random(1)
    seen = set()
    for _ in range(KILLS):
        killed_after(CHANGES, moments.uniform(0.0, 0.4), tiles.folder)
        now = Tiles.open(tiles.folder)
        seen.add(now.digest())
        assert seen <= known
        assert len(now.every_row()) == len(now)
    while Tiles.open(tiles.folder).head.past:
        undo(tiles.folder)
    taken = window.of_groups(Tiles.open(tiles.folder), [5, 12], 1 << 30)
    assert change(taken, taken.scene.replace(cloud=taken.scene.cloud[7:]), "fewer").digest() in known


@pytest.mark.slow
def test_a_kill_while_tiling_leaves_whole_folders_or_none(tmp_path: Path) -> None:
    source = saved_street(tmp_path)
    good = make([source], tmp_path / "good.tiles", most=1000).digest()
    moments = random.Random(2)
    for k in range(KILLS // 2):
        out = tmp_path / str(k)
        out.mkdir()
        killed_after(TILES, moments.uniform(0.1, 0.8), source, out)
        for folder in out.glob("[0-9]*.tiles"):
            assert is_tiles(folder) and Tiles.open(folder).digest() == good


@pytest.mark.slow
def test_a_kill_while_a_scene_is_made_smaller_leaves_it_and_no_other(tmp_path: Path) -> None:
    tiles = make([saved_street(tmp_path)], tmp_path / "a.tiles", most=1000)
    known = tiles.digest()
    for seconds in (0.5, 4.0):
        killed_after(SLIMS, seconds, tiles.folder, tmp_path / "b.tiles")
        assert Tiles.open(tiles.folder).digest() == known and not (tmp_path / "b.tiles").exists()

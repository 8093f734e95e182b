"""Writes that the system refuses at any size, and two programs that change one folder at the same time."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from street import saved_street

from scenewright.gaussians.tiles import window
from scenewright.gaussians.tiles.changing import change
from scenewright.gaussians.tiles.making import make
from scenewright.gaussians.tiles.store import Tiles, is_tiles

# Files may not grow beyond some bytes: as on a full disk, a write that begins well ends in an error of the system.
LIMITED = """
import json, resource, sys
from pathlib import Path
from scenewright.gaussians.errors import FileError
from scenewright.gaussians.tiles import window
from scenewright.gaussians.tiles.changing import change
from scenewright.gaussians.tiles.making import make
from scenewright.gaussians.tiles.store import Tiles
source, folder, out = map(Path, sys.argv[1:4])
said = []
for most in map(int, sys.argv[4:]):
    tiles = Tiles.open(folder)
    taken = window.of_groups(tiles, [5, 12], 1 << 30)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, resource.RLIM_INFINITY))
    for work in (lambda: make([source], out, most=1000),
                 lambda: change(taken, taken.scene.replace(cloud=taken.scene.cloud[7:]), "fewer")):
        try:
            work()
            said.append("done")
        except FileError as error:
            said.append(str(error))
    resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
print(json.dumps(said))
"""
WRITES = """
import sys
from pathlib import Path
from scenewright.gaussians.errors import FileError
from scenewright.gaussians.tiles import window
from scenewright.gaussians.tiles.changing import change
from scenewright.gaussians.tiles.store import Tiles
folder, group, name = Path(sys.argv[1]), int(sys.argv[2]), sys.argv[3]
sys.stdin.readline()
done = 0
while done < 6:
    try:
        taken = window.of_groups(Tiles.open(folder), [group], 1 << 30)
        change(taken, taken.scene.replace(cloud=taken.scene.cloud[1:]), name)
        done += 1
    except FileError as error:
        assert "another program" in str(error) or "meanwhile" in str(error), error
"""


@pytest.mark.slow
def test_a_write_that_is_refused_at_any_size_leaves_the_scene_and_no_other(tmp_path: Path) -> None:
    source = saved_street(tmp_path)
    tiles = make([source], tmp_path / "a.tiles", most=1000)
    known, before = tiles.digest(), sorted(tmp_path.iterdir())
    sizes = [1, 100, 3000, 11000]
    command = [sys.executable, "-c", LIMITED, str(source), str(tiles.folder), str(tmp_path / "b.tiles")]
    done = subprocess.run([*command, *map(str, sizes)], capture_output=True, text=True, check=True)
    said = json.loads(done.stdout)
    assert len(said) == 2 * len(sizes) and all("File too large" in text for text in said), said
    assert sorted(tmp_path.iterdir()) == before and not (tmp_path / "b.tiles").exists()
    again = Tiles.open(tiles.folder)
    assert again.digest() == known and len(again.every_row()) == len(again)
    taken = window.of_groups(again, [5, 12], 1 << 30)
    change(taken, taken.scene.replace(cloud=taken.scene.cloud[7:]), "fewer")
    assert is_tiles(make([source], tmp_path / "b.tiles", most=1000).folder)


@pytest.mark.slow
def test_two_programs_that_write_at_once_each_have_all_of_their_changes(tmp_path: Path) -> None:
    tiles = make([saved_street(tmp_path)], tmp_path / "a.tiles", most=1000)
    rows = len(tiles)
    writers = [
        subprocess.Popen(
            [sys.executable, "-c", WRITES, str(tiles.folder), str(group), name], stdin=subprocess.PIPE, text=True
        )
        for group, name in ((5, "one"), (12, "two"))
    ]
    for writer in writers:
        assert writer.stdin is not None
        writer.stdin.write("go\n")
        writer.stdin.flush()
    assert [writer.wait() for writer in writers] == [0, 0]
    now = Tiles.open(tiles.folder)
    words = [step.text for step in now.head.steps if step.text]
    assert (words.count("one"), words.count("two")) == (6, 6)
    assert len(now.every_row()) == len(now) == rows - 12

"""`bench scale`: the streamed grid is a scene with its field, and commands are measured as processes of their own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scenewright.benchmarks._scale import grid as grids
from scenewright.benchmarks._scale.measured import command
from scenewright.gaussians.errors import BackendError
from scenewright.gaussians.language.field.loading import load


@pytest.mark.slow
def test_a_grid_is_written_as_a_scene_in_which_one_room_is_different(tmp_path: Path) -> None:
    grid = grids.made(3 * 10**5)
    grids.write(grid, tmp_path / "grid.ply")
    scene = load(tmp_path / "grid.ply")
    assert scene.language is not None and len(scene.cloud) == grid.rows
    labels = [g.label for g in scene.language.groups]
    assert labels.count(grids.RECOLORED) == labels.count(grids.DELETED) == 1
    assert labels.count("sofa") == grid.count
    piano = scene.language.groups[labels.index(grids.RECOLORED)]
    rows = scene.cloud.group.numpy() == piano.id
    assert rows.sum() == piano.count
    middle = scene.cloud.means.numpy()[rows].mean(axis=0)
    assert np.linalg.norm(middle - piano.box.center) < 1.0
    assert np.linalg.norm(grid.inside(64, 48).position - grid.place(grid.special)) < grids.APART
    told = command("info", tmp_path / "grid.ply")
    assert told.data["gaussians"] == grid.rows and told.seconds >= told.processor / 4 > 0
    with pytest.raises(BackendError, match="no such file"):
        command("info", tmp_path / "none.ply")

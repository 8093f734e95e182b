"""`scenewright mesh`: a file of a named thing, and what it says where nothing is written."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import trimesh

from scenewright.gaussians.meshing import texturing


@pytest.mark.slow
def test_a_named_thing_becomes_a_file(call: Any, room: Path, tmp_path: Path) -> None:
    target = tmp_path / "thing.glb"
    code, out, err = call(
        "mesh",
        room,
        "--select",
        "the green thing",
        "-o",
        target,
        "--texture",
        0,
        "--cells",
        12,
        "--watertight",
        "--json",
    )
    assert code == 0, err
    told = json.loads(out)
    loaded: Any = trimesh.load(target, force="mesh", process=False)
    assert loaded.is_watertight and told["watertight"]
    assert len(loaded.faces) == told["faces"] and target.stat().st_size == told["bytes"]
    assert told["size"] == pytest.approx((loaded.bounds[1] - loaded.bounds[0]).tolist(), abs=1e-4)


def test_what_is_not_there_is_told_and_nothing_is_written(call: Any, room: Path, tmp_path: Path) -> None:
    code, out, _ = call("mesh", room, "--select", "the purple thing", "-o", tmp_path / "none.glb", "--texture", 0)
    assert code == 3 and "purple" in out
    assert not (tmp_path / "none.glb").exists()


def test_what_can_be_refused_is_refused_before_the_scene_is_read(
    call: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    missing = tmp_path / "missing.ply"
    code, _, err = call("mesh", missing, "-o", tmp_path / "a.obj")
    assert code == 2 and "name it a.glb" in err
    monkeypatch.setattr(texturing, "installed", lambda: False)
    code, _, err = call("mesh", missing, "-o", tmp_path / "a.glb")
    assert code == 4 and 'pip install "scenewright[mesh]"' in err

"""`scenewright mesh`: a file of a named thing, and what it says where nothing is written."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import trimesh
from torch import isin, zeros

from scenewright.gaussians import meshing
from scenewright.gaussians.language.field import embed as embedding
from scenewright.gaussians.language.field.saving import save
from scenewright.gaussians.meshing import texturing
from scenewright.gaussians.motion.motion import Look, Motion, Track
from scenewright.gaussians.scene import Scene


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


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Scene, Any]]:
    """The scenes of which a mesh is wanted, with the ids; none is made. Embedding fails."""
    found: list[tuple[Scene, Any]] = []

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("the scene was embedded again")

    def note(scene: Scene, ids: Any, **_: object) -> None:
        found.append((scene, ids))
        raise KeyboardInterrupt

    monkeypatch.setattr(embedding, "embed", refuse)
    monkeypatch.setattr(meshing, "mesh", note)
    return found


def test_a_given_frame_keeps_the_saved_names(call: Any, room: Path, tmp_path: Path, asked: list[Any]) -> None:
    for frame in ((), ("--metres-per-unit", 2), ("--up", "0,1,0")):
        answer = call("mesh", room, "--select", "the green thing", "--texture", 0, "-o", tmp_path / "a.glb", *frame)
        assert answer.code == 130, answer.err
    assert [len(ids) for _, ids in asked] == [343, 343, 343]
    frames = [scene.frame for scene, _ in asked]
    assert [frame.metres_per_unit for frame in frames] == [1, 2, 1]
    assert [frame.up for frame in frames] == [(0, 0, 1), (0, 0, 1), (0, 1, 0)]


def test_a_moving_scene_is_taken_at_a_time(
    call: Any, boxes: Scene, room: Path, tmp_path: Path, asked: list[Any]
) -> None:
    ids = boxes.cloud.ids[boxes.cloud.group == 1].numpy()
    rises, hides = Track.slide(ids, [0, 2], [0, 2.0], (0, 0, 1)), Look(ids, 3.0, 4.0, None, zeros(343))
    save(boxes.replace(motion=Motion((rises,), (hides,), stop=4.0)), tmp_path / "film.ply")
    green = ("mesh", tmp_path / "film.ply", "--select", "the green thing", "--texture", 0, "-o", tmp_path / "a.glb")
    assert call(*green).code == 130 and call(*green, "--time", "2").code == 130
    heights = [float(scene.cloud.means[isin(scene.cloud.ids, ids), 2].mean()) for scene, ids in asked]
    assert heights[1] - heights[0] == pytest.approx(2, abs=1e-4)
    for time, said in (("0:2", "many times"), ("soon", "seconds as in 2.5"), ("3.5", "hidden at 3.5 s")):
        refused = call(*green, "--time", time)
        assert refused.code == 2 and said in refused.err
    refused = call("mesh", room, "--time", "1", "-o", tmp_path / "a.glb", "--texture", 0)
    assert refused.code == 2 and "nothing moves" in refused.err

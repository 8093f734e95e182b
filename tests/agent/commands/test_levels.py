"""Scenes in levels of detail on the command line: what each verb does with a `.lod`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from scenewright.agent.options import with_values
from scenewright.gaussians import files
from scenewright.gaussians.files.formats import streamed_sog_writing
from scenewright.gaussians.levels.making import make
from scenewright.gaussians.scene import Scene

PSNR = [(50.0, 40.0), (30.0, 20.0), (25.0, 15.0)]
FAR = ("--view", "0,-4000,1:0,0,0.5:20", "--size", "60x40")


@pytest.fixture
def lod(boxes: Scene, tmp_path: Path) -> Path:
    plain = boxes.replace(language=None)
    with streamed_sog_writing.replacing(tmp_path / "boxes.lod") as folder:
        streamed_sog_writing.write(make(plain, 3, (), leaf_rows=200), folder, 400)
        streamed_sog_writing.annotate(folder, plain, PSNR)
    return tmp_path / "boxes.lod"


def picture(path: Path) -> np.ndarray[Any, Any]:
    return np.asarray(Image.open(path))


def test_info_tells_the_levels(call: Any, lod: Path, boxes: Scene) -> None:
    found = call("info", lod, "--json").data
    counts = [len(boxes.cloud), len(boxes.cloud) // 4, len(boxes.cloud) // 16]
    assert [level["gaussians"] for level in found["levels"]] == counts
    assert [(level["psnr"], level["psnr_least"]) for level in found["levels"]] == PSNR
    assert sum(level["bytes"] for level in found["levels"]) == sum(p.stat().st_size for p in lod.glob("*/*"))
    assert "level 1: 293 Gaussians" in (out := call("info", lod / "lod-meta.json").out) and "30.0 dB PSNR" in out


def test_frame_and_cameras_are_kept(lod: Path, boxes: Scene) -> None:
    back = files.load(lod)
    assert (back.frame.up, back.frame.floor, back.frame.metres_per_unit) == (
        boxes.frame.up, boxes.frame.floor, boxes.frame.metres_per_unit,
    )  # fmt: skip
    assert [c.name for c in back.cameras] == [c.name for c in boxes.cameras] and back.cameras
    for was, now in zip(boxes.cameras, back.cameras, strict=True):
        assert np.array_equal(was.world_to_camera, now.world_to_camera) and was.fx == now.fx


def test_without_the_option_the_finest_level_is_drawn(call: Any, lod: Path, tmp_path: Path) -> None:
    files.save(files.load(lod), tmp_path / "finest.ply")
    for scene, name in ((lod, "a"), (tmp_path / "finest.ply", "b")):
        found = call("render", scene, "-o", tmp_path / f"{name}.png", *FAR, "--json")
        assert found.code == 0 and "lod" not in found.data
    assert np.array_equal(picture(tmp_path / "a.png"), picture(tmp_path / "b.png"))


def test_no_pixel_of_error_is_the_finest_level(call: Any, lod: Path, boxes: Scene, tmp_path: Path) -> None:
    near = ("--view", "0,-9,4:0,0,0.3", "--size", "90x60")
    call("render", lod, "-o", tmp_path / "a.png", *near)
    found = call("render", lod, "-o", tmp_path / "b.png", *near, "--lod", 0, "--json").data
    assert found["lod"]["gaussians"] == found["lod"]["gaussians_finest"] == len(boxes.cloud)
    assert np.abs(picture(tmp_path / "a.png").astype(int) - picture(tmp_path / "b.png")).max() <= 1  # order of rows


def test_from_afar_only_the_coarse_files_are_read(call: Any, lod: Path, boxes: Scene, tmp_path: Path) -> None:
    for chunk in (*lod.glob("0_*"), *lod.glob("1_*")):
        (chunk / "meta.json").unlink()
    answer = call("render", lod, "-o", tmp_path / "a.png", *FAR, "--lod")
    assert answer.code == 0 and f"{len(boxes.cloud) // 16} of {len(boxes.cloud):,} Gaussians a picture" in answer.out
    assert "at level 2" in answer.out and "at level 0" not in answer.out


def test_a_film_chooses_levels_for_each_picture(call: Any, lod: Path, tmp_path: Path) -> None:
    found = call("render", lod, "-o", tmp_path / "film", "--orbit", 3, "--size", "48x32", "--lod", 3, "--json").data
    assert sum(found["lod"]["leaves"]) == 3 * 8
    assert 0 < found["lod"]["gaussians"] < found["lod"]["gaussians_finest"]
    assert all(picture(p).std() > 5 for p in (tmp_path / "film").iterdir())


@pytest.mark.parametrize(
    ("given", "meant"),
    [
        (["render", "a.lod", "--lod"], "--lod=1.0"),
        (["render", "--lod", "a.lod"], "--lod=1.0"),
        (["render", "--lod", "-o", "a.png"], "--lod=1.0"),
        (["render", "a.lod", "--lod", "2.5"], "--lod"),
        (["render", "a.lod", "--lod", "-1"], "--lod"),
    ],
)
def test_the_option_with_and_without_pixels(given: list[str], meant: str) -> None:
    words = with_values(given)
    assert [w for w in words if w.startswith("--lod")] == [meant] and len(words) == len(given)


def test_levels_of_what_has_none(call: Any, boxes: Scene, tmp_path: Path) -> None:
    files.save(boxes.replace(language=None), tmp_path / "room.ply")
    code, _, err = call("render", tmp_path / "room.ply", "-o", tmp_path / "a.png", "--lod")
    assert code == 2 and "convert room.ply room.lod" in err
    code, _, err = call("render", tmp_path / "gone.lod", "-o", tmp_path / "a.png", "--lod")
    assert code == 4 and "no such file or folder" in err
    assert call("render", tmp_path / "room.ply", "-o", tmp_path / "a.png", "--lod", "-1")[0] == 2


@pytest.mark.parametrize(
    ("extras", "note"),
    [
        ({"scenewright": {"comments": 7}}, "comments"),
        ({"scenewright": {"psnr": [[1.0, float("nan")]]}}, "psnr"),
        ({"scenewright": {"psnr": [[1.0, 1.0]]}}, "not of each level"),
        ({"scenewright": {"comments": ['scenewright frame {"up": 3}']}}, "frame"),
    ],
)
def test_spoiled_extras_cost_only_themselves(call: Any, lod: Path, extras: Any, note: str) -> None:
    index = json.loads((lod / "lod-meta.json").read_text())
    (lod / "lod-meta.json").write_text(json.dumps(index | {"extras": extras}))
    found = call("info", lod, "--json").data
    assert any(note in told for told in found["notes"]) and found["up"][1] == "unknown"
    assert found["levels"][0]["psnr"] is None and found["levels"][0]["gaussians"] > 0


@pytest.mark.parametrize("extras", [None, 3, [], {}, {"viewer": 1}])
def test_extras_of_others_are_skipped(call: Any, lod: Path, extras: Any) -> None:
    index = json.loads((lod / "lod-meta.json").read_text())
    (lod / "lod-meta.json").write_text(json.dumps(index | {"extras": extras}))
    assert call("info", lod, "--json").data["notes"] == []

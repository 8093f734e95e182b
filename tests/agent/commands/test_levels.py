"""Scenes in levels of detail on the command line: what each verb does with a `.lod`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from PIL import Image

from scenewright.agent.options import with_values
from scenewright.agent.output_files import folder_of
from scenewright.gaussians import files
from scenewright.gaussians.files.formats import streamed_sog_writing
from scenewright.gaussians.language import encoders
from scenewright.gaussians.language.field.store import field_path, save_field
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


@pytest.fixture
def named(lod: Path, boxes: Scene, encoder: Any, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The same with a language field."""
    monkeypatch.setattr(encoders, "load", lambda spec="auto": encoder)
    back = files.load(lod)
    nearest = torch.cdist(back.cloud.means, boxes.cloud.means).argmin(dim=1)
    group = boxes.cloud.group[nearest]
    save_field(back.replace(cloud=back.cloud.replace(group=group), language=boxes.language), lod)
    return lod


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


def test_spoiled_extras_cost_only_themselves(call: Any, lod: Path) -> None:
    index = json.loads((lod / "lod-meta.json").read_text())
    for extras, note in (
        ({"comments": 7}, "comments"),
        ({"psnr": [[1.0, float("nan")]]}, "psnr"),
        ({"psnr": [[1.0, 1.0]]}, "not of each level"),
        ({"comments": ['scenewright frame {"up": 3}']}, "frame"),
    ):
        (lod / "lod-meta.json").write_text(json.dumps(index | {"extras": {"scenewright": extras}}))
        found = call("info", lod, "--json").data
        assert any(note in told for told in found["notes"]) and found["up"][1] == "unknown"
        assert found["levels"][0]["psnr"] is None and found["levels"][0]["gaussians"] > 0


def test_extras_of_others_are_skipped(call: Any, lod: Path) -> None:
    index = json.loads((lod / "lod-meta.json").read_text())
    for extras in (None, 3, [], {}, {"viewer": 1}):
        (lod / "lod-meta.json").write_text(json.dumps(index | {"extras": extras}))
        assert call("info", lod, "--json").data["notes"] == []


def test_words_find_the_same_in_levels_as_in_a_file(call: Any, named: Path, room: Path, tmp_path: Path) -> None:
    for scene, name in ((named, "lod"), (room, "ply")):
        found = call("select", scene, "the green thing", "--ids", tmp_path / f"{name}.npy", "--json")
        assert found.code == 0 and found.data["groups"] == [1]
    ids = np.load(tmp_path / "lod.npy")
    assert len(ids) == len(np.load(tmp_path / "ply.npy"))
    means = files.load(named).cloud.means[torch.from_numpy(ids)]
    assert torch.allclose(means.mean(dim=0), torch.tensor([0.0, 0.3, 0.3]), atol=1e-2)
    answers = [call("ask", scene, "how many red things are there?") for scene in (named, named / "lod-meta.json", room)]
    assert len({(a.code, a.out) for a in answers}) == 1 and answers[0].code == 0


def test_an_edit_goes_to_a_plain_file(call: Any, named: Path, tmp_path: Path) -> None:
    out = tmp_path / "edited.ply"
    assert call("edit", named, "delete the green thing", "-o", out, "--no-infill").code == 0
    before, after = files.load(named), files.load(out)
    assert len(after.cloud) == len(before.cloud) - 343 and after.frame == before.frame
    assert field_path(out).is_file()  # as of any scene with a field


def test_levels_are_written_by_convert_only(call: Any, named: Path, tmp_path: Path) -> None:
    out = tmp_path / "b.lod"
    code, _, err = call("edit", named, "delete the green thing", "-o", out)
    assert code == 2 and "`scenewright convert SCENE b.lod`" in err and "b.ply first" in err
    code, _, err = call("slim", named, "-o", out)
    assert code == 2 and "slim to b.ply, then `scenewright convert b.ply b.lod`" in err
    for option, value in (("--levels", 2), ("--chunk", 2000)):
        code, _, err = call("convert", named, tmp_path / "b.ply", option, value)
        assert code == 2 and f"{option} is for levels of detail" in err
    assert not out.exists() and not (tmp_path / "b.ply").exists()


def test_a_field_that_is_there_is_used(call: Any, named: Path, tmp_path: Path) -> None:
    assert "was embedded already" in call("embed", named).out
    assert call("info", named / "lod-meta.json", "--json").data["language"]["things"][0]["label"] == "box"
    (named / "more.txt").write_text("this makes it another scene")
    assert call("info", named, "--json").data["language"] is None


def test_levels_become_a_file_again(call: Any, lod: Path, tmp_path: Path) -> None:
    found = call("convert", lod, tmp_path / "b.ply", "--views", 0, "--json").data
    assert found["from"] == "Streamed SOG" and not found["notes"]
    assert found["bytes_before"] == sum(p.stat().st_size for p in lod.rglob("*") if p.is_file())
    back = files.load(tmp_path / "b.ply")
    assert back.cloud.digest() == files.load(lod).cloud.digest() and len(back.cameras) == 1


def test_what_a_session_writes_lies_beside_a_scene_and_never_in_it(lod: Path, tmp_path: Path) -> None:
    assert folder_of(lod) == folder_of(lod / "lod-meta.json") == folder_of(tmp_path / "room.ply") == tmp_path


@pytest.mark.slow
def test_a_scene_in_levels_and_what_is_told_of_it(call: Any, boxes: Scene, tmp_path: Path) -> None:
    files.save(boxes.replace(language=None), tmp_path / "room.ply")
    told = call("convert", tmp_path / "room.ply", tmp_path / "a.lod", "--levels", 2, "--json").data
    assert told["levels"] == call("info", tmp_path / "a.lod", "--json").data["levels"]
    assert [level["gaussians"] for level in told["levels"]] == [len(boxes.cloud), len(boxes.cloud) // 4]
    assert told["levels"][0]["psnr"] > 40 > told["levels"][1]["psnr"] > told["levels"][1]["psnr_least"] > 10
    assert files.load(tmp_path / "a.lod").frame == files.load(tmp_path / "room.ply").frame
    plain = call("convert", tmp_path / "room.ply", tmp_path / "b.lod", "--levels", 2, "--views", 0, "--json").data
    assert [level["psnr"] for level in plain["levels"]] == [None, None]
    assert [level["gaussians"] for level in plain["levels"]] == [level["gaussians"] for level in told["levels"]]
    assert call("slim", tmp_path / "a.lod", "-o", tmp_path / "s.sog", "--psnr", 35, "--json").data["gaussians"] > 0
    assert call("embed", tmp_path / "b.lod").code == 0 and field_path(tmp_path / "b.lod").is_file()

"""`scenewright render`: a still, a film round the scene, from a capture's cameras, along a path; what it refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from scenewright.agent.pictures.shots import _file_names
from scenewright.gaussians.files import save
from scenewright.gaussians.scene import Scene


@pytest.fixture
def room(boxes: Scene, tmp_path: Path) -> Path:
    save(boxes.replace(language=None), tmp_path / "boxes.ply")
    return tmp_path / "boxes.ply"


@pytest.fixture
def render(call: Any, room: Path) -> Any:
    """Renders the room; the exit code, what was printed as JSON, and what was said."""

    def run(*arguments: object) -> tuple[int, Any, str]:
        answer = call("render", room, *arguments, "--json")
        return answer.code, answer.data, answer.err

    return run


@pytest.fixture
def capture(tmp_path: Path) -> Path:
    """Three photographs of two sizes, from one place."""
    pose = np.eye(4)
    pose[:3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]  # looks along +y, +z up (OpenGL axes)
    pose[:3, 3] = (0, -8, 1)
    frames = [{"file_path": f"images/{name}.JPG", "transform_matrix": pose.tolist()} for name in ("a 1", "b", "c")]
    frames[2]["w"] = 30
    told = {"w": 40, "h": 20, "fl_x": 30, "frames": frames}
    (tmp_path / "capture").mkdir()
    (tmp_path / "capture" / "transforms.json").write_text(json.dumps(told))
    return tmp_path / "capture"


def test_an_orbit_as_gif_and_as_pictures(render: Any, tmp_path: Path) -> None:
    code, data, _ = render("--orbit", 6, "-o", tmp_path / "a.gif", "--size", "48x32", "--seconds", 2)
    assert (code, data["pictures"], data["fps"], data["lasts"], data["size"]) == (0, 6, 3.0, 2.0, [48, 32])
    assert data["bytes"] == (tmp_path / "a.gif").stat().st_size
    assert Image.open(tmp_path / "a.gif").n_frames == 6  # type: ignore[attr-defined]
    assert render("--orbit", 6, "-o", tmp_path / "film", "--size", "48x32")[0] == 0
    pictures = sorted((tmp_path / "film").iterdir())
    assert [p.name for p in pictures] == [f"{i:04d}.png" for i in range(6)]
    assert all(np.asarray(Image.open(p)).std() > 5 for p in pictures)  # something is seen from all sides


def test_every_camera_of_a_capture_by_its_photographs_name_and_size(render: Any, capture: Path, tmp_path: Path) -> None:
    for i, source in enumerate((capture, capture / "transforms.json")):
        code, data, _ = render("--cameras", source, "-o", tmp_path / f"own{i}")
        assert code == 0 and data["size"] is None
        found = {p.name: Image.open(p).size for p in (tmp_path / f"own{i}").iterdir()}
        assert found == {"a 1.png": (40, 20), "b.png": (40, 20), "c.png": (30, 20)}
    code, data, _ = render("--cameras", capture, "-o", tmp_path / "a.gif")
    assert code == 2 and "one size" in data["reason"]
    assert render("--cameras", capture, "-o", tmp_path / "a.gif", "--size", "40x20")[0] == 0


def test_the_cameras_of_a_scene(render: Any, room: Path, tmp_path: Path) -> None:
    assert render("--cameras", room, "-o", tmp_path / "own")[0] == 0
    assert render("--view", "door", "-o", tmp_path / "door.png")[0] == 0
    assert (tmp_path / "own" / "door.png").read_bytes() == (tmp_path / "door.png").read_bytes()


def test_a_path_at_its_own_rate_and_stretched(render: Any, tmp_path: Path) -> None:
    keyframes = [{"position": [x, -8, 2], "target": [0, 0, 0], "time": t} for x, t in ((-3, 0), (0, 0.5), (3, 1))]
    path = tmp_path / "path.json"
    path.write_text(json.dumps({"fps": 4, "size": [30, 20], "keyframes": keyframes}))
    code, data, _ = render("--path", path, "-o", tmp_path / "a.gif")
    assert (code, data["pictures"], data["fps"], data["size"]) == (0, 5, 4.0, [30, 20])
    code, data, _ = render("--path", path, "-o", tmp_path / "p%d.png", "--seconds", 2, "--fps", 5, "--size", "24x16")
    assert (code, data["pictures"], data["size"]) == (0, 11, [24, 16]) and (tmp_path / "p10.png").exists()
    render("--view", "3,-8,2:0,0,0", "-o", tmp_path / "last.png", "--size", "24x16")
    assert (tmp_path / "last.png").read_bytes() == (tmp_path / "p10.png").read_bytes()  # both 55 degrees high


def test_one_keyframe_is_one_picture(render: Any, tmp_path: Path) -> None:
    path = tmp_path / "path.json"
    path.write_text(json.dumps({"keyframes": [{"position": [0, -8, 2], "target": [0, 0, 0]}]}))
    code, data, _ = render("--path", path, "-o", tmp_path / "a.gif", "--size", "24x16")
    assert (code, data["pictures"]) == (0, 1)


def test_transparency_and_depth(render: Any, tmp_path: Path) -> None:
    assert render("-o", tmp_path / "alpha.png", "--alpha", "--background", "white", "--size", "48x32")[0] == 0
    assert render("-o", tmp_path / "depth.png", "--depth", "--size", "48x32")[0] == 0
    alpha, depth = (np.asarray(Image.open(tmp_path / f"{name}.png")) for name in ("alpha", "depth"))
    assert alpha.shape == (32, 48, 4) and set(np.unique(alpha[..., 3])) >= {0, 255}
    assert depth.shape == (32, 48) and depth.dtype == np.uint16
    assert (depth[alpha[..., 3] == 0] == 0).all()
    assert 4000 < np.median(depth[alpha[..., 3] == 255]) < 13_000  # the camera stands 8 units before the middle


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["-o", "a.gif"], "say which"),
        (["-o", "folder"], "say which"),
        (["-o", "a.gif", "--view", "door"], "say which"),
        (["-o", "a.png", "--orbit", "9"], "many pictures"),
        (["-o", "a.png", "--fps", "9"], "many pictures"),
        (["-o", "a.webm", "--orbit", "9"], "films as"),
        (["-o", "a.gif", "--orbit", "9", "--view", "door"], "ask for one"),
        (["-o", "a.gif", "--orbit", "9", "--path", "p.json"], "ask for one"),
        (["-o", "a.gif", "--orbit", "1"], "2 to"),
        (["-o", "a.gif", "--orbit", "99999999"], "2 to"),
        (["-o", "a.gif", "--orbit", "9", "--seconds", "nan"], "above zero"),
        (["-o", "a.gif", "--orbit", "9", "--seconds", "1", "--fps", "9"], "leave out"),
        (["-o", "a.gif", "--orbit", "9", "--fps", "0"], "are not supported"),
        (["-o", "a.gif", "--orbit", "9", "--fps", "nan"], "are not supported"),
        (["-o", "a.gif", "--orbit", "9", "--depth"], "needs PNGs"),
        (["-o", "a", "--orbit", "9", "--depth", "--alpha"], "ask for one"),
        (["-o", "a%d%d.png", "--orbit", "9"], "is not a pattern"),
    ],
)
def test_what_makes_no_film_is_refused(render: Any, tmp_path: Path, arguments: list[str], says: str) -> None:
    before = sorted(tmp_path.rglob("*"))
    code, data, _ = render(arguments[0], tmp_path / arguments[1], *arguments[2:])
    assert code == 2 and says in data["reason"], data
    assert sorted(tmp_path.rglob("*")) == before


def test_a_broken_source_is_a_file_error(render: Any, tmp_path: Path) -> None:
    (tmp_path / "broken.json").write_text('{"keyframes": [{"position": [NaN, 0, 0], "target": [0, 0, 0]}]}')
    for option in ("--path", "--cameras"):
        for source in ("broken.json", "missing.json"):
            code, data, _ = render(option, tmp_path / source, "-o", tmp_path / "a.gif")
            assert code == 4 and source in data["reason"]
    assert not (tmp_path / "a.gif").exists()


@pytest.mark.slow
def test_nothing_is_overwritten_unasked(render: Any, tmp_path: Path) -> None:
    small = ("--orbit", 2, "--size", "8x8")
    for output in (tmp_path / "a.gif", tmp_path / "film"):
        assert render(*small, "-o", output)[0] == 0
        code, data, _ = render(*small, "-o", output)
        assert code == 2 and "--force" in data["reason"]
        assert render(*small, "-o", output, "--force")[0] == 0


def test_names_of_photographs_become_names_of_files() -> None:
    names = ["../../etc/passwd", "left/0001", "left_0001", "", ".hidden", "A", "a", "a-2", "ä b", "x" * 400, "nul\0"]
    made = _file_names(names)
    assert made[0] == "_.._etc_passwd" and made[1:3] == ("left_0001", "left_0001-2") and made[3] == "0003"
    assert made[5:8] == ("A", "a-2", "a-2-2") and made[8] == "ä b" and len(made[9]) == 100
    assert len({name.lower() for name in made}) == len(names)
    assert not any(name.startswith(".") or "/" in name or "\0" in name for name in made)

"""`find-view`: the view in words, as a picture, as text for --view and as JSON."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from scenewright.agent.cli import main
from scenewright.agent.pictures.named_cameras import choose_view, view_text
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.scene import Scene
from scenewright.gaussians.viewpoints.coverage import fit_camera


def run(*arguments: str | Path) -> int:
    with pytest.raises(SystemExit) as ended:
        main([str(a) for a in arguments])
    code = ended.value.code
    assert isinstance(code, int)
    return code


def test_a_view_is_drawn_and_given_again_by_its_text(
    room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "view.png"
    assert run("find-view", room, "the green thing from above", "-o", out, "--size", "240x160", "--json") == 0
    data = json.loads(capsys.readouterr().out)
    assert data["size"] == [240, 160] and data["things"][0]["group"] == 1 and data["things"][0]["share"] > 0.01
    image = np.asarray(Image.open(out)).astype(int)
    green = (image[..., 1] - image[..., 0] > 60).mean()
    assert green == pytest.approx(data["things"][0]["share"], abs=0.05)
    again = tmp_path / "again.png"
    assert run("render", room, "--view", data["view"], "--size", "240x160", "-o", again) == 0
    # The text is exact to a thousandth; borders of Gaussians may differ by a grey level or a few.
    assert np.abs(np.asarray(Image.open(again)).astype(int) - image).mean() < 1.0


def test_marks_are_drawn_only_when_asked_for(room: Path, tmp_path: Path) -> None:
    for name, options in (("a.png", []), ("b.png", ["--marks"])):
        assert run("find-view", room, "the green thing", "-o", tmp_path / name, "--size", "240x160", *options) == 0
    a, b = (np.asarray(Image.open(tmp_path / n)) for n in ("a.png", "b.png"))
    assert 0.001 < (a != b).any(axis=2).mean() < 0.2


def test_without_a_file_the_view_is_only_told(room: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("find-view", room, "the green thing from the left") == 0
    said = capsys.readouterr().out
    assert said.startswith("--view ") and "group 1" in said and "the viewer's" in said


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        ("the red thing from behind", 3, "2 things match"),
        ("the blue thing", 3, ""),
        ("", 2, "say what to look at"),
        ("the whole room from the left", 3, "no view from left"),
    ],
)
def test_refusals_write_nothing(
    room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], words: str, code: int, said: str
) -> None:
    assert run("find-view", room, words, "-o", tmp_path / "no.png") == code
    assert said in capsys.readouterr().err
    assert not (tmp_path / "no.png").exists()


def test_paths_are_checked_first(room: Path, tmp_path: Path) -> None:
    (tmp_path / "there.png").write_bytes(b"x")
    assert run("find-view", room, "the green thing", "-o", tmp_path / "there.png") == 2
    assert run("find-view", room, "the green thing", "-o", tmp_path / "view.jpg") == 2
    assert run("find-view", room, "the green thing", "--marks") == 2
    assert (tmp_path / "there.png").read_bytes() == b"x"


@pytest.mark.parametrize("size", [(960, 640), (640, 480), (300, 700)])
def test_the_text_of_a_view_gives_the_same_camera(boxes: Scene, size: tuple[int, int]) -> None:
    camera = Camera.look_at([1.5, -4, 2], [0.3, 0, 0.5], [0, 0, 1], *size, 37.0)
    again = choose_view(boxes, view_text(camera), f"{size[0]}x{size[1]}")
    assert again.fy == pytest.approx(camera.fy, rel=1e-4)
    assert np.allclose(again.world_to_camera, camera.world_to_camera, atol=2e-3)
    assert fit_camera(again, *size).width == size[0]


@pytest.mark.parametrize(
    "view", ["0,0,1:0,0,0:0", "0,0,1:0,0,0:nan", "0,0,1:0,0,0:x", "0,0,1:0,0,0:180", "0,0,1:0,0,0:5:6"]
)
def test_a_view_with_an_impossible_angle_is_refused(boxes: Scene, view: str) -> None:
    with pytest.raises(UserError):
        choose_view(boxes, view)

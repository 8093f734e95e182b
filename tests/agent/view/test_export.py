"""`scenewright export`: one file that shows the scene from a disk, loads nothing, and refuses what it must."""

from __future__ import annotations

import io
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from PIL import Image
from real_browser import browser_or_skip

from scenewright.agent.cli import main
from scenewright.agent.view.standalone import page
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.files import save
from scenewright.gaussians.motion.at import at
from scenewright.gaussians.motion.motion import Motion, Track
from scenewright.gaussians.render import render
from scenewright.gaussians.scene import Scene

WIDTH, HEIGHT = 240, 180
CAMERA = Camera.look_at([0, -4, 1], [0, 0, 0], [0, 0, 1], WIDTH, HEIGHT, 45)


def balls(count: int = 1500) -> Scene:
    """A ball of coloured Gaussians."""
    made = torch.Generator().manual_seed(4)
    means = torch.nn.functional.normalize(torch.randn(count, 3, generator=made), dim=1)
    quats = torch.nn.functional.normalize(torch.randn(count, 4, generator=made), dim=1)
    sh = 0.8 * torch.randn(count, 4, 3, generator=made)
    scales = torch.full((count, 3), 0.06)
    return Scene(GaussianCloud.create(means, quats, scales, torch.full((count,), 0.9), sh))


@pytest.mark.browser
def test_the_file_shows_the_scene_from_a_disk_and_asks_for_nothing(tmp_path: Path) -> None:
    scene, title = balls(), "a </title><script>alert(1)</script> & room"
    path = tmp_path / "room.html"
    path.write_bytes(page(scene, CAMERA, title))
    faults: list[str] = []
    asked: list[str] = []
    with browser_or_skip() as browser:
        opened = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})
        opened.on("pageerror", lambda error: faults.append(str(error)))
        opened.on("console", lambda said: faults.append(said.text) if said.type == "error" else None)
        opened.on("request", lambda request: asked.append(request.url))
        opened.goto(path.as_uri())
        opened.wait_for_selector("#told:has-text('Drag')")  # wait_for_function polls by eval, which the page forbids
        opened.evaluate("viewer.idle()")
        opened.add_style_tag(content="header, footer { display: none !important }")
        drawn = _picture(opened)
        shown = opened.title()
    wanted = render(scene.cloud, CAMERA).to_uint8()
    error = np.mean((drawn.astype(float) - wanted) ** 2)
    assert not faults
    assert shown == title
    assert [url for url in asked if not url.startswith(("file:", "data:", "blob:"))] == []
    assert wanted.std() > 20 and 10 * np.log10(255**2 / error) > 30


@pytest.mark.browser
@pytest.mark.slow
def test_a_moving_scene_plays_and_scrubs_without_a_server(tmp_path: Path) -> None:
    scene = balls()
    going = Track.slide(np.arange(1500), [0, 2], [0, 1.0], (1, 0, 0))
    moving = scene.replace(motion=Motion((going,), stop=2.0))
    path = tmp_path / "room.html"
    path.write_bytes(page(moving, CAMERA, "moving"))
    assert path.read_bytes() == page(moving, CAMERA, "moving")
    with browser_or_skip() as browser:
        opened = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})
        opened.goto(path.as_uri())
        opened.wait_for_selector("#time-bar:not([hidden])")
        assert opened.locator("#time").get_attribute("max") == "40"
        opened.locator("#play").click()
        opened.wait_for_selector("#time-told:has-text('0.5 of 2.0')")
        opened.locator("#time").fill("40")  # the end; it pauses
        opened.wait_for_selector("#play:has-text('Play')")
        opened.wait_for_timeout(500)
        opened.evaluate("viewer.idle()")
        opened.add_style_tag(content="header, footer, #time-bar { display: none !important }")
        drawn = _picture(opened)
    wanted = render(at(moving, 2.0).cloud, CAMERA).to_uint8()
    error = np.mean((drawn.astype(float) - wanted) ** 2)
    assert 10 * np.log10(255**2 / error) > 30


def test_a_static_scene_has_no_moments_and_a_huge_motion_shows_its_start() -> None:
    scene = balls(200)
    assert b'class="moments"' not in page(scene, CAMERA, "a")
    for_ever = Motion((Track.slide(np.arange(200), [0, 1e6], [0, 1.0], (1, 0, 0)),), stop=1e6)
    assert b'class="moments"' not in page(scene.replace(motion=for_ever), CAMERA, "a")


def _picture(opened: Any) -> np.ndarray:
    opened.evaluate("viewer.png()")  # draws
    return np.asarray(Image.open(io.BytesIO(opened.screenshot())).convert("RGB"))


def test_the_file_names_no_other_place_and_allows_only_its_own_scripts() -> None:
    text = page(balls(100), CAMERA, "room").decode()
    policy = re.search(r'Content-Security-Policy" content="([^"]+)"', text)
    assert policy is not None and "default-src 'none'" in policy[1]
    assert policy[1].count("'sha256-") == 2 and "unsafe-eval" not in policy[1]
    assert "script-src 'unsafe-inline'" not in policy[1] and "{{" not in text
    assert not re.search(r"https?://", text)
    assert page(balls(100), CAMERA, "room").decode() == text  # equal scenes, equal files


def test_the_command_writes_the_file_and_keeps_what_is_there(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source, target = tmp_path / "ball.ply", tmp_path / "ball.html"
    save(balls(200), source)
    assert _run("export", str(source), "-o", str(target)) == 0
    assert "200 Gaussians" in capsys.readouterr().out
    first = target.read_bytes()
    assert b"<title>ball.ply</title>" in first
    assert _run("export", str(source), "-o", str(target)) == 2
    assert _run("export", str(source), "-o", str(tmp_path / "ball.ply2")) == 2
    assert "name it ball.ply2.html" in capsys.readouterr().err
    assert target.read_bytes() == first
    assert not (tmp_path / "ball.ply2").exists()


def _run(*arguments: str) -> int:
    with pytest.raises(SystemExit) as end:
        main(list(arguments))
    return int(end.value.code or 0)

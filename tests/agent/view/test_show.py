"""`show`: a scene in a cell of a notebook, as a frame that holds its whole page; a result's picture."""

from __future__ import annotations

import html
import io
import re
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import torch
from PIL import Image

import scenewright
from scenewright import GaussianCloud, Result, Scene, UserError
from scenewright.agent.pictures.named_cameras import default_view
from scenewright.agent.view.standalone import page
from scenewright.gaussians.camera import Camera

CAMERA = Camera.look_at([0, -4, 1], [0, 0, 0], [0, 0, 1], 64, 48, 45)


def row(path: Path | None = None) -> Scene:
    """Five red Gaussians in a row."""
    means = torch.zeros(5, 3)
    means[:, 0] = torch.linspace(-1, 1, 5)
    sh = torch.tensor([1.5, -1.5, -1.5]).expand(5, 1, 3).contiguous()
    quats = torch.tensor([1.0, 0, 0, 0]).expand(5, 4).contiguous()
    return Scene(GaussianCloud.create(means, quats, torch.full((5, 3), 0.2), torch.full((5,), 0.9), sh), path=path)


def test_the_cell_holds_the_page_of_the_scene_and_nothing_else() -> None:
    cell = scenewright.show(row(Path("a/room.ply")), CAMERA, height=300)._repr_html_()
    held = re.fullmatch(r'<iframe srcdoc="([^"]*)" height="300" style="[^"]*"></iframe>', cell)
    assert held is not None
    assert html.unescape(held[1]).encode() == page(row(), CAMERA, "room.ply")


def test_a_result_is_shown_as_its_viewer_sees_it_and_has_a_picture() -> None:
    before = row()
    result = Result("redder", None, (), before, before, CAMERA)
    assert scenewright.show(result, title="redder").page.encode() == page(before, CAMERA, "redder")
    picture = np.asarray(Image.open(io.BytesIO(result._repr_png_())))
    assert np.array_equal(picture, result.render().to_uint8())
    assert picture[..., 0].max() > 100


def test_a_notebook_shows_a_scene_as_a_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    shown: dict[tuple[str, str], Callable[[Scene], bytes | None]] = {}
    png = SimpleNamespace(for_type_by_name=lambda module, name, draw: shown.update({(module, name): draw}))
    shell = SimpleNamespace(display_formatter=SimpleNamespace(formatters={"image/png": png}))
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    scenewright._show_in_notebook()
    draw = shown[Scene.__module__, Scene.__qualname__]
    scene = replace(row(), cameras=(CAMERA,))
    drawn = draw(scene)
    assert drawn is not None
    picture = np.asarray(Image.open(io.BytesIO(drawn)))
    assert np.array_equal(picture, scenewright.render(scene, default_view(scene)).to_uint8()) and picture.max() > 100
    assert draw(Scene(GaussianCloud.empty())) is None


def test_without_gaussians_or_height_there_is_nothing_to_show() -> None:
    with pytest.raises(UserError, match="no Gaussians"):
        scenewright.show(Scene(GaussianCloud.empty()))
    with pytest.raises(UserError, match="must be positive"):
        scenewright.show(row(), height=0)

"""`show`: a scene in a cell of a notebook, as a frame that holds its whole page; a result's picture."""

from __future__ import annotations

import html
import io
import re
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image

import scenewright
from scenewright import GaussianCloud, Result, Scene, UserError
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


def test_without_gaussians_or_height_there_is_nothing_to_show() -> None:
    with pytest.raises(UserError, match="no Gaussians"):
        scenewright.show(Scene(GaussianCloud.empty()))
    with pytest.raises(UserError, match="must be positive"):
        scenewright.show(row(), height=0)

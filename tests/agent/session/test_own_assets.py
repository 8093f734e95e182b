"""A user's own assets are inserted by the names of their files, in their own proportions and colours."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from scenewright.agent.session.session import Session
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.scene import Scene


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A tall green gargoyle in metres, a chair in centimetres, and a file that is none."""
    out = tmp_path / "mine"
    out.mkdir()
    gargoyle = trimesh.creation.box((0.3, 0.6, 0.2))  # y up
    gargoyle.visual.face_colors = (20, 200, 30, 255)
    gargoyle.export(out / "gargoyle.glb")
    trimesh.creation.box((45.0, 90.0, 50.0)).export(out / "my chair.glb")
    (out / "anvil.glb").write_bytes(b"glTF" + b"\xff" * 64)
    return out


def _added(session: Session, before: Scene) -> Any:
    return session.scene.cloud[len(before.cloud) :]


def test_an_asset_of_ones_own_is_inserted_as_it_is(boxes: Scene, encoder: Any, folder: Path) -> None:
    session = Session(boxes, encoder=encoder, assets=folder)
    result = session.do("add a gargoyle")
    new = _added(session, boxes)
    span = np.ptp(new.means.numpy(), axis=0)
    assert span == pytest.approx((0.3, 0.2, 0.6), abs=0.05) or span == pytest.approx((0.2, 0.3, 0.6), abs=0.05)
    rgb = (new.sh[:, 0] * 0.28209479 + 0.5).mean(dim=0)
    assert rgb[1] > 2 * rgb[0] and rgb[1] > 2 * rgb[2]
    assert any("gargoyle.glb of your assets" in said for said in result.sentences())


def test_a_size_that_is_none_of_its_kind_is_read_in_another_unit(boxes: Scene, encoder: Any, folder: Path) -> None:
    session = Session(boxes, encoder=encoder, assets=folder)
    result = session.do("add a chair")
    height = float(np.ptp(_added(session, boxes).means.numpy()[:, 2]))
    assert 0.6 < height < 1.2
    assert any("scaled by 0.0" in said and "usual size of a chair" in said for said in result.sentences())


@pytest.mark.slow
def test_it_replaces_and_takes_a_colour(boxes: Scene, encoder: Any, folder: Path) -> None:
    session = Session(boxes, encoder=encoder, assets=folder)
    session.do("replace the green thing with a red gargoyle")
    new = session.scene.cloud[session.scene.cloud.group > 3]
    rgb = (new.sh[:, 0] * 0.28209479 + 0.5).mean(dim=0)
    assert rgb[0] > 2 * rgb[1]
    assert not bool((session.scene.cloud.group == 1).any())


def test_what_is_not_there_or_broken_is_taken_from_the_library_or_refused(
    boxes: Scene, encoder: Any, folder: Path, tmp_path: Path
) -> None:
    session = Session(boxes, encoder=encoder, assets=folder)
    session.do("add a stool")
    assert len(session.scene.cloud) > len(boxes.cloud)
    before = session.scene
    with pytest.raises(UserError):
        session.do("add an anvil")  # broken, and the library has none
    assert session.scene is before
    with pytest.raises(UserError, match=r"no \.glb or \.ply"):
        (tmp_path / "empty").mkdir()
        Session(boxes, encoder=encoder, assets=tmp_path / "empty")

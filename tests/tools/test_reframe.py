"""The whole scene is turned, moved and scaled with all that knows where it is."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from scenewright.gaussians.errors import InstructionError, UserError
from scenewright.gaussians.render import Render, render
from scenewright.gaussians.scene import Scene
from scenewright.tools.execute import carry_out
from scenewright.tools.operation import Context
from scenewright.tools.registry import parse

EVERYTHING = {"text": "everything", "pick": "all"}
MAPS: list[dict[str, Any]] = [
    {"op": "reframe", "degrees": 90, "axis": "x"},
    {"op": "reframe", "degrees": -37, "axis": "y"},
    {"op": "reframe", "degrees": 125},
    {"op": "reframe", "up": "-y"},
    {"op": "reframe", "factor": 3.5},
    {"op": "reframe", "direction": "left", "distance": {"value": 40, "unit": "cm"}},
    {"op": "reframe", "origin": "middle"},
    {"op": "rotate", "target": EVERYTHING, "degrees": 180, "axis": "forward"},
    {"op": "scale", "target": EVERYTHING, "factor": 0.5},
]


@pytest.fixture(scope="module")
def filmed(corner: Scene) -> Scene:
    from scenewright.gaussians.camera import Camera

    eyes = [(0.5, -4.0, 1.6), (3.0, -2.0, 2.2)]
    cameras = tuple(Camera.look_at(eye, (0.2, 0.4, 0.5), (0, 0, 1), 48, 36) for eye in eyes)
    return corner.replace(cameras=cameras, frame=replace(corner.frame, metres_per_unit=0.8))


@pytest.fixture(scope="module")
def pictures(filmed: Scene) -> list[Render]:
    return [render(filmed.cloud, camera, backend="reference") for camera in filmed.cameras]


@pytest.mark.parametrize("fields", MAPS, ids=str)
@pytest.mark.slow
def test_the_scenes_cameras_see_the_same_picture(
    fields: dict[str, Any], filmed: Scene, pictures: list[Render], context: Context
) -> None:
    after = carry_out(filmed, parse(fields), context).scene
    for was, new in zip(pictures, after.cameras, strict=True):
        now = render(after.cloud, new, backend="reference")
        assert float((was.rgb - now.rgb).abs().mean()) < 1e-4  # rounding moves few Gaussians across a pixel's border
        assert float((was.rgb - now.rgb).abs().max()) < 0.05


def _over_floor(scene: Scene) -> np.ndarray:
    """Height `[N]` of every Gaussian over the floor."""
    return np.asarray(scene.cloud.means.double().numpy() @ scene.frame.up_vector - (scene.frame.floor or 0.0))


@pytest.mark.parametrize("fields", MAPS, ids=str)
def test_frame_and_boxes_go_along(fields: dict[str, Any], filmed: Scene, context: Context) -> None:
    after = carry_out(filmed, parse(fields), context).scene
    assert after.language is not None
    assert filmed.language is not None
    was, now = filmed.frame, after.frame
    scale = float((after.cloud.scales[0] / filmed.cloud.scales[0]).mean())
    assert now.metres_per_unit == pytest.approx(was.metres_per_unit / scale, rel=1e-5)  # type: ignore[operator]
    old, new = (_over_floor(s) for s in (filmed, after))
    np.testing.assert_allclose(new, scale * old, atol=1e-4)
    for a, b in zip(filmed.language.groups, after.language.groups, strict=True):
        own = torch.isin(after.cloud.group, torch.tensor(after.language.leaves(b.id), dtype=torch.int32))
        share = b.box.covers(after.cloud.means[own].double().numpy()).mean()
        before = a.box.covers(filmed.cloud.means[own].double().numpy()).mean()
        assert share == pytest.approx(before, abs=0.02)


def test_stating_the_unit_changes_no_gaussian(filmed: Scene, context: Context) -> None:
    known = carry_out(filmed, parse({"op": "reframe", "unit": {"value": 35, "unit": "cm"}}), context).scene
    assert known.cloud is filmed.cloud
    assert known.frame.metres_per_unit == pytest.approx(0.35)
    assert filmed.language is not None
    height = filmed.language.groups[0].box.size[2]
    said = {"op": "reframe", "unit": {"value": 1.5, "unit": "m"}, "at": {"text": "table"}}
    by_table = carry_out(filmed, parse(said), context).scene.frame.metres_per_unit
    assert by_table == pytest.approx(1.5 / height, rel=0.1)


def test_everything_is_not_placed_beside_something_in_it(filmed: Scene, context: Context) -> None:
    place = {"relation": "next_to", "anchors": ({"text": "table"},)}
    with pytest.raises(InstructionError, match="whole scene"):
        carry_out(filmed, parse({"op": "move", "target": EVERYTHING, "place": place}), context)
    with pytest.raises(UserError):
        parse({"op": "reframe", "degrees": 3, "factor": 2})
    with pytest.raises(UserError):
        parse({"op": "reframe", "direction": "up"})

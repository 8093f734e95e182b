"""What a thing of a capture encloses goes where it goes; what is only near it, or a thing of its own, stays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.harmonics import color_to_dc
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.selection import Selection
from scenewright.gaussians.scene import Frame, Scene
from scenewright.gaussians.world.box import Box
from scenewright.tools.enclosed import with_enclosed
from scenewright.tools.execute import carry_out
from scenewright.tools.operation import Context
from scenewright.tools.registry import parse

AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
URN, BALL, GROUND, PATCH, REST = range(5)


def shell(count: int, g: torch.Generator) -> torch.Tensor:
    """`[count, 3]` points of a sphere of radius 1 about the origin, without its top (an open vessel)."""
    points = torch.nn.functional.normalize(torch.randn(4 * count, 3, generator=g), dim=1)
    return points[points[:, 2] < 0.8][:count]


def scene(sure: float = 0.1) -> Scene:
    """An open vessel on the ground with haze of no group, a patch of what is behind, and a ball of its own."""
    g = torch.Generator().manual_seed(0)
    near = torch.rand(100, 3, generator=g) - 0.5
    inside = torch.cat([0.5 * near, 0.3 * near - torch.tensor([0.0, 0.0, 0.4]), 0.2 * near + 0.2])
    ground = torch.cat([6 * torch.rand(4000, 2, generator=g) - 3, torch.full((4000, 1), -1.02)], dim=1)
    beside = 0.3 * near + torch.tensor([1.6, 0.0, 0.0])
    means = torch.cat([shell(6000, g), inside, ground, beside])
    group = torch.tensor(
        [URN] * 6000 + [-1] * 100 + [PATCH] * 100 + [BALL] * 100 + [GROUND] * 4000 + [-1] * 50 + [REST] * 50
    )
    n = len(means)
    cloud = GaussianCloud.create(
        means, torch.tensor([[1.0, 0, 0, 0]]).expand(n, 4), torch.full((n, 3), 0.03), torch.full((n,), 0.9),
        color_to_dc(torch.full((n, 3), 0.5))[:, None], group.to(torch.int32),
    )  # fmt: skip

    def row(i: int, level: str, label: str, score: float, size: float, parent: int = -1) -> Group:
        box = Box((0.0, 0.0, 0.0), AXES, (size, size, size))
        return Group(i, level, parent, label, score, box, (50.0, 0.0, 0.0), int((group == i).sum()), 8, 1.0)  # type: ignore[arg-type]

    rows = (
        row(URN, "object", "urn", sure, 2.0),
        row(BALL, "object", "ball", 1.0, 0.2),
        row(GROUND, "structure", "floor", 1, 6.0),
        row(PATCH, "part", "", 0.0, 0.3, REST),
        row(REST, "object", "wall shelf", 0.1, 3.0),
    )
    return Scene(cloud, Frame(floor=-1.02), (), LanguageField(rows, np.zeros((5, 8), np.float32), "none"))


def urn_of(of: Scene) -> Selection:
    return Selection(Query(groups=(URN,)), "found", of.cloud.ids[of.cloud.group == URN], (URN,))


def rows(of: Scene, low: int, high: int) -> set[int]:
    return set(of.cloud.ids[low:high].tolist())


def test_what_lies_inside_goes_along_and_what_does_not_stays() -> None:
    of = scene()
    found = with_enclosed(of, urn_of(of))
    inner = set(found.enclosed.tolist())  # type: ignore[union-attr]
    assert inner >= rows(of, 6000, 6200)  # of no group, and a patch
    assert not inner & rows(of, 6200, 6300)  # a ball that is known as one
    assert not inner & rows(of, 6300, len(of.cloud))  # the ground below, and haze beside it
    assert set(found.ids.tolist()) == inner | rows(of, 0, 6000)


def test_nothing_is_added_where_names_are_reliable_or_a_part_is_meant() -> None:
    sure = scene(sure=1.0)
    assert with_enclosed(sure, urn_of(sure)).enclosed is None
    of = scene()
    assert of.language is not None
    parted = replace(of.language, groups=(replace(of.language.groups[0], level="part"), *of.language.groups[1:]))
    assert with_enclosed(of.replace(language=parted), urn_of(of)).enclosed is None


def test_a_flat_thing_encloses_nothing() -> None:
    of = scene()
    ids = of.cloud.ids[6300:10300]
    assert with_enclosed(of, Selection(Query(groups=(URN,)), "found", ids, (URN,))).enclosed is None


@pytest.mark.parametrize("op", ["delete", "move"])
def test_an_edit_takes_it_along_and_says_so(op: str) -> None:
    of = scene()
    data = {"op": op, "target": {"groups": [URN]}}
    if op == "move":
        data |= {"direction": "up", "distance": {"value": 1, "unit": "units"}}
    viewer = Camera.look_at((0.0, -6.0, 2.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 64, 48, 50.0)
    done = carry_out(of, parse(data), Context(viewer))
    assert any("inside it went along" in note for note in done.receipt.notes)
    assert done.receipt.changed + done.receipt.removed >= 6200
    if op == "move":  # as one body: everything by the same step
        step = (done.scene.cloud.means - of.cloud.means)[:6200, 2]
        assert torch.allclose(step, step[0].expand(6200), atol=1e-5)

"""Layers of a thing that belong to something else go with it; what of its picture stays is told."""

from __future__ import annotations

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
from scenewright.tools.cohesion import STAYS, remarks
from scenewright.tools.enclosed import with_enclosed
from scenewright.tools.registry import parse
from scenewright.tools.showing_through import SHOWN, showing_through

AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
BALL, LAYER, GROUND = range(3)
BOX = Box((0.0, 0.0, 0.0), AXES, (2.0, 2.0, 2.0))


def scene(sure: float = 0.1) -> Scene:
    """A red ball on grey ground, whose second layer is of another thing, named with probability `sure`."""
    g = torch.Generator().manual_seed(0)
    shell = torch.nn.functional.normalize(torch.randn(6000, 3, generator=g), dim=1)
    shell[1::2] *= 0.96
    ground = torch.cat([8 * torch.rand(6000, 2, generator=g) - 4, torch.full((6000, 1), -1.05)], dim=1)
    means = torch.cat([shell, ground])
    rgb = torch.cat([torch.tensor([[0.7, 0.1, 0.1]]).expand(6000, 3), torch.full((6000, 3), 0.5)])
    group = torch.cat([torch.arange(6000) % 2, torch.full((6000,), GROUND)])
    cloud = GaussianCloud.create(
        means, torch.tensor([[1.0, 0, 0, 0]]).expand(12000, 4), torch.full((12000, 3), 0.05), torch.full((12000,), 0.9),
        color_to_dc(rgb)[:, None], group.to(torch.int32),
    )  # fmt: skip

    def row(i: int, level: str, label: str, score: float, size: float) -> Group:
        box = Box((0.0, 0.0, 0.0), AXES, (size, size, size))
        return Group(i, level, -1, label, score, box, (50.0, 0.0, 0.0), int((group == i).sum()), 8, 1.0)  # type: ignore[arg-type]

    rows = (
        row(0, "object", "ball", 0.1, 2.0),
        row(1, "object", "rug", sure, 2.0),
        row(2, "structure", "floor", 1, 8.0),
    )
    return Scene(cloud, Frame(floor=-1.05), (), LanguageField(rows, np.zeros((3, 8), np.float32), "none"))


def ball_of(of: Scene) -> Selection:
    return Selection(Query(text="ball"), "found", of.cloud.ids[of.cloud.group == BALL], (BALL,))


def test_the_other_layer_goes_and_the_ground_stays() -> None:
    of = scene()
    own = of.cloud.group == BALL
    found, left = showing_through(of, own, BOX, torch.zeros_like(own))
    layer = of.cloud.group == LAYER
    assert not bool((found & ~layer).any())
    assert float(found[layer].float().mean()) > 0.5  # inner ones and those below are hardly seen
    assert left <= SHOWN * 3


def test_what_is_of_a_sure_thing_stays_and_is_told() -> None:
    of = scene()
    own = of.cloud.group == BALL
    found, left = showing_through(of, own, BOX, of.cloud.group == LAYER)
    assert not bool(found.any()) and left > 0.5


def test_a_thing_that_is_alone_leaves_no_picture() -> None:
    of = scene()
    own = of.cloud.group < GROUND
    found, left = showing_through(of, own, BOX, torch.zeros_like(own))
    assert left < SHOWN and not bool(found.any())


def test_the_layer_goes_along_with_a_selection_unless_it_is_known_as_a_thing() -> None:
    of = scene()
    taken = with_enclosed(of, ball_of(of))
    assert taken.shows is not None and taken.enclosed is not None and len(taken.enclosed) > 1500


@pytest.mark.parametrize(("shows", "told"), [(0.0, False), (STAYS - 0.01, False), (0.6, True)])
def test_a_picture_that_stays_is_told(shows: float, told: bool) -> None:
    of = scene()
    op = parse({"op": "delete", "target": {"text": "ball"}})
    chosen = Selection(Query(text="ball"), "found", of.cloud.ids[of.cloud.group < GROUND], (BALL, LAYER), shows=shows)
    said = remarks(of, op, chosen)
    assert any("looks as before" in one for one in said) is told


def test_a_border_without_an_edge_is_told_and_one_with_an_edge_is_not() -> None:
    of = scene()
    op = parse({"op": "recolor", "target": {"text": "ball"}, "color": "blue"})
    whole = Selection(Query(text="ball"), "found", of.cloud.ids[of.cloud.group < GROUND], (BALL, LAYER))
    assert not any("without an edge" in one for one in remarks(of, op, whole))
    assert any("without an edge" in one for one in remarks(of, op, ball_of(of)))


def test_nothing_is_remarked_in_a_room_of_known_scale() -> None:
    of = scene()
    known = of.replace(frame=Frame(floor=-1.05, metres_per_unit=1.0))
    op = parse({"op": "recolor", "target": {"text": "ball"}, "color": "blue"})
    assert remarks(known, op, ball_of(known)) == ()


def test_a_view_that_stands_inside_a_thing_shows_nothing_of_it() -> None:
    of = scene().replace(cameras=(Camera.look_at((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), 64, 48, 50.0),))
    own = of.cloud.group == BALL
    assert showing_through(of, own, BOX, torch.zeros_like(own))[1] == 0.0

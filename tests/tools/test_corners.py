"""A corner of the room by name: things go into it, and the thing in it is found."""

from __future__ import annotations

import numpy as np
import pytest

from scenewright.gaussians.errors import UserError
from scenewright.gaussians.language.query.resolve import resolve
from scenewright.gaussians.scene import Scene
from scenewright.planners.grammar import GrammarPlanner
from scenewright.tools.execute import carry_out
from scenewright.tools.operation import Context, Placement
from scenewright.tools.registry import parse

# The viewer looks along +y, so that "back" is +y and "left" is -x.
WAYS = {"front left": (-1, -1), "front right": (1, -1), "back left": (-1, 1), "back right": (1, 1)}


@pytest.mark.parametrize(("name", "way"), WAYS.items())
def test_a_thing_goes_into_the_named_corner(
    corner_scene: Scene, context: Context, name: str, way: tuple[int, int]
) -> None:
    place = {"relation": "corner", "corner": name}
    done = carry_out(corner_scene, parse({"op": "insert", "asset": "stool", "place": place}), context)
    assert done.scene.language is not None
    center = np.array(done.scene.language.groups[-1].box.center[:2])
    assert (center * way > 2.2).all()  # the floor reaches 3 m from the middle to each side


def test_only_a_corner_of_the_room_has_such_a_name() -> None:
    with pytest.raises((UserError, ValueError), match="corner"):
        Placement.model_validate({"relation": "on", "corner": "back left"})


@pytest.mark.parametrize(
    ("text", "pick"),
    [
        ("delete the back left chair", "back left"),
        ("delete the chair in the front right corner", "front right"),
        ("delete the chair at the back on the right", "back right"),
        ("delete the far left chair", "leftmost"),
    ],
)
def test_a_corner_picks(text: str, pick: str) -> None:
    (op,) = GrammarPlanner().plan(text).ops
    query = op.query()
    assert query is not None and (query.text, query.pick) == ("chair", pick)


def test_the_pick_is_the_farthest_into_the_corner(corner_scene: Scene, context: Context) -> None:
    assert corner_scene.language is not None
    boxes = {g.id: g.box.center for g in corner_scene.language.groups if g.level == "object"}
    for name, (x, y) in WAYS.items():
        query = parse({"op": "select", "target": {"pick": name}}).query()
        assert query is not None
        found = resolve(corner_scene, query, context.viewer)
        assert found.groups == (max(boxes, key=lambda i: x * boxes[i][0] + y * boxes[i][1]),), (name, found.reason)


@pytest.fixture
def corner_scene(corner: Scene) -> Scene:
    return corner

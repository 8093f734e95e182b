"""Exact moves, changing places, and hanging above something: on furniture with a language field."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from scenewright.gaussians.errors import CheckFailedError, InstructionError, UserError
from scenewright.gaussians.scene import Scene
from scenewright.gaussians.world.box import Box
from scenewright.tools.execute import carry_out
from scenewright.tools.operation import Context, Placement
from scenewright.tools.registry import parse

TABLE, CHAIR, ARMCHAIR, VASE = range(4)  # as the `corner` fixture numbers them


def do(scene: Scene, context: Context, op: str, **fields: Any) -> Scene:
    done = carry_out(scene, parse({"op": op, **fields}), context)
    assert done.receipt.passed
    return done.scene


def box(scene: Scene, group: int) -> Box:
    assert scene.language is not None
    return scene.language.groups[group].box


def both(a: int, b: int) -> dict[str, Any]:
    return {"groups": [a, b], "pick": "all"}


def test_a_thing_goes_exactly_as_far_as_was_said_and_takes_along_what_stands_on_it(
    corner: Scene, context: Context
) -> None:
    after = do(corner, context, "arrange", target={"text": "table"}, x=0.3, y=0.7, turn=30)
    moved = np.array(box(after, TABLE).center) - np.array(box(corner, TABLE).center)
    # Boxes are measured anew on float32 centres, a hundredth of the points left out at each end.
    assert np.allclose(moved, (0.3, 0.7, 0.0), atol=2e-3)
    assert math.degrees(math.atan2(*box(after, TABLE).axes[0][1::-1])) == pytest.approx(30, abs=1e-3)
    was, now = (box(s, TABLE).local(np.array([box(s, VASE).center])) for s in (corner, after))
    assert np.allclose(was, now, atol=2e-3)
    assert box(after, CHAIR) == box(corner, CHAIR)


def test_there_and_back_restores(corner: Scene, context: Context) -> None:
    there = do(corner, context, "arrange", target={"text": "vase"}, x=0.2, y=-0.1, turn=45)
    back = do(there, context, "arrange", target={"text": "vase"}, x=-0.2, y=0.1, turn=-45)
    # The pivot is the middle of a box measured again after the first turn.
    assert np.allclose(back.cloud.means.numpy(), corner.cloud.means.numpy(), atol=5e-3)


def test_nothing_is_put_into_the_air_into_a_thing_or_nowhere(corner: Scene, context: Context) -> None:
    with pytest.raises(InstructionError, match="carry"):
        do(corner, context, "arrange", target={"text": "vase"}, x=2.2)
    with pytest.raises(CheckFailedError, match="collision"):
        do(corner, context, "arrange", target={"text": "table"}, x=1.5)
    with pytest.raises(UserError, match="way or a turn"):
        parse({"op": "arrange", "target": {"text": "vase"}})


def test_two_things_change_places(corner: Scene, context: Context) -> None:
    after = do(corner, context, "exchange", target=both(CHAIR, ARMCHAIR))
    for one, other in ((CHAIR, ARMCHAIR), (ARMCHAIR, CHAIR)):
        # As near as the search's cells, a tenth of the shorter side, allow.
        assert math.dist(box(after, one).center[:2], box(corner, other).center[:2]) < 0.1
    assert box(after, TABLE) == box(corner, TABLE)


def test_what_cannot_change_places_is_refused(corner: Scene, context: Context) -> None:
    with pytest.raises(InstructionError, match="stands on it"):
        do(corner, context, "exchange", target=both(TABLE, VASE))
    with pytest.raises(InstructionError, match="two things"):
        do(corner, context, "exchange", target={"text": "chair"})


def test_what_hangs_goes_over_a_thing_and_what_stands_does_not(corner: Scene, context: Context) -> None:
    place = {"relation": "above", "anchors": [{"text": "table"}]}
    after = do(corner, context, "insert", asset="pendant lamp", place=place)
    lamp = box(after, 5)
    assert math.dist(lamp.center[:2], box(corner, TABLE).center[:2]) < 0.1
    with pytest.raises(InstructionError, match="does not hang"):
        do(corner, context, "insert", asset="chair", place=place)
    with pytest.raises(InstructionError, match="does not hang"):
        do(corner, context, "move", target={"text": "vase"}, place=place)


def test_a_new_thing_stands_where_an_offset_says(corner: Scene, context: Context) -> None:
    top = {"relation": "on", "anchors": [{"text": "table"}], "offset": [-0.3, 0.1]}
    after = do(corner, context, "insert", asset="mug", place=top)
    way = np.array(box(after, 5).center) - np.array(box(corner, TABLE).center)
    assert np.allclose(way[:2], (-0.3, 0.1), atol=0.06)  # the handle is part of the box
    with pytest.raises(ValidationError, match="offset"):
        Placement.model_validate({**top, "relation": "next_to"})


def test_opposite_is_before_the_front(corner: Scene, context: Context) -> None:
    place = {"relation": "opposite", "anchors": [{"text": "armchair"}]}
    after = do(corner, context, "insert", asset="stool", place=place)
    arm = box(corner, ARMCHAIR)
    across, ahead, _ = arm.local(np.array([box(after, 5).center]))[0]
    assert ahead < -arm.size[1] / 2 and abs(across) < abs(ahead)

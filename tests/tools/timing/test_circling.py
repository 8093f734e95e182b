"""What goes round a thing goes between what stands around, or says through what it goes."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import pytest

from scenewright.gaussians.motion.courses import course_of
from scenewright.gaussians.scene import Scene
from scenewright.gaussians.world.box import Box
from scenewright.tools.execute import carry_out
from scenewright.tools.operation import Context
from scenewright.tools.registry import parse
from scenewright.tools.timing.circling import Circling
from scenewright.tools.timing.through_time import carry_through_time

TABLE, CHAIR, ARMCHAIR, VASE, FLOOR = range(5)
LEVEL = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def box(x: float, y: float, side: float, z: float = 0.2) -> Box:
    return Box((x, y, z), LEVEL, (side, side, 0.3))


def circling(*around: tuple[str, Box], angle: float = 2 * math.pi, floor: Box | None = None) -> Circling:
    """A box of 20 cm two metres right of a table of 60 cm."""
    table = ("table", box(0.0, 0.0, 0.6))
    up = np.array([0.0, 0.0, 1.0])
    return Circling(box(2.0, 0.0, 0.2), np.array([0.0, 0.0, 0.2]), "table", up, angle, (table, *around), floor, 0.01)


def test_a_free_circle_stays() -> None:
    assert circling(("chair", box(0.0, 3.0, 0.4))).best() == (2.0, ())
    quarter = circling(("chair", box(-2.0, 0.0, 0.4)), angle=math.pi / 2)
    assert quarter.best() == (2.0, ())  # it does not come there


def test_it_goes_nearer_or_farther() -> None:
    radius, left = circling(("chair", box(-2.1, 0.0, 0.4))).best()
    assert not left and 1.7 < radius < 1.8  # in front of the chair, nearest to where it is
    radius, left = circling(("chair", box(-1.8, 0.0, 0.4))).best()
    assert not left and 2.1 < radius < 2.25  # behind it
    radius, left = circling(floor=Box((0.0, 0.0, 0.0), LEVEL, (6.0, 3.0, 0.0))).best()
    assert not left and radius == pytest.approx(1.5)  # it does not leave the floor


def test_what_it_goes_through_is_told() -> None:
    """Of circles that all go through something one that goes through less; never through what it goes round."""
    ring = [("shelf", box(-x, 0.0, 0.5)) for x in (0.6, 1.0, 1.4, 1.8, 2.2, 2.6)]
    radius, left = circling(*ring, ("lamp", box(0.0, 2.0, 0.4))).best()
    assert left == ("shelf",) and radius > 0.4


def test_a_thin_wall_is_not_missed() -> None:
    wall = Box((0.0, 1.2, 0.5), LEVEL, (9.0, 0.001, 1.0))
    radius, left = circling(("the wall", wall)).best()
    assert not left and radius < 1.1


def test_the_way_to_the_circle_and_the_circle_take_the_time(
    corner: Scene, context: Context, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Circling, "best", lambda self: (self.radius / 2, ()))
    monkeypatch.setattr(Circling, "hit", lambda self: ("wall",))
    data = {
        "op": "orbit", "target": {"groups": [CHAIR]}, "around": {"groups": [TABLE]}, "turns": 1,
        "when": {"start": 1, "stop": 3},
    }  # fmt: skip
    made = carry_through_time(corner, parse(data), context, None, partial(carry_out, seen=False))
    assert any("it would go through the wall" in note for note in made.receipt.notes)
    course = course_of(made.scene, CHAIR)
    middle = np.array(course_of(corner, TABLE).still.center)
    off = (course.boxes(np.array([0.5, 1.0, 2.0, 2.5, 3.0])).centers - middle)[:, :2]
    far = np.linalg.norm(off, axis=1)
    assert far == pytest.approx(far[0] * np.array([1, 1, 0.5, 0.5, 0.5]), rel=0.05)

"""How far a thing goes that is sent to another, and what a spot of a room means."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from scenewright.agent.session.session import Session
from scenewright.benchmarks._motion import rooms
from scenewright.gaussians.errors import AbsentError
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.world.box import Box, penetration
from scenewright.tools.ops.move import Move, _free_way

UP = np.array([0.0, 0.0, 1.0])


def box(x: float, y: float, angle: float, size: tuple[float, float]) -> Box:
    c, s = math.cos(angle), math.sin(angle)
    return Box((x, y, 0.5), ((c, s, 0.0), (-s, c, 0.0), (0.0, 0.0, 1.0)), (*size, 1.0))


SIZES = st.tuples(st.floats(0.2, 2.0), st.floats(0.2, 2.0))
ANGLES = st.floats(0.0, 6.28)


@given(SIZES, SIZES, ANGLES, ANGLES, ANGLES)
def test_it_stops_a_gap_before_what_it_goes_to(
    one: tuple[float, float], other: tuple[float, float], turned: float, its: float, bearing: float
) -> None:
    start, goal = box(0.0, 0.0, turned, one), box(5 * math.cos(bearing), 5 * math.sin(bearing), its, other)
    way = np.array([math.cos(bearing), math.sin(bearing), 0.0])
    far = _free_way(start, goal, way, UP, 0.03)
    assert 0 < far < 5
    there = start.shifted(way * far)
    assert penetration(there, goal) == pytest.approx(-0.03, abs=1e-6)


@pytest.fixture(scope="module")
def session() -> Session:
    return Session(rooms.moving_room("drawer", 0.3))


@pytest.mark.slow
def test_the_wardrobe_comes_as_near_to_the_bed_as_it_can(session: Session) -> None:
    session.do("move the wardrobe to the bed in 2 seconds")
    assert session.scene.motion is not None and session.scene.language is not None
    boxes = {g.label: g.box for g in session.scene.language.groups}
    moved = boxes["wardrobe"].shifted(session.scene.motion.tracks[-1].offsets[-1])
    assert -0.05 < penetration(moved, boxes["bed"]) < 0
    session.undo()


def test_the_wardrobe_in_the_corner_is_the_only_one(session: Session) -> None:
    (receipt,) = session.do("paint the wardrobe in the corner teal").receipts
    assert "was not checked" in receipt.selection.reason
    session.undo()
    with pytest.raises(AbsentError):
        session.do("paint the wardrobe in the corner of the piano teal")
    with pytest.raises(AbsentError):
        session.do("paint the wardrobe next to the piano teal")


def middles(session: Session) -> dict[str, np.ndarray]:
    assert session.scene.language is not None
    return {g.label: np.array(g.box.center) for g in session.scene.language.groups if g.level == "object"}


def test_something_moves_away_from_another_thing(session: Session) -> None:
    before = middles(session)
    (receipt,) = session.do("move the chair 30 cm away from the bed").receipts
    after, way = middles(session), before["chair"] - before["bed"]
    way[2] = 0.0
    assert after["chair"] - before["chair"] == pytest.approx(0.3 * way / np.linalg.norm(way), abs=1e-3)
    assert all(check.passed for check in receipt.checks)
    assert after["bed"] == pytest.approx(before["bed"], abs=1e-6)
    session.undo()


def test_away_says_from_what() -> None:
    with pytest.raises(ValidationError, match="away goes with toward"):
        Move(target=Query(text="chair"), direction="left", away=True)
    assert Move(target=Query(text="chair"), toward=Query(text="bed"), away=True).away

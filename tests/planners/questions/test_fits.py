"""Whether things would fit: laws of the exact test, sizes as read and as sold, and places in words."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from small_room import BED, DESK, DOOR, THINGS, WIDTH, graph, node, said, turned

from scenewright.gaussians.world.box import YawBox, plan_penetration
from scenewright.planners.questions.floor.spaces import Surface, place
from scenewright.planners.questions.reading.item import Item, read_item
from scenewright.planners.questions.reading.where_to import where_to
from scenewright.planners.questions.reading.words import plain_words

FLOOR = Surface(0.0, 0.0, 0.0, 4.0, 3.0, 0.0, 2.5)


# -- laws ------------------------------------------------------------------------------------------------------------


def test_a_place_is_free_and_on_the_floor() -> None:
    rng = np.random.default_rng(3)
    placed = 0
    for _ in range(60):
        boxes = [YawBox(*rng.uniform(-1.5, 1.5, 2), 0.0, *rng.uniform(0.3, 1.4, 2), 1.0, float(rng.choice([0, 90, 30])))
                 for _ in range(5)]  # fmt: skip
        size = (*rng.uniform(0.3, 1.5, 2), 0.8)
        found = place(size, FLOOR, boxes, (0.0, 90.0))
        if found is None:
            continue
        placed += 1
        assert all(plan_penetration(found, b) <= 0.006 for b in boxes)
        corners = found.corners()
        assert (np.abs(corners) <= np.array([2.0, 1.5]) + 0.006).all()
    assert placed > 20


def test_no_place_is_missed_among_aligned_boxes() -> None:
    """Compared with every position on a lattice of 2 cm."""
    rng = np.random.default_rng(5)
    fine_x, fine_y = np.meshgrid(np.arange(-2, 2.001, 0.02), np.arange(-1.5, 1.501, 0.02), indexing="ij")
    answers = set()
    for _ in range(25):
        boxes = [YawBox(*np.round(rng.uniform(-1.8, 1.8, 2), 2), 0.0, *np.round(rng.uniform(0.4, 1.6, 2), 2), 1.0)
                 for _ in range(6)]  # fmt: skip
        size = (round(float(rng.uniform(0.6, 1.8)), 2), round(float(rng.uniform(0.6, 1.4)), 2), 0.8)
        box = YawBox(fine_x, fine_y, 0.0, *size)
        free = (np.abs(fine_x) <= 2 - size[0] / 2) & (np.abs(fine_y) <= 1.5 - size[1] / 2)
        for other in boxes:
            free &= plan_penetration(box, other) <= 0
        found = place(size, FLOOR, boxes, (0.0,))
        answers.add(found is not None)
        if free.any():
            assert found is not None
    assert answers == {True, False}


def test_what_fits_still_fits_when_it_is_smaller_or_the_room_emptier() -> None:
    for width, question in itertools.product(
        (2.4, 1.8, 1.2, 0.6), ("next to the desk", "in front of the bed", "in here")
    ):
        asked = "Would a table of {:.1f} m by 0.6 m fit {}?"
        now = said(asked.format(width, question))
        if now.answer == "yes":
            assert said(asked.format(width / 2, question)).answer == "yes"
            assert said(asked.format(width, question), graph(DOOR, BED, DESK)).answer == "yes"


def test_a_gap_holds_what_is_as_wide_and_no_more() -> None:
    boxes = (node(7, "cabinet", (1.0, 0.4, 1.0), (-1.5, -0.5)), node(8, "dresser", (1.0, 0.4, 1.0), (0.5, -0.5)))
    scene = graph(*boxes)  # 1.0 m apart
    assert said("Would a bookcase 98 cm wide fit between the cabinet and the dresser?", scene).answer == "yes"
    assert said("Would a bookcase 1.03 m wide fit between the cabinet and the dresser?", scene).answer == "no"
    assert said("Would a bookcase 98 cm wide fit between the cabinet and the dresser?", turned(scene)).answer == "yes"
    widest = said("How wide a bookcase would fit between the cabinet and the dresser?", scene)
    assert widest.answer == pytest.approx(1.0, abs=0.09)  # steps of 2 % of four times the usual width


# -- reading -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "width", "depth", "height"),
    [
        ("a 2 m by 1 m table", 2.0, 1.0, None),
        ("a 2 x 1 m table", 2.0, 1.0, None),
        ("a table of 2 by 1 metres", 2.0, 1.0, None),
        ("a box measuring 50 x 40 x 30 cm", 0.5, 0.4, 0.3),
        ("another bookcase, say 90 cm wide,", 0.9, None, None),
        ("a chest of drawers 1.2 metres wide and half a metre deep", 1.2, 0.5, None),
        ("a wardrobe 1 m wide, 60 cm deep and 2 m tall", 1.0, 0.6, 2.0),
        ("a sofa three metres long", 3.0, None, None),
        ("a round table 1.2 m in diameter", 1.2, 1.2, None),
        ("a 3 ft by 6 ft desk", 0.9144, 1.8288, None),
        ("a piano", None, None, None),
    ],
)
def test_sizes_in_words(words: str, width: float | None, depth: float | None, height: float | None) -> None:
    found = read_item(plain_words(words))
    assert isinstance(found, Item)
    for value, side in ((width, found.width), (depth, found.depth), (height, found.height)):
        assert side == (pytest.approx(value) if value is not None else None)


@pytest.mark.parametrize(
    "words", ["a table between", "the 2 m", "a 2 m by", "a table 1 m wide 2 m wide", "a wumpus", ""]
)
def test_what_is_no_item_is_not_read(words: str) -> None:
    assert read_item(tuple(words.split())) is None


@pytest.mark.parametrize(
    ("words", "relations"),
    [
        ("between the bed and the wall", ["between"]),
        ("against the back wall between the dresser and the wardrobe", ["wall", "between"]),
        ("in the back left corner", ["corner"]),
        ("in here", ["room"]),
        ("under the window", ["under"]),
        ("along the front edge of the room", ["wall"]),
        ("in the middle of the room", ["middle"]),
        ("in front of the sofa", ["in_front"]),
    ],
)
def test_places_in_words(words: str, relations: list[str]) -> None:
    found = where_to(tuple(words.split()))
    assert found is not None and [w.relation for w in found] == relations


# -- answers -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("question", "value"),
    [
        ("Would a 2 m by 1 m rug fit in here?", "yes"),
        ("Could I put a sofa 6 metres long along the back wall?", "no"),
        ("Is there room for a chair at the desk?", "yes"),
        ("Is there space to do yoga in front of the bed?", "yes"),
        ("Is there space to dance (4 x 4 m) in front of the bed?", "no"),
        ("Is there enough space to lie down in the middle of the room?", "yes"),
        ("Would a table 1.2 m wide and 50 cm tall fit under the window?", "no"),
        ("Would a laptop fit on the desk?", "yes"),
        ("Would a pool table fit on the desk?", "no"),
        ("Will a 1.2 m wide fridge go through the door?", "no"),
        ("Will a 70 cm wide fridge go through the door?", "yes"),
        ("Would a piano fit next to the fireplace?", "no"),
        ("Would an elephant fit under the bed?", None),
        ("Would a 30 cm high box fit under the bed?", None),
        ("Would a 3 m wide and 3 m deep box fit under the bed?", "no"),
        ("Does the desk fit between the bed and the bed?", None),
    ],
)
def test_would_it_fit(question: str, value: str | None) -> None:
    found = said(question)
    assert found.answer == value, found.text
    if value is None:
        assert found.source == "none"


def test_an_answer_shows_where_it_would_stand() -> None:
    found = said("Would a 1 m by 0.5 m table fit in here?")
    table = found.evidence.lines[:2]
    assert found.answer == "yes" and [line.label for line in table] == ["1.00 m", "0.50 m"]
    assert all(abs(line.start[0]) <= WIDTH / 2 for line in table)


def test_the_size_of_a_kind_is_told_as_usual() -> None:
    assert "as usually sold" in said("Can I fit a piano in here?").text
    assert "as usually sold" not in said("Can I fit a piano of 1.5 by 0.6 m in here?").text


def test_a_thing_that_is_there_is_measured_and_not_in_its_own_way() -> None:
    found = said("Would the desk fit against the left wall?")
    assert found.answer == "yes" and "1.40 x 0.70" in found.text
    assert found.evidence.ids[0] == DESK.id


def test_where_something_would_fit_is_told() -> None:
    found = said("Where could I put a bookcase?")
    assert found.answer_type == "text" and "wall" in str(found.answer)
    assert len(THINGS) == 6 and said("Where could I put a pool table?", graph(*THINGS)).answer is not None

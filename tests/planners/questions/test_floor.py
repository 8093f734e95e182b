"""Room size, free floor, routes and hazards: laws of the floor map, and answers over small rooms with known truth."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from small_room import BED, BIN, DEPTH, DESK, DOOR, HEIGHT, RUG, THINGS, WIDTH, WINDOW, graph, node, said, turned

from scenewright.gaussians.world.person import SHOULDERS
from scenewright.planners.questions.asking import answer
from scenewright.planners.questions.floor import routes
from scenewright.planners.questions.floor.floor_map import FloorMap
from scenewright.planners.questions.survey import Survey
from scenewright.planners.rooms.graph import SceneGraph


def wall_of_boxes() -> SceneGraph:
    boxes = (node(10 + i, "box", (0.6, 0.4, 1.0), (-2.5 + 0.3 + 0.6 * i, 0.3)) for i in range(9))
    return graph(DOOR, DESK, *boxes)


# -- laws ------------------------------------------------------------------------------------------------------------


def test_free_and_covered_floor_are_the_whole_floor() -> None:
    floor = FloorMap.of(graph())
    assert floor.free + floor.covered == pytest.approx(WIDTH * DEPTH)
    footprints = sum(n.size[0] * n.size[1] for n in (BED, DESK, BIN))
    assert floor.covered == pytest.approx(footprints, rel=0.02)  # cells of 2 cm


def test_taking_a_thing_away_never_shrinks_the_free_floor() -> None:
    before = FloorMap.of(graph())
    for gone in THINGS:
        after = FloorMap.of(graph(*(n for n in THINGS if n is not gone)))
        assert after.free >= before.free
        assert (after.clear >= before.clear - 1e-9).all()
        assert (after.walkable() >= before.walkable()).all()


def test_a_route_is_walkable_and_no_shorter_than_the_straight_line() -> None:
    floor = FloorMap.of(graph())
    for goal in (BED, DESK, BIN, WINDOW):
        found = routes.route(floor, routes.to_node(floor, DOOR), routes.to_node(floor, goal))
        assert found is not None
        assert found.length >= math.dist(found.points[0], found.points[-1]) - 1e-9
        for a, b in pairwise(found.points):
            for t in np.linspace(0, 1, 50):
                x, y = a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])
                gaps = [n.yaw_box.distance_to(x, y) for n in (BED, DESK, BIN)]
                # half a cell: the legs run between the middles of cells that are free to a quarter of one
                assert min(gaps) >= SHOULDERS / 2 - floor.cell


def test_a_way_has_the_same_length_in_both_directions() -> None:
    floor = FloorMap.of(graph())
    ends = (routes.to_node(floor, DOOR), routes.to_node(floor, BED))
    there, back = routes.route(floor, *ends), routes.route(floor, *ends[::-1])
    assert there is not None and back is not None
    assert there.length == pytest.approx(back.length, abs=2 * floor.cell)


def test_a_wall_of_boxes_blocks_the_way_and_a_gap_opens_it() -> None:
    scene = wall_of_boxes()
    closed = said("Can I walk from the door to the desk?", scene)
    assert closed.answer == "no" and closed.source == "geometry"
    assert set(closed.evidence.ids) & set(range(10, 19))
    opened = scene.model_copy(update={"nodes": tuple(n for n in scene.nodes if n.id != 14)})
    assert said("Can I walk from the door to the desk?", opened).answer == "yes"


def test_the_widest_disc_that_passes_is_as_wide_as_the_gap() -> None:
    boxes = (node(7, "shelf", (2.0, 0.4, 1.8), (-1.5, 0.2)), node(8, "cabinet", (2.2, 0.4, 1.8), (1.4, 0.2)))
    floor = FloorMap.of(graph(DOOR, DESK, *boxes))  # the shelf ends at -0.5 and the cabinet begins at 0.3
    found = routes.passage(floor, routes.to_node(floor, DOOR), routes.to_node(floor, DESK))
    assert found == pytest.approx(0.8, abs=floor.cell)


QUESTIONS = (
    "How much free floor space is there?",
    "What share of the floor is covered?",
    "What is the floor area?",
    "How long is the walk from the door to the desk?",
    "Can a wheelchair get from the door to the bed?",
    "Can I walk all the way around the bed?",
    "Is there anything I could trip over?",
    "How high is the ceiling?",
    "How wide is the narrowest passage?",
)


@pytest.mark.parametrize("question", QUESTIONS)
def test_a_room_that_is_turned_gives_the_same_answer(question: str) -> None:
    first, second = said(question), said(question, turned(graph()))
    assert first.answer is not None
    if isinstance(first.answer, float):
        assert second.answer == pytest.approx(first.answer, abs=0.06)  # about a cell
    else:
        assert second.answer == first.answer


# -- answers -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("question", "answer_type", "value", "unit"),
    [
        ("How big is the floor area?", "number", WIDTH * DEPTH, "m2"),
        ("What is the area of the room in square feet?", "number", WIDTH * DEPTH / 0.3048**2, "ft2"),
        ("How wide is the room?", "metres", WIDTH, "m"),
        ("How long is this room from front to back, in feet please?", "number", DEPTH / 0.3048, "ft"),
        ("how high is the ceiling in cm", "number", 250.0, "cm"),
        ("Could you tell me how high the ceiling is?", "metres", HEIGHT, "m"),
        ("What's the volume of the room?", "number", WIDTH * DEPTH * HEIGHT, "m3"),
        ("How far is it from corner to corner?", "metres", math.hypot(WIDTH, DEPTH), "m"),
        ("What is the perimeter of the room?", "metres", 2 * (WIDTH + DEPTH), "m"),
        ("How long is the longest wall?", "metres", WIDTH, "m"),
        ("how much floor does the bed take up", "number", 3.2, "m2"),
    ],
)
def test_measures_of_the_room(question: str, answer_type: str, value: float, unit: str) -> None:
    found = said(question)
    assert (found.answer_type, found.unit, found.source) == (answer_type, unit, "geometry")
    assert found.answer == pytest.approx(value, rel=1e-3)


@pytest.mark.parametrize(
    ("question", "value"),
    [
        ("Is the room bigger than 15 square metres?", "yes"),
        ("Is the room smaller than 15 square metres?", "no"),
        ("Is the ceiling higher than 3 m?", "no"),
        ("Is the room 5 metres wide?", "yes"),
        ("Is the room square?", "no"),
        ("Is the room longer than it is wide?", "no"),
        ("Is the room crowded?", "no"),
        ("Is more than half of the floor free?", "yes"),
        ("Can one walk from the door to the desk?", "yes"),
        ("Is the way from the door to the desk blocked?", "no"),
        ("Is there a clear path between the door and the bed?", "yes"),
        ("Are there any trip hazards?", "yes"),
        ("Is the bed a trip hazard?", "no"),
        ("Is the door blocked?", "no"),
        ("Can you walk around the bed?", "no"),
        ("Can you walk all the way around the bin?", "yes"),
        ("Could a wheelchair turn around in here?", "yes"),
        ("Can I reach the piano?", "no"),
        ("Can the door be opened fully?", "yes"),
        ("Are there any obstacles between the door and the bed?", "no"),
        ("Is any corner free?", "yes"),
        ("Can two people walk side by side between the desk and the bed?", "yes"),
        ("Is there a gap of at least 3 m between the desk and the bed?", "no"),
        ("Is the ceiling high enough for a 2.6 m Christmas tree?", "no"),
    ],
)
def test_yes_and_no(question: str, value: str) -> None:
    found = said(question)
    assert (found.answer, found.answer_type) == (value, "yesno"), found.text


def test_a_blocked_door_is_told_with_what_stands_before_it() -> None:
    wardrobe = node(7, "wardrobe", (1.2, 0.6, 2.0), (-1.5, -1.6))
    found = said("Is the door blocked by anything?", graph(*THINGS, wardrobe))
    assert found.answer == "yes"
    assert found.evidence.ids[0] == 7
    assert said("What is blocking the door?", graph(*THINGS, wardrobe)).answer == "wardrobe"


def test_low_things_where_people_walk_are_hazards_and_tucked_ones_are_not() -> None:
    under = node(7, "box", (0.3, 0.3, 0.3), (-1.6, 1.65))
    found = said("What could I trip over?", graph(*THINGS, under))
    assert set(found.evidence.ids) == {RUG.id, BIN.id}
    assert said("Walking from the door to the desk, what might I kick over?").answer == "bin"


def test_directions_name_the_turns_and_add_up() -> None:
    found = said("How do I get from the door to the bed?")
    assert found.answer_type == "text" and found.frame == "viewer"
    legs = [math.dist(line.start, line.end) for line in found.evidence.lines]
    told = said("How far do I have to walk from the door to the bed?")
    assert told.answer == pytest.approx(sum(legs), abs=1e-3)
    assert "the bed" in found.text and "walk" in found.text


def test_lengths_in_a_scene_of_unknown_scale_are_told_as_uncertain() -> None:
    survey = replace(Survey.of_graph(graph()), scaled=False)
    found = answer("How wide is the room?", survey)
    assert found.answer == WIDTH and found.confidence <= 0.4 and "scale" in found.text
    assert answer("What share of the floor is covered?", survey).confidence > 0.4


def test_the_most_open_place_is_free() -> None:
    floor = FloorMap.of(graph())
    x, y, radius = floor.most_open()
    gaps = [n.yaw_box.distance_to(x, y) for n in (BED, DESK, BIN)]
    assert min(*gaps, WIDTH / 2 - abs(x), DEPTH / 2 - abs(y)) == pytest.approx(radius, abs=floor.cell)


def test_what_differs_between_candidates_is_told_and_not_guessed() -> None:
    far = node(7, "bin", (0.25, 0.25, 0.3), (2.3, -1.8))
    found = said("How far is the walk from the desk to the bin?", graph(*THINGS, far))
    assert found.answer is None
    assert set(found.evidence.ids) >= {BIN.id, far.id}
    alike = said("Can I walk from the desk to the bin?", graph(*THINGS, far))
    assert alike.answer == "yes"


@pytest.mark.parametrize(
    "question",
    ["How wide is the colour?", "How big is the room next door?", "Can I walk from the door to happiness tomorrow?",
     "How much free will is there?", "Is the room bigger than yours?"],
)  # fmt: skip
def test_what_is_not_fully_read_is_not_answered(question: str) -> None:
    assert said(question).source == "none" or said(question).answer in (None, "no")

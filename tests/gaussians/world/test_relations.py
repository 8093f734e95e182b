"""Relations between boxes: laws of the frames of reference first, then what people say of hand-made things."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import NDArray

from scenewright.gaussians.camera import Camera, Vec3
from scenewright.gaussians.language.field.language_field import Group
from scenewright.gaussians.world.box import Box, distance
from scenewright.gaussians.world.relation_geometry import HOLDS, object_stand, viewer_stand
from scenewright.gaussians.world.relations import KINDS, score

F64 = NDArray[np.float64]
UP = np.array([0.0, 0.0, 1.0])
SIDEWAYS = tuple(kind.name for kind in KINDS if kind.aim and kind.score)
MIRRORED = {kind.name: kind.inverse for kind in KINDS if kind.aim and kind.score}
JUDGED = tuple(kind.name for kind in KINDS if kind.score and kind.anchors == 1)
CLOSE = 1e-6  # scores are cosines and shares of unit-sized numbers in float64


def vec(values: F64) -> Vec3:
    x, y, z = (float(v) for v in values)
    return (x, y, z)


def at(center: Vec3, size: Vec3 = (0.5, 0.5, 0.5), degrees: float = 0.0, world: F64 | None = None) -> Group:
    """A box turned about up; `world` turns everything, its columns being the images of the axes."""
    a = math.radians(degrees)
    axes = np.array([[math.cos(a), math.sin(a), 0], [-math.sin(a), math.cos(a), 0], [0, 0, 1]])
    turn = np.eye(3) if world is None else world
    x, y, z = (vec(turn @ row) for row in axes)
    return Group(0, "object", -1, "", 0.0, Box(vec(turn @ np.array(center)), (x, y, z), size), (0, 0, 0), 1, 1, 1.0)


def eye(position: Vec3 = (0, -6, 1.6), target: Vec3 = (0, 0, 0.5), up: F64 = UP) -> Camera:
    return Camera.look_at(position, target, up)


def says(name: str, candidate: Group, anchor: Group, camera: Camera | None = None, up: F64 = UP) -> float:
    return score(name, candidate, [anchor], viewer_stand(camera or eye(), up, 0.5))


def holds(name: str, candidate: Group, *anchors: Group) -> bool:
    return score(name, candidate, anchors, viewer_stand(eye(), UP, 0.5)) >= HOLDS


metres = st.floats(-3, 3)
things = st.builds(
    at,
    st.tuples(metres, metres, st.floats(0, 2)),
    st.tuples(*[st.floats(0.05, 2.0)] * 3),
    st.floats(-45, 44),
)
angles = st.floats(-math.pi, math.pi)


def rotation(a: float, b: float, c: float) -> F64:
    """Any rotation, by three angles."""
    ca, sa, cb, sb, cc, sc = math.cos(a), math.sin(a), math.cos(b), math.sin(b), math.cos(c), math.sin(c)
    about_z = np.array([[ca, -sa, 0], [sa, ca, 0], [0, 0, 1]])
    about_x = np.array([[1, 0, 0], [0, cb, -sb], [0, sb, cb]])
    again = np.array([[cc, -sc, 0], [sc, cc, 0], [0, 0, 1]])
    return about_z @ about_x @ again


# -- laws ------------------------------------------------------------------------------------------------------------


@given(things, things)
def test_every_score_is_a_share(a: Group, b: Group) -> None:
    for name in JUDGED:
        assert 0.0 <= says(name, a, b) <= 1.0
    assert 0.0 <= score("between", a, [a, b], viewer_stand(eye(), UP, 0.5)) <= 1.0


@given(things, things)
def test_left_of_is_right_of_seen_from_the_other_thing(a: Group, b: Group) -> None:
    for name in SIDEWAYS:
        assert says(name, a, b) == pytest.approx(says(MIRRORED[name], b, a), abs=CLOSE)


@given(things, things)
def test_nothing_is_on_both_sides(a: Group, b: Group) -> None:
    for name in SIDEWAYS:
        assert says(name, a, b) < HOLDS or says(MIRRORED[name], a, b) < HOLDS


@given(st.tuples(metres, metres, st.floats(0, 2)), st.tuples(metres, metres, st.floats(0, 2)))
def test_a_mirrored_scene_swaps_left_and_right_only(p: Vec3, q: Vec3) -> None:
    a, b = at(p), at(q)
    ma, mb = at((-p[0], p[1], p[2])), at((-q[0], q[1], q[2]))  # the viewer looks along y, so x is mirrored
    for name in ("left_of", "right_of"):
        assert says(name, a, b) == pytest.approx(says(MIRRORED[name], ma, mb), abs=CLOSE)
    for name in ("in_front_of", "behind", "on", "above", "next_to"):
        assert says(name, a, b) == pytest.approx(says(name, ma, mb), abs=CLOSE)


@given(things, things, st.floats(-180, 180))
def test_from_the_other_side_left_is_right_and_front_is_behind(a: Group, b: Group, degrees: float) -> None:
    r = math.radians(degrees)
    here: Vec3 = (5 * math.cos(r), 5 * math.sin(r), 1.6)
    there: Vec3 = (-here[0], -here[1], 1.6)
    for name in SIDEWAYS:
        assert says(name, a, b, eye(here)) == pytest.approx(says(MIRRORED[name], a, b, eye(there)), abs=CLOSE)
    for name in ("on", "under", "above", "inside", "next_to"):
        assert says(name, a, b, eye(here)) == says(name, a, b, eye(there))  # these do not depend on who looks


@given(
    st.tuples(metres, metres, st.floats(0, 2)), st.tuples(metres, metres, st.floats(0, 2)),
    st.floats(-45, 44), angles, angles, angles,
)  # fmt: skip
def test_turning_world_and_viewer_together_changes_nothing(
    p: Vec3, q: Vec3, degrees: float, a: float, b: float, c: float
) -> None:
    turn = rotation(a, b, c)
    up = turn @ UP
    turned = Camera.look_at(turn @ [0, -6, 1.6], turn @ [0, 0, 0.5], up)
    one, two = at(p, (0.6, 0.4, 0.3), degrees), at(q, (1.2, 0.8, 0.7))
    one_, two_ = at(p, (0.6, 0.4, 0.3), degrees, turn), at(q, (1.2, 0.8, 0.7), 0.0, turn)
    for name in (*SIDEWAYS, "next_to"):
        assert says(name, one_, two_, turned, up) == pytest.approx(says(name, one, two), abs=1e-5)
    low = p[2] - 0.15
    assume(min(abs(low - h) for h in (q[2] - 0.35, q[2] - 0.336, q[2] + 0.28, q[2] + 0.35, q[2] + 0.42)) > 1e-3)
    assume(min(abs(p[2] - h) for h in (q[2], q[2] - 0.35)) > 1e-3)  # rounding may tip a box that just touches a limit
    for name in ("on", "above", "under", "inside"):
        # grid points on the very rim of the other box may fall either way: a row of 7 x 7, a slab of 5 x 5 x 5
        assert abs(says(name, one_, two_, turned, up) - says(name, one, two)) <= 0.2 + 1e-6


@given(things, things)
def test_distance_is_the_gap_either_way_round(a: Group, b: Group) -> None:
    assert distance(a.box, b.box) == pytest.approx(distance(b.box, a.box), abs=CLOSE)


@given(things, things)
def test_distance_against_a_dense_search(a: Group, b: Group) -> None:
    """Slow reference: many points of one box against the exact distance of a point to the other."""
    t = np.linspace(-0.5, 0.5, 15)
    grid = np.stack(np.meshgrid(t, t, t, indexing="ij"), axis=-1).reshape(-1, 3)
    points = np.array(a.box.center) + (grid * np.array(a.box.size)) @ np.array(a.box.axes)
    outside = np.maximum(np.abs(b.box.local(points)) - np.array(b.box.size) / 2, 0)
    reference = float(np.linalg.norm(outside, axis=1).min())
    step = float(np.linalg.norm(a.box.size)) / 14  # no point of the box is farther than this from the grid
    assert reference - step <= distance(a.box, b.box) + CLOSE
    assert distance(a.box, b.box) <= reference + CLOSE


# -- frames ----------------------------------------------------------------------------------------------------------


def test_a_viewer_sees_left_right_front_and_behind() -> None:
    sofa = at((0, 0, 0.4))
    west, east, south, north = at((-2, 0, 0.4)), at((2, 0, 0.4)), at((0, -2, 0.4)), at((0, 2, 0.4))
    assert says("left_of", west, sofa) == pytest.approx(1) and says("right_of", west, sofa) == 0
    assert says("right_of", east, sofa) == pytest.approx(1) and says("left_of", east, sofa) == 0
    assert says("in_front_of", south, sofa) == pytest.approx(1) and says("behind", south, sofa) == 0
    assert says("behind", north, sofa) == pytest.approx(1) and says("in_front_of", north, sofa) == 0
    assert says("left_of", north, sofa) == pytest.approx(0, abs=CLOSE)
    assert says("left_of", at((0, 0, 2)), sofa) == 0  # straight above is on no side


def test_left_ends_sixty_degrees_off_the_axis() -> None:
    sofa = at((0, 0, 0.4))
    for degrees, inside in ((0, True), (55, True), (65, False), (90, False)):
        r = math.radians(degrees)
        assert (says("left_of", at((-2 * math.cos(r), 2 * math.sin(r), 0.4)), sofa) >= HOLDS) == inside


@pytest.mark.parametrize("tilt", [0.0, 30.0, 89.0])
def test_looking_up_or_down_does_not_change_the_sides(tilt: float) -> None:
    r = math.radians(tilt)
    stand = viewer_stand(eye((0, -6, 6 * math.tan(r)), (0, 0, 0)), UP, 0.5)
    assert np.allclose(stand.right, [1, 0, 0], atol=CLOSE) and np.allclose(stand.forward, [0, 1, 0], atol=CLOSE)


def test_straight_down_the_image_decides() -> None:
    down = Camera.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0))  # the image's top is +y
    stand = viewer_stand(down, UP, 0.5)
    assert np.allclose(stand.right, [1, 0, 0], atol=CLOSE) and np.allclose(stand.forward, [0, 1, 0], atol=CLOSE)


@pytest.mark.parametrize("up", [(1.0, 0.0, 0.0), (-1.0, 0.0, 0.0)])
def test_a_camera_lying_on_its_side_still_looks_forward(up: Vec3) -> None:
    rolled = Camera.look_at((0, -6, 0), (0, 0, 0), up)
    stand = viewer_stand(rolled, UP, 0.5)
    assert np.allclose(stand.forward, [0, 1, 0], atol=CLOSE) and np.allclose(stand.right, [1, 0, 0], atol=CLOSE)


def test_an_objects_own_sides_do_not_depend_on_the_viewer() -> None:
    sofa, lamp, rug = at((0, 0, 0.4), (2, 0.8, 0.8)), at((-2, 0, 0.4)), at((0, -2, 0.4))
    for camera in (eye(), eye((0, 6, 1.6)), eye((6, 1, 1.6))):
        stand = object_stand(sofa, np.array([0.0, -1.0, 0.0]), viewer_stand(camera, UP, 0.5))
        # it faces -y; who sits on it has -x at the right hand
        assert score("right_of", lamp, [sofa], stand) == pytest.approx(1)
        assert score("left_of", lamp, [sofa], stand) == 0
        assert score("in_front_of", rug, [sofa], stand) == pytest.approx(1)
        assert score("behind", rug, [sofa], stand) == 0


def test_a_wall_is_where_it_is_nearest() -> None:
    sofa = at((3, 3, 0.4), (2, 0.9, 0.8))
    behind, beside = wall_at((0, 4, 1.25), (8, 0.1, 2.5)), wall_at((4.5, 0, 1.25), (0.1, 8, 2.5))
    assert holds("behind", behind, sofa) and not holds("behind", beside, sofa)
    assert holds("right_of", beside, sofa) and not holds("right_of", behind, sofa)
    assert holds("in_front_of", sofa, behind) and holds("left_of", sofa, beside)


def test_on_a_wall_is_what_hangs_there_not_what_stands_at_it() -> None:
    wall = wall_at((0, 4, 1.25), (8, 0.3, 2.5))
    picture, shelf = at((1, 3.9, 1.5), (0.6, 0.1, 0.5)), at((-1, 3.95, 1.0), (0.9, 0.3, 1.85))  # its foot 7 cm above
    assert holds("on", picture, wall) and not holds("on", shelf, wall)


def wall_at(center: Vec3, size: Vec3) -> Group:
    return replace(at(center, size), level="structure", label="wall")


# -- what people say -------------------------------------------------------------------------------------------------

TABLE = at((0, 0, 0.375), (1.6, 0.9, 0.75))
VASE = at((0.3, 0.1, 0.9), (0.2, 0.2, 0.3))
SHELF = at((3, 0, 1.0), (1.0, 0.35, 2.0))
BOOK = at((3, 0, 1.2), (0.2, 0.2, 0.3))
RUG = at((0, 0, 0.01), (2.5, 2.0, 0.02))
FLOOR = at((0, 0, 0.0), (8, 8, 0.02))
BED = at((-3, 0, 0.3), (1.6, 2.0, 0.6))
LAMP = at((0, 0, 2.4), (0.4, 0.4, 0.3))


def test_a_vase_on_a_table() -> None:
    assert holds("on", VASE, TABLE) and not holds("on", TABLE, VASE)
    assert holds("above", VASE, TABLE) and not holds("above", TABLE, VASE)
    assert holds("under", TABLE, VASE) and not holds("under", VASE, TABLE)
    assert not holds("inside", VASE, TABLE)


def test_on_needs_contact_and_above_does_not() -> None:
    assert not holds("on", LAMP, TABLE) and holds("above", LAMP, TABLE)
    assert not holds("on", at((1.5, 0, 0.9), (0.2, 0.2, 0.3)), TABLE)  # at that height, but beside it
    assert holds("on", at((0.85, 0, 0.9), (0.3, 0.2, 0.3)), TABLE) is False  # two thirds of it stick out
    assert holds("on", at((0.75, 0, 0.9), (0.3, 0.2, 0.3)), TABLE)  # a third does


def test_on_a_shelf_is_within_its_height() -> None:
    assert holds("on", BOOK, SHELF) and holds("inside", BOOK, SHELF)
    assert not holds("on", SHELF, BOOK)


def test_under_a_table() -> None:
    cat = at((0.2, 0, 0.15), (0.4, 0.2, 0.3))
    assert holds("under", cat, TABLE) and holds("below", cat, TABLE) and not holds("on", cat, TABLE)
    assert holds("under", RUG, TABLE)
    assert not holds("under", at((2.0, 0, 0.15), (0.4, 0.2, 0.3)), TABLE)


@pytest.mark.parametrize("thing", [TABLE, BED, SHELF, RUG], ids=["table", "bed", "shelf", "rug"])
def test_furniture_is_on_the_floor_but_what_it_carries_is_not(thing: Group) -> None:
    assert holds("on", thing, FLOOR)
    assert not holds("on", VASE, FLOOR) and not holds("on", LAMP, FLOOR)


def test_a_table_on_a_rug() -> None:
    assert holds("on", TABLE, RUG)  # its feet are at the rug's underside: a rug is thinner than a box is precise
    assert not holds("on", RUG, TABLE)


def test_inside_a_box() -> None:
    crate, ball = at((0, 3, 0.5), (1, 1, 1)), at((0.1, 3, 0.4), (0.3, 0.3, 0.3))
    assert holds("inside", ball, crate) and not holds("inside", crate, ball)
    assert not holds("inside", at((0.9, 3, 0.4), (0.3, 0.3, 0.3)), crate)


def test_next_to_is_a_matter_of_the_gap() -> None:
    chair = at((1.2, 0, 0.45), (0.5, 0.5, 0.9))
    assert holds("next_to", chair, TABLE) and holds("next_to", TABLE, chair)
    assert not holds("next_to", BED, SHELF)
    near, far = at((1.3, 0, 0.4)), at((2.3, 0, 0.4))
    assert says("next_to", near, TABLE) > says("next_to", far, TABLE)
    assert says("next_to", at((1.05, 0, 0.4)), TABLE) == pytest.approx(1)


def test_small_things_beside_long_ones_touch_them_either_way_round() -> None:
    wall, clock = at((0, 4, 1.25), (8, 0.1, 2.5)), at((1.0, 3.9, 1.7), (0.3, 0.1, 0.3))
    assert distance(wall.box, clock.box) == pytest.approx(0, abs=CLOSE)
    assert holds("next_to", clock, wall) and holds("next_to", wall, clock)


def test_crossing_boxes_have_no_gap_though_no_corner_is_inside() -> None:
    long, wide = at((0.3, 0.2, 0), (4, 0.2, 0.2)), at((0, 0, 0), (0.2, 4, 0.2), 10.0)
    assert distance(long.box, wide.box) == 0


def test_between() -> None:
    assert holds("between", at((1.7, 0, 0.2)), TABLE, SHELF) and holds("between", at((1.7, 0, 0.2)), SHELF, TABLE)
    assert not holds("between", at((1.7, 3, 0.2)), TABLE, SHELF)
    assert not holds("between", at((4.5, 0, 0.2)), TABLE, SHELF)
    assert not holds("between", TABLE, TABLE, SHELF)
    assert not holds("between", at((1, 1, 1)), TABLE, TABLE)


def test_an_unknown_relation_is_our_own_mistake() -> None:
    with pytest.raises(ValueError, match="entangled_with"):
        says("entangled_with", VASE, TABLE)

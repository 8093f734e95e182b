"""The checker of graphs: right about rooms whose faults are known, and the same however the room is turned."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from scenewright.gaussians.world.box import overlap
from scenewright.gaussians.world.person import ARM, SHOULDERS
from scenewright.planners.rooms.check import Report, check
from scenewright.planners.rooms.graph import SceneGraph
from scenewright.planners.rooms.node import Node, RoomShape, Viewpoint

WRITTEN = Path(__file__).parent / "written"
ROOMS = sorted(p.stem for p in WRITTEN.glob("*.json"))


def node(id: int | str, label: str, size: tuple[float, float, float], x: float, y: float, **more: object) -> Node:
    """A thing that stands on the floor unless `z` (of its underside) and `support` say otherwise."""
    bottom = float(more.pop("z", 0.0))  # type: ignore[arg-type]
    return Node.model_validate(
        {"id": id, "label": label, "size": size, "position": (x, y, bottom + size[2] / 2), **more}
    )


def room(*nodes: Node, relations: tuple[tuple[int | str, str, int | str], ...] = ()) -> SceneGraph:
    return SceneGraph(room=RoomShape(size=(5.0, 4.0, 2.5)), nodes=nodes, relations=relations)


def kinds(report: Report) -> list[tuple[str, tuple[int | str, ...]]]:
    return [(v.kind, v.ids) for v in report.violations]


TABLE = node(1, "table", (1.2, 0.8, 0.75), 0.0, 0.0)


@pytest.mark.parametrize("name", ROOMS)
def test_the_written_rooms_are_sound(name: str) -> None:
    report = check(SceneGraph.read(WRITTEN / f"{name}.json"))
    assert report.ok, report.violations


def test_a_collision_tells_how_deep() -> None:
    report = check(room(TABLE, node(2, "chair", (0.5, 0.5, 0.9), 0.8, 0.0)))
    assert kinds(report) == [("collision", (1, 2))]
    assert report.violations[0].measured == pytest.approx(0.05)
    assert "chair (2)" in report.violations[0].sentence and "0.05 m" in report.violations[0].sentence


@pytest.mark.parametrize(
    ("upper", "wrong"),
    [
        (node(2, "vase", (0.2, 0.2, 0.3), 0.3, 0.0, z=0.75, support=1), False),
        (node(2, "vase", (0.2, 0.2, 0.3), 0.3, 0.0, z=0.40, support=1), False),  # on a shelf below the top
        (node(2, "vase", (0.2, 0.2, 0.3), 0.3, 0.0, z=0.80, support=1), True),
        (node(2, "vase", (0.2, 0.2, 0.3), 0.7, 0.0, z=0.75, support=1), True),
        (node(2, "vase", (0.2, 0.2, 0.3), 2.0, 1.5, z=0.75, support="floor"), True),
        (node(2, "picture", (0.6, 0.04, 0.4), 0.0, 1.97, z=1.4, support="wall"), False),
        (node(2, "picture", (0.6, 0.04, 0.4), 0.0, 1.50, z=1.4, support="wall"), True),
        (node(2, "lamp", (0.3, 0.3, 0.5), 0.0, 1.0, z=2.0, support="ceiling"), False),
        (node(2, "lamp", (0.3, 0.3, 0.5), 0.0, 1.0, z=1.8, support="ceiling"), True),
    ],
)
def test_support(upper: Node, wrong: bool) -> None:
    found = kinds(check(room(TABLE, upper)))
    assert (("support" in {k for k, _ in found}) == wrong) and {k for k, _ in found} <= {"support"}, found


def test_two_things_do_not_carry_each_other() -> None:
    box = node(2, "box", (0.4, 0.4, 0.4), 0.0, 0.0, z=0.75, support=1)
    assert ("support", (1, 2)) in kinds(check(room(TABLE.model_copy(update={"support": 2}), box)))


def test_bounds_tell_how_far_and_where() -> None:
    (found,) = check(room(node(1, "sofa", (2.0, 0.9, 0.8), 1.8, 0.0))).violations
    assert (found.kind, found.measured) == ("bounds", pytest.approx(0.3))
    assert "right of the room" in found.sentence


def test_a_rug_is_stood_upon() -> None:
    rug = node(2, "rug", (2.0, 1.5, 0.02), 0.0, 0.0)
    assert check(room(TABLE, rug)).ok
    assert check(room(TABLE.model_copy(update={"position": (0.0, 0.0, 0.395)}), rug)).ok


@pytest.mark.parametrize(
    ("name", "holds"), [("right of", True), ("left_of", False), ("next to", True), ("beside", True), ("above", False)]
)
def test_stated_relations(name: str, holds: bool) -> None:
    chair = node(2, "chair", (0.5, 0.5, 0.9), 1.2, 0.0)
    found = kinds(check(room(TABLE, chair, relations=((2, name, 1),))))
    assert found == ([] if holds else [("relation", (2, 1))])


def test_facing_is_measured_and_the_unknown_is_told() -> None:
    away = node(2, "chair", (0.5, 0.5, 0.9), 0.0, -1.2)  # its front is toward -y, the table is behind it
    report = check(room(TABLE, away, relations=((2, "faces", 1), (2, "adores", 1))))
    assert kinds(report) == [("relation", (2, 1))]
    assert report.violations[0].measured == pytest.approx(180.0)
    assert len(report.unchecked) == 1 and "adores" in report.unchecked[0]
    turned = away.model_copy(update={"yaw": 180.0})
    assert check(room(TABLE, turned, relations=((2, "faces", 1),))).ok


def test_what_is_walled_in_cannot_be_walked_up_to() -> None:
    shelf = node(1, "bookshelf", (0.4, 4.0, 2.0), 0.5, 0.0)  # from the front to the back of the room
    lamp = node(2, "lamp", (0.3, 0.3, 1.5), 2.3, 0.0)
    found = check(room(shelf, lamp)).violations
    assert [(v.kind, v.ids) for v in found] == [("reach", (2,))]
    assert found[0].measured > SHOULDERS / 2 + ARM
    gap = shelf.model_copy(update={"size": (0.4, 3.4, 2.0), "position": (0.5, -0.3, 1.0)})
    assert check(room(gap, lamp)).ok  # 0.6 m are left to pass


def test_a_door_that_does_not_open_is_told() -> None:
    door = node(1, "door", (0.9, 0.05, 2.0), 0.0, -1.98, support="wall")
    assert check(room(door, TABLE.model_copy(update={"id": 2}))).ok
    crate = node(2, "crate", (4.9, 2.5, 1.0), 0.0, -0.7)
    assert ("reach", (1,)) in kinds(check(room(door, crate)))


def test_nobody_fits_into_a_closet() -> None:
    closet = SceneGraph(room=RoomShape(size=(0.4, 0.4, 2.0)), nodes=(node(1, "broom", (0.1, 0.1, 1.2), 0.0, 0.0),))
    (found,) = check(closet).violations
    assert (found.kind, found.measured) == ("reach", -1.0)


def test_an_empty_room_is_sound() -> None:
    assert check(room()).ok


# ---- laws ----------------------------------------------------------------------------------------------------------

boxes = st.builds(
    lambda w, d, h, x, y, z, yaw: Node(id=1, label="box", size=(w, d, h), position=(x, y, z), yaw=yaw),
    *[st.floats(0.2, 2.0)] * 3,
    *[st.floats(-1.5, 1.5)] * 3,
    st.floats(-179, 179),
)
TIES = 1e-6  # metres; a touch in one order of additions is a hair of overlap in another


def inside(points: np.ndarray, thing: Node) -> np.ndarray:
    """Which points `[M, 3]` lie in a box: the slow and plain way."""
    x, y, z = (points - np.array(thing.position)).T
    turn = math.radians(thing.yaw)
    along, across = x * math.cos(turn) + y * math.sin(turn), y * math.cos(turn) - x * math.sin(turn)
    w, d, h = thing.size
    return (abs(along) < w / 2) & (abs(across) < d / 2) & (abs(z) < h / 2)  # boxes that touch do not meet


def lattice(thing: Node, steps: int = 25) -> np.ndarray:
    t = np.linspace(-0.5, 0.5, steps)
    grid = np.stack(np.meshgrid(t, t, t, indexing="ij"), axis=-1).reshape(-1, 3)
    return np.array(thing.box.center) + (grid * np.array(thing.box.size)) @ np.array(thing.box.axes)


@given(boxes, boxes)
def test_separating_axes_agree_with_samples(a: Node, b: Node) -> None:
    depth = overlap(a.box, b.box)
    met = inside(lattice(a), b).any() or inside(lattice(b), a).any()
    if met:
        assert depth > 0
    # Between two of 25 samples a box of 2 m has 0.08 m; what is deeper in each other than that in every direction and
    # is no sliver across a corner holds a sample.
    if depth > 0.25:
        assert met


@given(boxes, boxes)
def test_a_push_of_the_measured_depth_separates(a: Node, b: Node) -> None:
    depth = overlap(a.box, b.box)
    assume(depth > 0)
    axes = [np.array(v) for v in (*a.box.axes[:2], *b.box.axes[:2], (0.0, 0.0, 1.0))]
    away = np.array(a.position) - np.array(b.position)

    def pushed(axis: np.ndarray, far: float) -> float:
        to = np.array(a.position) + axis * far * (1 if away @ axis >= 0 else -1)
        return overlap(a.model_copy(update={"position": tuple(to.tolist())}).box, b.box)

    assert min(pushed(axis, depth + TIES) for axis in axes) == 0
    assert all(pushed(axis, 0.99 * depth) > 0 for axis in axes)


def turned(graph: SceneGraph, quarters: int, mirrored: bool) -> SceneGraph:
    """The whole room, viewer and all, turned by quarter turns about its centre and perhaps seen in a mirror (x)."""
    flip = -1.0 if mirrored else 1.0
    c, s = [(1, 0), (0, 1), (-1, 0), (0, -1)][quarters % 4]

    def at(p: tuple[float, float, float]) -> tuple[float, float, float]:
        x, y = flip * p[0], p[1]
        return (c * x - s * y, s * x + c * y, p[2])

    w, d, h = graph.room.size
    size = (d, w, h) if quarters % 2 else (w, d, h)
    nodes = []
    for n in graph.nodes:
        yaw = (flip * n.yaw + 90 * quarters + 180) % 360 - 180
        nodes.append(n.model_copy(update={"position": at(n.position), "yaw": yaw}))
    eye = Viewpoint(position=at((0.0, -9.0, 1.6)), target=at((0.0, 0.0, 1.6)))
    return SceneGraph(room=RoomShape(size=size), nodes=tuple(nodes), relations=graph.relations, viewer=eye)


things = st.lists(
    st.tuples(
        st.floats(0.3, 1.6), st.floats(0.3, 1.0), st.floats(0.2, 2.0), st.floats(-2.4, 2.4), st.floats(-1.9, 1.9),
        st.floats(-170, 170),
    ),
    min_size=1,
    max_size=6,
)  # fmt: skip


@given(things, st.integers(0, 3), st.booleans())
@example([(1.0, 0.5, 1.0, 2.2, 0.0, 45.0)], 1, True)
def test_turning_or_mirroring_the_whole_room_changes_nothing(
    told: list[tuple[float, float, float, float, float, float]], quarters: int, mirrored: bool
) -> None:
    nodes = tuple(node(i, "box", (w, d, h), x, y, yaw=yaw) for i, (w, d, h, x, y, yaw) in enumerate(told))
    stated = ((0, "next to", 1),) if len(nodes) > 1 else ()
    before, after = (
        check(room(*nodes, relations=stated)),
        check(turned(room(*nodes, relations=stated), quarters, mirrored)),
    )

    def measured(report: Report) -> list[tuple[str, tuple[int | str, ...], float]]:
        # A measurement may end up on the other side of its limit by rounding alone.
        return sorted((v.kind, v.ids, round(v.measured, 6)) for v in report.violations)

    close = [v.measured for r in (before, after) for v in r.violations]
    assume(all(abs(m - limit) > TIES for m in close for limit in (0.01, 0.1, 0.5)))
    found, other = measured(before), measured(after)
    assert [f[:2] for f in found] == [o[:2] for o in other]
    # A cell of the grid on either side of a limit by rounding moves the way by one cell, 0.05 m.
    assert all(abs(f[2] - o[2]) <= (0.06 if f[0] == "reach" else 1e-4) for f, o in zip(found, other, strict=True))

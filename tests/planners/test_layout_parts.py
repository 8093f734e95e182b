"""The parts of the layout solver against the slow and neutral ones: overlaps, the walkable grid, relations."""

from __future__ import annotations

import numpy as np
import pytest
from amounts import some
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from scenewright.gaussians.world.box import YawBox, overlap, plan_gap, plan_penetration
from scenewright.gaussians.world.person import SHOULDERS
from scenewright.gaussians.world.relations import KINDS, names
from scenewright.planners.layout.lattice import Lattice, blocked, in_disc
from scenewright.planners.layout.measures import measure
from scenewright.planners.layout.walkable_grid import WalkableGrid
from scenewright.planners.rooms.check import check
from scenewright.planners.rooms.graph import SceneGraph
from scenewright.planners.rooms.node import Node, RoomShape
from scenewright.planners.rooms.reachability import unreached

SIZE = (6.0, 5.0, 2.5)
sides = st.floats(0.1, 2.0)
yaws = st.one_of(st.sampled_from([0.0, 90.0, 180.0, -90.0]), st.floats(-179.0, 180.0))
ulp = 1e-5  # metres; two ways to compute one distance


@st.composite
def spots(draw: st.DrawFn, turns: st.SearchStrategy[float] = yaws, on_floor: bool = False) -> YawBox:
    low = 0.0 if on_floor else draw(st.sampled_from([0.0, 0.4, 1.2]))
    x, y = draw(st.floats(-2.0, 2.0)), draw(st.floats(-1.5, 1.5))
    return YawBox(x, y, low, w=draw(sides), d=draw(sides), h=draw(sides), yaw=draw(turns))


def node(id: str, spot: YawBox, support: str = "floor") -> Node:
    size = (spot.w, spot.d, spot.h)
    middle = (spot.x, spot.y, spot.low + spot.h / 2)
    return Node(id=id, label=id, size=size, position=middle, yaw=spot.yaw, support=support)  # type: ignore[arg-type]


def graph(*nodes: Node, relations: tuple[tuple[str, str, str], ...] = ()) -> SceneGraph:
    return SceneGraph(room=RoomShape(size=SIZE), nodes=nodes, relations=relations)


@settings(max_examples=some(60), deadline=None)
@given(spots(), st.lists(spots(), min_size=1, max_size=3), yaws)
def test_forbidden_middles_are_those_at_which_boxes_are_in_each_other(
    one: YawBox, others: list[YawBox], frame: float
) -> None:
    lattice = Lattice(np.linspace(-2.5, 2.5, 9), np.linspace(-2.0, 2.0, 7), one.yaw)
    taken = np.zeros((9, 7), bool)
    blocked(lattice, one._replace(x=0.0, y=0.0), others, taken)
    for i, x in enumerate(lattice.xs):
        for j, y in enumerate(lattice.ys):
            here = node("a", one._replace(x=float(x), y=float(y))).box
            deep = max(overlap(here, node("b", other).box) for other in others)
            if deep == 0.0 or deep > ulp:
                assert taken[i, j] == (deep > 0.0)


@settings(max_examples=some(60), deadline=None)
@given(spots(), st.floats(0.1, 2.0))
def test_a_disc_is_reached_into_where_a_point_of_the_box_is_in_it(one: YawBox, radius: float) -> None:
    lattice = Lattice(np.linspace(-3, 3, 7), np.linspace(-3, 3, 7), one.yaw)
    found = in_disc(lattice, one._replace(x=0.0, y=0.0), 0.3, -0.2, radius)
    for i, x in enumerate(lattice.xs):
        for j, y in enumerate(lattice.ys):
            u, v = one._replace(x=float(x), y=float(y)).local(0.3, -0.2)
            inside = np.hypot(u - np.clip(u, -one.w / 2, one.w / 2), v - np.clip(v, -one.d / 2, one.d / 2))
            assert found[i, j] == (inside < radius) or abs(inside - radius) < ulp


@settings(max_examples=some(80), deadline=None)
@given(spots(), spots())
def test_gaps_are_symmetric_and_tell_overlaps(one: YawBox, other: YawBox) -> None:
    assert float(plan_gap(one, other)) == pytest.approx(float(plan_gap(other, one)), abs=ulp)
    if float(plan_gap(one, other)) > ulp:
        assert float(plan_penetration(one, other)) <= ulp


@settings(max_examples=some(60), deadline=None)
@given(st.lists(spots(on_floor=True), min_size=1, max_size=5))
def test_the_walkable_grid_finds_what_the_checker_finds(things: list[YawBox]) -> None:
    grid = WalkableGrid((SIZE[0], SIZE[1]), SHOULDERS)
    for k, spot in enumerate(things):
        grid.put(f"t{k}", spot, required=spot.high > 0.05)
    scene = graph(*(node(f"t{k}", spot) for k, spot in enumerate(things)))
    assert grid.unreached() == {n.id for n, _ in unreached(scene)}


def test_what_is_taken_away_leaves_no_trace() -> None:
    grid = WalkableGrid((SIZE[0], SIZE[1]), SHOULDERS)
    before = grid.taken.copy()
    grid.put("a", YawBox(0.5, 0.5, 0.0, 1.0, 2.0, 1.0, 30.0), required=True)
    assert (grid.taken != before).any()
    grid.take("a")
    assert (grid.taken == before).all() and not grid.unreached()


@settings(max_examples=some(150), deadline=None)
@given(
    spots(st.sampled_from([0.0, 90.0, 180.0, -90.0])),
    spots(st.sampled_from([0.0, 90.0, 180.0, -90.0])),
    st.sampled_from(names("stated")),
)
def test_what_is_measured_as_kept_is_kept_by_the_checkers_word(one: YawBox, other: YawBox, name: str) -> None:
    kept, _ = measure(name, SIZE, one, [other], [])
    assume(bool(kept))
    report = check(graph(node("a", one), node("b", other), relations=(("a", name, "b"),)))
    assert "relation" not in {v.kind for v in report.violations}


@given(st.sampled_from([k.name for k in KINDS if k.used("wish") and k.anchors == 1]), spots(), spots())
def test_many_places_at_once_are_measured_as_each_alone(name: str, one: YawBox, other: YawBox) -> None:
    xs, ys = np.linspace(-2, 2, 5), np.linspace(-1.5, 1.5, 5)
    kept, cost = measure(name, SIZE, one._replace(x=xs, y=ys), [other], [])
    for k in range(5):
        alone, price = measure(name, SIZE, one._replace(x=xs[k], y=ys[k]), [other], [])
        assert bool(np.broadcast_to(kept, 5)[k]) == bool(alone)
        assert float(np.broadcast_to(cost, 5)[k]) == pytest.approx(float(price))


def test_wishes_of_the_room() -> None:
    box = YawBox(0.0, 0.0, 0.0, 1.0, 0.5, 0.0, 1.0)
    at = {
        "against_wall": (box._replace(y=SIZE[1] / 2 - 0.25), box),
        "in_corner": (box._replace(x=SIZE[0] / 2 - 0.5, y=SIZE[1] / 2 - 0.25), box._replace(y=SIZE[1] / 2 - 0.25)),
        "in_center": (box, box._replace(x=2.0)),
    }
    for name, (good, bad) in at.items():
        assert measure(name, SIZE, good, [], [])[0] and not measure(name, SIZE, bad, [], [])[0], name
    window = YawBox(0.0, 2.45, 0.0, 1.0, 0.1, 1.0, 2.0)
    assert measure("at_window", SIZE, box._replace(y=2.0), [], [window])[0]
    assert not measure("at_window", SIZE, box, [], [window])[0] and not measure("at_window", SIZE, box, [], [])[0]
    a, b = box._replace(x=-2.0), box._replace(x=2.0)
    assert (
        measure("between", SIZE, box, [a, b], [])[0]
        and not measure("between", SIZE, box._replace(y=2.0), [a, b], [])[0]
    )

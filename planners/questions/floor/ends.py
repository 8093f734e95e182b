"""The ends of ways as cells of the floor, and ways told in words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ....gaussians.world.relation_geometry import Stand
from ..answer import Answer, Evidence, Line
from ..candidates import meant
from ..reading.ends import Place
from ..reading.situation import Situation
from ..survey import NotResolved, Survey, Thing, listed
from .routes import End, Point2, Route, to_node, to_point

NEAR = 0.8  # metres from a leg: things that it passes by
_STRAIGHT, _SHARP = 25.0, 120.0  # degrees between legs: less is straight on, more is a sharp turn


class Spot:
    """An end of a way with its words and the things that it is about."""

    def __init__(self, words: str, end: End, things: tuple[Thing, ...] = ()) -> None:
        self.words, self.end, self.things = words, end, things


def spots(place: Place | None, survey: Survey, situation: Situation | None = None) -> tuple[Spot, ...]:
    """What an end may mean: one for each thing that a phrase may mean; without a place, where the person is.

    Raises:
        NotResolved: the thing is absent.
    """
    floor = survey.floor
    if place is not None and place.query is not None:
        return tuple(_at(t, survey) for t in meant(place.query, survey))
    if place is not None and place.spot == "middle":
        return (Spot("the middle of the room", to_point(floor, 0.0, 0.0)),)
    if situation is not None and situation.at is not None:
        return tuple(_at(t, survey) for t in meant(situation.at, survey))
    eye = survey.stand.eye
    return (Spot("where you stand", to_point(floor, float(eye[0]), float(eye[1]))),)


def entrances(survey: Survey) -> tuple[Spot, ...]:
    """The doors; without one the largest free part of the floor."""
    doors = [survey.thing(d.id) for d in survey.floor.doors]
    if doors:
        return tuple(_at(t, survey) for t in doors)
    x, y, _ = survey.floor.most_open()
    return (Spot("the open floor", to_point(survey.floor, x, y)),)


def _at(thing: Thing, survey: Survey) -> Spot:
    if thing.node is not None:
        return Spot(survey.named(thing), to_node(survey.floor, thing.node), (thing,))
    if thing.label == "wall":
        return Spot("the wall", _at_wall(thing, survey), (thing,))
    x, y, _ = thing.group.box.center
    return Spot(survey.named(thing), to_point(survey.floor, x, y), (thing,))


def _at_wall(wall: Thing, survey: Survey) -> End:
    """Cells next to a wall, as far as one can get."""
    floor = survey.floor

    def cells(width: float) -> np.ndarray:
        points = np.argwhere(floor.walkable(width))
        if not len(points):
            return points
        world = np.stack([floor.xs[points[:, 0]], floor.ys[points[:, 1]], np.zeros(len(points))], axis=1)
        gap = (np.abs(wall.group.box.local(world)) - np.array(wall.group.box.size) / 2)[:, :2].max(axis=1)
        return np.asarray(points[gap <= max(float(gap.min()) + 2 * floor.cell, width / 2)])

    return cells


def all_pairs(starts: Sequence[Spot], goals: Sequence[Spot]) -> list[tuple[str, Spot, Spot]]:
    """Every start with every goal, with the words that tell them apart."""
    cases = []
    for a in starts:
        for b in goals:
            said = [s.words for s, several in ((a, starts), (b, goals)) if len(several) > 1]
            cases.append((" to ".join(said), a, b))
    return cases


def absent(error: NotResolved, survey: Survey) -> Answer:
    """The "no" of a yes/no question about a thing that is not there."""
    near = [survey.named(t) for t in error.found.near]
    told = f" The nearest to that: {listed(near)}." if near else ""
    said = error.query.describe().removeprefix("the ").removeprefix("every ").removeprefix("any ")
    ids = tuple(t.id for t in error.found.near)
    return Answer(answer="no", answer_type="yesno", text=f"There is no {said} here.{told}", confidence=0.9,
                  evidence=Evidence(ids=ids))  # fmt: skip


def place_words(x: float, y: float, survey: Survey) -> str:
    """Where a point of the floor is in the room, as the viewer sees it: "in the back left part of the room"."""
    width, depth, _ = survey.graph.room.size
    stand = survey.stand
    right = float(stand.right[0] * x + stand.right[1] * y)
    ahead = float(stand.forward[0] * x + stand.forward[1] * y)
    reach_x = abs(float(stand.right[0])) * width / 2 + abs(float(stand.right[1])) * depth / 2
    reach_y = abs(float(stand.forward[0])) * width / 2 + abs(float(stand.forward[1])) * depth / 2
    across, along = right / max(reach_x, 1e-9), ahead / max(reach_y, 1e-9)
    deep = "back" if along > 1 / 3 else "front" if along < -1 / 3 else ""
    side = "right" if across > 1 / 3 else "left" if across < -1 / 3 else ""
    if not deep and not side:
        return "in the middle of the room"
    return f"in the {' '.join(w for w in (deep, side) if w)} part of the room"


def lines(found: Route) -> tuple[Line, ...]:
    """The legs of a way on the floor."""
    return tuple(
        Line(start=(*a, 0.02), end=(*b, 0.02), label=f"{math.dist(a, b):.2f} m") for a, b in pairwise(found.points)
    )


def directions(found: Route, start: Spot, goal: Spot, survey: Survey) -> str:
    """A way in words, with the walls as the viewer names them: "walk 1.8 m toward the back wall; then ..."."""
    if found.length < 0.3:
        return f"{goal.words} is right beside {start.words}."
    told: list[str] = []
    before: float | None = None
    apart = {t.id for t in (*start.things, *goal.things)}
    for a, b in _merged(found.points):
        bearing = math.degrees(math.atan2(b[1] - a[1], b[0] - a[0]))
        said = f"walk {math.dist(a, b):.1f} m"
        if before is None:
            said += f" {_heading(a, b, survey.stand)}"
        else:
            said = f"{_turn(bearing - before)} and {said}"
        if passed := _passed(a, b, survey, apart):
            said += f", past {listed(passed)}"
        told.append(said)
        before = bearing
    return f"From {start.words}, {'; then '.join(told)}, to {goal.words}."


def _merged(points: Sequence[Point2]) -> list[tuple[Point2, Point2]]:
    """The legs, those that go nearly straight on or are shorter than a step joined with the one before."""
    kept = [points[0]]
    for before, here, after in zip(points, points[1:], points[2:], strict=False):
        turn = math.atan2(after[1] - here[1], after[0] - here[0]) - math.atan2(here[1] - before[1], here[0] - before[0])
        if abs((math.degrees(turn) + 180) % 360 - 180) > _STRAIGHT and math.dist(kept[-1], here) > 0.4:
            kept.append(here)
    return list(pairwise([*kept, points[-1]]))


def _heading(a: Point2, b: Point2, stand: Stand) -> str:
    way = np.array([b[0] - a[0], b[1] - a[1], 0.0])
    sides = {"right": stand.right, "left": -stand.right, "back": stand.forward, "front": -stand.forward}
    name = max(sides, key=lambda s: float(way @ sides[s]))
    return f"toward the {name} wall"


def _turn(degrees: float) -> str:
    off = (degrees + 180) % 360 - 180
    side = "left" if off > 0 else "right"
    if abs(off) <= _STRAIGHT:
        return "go on"
    if abs(off) < 60:
        return f"bear {side}"
    return f"turn {'sharp ' if abs(off) > _SHARP else ''}{side}"


def _passed(a: Point2, b: Point2, survey: Survey, apart: set[int | str]) -> list[str]:
    """Names of at most two larger things that a leg passes by, the nearest first."""
    t = np.linspace(0.15, 0.85, 12)
    x, y = a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])
    found = []
    for thing in survey.things:
        node = thing.node
        if node is None or node.support != "floor" or node.size[2] < 0.3 or thing.id in apart or not thing.label:
            continue
        gap = float(np.min(node.yaw_box.distance_to(x, y)))
        if gap <= NEAR:
            found.append((gap, survey.named(thing)))
    return [name for _, name in sorted(found)[:2]]

"""Where a person stands and looks: the viewer's own place, a stated situation, or the frame of a thing.

Plan coordinates are x and y of the graph's frame, metres; bearings are degrees clockwise from straight ahead, in
(-180, 180]: 90 is on the right, -90 on the left.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...gaussians.world import kinds
from ...gaussians.world.person import HEADROOM
from ...gaussians.world.support import SHELL, is_stepped_on
from .candidates import meant
from .reading.side_phrases import Side
from .reading.situation import Situation
from .room_places import middle
from .survey import Survey, Thing

F64 = NDArray[np.float64]

BEFORE = 0.4  # metres between a standing or seated person's middle and what the person is at
SEAT_REACH = 0.5  # largest gap in metres between a seat and the table that it belongs to
_DISTANCES = (0.4, 0.7, 1.0, 1.3, 1.6)  # metres from what a person faces or has at the back, if nothing else is said
_BESIDE = 75.0  # degrees off a side up to which what a person says to be there may lie
_TURNED = 60.0  # degrees between a seat's front and the table that it belongs to
STEP = 0.5  # metres between the places that are tried where the place is not said
MOST = 48  # views that one situation may leave


@dataclass(frozen=True, eq=False)
class View:
    """A place and a direction of gaze.

    Attributes:
        eye: `[2]` in plan.
        forward: `[2]` unit vector.
        words: for an answer's frame.
        name: which of several possible readings it is, "" if there is only one.
        stated: whether a situation or an object gives it; the viewer's own looks into the room from outside.
    """

    eye: F64
    forward: F64
    words: str
    name: str = ""
    stated: bool = True

    def bearing(self, point: F64) -> float:
        """Of a point `[2]` in plan."""
        way = point - self.eye
        right = np.array([self.forward[1], -self.forward[0]])
        return math.degrees(math.atan2(float(way @ right), float(way @ self.forward)))

    def to(self, thing: Thing) -> float:
        """Bearing of a thing: of its centre, of a wall's nearest point."""
        return self.bearing(self.target(thing))

    def target(self, thing: Thing) -> F64:
        """`[2]` the point of a thing that counts."""
        if thing.label not in SHELL:
            return middle(thing)
        box = thing.group.box
        local = box.local(np.array([[*self.eye, box.center[2]]]))[0]
        half = np.array(box.size) / 2
        near: F64 = (np.array(box.center) + np.clip(local, -half, half) @ np.array(box.axes))[:2]
        return near

    def across(self, thing: Thing) -> float:
        """Metres by which a thing lies to the right of the line of sight."""
        right = np.array([self.forward[1], -self.forward[0]])
        return float((self.target(thing) - self.eye) @ right)

    def along(self, thing: Thing) -> float:
        """Metres by which a thing lies ahead."""
        return float((self.target(thing) - self.eye) @ self.forward)


def off(bearing: float, side: Side) -> float:
    """Degrees between a bearing and a side, in [0, 180]."""
    return abs((bearing - side.at + 180.0) % 360.0 - 180.0)


def side_of(bearing: float) -> str:
    """The side that a bearing is nearest to: "in front", "right", "behind" or "left"."""
    return ("in front", "right", "behind", "left")[round((bearing % 360.0) / 90.0) % 4]


def viewer(survey: Survey) -> View:
    """The view of the person who looks at the scene."""
    stand = survey.stand
    return View(stand.eye[:2].copy(), _unit(stand.forward[:2]), "viewer", stated=False)


def is_inside(view: View, survey: Survey) -> bool:
    """Whether a view's eye is within the room, so that things may lie behind it."""
    width, depth, _ = survey.graph.room.size
    return bool(abs(view.eye[0]) < width / 2 and abs(view.eye[1]) < depth / 2)


def front(thing: Thing, survey: Survey) -> F64 | None:
    """`[2]` unit vector out of a thing's front, None if it has none that is known."""
    if thing.node is None:
        return None
    if thing.node.support == "wall":
        return inward(thing, survey)
    return np.array(thing.node.yaw_box.front) if survey.has_front(thing) else None


def inward(thing: Thing, survey: Survey) -> F64:
    """`[2]` unit vector from the wall that a thing is nearest to into the room."""
    x, y = middle(thing)
    width, depth, _ = survey.graph.room.size
    gaps = {(1.0, 0.0): x + width / 2, (-1.0, 0.0): width / 2 - x,
            (0.0, 1.0): y + depth / 2, (0.0, -1.0): depth / 2 - y}  # fmt: skip
    return np.array(min(gaps, key=lambda way: gaps[way]))


def of_object(thing: Thing, survey: Survey) -> View | None:
    """A thing's own frame: its left is that of who sits on it or stands with the back to it; None without a front."""
    way = front(thing, survey)
    return None if way is None else View(middle(thing), way, f"{survey.named(thing)}'s own")


_NEARER = 0.6  # share of the distance to the next thing up to which somebody faces the nearer one


def views(situation: Situation, survey: Survey) -> tuple[View, ...]:
    """Every view that fits a situation; none if no place fits what is said to lie beside the person.

    Raises:
        NotResolved: a thing of the situation is absent.
    """
    places = meant(situation.at, survey) if situation.at is not None else ()
    targets = meant(situation.facing, survey) if situation.facing is not None else ()
    found: list[View] = []
    for place in _thinned(places) or (None,):
        for target in _faced(place, targets) or (None,):
            if place is not None and target is not None and place.row == target.row and situation.pose == "on":
                target = None
            name = ", ".join([survey.named(t) for t in (place, target) if t is not None])
            many = len(places) > 1 or len(targets) > 1
            made = _views_at(situation, place, target, survey)
            found.extend(replace(v, words=situation.words, name=name if many else "") for v in made)
    for query, side in situation.beside:
        beside = meant(query, survey)
        found = [
            v
            for v in found
            if any(
                off(v.to(t), side) <= max(side.reach, _BESIDE * (side.reach == 60.0)) and not _is_at(v, t)
                for t in beside
            )
        ]
    step = max(1, math.ceil(len(found) / MOST))
    return tuple(found[::step])


def _thinned(places: Sequence[Thing]) -> Sequence[Thing]:
    return places[:8]


def _faced(place: Thing | None, targets: Sequence[Thing]) -> Sequence[Thing]:
    """What somebody at a place may face: of several things the one that is clearly nearer than the others."""
    if place is None or len(targets) < 2:
        return targets
    ranked = sorted(targets, key=lambda t: float(np.linalg.norm(middle(t) - middle(place))))
    near, next_one = (float(np.linalg.norm(middle(t) - middle(place))) for t in ranked[:2])
    return ranked[:1] if near < _NEARER * next_one else targets


def _is_at(view: View, thing: Thing) -> bool:
    return float(np.linalg.norm(view.eye - middle(thing))) < 1e-6


def _views_at(situation: Situation, place: Thing | None, target: Thing | None, survey: Survey) -> Iterator[View]:
    """The views at one place with one target of the gaze."""
    stands = list(_stands(situation, place, target, survey))
    free = place is not None and situation.pose == "at" and not _at_wall(place, survey)
    if free and place is not None and target is not None and target.row != place.row and len(stands) > 1:
        stands = [(middle(place), None)]  # its middle stands for the places around it
    for eye, forward in stands:
        way = forward
        if target is not None:
            toward = View(eye, np.array([0.0, 1.0]), "").target(target) - eye
            if float(np.linalg.norm(toward)) < 1e-6:
                continue
            way = _unit(toward)
            if target.label == "wall" or (target.node is not None and target.node.support == "wall"):
                way = -inward(target, survey) if situation.pose == "somewhere" else way
            if situation.gaze == "away":
                way = -way
        elif situation.gaze in ("in", "out") and place is not None and situation.pose in ("at", "front", "enter"):
            way = inward(place, survey) * (1.0 if situation.gaze == "in" else -1.0)
        if way is not None:
            yield View(eye, way, situation.words)


def _stands(
    situation: Situation, place: Thing | None, target: Thing | None, survey: Survey
) -> Iterator[tuple[F64, F64 | None]]:
    """Places of the person, each with the direction of gaze unless another is said."""
    if situation.pose == "middle":
        yield np.zeros(2), viewer(survey).forward
    elif place is None:
        yield from ((eye, None) for eye in _places_before(situation, target, survey))
    elif situation.pose in ("on", "own") or (situation.seated and seats(place)):
        way = front(place, survey)
        if situation.pose == "own":
            yield (middle(place), way)
        else:
            yield middle(place), way if way is not None else viewer(survey).forward
    elif situation.seated and (chairs := _seats_at(place, survey)):
        for chair in chairs:
            yield middle(chair), _unit(_nearest_point(place, middle(chair)) - middle(chair))
    else:
        yield from _before(situation, place, survey)


def _places_before(situation: Situation, target: Thing | None, survey: Survey) -> Iterator[F64]:
    """Free places of a person of whom only the gaze is said: before the front of what is faced, or anywhere."""
    way = front(target, survey) if target is not None else None
    if way is None or target is None or situation.beside:
        yield from _free_places(survey)
        return
    line = [middle(target) + way * (_half(target, way) + d) for d in _DISTANCES]
    yield from [eye for eye in line if _is_free(eye, survey, 0.0)] or line[:1]


def _before(situation: Situation, place: Thing, survey: Survey) -> Iterator[tuple[F64, F64 | None]]:
    """Standing at, before or behind a thing, or coming in through it."""
    way = front(place, survey)
    if way is None and _at_wall(place, survey):
        way = inward(place, survey)
    reach = _half(place, way) + BEFORE if way is not None else 0.0
    if situation.pose == "enter" and way is not None:
        yield middle(place) + way * _half(place, way), way
    elif situation.pose == "behind" and way is not None:
        yield middle(place) - way * reach, way
    elif way is not None and (situation.pose == "front" or _at_wall(place, survey)):
        kind = kinds.of(place.label)
        inside = kind is not None and kind.name == "door"
        yield middle(place) + way * reach, way if inside and situation.pose == "at" else -way
    else:
        ways = [np.array([math.cos(t), math.sin(t)]) for t in np.arange(8) * math.pi / 4]
        places = [middle(place) + w * (_half(place, w) + BEFORE) for w in ways]
        free = [eye for eye in places if _is_free(eye, survey, 0.0)] or places
        for eye in free:
            yield eye, _unit(middle(place) - eye)


def seats(thing: Thing) -> bool:
    """Whether people sit or lie on it."""
    kind = kinds.of(thing.label)
    return kind is not None and (kind.seats > 0 or "bed" in (kind.name, kind.like))


def _seats_at(table: Thing, survey: Survey) -> list[Thing]:
    """The seats that stand at a table; those that are turned to it where there are some, else the nearest."""
    near = [t for t in survey.things if t.row != table.row and survey.gap(t, table) <= SEAT_REACH]
    near = [t for t in near if (k := kinds.of(t.label)) is not None and k.seats > 0]
    turned = []
    for t in near:
        way = front(t, survey)
        if way is not None and abs(View(middle(t), way, "").bearing(_nearest_point(table, middle(t)))) <= _TURNED:
            turned.append(t)
    return turned or sorted(near, key=lambda t: survey.gap(t, table))[:1]


def _at_wall(thing: Thing, survey: Survey) -> bool:
    if thing.label == "wall" or (thing.node is not None and thing.node.support == "wall"):
        return True
    way = inward(thing, survey)
    width, depth, _ = survey.graph.room.size
    edge = abs(float(way @ np.array([width, depth]))) / 2 + float(middle(thing) @ way)
    return edge - _half(thing, way) < 0.15


def _half(thing: Thing, way: F64) -> float:
    return thing.group.box.extent(np.array([*way, 0.0])) / 2


def _nearest_point(thing: Thing, point: F64) -> F64:
    """`[2]` the point of a footprint that is nearest to a point; its centre if the point is within."""
    box = thing.group.box
    local = box.local(np.array([[*point, box.center[2]]]))[0]
    half = np.array(box.size) / 2
    clipped = np.clip(local, -half, half)
    if np.allclose(clipped[:2], local[:2]):
        return middle(thing)
    near: F64 = (np.array(box.center) + clipped @ np.array(box.axes))[:2]
    return near


def _free_places(survey: Survey) -> Iterator[F64]:
    width, depth, _ = survey.graph.room.size
    step = max(STEP, width / 12, depth / 12)
    for y in np.arange(-depth / 2 + step / 2, depth / 2, step):
        for x in np.arange(-width / 2 + step / 2, width / 2, step):
            eye = np.array([x, y])
            if _is_free(eye, survey, 0.15):
                yield eye


def _is_free(eye: F64, survey: Survey, margin: float) -> bool:
    width, depth, _ = survey.graph.room.size
    if abs(eye[0]) > width / 2 or abs(eye[1]) > depth / 2:
        return False
    for t in survey.things:
        if t.node is None or t.node.bottom > HEADROOM or is_stepped_on(t.node.support, t.node.size[2]):
            continue
        if t.node.support == "wall":
            continue
        if t.node.yaw_box.distance_to(eye[0], eye[1]) <= margin:
            return False
    return True


def _unit(way: F64) -> F64:
    return np.asarray(way / max(float(np.linalg.norm(way)), 1e-12))


def view_of(situation: Situation | None, survey: Survey) -> tuple[View, ...]:
    """The views of a stated situation, or the viewer's own if none is stated."""
    return (viewer(survey),) if situation is None else views(situation, survey)

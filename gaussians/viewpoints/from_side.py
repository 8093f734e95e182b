"""A camera that shows things from one side, or what is seen from a thing: the views that people ask for in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from ..errors import InstructionError
from ..language.field.group_index import index_groups
from ..language.field.language_field import Group
from ..world import kinds
from ..world.box import Box
from ..world.facing import facing_in
from ..world.person import SEATED_EYES
from ..world.relation_geometry import Stand, object_stand, viewer_stand
from .cutaway import NOTHING, Cut, toward_inside, wall_between
from .for_groups import HEIGHT, WIDTH, ChosenView, Sights, measured
from .view_candidates import (
    CLEARANCE,
    CLOSE_FOV,
    STANDS,
    View,
    filling_distance,
    fitted_camera,
    photograph_eyes,
    side_camera,
)

F64 = NDArray[np.float64]
Side = Literal["front", "behind", "left", "right", "above", "below"]
Whose = Literal["object", "viewer"]

AIMS = {"front": (0.0, -1.0), "behind": (0.0, 1.0), "left": (-1.0, 0.0), "right": (1.0, 0.0)}  # as `Stand.side`
TURNS = (0.0, 15.0, -15.0, 30.0, -30.0, 45.0, -45.0)  # degrees from the side that is asked for
ELEVATIONS = (14.0, 32.0, 50.0)  # degrees above the horizon
MOST_TURNED = 30.0  # degrees between the side that is asked for and a photograph that is taken for it
STEEP = (80.0, 65.0)  # degrees, for views from above
UPWARD = (-15.0, -35.0)  # degrees, for views from below
OTHER_SIDES = (75.0, -75.0, 110.0, -110.0, 180.0)  # turns that are tried too where no side is asked for
SEAT_SHARE = 1.2  # of a seat's height above its underside: seated eyes, where the scale is unknown
LEAST = 0.6  # readability from which a view is taken without trying further ones
TURN_COSTS = 200.0  # degrees of deviation that cost as much as all of the readability
FAR, CLOSE = 2.2, 0.75  # of the distance at which the things fill the image
PERSON_FOV = 65.0  # degrees, vertical, of what one sees
STEPS_OUT = 30  # steps of half a voxel that an eye is moved out of the thing it looks from


@dataclass(frozen=True, eq=False)
class SideView:
    """A view that was asked for by its side.

    Attributes:
        chosen: the view and how much of the things it shows.
        whose: whose left, right, front and behind: the thing's own, or the viewer's.
        turned: degrees between the side that was asked for and the one that was found free.
    """

    chosen: ChosenView
    whose: Whose
    turned: float = 0.0


def stand_of(sights: Sights, groups: Sequence[int], viewer: Camera) -> tuple[Stand, Whose]:
    """The frame in which sides of things are meant: of one thing with a front its own, else the viewer's."""
    scene, field = sights.scene, sights.scene.language
    assert field is not None
    seen = viewer_stand(viewer, scene.frame.up_vector, field.typical_size, field.middle)
    if len(groups) != 1:
        return seen, "viewer"
    front = front_of(sights, groups[0])
    return (seen, "viewer") if front is None else (object_stand(field.groups[groups[0]], front, seen), "object")


def front_of(sights: Sights, group: int) -> F64 | None:
    """The level unit vector `[3]` out of a thing's front, world; None if it has none that can be measured."""
    field = sights.scene.language
    assert field is not None
    rows = index_groups(sights.scene.cloud).rows(field.leaves(group))
    return facing_in(field, sights.scene.cloud, rows, field.groups[group]).front


def view_from_side(
    sights: Sights, groups: Sequence[int], side: Side | None, viewer: Camera, *,
    distance: float = 1.0, eye_level: bool = False, size: tuple[int, int] = (WIDTH, HEIGHT),
) -> SideView:  # fmt: skip
    """The view of things from one side, as near to it as there is room and nothing hides them.

    Args:
        groups: at least one.
        side: None takes the side that shows them best, their front first.
        viewer: whose left, right, front and behind are meant where the things have no front of their own.
        distance: of that at which the things fill the image.
        eye_level: at the height of a standing person's eyes.
        size: of the view, pixels.

    Raises:
        UserError: the scene has no such group.
        InstructionError: the things are visible from nowhere on that side.
    """
    groups = sights.asked(groups)
    stand, whose = stand_of(sights, groups, viewer)
    best: SideView | None = None
    most = 0.0
    toward = stand.side(AIMS[side if side in AIMS else "front"])
    for camera, turned, cut in _side_cameras(_Asked(sights, groups, side, toward, distance, eye_level, size)):
        name = f"{side or 'close'}:{','.join(map(str, groups))}"
        chosen = measured(sights, View(name, "close-up", replace(camera, name=name), cut), groups)
        worth = _worth(chosen) - turned / TURN_COSTS
        if best is None or worth > most + 1e-9:
            best, most = SideView(chosen, whose, turned), worth
        if _worth(best.chosen) >= LEAST:
            break
    if best is None or not any(best.chosen.shares.values()):
        where = f"from {'below' if side == 'below' else 'that side' if side else 'any side'}"
        raise InstructionError(f"it cannot be seen {where}: something stands in the way; ask for another side")
    return best


def view_from_thing(
    sights: Sights, group: int, toward: Sequence[int] = (), size: tuple[int, int] = (WIDTH, HEIGHT)
) -> SideView:
    """What one sees from a thing: sitting on a seat, standing in a door, looking out of its front.

    Args:
        toward: groups that one looks at; empty looks out of the thing's front, or to the middle of the scene.
        size: of the view, pixels.

    Raises:
        UserError: the scene has no such group.
    """
    (group,) = sights.asked([group])
    scene, field = sights.scene, sights.scene.language
    assert field is not None
    thing, up = field.groups[group], scene.frame.up_vector
    targets = sights.asked(toward) if toward else ()
    front = front_of(sights, group)
    center = np.array(thing.box.center)
    aimed = np.mean([field.groups[g].box.center for g in targets], axis=0) if targets else sights.space.middle
    way = front if front is not None else _level(aimed - center, up)
    way = way if way is not None else scene.frame.basis()[0]
    eye = _eye_at(sights, thing, way)
    if targets:
        camera = fitted_camera(eye, [field.groups[g].box for g in targets], scene, size)
        if camera.fy > 0.5 * size[1] / np.tan(np.radians(PERSON_FOV) / 2):  # a person sees no less than this
            target = eye + camera.forward
            camera = Camera.look_at(eye, target, up, *size, PERSON_FOV)
    else:
        camera = Camera.look_at(eye, eye + way - 0.12 * up, up, *size, PERSON_FOV)
    name = f"from:{group}"
    view = View(name, "walk-in", replace(camera, name=name))
    chosen = measured(sights, view, targets or [group])
    if targets and group not in targets and _worth(chosen) < LEAST:  # one may sit with one's back to what one looks at
        without = measured(sights, replace(view, cut=Cut(frozenset({group}))), targets)
        chosen = without if _worth(without) > _worth(chosen) else chosen
    return SideView(chosen, "object" if front is not None else "viewer")


@dataclass(frozen=True, eq=False)
class _Asked:
    """What `view_from_side` is asked for; `toward` `[3]` is the level direction of the side, world."""

    sights: Sights
    groups: tuple[int, ...]
    side: Side | None
    toward: F64
    distance: float
    eye_level: bool
    size: tuple[int, int]

    @property
    def boxes(self) -> list[Box]:
        field = self.sights.scene.language
        assert field is not None
        return [field.groups[g].box for g in self.groups]

    @property
    def tilts(self) -> tuple[float, ...]:
        """Degrees above the horizon that are tried, the best first."""
        return STEEP if self.side == "above" else UPWARD if self.side == "below" else ELEVATIONS

    @property
    def level(self) -> bool:
        """Whether the view is from around the things, not from above or below."""
        return self.side not in ("above", "below")


def _side_cameras(asked: _Asked) -> Iterator[tuple[Camera, float, Cut]]:
    """Cameras with their deviation in degrees and what is cut away: photographs, free places, then from outside."""
    for camera, off in (*_from_photographs(asked), *_at_eye_level(asked)):
        yield camera, off, NOTHING
    for camera, off in _from_free_places(asked):
        yield camera, off, NOTHING
    for tilt in asked.tilts[:2]:
        camera = _from_outside(asked, tilt)
        yield camera, abs(tilt - asked.tilts[0]) / 2, toward_inside(asked.sights.scene, camera.position, asked.groups)


def _from_photographs(asked: _Asked) -> Iterator[tuple[Camera, float]]:
    """Close-ups from where photographs were taken, which show a capture at its best."""
    if len(asked.groups) > 1 or asked.distance != 1.0 or asked.eye_level or not asked.level:
        return
    scene, (box,) = asked.sights.scene, asked.boxes
    toward = asked.toward if asked.side is not None else None
    for eye, off in photograph_eyes(scene, box, toward, MOST_TURNED):
        yield fitted_camera(eye, [box], scene, asked.size), off


def _from_free_places(asked: _Asked) -> Iterator[tuple[Camera, float]]:
    """Close-ups from the side that is asked for and those near to it, then from where a person can stand."""
    scene, space, boxes = asked.sights.scene, asked.sights.space, asked.boxes
    turns = TURNS if asked.side is not None else (*TURNS, *OTHER_SIDES)
    first = asked.tilts[0]
    tried = [(abs(turn) + abs(tilt - first) / 2, i, tilt, turn) for tilt in asked.tilts for i, turn in enumerate(turns)]
    for off, _, tilt, turn in sorted(tried):
        way = _turned(asked.toward, scene.frame.up_vector, turn)
        camera = side_camera(scene, boxes, way, tilt, asked.size, space, asked.distance)
        if camera is not None:
            yield camera, off
    if asked.side is None:
        for eye in space.stands(STANDS, space.eye_height, _corners(boxes)[1]):
            yield fitted_camera(eye, boxes, scene, asked.size), OTHER_SIDES[0]


def _at_eye_level(asked: _Asked) -> Iterator[tuple[Camera, float]]:
    """Cameras at standing height on the side that is asked for, where there is room and a clear sight."""
    if not asked.eye_level or not asked.level:
        return
    scene, space = asked.sights.scene, asked.sights.space
    up = scene.frame.up_vector
    corners, center, radius = _corners(asked.boxes)
    for turn in TURNS if asked.side is not None else (*TURNS, *OTHER_SIDES):
        way = _turned(asked.toward, up, turn)
        away = asked.distance * filling_distance(corners - center, way, up, asked.size)
        for share in (1.0, 0.75, 0.5):
            eye = center + share * away * way
            eye = eye + up * (space.eye_height - eye @ up)
            clear = float(space.clearance(eye[None])[0]) >= CLEARANCE * space.step
            if clear and space.sees(eye, center, radius) and not wall_between(scene, eye, center):
                yield Camera.look_at(eye, center, up, *asked.size, CLOSE_FOV if share == 1.0 else PERSON_FOV), abs(turn)
                break


def _from_outside(asked: _Asked, tilt: float) -> Camera:
    """The camera on the side that is asked for, `tilt` degrees above the horizon, whatever is there."""
    up = asked.sights.scene.frame.up_vector
    corners, center, _ = _corners(asked.boxes)
    e = np.radians(tilt)
    toward = np.cos(e) * asked.toward + np.sin(e) * up
    away = max(asked.distance, 1.0) * filling_distance(corners - center, toward, up, asked.size)
    return Camera.look_at(center + away * toward, center, up, *asked.size, CLOSE_FOV)


def _corners(boxes: Sequence[Box]) -> tuple[F64, F64, float]:
    """Corners `[P, 3]` of boxes, their middle `[3]` and the radius around it that holds them, world."""
    corners = np.concatenate([box.corners() for box in boxes])
    center: F64 = (corners.min(axis=0) + corners.max(axis=0)) / 2
    return corners, center, max(float(np.linalg.norm(corners - center, axis=1).max()), 1e-6)


def _eye_at(sights: Sights, thing: Group, way: F64) -> F64:
    """Eyes `[3]` of a person at a thing, moved along `way` out of it until they are free."""
    frame, space = sights.scene.frame, sights.space
    up, center = frame.up_vector, np.array(thing.box.center)
    kind = kinds.of(thing.label)
    scale = frame.metres_per_unit
    top = thing.box.top(up)
    if kind is not None and kind.seats:
        low = thing.box.bottom(up)
        height = space.floor + SEATED_EYES / scale if scale else low + SEAT_SHARE * (top - low)
        start = center
    else:
        height = float(np.clip(space.eye_height, thing.box.bottom(up), max(top, space.eye_height)))
        start = center + way * (thing.box.extent(way) / 2 + space.step)
    eye = start + up * (height - start @ up)
    for _ in range(STEPS_OUT):
        if float(space.clearance(eye[None])[0]) >= CLEARANCE * space.step:
            break
        eye = eye + 0.5 * space.step * way
    return np.asarray(eye)


def _worth(chosen: ChosenView) -> float:
    """Mean readability of what the view is asked to show."""
    return float(np.mean(list(chosen.readable.values()))) if chosen.readable else 0.0


def _level(way: F64, up: F64) -> F64 | None:
    """The level unit vector along `way` `[3]`; None if that is vertical."""
    flat = way - up * (way @ up)
    length = float(np.linalg.norm(flat))
    return flat / length if length > 1e-6 else None


def _turned(way: F64, up: F64, degrees: float) -> F64:
    """A level vector `[3]` turned about up."""
    a = np.radians(degrees)
    return np.asarray(np.cos(a) * way + np.sin(a) * np.cross(up, way))

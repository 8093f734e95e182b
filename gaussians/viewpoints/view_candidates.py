"""Candidate views of a scene: its own cameras, overviews from outside, views from where a person stands, close-ups."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from ..scene import Scene
from ..world.box import Box
from .coverage import fit_camera
from .cutaway import NOTHING, Cut, from_above, toward_inside, wall_between
from .free_space import FreeSpace
from .visibility import silhouettes

F64 = NDArray[np.float64]
Kind = Literal["camera", "overview", "walk-in", "close-up", "plan"]

OVERVIEW_ELEVATIONS = (32.0, 55.0)  # degrees above the horizon
OVERVIEW_FOV = 40.0  # degrees, vertical
CLOSE_FOV = 50.0
CLOSE_ELEVATIONS = (12.0, 38.0)
CLOSE_AZIMUTHS = 8  # sides that a close-up is taken from, relative to the thing's box
CLOSE_UPS_OF = 6  # most groups that close-ups are made of; more are shown by views of the whole
PER_PART, MOST_PARTS = 4, 8  # things in a part of the scene on average, and most parts
PART_AZIMUTHS = 4  # sides that a part is shown from
DISTANCES = (1.0, 1.7, 0.7, 2.6)  # of the distance at which a thing fills the image, until there is room and sight
NEAR_THING = 3.0  # voxels around the middle of a thing in which nothing is taken to hide it
FILLS = 0.65  # share of the image's height or width that a thing's box takes in a close-up
CLEARANCE = 1.5  # voxels between an eye and the nearest surface
PHOTOGRAPHS = 8  # cameras of a scene, from which they are taken for photographs that cover it
PHOTOGRAPHS_TRIED = 12  # photographs from whose position a close-up is tried
STANDS = 8  # places in free space
FOV_LIMITS = (20.0, 85.0)  # degrees, vertical, of views fitted to what they show
PLAN_FOV = 12.0  # degrees: so narrow that a view from above is nearly a plan
TALL = 0.95  # share of the image that a fitted view fills


@dataclass(frozen=True, eq=False)
class View:
    """A camera with what is cut away before it is rendered.

    Attributes:
        name: unique among the candidates of a scene: "overview 2", "close-up 12.3", or "camera 3" for the scene's own,
            counted from 0; `camera.name` holds what its file calls it.
        kind: how it was made.
        camera: pose, intrinsics and image size.
        cut: what is not drawn.
    """

    name: str
    kind: Kind
    camera: Camera
    cut: Cut = NOTHING


def candidate_views(
    scene: Scene, groups: Sequence[int], size: tuple[int, int], space: FreeSpace | None = None
) -> list[View]:
    """All candidates that may show `groups` (of the whole scene if empty), as images of `size` pixels."""
    space = space or FreeSpace.of(scene.cloud, scene.frame)
    found = own_views(scene, size) + overviews(scene, groups, size, space) + walk_ins(scene, groups, size, space)
    if 0 < len(groups) <= CLOSE_UPS_OF:
        for group in groups:
            found += close_ups(scene, group, size, space)
        return found
    return found + part_views(scene, groups, size, space)


def own_views(scene: Scene, size: tuple[int, int]) -> list[View]:
    """The cameras that came with the scene, whole in images of `size`."""
    return [View(f"camera {i}", "camera", fit_camera(camera, *size)) for i, camera in enumerate(scene.cameras)]


def overviews(scene: Scene, groups: Sequence[int], size: tuple[int, int], space: FreeSpace) -> list[View]:
    """Views of the whole from outside, above its corners, with ceiling and near walls cut away."""
    basis = scene.frame.basis()
    low, high = bounds(scene, groups, space)
    points = _corners(low, high) @ basis
    center, radius = (low + high) / 2, float(np.linalg.norm(high - low)) / 2 + 1e-6
    found: list[View] = []
    for elevation in OVERVIEW_ELEVATIONS:
        for k in range(4):
            a, e = np.radians(45.0 + 90.0 * k), np.radians(elevation)
            toward = np.array([np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)])
            camera = _framing(center @ basis, toward @ basis, points, scene, size, OVERVIEW_FOV, radius)
            name = f"overview {len(found) + 1}"
            cut = toward_inside(scene, camera.position, groups)
            found.append(View(name, "overview", replace(camera, name=name), cut))
    return found


def walk_ins(scene: Scene, groups: Sequence[int], size: tuple[int, int], space: FreeSpace) -> list[View]:
    """Views from free places at eye height: of `groups` if they fit into one, else in three directions each."""
    boxes = _boxes(scene, groups)
    near = np.mean([b.center for b in boxes], axis=0) if boxes else None
    eyes = space.stands(STANDS, space.eye_height, near)
    found = []
    for i, eye in enumerate(eyes, start=1):
        if boxes:
            cameras = [fitted_camera(eye, boxes, scene, size)]
        else:
            cameras = [_level_camera(eye, space.middle, turn, scene, size) for turn in (0.0, 65.0, -65.0)]
        for k, camera in enumerate(cameras):
            name = f"walk-in {i}" + (".abc"[k] if k else "")
            found.append(View(name, "walk-in", replace(camera, name=name)))
    return found


def close_ups(scene: Scene, group: int, size: tuple[int, int], space: FreeSpace) -> list[View]:
    """Views of one group from its sides, where there is room for a camera, and from where photographs were taken."""
    assert scene.language is not None
    box = scene.language.groups[group].box
    found: list[View] = []
    for elevation in CLOSE_ELEVATIONS:
        for k in range(CLOSE_AZIMUTHS):
            a = 2 * np.pi * k / CLOSE_AZIMUTHS
            side = np.cos(a) * np.array(box.axes[0]) + np.sin(a) * np.array(box.axes[1])
            camera = side_camera(scene, [box], side, elevation, size, space)
            if camera is not None:
                name = f"close-up {group}.{len(found) + 1}"
                found.append(View(name, "close-up", replace(camera, name=name)))
    for eye, _ in photograph_eyes(scene, box):
        name = f"close-up {group}.{len(found) + 1}"
        found.append(View(name, "camera", replace(fitted_camera(eye, [box], scene, size), name=name)))
    return found


def part_views(scene: Scene, groups: Sequence[int], size: tuple[int, int], space: FreeSpace) -> list[View]:
    """Views of parts of the scene, each with things that stand close together: small things are readable in them.

    The parts are those of `groups`, of all objects if empty.
    """
    assert scene.language is not None
    things = groups or [g.id for g in scene.language.objects() if g.count]
    boxes = _boxes(scene, things)
    if not boxes:
        return []
    basis = scene.frame.basis()
    found: list[View] = []
    for part in _parts(np.array([b.center for b in boxes]), -(-len(boxes) // PER_PART)):
        inside = [boxes[i] for i in part]
        for k in range(PART_AZIMUTHS):
            a = 2 * np.pi * (k + 0.5) / PART_AZIMUTHS
            side = np.cos(a) * basis[0] + np.sin(a) * basis[1]
            camera = side_camera(scene, inside, side, CLOSE_ELEVATIONS[1], size, space)
            if camera is not None:
                name = f"part {len(found) + 1}"
                found.append(View(name, "close-up", replace(camera, name=name)))
    return found


def _parts(points: F64, count: int) -> list[list[int]]:
    """Indices of points `[P, 3]` in at most `MOST_PARTS` groups around points far from each other (Gonzalez 1985)."""
    seeds = [int(np.argmax(np.linalg.norm(points - points.mean(axis=0), axis=1)))]
    distance = np.linalg.norm(points - points[seeds[0]], axis=1)
    while len(seeds) < min(count, MOST_PARTS) and distance.max() > 0:
        seeds.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.linalg.norm(points - points[seeds[-1]], axis=1))
    nearest = np.linalg.norm(points[:, None] - points[seeds], axis=2).argmin(axis=1)
    return [np.flatnonzero(nearest == k).tolist() for k in range(len(seeds))]


def is_photographed(scene: Scene) -> bool:
    """Whether the scene has so many cameras that they are taken for those of photographs that cover it."""
    return len(scene.cameras) >= PHOTOGRAPHS


def photograph_eyes(
    scene: Scene, box: Box, toward: F64 | None = None, within: float = 180.0
) -> list[tuple[F64, float]]:
    """Positions `[3]` of photographs that have a box before them, and how far they are from a side, degrees.

    Args:
        toward: `[3]` level direction from the box to the side that is asked for; None takes cameras on all sides.
        within: largest angle between that side and a camera, degrees.

    Returns:
        at most `PHOTOGRAPHS_TRIED`, those nearest to the side first; without a side those that show most of the box.
    """
    center, up = np.array(box.center), scene.frame.up_vector
    found: list[tuple[float, int, F64]] = []
    for i, camera in enumerate(scene.cameras if is_photographed(scene) else ()):
        pixels, depth = camera.project(center[None])
        if not camera.contains(pixels, depth)[0]:
            continue
        way = camera.position - center
        level = way - up * (way @ up)
        if toward is None:
            found.append((-float(silhouettes(camera, [box])[1][0]), i, camera.position))
            continue
        cosine = float(level @ toward) / max(float(np.linalg.norm(level) * np.linalg.norm(toward)), 1e-12)
        off = float(np.degrees(np.arccos(np.clip(cosine, -1, 1))))
        if off <= within:
            found.append((off, i, camera.position))
    best = sorted(found, key=lambda f: f[:2])[:PHOTOGRAPHS_TRIED]
    return [(eye, off if toward is not None else 0.0) for off, _, eye in best]


def side_camera(
    scene: Scene, boxes: Sequence[Box], side: F64, elevation: float, size: tuple[int, int], space: FreeSpace,
    far: float = 1.0,
) -> Camera | None:  # fmt: skip
    """The camera that shows boxes from one side, at `far` times the distance at which they fill the image.

    Where there is no room or no sight, other distances are tried, with the field of view that shows them as large.

    Args:
        side: `[3]` level direction from the boxes to the camera, world.
        elevation: degrees above the horizon.

    Returns:
        None if the eye would be inside something at every distance, or something hides the boxes from it.
    """
    corners = np.concatenate([box.corners() for box in boxes])
    center = (corners.min(axis=0) + corners.max(axis=0)) / 2
    radius = max(float(np.linalg.norm(corners - center, axis=1).max()), 1e-6)
    e = np.radians(elevation)
    toward = np.cos(e) * side / max(float(np.linalg.norm(side)), 1e-12) + np.sin(e) * scene.frame.up_vector
    fills = filling_distance(corners - center, toward, scene.frame.up_vector, size)
    reach = max(radius, NEAR_THING * space.step)  # what a small thing stands on does not hide it
    for share in DISTANCES:
        eye = center + far * share * fills * toward
        clear = float(space.clearance(eye[None])[0])
        if clear < CLEARANCE * space.step or not space.sees(eye, center, reach) or wall_between(scene, eye, center):
            continue
        fov = 2 * float(np.degrees(np.arctan(np.tan(np.radians(CLOSE_FOV) / 2) / share)))
        return Camera.look_at(eye, center, scene.frame.up, *size, float(np.clip(fov, *FOV_LIMITS)), "side")
    return None


def filling_distance(corners: F64, toward: F64, up: F64, size: tuple[int, int]) -> float:
    """How far away, in the direction `toward` `[3]`, a close-up's camera is whose image the corners fill.

    Args:
        corners: `[P, 3]` relative to the point that the camera looks at, world.
    """
    pose = Camera.look_at(toward, np.zeros(3), up, *size, CLOSE_FOV).world_to_camera[:3, :3]
    across, down, depth = np.abs(corners @ pose[0]), np.abs(corners @ pose[1]), corners @ pose[2]
    tangent = FILLS * np.tan(np.radians(CLOSE_FOV) / 2)
    # A corner at (x, y, z) before a camera at distance d is in the image if |x| <= tangent * (d + z), y likewise.
    needed = np.maximum(across / (tangent * size[0] / size[1]), down / tangent) - depth
    return max(float(needed.max()), 1e-6)


def fitted_camera(eye: F64, boxes: Sequence[Box], scene: Scene, size: tuple[int, int]) -> Camera:
    """The camera at `eye` `[3]` with the narrowest field of view that holds all boxes, within `FOV_LIMITS`."""
    corners = np.concatenate([box.corners() for box in boxes])
    ways = corners - eye
    ways /= np.maximum(np.linalg.norm(ways, axis=1, keepdims=True), 1e-9)
    middle = ways.mean(axis=0)
    if np.linalg.norm(middle) < 1e-6:
        middle = scene.frame.basis()[0]
    camera = Camera.look_at(eye, eye + middle, scene.frame.up, *size, 60.0, "fitted")
    local = ways @ camera.world_to_camera[:3, :3].T
    ahead = local[local[:, 2] > 0.05]
    if len(ahead) < len(local):
        return Camera.look_at(eye, eye + middle, scene.frame.up, *size, FOV_LIMITS[1], "fitted")
    aspect = size[0] / size[1]
    needed = max(
        float(np.abs(ahead[:, 1] / ahead[:, 2]).max()), float(np.abs(ahead[:, 0] / ahead[:, 2]).max()) / aspect
    )
    fov = float(np.clip(2 * np.degrees(np.arctan(needed / TALL * 1.15)), *FOV_LIMITS))
    return Camera.look_at(eye, eye + middle, scene.frame.up, *size, fov, "fitted")


def plan(scene: Scene, groups: Sequence[int], size: tuple[int, int], space: FreeSpace) -> View:
    """The view from above, nearly without perspective, north up: of the whole scene, with the ceiling cut away.

    `groups` are kept even where they are above the cut.
    """
    basis = scene.frame.basis()
    low, high = bounds(scene, groups, space)
    cut = from_above(scene, groups)
    top = min(float(high[2]), cut.above) if cut.above is not None else float(high[2])
    center = np.array([*(low + high)[:2] / 2, top])
    span = np.maximum(high - low, 1e-6)
    half = max(span[1], span[0] * size[1] / size[0]) / 2 / TALL
    eye = center + np.array([0, 0, half / np.tan(np.radians(PLAN_FOV) / 2)])
    camera = Camera.look_at(eye @ basis, center @ basis, basis[1], *size, PLAN_FOV, "plan")
    return View("plan", "plan", camera, cut)


def bounds(scene: Scene, groups: Sequence[int], space: FreeSpace) -> tuple[F64, F64]:
    """Lowest and highest corner `[3]` of what a view of the whole shows, in the frame's basis.

    These are the bounds of the free space, which leave out far floaters, widened to the boxes of `groups`.
    """
    boxes = _boxes(scene, groups)
    if not boxes:
        return space.low, space.high
    corners = np.concatenate([b.corners() for b in boxes]) @ scene.frame.basis().T
    return np.minimum(space.low, corners.min(axis=0)), np.maximum(space.high, corners.max(axis=0))


def _framing(
    center: F64, toward: F64, points: F64, scene: Scene, size: tuple[int, int], fov: float, radius: float
) -> Camera:
    """The nearest camera in the direction `toward` from `center` whose image holds all `points` `[P, 3]`, world."""
    low, high = 0.5 * radius, 6.0 * radius / np.tan(np.radians(fov) / 2)
    for _ in range(16):
        distance = (low + high) / 2
        camera = Camera.look_at(center + distance * toward, center, scene.frame.up, *size, fov, "overview")
        pixels, depth = camera.project(points)
        held = bool(camera.contains(pixels, depth).all())
        low, high = (low, distance) if held else (distance, high)
    return Camera.look_at(center + high * toward, center, scene.frame.up, *size, fov, "overview")


def _level_camera(eye: F64, middle: F64, turn: float, scene: Scene, size: tuple[int, int]) -> Camera:
    """A camera at `eye` toward the scene's middle, turned by degrees about up and tilted slightly down."""
    east, north, up = scene.frame.basis()
    gap = middle - eye
    azimuth = np.arctan2(gap @ north, gap @ east) + np.radians(turn)
    aim = np.cos(azimuth) * east + np.sin(azimuth) * north - 0.2 * up
    return Camera.look_at(eye, eye + aim, up, *size, 70.0, "walk-in")


def _boxes(scene: Scene, groups: Sequence[int]) -> list[Box]:
    assert scene.language is not None
    return [scene.language.groups[g].box for g in groups]


def _corners(low: F64, high: F64) -> F64:
    return np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])

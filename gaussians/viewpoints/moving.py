"""Moves a camera as a person asks for it: around what it looks at, nearer or farther, and turned on the spot.

Short names: `pivot [3]` world, the point that the middle of the picture shows; `up [3]` unit, world. Angles in degrees.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from ..render import render
from ..rotations import axis_rotation
from ..scene import Scene
from .coverage import fit_camera

F64 = NDArray[np.float64]

STEEPEST = 85.0  # degrees above the horizon, beyond which the picture would turn over
LOWEST = -60.0
_SIZE = 96, 64  # pixels of the pictures that are measured
_MIDDLE = 3  # the middle third of the picture, in each direction, shows the pivot
_OPAQUE = 0.4  # alpha from which a pixel shows something
_SHOWN = 0.25  # share of the middle that must show something
_CLEAR = 0.7  # share of the way to the pivot that must be free
_NEARER = (1.0, 0.75, 0.55, 0.4, 0.28, 0.2)  # shares of the distance that are tried until the way is free


def ahead(scene: Scene, camera: Camera) -> float | None:
    """Distance along the view to what the middle of the picture shows, scene units; None if it shows nothing."""
    width, height = _SIZE
    drawn = render(scene.cloud, fit_camera(camera, width, height))
    rows = slice(height // 2 - height // (2 * _MIDDLE), height // 2 + height // (2 * _MIDDLE))
    columns = slice(width // 2 - width // (2 * _MIDDLE), width // 2 + width // (2 * _MIDDLE))
    depth, alpha = drawn.depth[rows, columns], drawn.alpha[rows, columns]
    shown = depth[alpha > _OPAQUE]
    return float(shown.median()) if len(shown) >= _SHOWN * alpha.numel() else None


def pivot_of(scene: Scene, camera: Camera) -> F64:
    """The point that the middle of the picture shows; where it shows nothing, as far away as the scene's middle."""
    depth = ahead(scene, camera)
    if depth is None:
        middle = scene.cloud.means.median(dim=0).values.double().numpy() if len(scene.cloud) else camera.position
        depth = max(float((middle - camera.position) @ camera.forward), 0.0) or 1.0
    return np.asarray(camera.position + depth * camera.forward, dtype=np.float64)


def orbited(
    camera: Camera, pivot: F64, up: F64, *, azimuth: float = 0.0, elevation: float = 0.0, to: float | None = None
) -> Camera:
    """The camera moved around the pivot, at the same distance and looking at it.

    Args:
        azimuth: degrees about `up`, counter-clockwise seen from above.
        elevation: degrees up.
        to: the elevation above the horizon to go to instead, degrees.
    """
    offset = camera.position - pivot
    distance = float(np.linalg.norm(offset))
    level = offset - (offset @ up) * up
    if np.linalg.norm(level) < 1e-6 * distance:  # right above or below: the picture's bottom is towards the viewer
        level = np.cross(camera.right, up)
    level = axis_rotation(up, azimuth) @ (level / np.linalg.norm(level))
    now = np.degrees(np.arcsin(np.clip(offset @ up / distance, -1, 1))) + elevation
    height = np.radians(np.clip(now if to is None else to, LOWEST, STEEPEST))
    eye = pivot + distance * (np.cos(height) * level + np.sin(height) * up)
    return _looking(camera, eye, pivot, up)


def from_azimuth_of(camera: Camera, home: Camera, up: F64, turn: float) -> float:
    """Degrees that `camera` must orbit to see from the side of `home`, turned by `turn`."""
    return turn + _azimuth(-home.forward, up, home) - _azimuth(-camera.forward, up, camera)


def nearer(camera: Camera, pivot: F64, share: float) -> Camera:
    """The camera at `share` of its distance from the pivot."""
    return _moved(camera, pivot + share * (camera.position - pivot))


def turned(camera: Camera, up: F64, *, left: float = 0.0, upward: float = 0.0) -> Camera:
    """The camera turned on the spot; it stays level and never looks straight up or down."""
    pitch = float(np.degrees(np.arcsin(np.clip(camera.forward @ up, -1, 1))))
    goal = float(np.clip(pitch + upward, -STEEPEST, STEEPEST))
    level = camera.forward - (camera.forward @ up) * up
    if np.linalg.norm(level) < 1e-6:
        level = np.cross(up, camera.right)
    level = axis_rotation(up, left) @ (level / np.linalg.norm(level))
    aim = np.cos(np.radians(goal)) * level + np.sin(np.radians(goal)) * up
    return _looking(camera, camera.position, camera.position + aim, up)


def with_clear_sight(scene: Scene, camera: Camera, pivot: F64) -> tuple[Camera, bool]:
    """The camera, moved towards the pivot until nothing stands in the way; and whether its sight is clear."""
    distance = float(np.linalg.norm(pivot - camera.position))
    for share in _NEARER:
        tried = nearer(camera, pivot, share)
        depth = ahead(scene, tried)
        if depth is not None and depth >= _CLEAR * share * distance:
            return tried, True
    return camera, False


def facing_point(camera: Camera, point: F64, up: F64) -> Camera:
    """The camera turned on the spot so that `point` is in the middle of its picture."""
    return _looking(camera, camera.position, point, up)


def _azimuth(direction: F64, up: F64, camera: Camera) -> float:
    """The azimuth of a direction about `up`, degrees, from an axis that depends on `up` alone."""
    seed = np.eye(3)[int(np.argmin(np.abs(up)))]
    east = seed - (seed @ up) * up
    east /= np.linalg.norm(east)
    level = direction - (direction @ up) * up
    if np.linalg.norm(level) < 1e-6:
        level = np.cross(camera.right, up)
    return float(np.degrees(np.arctan2(level @ np.cross(up, east), level @ east)))


def _looking(camera: Camera, eye: F64, target: F64, up: F64) -> Camera:
    """The camera's image and lens at another pose."""
    pose = Camera.look_at(eye, target, up, camera.width, camera.height).world_to_camera
    return replace(camera, world_to_camera=pose, name="moved")


def _moved(camera: Camera, eye: F64) -> Camera:
    pose = np.array(camera.world_to_camera)
    pose[:3, 3] = -pose[:3, :3] @ eye
    return replace(camera, world_to_camera=pose, name="moved")

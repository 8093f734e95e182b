"""How the light of a scene falls on what carries a thing: an even sky that leans to one side, and a wide lamp.

The lamp is the one that lights new things (`form`), so a thing and its shadow agree. What the thing takes of both makes
the shadow: that of the sky is soft and dark at the contact, that of the lamp lies under a seat and beside a thing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...gaussians.scene import Scene
from ..filling.occlusion import SIDES, Blocked
from .shading import shading_of

F64 = NDArray[np.float64]
_LAMP = 0.6  # share of the lamp in the light on what carries a thing
_LEAN = 0.6  # largest share of the light that leans to the side from which most light comes
_WALL = 0.6  # likewise on walls, to above
_STRAIGHT = 0.1  # slope of light from above that is taken to be there at least
_LEANS = 1.5  # by how much the lamp stands lower than the slope tells, which is flattened by noise
_LOWEST = 0.75  # sine of the elevation that it has at least: what falls far beside a thing does not tie it to its place
_TOLD, _ASIDE = 0.06, 0.06  # slope along the ground that tells a side, and the one that is taken where none is told
_BEHIND = 0.4  # tangent of the angle by which that side lies behind the thing
_SOFT = 0.25  # tangent of half the angle that it fills


def lamp_of(up: F64, slope: F64) -> F64:
    """`[3]` unit (world) towards the lamp, which is never low, where the logarithm of brightness grows by `slope` with
    the normal."""
    way = np.asarray(slope, dtype=np.float64)
    if float(np.linalg.norm(way)) < 1e-9:
        return np.asarray(up)
    rise = max(float(way @ up), _STRAIGHT)
    way = _LEANS * (way - float(way @ up) * up) + rise * up
    way = way / max(float(np.linalg.norm(way)), 1e-12)
    rise = float(way @ up)
    if rise < _LOWEST:
        level = way - rise * up
        level = level / max(float(np.linalg.norm(level)), 1e-12)
        way = _LOWEST * up + np.sqrt(1 - _LOWEST**2) * level
    return np.asarray(way)


def slope_at(scene: Scene, point: F64) -> F64:
    """`[3]` (world) by which the logarithm of brightness grows with the normal, at a place.

    The shading of many captures tells no side from which they are lit. There the lamp stands to the left of who looks
    from where the photographs were taken, and a little behind the place, so that a shadow is seen.
    """
    slope, up = shading_of(scene).slope, scene.frame.up_vector
    along = slope - float(slope @ up) * up
    if float(np.linalg.norm(along)) >= _TOLD:
        return np.asarray(slope)
    if not scene.cameras:
        return np.asarray(slope - along)
    toward = np.mean([c.position for c in scene.cameras], axis=0) - point
    toward = toward - float(toward @ up) * up
    length = float(np.linalg.norm(toward))
    if length < 1e-9:
        return np.asarray(slope)
    side = np.cross(toward, up) / length - _BEHIND * toward / length
    return np.asarray(slope - along + _ASIDE * side / np.linalg.norm(side))


def taken(scene: Scene, shade: Blocked, level: bool) -> F64:
    """`[H, W]` the share of a scene's light that a thing takes from what carries it.

    Args:
        level: whether that is level, else it is a wall.
    """
    lean = np.zeros(SIDES)
    if not level:
        lean[1] = _WALL
        return np.asarray(np.tensordot(np.concatenate([[1 - _WALL], lean]), shade.shares, 1))
    plane = shade.chart.plane
    slope, axes = slope_at(scene, plane.origin), plane.axes
    along, up = axes[:2] @ slope, scene.frame.up_vector
    length = float(np.linalg.norm(along))
    share = min(_LEAN, length / (length + abs(float(slope @ up)) + _STRAIGHT))
    toward = along / max(length, 1e-12)
    lean = share * np.maximum(0.0, np.array([toward[0], toward[1], -toward[0], -toward[1]]))
    lean *= share / max(float(lean.sum()), 1e-12)
    sky = np.tensordot(np.concatenate([[1 - share], lean]), shade.shares, 1)
    # The share of the sky is kept whole, as the strength is measured by it: contacts stay dark on the side of the lamp.
    return np.asarray(1 - (1 - np.clip(sky, 0, 1)) * (1 - _LAMP * shade.from_lamp(axes @ lamp_of(up, slope), _SOFT)))

"""The light on each part of a new thing where it stands: sky, bounce from what carries it, lamp, and its own shade.

Assets come without light, as pigments. Irradiance is gathered along a few cones from each Gaussian through the thing's
own occupancy (cone tracing with one level, after Crassin et al., "Interactive indirect illumination using voxel cone
tracing", 2011). Cones that rise see an even sky, those that fall see the support, which the thing itself darkens near
its foot. A lamp from the scene's dominant direction is added, with its shadow on the thing. Display values follow
irradiance by the power law of a display.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...gaussians.assets.modeling.light import Occupancy, occupancy
from .falling import lamp_of

F64 = NDArray[np.float64]
GAMMA = 1 / 2.2  # display value over linear light
_ACROSS = 30  # cells of the occupancy grid along the longest side
_TILT, _SIDES = np.radians(58.0), 5  # cones beside that along the normal
_AHEAD = 0.25  # weight of the cone along the normal; those beside share the rest
_STEPS = (1.5, 2.6, 4.2, 6.8)  # cells along a cone
_THICK = 0.65  # how much of a cone a filled cell blocks
_OFF = 1.0  # cells from the surface at which cones begin
_HORIZON = 0.55  # radiance of the horizon, of that of the zenith
_LAMP_STEPS, _PAST = (1.0, 2.2, 3.8, 6.0, 9.0), 1.9  # cells along its rays, and from the surface at which they begin
_LAMP = 1.0  # irradiance of the lamp over that of an unblocked sky
_FOOT, _UNDER = 0.22, 0.8  # of a thing's extent: height in which the support is dark for it, and by how much
_DIM = 0.04  # irradiance, of that of a free level surface, that any part has at least


class Pigment(NamedTuple):
    """Display colours `[N, 3]` of an asset's Gaussians without light, and `[N]` which are lit from both sides."""

    rgb: F64
    two_sided: NDArray[np.bool_]
    drawn: bool = True  # whether the library chose them, else they are as the user's own asset has them


@dataclass(frozen=True, eq=False)
class Surround:
    """What lights a thing.

    Attributes:
        up: `[3]` unit.
        toward: `[3]` world, towards the lamp; its length does not matter.
        bounce: `[3]` display colour of what is below and around it, relative to the scene's white.
        foot: height along up of what it stands on; None if it hangs.
    """

    up: F64
    toward: F64
    bounce: F64
    foot: float | None


def form_light(points: F64, normals: F64, around: Surround) -> F64:
    """`[N, 3]` factor on the display colours of pigments, 1 on a free level surface that faces up.

    Args:
        points: `[N, 3]` world.
        normals: `[N, 3]` unit, outward.
    """
    space = occupancy(points, _ACROSS)
    lamp = lamp_of(np.asarray(around.up), np.asarray(around.toward))
    light = np.zeros((len(points), 3))
    extent = float(np.ptp(points, axis=0).max())
    height = np.full(len(points), np.inf) if around.foot is None else points @ around.up - around.foot
    below = 1 - _UNDER * np.exp(-np.maximum(height, 0) / max(_FOOT * extent, 1e-12))
    ground = np.asarray(around.bounce) ** (1 / GAMMA)
    for ways, weight in _cones(normals):
        open_ = _open(space, points + normals * (_OFF * space.step), ways, _STEPS)
        rise = ways @ around.up
        sky = np.where(rise > 0, _HORIZON + (1 - _HORIZON) * np.clip(rise, 0, 1), 0.0)
        # A cone is wide: near the horizon it sees some of both.
        fall = np.clip(0.5 - 1.2 * rise, 0, 1)
        seen = ((1 - fall) * np.maximum(sky, _HORIZON * (1 - fall)))[:, None] + (fall * below)[:, None] * ground
        light += (weight * open_)[:, None] * seen
    facing = np.clip(normals @ lamp, 0, None)
    shade = _open(space, points + normals * (_PAST * space.step), np.broadcast_to(lamp, points.shape), _LAMP_STEPS)
    light += (_LAMP * facing * shade)[:, None]
    free = _free(around, lamp)
    return np.asarray((np.maximum(light, _DIM * free) / free) ** GAMMA)


def _free(around: Surround, lamp: F64) -> float:
    """Irradiance of a level surface that faces up and nothing blocks."""
    side = _HORIZON + (1 - _HORIZON) * float(np.cos(_TILT))
    return _AHEAD + (1 - _AHEAD) * side + _LAMP * max(0.0, float(lamp @ around.up))


def _cones(normals: F64) -> list[tuple[F64, float]]:
    """Directions `[N, 3]` of the cones, and the weight of each."""
    helper = np.where(np.abs(normals[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]])
    first = np.cross(normals, helper)
    first /= np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-12)
    second = np.cross(normals, first)
    found = [(normals, _AHEAD)]
    for k in range(_SIDES):
        turn = 2 * np.pi * k / _SIDES
        way = np.cos(_TILT) * normals + np.sin(_TILT) * (np.cos(turn) * first + np.sin(turn) * second)
        found.append((way, (1 - _AHEAD) / _SIDES))
    return found


def _open(space: Occupancy, start: F64, ways: F64, steps: tuple[float, ...]) -> F64:
    """`[N]` share of light that comes along cones."""
    left = np.ones(len(start))
    for step in steps:
        left *= 1 - _THICK * np.clip(1.5 * space.at(start + ways * (step * space.step)) - 0.15, 0, 1)
    return left

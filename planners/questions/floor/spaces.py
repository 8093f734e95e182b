"""Whether a box of a given size fits somewhere: exact tests of candidate positions among the boxes that are there.

Among boxes with the same axes, a free place for another box exists only if there is one at which it touches a side of
a thing, or the edge, along both axes. So those positions are tried, and a lattice besides for turned boxes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....gaussians.world.box import YawBox, is_square, plan_penetration, shared_height

F64 = NDArray[np.float64]
Allowed = Callable[[YawBox], NDArray[np.bool_]]  # a box at many positions, to whether each is allowed

SLACK = 0.005  # metres that boxes may overlap: the precision of written sizes
_LATTICE = 0.1  # metres between the positions that are tried besides
_MOST = 160  # critical positions along an axis


@dataclass(frozen=True)
class Surface:
    """A level rectangle to stand on: the floor, or the top of a thing.

    Attributes:
        x, y, yaw: its middle and turn in the room.
        width, depth: its sides, metres.
        height: above the floor.
        ceiling: height up to which things may reach.
    """

    x: float
    y: float
    yaw: float
    width: float
    depth: float
    height: float
    ceiling: float

    def local(self, box: YawBox) -> YawBox:
        """A box of the room in the surface's own axes, which have their origin in its middle."""
        if not (self.x or self.y or self.yaw):
            return box
        u, v = YawBox(self.x, self.y, 0.0, 1.0, 1.0, 1.0, self.yaw).local(box.x, box.y)
        return box._replace(x=u, y=v, yaw=box.yaw - self.yaw)

    def world(self, box: YawBox) -> YawBox:
        """The inverse of `local`."""
        if not (self.x or self.y or self.yaw):
            return box
        x, y = YawBox(self.x, self.y, 0.0, 1.0, 1.0, 1.0, self.yaw).world(box.x, box.y)
        return box._replace(x=x, y=y, yaw=box.yaw + self.yaw)


def place(
    size: tuple[float, float, float], surface: Surface, obstacles: Sequence[YawBox], yaws: Sequence[float],
    allowed: Allowed | None = None,
) -> YawBox | None:  # fmt: skip
    """A free place for a box of this size on a surface, None if there is none.

    Args:
        size: width, depth and height of the box, metres.
        obstacles: boxes of the room that it must not meet.
        yaws: turns to try, degrees, in the room's axes.
        allowed: further conditions, in the room's axes.
    """
    if surface.height + size[2] > surface.ceiling + SLACK:
        return None
    around = [surface.local(o) for o in obstacles]
    for yaw in yaws:
        box = YawBox(0.0, 0.0, surface.height, *size, yaw - surface.yaw)
        near = [o for o in around if shared_height(box, o) > SLACK]
        found = _free(box, surface, near, allowed)
        if found is not None:
            return found
    return None


def _free(box: YawBox, surface: Surface, near: Sequence[YawBox], allowed: Allowed | None) -> YawBox | None:
    (hx, hy) = box.half
    if 2 * hx > surface.width + 2 * SLACK or 2 * hy > surface.depth + 2 * SLACK:
        return None
    turned = not is_square(box.yaw) or any(not is_square(o.yaw) for o in near)
    xs = _critical(surface.width / 2 - hx, [(o.x, o.half[0] + hx) for o in near], turned)
    ys = _critical(surface.depth / 2 - hy, [(o.y, o.half[1] + hy) for o in near], turned)
    x, y = (axis.ravel() for axis in np.meshgrid(xs, ys, indexing="ij"))
    if allowed is not None:
        keep = allowed(surface.world(box._replace(x=x, y=y)))
        x, y = x[keep], y[keep]
    for other in near:
        if not len(x):
            return None
        keep = np.asarray(plan_penetration(box._replace(x=x, y=y), other) <= SLACK)
        x, y = x[keep], y[keep]
    if not len(x):
        return None
    best = int(np.argmin(np.hypot(x, y)))
    return surface.world(box._replace(x=float(x[best]), y=float(y[best])))


def _critical(bound: float, others: Sequence[tuple[float, float]], turned: bool) -> F64:
    """Positions along one axis at which a box touches an edge or another box, and a lattice."""
    bound = max(bound, 0.0)
    touching = np.array([-bound, bound, *(m - r for m, r in others), *(m + r for m, r in others)])
    step = _LATTICE / 2 if turned else _LATTICE
    count = int(np.clip(2 * bound / step, 1, 120)) + 1
    touching = np.unique(np.round(touching[np.abs(touching) <= bound + SLACK], 6))
    if len(touching) > _MOST:
        touching = touching[:: len(touching) // _MOST + 1]
    return np.unique(np.concatenate([np.clip(touching, -bound, bound), np.linspace(-bound, bound, count)]))


def largest(
    size: tuple[float, float, float], fits: Callable[[tuple[float, float, float]], bool], sides: tuple[bool, bool],
    most: float = 1.0,
) -> float:  # fmt: skip
    """The factor on the marked sides (width, depth) up to which a box fits, between 0 and `most`, to 2 % of that."""

    def scaled(factor: float) -> tuple[float, float, float]:
        return (size[0] * (factor if sides[0] else 1.0), size[1] * (factor if sides[1] else 1.0), size[2])

    low, high = 0.0, most
    while high - low > 0.02 * most:
        middle = (low + high) / 2
        low, high = (middle, high) if fits(scaled(middle)) else (low, middle)
    return low

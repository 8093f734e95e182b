"""What a search for a spot must know of a scene: what is solid, how far the room reaches, what a thing stands on.

Knows the scene, the viewer, and what was placed before. Refuses to know placements (regions.py)
and to search for a spot (place.py).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.camera import Vec3
from ...gaussians.language.field.measure import OPAQUE, solid_points
from ...gaussians.scene import Frame, Scene
from ...gaussians.world.box import Axes, Box
from ..operation import Context
from .bodies import Array, Body, as_vec, centimetre, contact_box, mask_of_bodies
from .occupancy import Bool, obstacle_points

_LOW = 240.0  # centimetres, height of a low room
_SAMPLE = 50_000  # points on which extents of the room are measured
_FEW = 8  # points under a thing; fewer are floaters
_SHARE = 0.03  # of its height that a thing may be off its support: splats reach about that far beyond their centres
FLOOR_WORDS = frozenset({"floor", "ground", "carpet", "room"})


@dataclass(eq=False)
class Surroundings:
    """One scene for one viewer; what was placed before counts as taken once it is given to `take`.

    Attributes:
        scene: with everything in it that may be in the way.
        context: viewer and resolver.
        moving: `[N]` bool, Gaussians that are being moved and so are not in the way.
        moving_groups: their groups.
        back: `[3]` where the thing's back points, which "against a wall" then brings to the wall; None takes any side.
        lift: height above the floor of what hangs on a wall or from the ceiling, scene units.
    """

    scene: Scene
    context: Context
    moving: Tensor | None = None
    moving_groups: frozenset[int] = frozenset()
    back: Array | None = None
    lift: float = 0.0
    taken: list[Box] = field(default_factory=list)

    @cached_property
    def frame(self) -> Frame:
        return self.scene.frame

    @cached_property
    def up(self) -> Array:
        return self.frame.up_vector

    @cached_property
    def solid(self) -> NDArray[np.float32]:
        """`[M, 3]` world points one could bump into."""
        return obstacle_points(self.scene.cloud, self.moving)

    def take(self, points: Array, box: Box) -> None:
        """From now on these world points `[M, 3]` and this box are in the way, too."""
        self.solid = np.concatenate([self.solid, points.astype(np.float32)])
        self.taken.append(box)

    @cached_property
    def thin(self) -> NDArray[np.float32]:
        """An even sample of the solid points, for extents and middles."""
        return self.solid[:: max(1, len(self.solid) // _SAMPLE)]

    @cached_property
    def room_axes(self) -> Axes:
        """Level axes of the floor if the field knows it, else of the frame."""
        if self.scene.language is not None:
            floors = [g for g in self.scene.language.groups if g.level == "structure" and g.label in FLOOR_WORDS]
            if floors:
                return max(floors, key=lambda g: g.box.size[0] * g.box.size[1]).box.axes
        east, north, up = self.frame.basis()
        return as_vec(east), as_vec(north), as_vec(up)

    @cached_property
    def floor(self) -> float:
        """Height of the floor along up; where the frame has none, the lowest height that much of the scene lies at."""
        if self.frame.floor is not None:
            return self.frame.floor
        heights = self.thin @ self.up.astype(np.float32)
        if not len(heights):
            return 0.0
        low, high = np.quantile(heights, [0.005, 0.6])
        counts, edges = np.histogram(heights, bins=60, range=(float(low), float(high) + 1e-9))
        lowest = int(np.argmax(counts >= 0.5 * counts.max()))
        return float((edges[lowest] + edges[lowest + 1]) / 2)

    @cached_property
    def ceiling(self) -> float:
        """Height along up of the ceiling; where none is known that of the highest solid points, or of a low room."""
        field = self.scene.language
        tops = [g for g in field.groups if g.label == "ceiling" and g.level == "structure" and g.count] if field else []
        if tops:
            return min(float(np.array(g.box.center) @ self.up) - g.box.size[2] / 2 for g in tops)
        heights = self.thin @ self.up.astype(np.float32)
        highest = float(np.quantile(heights, 0.995)) if len(heights) else self.floor
        low = self.floor + _LOW * centimetre(self.frame, 1.0)
        return highest if self.frame.metres_per_unit is None else max(highest, low)

    def bounds_for(self, size: Vec3, plan: Array) -> tuple[Array, Array]:
        """Bounds, along the room's axes, of the centre of a footprint along `plan` that stays in the room."""
        low, high = self.room_bounds
        turn = np.abs(np.array(self.room_axes[:2]) @ plan.T)
        half = turn @ np.array(size[:2]) / 2
        low, high = low + half, high - half
        tight = low > high
        return np.where(tight, (low + high) / 2, low), np.where(tight, (low + high) / 2, high)

    @cached_property
    def room_bounds(self) -> tuple[Array, Array]:
        """Extent along the room's axes of what lies about floor height, stray points left out."""
        plan = np.array(self.room_axes[:2])
        heights = self.thin @ self.up.astype(np.float32)
        span = float(np.ptp(np.quantile(heights, [0.01, 0.99]))) if len(heights) else 1.0
        near = self.thin[np.abs(heights - self.floor) < 0.05 * span]
        points = (near if len(near) > 100 else self.thin) @ plan.T.astype(np.float32)
        if not len(points):
            return np.full(2, -1.0), np.full(2, 1.0)
        low, high = np.quantile(points, [0.004, 0.996], axis=0)
        return low.astype(np.float64), high.astype(np.float64)

    def base_under(self, anchor: Body, plan: Array) -> tuple[float, Array | None]:
        """What a thing stands on: the floor, or the surface just under it with its points."""
        bottom = anchor.box.bottom(self.up)
        tolerance = max(self.tolerance(anchor), 5 * centimetre(self.frame, max(anchor.box.size)))
        if abs(bottom - self.floor) <= tolerance and self.frame.floor is not None:
            return self.floor, None
        heights = self.solid @ self.up.astype(np.float32)
        near = (np.abs(heights - bottom) <= tolerance) & ~self._inside(anchor)
        if near.sum() < 20:
            return bottom, None
        local = self.solid[near].astype(np.float64)
        level = float(np.median(heights[near]))
        return level, np.column_stack([local @ plan.T, heights[near]])

    def _inside(self, body: Body) -> Bool:
        """Which solid points lie within a body's footprint."""
        return body.box.covers(self.solid)

    def points_of(self, body: Body) -> Array:
        cloud = self.scene.cloud
        points = cloud.means[body.rows].to(torch.float64).cpu().numpy()
        solid = (cloud.opacities[body.rows] >= OPAQUE).cpu().numpy()
        return points[solid] if solid.any() else points

    def tolerance(self, anchor: Body) -> float:
        """How uneven a surface may be: 3 % of its owner's height, between 1 and 4 centimetres."""
        cm = centimetre(self.frame, max(anchor.box.size))
        return float(np.clip(0.03 * anchor.box.size[2], cm, 4 * cm))


def support_height(scene: Scene, body: Body, context: Context) -> float | None:
    """Height along up of what a body stands on, scene units; None where nothing is within two centimetres below it."""
    up = scene.frame.up_vector
    box = contact_box(solid_points(scene.cloud, body.rows), scene.frame, body.box.axes)
    bottom = box.bottom(up)
    slack = max(2 * centimetre(scene.frame, max(box.size)), _SHARE * box.size[2])
    floor = Surroundings(scene, context).floor
    if abs(bottom - floor) <= slack:
        return floor
    others = obstacle_points(scene.cloud, mask_of_bodies(scene, [body]))
    heights = others[box.covers(others)] @ up.astype(np.float32)
    near = heights[np.abs(heights - bottom) <= slack]
    return float(np.median(near)) if len(near) >= _FEW else None

"""The scene as the search for a spot sees it: obstacles, bounds of the room, floor and ceiling, supporting surfaces.

regions.py turns placements into regions, and place.py searches them.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.camera import Vec3
from ...gaussians.language.field.measure import solid_points
from ...gaussians.scene import Frame, Scene
from ...gaussians.world.box import Axes, Box
from ..operation import Context
from .bodies import Array, Body, as_vec, centimetre, contact_box, mask_of_bodies
from .occupancy import column_of, obstacle_points, surface_heights
from .sight import Sight

_LOW_CEILING = 240.0  # centimetres, height of a low room
_SAMPLE_SIZE = 50_000  # points from which extents of the room are measured
_MIN_POINTS = 8  # points under a thing; fewer are floaters
# Largest gap to the support as a share of the height: Gaussians reach about that far beyond their centres.
_TOLERANCE = 0.03
_RING = 1.8  # times its footprint: where the surface that carries a thing shows around it
_RING_CELLS = 12  # along each side of that
_FLOOR = 0.02  # of the scene's height: how thick the floor is
_FLOOR_CELLS, _FEW_OF_FLOOR = 40, 200  # along each side of it; points that are no floor
_FLOOR_SPARSE = 0.3  # of the points that a cell of it usually has, below which it is haze
_AROUND = 0.2  # share of the cells around a footprint that a surface fills
FLOOR_WORDS = frozenset({"floor", "ground", "carpet", "room"})


@dataclass(eq=False)
class Surroundings:
    """One scene for one viewer; objects placed during an operation become obstacles by `add_obstacle`.

    Attributes:
        scene: the scene with all obstacles.
        context: viewer and resolver.
        moving: `[N]` bool, Gaussians that are being moved and so are no obstacles.
        moving_groups: their groups.
        back: `[3]` direction of the thing's back, which "against a wall" brings to the wall; None allows any side.
        lift: height above the floor of a thing that hangs on a wall or from the ceiling, scene units.
        placed: boxes of the objects given to `add_obstacle`.
        rests: whether the thing must rest on something: beside a thing in the air it goes on what is below that.
    """

    scene: Scene
    context: Context
    moving: Tensor | None = None
    moving_groups: frozenset[int] = frozenset()
    back: Array | None = None
    lift: float = 0.0
    placed: list[Box] = field(default_factory=list)
    rests: bool = False

    @cached_property
    def frame(self) -> Frame:
        return self.scene.frame

    @cached_property
    def up(self) -> Array:
        return self.frame.up_vector

    @cached_property
    def solid(self) -> NDArray[np.float32]:
        """`[M, 3]` points of the obstacles, world frame."""
        return obstacle_points(self.scene.cloud, self.moving)

    @cached_property
    def heights(self) -> NDArray[np.float32]:
        """`[M]` of the obstacles' points along up."""
        heights: NDArray[np.float32] = self.solid @ self.up.astype(np.float32)
        return heights

    @cached_property
    def sight(self) -> Sight | None:
        """What the viewer and the cameras of a capture see; None for other scenes, which are known from all sides."""
        if self.frame.metres_per_unit is not None:
            return None
        return Sight.of(self.context.viewer, self.scene.cameras, self.solid)

    @cached_property
    def floor_points(self) -> NDArray[np.float32]:
        """`[M, 3]` solid points of the floor."""
        span = float(np.ptp(np.quantile(self.heights, [0.01, 0.99]))) if len(self.heights) else 0.0
        return self.solid[np.abs(self.heights - self.floor) < _FLOOR * span]

    @cached_property
    def floor_density(self) -> float:
        """Points of a capture's floor for each square unit of what was seen of it; 0 for other scenes, which have no
        noise, and where no floor was seen."""
        found = self._floor_cells
        return 0.0 if found is None else found[2]

    @cached_property
    def _floor_cells(self) -> tuple[Array, Array, float] | None:
        """Corners `[2]` along the room's axes of the connected floor that a capture shows, and its points for each
        square unit; None for other scenes, and where no floor was seen."""
        points = self.floor_points
        if self.sight is None or len(points) < _FEW_OF_FLOOR:
            return None
        plan = points @ np.array(self.room_axes[:2]).T.astype(np.float32)
        low, high = np.quantile(plan, [0.02, 0.98], axis=0).astype(np.float64)
        cell = max(float((high - low).max()) / _FLOOR_CELLS, 1e-9)
        index = np.floor((plan - low) / cell).astype(np.int64)
        index = index[((index >= 0) & (index < _FLOOR_CELLS)).all(axis=1)]
        counts = np.bincount(index[:, 0] * _FLOOR_CELLS + index[:, 1], minlength=_FLOOR_CELLS**2)
        usual = float(np.median(counts[counts > 0]))
        names, _ = scipy.ndimage.label(counts.reshape(_FLOOR_CELLS, -1) >= _FLOOR_SPARSE * usual)
        widest = int(np.bincount(names.ravel())[1:].argmax()) + 1
        at = np.argwhere(names == widest)
        return low + at.min(axis=0) * cell, low + (at.max(axis=0) + 1) * cell, usual / cell**2

    def add_obstacle(self, points: Array, box: Box) -> None:
        """Add points `[M, 3]` of the world frame and their box to the obstacles."""
        self.solid = np.concatenate([self.solid, points.astype(np.float32)])
        self.__dict__.pop("heights", None)
        self.placed.append(box)

    @cached_property
    def sampled(self) -> NDArray[np.float32]:
        """A sample of the solid points at even steps, for extents and middles."""
        return self.solid[:: max(1, len(self.solid) // _SAMPLE_SIZE)]

    @cached_property
    def room_axes(self) -> Axes:
        """Horizontal axes of the floor if the field has one, else of the frame; and up."""
        if self.scene.language is not None:
            floors = [g for g in self.scene.language.groups if g.level == "structure" and g.label in FLOOR_WORDS]
            if floors:
                return max(floors, key=lambda g: g.box.size[0] * g.box.size[1]).box.axes
        east, north, up = self.frame.basis()
        return as_vec(east), as_vec(north), as_vec(up)

    @cached_property
    def floor(self) -> float:
        """Height of the floor along up; without one in the frame, the lowest height with many points (a histogram)."""
        if self.frame.floor is not None:
            return self.frame.floor
        heights = self.sampled @ self.up.astype(np.float32)
        if not len(heights):
            return 0.0
        low, high = np.quantile(heights, [0.005, 0.6])
        counts, edges = np.histogram(heights, bins=60, range=(float(low), float(high) + 1e-9))
        lowest = int(np.argmax(counts >= 0.5 * counts.max()))
        return float((edges[lowest] + edges[lowest + 1]) / 2)

    @cached_property
    def ceiling(self) -> float:
        """Height along up of the ceiling; if unknown, that of the highest solid points, but at least a low room's."""
        field = self.scene.language
        tops = [g for g in field.groups if g.label == "ceiling" and g.level == "structure" and g.count] if field else []
        if tops:
            return min(float(np.array(g.box.center) @ self.up) - g.box.size[2] / 2 for g in tops)
        heights = self.sampled @ self.up.astype(np.float32)
        highest = float(np.quantile(heights, 0.995)) if len(heights) else self.floor
        low = self.floor + _LOW_CEILING * centimetre(self.frame, 1.0)
        return highest if self.frame.metres_per_unit is None else max(highest, low)

    def bounds_for(self, size: Vec3, plan: Array) -> tuple[Array, Array]:
        """Bounds along the room's axes for the centre of a footprint with axes `plan` that stays in the room."""
        low, high = self.room_bounds
        turn = np.abs(np.array(self.room_axes[:2]) @ plan.T)
        half = turn @ np.array(size[:2]) / 2
        low, high = low + half, high - half
        tight = low > high
        return np.where(tight, (low + high) / 2, low), np.where(tight, (low + high) / 2, high)

    @cached_property
    def room_bounds(self) -> tuple[Array, Array]:
        """Extent along the room's axes of the points near floor height, without the outermost 0.4 % at each end;
        of a capture, that of the floor that it shows."""
        if self._floor_cells is not None:
            return self._floor_cells[0], self._floor_cells[1]
        plan = np.array(self.room_axes[:2])
        heights = self.sampled @ self.up.astype(np.float32)
        span = float(np.ptp(np.quantile(heights, [0.01, 0.99]))) if len(heights) else 1.0
        near = self.sampled[np.abs(heights - self.floor) < 0.05 * span]
        points = (near if len(near) > 100 else self.sampled) @ plan.T.astype(np.float32)
        if not len(points):
            return np.full(2, -1.0), np.full(2, 1.0)
        low, high = np.quantile(points, [0.004, 0.996], axis=0)
        return low.astype(np.float64), high.astype(np.float64)

    def base_under(self, anchor: Body, plan: Array) -> tuple[float, Array | None]:
        """Height and points of the surface just under a thing; the floor has no points (None)."""
        bottom = anchor.box.bottom(self.up)
        tolerance = max(self.tolerance(anchor), 5 * centimetre(self.frame, max(anchor.box.size)))
        if abs(bottom - self.floor) <= tolerance and self.frame.floor is not None:
            return self.floor, None
        near = np.flatnonzero(np.abs(self.heights - bottom) <= tolerance)
        near = near[~anchor.box.covers(self.solid[near])]
        if self.rests and not self._is_around(anchor, self.solid[near]):
            return self._below(anchor, plan)
        if len(near) < 20:
            return bottom, None
        local = self.solid[near].astype(np.float64)
        level = float(np.median(self.heights[near]))
        return level, np.column_stack([local @ plan.T, self.heights[near]])

    def _is_around(self, anchor: Body, points: NDArray[np.float32]) -> bool:
        """Whether points at the height of a thing's underside lie around it, as of a table top: what is under it was
        seen by no camera."""
        place = np.abs(anchor.box.local(points)[:, :2]) / np.maximum(np.array(anchor.box.size[:2]), 1e-9)
        ring = anchor.box.local(points[(place <= 0.5 * _RING).all(axis=1)])[:, :2]
        cells = np.floor((ring / np.array(anchor.box.size[:2]) / _RING + 0.5) * _RING_CELLS).astype(np.intp)
        filled = len(np.unique(np.clip(cells, 0, _RING_CELLS - 1) @ np.array([_RING_CELLS, 1])))
        return filled >= _AROUND * _RING_CELLS**2 * (1 - _RING**-2)

    def _below(self, anchor: Body, plan: Array) -> tuple[float, Array | None]:
        """Height and points of the broadest surface under a thing that is in the air, else of the floor."""
        heights = self.heights
        lowest = self.floor + self.tolerance(anchor) if self.frame.floor is not None else -np.inf
        under = np.flatnonzero((heights < anchor.box.bottom(self.up)) & (heights > lowest))
        under = under[anchor.box.covers(self.solid[under])]
        if len(under) < 20:
            return (self.floor if self.frame.floor is not None else anchor.box.bottom(self.up)), None
        points, tops = self.solid[under].astype(np.float64) @ plan.T, heights[under].astype(np.float64)
        tolerance = self.tolerance(anchor)
        level = surface_heights(tops, points, tolerance)[0][0]
        near = np.abs(heights - level) <= tolerance
        return level, np.column_stack([self.solid[near].astype(np.float64) @ plan.T, heights[near]])

    def tolerance(self, anchor: Body) -> float:
        """Allowed unevenness of a surface: 3 % of its owner's height, between 1 and 4 centimetres."""
        cm = centimetre(self.frame, max(anchor.box.size))
        return float(np.clip(0.03 * anchor.box.size[2], cm, 4 * cm))


def support_height(scene: Scene, body: Body, context: Context) -> float | None:
    """Height along up of a body's support, scene units; None if there is none within 2 cm or 3 % of its height."""
    up = scene.frame.up_vector
    box = contact_box(solid_points(scene.cloud, body.rows), scene.frame, body.box.axes)
    bottom = box.bottom(up)
    slack = max(2 * centimetre(scene.frame, max(box.size)), _TOLERANCE * box.size[2])
    floor = Surroundings(scene, context).floor
    if abs(bottom - floor) <= slack:
        return floor
    others = obstacle_points(scene.cloud, mask_of_bodies(scene, [body]), column_of(scene.cloud, box))
    heights = others[box.covers(others)] @ up.astype(np.float32)
    near = heights[np.abs(heights - bottom) <= slack]
    return float(np.median(near)) if len(near) >= _MIN_POINTS else None

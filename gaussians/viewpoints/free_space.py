"""Where a camera can stand: the distance from a point to the nearest surface, on a grid of voxels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ..cloud import GaussianCloud
from ..scene import Frame
from ..world.person import EYE_HEIGHT
from .coverage import EYE_HEIGHT as EYE_SHARE

F64 = NDArray[np.float64]

CELLS = 64  # along the longest side of the scene
SOLID = 0.3  # opacity from which a Gaussian is part of a surface
LEAST = 4  # Gaussians in and around a voxel from which one in it counts as a surface; fewer are floaters
MARGIN = 0.01  # share of the Gaussians at each end of each axis that are left out of the bounds
PADDING = 0.02  # of each side by which the bounds are widened, so that they hold the walls
BODY = (0.3, 0.75)  # shares of the scene's height between which what stands there blocks a person
BLOCKS = 1.2  # voxels: a line of sight that passes a surface nearer than this meets it; walls have gaps of a voxel
AIR = 3  # voxels of free space around the eyes of who stands somewhere
PLAN_CELLS = 32  # per side of the floor plan in which people stand


@dataclass(frozen=True, eq=False)
class FreeSpace:
    """The empty space of a scene.

    Attributes:
        frame: the scene's frame; coordinates here are in its basis (east, north, up), scene units.
        low, high: `[3]` bounds of the solid Gaussians without the outermost ones.
        step: side of a voxel.
        distance: `[X, Y, Z]` from the middle of each voxel to the nearest occupied one.
        points: `[P, 3]` solid Gaussians, at most 60,000.
    """

    frame: Frame
    low: F64
    high: F64
    step: float
    distance: NDArray[np.float32]
    points: F64

    @classmethod
    def of(cls, cloud: GaussianCloud, frame: Frame) -> Self:
        """The free space of a cloud; all is free where there are no Gaussians."""
        solid = cloud.opacities > SOLID
        means = (cloud.means[solid] if bool(solid.any()) else cloud.means).cpu().numpy().astype(np.float64)
        local = means @ frame.basis().T
        some = local[:: max(1, len(local) // 60_000)]
        if not len(local):
            return cls(frame, np.zeros(3), np.ones(3), 1.0, np.full((1, 1, 1), np.inf, np.float32), some)
        low, high = np.quantile(some, MARGIN, axis=0), np.quantile(some, 1 - MARGIN, axis=0)
        low, high = low - PADDING * (high - low), high + PADDING * (high - low)
        step = max(float((high - low).max()) / CELLS, 1e-9)
        shape = np.maximum(np.ceil((high - low) / step).astype(int), 1)
        index = np.floor((local - low) / step).astype(int)
        index = index[((index >= 0) & (index < shape)).all(axis=1)]
        count = np.bincount(np.ravel_multi_index(tuple(index.T), tuple(shape)), minlength=int(shape.prod()))
        count = count.reshape(shape)
        around = ndimage.uniform_filter(count.astype(np.float64), 3, mode="constant") * 27
        empty = (count == 0) | (around < LEAST - 0.5)
        distance = ndimage.distance_transform_edt(empty) * step if not empty.all() else np.full(empty.shape, np.inf)
        return cls(frame, low, high, step, distance.astype(np.float32), some)

    @property
    def floor(self) -> float:
        """Height of the floor along up, or of the lowest Gaussians if the frame has none."""
        return self.frame.floor if self.frame.floor is not None else float(self.low[2])

    @property
    def eye_height(self) -> float:
        """Height of a standing person's eyes along up; a share of the scene's height where its scale is unknown."""
        tall = float(self.high[2]) - self.floor
        scale = self.frame.metres_per_unit
        return self.floor + (min(EYE_HEIGHT / scale, 0.9 * tall) if scale else EYE_SHARE * tall)

    @property
    def middle(self) -> F64:
        """`[3]` middle of the bounds, world."""
        middle: F64 = (self.low + self.high) / 2 @ self.frame.basis()
        return middle

    def clearance(self, points: F64) -> F64:
        """Distance `[M]` from world points `[M, 3]` to the nearest surface, about a voxel exact.

        Outside the bounds it is the distance to them, where that is larger.
        """
        local = np.atleast_2d(points) @ self.frame.basis().T
        index = np.clip(np.floor((local - self.low) / self.step).astype(int), 0, np.array(self.distance.shape) - 1)
        outside = np.linalg.norm(np.maximum(np.maximum(self.low - local, local - self.high), 0), axis=1)
        return np.maximum(self.distance[tuple(index.T)].astype(np.float64), outside)

    def inside(self, points: F64) -> NDArray[np.bool_]:
        """`[M]` whether world points `[M, 3]` lie within the bounds."""
        local = np.atleast_2d(points) @ self.frame.basis().T
        return np.asarray(((local >= self.low) & (local <= self.high)).all(axis=1))

    def sees(self, eye: F64, target: F64, reach: float) -> bool:
        """Whether the straight line from `eye` `[3]` meets no surface until `reach` before `target` `[3]`, world."""
        basis = self.frame.basis()
        start, gap = basis @ eye, basis @ (target - eye)
        length = float(np.linalg.norm(gap))
        end = 1 - reach / length if length > reach else 0.0
        with np.errstate(divide="ignore", invalid="ignore"):  # a ray along a face gives 0 / 0, which is no limit
            planes = np.stack([(self.low - start) / gap, (self.high - start) / gap])
        enter = max(0.0, float(np.nanmax(planes.min(axis=0), initial=0.0)))
        leave = min(end, float(np.nanmin(planes.max(axis=0), initial=end)))
        if enter >= leave:  # outside the bounds there is nothing
            return True
        shares = np.arange(enter, leave, self.step / length)
        return not bool((self.clearance((start + shares[:, None] * gap) @ basis) < BLOCKS * self.step).any())

    def stands(self, count: int, height: float, near: F64 | None = None) -> F64:
        """Up to `count` points `[S, 3]`, world, at `height` along up, where nothing stands and far apart.

        With `near` `[3]`, world, the first is the free place nearest to it; otherwise the one with most space around.
        """
        span = np.maximum(self.high - self.low, 1e-9)
        cell = span[:2] / PLAN_CELLS
        lower, upper = (self.low[2] + share * span[2] for share in BODY)
        body = self.points[(self.points[:, 2] > lower) & (self.points[:, 2] < upper)]
        index = np.floor((body[:, :2] - self.low[:2]) / cell).astype(int)
        index = index[((index >= 0) & (index < PLAN_CELLS)).all(axis=1)]
        free = np.ones((PLAN_CELLS, PLAN_CELLS), bool)
        free[index[:, 0], index[:, 1]] = False
        clear = ndimage.distance_transform_edt(np.pad(free, 1))[1:-1, 1:-1]
        grid = np.stack(np.meshgrid(*[np.arange(PLAN_CELLS)] * 2, indexing="ij"), axis=-1)
        eyes = np.concatenate([self.low[:2] + (grid + 0.5) * cell, np.full((*grid.shape[:2], 1), height)], axis=-1)
        open_air = self.clearance(eyes.reshape(-1, 3) @ self.frame.basis()).reshape(free.shape)
        clear = np.where(open_air >= AIR * self.step, clear, 0)
        basis = self.frame.basis()
        found: list[list[float]] = []
        for _ in range(count):
            score = np.where(clear >= 2, clear, 0)
            if near is not None and not found:
                place = ((basis @ near)[:2] - self.low[:2]) / cell - 0.5
                score = np.where(score > 0, 1 / (1 + np.linalg.norm(grid - place, axis=-1)), 0)
            i, j = np.unravel_index(int(np.argmax(score)), score.shape)
            if not score[i, j] > 0:
                break
            found.append([*(self.low[:2] + (np.array([i, j]) + 0.5) * cell), height])
            clear = np.where(np.linalg.norm(grid - [i, j], axis=-1) < PLAN_CELLS / 4, 0, clear)
        return np.array(found).reshape(-1, 3) @ basis

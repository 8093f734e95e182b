"""Where light comes from in a scene: what Gaussians receive from lamps, windows and a direction.

An estimate on a grid: surfaces face away from what is solid, toward the middle of the room or away from the middle of
their own thing; the light of a lamp falls off with the square of the distance and is stopped by the solid cells on the
straight line. Nothing is reflected.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.rotations import to_matrix
from ...gaussians.scene import Scene
from ..coloring.grid import Grid
from .whites import F64, LUMINANCE, NEUTRAL, white

_CELLS = 64  # along the longest axis
_SAMPLE = 1 << 17  # Gaussians that the grid is filled with
_FULL = 0.6  # share of a cell's side squared that opaque surfaces cover, from which it stops all light
_CLEAR = 1.6  # cells around a point and around a lamp that stop nothing: surfaces do not shadow themselves
_LEAST = 0.004  # light relative to that of the scene below which a lamp reaches no farther
_BRIGHTEST = 9.0  # times its light at a metre, that a lamp gives to what is close
_STRENGTH, _SLOPE = 0.42, 0.24  # of a directional light: by facing, and by place


@dataclass(frozen=True)
class Source:
    """A lamp or a window, taken as a point.

    Attributes:
        place: `[3]` world.
        strength: light on a surface that faces it from a metre, relative to the light that is there; negative: taken
            away, as by a lamp that goes out.
        kelvin: its colour.
        size: radius in metres within which it is not brighter.
        owner: group of the thing that it is, whose Gaussians stop none of its light; -1 for none.
    """

    place: tuple[float, float, float]
    strength: float
    kelvin: float
    size: float = 0.3
    owner: int = -1


@dataclass(frozen=True)
class Sky:
    """The light that is there, coming more from one side.

    Attributes:
        toward: unit vector to the light, world.
        amount: 0 for none, 1 for a strong one.
    """

    toward: tuple[float, float, float]
    amount: float = 1.0


@dataclass(frozen=True, eq=False)
class Space:
    """A scene on a grid.

    Attributes:
        grid: its cells.
        solid: `[cells]` float32, share of light that a cell stops, 0 to 1.
        normals: `[3, cells]` float32 smoothed normals, away from what is solid, shorter where surfaces disagree.
        used: `[C]` int64 cells that hold something.
        unit: metres per scene unit.
    """

    grid: Grid
    solid: Tensor
    normals: Tensor
    used: Tensor
    unit: float

    @classmethod
    def of(cls, scene: Scene, unit: float, without: Sequence[int] = ()) -> Space:
        """The grid of a scene of so many metres a unit.

        Args:
            without: groups that stop no light.
        """
        cloud = scene.cloud
        step = max(1, len(cloud) // _SAMPLE)
        rows = torch.arange(0, len(cloud), step)
        points, scales = cloud.means[rows].cpu(), cloud.scales[rows].cpu()
        opacities, groups = cloud.opacities[rows].cpu(), cloud.group[rows].cpu()
        grid = Grid.over(points, _CELLS)
        ordered = scales.sort(dim=1).values
        area = (step * opacities * ordered[:, 1] * ordered[:, 2] * 6.0).clamp(max=grid.step**2)
        stops = torch.where(torch.isin(groups, torch.tensor(list(without), dtype=groups.dtype)), 0.0, area)
        own, flat = _own_normals(cloud.quats[rows].cpu(), scales)
        away = _away(scene, points, groups)
        own = torch.where((own * away).sum(dim=1, keepdim=True) < 0, -own, own)
        weight = (area * flat)[:, None]
        sums = grid.sums(points, torch.cat([weight * own, weight, area[:, None], stops[:, None]], dim=1))
        soft = grid.smoothed(sums[:, :4])
        normals = soft[:, :3] / soft[:, 3:].clamp(min=1e-3 * float(soft[:, 3].max()) + 1e-30)
        solid = (sums[:, 5] / (_FULL * grid.step**2)).clamp(0, 1)
        used = (soft[:, 3] > 0).nonzero().squeeze(1)
        return cls(grid, solid.contiguous(), normals.T.contiguous(), used, unit)

    def received(
        self, scene: Scene, rows: Tensor, sources: Sequence[Source], sky: Sky | None, kelvin: float = NEUTRAL
    ) -> Tensor:
        """`[M, 3]` factors of linear light of some rows `[M]` of the scene's cloud.

        Args:
            kelvin: white point of the light that is there.
        """
        from ...gaussians.compiled import run, workers
        from .kernels import receive

        cloud = scene.cloud
        table = self._table(sources, kelvin)
        grid = np.array([*self.grid.low.tolist(), self.grid.step], dtype=np.float32)
        shape = np.array(self.grid.shape, dtype=np.int64)
        seen = self._visibility(table, grid, shape)
        out = np.empty((len(rows), 3), dtype=np.float32)
        arrays = (c.cpu().contiguous().numpy() for c in (cloud.means, cloud.quats, cloud.scales))
        count = workers()
        scratch = np.zeros((count, 6), dtype=np.float32)
        arguments = (grid, shape, self.normals.numpy(), seen, table, self._sky(sky), out, scratch)
        run(receive, count, rows.cpu().numpy(), *arrays, *arguments)
        return torch.from_numpy(out)

    def _table(self, sources: Sequence[Source], kelvin: float) -> NDArray[np.float32]:
        """`[S, 9]` as the kernel takes it, in scene units."""
        found = np.zeros((len(sources), 9), dtype=np.float32)
        for row, source in zip(found, sources, strict=True):
            power = abs(source.strength) / self.unit**2
            row[:3] = source.place
            row[3:6] = np.sign(source.strength) * power * _tint(source.kelvin, kelvin)
            row[6] = max((source.size / self.unit) ** 2, 1 / (_BRIGHTEST * self.unit**2))
            row[7] = power / _LEAST
        return found

    def _visibility(
        self, table: NDArray[np.float32], grid: NDArray[np.float32], shape: NDArray[np.int64]
    ) -> NDArray[np.float32]:
        """`[S, cells]` share of the light of each source that arrives, smoothed over neighbouring cells."""
        from ...gaussians.compiled import run, workers
        from .kernels import visible

        seen = np.zeros((len(table), self.grid.size), dtype=np.float32)
        if not len(table):
            return seen
        clear = np.float32(_CLEAR)
        run(visible, workers(), self.used.numpy(), self.solid.numpy(), grid, shape, table, clear, seen)
        there = torch.zeros(self.grid.size)
        there[self.used] = 1.0
        soft = self.grid.smoothed(torch.cat([torch.from_numpy(seen), there[None]]).T.contiguous())
        return np.asarray((soft[:, :-1] / soft[:, -1:].clamp(min=1e-6)).T.contiguous().numpy())

    def _sky(self, sky: Sky | None) -> NDArray[np.float32]:
        """`[8]` as the kernel takes it."""
        if sky is None:
            return np.array([0, 0, 1, 0, 0, 0, 1, 1], dtype=np.float32)
        low = self.grid.low.double().numpy()
        high = low + self.grid.step * np.array(self.grid.shape)
        toward = np.array(sky.toward)
        half = float(np.abs(toward) @ (high - low)) / 2
        strength = (sky.amount * _STRENGTH, sky.amount * _SLOPE)
        return np.array([*toward, *strength, toward @ (low + high) / 2, max(half, 1e-9), 1], dtype=np.float32)


def _tint(kelvin: float, base: float) -> F64:
    """`[3]` linear colour of a source relative to that of the light that is there, of luminance 1."""
    tint = white(kelvin) / np.maximum(white(base), 0.02)
    return np.asarray(tint / (LUMINANCE @ tint))


def _own_normals(quats: Tensor, scales: Tensor) -> tuple[Tensor, Tensor]:
    """Shortest axes `[M, 3]` of Gaussians, up to their sign, and how flat each is, `[M]`."""
    axes = to_matrix(quats)
    thin = scales.argmin(dim=1)
    own = axes.gather(2, thin[:, None, None].expand(-1, 3, 1)).squeeze(2)
    ordered = scales.sort(dim=1).values
    return own, (1 - ordered[:, 0] / ordered[:, 1].clamp(min=1e-12)).clamp(min=0.05)


def _away(scene: Scene, points: Tensor, groups: Tensor) -> Tensor:
    """`[M, 3]` which way the surface at each point faces at least in part: away from the middle of its thing; of floor,
    walls, ceiling and what belongs to nothing, toward the middle of the scene."""
    middle = (points.quantile(0.1, dim=0) + points.quantile(0.9, dim=0)) / 2 if len(points) else points.sum(dim=0)
    found = middle - points
    field = scene.language
    if field is None or not field.groups:
        return found
    centers = torch.tensor(np.array([g.box.center for g in field.groups]), dtype=torch.float32)
    things = torch.tensor([g.level != "structure" for g in field.groups])
    at = groups.long().clamp(min=0, max=len(field.groups) - 1)
    thing = (groups >= 0) & things[at]
    return torch.where(thing[:, None], points - centers[at], found)


def direction_of(values: F64) -> tuple[float, float, float]:
    """A vector `[3]` at unit length."""
    x, y, z = (float(v) for v in values / max(float(np.linalg.norm(values)), 1e-12))
    return x, y, z

"""Hand-made worlds: flat pieces of painted surface whose truth is known by construction."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import torch
from numpy.typing import NDArray

from scenewright.gaussians.camera import Vec3
from scenewright.gaussians.cloud import GaussianCloud, concat
from scenewright.gaussians.color import Rgb
from scenewright.gaussians.harmonics import SH_C0
from scenewright.gaussians.rotations import from_matrix, multiply

F64 = NDArray[np.float64]
Height = Callable[[F64, F64], F64]
ASIDE = 0.15  # of the spacing: samples lie irregularly, as those of real surfaces do
ROUGH = 0.01  # of the spacing, across the surface
SHADE = 0.01  # deviation of the colour from Gaussian to Gaussian


class World:
    """Builds clouds from parallelograms; every sheet remembers which rows it owns."""

    def __init__(self, seed: int = 0) -> None:
        self._rng = np.random.default_rng(seed)
        self._clouds: list[GaussianCloud] = []
        self.rows: dict[str, NDArray[np.int64]] = {}

    def __len__(self) -> int:
        return sum(len(c) for c in self._clouds)

    def sheet(
        self, name: str, corner: Vec3, u: Vec3, v: Vec3, color: Rgb, step: float = 0.04, height: Height | None = None
    ) -> World:
        """A parallelogram from `corner` along `u` and `v`, sampled every `step`; `height(x, y)` lifts it along +z."""
        a, b = np.array(u, dtype=np.float64), np.array(v, dtype=np.float64)
        na, nb = (max(2, round(float(np.linalg.norm(w)) / step)) for w in (a, b))
        s, t = np.meshgrid((np.arange(na) + 0.5) / na, (np.arange(nb) + 0.5) / nb, indexing="ij")
        normal = np.cross(a, b) / np.linalg.norm(np.cross(a, b))
        points = np.array(corner) + s.reshape(-1, 1) * a + t.reshape(-1, 1) * b
        points += self._rng.normal(0, ASIDE * step, (len(points), 2)) @ np.stack(
            [a / np.linalg.norm(a), b / np.linalg.norm(b)]
        )
        points += self._rng.normal(0, ROUGH * step, (len(points), 1)) * normal
        if height is not None:
            points[:, 2] += height(points[:, 0], points[:, 1])
        axes = np.stack([a / np.linalg.norm(a), np.cross(normal, a / np.linalg.norm(a)), normal], axis=1)
        self._add(name, points, axes, np.array(color), step)
        return self

    def box(self, name: str, low: Vec3, high: Vec3, color: Rgb, step: float = 0.04) -> World:
        """The six faces of an upright box."""
        (x, y, z), (w, d, h) = low, tuple(b - a for a, b in zip(low, high, strict=True))
        faces: list[tuple[Vec3, Vec3, Vec3]] = [
            ((x, y, z), (w, 0, 0), (0, d, 0)), ((x, y, z + h), (w, 0, 0), (0, d, 0)),
            ((x, y, z), (w, 0, 0), (0, 0, h)), ((x, y + d, z), (w, 0, 0), (0, 0, h)),
            ((x, y, z), (0, d, 0), (0, 0, h)), ((x + w, y, z), (0, d, 0), (0, 0, h)),
        ]  # fmt: skip
        for corner, u, v in faces:
            self.sheet(name, corner, u, v, color, step)
        return self

    def cloud(self, turn: F64 | None = None) -> GaussianCloud:
        """All sheets as one cloud, optionally turned about the origin by a rotation matrix."""
        whole = concat(self._clouds)
        if turn is None:
            return whole
        matrix = torch.from_numpy(turn)
        means = (whole.means.double() @ matrix.T).float()
        return whole.replace(means=means, quats=multiply(from_matrix(matrix).float()[None], whole.quats))

    def labels(self, names: Sequence[str]) -> NDArray[np.int64]:
        """`[N]` position in `names` of the piece each row belongs to, -1 for the others."""
        label = np.full(len(self), -1, dtype=np.int64)
        for i, name in enumerate(names):
            label[self.rows[name]] = i
        return label

    def _add(self, name: str, points: F64, axes: F64, color: F64, step: float) -> None:
        n, start = len(points), len(self)
        shown = np.clip(color + self._rng.normal(0, SHADE, (n, 1)), 0, 1)
        cloud = GaussianCloud.create(
            torch.from_numpy(points).float(),
            from_matrix(torch.from_numpy(axes).float()).expand(n, 4).contiguous(),
            torch.tensor([0.6 * step, 0.6 * step, 0.05 * step]).expand(n, 3).contiguous(),
            torch.full((n,), 0.9),
            torch.from_numpy((shown - 0.5) / SH_C0).float()[:, None, :].contiguous(),
        )
        self._clouds.append(cloud.replace(ids=cloud.ids + start))
        own = np.arange(start, start + n)
        self.rows[name] = np.concatenate([self.rows[name], own]) if name in self.rows else own

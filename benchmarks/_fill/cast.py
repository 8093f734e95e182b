"""New contact shadows against truth: things of the library on a floor, lit by a known sky and lamp.

Truth is traced: from points of the floor around a thing, rays to the sky and to a wide lamp are followed through the
thing's occupancy on a fine grid. What `tools.harmony` casts on a floor of coarse Gaussians is rendered from above, with
the thing taken away, and divided by the floor as it was.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians import assets
from ...gaussians.camera import Camera
from ...gaussians.cloud import GaussianCloud, concat
from ...gaussians.harmonics import color_to_dc
from ...gaussians.render import render
from ...gaussians.scene import Frame, Scene
from ...tools.harmony.shadows import shadows_under
from ...tools.harmony.strength import FAINT, Strength
from ..harness import Metric

F64 = NDArray[np.float64]
KINDS = ("chair", "stool", "ball", "vase", "potted plant", "armchair", "cushion", "bookshelf", "floor lamp", "table")
GOAL = 3.0  # dB between the new shadow and the true one
_VOXELS, _MARCH = 56, 0.9  # along a thing's longest side; cells of one step along a ray
_RAYS = 100  # of the sky, by the cosine law
_LAMP = 0.35  # of the light on the floor comes from a lamp above and aside, the rest from an even sky
_TOWARD, _SOFT, _LAMP_RAYS = np.array([0.35, -0.3, 0.9]), 0.25, 24  # to the lamp; tangent of half its width
_BOUNCED = 0.12  # of the light that arrives wherever it is blocked: reflected by the room
_GAMMA = 1 / 2.2
_PIXELS = 60  # along a side of the pictures
_AROUND = 1.6  # times a thing's extent: side of the floor that is compared
_SHOWS = 0.95  # ratio of colours below which one sees a shadow
_ENOUGH = 0.02  # share of a picture that it must fill
_SPACING = 0.09  # of the floor's Gaussians, metres


@dataclass(frozen=True, eq=False)
class Cast:
    """The shadow of one thing: ratios `[H, W]` of colours to those without it, true and ours, and what is visible of it
    beside the thing."""

    kind: str
    true: F64
    ours: F64
    shown: NDArray[np.bool_]

    @property
    def level(self) -> float:
        """Ours over the true one, dB of the darkness summed over what is shown."""
        true, ours = ((1 - ratio)[self.shown].sum() for ratio in (self.true, self.ours))
        return float(20 * np.log10(max(ours, 1e-9) / max(true, 1e-9)))

    @property
    def residual(self) -> float:
        """Root mean square of the difference over that of the true darkness."""
        return float(
            np.sqrt((((self.true - self.ours) ** 2)[self.shown]).mean() / ((1 - self.true)[self.shown] ** 2).mean())
        )


def cast_metrics(quick: bool = False) -> list[Metric]:
    """How far new shadows are from the true ones."""
    found = [c for kind in (KINDS[:3] if quick else KINDS) if (c := measured(kind)) is not None]
    levels = [abs(c.level) for c in found]
    return [
        Metric("cast.level", float(np.median(levels)), "dB", "lower", 0.3, GOAL),
        Metric("cast.level.worst", max(levels), "dB", "lower", 0.3),
        Metric("cast.residual", float(np.mean([c.residual for c in found])), "x", "lower", 0.1),
        Metric("cast.within_goal", float(np.mean([x <= GOAL for x in levels])), "1", "higher", 0.1),
    ]


def measured(kind: str) -> Cast | None:
    """The shadow of a thing of a kind; None if it hides its own from above."""
    thing = assets.make(kind, 0, detail=2.0).cloud
    points = thing.means.numpy().astype(np.float64)
    extent = float(np.ptp(points, axis=0).max())
    half = _AROUND * extent / 2
    floor = _floor(half * 1.6)
    scene = Scene(
        concat([floor, thing.replace(ids=thing.ids + len(floor), group=torch.ones(len(thing), dtype=torch.int32))]),
        Frame((0, 0, 1), 0.0, 1.0, "given", "given"),
    )
    rows = torch.arange(len(floor), len(scene.cloud))
    dark, _ = shadows_under(scene, [rows], Strength(FAINT, 0), split=True, layers=True)
    camera = Camera.look_at(
        [0, 0, 40 * half], [0, 0, 0], [0, 1, 0], _PIXELS, _PIXELS, 2 * np.degrees(np.arctan(1 / 40))
    )
    without = dark.cloud[~torch.isin(dark.cloud.ids, scene.cloud.ids[rows])]
    ours = render(without, camera).rgb.numpy().mean(axis=2) / render(floor, camera).rgb.numpy().mean(axis=2)
    ground = _ground(camera)
    true = traced(points, ground.reshape(-1, 3)).reshape(_PIXELS, _PIXELS)
    shown = render(thing, camera).alpha.numpy() < 0.5
    shown &= true < _SHOWS
    return Cast(kind, true, ours.astype(np.float64), shown) if shown.mean() >= _ENOUGH else None


def traced(points: F64, ground: F64) -> F64:
    """`[M]` display colour of a floor at points of it over that without the thing, whose surface has `points`."""
    low, cell = points.min(axis=0), float(np.ptp(points, axis=0).max()) / _VOXELS
    shape = (np.ptp(points, axis=0) / cell).astype(int) + 1
    cells = np.zeros(shape, bool)
    cells[tuple(((points - low) / cell).astype(int).T)] = True
    rng = np.random.default_rng(0)
    sky = _cosine(rng, _RAYS)
    lamp = _TOWARD / np.linalg.norm(_TOWARD) + _SOFT * rng.normal(size=(_LAMP_RAYS, 3)) / 2
    light = (1 - _LAMP) * _arrives(cells, low, cell, ground, sky) + _LAMP * _arrives(cells, low, cell, ground, lamp)
    return np.asarray((_BOUNCED + (1 - _BOUNCED) * light) ** _GAMMA)


def _arrives(cells: NDArray[np.bool_], low: F64, cell: float, ground: F64, ways: F64) -> F64:
    """`[M]` share of rays from points that meet no cell."""
    total = np.zeros(len(ground))
    top = cell * cells.shape[2] + low[2]
    for way in ways / np.linalg.norm(ways, axis=1, keepdims=True):
        open_ = np.ones(len(ground), bool)
        for k in range(1, int(np.ceil(top / max(way[2], 0.05) / (_MARCH * cell)))):
            at = np.floor((ground + way * (k * _MARCH * cell) - low) / cell).astype(int)
            inside = ((at >= 0) & (at < cells.shape)).all(axis=1)
            open_[inside] &= ~cells[tuple(at[inside].T)]
        total += open_
    return np.asarray(total / len(ways))


def _cosine(rng: np.random.Generator, count: int) -> F64:
    """`[count, 3]` directions by the cosine law, evenly spread."""
    share, turn = (np.arange(count) + rng.random(count)) / count, np.pi * (1 + 5**0.5) * np.arange(count)
    sine = np.sqrt(share)
    return np.stack([sine * np.cos(turn), sine * np.sin(turn), np.sqrt(1 - share)], axis=1)


def _ground(camera: Camera) -> F64:
    """`[H, W, 3]` points of the floor that the pixels of a camera above it show."""
    x = (np.arange(camera.width) + 0.5 - camera.cx) / camera.fx
    y = (np.arange(camera.height) + 0.5 - camera.cy) / camera.fy
    a, b = np.meshgrid(x, y)
    ways = np.stack([a, b, np.ones_like(a)], axis=2) @ np.asarray(camera.world_to_camera)[:3, :3]
    return np.asarray(camera.position + ways * (-camera.position[2] / ways[..., 2:]))


def _floor(half: float) -> GaussianCloud:
    """A grey floor of coarse Gaussians, as fits make it where there is no texture."""
    step = _SPACING
    x = np.arange(-half, half, step) + step / 2
    a, b = np.meshgrid(x, x)
    means = np.stack([a.ravel(), b.ravel(), np.zeros(a.size)], axis=1).astype(np.float32)
    scales = torch.tensor([0.7 * step, 0.7 * step, 0.002]).repeat(len(means), 1)
    quats = torch.tensor([1.0, 0.0, 0.0, 0.0]).repeat(len(means), 1)
    sh = color_to_dc(torch.full((len(means), 3), 0.6))[:, None]
    return GaussianCloud.create(torch.from_numpy(means), quats, scales, torch.full((len(means),), 0.95), sh)


def describe(found: Sequence[Cast]) -> str:
    """One line a thing."""
    return "\n".join(f"{c.kind}: {c.level:+.1f} dB, residual {c.residual:.2f}" for c in found)

"""A room of coloured boxes with a hand-made language field, so that what each pixel shows is known by construction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch

from scenewright.gaussians.camera import Camera, Vec3
from scenewright.gaussians.cloud import GaussianCloud, concat
from scenewright.gaussians.color import rgb_to_lab
from scenewright.gaussians.harmonics import SH_C0
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.scene import Frame, Scene
from scenewright.gaussians.world.box import Box

_AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
WIDE, DEEP, HIGH = 4.0, 4.0, 2.6


@dataclass(frozen=True)
class Thing:
    """A box of one colour: label, lowest and highest corner, colour, level in the field, spacing of its Gaussians."""

    label: str
    low: Vec3
    high: Vec3
    color: Vec3
    level: str = "object"
    step: float = 0.06


def shell(ceiling: bool = True) -> list[Thing]:
    """Floor, four walls and a ceiling around the origin, the floor at z = 0."""
    x, y, t = WIDE / 2, DEEP / 2, 0.02
    grey = (0.75, 0.75, 0.75)
    walls = [
        ((-x - t, -y, 0.0), (-x, y, HIGH)), ((x, -y, 0.0), (x + t, y, HIGH)),
        ((-x, -y - t, 0.0), (x, -y, HIGH)), ((-x, y, 0.0), (x, y + t, HIGH)),
    ]  # fmt: skip
    parts = [Thing("floor", (-x, -y, -t), (x, y, 0.0), (0.5, 0.5, 0.5), "structure", 0.1)]
    parts += [Thing("wall", low, high, grey, "structure", 0.1) for low, high in walls]
    return parts + ([Thing("ceiling", (-x, -y, HIGH), (x, y, HIGH + t), grey, "structure", 0.1)] if ceiling else [])


def room(things: list[Thing], cameras: tuple[Camera, ...] = (), encoder: str = "test:1") -> Scene:
    """The scene of some things; group ids are their positions in the list."""
    clouds: list[GaussianCloud] = []
    groups: list[Group] = []
    for i, thing in enumerate(things):
        cloud = _surface(thing, i)
        cloud = cloud.replace(ids=cloud.ids + sum(map(len, clouds)))
        clouds.append(cloud)
        low, high = np.array(thing.low), np.array(thing.high)
        center, size = (tuple(v.tolist()) for v in ((low + high) / 2, high - low))
        lab = tuple(float(c) for c in rgb_to_lab(torch.tensor(thing.color)))
        box = Box(center, _AXES, size)
        groups.append(Group(i, thing.level, -1, thing.label, 0.9, box, lab, len(cloud), 4, 1.0))  # type: ignore[arg-type]
    field = LanguageField(tuple(groups), np.zeros((len(groups), 2), np.float32), encoder)
    frame = Frame((0, 0, 1), 0.0, 1.0, "given", "given")
    return Scene(concat(clouds), frame, cameras, field)


def _surface(thing: Thing, group: int) -> GaussianCloud:
    """The faces of a box as opaque flat discs about `step` apart."""
    low, high = np.array(thing.low), np.array(thing.high)
    points = []
    for axis in range(3):
        others = [k for k in range(3) if k != axis]
        ticks = [np.linspace(low[k], high[k], max(2, round((high[k] - low[k]) / thing.step) + 1)) for k in others]
        grid = np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, 2)
        for end in (low[axis], high[axis]):
            face = np.empty((len(grid), 3))
            face[:, others], face[:, axis] = grid, end
            points.append(face)
    means = torch.from_numpy(np.concatenate(points)).float()
    n = len(means)
    return GaussianCloud.create(
        means,
        torch.tensor([1.0, 0, 0, 0]).expand(n, 4).contiguous(),
        torch.full((n, 3), 0.6 * thing.step),
        torch.full((n,), 0.97),
        ((torch.tensor(thing.color) - 0.5) / SH_C0).expand(n, 1, 3).contiguous(),
        torch.full((n,), group, dtype=torch.int32),
    )

"""Scenes of axis-aligned blocks of points with exact boxes, some of which move."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import torch
from numpy.typing import NDArray

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.motion.motion import Motion, Track
from scenewright.gaussians.scene import Frame, Scene
from scenewright.gaussians.world.box import Box

Block = tuple[tuple[float, float, float], tuple[float, float, float]]  # centre and size
I64 = NDArray[np.int64]
LEVEL = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
STRUCTURE = ("floor", "wall", "ceiling")
ACROSS = 5  # points of a block along each side


def blocks(things: Mapping[str, Block], *move: Callable[[Callable[[str], I64]], Track], stop: float = 4.0) -> Scene:
    """A scene of blocks by name, from 0 to `stop` seconds; a name may end in a number, which its label leaves out.

    Args:
        move: each makes a track from a function that gives the ids of a block.
    """
    lattice = np.stack(np.meshgrid(*[np.linspace(-0.5, 0.5, ACROSS)] * 3), axis=-1).reshape(-1, 3)
    points = np.concatenate([np.array(center) + lattice * np.array(size) for center, size in things.values()])
    n, each = len(points), len(lattice)
    cloud = GaussianCloud.create(
        means=torch.from_numpy(points).float(),
        quats=torch.tensor([[1.0, 0, 0, 0]]).repeat(n, 1),
        scales=torch.full((n, 3), 0.002),
        opacities=torch.full((n,), 0.9),
        sh=torch.zeros(n, 1, 3),
        group=torch.arange(len(things), dtype=torch.int32).repeat_interleave(each),
    )
    groups = []
    for i, (name, (center, size)) in enumerate(things.items()):
        label = name.rstrip("0123456789 ")
        level = "structure" if label in STRUCTURE else "object"
        groups.append(Group(i, level, -1, label, 1.0, Box(center, LEVEL, size), (60.0, 0.0, 0.0), each, 0, 1.0))  # type: ignore[arg-type]
    field = LanguageField(tuple(groups), np.zeros((len(groups), 4), np.float32), "none")
    names = list(things)

    def ids(name: str) -> I64:
        return np.arange(each, dtype=np.int64) + each * names.index(name)

    motion = Motion(tuple(m(ids) for m in move), (), (), 0.0, stop) if move else None
    return Scene(cloud, Frame((0, 0, 1), 0.0, 1.0, "given", "given"), language=field, motion=motion)

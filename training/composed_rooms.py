"""Rooms that the layout solver composes, as scenes with the true object of every Gaussian, for training."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import torch
from numpy.typing import NDArray

from ..gaussians.scene import Scene
from ..gaussians.world import kinds
from ..planners.compose.api import compose


def composed_room(text: str, seed: int) -> tuple[Scene, NDArray[np.int32]]:
    """The room that `text` describes, without its language field, and the object of each Gaussian `[N]`.

    Parts count as their object; floor, walls and ceiling are -1.
    """
    scene, objects, _ = named_room(text, seed)
    return scene, objects


def named_room(text: str, seed: int) -> tuple[Scene, NDArray[np.int32], tuple[str, ...]]:
    """As `composed_room`, and the name of each object: its kind where there is one, else its label."""
    scene = compose(text, seed=seed, planner="grammar", best=True).build()
    field, group = scene.language, scene.cloud.group.numpy()
    assert field is not None, "composed rooms carry their groups"
    whole = np.array([g.parent if g.parent >= 0 else g.id for g in field.groups] + [-1])[group]
    held = set(whole.tolist())
    objects = [g.id for g in field.groups if g.level == "object" and g.id in held]
    number = np.full(len(field.groups) + 1, -1, np.int32)
    number[objects] = np.arange(len(objects))
    bare = scene.cloud.replace(group=torch.full_like(scene.cloud.group, -1))
    found = [(kinds.find(label), label) for label in (field.groups[i].label for i in objects)]
    names = tuple(kind.name if kind else label for kind, label in found)
    return replace(scene, cloud=bare, language=None), number[whole], names

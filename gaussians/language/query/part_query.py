"""The pieces of a thing that are its named part: "the legs of the table", "the left armrest".

Takes the owner's shape from a scene; `parts.py` tells the part by its shape.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ...rotations import to_matrix
from ...scene import Scene
from ..field.language_field import Group
from ..field.measure import box_of, lab_of_cloud
from . import parts

F64 = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Piece:
    """A part of a thing: its rows in the cloud, and what relations and superlatives can be asked of."""

    rows: NDArray[np.int64]
    group: Group


def pieces_of(
    scene: Scene, rows: NDArray[np.int64], owner: Group, front: F64 | None, name: str
) -> tuple[list[Piece], str]:
    """The pieces of an owner that are its part of this name, or none and a sentence why that cannot be told.

    Args:
        rows: the owner's in the scene's cloud; none for what is known by its colour only.
        front: `[3]` where the owner faces, world frame; None where that is not known.
    """
    if not len(rows):
        return [], "it is known by its colour only, and a colour has no parts"
    shape = shape_in(scene, rows, owner, front)
    flags = parts.part_of(name, shape)
    if isinstance(flags, str):
        return [], flags
    split = parts.pieces(shape, flags) if name in parts.SEVERAL else []
    found = split if len(split) > 1 else [np.flatnonzero(flags)]
    return [_piece(scene, rows[k], owner, name) for k in found], ""


def shape_in(scene: Scene, rows: NDArray[np.int64], group: Group, front: F64 | None) -> parts.Shape:
    """The shape of a group that owns some rows of a scene, facing `front` (`[3]`, world) or nowhere."""
    cloud = scene.cloud[torch.from_numpy(rows)]
    axes = to_matrix(cloud.quats)
    thin = axes[torch.arange(len(cloud)), :, cloud.scales.argmin(dim=1)]
    return parts.shape_of(cloud.means.double().cpu().numpy(), thin.double().cpu().numpy(), group.box, front)


def _piece(scene: Scene, rows: NDArray[np.int64], owner: Group, name: str) -> Piece:
    cloud = scene.cloud[torch.from_numpy(rows)]
    box = box_of(cloud, scene.frame, axes=owner.box.axes)
    return Piece(rows, Group(-1, "part", owner.id, name, 1.0, box, lab_of_cloud(cloud), len(rows), 0, 1.0))

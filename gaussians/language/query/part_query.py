"""Find the named part of an object in a scene, as one or more pieces: "the legs of the table", "the left armrest".

`parts.py` recognises the part from the shape of the object.
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
    """A piece of an object: its rows in the cloud, and a group for relations and superlatives."""

    rows: NDArray[np.int64]
    group: Group


def pieces_of(
    scene: Scene, rows: NDArray[np.int64], owner: Group, front: F64 | None, name: str
) -> tuple[list[Piece], str]:
    """The pieces of an object that form its part of this name, or none and the reason.

    Args:
        rows: rows of the object in the cloud; empty for an anchor that was selected by colour.
        front: `[3]` direction the object faces, world frame; None if unknown.
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
    """The shape of a group with some rows of a scene, with the direction `front` (`[3]`, world) it faces or None."""
    cloud = scene.cloud[torch.from_numpy(rows)]
    axes = to_matrix(cloud.quats)
    thin = axes[torch.arange(len(cloud)), :, cloud.scales.argmin(dim=1)]
    return parts.shape_of(cloud.means.double().cpu().numpy(), thin.double().cpu().numpy(), group.box, front)


def _piece(scene: Scene, rows: NDArray[np.int64], owner: Group, name: str) -> Piece:
    cloud = scene.cloud[torch.from_numpy(rows)]
    box = box_of(cloud, scene.frame, axes=owner.box.axes)
    return Piece(rows, Group(-1, "part", owner.id, name, 1.0, box, lab_of_cloud(cloud), len(rows), 0, 1.0))

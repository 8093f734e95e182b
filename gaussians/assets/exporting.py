"""Writes a part of a scene as a file of its own: as Gaussians, or as a mesh with colours (.glb)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from ..errors import UserError
from ..files import save, writer, writing
from ..motion.motion import with_only
from ..scene import Scene

MESH = ".glb"


def check_export(path: Path) -> None:
    """Check that a part can be written under this name.

    Raises:
        UserError: its suffix is neither that of a scene format nor ".glb".
    """
    if path.suffix.lower() != MESH:
        writer(path)


def export(scene: Scene, ids: Tensor, path: Path, force: bool = False) -> None:
    """Write the Gaussians with these ids: as a scene of their own in the same frame, or as a .glb.

    The .glb stands on its origin with y up and the scene's north at -z, in metres where the scene's scale is known.

    Raises:
        UserError: no Gaussian is selected, the suffix is unknown, or the file exists and `force` is not set.
        FileError: it cannot be written.
    """
    check_export(path)
    chosen = torch.isin(scene.cloud.ids, ids.to(scene.cloud.ids.device))
    if not bool(chosen.any()):
        raise UserError("nothing is selected, so there is nothing to write")
    cloud = scene.cloud[chosen]
    part = scene.replace(cloud=cloud, language=None, motion=with_only(scene.motion, cloud.ids.cpu().numpy()))
    if path.suffix.lower() != MESH:
        save(part, path, force=force)
        return
    data = _glb(part)
    with writing(path, force) as file:
        file.write(data)


def _glb(part: Scene) -> bytes:
    import trimesh

    from .modeling.meshing import mesh_of

    mesh = mesh_of(part.cloud)
    local = mesh.vertices @ part.frame.basis().T * (part.frame.metres_per_unit or 1.0)
    low, high = local.min(axis=0), local.max(axis=0)
    local -= [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]]
    placed = np.stack([local[:, 0], local[:, 2], -local[:, 1]], axis=1)
    colors = np.concatenate([mesh.colors, np.ones((len(placed), 1))], axis=1)
    made = trimesh.Trimesh(placed, mesh.faces, vertex_colors=(colors * 255 + 0.5).astype(np.uint8), process=False)
    data = made.export(file_type="glb")
    assert isinstance(data, bytes)
    return data

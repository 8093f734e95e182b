"""Saves a scene together with its language field, so that its things keep their names; the inverse of `loading`."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...errors import UserError
from ...files import save as save_file
from ...motion.runs import runs_of
from ...scene import Scene
from .store import column_fits, save_field


def save(scene: Scene, path: str | Path, force: bool = False) -> Path | None:
    """Write a scene atomically in the format that the file name asks for, with its motion and its language field beside
    it (`room.ply.motion.safetensors`, `room.ply.field.safetensors`), as `load` reads them.
    `scene.replace(language=None)` is written without names.

    Rows keep their order, except in formats where neighbouring rows share storage (compressed .ply, SPZ, SOG): there
    they are sorted along a Morton curve, unless the scene has a language field, which refers to rows by number.

    Returns:
        The path of the language field, None for a scene that has none.

    Raises:
        UserError: the format cannot be written, the scene is empty, its groups or its motion are those of another
            scene, or the file exists and `force` is not set.
        FileError: the folder is missing or cannot be written; an existing file is then unchanged.
    """
    table = scene.language
    if table is not None and not column_fits(scene.cloud.group.cpu().numpy(), table):
        raise UserError(
            f"the Gaussians are in groups that the language field, of {len(table.groups)} groups, does not have; embed "
            "the scene again, or save it without names: scene.replace(language=None)"
        )
    _check_motion(scene)
    save_file(scene, path, force)
    return None if table is None else save_field(scene, Path(path))


def _check_motion(scene: Scene) -> None:
    """Check that each part of the motion holds some Gaussian of the scene. Ids of Gaussians that were removed are left
    out when it is written.

    Raises:
        UserError: a part holds none, so that it would be lost.
    """
    motion = scene.motion
    if motion is None or not len(scene.cloud):
        return
    there = np.sort(scene.cloud.ids.cpu().numpy())
    parts = [(f"the track {track.name or i}", track.runs) for i, track in enumerate(motion.tracks)]
    parts += [(f"the look {i}", runs_of(look.ids)) for i, look in enumerate(motion.looks)]
    parts += [(f"the residual {i}", runs_of(residual.ids)) for i, residual in enumerate(motion.residuals)]
    for what, runs in parts:
        if not (np.searchsorted(there, runs[:, 1]) > np.searchsorted(there, runs[:, 0])).any():
            raise UserError(
                f"{what} of the motion holds no Gaussian of this scene (its ids go from {there[0]} to {there[-1]}), so "
                "that it would be lost; make it of ids of scene.cloud.ids, or leave it out of the motion"
            )

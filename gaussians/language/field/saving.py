"""Saves a scene together with its language field, so that its things keep their names; the inverse of `loading`."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...errors import UserError
from ...files import save as save_file
from ...motion.motion import mentioned_ids
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
    """Check that the motion holds some Gaussian of the scene.

    Parts of it whose Gaussians were removed are left out when it is written.

    Raises:
        UserError: it holds none, so that all of it would be lost.
    """
    motion = scene.motion
    if motion is None or not len(scene.cloud):
        return
    parts = (*motion.tracks, *motion.looks, *motion.residuals)
    if parts and not np.isin(mentioned_ids(motion), scene.cloud.ids.cpu().numpy()).any():
        raise UserError(
            "the motion holds no Gaussian of this scene, so that it would be lost; make it of ids of scene.cloud.ids, "
            "or leave it out: scene.replace(motion=None)"
        )

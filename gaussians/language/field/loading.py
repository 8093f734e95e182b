"""Loads a scene together with the language field that was saved for it."""

from __future__ import annotations

from pathlib import Path

from ...files import load as load_file
from ...files.remote import local
from ...scene import Scene
from .store import load_field


def load(path: str | Path) -> Scene:
    """The scene in a file or folder of any known format, with its saved language field and the frame that came with
    it, if there is one for exactly this file (see `scenewright embed`). The ids of its Gaussians are the row numbers of
    the file. A URL (`s3://`, `gs://`, `sftp://`) is fetched first, with what is beside it.

    Raises:
        FileError: the path is missing, unreadable, of an unknown format, or without a usable Gaussian; or its field is
            damaged.
    """
    path = local(path)
    scene = load_file(path)
    return load_field(scene, path) or scene

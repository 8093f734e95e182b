"""The one folder that tools may write to: names of files are checked against it, links included."""

from __future__ import annotations

import os
import unicodedata
from pathlib import Path, PurePosixPath

from .limits import ArgumentError

_MAX_NAME = 200  # bytes of one part; file systems allow 255, and temporary files need some


class Folder:
    """A folder, and the files below it that a caller may name.

    Attributes:
        root: its path without links.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.root = Path(os.path.realpath(path))

    def file(self, name: str) -> Path:
        """The path of a file below the folder, links followed.

        Raises:
            ArgumentError: the name is empty, absolute, leads out of the folder (by `..` or a link) or holds characters
                that do not belong in a name.
        """
        parts = PurePosixPath(name).parts
        if not parts or any(unicodedata.category(c).startswith("C") or c in '\\:*?"<>|' for c in name):
            raise ArgumentError(f"{name[:80]!r} is not the name of a file; use letters, digits, '-', '_' and '.'")
        if name.startswith(("/", "~")) or ".." in parts or any(len(os.fsencode(p)) > _MAX_NAME for p in parts):
            raise ArgumentError(f"{name[:80]!r} is not allowed; files are written only to the folder of the scene")
        path = Path(os.path.realpath(self.root.joinpath(*parts)))
        if not path.is_relative_to(self.root) or path == self.root:
            raise ArgumentError(f"{name[:80]!r} leads out of the folder of the scene; choose another name")
        return path

"""Encodes scenes in the format of a file and decodes them, for measuring what a format loses."""

from __future__ import annotations

from pathlib import Path

from ..errors import UserError
from ..files import known_formats, load
from ..scene import Scene


class Files:
    """Encodes scenes in the format of a suffix, in row order, and reads them back; `folder` is for scratch files.

    Raises:
        UserError: no format that can be written has this suffix.
    """

    def __init__(self, folder: Path, suffix: str) -> None:
        write = next((f.write for f in known_formats() if suffix in f.suffixes), None)
        if write is None:
            writable = ", ".join(s for f in known_formats() if f.write for s in f.suffixes)
            raise UserError(f"scenes are written as {writable}, not as {suffix}")
        self._path, self._write = folder / f"a{suffix}", write

    def encode(self, scene: Scene) -> bytes:
        """The bytes of a file whose rows are the scene's."""
        with self._path.open("wb") as file:
            self._write(scene, file)
        return self._path.read_bytes()

    def decode(self, data: bytes) -> Scene:
        """The scene in these bytes."""
        self._path.write_bytes(data)
        return load(self._path)

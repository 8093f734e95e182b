"""The fingerprint of a scene file, by which what is stored beside it is bound to its content."""

from __future__ import annotations

import hashlib
from pathlib import Path

from ..errors import FileError
from .formats.streamed_sog import scene_folder


def fingerprint(path: Path) -> str:
    """Hex SHA-256 of the bytes of a scene file; of the names and bytes of all files if the scene is a folder (SOG)."""
    h = hashlib.sha256()
    path = scene_folder(path)
    try:
        files = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
        for file in files:
            h.update(f"{file.relative_to(path).as_posix()};".encode() if path.is_dir() else b"")
            with file.open("rb") as stream:
                while block := stream.read(1 << 22):
                    h.update(block)
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror or error}") from error
    return h.hexdigest()

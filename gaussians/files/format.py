"""The interface of a file format (`Format`) and the report of reading a file (`Report`)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from ..scene import Scene

HEAD_BYTES = 65536  # of the start of a file, given to `Format.recognises`


@dataclass(frozen=True)
class Report:
    """The result of reading a scene file.

    Attributes:
        format: name of the format.
        rows: Gaussians in the file.
        loaded: Gaussians in the scene.
        notes: one sentence per kind of repair, with its count; empty if the file was valid.
    """

    format: str
    rows: int
    loaded: int
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Format:
    """One file format.

    Attributes:
        name: the name shown to users, e.g. "INRIA .ply".
        suffixes: lower case, with dot, longest first if one contains another.
        recognises: `(path, head)` -> whether the content is of this format; `head` is the first `HEAD_BYTES` of the
            file, empty for a folder. Must be cheap and must not raise.
        read: returns the scene and a report; raises FileError for anything it cannot read.
        write: writes the scene in row order into a binary file opened for writing; None if the format is read-only.
        made_by: of a format without `write`, the command that makes such a scene, to which a name is appended.
        morton_order: whether neighbouring rows share storage, so that files are smaller or more exact if rows follow a
            Morton curve.
    """

    name: str
    suffixes: tuple[str, ...]
    recognises: Callable[[Path, bytes], bool]
    read: Callable[[Path], tuple[Scene, Report]]
    write: Callable[[Scene, BinaryIO], None] | None = None
    morton_order: bool = False
    made_by: str = ""

"""What a file format offers, and what reading a file reports.

Knows no format. A format is a module of this package with a module-level `FORMAT`; the package finds it by scanning.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from ..scene import Scene

HEAD_BYTES = 65536  # of the start of a file that recognition may look at


@dataclass(frozen=True)
class Report:
    """What happened while a scene was read.

    Attributes:
        format: name of the format that read it.
        rows: Gaussians the file holds.
        loaded: Gaussians that became part of the scene.
        notes: each repair in a sentence with its count; empty if the file was sound.
    """

    format: str
    rows: int
    loaded: int
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Format:
    """One file format.

    Attributes:
        name: for people, e.g. "INRIA .ply".
        suffixes: lower case, with dot, longest first if one contains another.
        recognises: `(path, head)` whether the content is this format's; `head` is the first `HEAD_BYTES` of the file,
            empty for a folder. Must be cheap and must not raise.
        read: the scene and a report; raises FileError for anything it cannot read.
        write: puts the scene into a binary file opened for writing, row by row in order, or None if the format is
            only read.
        arranges: whether rows beside each other share storage, so that neighbours in space should be neighbours there.
    """

    name: str
    suffixes: tuple[str, ...]
    recognises: Callable[[Path, bytes], bool]
    read: Callable[[Path], tuple[Scene, Report]]
    write: Callable[[Scene, BinaryIO], None] | None = None
    arranges: bool = False

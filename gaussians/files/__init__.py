"""Scenes in files: `load`, `load_with_report`, `save`. The only room that knows logits, logarithms and packing.

One module a format; a module of this package with a `FORMAT` is a format (see `format.Format`), found by scanning.
Content decides which format a file has; its name decides only where the content does not say.
"""

from __future__ import annotations

import functools
import importlib
import pkgutil
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

from ..errors import FileError, UserError
from ..scene import Scene
from . import formats
from .atomic import writing
from .format import HEAD_BYTES, Format, Report
from .formats.morton import arranged

__all__ = ["Format", "Report", "known_formats", "load", "load_with_report", "save", "writer", "writing"]


@functools.cache
def known_formats() -> tuple[Format, ...]:
    """Every known format, by name."""
    names = (info.name for info in pkgutil.iter_modules(formats.__path__))
    modules = (importlib.import_module(f"{formats.__name__}.{name}") for name in names)
    found = [module.FORMAT for module in modules if hasattr(module, "FORMAT")]
    return tuple(sorted(found, key=lambda f: f.name))


def load(path: str | Path) -> Scene:
    """The scene in a file or folder of any known format; ids are the row numbers there.

    Raises:
        FileError: missing, unreadable, of unknown format, or without a single usable Gaussian.
    """
    return load_with_report(path)[0]


def load_with_report(path: str | Path) -> tuple[Scene, Report]:
    """As `load`, with what was found and repaired on the way."""
    path = Path(path)
    try:
        return _detect(path).read(path)
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror or error}") from error


def _detect(path: Path) -> Format:
    """The format of what lies at `path`: by content first, by name second."""
    if not path.exists():
        raise FileError(f"no such file or folder: {path}")
    if not (path.is_file() or path.is_dir()):
        raise FileError(f"{path} is neither a file nor a folder")
    head = b""
    if path.is_file():
        with open(path, "rb") as file:
            head = file.read(HEAD_BYTES)
    for known in known_formats():
        if known.recognises(path, head):
            return known
    if named := _by_suffix(path):
        return named
    raise FileError(_unknown(path))


def _unknown(path: Path) -> str:
    """What is wrong with a path that no format recognises."""
    if path.is_dir():
        inside = sorted(p.name for p in path.iterdir() if _promising(p))
        if inside:
            return f"{path} is a folder that holds scenes; name one of them: {', '.join(inside[:10])}"
    listed = "; ".join(f"{f.name} ({', '.join(f.suffixes)})" for f in known_formats())
    return f"{path}: unknown format. Known are: {listed}"


def _promising(path: Path) -> bool:
    """Whether something in a folder looks like a scene."""
    return any(f.recognises(path, b"") for f in known_formats()) if path.is_dir() else _by_suffix(path) is not None


def _by_suffix(path: Path) -> Format | None:
    """The format with the longest suffix that the name ends in."""
    name = path.name.lower()
    matches = [(len(s), f) for f in known_formats() for s in f.suffixes if name.endswith(s)]
    return max(matches, key=lambda m: m[0])[1] if matches else None


def save(scene: Scene, path: str | Path, force: bool = False) -> None:
    """Write a scene in the format its name asks for, whole or not at all.

    Rows keep their order, but for formats where neighbours share storage (compressed .ply, SPZ, SOG): there they are
    arranged along a Morton curve, unless the scene has a language field, which is bound to rows.

    Raises:
        UserError: the format cannot be written, the scene is empty, or the file exists and `force` is not set.
        FileError: the folder is missing or the disk refuses; an existing file is then unchanged.
    """
    path = Path(path)
    write = writer(path)
    if len(scene.cloud) == 0:
        raise UserError("there is nothing to save: the scene holds zero Gaussians")
    with writing(path, force) as file:
        write(scene, file)


def writer(path: Path) -> Callable[[Scene, BinaryIO], None]:
    """What writes a scene in the format that a name asks for, arranged as `save` says.

    Raises:
        UserError: no format that can be written has this name.
    """
    known = _by_suffix(path)
    if known is None or known.write is None:
        writable = ", ".join(s for f in known_formats() if f.write for s in f.suffixes)
        raise UserError(f"cannot write {path.name}: scenes are written as {writable}")
    write, arranges = known.write, known.arranges
    return lambda scene, file: write(arranged(scene) if arranges and scene.language is None else scene, file)

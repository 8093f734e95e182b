"""Loads and saves scenes in files: `load`, `load_with_report`, `save`.

Each module of `formats` with a `FORMAT` is one file format (see `format.Format`); the modules are found by scanning.
The format of a file is recognised by its content, and by its name only where the content does not decide. Logits,
logarithms and packed values exist only in this package.
"""

from __future__ import annotations

import functools
import importlib
import pkgutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import BinaryIO

from ..errors import FileError, UserError
from ..scene import Scene
from . import formats
from .atomic import writing
from .format import HEAD_BYTES, Format, Report
from .formats.morton import morton_sorted
from .motion_file import load_motion, save_motion
from .remote import local

__all__ = ["Format", "Report", "known_formats", "load", "load_with_report", "save", "stored_order", "writer", "writing"]


@functools.cache
def known_formats() -> tuple[Format, ...]:
    """Every known format, sorted by name."""
    names = (info.name for info in pkgutil.iter_modules(formats.__path__))
    modules = (importlib.import_module(f"{formats.__name__}.{name}") for name in names)
    found = [module.FORMAT for module in modules if hasattr(module, "FORMAT")]
    return tuple(sorted(found, key=lambda f: f.name))


def load(path: str | Path) -> Scene:
    """The scene in a file or folder of any known format, with the motion beside it, if there is one for exactly this
    file; the ids of its Gaussians are the row numbers of the file. A URL is fetched first (see `remote`).

    Raises:
        FileError: the path is missing, unreadable, of an unknown format, or without a usable Gaussian;
            or its motion is damaged.
    """
    return load_with_report(path)[0]


def load_with_report(path: str | Path) -> tuple[Scene, Report]:
    """As `load`, with a report of the file's format, its rows and the repairs made while reading."""
    path = local(path)
    try:
        scene, report = _detect(path).read(path)
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror or error}") from error
    scene, notes = load_motion(scene, path)
    return scene, replace(report, notes=(*report.notes, *notes))


def _detect(path: Path) -> Format:
    """The format of the file or folder at `path`: by content first, by name second."""
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
    """The error message for a path that no format recognises."""
    if path.is_dir():
        inside = sorted(p.name for p in path.iterdir() if _looks_like_scene(p))
        if inside:
            return f"{path} is a folder that holds scenes; name one of them: {', '.join(inside[:10])}"
    listed = "; ".join(f"{f.name} ({', '.join(f.suffixes)})" for f in known_formats())
    return f"{path}: unknown format. Known formats are: {listed}"


def _looks_like_scene(path: Path) -> bool:
    """Whether an entry of a folder looks like a scene."""
    return any(f.recognises(path, b"") for f in known_formats()) if path.is_dir() else _by_suffix(path) is not None


def _by_suffix(path: Path) -> Format | None:
    """The format with the longest suffix that the name ends with, or None."""
    name = path.name.lower()
    matches = [(len(s), f) for f in known_formats() for s in f.suffixes if name.endswith(s)]
    return max(matches, key=lambda m: m[0])[1] if matches else None


def save(scene: Scene, path: str | Path, force: bool = False) -> None:
    """Write a scene atomically in the format that the file name asks for, and its motion beside it.

    Rows keep their order, except in formats where neighbouring rows share storage (compressed .ply, SPZ, SOG): there
    they are sorted along a Morton curve, unless the scene has a language field, which refers to rows by number.

    Raises:
        UserError: the format cannot be written, the scene is empty, or the file exists and `force` is not set.
        FileError: the folder is missing or cannot be written; an existing file is then unchanged.
    """
    path = Path(path)
    known, write = _writable(path)
    if len(scene.cloud) == 0:
        raise UserError("there is nothing to save: the scene holds zero Gaussians")
    ordered = _ordered(scene, known)
    with writing(path, force) as file:
        write(ordered, file)
    save_motion(ordered, path)


def writer(path: Path) -> Callable[[Scene, BinaryIO], None]:
    """The function that writes a scene in the format of a file name, with rows ordered as in `save`.

    Raises:
        UserError: no writable format has this suffix.
    """
    known, write = _writable(path)
    return lambda scene, file: write(_ordered(scene, known), file)


def stored_order(scene: Scene, path: Path) -> Scene:
    """The scene with its rows in the order in which the format of a file name takes the fewest bytes; ids and groups
    stay with their rows. `save` keeps that order.

    Raises:
        UserError: no writable format has this suffix.
    """
    return morton_sorted(scene) if _writable(path)[0].morton_order else scene


def _ordered(scene: Scene, known: Format) -> Scene:
    """The scene with its rows in the order in which a format stores them; ids stay with their rows."""
    return morton_sorted(scene) if known.morton_order and scene.language is None else scene


def _writable(path: Path) -> tuple[Format, Callable[[Scene, BinaryIO], None]]:
    """The format of a file name, and its function that writes rows as they are. Raises UserError if there is none."""
    known = _by_suffix(path)
    if known is None:
        writable = ", ".join(s for f in known_formats() if f.write for s in f.suffixes)
        raise UserError(f"cannot write {path.name}: scenes are written as {writable}")
    if known.write is None:
        raise UserError(
            f"{known.name} is a folder that only `scenewright {known.made_by} {path.name}` makes: write the scene to "
            f"{path.stem}.ply first"
        )
    return known, known.write

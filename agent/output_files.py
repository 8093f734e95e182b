"""Checks of output paths, made before the work: overwriting, missing folders, suffixes."""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from ..gaussians.errors import FileError, UserError


def refuse_existing(paths: Iterable[Path], force: bool) -> None:
    """Check that no file would be overwritten.

    Raises:
        UserError: one of the paths exists and `force` is not set.
    """
    for path in paths:
        if path.exists() and not force:
            raise UserError(f"{path} exists; choose another name, or overwrite it with --force")


def require_folder(path: Path) -> None:
    """Check that the folder of a file exists.

    Raises:
        FileError: it does not.
    """
    if not path.absolute().parent.is_dir():
        raise FileError(f"the folder {path.absolute().parent} does not exist; create it first")


def folder_of(scene: Path) -> Path:
    """The folder that a session writes to: where the scene lies. A scene that is a folder itself (SOG, levels of
    detail) stays as it is: files in it would make it another scene, whose language field is no longer its own."""
    from ..gaussians.files.formats import sog
    from ..gaussians.files.formats.streamed_sog import scene_folder

    whole = scene_folder(scene.absolute())
    return (whole.parent if whole.name == sog.META else whole).parent


def make_folder(path: Path) -> None:
    """Make a folder and its parents, if it does not exist.

    Raises:
        UserError: there is a file of that name.
        FileError: the system does not allow it.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError) as error:
        raise UserError(f"{path} cannot be made as a folder: a file has that name; choose another name") from error
    except OSError as error:
        raise FileError(f"cannot make the folder {path}: {error.strerror}; choose one that you may write to") from error


def require_png(path: Path) -> None:
    """Check that the name of a picture ends in .png.

    Raises:
        UserError: it does not.
    """
    if path.suffix.lower() != ".png":
        raise UserError(f"cannot write {path}: pictures are written as .png")


def write_whole(paths: Sequence[Path], make: Callable[[int, Path], None], force: bool) -> None:
    """Make files of one folder in a hidden one, and move them to their places after the last: all of them or none.

    Args:
        make: writes the i-th file to a path; what it writes beside that goes along.

    Raises:
        UserError: a file was made by others in the meantime and `force` is not set.
        FileError: they cannot be written.
    """
    folder = paths[0].parent
    make_folder(folder.absolute().parent)
    fresh = not folder.exists()
    staged = (folder.parent if fresh else folder) / f".{folder.name[:100]}.{secrets.token_hex(6)}.part"
    make_folder(staged)
    try:
        for i, path in enumerate(paths):
            make(i, staged / path.name)
        refuse_existing(paths, force)
        if fresh and not folder.exists():
            os.rename(staged, folder)
            return
        for made in sorted(staged.iterdir()):
            os.replace(made, folder / made.name)
    except OSError as error:
        raise FileError(f"cannot write into {folder}: {error.strerror or error}") from error
    finally:
        shutil.rmtree(staged, ignore_errors=True)

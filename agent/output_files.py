"""Files that a command is going to leave behind: whether they may be written, asked before the work and not after it.

Knows paths. Refuses to know what is written.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from ..gaussians.errors import FileError, UserError


def refuse_existing(paths: Iterable[Path], force: bool) -> None:
    """Say at once that a file would be overwritten.

    Raises:
        UserError: one of the paths exists and `force` is not set.
    """
    for path in paths:
        if path.exists() and not force:
            raise UserError(f"{path} exists; choose another name, or overwrite it with --force")


def require_folder(path: Path) -> None:
    """Say at once that there is no folder for a file.

    Raises:
        FileError: there is none.
    """
    if not path.absolute().parent.is_dir():
        raise FileError(f"the folder {path.absolute().parent} does not exist; create it first")


def make_folder(path: Path) -> None:
    """Make a folder, and those above it, if it is not there.

    Raises:
        UserError: there is a file of that name.
        FileError: the system refuses.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError) as error:
        raise UserError(f"{path} is to be a folder, but a file stands in its way; choose another name") from error
    except OSError as error:
        raise FileError(f"cannot make the folder {path}: {error.strerror}; choose one that you may write to") from error


def require_png(path: Path) -> None:
    """Pictures are written as PNG; another suffix would lie.

    Raises:
        UserError: the name ends otherwise.
    """
    if path.suffix.lower() != ".png":
        raise UserError(f"cannot write {path}: pictures are written as .png")

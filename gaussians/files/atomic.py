"""Atomic writing of files and folders: the complete one appears or none does, and what exists is replaced on request
only."""

from __future__ import annotations

import contextlib
import os
import secrets
import shutil
import stat
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import BinaryIO

from ..errors import FileError, UserError


@contextlib.contextmanager
def writing(path: str | Path, force: bool = False) -> Iterator[BinaryIO]:
    """A binary file that replaces `path` when the block succeeds and is removed when it fails.

    The bytes are written to a hidden file in the same folder, synced to disk, and renamed over `path` in one step. A
    full disk, a crash or an exception in the block therefore leaves the old file unchanged. A link is followed, not
    replaced.

    Raises:
        UserError: `path` exists and `force` is not set, or it is a folder.
        FileError: the folder is missing or cannot be written.
    """
    target = Path(os.path.realpath(path))
    _check_target(target, force)
    part = target.with_name(f".{target.name[:100]}.{secrets.token_hex(6)}.part")  # unique among concurrent writers
    try:
        with open(part, "xb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
            if target.exists():
                os.fchmod(file.fileno(), stat.S_IMODE(target.stat().st_mode))
        _check_target(target, force)  # another program may have created it meanwhile
        os.replace(part, target)
        _sync_folder(target.parent)
    except OSError as error:
        raise FileError(f"cannot write {target}: {error.strerror or error}; the file there was not changed") from error
    finally:
        with contextlib.suppress(OSError):  # a folder that cannot be written holds no partial file either
            part.unlink(missing_ok=True)


@contextlib.contextmanager
def writing_folder(path: Path, force: bool, ours: Callable[[Path], bool]) -> Iterator[Path]:
    """An empty folder that becomes `path` when the block succeeds and is removed when it fails.

    An existing folder is moved aside first and removed last; a crash between leaves it beside `path` under a hidden
    name that ends in ".old".

    Args:
        ours: whether a file of an existing folder is of the kind that is written, by its path in that folder. A folder
            with other files is not replaced, `force` or not.

    Raises:
        UserError: `path` exists and `force` is not set, is a file, or holds other files.
        FileError: its parent folder is missing or cannot be written.
    """
    target = Path(os.path.realpath(path))
    _check_folder(target, force, ours)
    part, old = (target.with_name(f".{target.name[:100]}.{secrets.token_hex(6)}.{end}") for end in ("part", "old"))
    try:
        part.mkdir()
        yield part
        for written in (p for p in part.rglob("*") if p.is_file()):
            with written.open("rb+") as file:
                os.fsync(file.fileno())
        _check_folder(target, force, ours)
        if target.exists():
            os.rename(target, old)
        os.rename(part, target)
        _sync_folder(target.parent)
    except OSError as error:
        if old.exists() and not target.exists():
            os.rename(old, target)
        raise FileError(f"cannot write {target}: {error.strerror or error}; what is there was not changed") from error
    finally:
        shutil.rmtree(part, ignore_errors=True)
        shutil.rmtree(old, ignore_errors=True)


def _check_folder(target: Path, force: bool, ours: Callable[[Path], bool]) -> None:
    if not target.parent.is_dir():
        raise FileError(f"the folder {target.parent} does not exist; create it first")
    if not target.exists():
        return
    if not force:
        raise UserError(f"{target} exists; choose another name, or overwrite it with --force (force=True)")
    if not target.is_dir():
        raise UserError(f"{target} is a file; choose another name for the folder")
    strange = [p for p in target.rglob("*") if not p.is_dir() and not ours(p.relative_to(target))]
    if strange:
        raise UserError(
            f"{target} also holds {strange[0].relative_to(target)}, which is not of such a folder; move it away"
        )


def _check_target(target: Path, force: bool) -> None:
    if target.is_dir():
        raise UserError(f"{target} is a folder; give the name of a file in it")
    if not target.parent.is_dir():
        raise FileError(f"the folder {target.parent} does not exist; create it first")
    if target.exists() and not force:
        raise UserError(f"{target} exists; choose another name, or overwrite it with --force (force=True)")


def _sync_folder(folder: Path) -> None:
    """Make the rename durable. Some network disks cannot sync folders; the file's data is on disk in any case."""
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)

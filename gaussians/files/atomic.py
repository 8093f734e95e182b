"""Atomic file writing: the complete file appears or none does, and existing files are only replaced on request."""

from __future__ import annotations

import contextlib
import os
import secrets
import stat
from collections.abc import Iterator
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

"""Files that appear whole or not at all, and never over another one unasked. Knows nothing of what is written."""

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
    """A binary file that takes the place of `path` when the block ends well, and leaves no trace when it does not.

    The bytes go to a hidden file in the same folder, reach the disk, and are renamed over `path` in one step, so a
    full disk, a crash or an exception in the block leaves the old file as it was. A link is followed, not replaced.

    Raises:
        UserError: `path` exists and `force` is not set, or it is a folder.
        FileError: the folder is missing or the system refuses to write.
    """
    target = Path(os.path.realpath(path))
    _check_target(target, force)
    part = target.with_name(f".{target.name[:100]}.{secrets.token_hex(6)}.part")  # nobody else's, whatever runs beside
    try:
        with open(part, "xb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
            if target.exists():
                os.fchmod(file.fileno(), stat.S_IMODE(target.stat().st_mode))
        _check_target(target, force)  # it may have appeared while we wrote
        os.replace(part, target)
        _sync_folder(target.parent)
    except OSError as error:
        raise FileError(f"cannot write {target}: {error.strerror or error}; the file there was not changed") from error
    finally:
        with contextlib.suppress(OSError):  # where nothing may be written, nothing was
            part.unlink(missing_ok=True)


def _check_target(target: Path, force: bool) -> None:
    if target.is_dir():
        raise UserError(f"{target} is a folder; give the name of a file in it")
    if not target.parent.is_dir():
        raise FileError(f"the folder {target.parent} does not exist; create it first")
    if target.exists() and not force:
        raise UserError(f"{target} exists; choose another name, or overwrite it with --force (force=True)")


def _sync_folder(folder: Path) -> None:
    """Make the rename itself last; where folders cannot be synced (some network disks) the data is safe anyway."""
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)

"""Keeps two programs from changing one folder of tiles: a lock that ends with its process, however that ends."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import FileError

NAME = "LOCK"


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """The right to change the folder, for the block. Reading needs none: files never change once they are named.

    Raises:
        FileError: another program has it, or the folder cannot be written.
    """
    try:
        file = open(folder / NAME, "a+b")  # noqa: SIM115 (closed below)
    except OSError as error:
        raise FileError(f"cannot change {folder}: {error.strerror or error}") from error
    try:
        if not _taken(file.fileno()):
            raise FileError(f"{folder} is being changed by another program; wait until that is done")
        yield
    finally:
        file.close()


def _taken(handle: int) -> bool:
    if sys.platform == "win32":
        import msvcrt

        try:
            os.lseek(handle, 0, os.SEEK_SET)
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True
    import fcntl

    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True

"""Keeps two sessions from writing to one log: an advisory lock on a file beside the log.

The operating system drops the lock when its process ends, however it ends, so a lock file that a crash left behind is
recognised as stale and taken over. The file says in words who holds the lock, for the message to the other session.
"""

from __future__ import annotations

import json
import os
import socket
import sys
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, BinaryIO

from ...gaussians.errors import FileError

SUFFIX = ".lock"
_TRIES = 20  # a lock file may be removed by its holder just when it is opened here


class LogLock:
    """The right to write to one log, from construction until `release`.

    Raises:
        FileError: another session writes to this log, or the lock file cannot be written.
    """

    def __init__(self, log: Path) -> None:
        self.path = log.with_name(log.name + SUFFIX)
        self._file: BinaryIO | None = None
        if log.exists() and not log.is_file():
            return  # a device or a pipe, which nobody reads back
        try:
            self._file = self._acquired()
        except OSError as error:
            raise FileError(f"cannot open the session log {log}: {error.strerror} ({self.path})") from error
        if self._file is None:
            raise FileError(
                f"the session log {log} is in use{_holder(self.path)}; end that session, or write to another --log"
            )

    def release(self) -> None:
        """Give the lock back and remove its file; releasing twice is harmless."""
        if self._file is None:
            return
        with suppress(OSError):  # before it is unlocked, so that no other session locks a file that is about to go
            self.path.unlink()
        self._file.close()
        with suppress(OSError):  # where an open file cannot be removed
            if sys.platform == "win32":
                self.path.unlink()
        self._file = None

    def _acquired(self) -> BinaryIO | None:
        """The lock file, locked and with the holder in it; None if another session holds it."""
        for _ in range(_TRIES):
            file = open(self.path, "a+b")  # noqa: SIM115 (closed by `release`)
            if not _locked(file):
                file.close()
                return None
            if _is_at(file, self.path):
                file.truncate(0)
                file.write(json.dumps(_self()).encode())
                file.flush()
                return file
            file.close()
        return None


def _locked(file: BinaryIO) -> bool:
    """Lock a file without waiting; True if it is now locked here, or if its file system knows no locks."""
    if sys.platform == "win32":
        import msvcrt

        try:
            file.seek(0)
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True
    import fcntl

    try:
        fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return True


def _is_at(file: BinaryIO, path: Path) -> bool:
    """Whether an open file is the one that stands at a path now."""
    try:
        return os.path.samestat(os.fstat(file.fileno()), path.stat())
    except OSError:
        return False


def _self() -> dict[str, Any]:
    return {
        "process": os.getpid(),
        "host": socket.gethostname(),
        "since": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def _holder(path: Path) -> str:
    """Who holds the lock, as the end of a sentence; "" if the file does not tell."""
    try:
        held = json.loads(path.read_text())
        return f" by process {held['process']} on {held['host']} since {held['since']}"
    except (OSError, ValueError, KeyError, TypeError):
        return ""

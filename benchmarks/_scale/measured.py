"""Command lines as processes of their own, with their seconds, processor time and peak of memory."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...gaussians.errors import BackendError

_POLL = 0.02  # seconds between two looks at the memory of a process


@dataclass(frozen=True)
class Run:
    """What a command took.

    Attributes:
        data: its answer.
        seconds: from start to end.
        processor: seconds of processor time, of user and system.
        bytes: the peak of its resident memory.
    """

    data: dict[str, Any]
    seconds: float
    processor: float
    bytes: int


def command(*arguments: object) -> Run:
    """Run `scenewright` with some arguments and `--json`.

    Raises:
        BackendError: it failed.
    """
    line = [sys.executable, "-m", "scenewright", *map(str, arguments), "--json"]
    started = time.perf_counter()
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        process = subprocess.Popen(line, stdout=out, stderr=err)
        peak, (ended, status, used) = 0, os.wait4(process.pid, os.WNOHANG)
        while not ended:
            peak = max(peak, _peak(process.pid))
            time.sleep(_POLL)
            ended, status, used = os.wait4(process.pid, os.WNOHANG)
        process.returncode = os.waitstatus_to_exitcode(status)
        seconds = time.perf_counter() - started
        for stream in (out, err):
            stream.seek(0)
        if process.returncode:
            raise BackendError(f"{' '.join(line[3:])} ended with {process.returncode}: {err.read().decode()[-500:]}")
        data = json.loads(out.read())
    return Run(data, seconds, used.ru_utime + used.ru_stime, peak)


def _peak(process: int) -> int:
    """Peak of the resident memory of a process so far, bytes; 0 where the system does not tell.

    `wait4` tells the peak of what was there before the program was loaded too: that of this process.
    """
    try:
        lines = Path(f"/proc/{process}/status").read_text().splitlines()
    except OSError:
        return 0
    return sum(int(line.split()[1]) * 1024 for line in lines if line.startswith("VmHWM"))


def size_of(folder: Path) -> int:
    """Bytes of the files of a folder."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())

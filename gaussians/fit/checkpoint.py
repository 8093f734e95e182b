"""A training on the disk, so that it goes on where a crash ended it: one safetensors file, replaced whole.

Knows the file. Refuses to know what the numbers mean. Nothing in it is code; a file in which a single bit is not as it
was written is refused.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Mapping
from glob import escape
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import FileError
from ..files import writing

VERSION = "2"


def keep(path: Path, arrays: Mapping[str, Any], state: Mapping[str, Any]) -> None:
    """Write arrays and a JSON state; an older checkpoint is replaced only by a whole one.

    Raises:
        FileError: it cannot be written (a full disk); the message says how to go on.
    """
    from safetensors.numpy import save

    told = json.dumps(state)
    tensors = {name: np.asarray(value, order="C") for name, value in arrays.items()}
    whole = save(tensors, {"version": VERSION, "state": told, "sha256": _digest(tensors, told)})
    try:
        with writing(path, force=True) as file:
            file.write(whole)
    except FileError as error:
        raise FileError(f"{error}; make room and give the same command again") from error


def _digest(arrays: Mapping[str, Any], state: str) -> str:
    found = hashlib.sha256(state.encode())
    for name in sorted(arrays):
        found.update(f"{name} {arrays[name].dtype} {arrays[name].shape}".encode())
        found.update(np.ascontiguousarray(arrays[name]).data)
    return found.hexdigest()


def drop(path: Path) -> None:
    """Take a checkpoint away, and what a crash in the middle of writing one left behind."""
    for part in (path, *path.parent.glob(f".{escape(path.name)}.*.part")):
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)


def resume(path: Path) -> tuple[dict[str, Any], dict[str, Any]] | None:
    """Arrays and state of a checkpoint; None if there is none.

    Raises:
        FileError: it is there but cannot be used; the message says to take it away.
    """
    from safetensors import SafetensorError, safe_open

    if not path.exists():
        return None
    try:
        with safe_open(path, "numpy") as file:
            told = file.metadata() or {}
            arrays = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
        if told.get("version") != VERSION:
            raise ValueError(f"its version is {told.get('version')!r}, not {VERSION}")
        if told["sha256"] != _digest(arrays, told["state"]):
            raise ValueError("it has changed since it was written")
        return arrays, json.loads(told["state"])
    except (OSError, SafetensorError, ValueError, KeyError) as error:
        raise FileError(f"{path} is no checkpoint to go on from ({error}); delete it to begin anew") from error

"""Checkpoints of a training: one safetensors file, replaced atomically, from which a training resumes after a crash.

The file contains no code. A file whose checksum does not match is refused.
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

VERSION = "3"


def save(path: Path, arrays: Mapping[str, Any], state: Mapping[str, Any]) -> None:
    """Write arrays and a JSON state; an older checkpoint is replaced only by a complete one.

    Raises:
        FileError: it cannot be written (for example a full disk); the message says how to resume.
    """
    from safetensors import numpy

    text = json.dumps(state)
    tensors = {name: np.asarray(value, order="C") for name, value in arrays.items()}
    data = numpy.save(tensors, {"version": VERSION, "state": text, "sha256": _digest(tensors, text)})
    try:
        with writing(path, force=True) as file:
            file.write(data)
    except FileError as error:
        raise FileError(f"{error}; free some disk space and run the same command again") from error


def _digest(arrays: Mapping[str, Any], state: str) -> str:
    found = hashlib.sha256(state.encode())
    for name in sorted(arrays):
        found.update(f"{name} {arrays[name].dtype} {arrays[name].shape}".encode())
        found.update(np.ascontiguousarray(arrays[name]).data)
    return found.hexdigest()


def delete(path: Path) -> None:
    """Delete a checkpoint, and partial files that a crash during writing left behind."""
    for part in (path, *path.parent.glob(f".{escape(path.name)}.*.part")):
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)


def load(path: Path) -> tuple[dict[str, Any], dict[str, Any]] | None:
    """Arrays and state of a checkpoint; None if the file does not exist.

    Raises:
        FileError: the file cannot be used; the message says to delete it.
    """
    from safetensors import SafetensorError, safe_open

    if not path.exists():
        return None
    try:
        with safe_open(path, "numpy") as file:
            metadata = file.metadata() or {}
            arrays = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
        if metadata.get("version") != VERSION:
            raise ValueError(f"its version is {metadata.get('version')!r}, not {VERSION}")
        if metadata["sha256"] != _digest(arrays, metadata["state"]):
            raise ValueError("it has changed since it was written")
        return arrays, json.loads(metadata["state"])
    except (OSError, SafetensorError, ValueError, KeyError) as error:
        raise FileError(f"cannot resume from {path} ({error}); delete it to start over") from error

"""Reads untrusted JSON and NumPy files: every defect raises `FileError`, and nothing is unpickled."""

from __future__ import annotations

import json
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import FileError

# What NumPy and zipfile raise for truncated, corrupted, encrypted or forged files; a header may ask for terabytes.
_BROKEN = (OSError, ValueError, EOFError, KeyError, RuntimeError, zipfile.BadZipFile, zlib.error, MemoryError)


def read_json(path: Path) -> Any:
    """The parsed content of a JSON file.

    Raises:
        FileError: the file cannot be read, is not JSON, or is nested too deeply.
    """
    try:
        return json.loads(path.read_text(encoding="utf-8-sig"))  # Windows programs write a byte order mark
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror or error}") from error
    except (ValueError, RecursionError) as error:
        raise FileError(f"{path} is not valid JSON: {error}") from error


def read_array(path: Path) -> NDArray[Any]:
    """The array in a `.npy` file; object arrays are refused.

    Raises:
        FileError: the file cannot be read or holds something else.
    """
    try:
        held = np.load(path, allow_pickle=False)
    except _BROKEN as error:
        raise FileError(f"cannot read {path}: {error or type(error).__name__}") from error
    if not isinstance(held, np.ndarray):
        held.close()
        raise FileError(f"cannot read {path}: it is an archive (.npz), not one array")
    return held


def read_archive(path: Path) -> dict[str, NDArray[Any]]:
    """The arrays in a `.npz` file by name; object arrays are refused, members that are not arrays are skipped.

    Raises:
        FileError: the file cannot be read or holds something else.
    """
    try:
        held = np.load(path, allow_pickle=False)
        if isinstance(held, np.ndarray):
            raise FileError(f"cannot read {path}: it is one array (.npy), not an archive")
        with held:
            return {name: array for name in held.files if isinstance(array := held[name], np.ndarray)}
    except _BROKEN as error:
        raise FileError(f"cannot read {path}: {error or type(error).__name__}") from error

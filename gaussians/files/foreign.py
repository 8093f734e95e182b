"""JSON and NumPy files that anybody may have written: whatever is wrong with one is one `FileError`.

Knows how such files break. Refuses to know what is in them, and to unpickle anything.
"""

from __future__ import annotations

import json
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import FileError

# What NumPy and zipfile raise for cut, overwritten, encrypted or lying files; a header may ask for terabytes.
_BROKEN = (OSError, ValueError, EOFError, KeyError, RuntimeError, zipfile.BadZipFile, zlib.error, MemoryError)


def read_json(path: Path) -> Any:
    """What a JSON file says.

    Raises:
        FileError: it cannot be read, is no JSON, or is nested too deeply to be any file of ours.
    """
    try:
        return json.loads(path.read_text(encoding="utf-8-sig"))  # Windows marks its files
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror or error}") from error
    except (ValueError, RecursionError) as error:
        raise FileError(f"{path} is no JSON: {error}") from error


def read_array(path: Path) -> NDArray[Any]:
    """The array in a `.npy`, never of objects.

    Raises:
        FileError: it cannot be read or holds something else.
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
    """The arrays in a `.npz` by name, never of objects; members that are no arrays are left out.

    Raises:
        FileError: it cannot be read or holds something else.
    """
    try:
        held = np.load(path, allow_pickle=False)
        if isinstance(held, np.ndarray):
            raise FileError(f"cannot read {path}: it is one array (.npy), not an archive")
        with held:
            return {name: array for name in held.files if isinstance(array := held[name], np.ndarray)}
    except _BROKEN as error:
        raise FileError(f"cannot read {path}: {error or type(error).__name__}") from error

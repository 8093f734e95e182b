"""Files of a folder of tiles: plain little-endian arrays and JSON, hashed when they are written and checked when read.

A file is written once under a name of its own, synced, and never changed after.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
from io import FileIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import FileError
from .records import Stored

_BLOCK = 1 << 22  # bytes hashed at a time

Array = NDArray[Any]


def write(folder: Path, name: str, content: Array | bytes) -> Stored:
    """Write a new file and sync it.

    Raises:
        FileError: it cannot be written, because the disk is full for instance.
    """
    data = content if isinstance(content, bytes) else np.ascontiguousarray(content).view(np.uint8).reshape(-1).data
    try:
        with open(folder / name, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        raise FileError(
            f"cannot write {folder / name}: {error.strerror or error}; the scene was not changed"
        ) from error
    return Stored(file=name, sha256=hashlib.sha256(data).hexdigest())


def allocated(path: Path, kind: np.dtype[Any], shape: tuple[int, ...]) -> Array:
    """A new file as an array that can be written, with room on the disk for all of it: without, a full disk would end
    the process (SIGBUS) when a page is written.

    Raises:
        FileError: the disk is full, or the file cannot be written.
    """
    size = kind.itemsize * int(np.prod(shape, dtype=np.int64))
    try:
        with open(path, "xb") as file:
            if hasattr(os, "posix_fallocate") and size:
                os.posix_fallocate(file.fileno(), 0, size)
            else:
                for start in range(0, size, _BLOCK):
                    file.write(bytes(min(_BLOCK, size - start)))
    except OSError as error:
        told = error.strerror or str(error)
        raise FileError(f"cannot write {size / 1e9:.1f} GB to {path.parent}: {told}; make room on the disk") from error
    return np.memmap(path, kind, "r+", shape=shape) if size else np.zeros(shape, kind)


def mapped(folder: Path, stored: Stored, kind: np.dtype[Any], shape: tuple[int, ...], checked: bool = True) -> Array:
    """A read-only array over a file, whose pages the system loads and drops as it likes.

    Args:
        checked: compare the bytes with the hash; without it only the size is compared.

    Raises:
        FileError: the file is missing, or its size or bytes are not what the index says.
    """
    path = folder / stored.file
    wanted = kind.itemsize * int(np.prod(shape, dtype=np.int64))
    try:
        size = path.stat().st_size
        if size != wanted:
            raise FileError(f"{path} has {size:,} bytes, the index says {wanted:,}: {ADVICE}")
        if checked:
            check(folder, stored)
        return np.memmap(path, kind, "r", shape=shape) if wanted else np.zeros(shape, kind)
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror or error}: {ADVICE}") from error


def rows(folder: Path, stored: Stored, kind: np.dtype[Any], shape: tuple[int, ...], wanted: NDArray[np.int64]) -> Array:
    """Some rows of a file whose rows have a shape, read one by one: so that few rows of a large file fill no memory.
    Their bytes are not compared with the hash, which is that of the whole file.

    Raises:
        FileError: the file cannot be read or ends before a row.
    """
    size = kind.itemsize * int(np.prod(shape, dtype=np.int64))
    try:
        with open(folder / stored.file, "rb", buffering=0) as file:
            found = b"".join(_part(file, row * size, size) for row in wanted.tolist())
    except OSError as error:
        raise FileError(f"cannot read {folder / stored.file}: {error.strerror or error}: {ADVICE}") from error
    if len(found) != size * len(wanted):
        raise FileError(f"{folder / stored.file} is cut off: {ADVICE}")
    return np.frombuffer(found, kind).reshape(len(wanted), *shape)


def _part(file: FileIO, start: int, size: int) -> bytes:
    file.seek(start)
    return file.read(size)


def sync(folder: Path) -> None:
    """Make the names of new files in a folder durable. Some network disks cannot; their data is on disk in any case."""
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def content(folder: Path, stored: Stored, most: int) -> bytes:
    """The bytes of a small file, at most `most`.

    Raises:
        FileError: as `mapped`.
    """
    path = folder / stored.file
    try:
        if path.stat().st_size > most:
            raise FileError(f"{path} is larger than such a file can be: {ADVICE}")
        found = path.read_bytes()
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror or error}: {ADVICE}") from error
    if hashlib.sha256(found).hexdigest() != stored.sha256:
        raise FileError(f"{path} is damaged (its bytes have another hash): {ADVICE}")
    return found


def check(folder: Path, stored: Stored) -> None:
    """Compare the bytes of a file with its hash. They are read, not mapped: so they fill no memory of this process.

    Raises:
        FileError: they differ.
    """
    digest = hashlib.sha256()
    block = bytearray(_BLOCK)
    try:
        with open(folder / stored.file, "rb", buffering=0) as file:
            while count := file.readinto(block):
                digest.update(memoryview(block)[:count])
    except OSError as error:
        raise FileError(f"cannot read {folder / stored.file}: {error.strerror or error}: {ADVICE}") from error
    if digest.hexdigest() != stored.sha256:
        raise FileError(f"{folder / stored.file} is damaged (its bytes have another hash): {ADVICE}")


ADVICE = "copy the folder again, undo the last edit (`scenewright edit FOLDER --undo`), or tile the scene again"

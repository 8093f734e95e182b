"""An in-memory cache of image vectors for the process, keyed by encoder fingerprint and pixel hash.

Encoders with the same fingerprint share vectors. Images are encoded in batches of a fixed size: the last bits of a
vector depend on the size of its batch but not on its position there, so cached vectors equal recomputed ones.

The cache is not saved to disk: the language field beside a scene serves reloading, and in an edited scene the middle,
and with it every render of a group, has changed.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from hashlib import blake2b

import numpy as np
from numpy.typing import NDArray

from . import Encoder, checked_images

F32 = NDArray[np.float32]
BATCH = 16  # images encoded at a time; the last batch is padded with blank ones
MAX_BYTES = 64 * 2**20  # of vectors, least recently used evicted first: 30,000 images at 512 numbers

Key = tuple[str, bytes]  # fingerprint and shape; hash of the pixels


class VectorCache:
    """A bounded, thread-safe LRU cache of vectors."""

    def __init__(self, max_bytes: int = MAX_BYTES) -> None:
        self._held: OrderedDict[Key, F32] = OrderedDict()
        self._bytes = 0
        self._max_bytes = max_bytes
        self._lock = threading.Lock()

    def get(self, key: Key) -> F32 | None:
        """The cached vector, marked as most recently used; None if there is none."""
        with self._lock:
            if key in self._held:
                self._held.move_to_end(key)
            return self._held.get(key)

    def put(self, key: Key, vector: F32) -> F32:
        """Cache a vector; returns the cached read-only copy."""
        row = vector.copy()
        row.flags.writeable = False
        with self._lock:
            if key not in self._held:
                self._held[key] = row
                self._bytes += row.nbytes
            while self._bytes > self._max_bytes:
                self._bytes -= self._held.popitem(last=False)[1].nbytes
        return row

    def clear(self) -> None:
        """Remove all vectors."""
        with self._lock:
            self._held.clear()
            self._bytes = 0


_shared = VectorCache()


def images(encoder: Encoder, pictures: NDArray[np.uint8], memory: VectorCache = _shared) -> F32:
    """`encoder.encode_images` of `[B, H, W, 3]` uint8, unit rows `[B, D]`, with cached vectors where there are any.

    Raises:
        BackendError: as `encode_images`.
    """
    checked = checked_images(pictures)
    name = f"{encoder.fingerprint} {checked.shape[1:]}"
    keys = [(name, blake2b(picture.tobytes(), digest_size=16).digest()) for picture in checked]
    found = {key: vector for key in set(keys) if (vector := memory.get(key)) is not None}
    first = {key: i for i, key in reversed(list(enumerate(keys))) if key not in found}
    unknown = sorted(first.values())
    for start in range(0, len(unknown), BATCH):
        rows = unknown[start : start + BATCH]
        batch = np.zeros((BATCH, *checked.shape[1:]), np.uint8)
        batch[: len(rows)] = checked[rows]
        for i, vector in zip(rows, encoder.encode_images(batch), strict=False):  # without the padding
            found[keys[i]] = memory.put(keys[i], vector)
    return np.stack([found[key] for key in keys]) if keys else np.zeros((0, encoder.dim), np.float32)

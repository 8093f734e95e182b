"""Nothing is encoded twice: vectors by what was encoded and by whom, in memory, for the whole process.

A picture is known by a hash of its pixels, an encoder by its fingerprint, so encoders that share weights share vectors
and others never do. Pictures are encoded in batches of one size: the last bits of a vector depend on the size of the
batch it was computed in, never on its place there, so what is remembered equals what would be computed again.

There is no copy on the disk: beside a scene its language field is kept, which answers the same question sooner, and
in an edited scene the middle, hence every portrait, has moved. Knows vectors. Refuses to know pictures' meaning.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from hashlib import blake2b

import numpy as np
from numpy.typing import NDArray

from . import Encoder, checked_images

F32 = NDArray[np.float32]
BATCH = 16  # pictures encoded at a time; the last batch is filled up with blank ones
MOST_BYTES = 64 * 2**20  # of vectors remembered; the longest unused are forgotten first: 30,000 pictures at 512 numbers

Key = tuple[str, bytes]  # fingerprint and shape; hash of the pixels


class Memory:
    """Vectors by key, bounded, for any number of threads."""

    def __init__(self, most_bytes: int = MOST_BYTES) -> None:
        self._held: OrderedDict[Key, F32] = OrderedDict()
        self._bytes = 0
        self._most = most_bytes
        self._lock = threading.Lock()

    def get(self, key: Key) -> F32 | None:
        """What is remembered; it counts as just used."""
        with self._lock:
            if key in self._held:
                self._held.move_to_end(key)
            return self._held.get(key)

    def put(self, key: Key, vector: F32) -> F32:
        """Remember a row; the copy that is remembered, which nobody can write to."""
        row = vector.copy()
        row.flags.writeable = False
        with self._lock:
            if key not in self._held:
                self._held[key] = row
                self._bytes += row.nbytes
            while self._bytes > self._most:
                self._bytes -= self._held.popitem(last=False)[1].nbytes
        return row

    def clear(self) -> None:
        """Forget everything."""
        with self._lock:
            self._held.clear()
            self._bytes = 0


_memory = Memory()


def images(encoder: Encoder, pictures: NDArray[np.uint8], memory: Memory = _memory) -> F32:
    """What `encoder.encode_images` gives for `[B, H, W, 3]` uint8, unit rows `[B, D]`; known pictures are looked up.

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
        for i, vector in zip(rows, encoder.encode_images(batch), strict=False):  # without what only fills up
            found[keys[i]] = memory.put(keys[i], vector)
    return np.stack([found[key] for key in keys]) if keys else np.zeros((0, encoder.dim), np.float32)

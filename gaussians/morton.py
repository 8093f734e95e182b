"""Morton codes (Morton 1966): one number per grid cell; sorting by it places neighbours in space close in memory."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

BITS = 21  # per axis, so that three axes fit in 64 bits


def codes(cells: NDArray[np.integer]) -> NDArray[np.uint64]:
    """The codes `[N]` of cells `[N, 3]` of `BITS` bits per axis: the bits of x, y and z interleaved, x lowest."""
    keys = np.zeros(len(cells), np.uint64)
    for axis in range(3):
        keys |= _spread(cells[:, axis].astype(np.uint64)) << np.uint64(axis)
    return keys


def _spread(cells: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Insert two zero bits between neighbouring bits of 21-bit numbers."""
    for shift, mask in (
        (32, 0x001F00000000FFFF), (16, 0x001F0000FF0000FF), (8, 0x100F00F00F00F00F),
        (4, 0x10C30C30C30C30C3), (2, 0x1249249249249249),
    ):  # fmt: skip
        cells = (cells | (cells << np.uint64(shift))) & np.uint64(mask)
    return cells

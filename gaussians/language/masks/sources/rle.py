"""Decode and encode run-length masks of COCO (`segmentation: {"size": [h, w], "counts": …}`).

Runs go down the columns and start with a run of zeros. Compressed counts are a string: each number is written in
groups of five bits, lowest first, with a sixth bit for "more follows" and 48 added to make it printable. From the
fourth number on, the signed difference to the number two before is written (the layout of cocoapi's maskApi).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

MAX_PIXELS = 1 << 28


def size_of(segmentation: Any) -> tuple[int, int]:
    """Height and width of one segmentation, without reading its runs.

    Raises:
        ValueError: it is not valid; the message says why.
    """
    if not isinstance(segmentation, Mapping) or "size" not in segmentation or "counts" not in segmentation:
        raise ValueError("a segmentation must be an object with size and counts (polygons are not read)")
    try:
        height, width = (int(side) for side in segmentation["size"])
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"size must be [height, width], not {segmentation['size']!r}") from None
    if not (height > 0 and width > 0 and height * width <= MAX_PIXELS):
        raise ValueError(f"a mask cannot have {width}x{height} pixels")
    return height, width


def decode(segmentation: Any) -> NDArray[np.bool_]:
    """The mask `[H, W]` of one segmentation.

    Raises:
        ValueError: it is not valid; the message says why.
    """
    height, width = size_of(segmentation)
    counts = segmentation["counts"]
    runs = _decompressed(counts) if isinstance(counts, str | bytes) else _uncompressed(counts)
    if int(runs.sum()) != height * width or (runs < 0).any():
        raise ValueError(f"its runs cover {int(runs.sum())} pixels instead of {height * width}")
    flat = np.repeat(np.arange(len(runs)) % 2 == 1, runs)
    return flat.reshape(width, height).T.copy()


def encode(mask: NDArray[np.bool_]) -> dict[str, Any]:
    """A mask `[H, W]` as a segmentation with compressed counts."""
    flat = np.asarray(mask, dtype=bool).T.ravel()
    ends = np.flatnonzero(np.diff(flat)) + 1
    runs = np.diff(np.concatenate([[0], ends, [len(flat)]]))
    if len(flat) and flat[0]:
        runs = np.concatenate([[0], runs])
    return {"size": [int(side) for side in mask.shape], "counts": _compressed(runs.tolist())}


def _uncompressed(counts: Any) -> NDArray[np.int64]:
    whole = isinstance(counts, Sequence) and all(isinstance(c, int) and 0 <= c <= MAX_PIXELS for c in counts)
    if not whole:
        raise ValueError("counts must be a string or a list of whole numbers")
    return np.array(counts, dtype=np.int64)


def _decompressed(counts: str | bytes) -> NDArray[np.int64]:
    codes = [c - 48 for c in (counts.encode() if isinstance(counts, str) else counts)]
    if any(not 0 <= c < 64 for c in codes):
        raise ValueError("counts holds characters that no compressed mask has")
    runs: list[int] = []
    at = 0
    while at < len(codes):
        value, shift, more = 0, 0, True
        while more:
            if at >= len(codes) or shift > 40:
                raise ValueError("its compressed counts end in the middle of a number")
            code = codes[at]
            value |= (code & 31) << shift
            shift, at, more = shift + 5, at + 1, bool(code & 32)
        if code & 16:
            value -= 1 << shift
        runs.append(value + (runs[-2] if len(runs) > 2 else 0))
        if not 0 <= runs[-1] <= MAX_PIXELS:
            raise ValueError("its compressed counts hold a run of impossible length")
    return np.array(runs, dtype=np.int64)


def _compressed(runs: list[int]) -> str:
    letters = []
    for i, run in enumerate(runs):
        value = run - (runs[i - 2] if i > 2 else 0)
        while True:
            code, value = value & 31, value >> 5
            more = value != (-1 if code & 16 else 0)
            letters.append(chr(48 + (code | 32 * more)))
            if not more:
                break
    return "".join(letters)

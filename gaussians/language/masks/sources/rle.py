"""Run-length masks as COCO writes them (`segmentation: {"size": [h, w], "counts": …}`).

Runs go down the columns, first a run of zeros. Compressed counts are a string: each number in groups of five bits from
the low end, a sixth bit for "more follows", 48 added to make it printable; from the fourth number on the difference to
the one two before is written, with sign (the layout of cocoapi's maskApi). Knows that layout and nothing else.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

MOST_PIXELS = 1 << 28


def size_of(told: Any) -> tuple[int, int]:
    """Height and width of one segmentation, without reading its runs.

    Raises:
        ValueError: it is none; the message says why.
    """
    if not isinstance(told, Mapping) or "size" not in told or "counts" not in told:
        raise ValueError("a segmentation must be an object with size and counts (polygons are not read)")
    try:
        height, width = (int(side) for side in told["size"])
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"size must be [height, width], not {told['size']!r}") from None
    if not (height > 0 and width > 0 and height * width <= MOST_PIXELS):
        raise ValueError(f"a mask of {width}x{height} pixels is none")
    return height, width


def decode(told: Any) -> NDArray[np.bool_]:
    """`[H, W]` mask of one segmentation.

    Raises:
        ValueError: it is none; the message says why.
    """
    height, width = size_of(told)
    counts = told["counts"]
    runs = _unpacked(counts) if isinstance(counts, str | bytes) else _plain(counts)
    if int(runs.sum()) != height * width or (runs < 0).any():
        raise ValueError(f"its runs cover {int(runs.sum())} pixels instead of {height * width}")
    flat = np.repeat(np.arange(len(runs)) % 2 == 1, runs)
    return flat.reshape(width, height).T.copy()


def encode(mask: NDArray[np.bool_]) -> dict[str, Any]:
    """A mask `[H, W]` with compressed counts."""
    flat = np.asarray(mask, dtype=bool).T.ravel()
    ends = np.flatnonzero(np.diff(flat)) + 1
    runs = np.diff(np.concatenate([[0], ends, [len(flat)]]))
    if len(flat) and flat[0]:
        runs = np.concatenate([[0], runs])
    return {"size": [int(side) for side in mask.shape], "counts": _packed(runs.tolist())}


def _plain(counts: Any) -> NDArray[np.int64]:
    whole = isinstance(counts, Sequence) and all(isinstance(c, int) and 0 <= c <= MOST_PIXELS for c in counts)
    if not whole:
        raise ValueError("counts must be a string or a list of whole numbers")
    return np.array(counts, dtype=np.int64)


def _unpacked(counts: str | bytes) -> NDArray[np.int64]:
    codes = [c - 48 for c in (counts.encode() if isinstance(counts, str) else counts)]
    if any(not 0 <= c < 64 for c in codes):
        raise ValueError("counts holds letters that no compressed mask has")
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
        if not 0 <= runs[-1] <= MOST_PIXELS:
            raise ValueError("its compressed counts hold a run that cannot be")
    return np.array(runs, dtype=np.int64)


def _packed(runs: list[int]) -> str:
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

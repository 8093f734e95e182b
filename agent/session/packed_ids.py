"""Ids of Gaussians as a short text, for logs: the steps from one to the next, compressed."""

from __future__ import annotations

import base64
import zlib

import numpy as np
import torch
from torch import Tensor

_MOST = 100_000_000  # ids of one text


def pack(ids: Tensor) -> str:
    """`[M]` int64 ascending ids without repeats as a text: first ids and lengths of their runs, as differences."""
    numbers = ids.cpu().numpy()
    starts = np.flatnonzero(np.diff(numbers, prepend=-2) != 1)
    lengths = np.diff(np.append(starts, len(numbers)))
    steps = np.stack([np.diff(numbers[starts], prepend=0), lengths]).astype("<i8")
    return base64.b64encode(zlib.compress(steps.tobytes())).decode()


def unpack(text: str) -> Tensor:
    """The ids `[M]` that `pack` made a text of.

    Raises:
        ValueError: it is no such text.
    """
    data = zlib.decompressobj()
    try:
        raw = data.decompress(base64.b64decode(text, validate=True), 16 * _MOST)
    except zlib.error as error:
        raise ValueError("no packed ids") from error
    steps = np.frombuffer(raw, "<i8").reshape(2, -1)
    lengths = steps[1]
    if (lengths < 1).any() or lengths.sum() > _MOST:
        raise ValueError("no packed ids")
    first = np.cumsum(steps[0])
    before = np.cumsum(lengths) - lengths
    return torch.from_numpy(np.repeat(first - before, lengths) + np.arange(int(lengths.sum())))

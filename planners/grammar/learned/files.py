"""Files of learned weights: lists of words, and arrays rounded to whole steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

LEVELS = 127  # steps from zero to the largest weight of an array


def stored(path: Path) -> tuple[dict[str, list[str]], dict[str, NDArray[np.float32]]]:
    """The lists of words and the weights in a file that `store` wrote."""
    with np.load(path, allow_pickle=False) as file:
        lists = {key: bytes(file[key]).decode().split("\n") for key in file.files if file[key].dtype == np.uint8}
        weights = {
            key: file[key].astype(np.float32) * file[f"{key}_step"] for key in file.files if file[key].dtype == np.int8
        }
    return lists, weights


def store(path: Path, lists: Mapping[str, Sequence[str]], weights: Mapping[str, NDArray[np.float32]]) -> None:
    """Write lists of words, and weights rounded to whole steps."""
    held: dict[str, Any] = {key: np.frombuffer("\n".join(said).encode(), np.uint8) for key, said in lists.items()}
    for key, values in weights.items():
        step = np.float32(float(np.abs(values).max()) / LEVELS)
        held |= {key: np.round(values / step).astype(np.int8), f"{key}_step": step}
    np.savez_compressed(path, allow_pickle=False, **held)

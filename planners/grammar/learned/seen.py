"""How the models see words: classes of what is alike, and sets of numbers by which a file of weights is read."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....gaussians import color
from ..timing.verbs import SENSES, has_form
from ..vocabulary.nouns import is_known
from ..vocabulary.quantities import NUMBERS

STEM = 5  # letters of a word by which its forms are alike
LEVELS = 127  # weights are stored as whole numbers of steps
_SECONDS = frozenset(("s", "sec", "secs", "second", "seconds"))


@cache
def hues() -> frozenset[str]:
    """Colours of one word."""
    return frozenset(name for name in color.names() if " " not in name)


def amount_or_color(word: str) -> str:
    """One word for all numbers, one for seconds, one for colours; else the word."""
    if word in _SECONDS:
        return "#s"
    if word in NUMBERS or word[0].isdigit():
        return "#"
    return "#color" if word in hues() else word


@cache
def classed(word: str) -> str:
    """As `amount_or_color`, with one word for all things, and for each form of verbs of motion; else ""."""
    seen = amount_or_color(word)
    if seen != word:
        return seen
    if is_known(word):
        return "#thing"
    forms = (form for form in ("s", "past", "ing", "plain") if has_form(word, tuple(SENSES), form))
    return next((f"#v-{form}" for form in forms), "")


def stored(path: Path) -> tuple[dict[str, list[str]], dict[str, NDArray[np.float32]]]:
    """The lists of words and the weights in a file that `store` wrote."""
    with np.load(path, allow_pickle=False) as file:
        lists = {key: bytes(file[key]).decode().split("\n") for key in file.files if file[key].dtype == np.uint8}
        weights = {
            key: file[key].astype(np.float32) * file[f"{key}_step"] for key in file.files if file[key].dtype == np.int8
        }
    return lists, weights


def store(path: Path, lists: dict[str, Sequence[str]], weights: dict[str, NDArray[np.float32]]) -> None:
    """Write lists of words, and weights rounded to whole steps."""
    held: dict[str, Any] = {key: np.frombuffer("\n".join(said).encode(), np.uint8) for key, said in lists.items()}
    for key, values in weights.items():
        step = np.float32(float(np.abs(values).max()) / LEVELS)
        held |= {key: np.round(values / step).astype(np.int8), f"{key}_step": step}
    np.savez_compressed(path, allow_pickle=False, **held)

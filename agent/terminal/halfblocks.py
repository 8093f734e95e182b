"""Draws a picture in a terminal: two pixels in each character cell, as upper half blocks with escape sequences."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

Depth = Literal["truecolor", "256", "ascii"]
Picture = NDArray[np.uint8]  # [H, W, 3], display space

_RAMP = " .:-=+*#%@"  # dark to light, in even steps
_RESET = "\x1b[0m"
_CUBE = np.array([0, 95, 135, 175, 215, 255])  # channel levels of xterm's 6x6x6 colour cube, colours 16 to 231


class Stream(Protocol):
    """The part of an output stream that `depth_of` needs."""

    @property
    def encoding(self) -> str | None: ...
    def isatty(self) -> bool: ...


def depth_of(stream: Stream, env: Mapping[str, str] | None = None) -> Depth:
    """The best colour depth of a stream; a pipe, a dumb terminal or NO_COLOR gives "ascii"."""
    env = os.environ if env is None else env
    encodes = (stream.encoding or "").lower().replace("-", "").startswith("utf8")
    if not stream.isatty() or env.get("TERM", "") in ("", "dumb") or "NO_COLOR" in env or not encodes:
        return "ascii"
    if env.get("COLORTERM", "").lower() in ("truecolor", "24bit") or "direct" in env.get("TERM", ""):
        return "truecolor"
    return "256"


def draw(image: Picture, columns: int, rows: int, depth: Depth = "truecolor") -> str:
    """Text of at most `columns` x `rows` cells showing `image [H, W, 3]` with its aspect kept.

    Every line ends with a reset, so that the colours do not spread to later text. A cell is twice as high as wide.
    """
    height, width = image.shape[:2]
    shrink = min(columns / width, 2 * rows / height)
    w = max(1, min(columns, round(width * shrink)))
    h = max(2, min(2 * rows, 2 * round(height * shrink / 2)))
    pixels = _shrink(image, w, h)
    upper, lower = pixels[0::2], pixels[1::2]
    if depth == "ascii":
        return "\n".join("".join(line) for line in _letters(upper, lower))
    paint = _truecolor if depth == "truecolor" else _palette
    lines = []
    for top, bottom in zip(upper, lower, strict=True):
        cells, last = [], ""
        for t, b in zip(top, bottom, strict=True):
            code = paint(t, b)
            cells.append("▀" if code == last else f"\x1b[{code}m▀")
            last = code
        lines.append("".join(cells) + _RESET)
    return "\n".join(lines)


def _shrink(image: Picture, width: int, height: int) -> Picture:
    """The picture at another size, each pixel the mean of those that it covers (box filter)."""
    from PIL import Image

    return np.asarray(Image.fromarray(np.ascontiguousarray(image)).resize((width, height), Image.Resampling.BOX))


def _truecolor(top: Picture, bottom: Picture) -> str:
    return "38;2;{};{};{};48;2;{};{};{}".format(*(int(c) for c in (*top, *bottom)))


def _palette(top: Picture, bottom: Picture) -> str:
    return f"38;5;{_nearest_256(top)};48;5;{_nearest_256(bottom)}"


def _nearest_256(color: Picture) -> int:
    """The closest colour of xterm's colour cube and its 24 greys (232 to 255, levels 8, 18, ... 238)."""
    rgb = color.astype(int)
    cube = np.abs(rgb[:, None] - _CUBE).argmin(axis=1)
    grey = int(np.clip(round((rgb.mean() - 8) / 10), 0, 23))
    if np.abs(_CUBE[cube] - rgb).sum() <= np.abs(8 + 10 * grey - rgb).sum():
        return int(16 + 36 * cube[0] + 6 * cube[1] + cube[2])
    return 232 + grey


def _letters(upper: Picture, lower: Picture) -> list[list[str]]:
    """One character for each cell by its luminance (Rec. 709 weights)."""
    light = (upper.astype(float) + lower) / 2 @ np.array([0.2126, 0.7152, 0.0722])
    index = np.clip((light / 256 * len(_RAMP)).astype(int), 0, len(_RAMP) - 1)
    return [[_RAMP[i] for i in line] for line in index]

"""Encodes and writes PNG files, and composes a contact sheet: pictures of steps with their instruction and outcome."""

from __future__ import annotations

import io
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from ...gaussians.files import writing

Picture = NDArray[np.uint8]  # [H, W, 3], display space

_PAPER, _INK, _GOOD, _BAD = (250, 249, 246), (30, 30, 34), (34, 110, 66), (176, 58, 46)
_GAP = 14  # pixels between and around tiles


@dataclass(frozen=True)
class Tile:
    """One step on a contact sheet.

    Attributes:
        title: the instruction.
        outcome: its outcome in a sentence.
        pictures: one or two pictures side by side, of one size.
        good: whether the outcome is an edit (green) or a refusal (red).
    """

    title: str
    outcome: str
    pictures: tuple[Picture, ...]
    good: bool = True


def encoded_png(picture: NDArray[np.uint8]) -> bytes:
    """A picture `[H, W, 3]` as the bytes of a PNG file."""
    written = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(picture)).save(written, format="PNG")
    return written.getvalue()


def save_png(picture: NDArray[np.uint8 | np.uint16], path: str | Path, force: bool = False) -> None:
    """Write a picture completely or not at all; an existing file is overwritten only with `force`.

    `[H, W, 3]` colours, `[H, W, 4]` with alpha, or `[H, W]` of up to 16 bits.
    """
    with writing(path, force) as file:
        Image.fromarray(np.ascontiguousarray(picture)).save(file, format="PNG", optimize=True)


def beside(pictures: Sequence[Picture], gap: int = 6) -> Picture:
    """Pictures of one height in a row, with background between them."""
    height = pictures[0].shape[0]
    bar = np.full((height, gap, 3), _PAPER, dtype=np.uint8)
    return np.concatenate([p for picture in pictures for p in (bar, picture)][1:], axis=1)


def contact_sheet(heading: str, tiles: Sequence[Tile], columns: int = 2, tile_width: int = 760) -> Picture:
    """All tiles on one sheet, read row by row, each with its number, words and outcome."""
    drawn = [_draw_tile(i, tile, tile_width) for i, tile in enumerate(tiles, start=1)]
    rows = [drawn[i : i + columns] for i in range(0, len(drawn), columns)]
    head = 64
    width = columns * tile_width + (columns + 1) * _GAP
    height = head + sum(max(t.height for t in row) + _GAP for row in rows) + _GAP
    sheet = Image.new("RGB", (width, height), _PAPER)
    ImageDraw.Draw(sheet).text((_GAP + 4, 16), heading, fill=_INK, font=_font(26))
    y = head
    for row in rows:
        for column, tile in enumerate(row):
            sheet.paste(tile, (_GAP + column * (tile_width + _GAP), y))
        y += max(t.height for t in row) + _GAP
    return np.asarray(sheet)


def _draw_tile(number: int, tile: Tile, width: int) -> Image.Image:
    blank = np.full_like(tile.pictures[0], _PAPER)
    strip = Image.fromarray(beside((*tile.pictures, blank)[:2]))
    strip = strip.resize((width, round(strip.height * width / strip.width)), Image.Resampling.LANCZOS)
    title = _wrapped(f"{number}. {tile.title}", _font(19), width)
    outcome = _wrapped(tile.outcome, _font(15), width)[:3]
    image = Image.new("RGB", (width, 26 * len(title) + strip.height + 21 * len(outcome) + 14), _PAPER)
    draw = ImageDraw.Draw(image)
    y = 0
    for line in title:
        draw.text((0, y), line, fill=_INK, font=_font(19))
        y += 26
    image.paste(strip, (0, y + 2))
    y += strip.height + 7
    for line in outcome:
        draw.text((0, y), line, fill=_GOOD if tile.good else _BAD, font=_font(15))
        y += 21
    return image


def _font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    return ImageFont.load_default(size)


def _wrapped(text: str, font: ImageFont.FreeTypeFont | ImageFont.ImageFont, width: int) -> list[str]:
    """Lines that fit into `width` pixels, by the mean width of a character of the text."""
    letter = max(1.0, font.getlength(text) / max(1, len(text)))
    return textwrap.wrap(text, max(8, int(width / letter) - 1)) or [""]

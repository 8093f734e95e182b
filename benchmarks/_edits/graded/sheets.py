"""Contact sheets: one JPEG an instruction, with its words, what was said, and the pictures before and after."""

from __future__ import annotations

import textwrap
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from .carrying import Carried, Instruction, Picture, Shown

_PAPER, _INK, _NOTE = (250, 249, 246), (20, 20, 24), (110, 60, 40)
_WIDTH = 1200  # pixels of a sheet
_QUALITY = 82


def draw(instruction: Instruction, carried: Carried, shown: Shown) -> Image.Image:
    """The sheet of one instruction."""
    font = ImageFont.load_default(15)
    lines = [(f"{carried.key}: {instruction.text}", _INK)]
    lines += [(line, _INK) for line in textwrap.wrap(f"expected: {instruction.expect}", 165)]
    for told in (*carried.told, f"{carried.outcome}: {carried.said}"):
        lines += [(line, _NOTE) for part in told.split("\n") for line in textwrap.wrap(part, 165)]
    head = 22 * len(lines) + 10
    strips = [_strip(row) for row in shown.rows]
    sheet = Image.new("RGB", (_WIDTH, head + sum(s.height + 4 for s in strips)), _PAPER)
    pen = ImageDraw.Draw(sheet)
    for i, (line, ink) in enumerate(lines):
        pen.text((6, 4 + 22 * i), line, fill=ink, font=font)
    y = head
    for strip in strips:
        sheet.paste(strip, (0, y))
        y += strip.height + 4
    return sheet


def save(instruction: Instruction, carried: Carried, shown: Shown, out: Path) -> Path:
    """Write the sheet of one instruction; returns its path."""
    path = out / "sheets" / f"{carried.key.replace(' ', '_')}.jpg"
    path.parent.mkdir(parents=True, exist_ok=True)
    draw(instruction, carried, shown).save(path, quality=_QUALITY)
    return path


def _strip(row: tuple[Picture, ...]) -> Image.Image:
    """Pictures side by side over the width of a sheet: three of an edit, two of a question."""
    width = _WIDTH // (3 if len(row) > 2 else 2)
    tiles = [Image.fromarray(p) for p in row]
    tiles = [t.resize((width, round(t.height * width / t.width)), Image.Resampling.LANCZOS) for t in tiles]
    strip = Image.new("RGB", (_WIDTH, tiles[0].height), _PAPER)
    for i, tile in enumerate(tiles):
        strip.paste(tile, (i * width, 0))
    return strip

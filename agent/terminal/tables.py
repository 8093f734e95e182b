"""Tables and coloured lines by rich; plain text where the stream is not a terminal."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import TextIO


def table(columns: Sequence[str], rows: Sequence[Sequence[object]], width: int = 100) -> str:
    """A table in plain text, `width` characters wide, with aligned columns and long cells wrapped."""
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table

    drawn = Table(*columns, box=SIMPLE_HEAD, pad_edge=False, show_edge=False)
    for row in rows:
        drawn.add_row(*(str(cell) for cell in row))
    out = io.StringIO()
    Console(file=out, width=width, color_system=None, legacy_windows=False).print(drawn)
    return "\n".join(line.rstrip() for line in out.getvalue().rstrip().splitlines())


def coloured(text: str, style: str, stream: TextIO) -> str:
    """`text` with its first line in `style` ("green", "bold red") if `stream` shows colours, else as it is."""
    from rich.console import Console
    from rich.style import Style

    system = Console(file=stream).color_system
    if not stream.isatty() or system is None:
        return text
    first, line_break, rest = text.partition("\n")
    return Style.parse(style).render(first) + line_break + rest

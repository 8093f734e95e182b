"""Writes the tables of `docs/effort.md` from the points: python -m scenewright.benchmarks._effort.page"""

from __future__ import annotations

from pathlib import Path

from ...gaussians.effort.points import methods
from .named import table

PAGE = Path(__file__).resolve().parents[2] / "docs" / "effort.md"
START, END = "<!-- points -->", "<!-- end of points -->"


def points() -> str:
    """The table of all points, and what was measured of each method and left out."""
    told = [
        f"- **{m.name}** ({m.scene}; revision {m.revision}){': ' + m.note if m.note else '.'}"
        for m in methods().values()
    ]
    return "\n".join([START, table(), "", *told, END])


def written(text: str) -> str:
    """The page with the tables of the present points.

    Raises:
        ValueError: the page has no place for them.
    """
    start, end = text.index(START), text.index(END)
    return text[:start] + points() + text[end + len(END) :]


if __name__ == "__main__":
    PAGE.write_text(written(PAGE.read_text(encoding="utf-8")), encoding="utf-8")

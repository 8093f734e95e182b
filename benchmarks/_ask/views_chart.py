"""Draws the chart of accuracy against the number of views from a result of `bench ask --json`, with matplotlib.

Usage: python -m scenewright.benchmarks._ask.views_chart RESULT.json CHART.png
"""

from __future__ import annotations

import sys
from pathlib import Path

from ..harness import Result

WAYS = {"ours": ("for the question", "#1b6ca8"), "uniform": ("evenly", "#d1495b"), "random": ("at random", "#b0792b")}
DEFAULT = 3  # views that are sent unless more are asked for


def draw(result: Result, path: Path) -> Path:
    """One line a way of choosing views, the default ringed, and geometry's share on the same rooms' questions."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    figure = Figure(figsize=(7.5, 4.8), dpi=150, layout="constrained")
    axes = figure.add_subplot()
    for way, (label, color) in WAYS.items():
        found = [(int(m.key.split(".")[2]), m.value) for m in result.metrics if m.key.startswith(f"views.{way}.")]
        axes.plot(*zip(*sorted(found), strict=True), "o-", color=color, label=f"views chosen {label}")
        if way == "ours" and (share := dict(found).get(DEFAULT)) is not None:
            axes.scatter([DEFAULT], [share], s=190, facecolors="none", edgecolors="black", zorder=4, label="default")
    axes.set_xlabel("views sent")
    axes.set_ylabel("share right (up is better)")
    axes.set_title("a scripted stand-in for a vision model: what its pictures show", fontsize=10)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.grid(True, color="0.9")
    axes.legend(fontsize=8)
    figure.savefig(path)
    return path


if __name__ == "__main__":
    draw(Result.from_json(Path(sys.argv[1]).read_text(encoding="utf-8")), Path(sys.argv[2]))

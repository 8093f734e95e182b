"""The chart of time against accuracy. Knows matplotlib, which is an extra; refuses to know what was measured."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

from ..gaussians.errors import BackendError, FileError, UserError
from .harness import Point, Result

FORMATS = ("png", "svg", "pdf")
COLORS = ("#1b6ca8", "#d1495b", "#3c8d5a", "#b0792b", "#6a4c93", "#4a4e52")


def draw(result: Result, path: Path) -> Path:
    """See `Result.chart`."""
    kind = path.suffix.lstrip(".").lower()
    if kind not in FORMATS:
        raise UserError(f"a chart is written as .{', .'.join(FORMATS)}, not {path.name!r}")
    if not result.points:
        raise UserError(f"benchmark {result.name} has no points of time against accuracy to draw")
    try:
        from matplotlib.figure import Figure  # no pyplot: no global state, no display
    except ImportError as error:
        raise BackendError("charts need matplotlib; install it with: pip install 'scenewright[bench]'") from error
    figure = Figure(figsize=(8, 5), dpi=150, layout="constrained")
    _fill(figure.add_subplot(), result)
    data = io.BytesIO()
    figure.savefig(data, format=kind)
    try:
        path.write_bytes(data.getvalue())
    except OSError as error:
        raise FileError(f"cannot write the chart {path}: {error.strerror or error}") from error
    return path


def _fill(axes: Any, result: Result) -> None:
    """Points by method, the front as steps, the default ringed, every point named."""
    axes.set_xscale("log")
    methods = list(dict.fromkeys(point.method for point in result.points))
    for index, method in enumerate(methods):
        own = [point for point in result.points if point.method == method]
        color = COLORS[index % len(COLORS)]
        axes.scatter([p.seconds for p in own], [p.accuracy for p in own], s=45, color=color, label=method, zorder=3)
    front = result.front()
    axes.step(
        [p.seconds for p in front], [p.accuracy for p in front], where="post", color="0.6", zorder=1, label="front"
    )
    chosen = [point for point in result.points if point.default]
    if chosen:
        where = [p.seconds for p in chosen], [p.accuracy for p in chosen]
        axes.scatter(*where, s=190, facecolors="none", edgecolors="black", linewidths=1.5, zorder=4, label="default")
    for point in result.points:
        axes.annotate(
            _label(point), (point.seconds, point.accuracy), xytext=(7, 6), textcoords="offset points", fontsize=8
        )
    axes.set_xlabel("seconds (logarithmic; left is better)")
    axes.set_ylabel(f"{result.accuracy} (up is better)")
    machine = ", ".join(f"{result.machine[key]} {unit}".strip() for key, unit in _MACHINE if key in result.machine)
    axes.set_title(f"{result.title}\n{machine}" if machine else result.title, fontsize=10)
    axes.grid(True, which="major", color="0.9")
    axes.margins(x=0.15, y=0.15)
    axes.legend(fontsize=8)


_MACHINE = (("cpu", ""), ("cores", "cores"))


def _label(point: Point) -> str:
    return point.setting or point.method

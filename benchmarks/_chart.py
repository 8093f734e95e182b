"""Draws the chart of time or bytes against accuracy of a benchmark's result, with matplotlib (an extra)."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from ..gaussians.errors import BackendError, FileError, UserError
from .harness import Point, Result

FORMATS = ("png", "svg", "pdf")
COLORS = ("#1b6ca8", "#d1495b", "#3c8d5a", "#b0792b", "#6a4c93", "#4a4e52", "#17a2a2", "#c2649b", "#8a8f1d", "#e08b6d")
MARKERS = "osD^v"  # the next marker for each repetition of the colours, so that all methods differ
MAX_LABELS = 12  # points up to which each is labelled; of more, only the front, the defaults and ends of each method
NARROW_RANGE = 1000  # ratio of greatest to least cost up to which the axis also has ticks at 2 and 5
# Offsets of a label from its point, best first; points.
LABEL_OFFSETS = ((7, 6), (7, -12), (-7, 6), (-7, -12), (7, 17), (7, -23), (-7, 17), (-7, -23))
LETTER_SIZE = (4.4, 9.0)  # width and height of a letter of a label, points


def draw(result: Result, path: Path) -> Path:
    """Draw time (logarithmic) against accuracy with the Pareto front, the default marked; PNG, SVG or PDF by name.

    Raises:
        BackendError: matplotlib is not installed.
        UserError: the result has no points, or the file's ending is none of these.
        FileError: the file cannot be written.
    """
    kind = path.suffix.lstrip(".").lower()
    if kind not in FORMATS:
        raise UserError(f"a chart is written as .{', .'.join(FORMATS)}, not {path.name!r}")
    if not result.points:
        raise UserError(f"benchmark {result.name} has no points of time against accuracy to draw")
    try:
        from matplotlib.figure import Figure  # no pyplot: no global state, no display
    except ImportError as error:
        raise BackendError("charts need matplotlib; install it with: pip install 'scenewright[bench]'") from error
    many = len(result.points) > MAX_LABELS
    figure = Figure(figsize=(11, 6.5) if many else (8, 5), dpi=150, layout="constrained")
    axes = figure.add_subplot()
    _fill(axes, result)
    figure.draw_without_rendering()  # labels are placed in pixels, which stand only now
    _name(axes, result.points, labelled(result), result.cost_of)
    data = io.BytesIO()
    figure.savefig(data, format=kind)
    try:
        path.write_bytes(data.getvalue())
    except OSError as error:
        raise FileError(f"cannot write the chart {path}: {error.strerror or error}") from error
    return path


def labelled(result: Result) -> tuple[Point, ...]:
    """The points that are labelled: all if there are few; else the front, the defaults and both ends of each method, if
    they have a setting (inner points of a curve have none)."""
    if len(result.points) <= MAX_LABELS:
        return result.points
    wanted = {*result.front(), *(p for p in result.points if p.default)}
    for method in dict.fromkeys(p.method for p in result.points):
        own = [p for p in result.points if p.method == method]
        wanted |= {own[0], own[-1]}
    return tuple(p for p in result.points if p in wanted and p.setting)


def _fill(axes: Any, result: Result) -> None:
    """Points by method in the order they were measured, the front as steps, the default ringed."""
    axes.set_xscale("log")
    methods = list(dict.fromkeys(point.method for point in result.points))
    lines = len(result.points) > MAX_LABELS
    for index, method in enumerate(methods):
        own = [point for point in result.points if point.method == method]
        color = COLORS[index % len(COLORS)]
        where = [result.cost_of(p) for p in own], [p.accuracy for p in own]
        mark = MARKERS[index // len(COLORS) % len(MARKERS)]
        axes.scatter(*where, s=45, color=color, marker=mark, label=method, zorder=3)
        if lines:
            axes.plot(*where, color=color, linewidth=0.8, alpha=0.5, zorder=2)
    front = result.front()
    axes.step(
        [result.cost_of(p) for p in front],
        [p.accuracy for p in front],
        where="post",
        color="0.6",
        zorder=1,
        label="front",
    )
    chosen = [point for point in result.points if point.default]
    if chosen:
        where = [result.cost_of(p) for p in chosen], [p.accuracy for p in chosen]
        axes.scatter(*where, s=190, facecolors="none", edgecolors="black", linewidths=1.5, zorder=4, label="default")
    axes.set_xlabel(f"{result.cost} (logarithmic; left is better)")
    axes.set_ylabel(f"{result.accuracy} (up is better)")
    machine = ", ".join(f"{result.machine[key]} {unit}".strip() for key, unit in _MACHINE if key in result.machine)
    axes.set_title(f"{result.title}\n{machine}" if machine else result.title, fontsize=10)
    axes.grid(True, which="major", color="0.9")
    axes.margins(x=0.15, y=0.15)
    _number(axes, result)
    beside = {"loc": "upper left", "bbox_to_anchor": (1.01, 1.0)} if lines else {"loc": "best"}
    axes.legend(fontsize=8, **beside)


def _number(axes: Any, result: Result) -> None:
    """Plain numbers along the cost, closer where it spans little."""
    from matplotlib.ticker import EngFormatter, LogLocator, NullFormatter, StrMethodFormatter

    low, high = axes.get_xlim()
    axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5) if high < NARROW_RANGE * low else (1,)))
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}") if result.cost == "seconds" else EngFormatter("B"))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _name(axes: Any, points: Sequence[Point], named: Sequence[Point], cost: Callable[[Point], float]) -> None:
    """Write each label at the offset with the least overlap with the points, earlier labels and the axes' outside."""
    gain = axes.figure.dpi / 72
    frame = tuple(edge / gain for edge in axes.get_window_extent().extents)
    spots = axes.transData.transform([(cost(p), p.accuracy) for p in points]) / gain
    taken = [(x - 4, y - 4, x + 4, y + 4) for x, y in spots]
    for point in named:
        x, y = axes.transData.transform((cost(point), point.accuracy)) / gain
        text = point.setting or point.method
        boxes = [_box(x, y, spot, text) for spot in LABEL_OFFSETS]
        hidden = [sum(_overlap(box, other) for other in taken) - _overlap(box, frame) for box in boxes]
        best = hidden.index(min(hidden))
        taken.append(boxes[best])
        side = "left" if LABEL_OFFSETS[best][0] > 0 else "right"
        axes.annotate(
            text,
            (cost(point), point.accuracy),
            xytext=LABEL_OFFSETS[best],
            textcoords="offset points",
            fontsize=8,
            ha=side,
        )


_Box = tuple[float, float, float, float]  # left, bottom, right, top; points


def _box(x: float, y: float, spot: tuple[int, int], text: str) -> _Box:
    width, height = LETTER_SIZE[0] * len(text), LETTER_SIZE[1]
    left = x + spot[0] - (width if spot[0] < 0 else 0)
    return left, y + spot[1] - 2, left + width, y + spot[1] - 2 + height


def _overlap(a: _Box, b: _Box) -> float:
    """Area that two boxes share."""
    width, height = min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])
    return max(width, 0.0) * max(height, 0.0)


_MACHINE = (("cpu", ""), ("cores", "cores"))

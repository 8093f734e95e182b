"""Draws the chart of time or bytes against accuracy of a benchmark's result, with matplotlib (an extra)."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from ..gaussians.errors import BackendError, FileError, UserError
from . import _row_chart
from .harness import Point, Result

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Cost = Literal["seconds", "bytes"]

FORMATS = ("png", "svg", "pdf")
COLORS = ("#1b6ca8", "#d1495b", "#3c8d5a", "#b0792b", "#6a4c93", "#4a4e52", "#17a2a2", "#c2649b", "#8a8f1d", "#e08b6d")
MARKERS = "osD^v"  # the next marker for each repetition of the colours, so that all methods differ
MAX_SETTINGS = 8  # settings of one chart; the others stand in the table
SPAN_OF_BYTES = 1.5  # ratio of the most to the fewest bytes from which they get axes of their own
NARROW_RANGE = 1000  # ratio of greatest to least cost up to which the axis also has ticks at 2 and 5
# Offsets of a label from its point, best first; points.
LABEL_OFFSETS = ((7, 6), (7, -12), (-7, 6), (-7, -12), (7, 17), (7, -23), (-7, 17), (-7, -23))
LETTER_SIZE = (4.4, 9.0)  # width and height of a letter of a label, points


def draw(result: Result, path: Path) -> Path:
    """Draw time (logarithmic) against accuracy with the Pareto front, the default marked; PNG, SVG or PDF by name.

    A result without points, but with rows, is drawn as the curves of its rows.

    Raises:
        BackendError: matplotlib is not installed.
        UserError: the result has no points, or the file's ending is none of these.
        FileError: the file cannot be written.
    """
    kind = path.suffix.lstrip(".").lower()
    if kind not in FORMATS:
        raise UserError(f"a chart is written as .{', .'.join(FORMATS)}, not {path.name!r}")
    if not (result.points or result.rows):
        raise UserError(f"benchmark {result.name} has no points of time against accuracy to draw")
    try:
        from matplotlib import rc_context
        from matplotlib.figure import Figure  # no pyplot: no global state, no display
    except ImportError as error:
        raise BackendError("charts need matplotlib; install it with: pip install 'scenewright[bench]'") from error
    figure = Figure(dpi=110, layout="constrained")
    if result.points:
        _draw_points(figure, result)
    else:
        _row_chart.fill(figure, result)
    data = io.BytesIO()
    with rc_context({"svg.hashsalt": result.name, "svg.fonttype": "none"}):
        figure.savefig(data, format=kind, metadata=_UNDATED.get(kind))
    try:
        path.write_bytes(data.getvalue())
    except OSError as error:
        raise FileError(f"cannot write the chart {path}: {error.strerror or error}") from error
    return path


def _draw_points(figure: Figure, result: Result) -> None:
    """Draw the points with labels that do not overlap."""
    costs = _costs(result)
    figure.set_size_inches(4 + 4.5 * len(costs), 5.5)
    panels = figure.subplots(1, len(costs), sharey=True, squeeze=False)[0]
    for axes, cost in zip(panels, costs, strict=True):
        _fill(axes, result, cost)
    panels[0].set_ylabel(f"{result.accuracy} (up is better)")
    machine = ", ".join(f"{result.machine[key]} {unit}".strip() for key, unit in _MACHINE if key in result.machine)
    figure.suptitle(f"{result.title}\n{machine}" if machine else result.title, fontsize=10, wrap=True)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=8)
    figure.draw_without_rendering()  # labels are placed in pixels, which stand only now
    for axes, cost in zip(panels, costs, strict=True):
        _name(axes, result, cost)


def shown(result: Result) -> tuple[Point, ...]:
    """The points of the chart: the defaults, the front, then what is most accurate of each method, at most
    `MAX_SETTINGS` in all, with the unnamed points of their methods, which are the inner points of curves."""
    named = [p for p in result.points if label(result, p)]
    best = {m: max((p for p in named if p.method == m), key=lambda p: p.accuracy) for m in {p.method for p in named}}
    first = [p for p in named if p.default]
    front = [p for p in result.front() if p in named and p not in first]
    rest = sorted((p for p in named if p not in first and p not in front), key=lambda p: p is not best[p.method])
    chosen = [*first[:MAX_SETTINGS], *_spaced(front, MAX_SETTINGS - len(first))]
    chosen += rest[: MAX_SETTINGS - len(chosen)]
    methods = {p.method for p in chosen}
    return tuple(p for p in result.points if p in chosen or (p not in named and p.method in methods))


def label(result: Result, point: Point) -> str:
    """What stands beside a point: its setting; of a method with one point alone, the method. "" within a curve."""
    alone = sum(p.method == point.method for p in result.points) == 1
    return point.setting or (point.method if alone else "")


def _spaced(points: Sequence[Point], count: int) -> Sequence[Point]:
    """At most `count` points, evenly taken, with both ends."""
    if len(points) <= count:
        return points
    if count < 2:
        return points[-max(count, 0) :] if count else ()
    return [points[round(k * (len(points) - 1) / (count - 1))] for k in range(count)]


def _costs(result: Result) -> tuple[Cost, ...]:
    """What the points are charted against: what the result says, and the bytes too where they differ."""
    bytes_ = [p.bytes for p in shown(result)]
    if result.cost == "seconds" and min(bytes_) > 0 and max(bytes_) > SPAN_OF_BYTES * min(bytes_):
        return ("seconds", "bytes")
    return (result.cost,)


def _fill(axes: Any, result: Result, cost: Cost) -> None:
    """Points by method in the order they were measured, the front as steps, the default ringed."""
    axes.set_xscale("log")
    points = shown(result)
    for index, method in enumerate(dict.fromkeys(point.method for point in points)):
        own = [point for point in points if point.method == method]
        color = COLORS[index % len(COLORS)]
        where = [getattr(p, cost) for p in own], [p.accuracy for p in own]
        axes.scatter(*where, s=45, color=color, marker=MARKERS[index % len(MARKERS)], label=method, zorder=3)
        if not all(label(result, p) for p in own):
            axes.plot(*where, color=color, linewidth=0.8, alpha=0.5, zorder=2)
    front = replace(result, points=points, cost=cost).front()
    where = [getattr(p, cost) for p in front], [p.accuracy for p in front]
    axes.step(*where, where="post", color="0.6", zorder=1, label="front")
    chosen = [point for point in points if point.default]
    if chosen:
        where = [getattr(p, cost) for p in chosen], [p.accuracy for p in chosen]
        axes.scatter(*where, s=190, facecolors="none", edgecolors="black", linewidths=1.5, zorder=4, label="default")
    axes.set_xlabel(f"{cost} (logarithmic; left is better)")
    axes.grid(True, which="major", color="0.9")
    axes.margins(x=0.2, y=0.15)
    _number(axes, cost)


def _number(axes: Any, cost: Cost) -> None:
    """Plain numbers along the cost, closer where it spans little."""
    from matplotlib.ticker import EngFormatter, LogLocator, NullFormatter, StrMethodFormatter

    low, high = axes.get_xlim()
    axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5) if high < NARROW_RANGE * low else (1,)))
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}") if cost == "seconds" else EngFormatter("B"))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _name(axes: Any, result: Result, cost: Cost) -> None:
    """Write each label at the offset with the least overlap with the points, earlier labels and the axes' outside."""
    points = shown(result)
    gain = axes.figure.dpi / 72
    frame = tuple(edge / gain for edge in axes.get_window_extent().extents)
    spots = axes.transData.transform([(getattr(p, cost), p.accuracy) for p in points]) / gain
    taken = [(x - 4, y - 4, x + 4, y + 4) for x, y in spots]
    for point, (x, y) in zip(points, spots, strict=True):
        if not (text := label(result, point)):
            continue
        boxes = [_box(x, y, spot, text) for spot in LABEL_OFFSETS]
        hidden = [sum(_overlap(box, other) for other in taken) - _overlap(box, frame) for box in boxes]
        best = hidden.index(min(hidden))
        taken.append(boxes[best])
        axes.annotate(
            text,
            (getattr(point, cost), point.accuracy),
            xytext=LABEL_OFFSETS[best],
            textcoords="offset points",
            fontsize=8,
            ha="left" if LABEL_OFFSETS[best][0] > 0 else "right",
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
_UNDATED: dict[str, dict[str, str | None]] = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}

"""Draws the curves of a stability benchmark's rows as small multiples, what breaks first on top, with matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._rows import BREAKS, Row, sorted_rows
from .harness import Result

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLUMNS, MOST = 5, 30  # panels side by side, and in all; the other rows stand in the table
NAMED = 5  # levels up to which each has its label; of more only the broken ones have
WIDTH, HEIGHT = 3.0, 1.75  # of a panel, inches
HOLDS, BROKEN, BOUND = "#1b6ca8", "#d1495b", "0.6"
LETTERS = 12  # of the label of a level


def fill(figure: Figure, result: Result) -> None:
    """Draw one panel a row: what is left of its baseline at each level, the bound dashed, broken levels red."""
    rows = [row for row in sorted_rows(result.rows) if row.drop > 0][:MOST] or sorted_rows(result.rows)[:1]
    lines = -(-len(rows) // COLUMNS)
    figure.set_size_inches(COLUMNS * WIDTH, lines * HEIGHT + 0.6)
    panels = figure.subplots(lines, COLUMNS, squeeze=False).ravel()
    for axes, row in zip(panels, rows, strict=False):
        _panel(axes, row)
    for axes in panels[len(rows) :]:
        axes.axis("off")
    hidden = len(result.rows) - len(rows)
    more = f"; {hidden} more rows, which lose least, stand in the table" if hidden else ""
    figure.suptitle(
        f"{result.title}: share of the baseline that is left at rising levels, what breaks first on top{more}",
        fontsize=10,
        wrap=True,
    )


def _panel(axes: Any, row: Row) -> None:
    """The curve of one row from its baseline on."""
    bound = 0.0 if row.law else BREAKS
    left = [1 - row.drop_at(level.value) for level in row.levels]
    places = range(len(left) + 1)
    axes.plot(places, [1.0, *left], color="0.75", linewidth=1, zorder=1)
    colors = [HOLDS, *(HOLDS if 1 - share <= bound + 1e-9 else BROKEN for share in left)]
    axes.scatter(places, [1.0, *left], c=colors, s=16, zorder=2)
    axes.axhline(1 - bound, color=BOUND, linestyle="--", linewidth=0.8, zorder=0)
    axes.set_ylim(min(-0.05, *left), max(1.15, *left))
    named = [i for i, color in enumerate(colors) if i and (len(left) <= NAMED or color == BROKEN)]
    axes.set_xticks([0, *named], ["none", *(_short(row.levels[i - 1].label) for i in named)])
    axes.tick_params(labelsize=6)
    for tick in axes.get_xticklabels():
        tick.set(rotation=55 if len(left) > NAMED else 20, ha="right", rotation_mode="anchor")
    axes.set_title(f"{row.name} ({row.baseline:.3g} {row.unit})", fontsize=7.5)
    axes.spines[["top", "right"]].set_visible(False)


def _short(label: str) -> str:
    return label if len(label) <= LETTERS else f"{label[: LETTERS - 1]}…"

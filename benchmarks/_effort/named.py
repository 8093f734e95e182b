"""The words of the dial beside the settings of charts, and the table of all points."""

from __future__ import annotations

from typing import Any

from ...gaussians.effort import WORDS, Method
from ...gaussians.effort.points import method, methods


def words(name: str, clock: float = 0.0, **settings: Any) -> str:
    """The words that mean a setting of a method, as in " (fast)"; "" if none does."""
    for point in method(name).points:
        if point.clock == clock and all(point.settings.get(key) == value for key, value in settings.items()):
            return f" ({', '.join(point.names)})" if point.names else ""
    return ""


def table() -> str:
    """All points as a Markdown table."""
    head = "| method | setting | effort | accuracy | measured, s | predicted, s | |"
    rule = "| --- | --- | --- | ---: | ---: | --- | --- |"
    return "\n".join([head, rule, *(row for one in methods().values() for row in _rows(one))])


def _rows(one: Method) -> list[str]:
    rows = []
    for k, p in enumerate(one.points):
        clock = f"{p.clock:g} + " if p.clock else ""
        fixed = f"{p.fixed:g} + " if p.fixed else ""
        grows = f"{p.per:.3g} x {one.sized_by}" if p.per else "0"
        cells = [one.name, p.setting, ", ".join(w for w in WORDS if w in p.names), f"{p.accuracy:g} {one.unit}",
                 f"{p.measured:g}", f"{clock}{fixed}{grows}", "default" if k == one.default else ""]  # fmt: skip
        rows.append(f"| {' | '.join(cells)} |")
    return rows

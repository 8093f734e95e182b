"""Rows of a stability benchmark: one figure without a disturbance and at rising levels of it, and where it breaks."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from .harness import Metric

BREAKS = 0.1  # share of the baseline by which a figure may fall before it counts as broken


@dataclass(frozen=True)
class Level:
    """One level of a disturbance: what was done, in words or a figure with its unit, and what was measured."""

    label: str
    value: float

    def __post_init__(self) -> None:
        if not math.isfinite(self.value):
            raise ValueError(f"level {self.label} is {self.value}; cap it where it is measured")


@dataclass(frozen=True)
class Row:
    """What one disturbance does to one figure, of which more is better.

    Attributes:
        name: stable between versions, "theme.disturbance".
        baseline: the figure without the disturbance, or what it would be if nothing failed.
        levels: from the mildest on; not empty.
        unit: of the figure: "IoU", "share", "dB", "hashes", ...
        n: things, queries or operations that a level was measured on.
        law: whether any loss at all is a fault, as with hashes that must be equal.
    """

    name: str
    baseline: float
    levels: tuple[Level, ...]
    unit: str
    n: int
    law: bool = False

    def __post_init__(self) -> None:
        if not self.levels or not math.isfinite(self.baseline):
            raise ValueError(f"row {self.name} needs a level and a finite baseline")

    @property
    def perturbed(self) -> float:
        """The figure at the worst level."""
        return min(level.value for level in self.levels)

    @property
    def drop(self) -> float:
        """Share of the baseline that is lost at the worst level; below 0 if the figure is better than without it."""
        return self.drop_at(self.perturbed)

    @property
    def breaks_at(self) -> str | None:
        """The first level at which the figure is broken; None if it holds at all of them."""
        place = self._place
        return None if place is None else self.levels[place].label

    def drop_at(self, value: float) -> float:
        """Share of the baseline that is lost where the figure is `value`."""
        return (self.baseline - value) / max(abs(self.baseline), 1e-9)

    @property
    def _place(self) -> int | None:
        bound = 0.0 if self.law else BREAKS
        broken = (i for i, level in enumerate(self.levels) if self.drop_at(level.value) > bound + 1e-9)
        return next(broken, None)

    @property
    def order(self) -> tuple[float, float]:
        """Sorts rows by what breaks first: at the mildest share of its levels, then by what is lost there."""
        place = self._place
        if place is None:
            return 1.0, -self.drop
        return place / len(self.levels), -self.drop_at(self.levels[place].value)

    def metric(self) -> Metric:
        """The worst level as a figure that results are compared by; a law has its baseline as goal."""
        from .harness import Metric

        goal = self.baseline if self.law else None
        return Metric(f"{self.name}.perturbed", self.perturbed, self.unit, "higher", 0.0 if self.law else BREAKS, goal)

    def figures(self) -> dict[str, Any]:
        """The row with all that follows from it, as JSON has it."""
        return {
            "name": self.name, "baseline": self.baseline, "perturbed": self.perturbed, "drop": self.drop,
            "breaks_at": self.breaks_at, "unit": self.unit, "n": self.n, "law": self.law,
            "levels": [{"label": level.label, "value": level.value} for level in self.levels],
        }  # fmt: skip

    @classmethod
    def read(cls, data: Mapping[str, Any]) -> Self:
        """A row from its figures."""
        levels = tuple(Level(**level) for level in data["levels"])
        return cls(data["name"], data["baseline"], levels, data["unit"], data["n"], data["law"])


def sorted_rows(rows: Sequence[Row]) -> list[Row]:
    """What breaks first on top, then what loses most."""
    return sorted(rows, key=lambda row: (row.order, row.name))


def table(rows: Sequence[Row]) -> list[str]:
    """Rows as lines of a Markdown table, what breaks first on top."""
    if not rows:
        return []
    lines = ["| row | baseline | worst level | drop | breaks at | levels | n |", "| --- " * 7 + "|"]
    for row in sorted_rows(rows):
        along = ", ".join(f"{level.label}: {level.value:.3g}" for level in row.levels)
        lines.append(
            f"| {row.name}{' (law)' if row.law else ''} | {row.baseline:.3g} {row.unit} | {row.perturbed:.3g} "
            f"| {row.drop:.0%} | {row.breaks_at or 'holds'} | {along} | {row.n} |"
        )
    return [*lines, ""]

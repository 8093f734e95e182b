"""What differs between the clouds before and after an edit, Gaussian by Gaussian, matched by id."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import torch
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.rows import rows_where
from ..cloud_diff import Difference

_ROUNDING = 1e-5  # of the largest coordinate


@dataclass(frozen=True, eq=False)
class Changes:
    """The difference of two clouds; N rows before.

    Attributes:
        before, after: the clouds.
        row: `[N]` int64, row of each Gaussian in the cloud after, -1 where it is gone.
        added: `[K]` int64, rows of the cloud after whose ids are new, ascending.
        known: the same as it was found row by row already; None: columns are compared here.
    """

    before: GaussianCloud
    after: GaussianCloud
    row: Tensor
    added: Tensor
    known: Difference | None = None

    @cached_property
    def all_stayed(self) -> bool:
        """Whether every Gaussian is in the row in which it was."""
        n = len(self.before)
        return len(self.row) <= len(self.after) and bool((self.row == torch.arange(n, device=self.row.device)).all())

    @cached_property
    def gone(self) -> Tensor:
        """`[N]` bool."""
        return self.row < 0

    @cached_property
    def placed(self) -> Tensor:
        """`[N]` bool: centre, orientation or extent differ."""
        return self._differs("means") | self._differs("quats") | self._differs("scales")

    @cached_property
    def colored(self) -> Tensor:
        """`[N]` bool: the constant band of the harmonics differs."""
        return self._differs("sh", 1)

    @cached_property
    def shaded(self) -> Tensor:
        """`[N]` bool: any band of the harmonics differs."""
        return self._differs("sh")

    @cached_property
    def faded(self) -> Tensor:
        """`[N]` bool: the opacity differs."""
        return self._differs("opacities")

    @cached_property
    def any(self) -> Tensor:
        """`[N]` bool: gone, or different in any way that is drawn."""
        return self.gone | self.placed | self.shaded | self.faded

    @cached_property
    def elsewhere(self) -> Tensor:
        """`[N]` bool: the centre is at another place than before, by more than rounding."""
        found = torch.zeros_like(self.gone)
        rows = rows_where(self.placed)
        apart = self.before.means[rows] - self.after.means[self.row[rows]]
        largest = float(max(map(abs, torch.aminmax(self.before.means)))) if len(rows) else 1.0
        found[rows] = torch.linalg.vector_norm(apart, dim=1) > _ROUNDING * max(largest, 1e-9)
        return found

    def _differs(self, name: str, bands: int | None = None) -> Tensor:
        """`[N]` bool: rows that stayed and differ in a column, or in the first `bands` of it."""
        old, new = getattr(self.before, name), getattr(self.after, name)
        found = torch.zeros(len(self.before), dtype=torch.bool, device=old.device)
        if old is new:
            return found
        if old.shape[1:] != new.shape[1:]:
            return ~self.gone
        if self.known is not None and bands is None:
            return self._as_known(name, found)
        stayed = rows_where(~self.gone if bands is None else self.shaded)
        if bands is not None:
            old, new = old[:, :bands], new[:, :bands]
        every = self.all_stayed and len(stayed) == len(old)
        a, b = (old, new[: len(old)]) if every else (old[stayed], new[self.row[stayed]])
        found[stayed] = (a != b).flatten(1).any(dim=1) if a.ndim > 1 else a != b
        return found

    def _as_known(self, name: str, found: Tensor) -> Tensor:
        """`[N]` bool: `found`, with the rows that are known to differ in a column."""
        assert self.known is not None
        if (changed := self.known.changed.get(name)) is not None:
            kept = self.known.kept
            found[changed if kept is None else kept[changed]] = True
        return found


def changes_of(before: GaussianCloud, after: GaussianCloud, known: Difference) -> Changes:
    """The difference of two clouds whose remaining rows keep their order, as it was found row by row."""
    kept = known.kept
    n = len(before) if kept is None else len(kept)
    here = torch.arange(n, device=before.device)
    row = here
    if kept is not None:
        row = torch.full((len(before),), -1, dtype=torch.int64, device=before.device)
        row[kept] = here
    return Changes(before, after, row, torch.arange(n, len(after), device=before.device), known)


def changes_between(before: GaussianCloud, after: GaussianCloud) -> Changes:
    """The difference of two clouds by id, whatever the order of their rows."""
    if before.ids is after.ids:
        here = torch.arange(len(before), device=before.device)
        return Changes(before, after, here, here[:0])
    ordered, order = after.ids.sort()
    row = torch.full((len(before),), -1, dtype=torch.int64, device=before.device)
    if len(after):
        place = torch.searchsorted(ordered, before.ids).clamp(max=len(after) - 1)
        there = ordered[place] == before.ids
        row[there] = order[place[there]]
    kept = torch.zeros(len(after), dtype=torch.bool, device=before.device)
    kept[row[row >= 0]] = True
    return Changes(before, after, row, rows_where(~kept))

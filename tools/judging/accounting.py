"""Checks of which Gaussians changed: all of the target, nothing else, and only in the way that the operation says."""

from __future__ import annotations

import torch
from torch import Tensor

from ...gaussians.rows import rows_where
from ..receipt import Check, at_least, at_most
from .case import Case, weight_of
from .changes import Changes

# In which ways each operation may change Gaussians that stay or go; an operation that is not listed may do anything.
_WAYS: dict[str, frozenset[str]] = {
    "delete": frozenset({"gone"}),
    "isolate": frozenset({"gone"}),
    "replace": frozenset({"gone"}),
    "recolor": frozenset({"colored"}),
    "relight": frozenset({"colored"}),
    "restyle": frozenset({"colored", "gone"}),  # large Gaussians become several small ones
    "opacity": frozenset({"faded"}),
    "move": frozenset({"placed"}),
    "rotate": frozenset({"placed"}),
    "scale": frozenset({"placed"}),
    "arrange": frozenset({"placed"}),
    "exchange": frozenset({"placed"}),
    "reframe": frozenset({"placed"}),
    "insert": frozenset(),
    "duplicate": frozenset(),
    "infill": frozenset(),
    "shadow": frozenset({"colored"}),
    "articulate": frozenset({"placed"}),
    "pace": frozenset({"placed"}),
    "order": frozenset({"placed"}),
    "spin": frozenset(),
    "sway": frozenset(),
    "tip": frozenset(),
    "orbit": frozenset(),
    "follow": frozenset(),
    "select": frozenset(),
    "merge": frozenset(),
    "split": frozenset(),
}
_CARRIED = {"delete": frozenset({"placed"}), "replace": frozenset({"placed"})}
_ADDS = frozenset({"insert", "duplicate", "replace", "infill", "restyle"})
_COMPLETE = 0.99  # share of the target's visual weight that must change: a few Gaussians may already be as asked


def only_as_asked(case: Case) -> Check:
    """No Gaussian changed but those that the words mean, none in another way, and none appeared unasked."""
    stray = int((case.changes.any & ~case.free).sum())
    ways = _WAYS.get(case.op.op)
    wrong = 0 if ways is None else int((_otherwise(case.changes, ways) & case.free & case.target).sum())
    if ways is not None:  # what stood on a thing that goes comes down
        carried = case.free & ~case.target
        wrong += int((_otherwise(case.changes, ways | _CARRIED.get(case.op.op, frozenset())) & carried).sum())
    new = 0 if ways is None or case.op.op in _ADDS else len(case.changes.added)
    said = f"{stray} Gaussians of other things changed, {wrong} of the target changed in another way"
    said += f", {new} appeared" if new else ""
    return at_most("nothing else changed", stray + wrong + new, 0, "Gaussians", said)


def _otherwise(changes: Changes, ways: frozenset[str]) -> Tensor:
    """`[N]` bool: Gaussians that changed in none of `ways`."""
    other = torch.zeros_like(changes.gone)
    if "gone" not in ways:
        other = other | changes.gone
    if "placed" not in ways:
        other = other | changes.placed
    if "colored" not in ways:
        # Turning a Gaussian turns the higher bands of its harmonics.
        other = other | (changes.colored if "placed" in ways else changes.shaded)
    if "faded" not in ways:
        other = other | changes.faded
    return other


def all_of_it(case: Case, changed: Tensor, target: Tensor | None = None) -> Check:
    """The target changed, all of it.

    Args:
        changed: `[N]` bool, Gaussians that changed as asked.
        target: `[N]` bool, None for what the words mean.
    """
    rows = rows_where(case.target if target is None else target)
    weight = weight_of(case.before.cloud, rows)
    total = float(weight.sum())
    share = float(weight[changed[rows]].sum()) / total if total > 0 else 0.0
    said = f"{share:.1%} of the target by area changed as asked"
    return at_least("all of it changed", share, _COMPLETE, "1", said)

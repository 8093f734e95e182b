"""Fit a decision rule on furnished rooms, evaluate it on held-out rooms, and write it beside the code that uses it."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from ..gaussians.assets import Room, furnish
from ..gaussians.language.segmentation.learned_rule import Rule, rule_of
from ..gaussians.scene import Scene

F64 = NDArray[np.float64]
Rooms = Iterator[tuple[Scene, NDArray[np.int32]]]
HIDDEN, BATCH, RATE = 32, 2048, 5e-3
JITTER = 0.25  # standard deviations of a feature: captures are noisier than furnished rooms


@dataclass(frozen=True)
class Met:
    """Borders met on the way: features `[B, F]`, whether both sides are one object, and what a mistake would cost."""

    features: F64
    same: NDArray[np.bool_]
    cost: F64


def joined(met: Sequence[Met]) -> Met:
    """All of them."""
    return Met(*(np.concatenate([getattr(m, name) for m in met]) for name in ("features", "same", "cost")))


def fit(met: Met, names: tuple[str, ...], seed: int, steps: int) -> dict[str, Any]:
    """The rule as a table; both classes count equally, so that it does not follow how often each occurs."""
    torch.manual_seed(seed)
    rng = np.random.default_rng(seed)
    mean, spread = met.features.mean(axis=0), met.features.std(axis=0) + 1e-6
    x = torch.from_numpy((met.features - mean) / spread).float()
    y = torch.from_numpy(met.same).float()
    weight = torch.from_numpy(met.cost).float()
    weight = torch.where(y > 0, weight / (weight * y).mean(), weight / (weight * (1 - y)).mean())
    layers = [torch.nn.Linear(len(names), HIDDEN), torch.nn.Linear(HIDDEN, HIDDEN), torch.nn.Linear(HIDDEN, 1)]
    model = torch.nn.Sequential(layers[0], torch.nn.Tanh(), layers[1], torch.nn.Tanh(), layers[2])
    optimizer = torch.optim.AdamW(model.parameters(), lr=RATE, weight_decay=1e-2)
    for step in range(steps):
        for group in optimizer.param_groups:
            group["lr"] = RATE * (1 - step / steps)
        pick = torch.from_numpy(rng.integers(len(y), size=BATCH))
        jitter = torch.from_numpy(rng.normal(size=(BATCH, x.shape[1])).astype(np.float32)) * JITTER
        logit = model(x[pick] + jitter).squeeze(1)
        loss = torch.nn.functional.binary_cross_entropy_with_logits(logit, y[pick], weight[pick])
        optimizer.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        optimizer.step()
    return {
        "features": list(names),
        "mean": _rounded(mean),
        "spread": _rounded(spread),
        "weights": [_rounded(layer.weight.detach().numpy().T) for layer in layers],
        "biases": [_rounded(layer.bias.detach().numpy()) for layer in layers],
        "borders": len(y),
    }


def judge(rule: Rule, met: Met) -> dict[str, float]:
    """Shares of borders judged right, each weighted by what a mistake would cost."""
    joined = rule.probability(met.features) > 0.5
    return {
        name: round(float(np.average(joined[rows] == wanted, weights=met.cost[rows])), 4)
        for name, rows, wanted in (("joined when one thing", met.same, True), ("parted when two", ~met.same, False))
    }


def _rounded(values: NDArray[np.floating]) -> list[Any]:
    rounded: list[Any] = np.round(values.astype(np.float64), 5).tolist()
    return rounded


def kept(rooms: int) -> int:
    """How many of some rooms are fitted on: all but a sixth, which is held out."""
    return max(1, rooms * 5 // 6)


def with_judgement(table: dict[str, Any], features: tuple[str, ...], held: Sequence[Met]) -> dict[str, Any]:
    """The table with how it does on what was held out."""
    return {**table, "held_out": judge(rule_of(table, features), joined(held)) if held else {}}


def fit_and_judge(met: Sequence[Met], features: tuple[str, ...], seed: int, steps: int) -> dict[str, Any]:
    """The table of a rule fitted on what most rooms showed and judged on the others."""
    count = kept(len(met))
    return with_judgement(fit(joined(met[:count]), features, seed, steps), features, met[count:])


def command(
    module: ModuleType,
    rooms: int,
    fit_rooms: Callable[[Rooms, int], dict[str, Any]],
    room: Callable[[int, int], Room] = lambda seed, number: furnish(seed),
) -> None:
    """Fit the rule of a module on furnished rooms, from the command line.

    Args:
        module: whose `NAME.json` is written.
        rooms: how many, unless said.
        fit_rooms: rooms with their known objects (-1: structure), and a seed, to the table of a rule.
        room: of a seed, and which room of all it is.
    """
    parser = argparse.ArgumentParser(description=f"Fit the rule of {module.__name__.rpartition('.')[2]}.")
    parser.add_argument("--rooms", type=int, default=rooms)
    parser.add_argument("--seed", type=int, default=9000)
    parser.add_argument("--out", type=Path, default=Path(str(module.__file__)).with_suffix(".json"))
    args = parser.parse_args()
    furnished = (room(args.seed + i, i) for i in range(args.rooms))
    table = fit_rooms(((r.scene, r.truth.ids.numpy()) for r in furnished), args.seed)
    args.out.write_text(json.dumps(table) + "\n")

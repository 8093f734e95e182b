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
from ..gaussians.language.segmentation.haze import HazyRule
from ..gaussians.language.segmentation.learned_rule import Rule, rule_of
from ..gaussians.scene import Scene

F64 = NDArray[np.float64]
Rooms = Iterator[tuple[Scene, NDArray[np.int32]]]
HIDDEN, BATCH, RATE = 32, 2048, 5e-3
JITTER = 0.25  # noise in standard deviations of a feature, since captures are noisier than furnished rooms


@dataclass(frozen=True)
class Examples:
    """Training examples: features `[B, F]`, whether the answer is yes `[B]`, and the cost of a mistake `[B]`.

    For borders, `same` says whether both sides are one object.
    """

    features: F64
    same: NDArray[np.bool_]
    cost: F64


def joined(examples: Sequence[Examples]) -> Examples:
    """Concatenate examples."""
    return Examples(*(np.concatenate([getattr(m, name) for m in examples]) for name in ("features", "same", "cost")))


def fit(examples: Examples, names: tuple[str, ...], seed: int, steps: int) -> dict[str, Any]:
    """Fit a rule and return it as a table. Both classes have the same total weight, however often they occur."""
    torch.manual_seed(seed)
    rng = np.random.default_rng(seed)
    mean, spread = examples.features.mean(axis=0), examples.features.std(axis=0) + 1e-6
    x = torch.from_numpy((examples.features - mean) / spread).float()
    y = torch.from_numpy(examples.same).float()
    weight = torch.from_numpy(examples.cost).float()
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


def judge(rule: Rule | HazyRule, examples: Examples) -> dict[str, float]:
    """Accuracy in each class, weighted by the cost of a mistake."""
    joined = rule.probability(examples.features) > 0.5
    return {
        name: round(float(np.average(joined[rows] == wanted, weights=examples.cost[rows])), 4)
        for name, rows, wanted in (
            ("joined when one thing", examples.same, True),
            ("parted when two", ~examples.same, False),
        )
    }


def _rounded(values: NDArray[np.floating]) -> list[Any]:
    rounded: list[Any] = np.round(values.astype(np.float64), 5).tolist()
    return rounded


def training_count(rooms: int) -> int:
    """Number of rooms to fit on: all but a sixth, which is held out."""
    return max(1, rooms * 5 // 6)


def with_held_out(table: dict[str, Any], features: tuple[str, ...], held: Sequence[Examples]) -> dict[str, Any]:
    """The table with its accuracy on the held-out examples."""
    return {**table, "held_out": judge(rule_of(table, features), joined(held)) if held else {}}


def fit_and_evaluate(examples: Sequence[Examples], features: tuple[str, ...], seed: int, steps: int) -> dict[str, Any]:
    """The table of a rule fitted on the examples of most rooms and evaluated on the others."""
    count = training_count(len(examples))
    return with_held_out(fit(joined(examples[:count]), features, seed, steps), features, examples[count:])


def command(
    module: ModuleType,
    rooms: int,
    fit_rooms: Callable[[Rooms, int], dict[str, Any]],
    room: Callable[[int, int], Room] = lambda seed, number: furnish(seed),
) -> None:
    """Fit the rule of a module on furnished rooms, from the command line.

    Args:
        module: the module of the rule; `NAME.json` is written beside it.
        rooms: default number of rooms.
        fit_rooms: takes rooms with their true objects (-1: structure) and a seed; returns the table of the rule.
        room: makes a room from a seed and the number of the room.
    """
    parser = argparse.ArgumentParser(description=f"Fit the rule of {module.__name__.rpartition('.')[2]}.")
    parser.add_argument("--rooms", type=int, default=rooms)
    parser.add_argument("--seed", type=int, default=9000)
    parser.add_argument("--out", type=Path, default=Path(str(module.__file__)).with_suffix(".json"))
    args = parser.parse_args()
    furnished = (room(args.seed + i, i) for i in range(args.rooms))
    table = fit_rooms(((r.scene, r.truth.ids.numpy()) for r in furnished), args.seed)
    args.out.write_text(json.dumps(table) + "\n")

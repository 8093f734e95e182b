"""A small multilayer perceptron over measured features, read from a JSON file in this folder.

`affinity`, `coplanar` and `borders` each have one, fitted on furnished rooms by `training/`.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]


@dataclass(frozen=True)
class Rule:
    """A multilayer perceptron over standardised features: two hidden layers of tanh units, one sigmoid output.

    Attributes:
        mean, spread: `[F]` mean and standard deviation of the features.
        weights, biases: of the three layers, `[F, H]`, `[H, H]`, `[H, 1]` and `[H]`, `[H]`, `[1]`.
    """

    mean: F64
    spread: F64
    weights: tuple[F64, ...]
    biases: tuple[F64, ...]

    def probability(self, features: F64) -> F64:
        """Probability `[...]` of features `[..., F]`."""
        x = (features - self.mean) / self.spread
        for k, (weight, bias) in enumerate(zip(self.weights, self.biases, strict=True)):
            x = (np.tanh(x) if k else x) @ weight + bias
        result: F64 = 1 / (1 + np.exp(-np.clip(x[..., 0], -30, 30)))
        return result


@cache
def load_rule(name: str, features: tuple[str, ...]) -> Rule:
    """The rule in `NAME.json` of this folder, read once a process."""
    return rule_of(json.loads((files(__package__) / f"{name}.json").read_text()), features)


def rule_of(table: dict[str, Any], features: tuple[str, ...]) -> Rule:
    """The rule from its JSON table, which must have been fitted for these features."""
    assert tuple(table["features"]) == features, "the rule was fitted for other features"
    weights, biases = (tuple(np.array(a) for a in table[k]) for k in ("weights", "biases"))
    return Rule(np.array(table["mean"]), np.array(table["spread"]), weights, biases)

"""The correction of the affinity rule in hazy scenes, whose surfaces are made of faint Gaussians, as fits make them.

The rule was fitted on generated rooms, whose Gaussians are opaque. In scenes fitted from photographs it is far too
sure: colours and normals are noisy, so that one object looks like many. The correction adds to the rule's log-odds `l`

    haze * (constant - slope * l + weights · z)

with the standardised features `z`. It vanishes in clear scenes, and is kept this simple because fitted rooms with known
objects are few (`training/hazy_affinity.py`).
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...cloud import GaussianCloud
from .learned_rule import Rule

F64 = NDArray[np.float64]
CLEAR = 0.97  # median opacity of a surface point from which a scene is clear
SOFT = 1.01  # haze is the logarithm of SOFT - opacity, relative to that of a clear scene
FULL = 3.0  # logarithm for a haze of 1: a median opacity of about 0.2
MOST = 10.0  # bound of the rule's log-odds
SPREADS = 3.0  # bound of a standardised feature


def haze_of(cloud: GaussianCloud, rows: NDArray[np.int64]) -> float:
    """How hazy a scene is: 0 where its surface points, in these rows of the cloud, are opaque, about 1 where faint."""
    if not len(rows):
        return 0.0
    opacity = min(float(np.median(cloud.opacities.numpy()[rows])), CLEAR)
    return float(np.log((SOFT - opacity) / (SOFT - CLEAR))) / FULL


@dataclass(frozen=True)
class Correction:
    """How the rule's log-odds change with haze.

    Attributes:
        constant, slope: added at a haze of 1, and share of the log-odds that is taken away there.
        weights: `[F]` of the standardised features.
    """

    constant: float
    slope: float
    weights: F64


@dataclass(frozen=True)
class HazyRule:
    """A rule with its correction in a scene of known haze; without haze it is the rule."""

    rule: Rule
    correction: Correction
    haze: float

    def probability(self, features: F64) -> F64:
        """Probability `[...]` of features `[..., F]`."""
        if self.haze <= 0:
            return self.rule.probability(features)
        odds, inputs = correction_inputs(self.rule, features, self.haze)
        c = self.correction
        corrected = odds + inputs @ np.concatenate([[c.constant, c.slope], c.weights])
        result: F64 = 1 / (1 + np.exp(-np.clip(corrected, -30, 30)))
        return result


def correction_inputs(rule: Rule, features: F64, haze: float) -> tuple[F64, F64]:
    """The rule's bounded log-odds `[...]`, and what a correction weighs `[..., 2 + F]`: one, minus the log-odds, and
    the standardised features, all times the haze."""
    likely = np.clip(rule.probability(features), 1e-9, 1 - 1e-9)
    odds = np.clip(np.log(likely / (1 - likely)), -MOST, MOST)
    standard = np.clip((features - rule.mean) / rule.spread, -SPREADS, SPREADS)
    inputs = np.concatenate([np.ones((*odds.shape, 1)), -odds[..., None], standard], axis=-1)
    return odds, haze * inputs


@cache
def load_correction(name: str, features: tuple[str, ...]) -> Correction:
    """The correction in `NAME_haze.json` of this folder, read once a process."""
    return correction_of(json.loads((files(__package__) / f"{name}_haze.json").read_text()), features)


def correction_of(table: dict[str, Any], features: tuple[str, ...]) -> Correction:
    """The correction from its JSON table, which must have been fitted for these features."""
    assert tuple(table["features"]) == features, "the correction was fitted for other features"
    return Correction(table["constant"], table["slope"], np.array(table["weights"], np.float64))

"""Estimate the scale of a scene from the sizes of things that are named surely: doors, chairs, tables, bicycles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...world import kinds
from .language_field import Group

SURE = 0.5  # probability from which a name tells a size
LEAST = 2  # things that must agree
AGREE = 1.6  # factor from the median within which a thing agrees
MOST_AGREE = 2 / 3  # share of the things that must agree
SHAPE = 2.0  # factor between the scales by length and by height from which a thing is not whole, or is misnamed


@dataclass(frozen=True)
class Scale:
    """An estimated scale.

    Attributes:
        metres: per unit of the scene.
        by: the kinds of the things that agree on it, sorted.
    """

    metres: float
    by: tuple[str, ...]

    def note(self) -> str:
        """For the user: "sizes are judged at about 0.15 m a unit, estimated from bicycle, chair"."""
        return f"{NOTE} {self.metres:.2g} m a unit, estimated from {', '.join(self.by)}; --metres-per-unit corrects it"


NOTE = "sizes are judged at about"


def estimate_scale(groups: Sequence[Group]) -> Scale | None:
    """The scale that most of the surely named objects agree on; None if fewer than LEAST do."""
    told = [(g.label, value) for g in groups if (value := _log_scale(g)) is not None]
    if len(told) < LEAST:
        return None
    values = np.array([value for _, value in told])
    middle = float(np.median(values))
    agreeing = np.abs(values - middle) <= math.log(AGREE)
    if agreeing.sum() < max(LEAST, MOST_AGREE * len(told)):
        return None
    by = tuple(sorted({name for (name, _), fits in zip(told, agreeing, strict=True) if fits}))
    return Scale(math.exp(float(values[agreeing].mean())), by)


def _log_scale(group: Group) -> float | None:
    """Logarithm of metres per unit by one group; None if its name is not sure or its shape does not fit."""
    kind = kinds.find(group.label) if group.label and group.label_score >= SURE else None
    if kind is None or group.level != "object" or not group.count or min(group.box.size) <= 0:
        return None
    width, depth, height = kind.usual_size
    by_length = math.log(max(width, depth) / max(group.box.size[:2]))
    by_height = math.log(height / group.box.size[2])
    return None if abs(by_length - by_height) > math.log(SHAPE) else (by_length + by_height) / 2

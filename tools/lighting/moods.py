"""Named lights: "evening", "overcast", "candle light" as exposure, white point, contrast, saturation and sources."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources
from typing import Literal

import numpy as np

from ..color_map import LUMA
from .light import Light
from .whites import F64, NEUTRAL, balance, luminance, warmer_by

MoodName = Literal[
    "daylight", "sunny", "overcast", "sunrise", "golden hour", "dusk", "evening", "cosy", "candle light", "night",
    "moonlight",
]  # fmt: skip

_PASSED = 0.35  # share of a display channel that light of a pure colour keeps where the colour has none


@dataclass(frozen=True)
class Mood:
    """A named light.

    Attributes:
        name: as operations name it.
        exposure: factor of the mean luminance.
        kelvin: white point; None leaves it.
        contrast: exponent of display values.
        saturation: factor of chroma.
        windows: light of each window at a metre, relative to the light that is there; 0 for none.
        sky: how much the light comes from one side, 0 to 1.
        lamps: which lamps are lit: "all", "flames" (candles, lanterns, fires) or "" for none.
    """

    name: str
    exposure: float = 1.0
    kelvin: float | None = None
    contrast: float = 1.0
    saturation: float = 1.0
    windows: float = 0.0
    sky: float = 0.0
    lamps: Literal["", "all", "flames"] = ""

    def scaled(self, amount: float) -> Mood:
        """The mood `amount` times as strong; 0 changes nothing."""
        if amount == 1:
            return self
        kelvin = None if self.kelvin is None else warmer_by(NEUTRAL, amount * (1e6 / self.kelvin - 1e6 / NEUTRAL))
        return Mood(
            self.name, self.exposure**amount, kelvin, self.contrast**amount, self.saturation**amount,
            amount * self.windows, min(1.0, amount * self.sky), self.lamps,
        )  # fmt: skip


@cache
def moods() -> dict[str, Mood]:
    """All named lights, by name."""
    text = resources.files(__package__ or "").joinpath("moods.json").read_text(encoding="utf-8")
    return {entry["name"]: Mood(**entry) for entry in json.loads(text)}


def light_of(exposure: float, old: float, new: float, contrast: float = 1.0, saturation: float = 1.0) -> Light:
    """The change of light with a white point that goes from `old` to `new` kelvins."""
    matrix = balance(old, new)
    if saturation != 1.0:
        matrix = matrix @ _saturation(saturation)
    return Light(exposure, matrix, contrast)


def tinted(light: Light, rgb: Sequence[float], amount: float = 1.0) -> Light:
    """A light of a colour: every display channel keeps `_PASSED` and the rest in proportion to the colour's.

    A saturated colour is dimmer than white, as a filter before a lamp is, by what it passes of luminance.

    Args:
        rgb: `[3]` display colour, 0 to 1; only its hue and saturation count.
        amount: exponent of the factors; 0 changes nothing.
    """
    hue = np.asarray(rgb, dtype=np.float64)
    factors = (_PASSED + (1 - _PASSED) * hue / max(float(hue.max()), 1e-3)) ** amount
    passed = float(np.asarray(luminance(factors)))
    return replace(light, exposure=light.exposure * passed, matrix=np.diag(factors) @ light.matrix)


def _saturation(factor: float) -> F64:
    """`[3, 3]` chroma times a factor about each colour's grey."""
    return np.asarray(factor * np.eye(3) + (1 - factor) * np.ones((3, 1)) @ np.array([LUMA]))

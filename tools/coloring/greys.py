"""Measure whether greys stay grey when they become darker or lighter."""

from __future__ import annotations

import torch

from ...gaussians.language.field.measure import Sample
from .materials import hue_at
from .quantiles import quantile

_GREY = 10.0  # Lab chroma up to which a colour is a grey
# Least lightness before and after: below it nobody sees a hue, and a display's transfer is no power law.
_SEEN = 15.0
_FEWEST = 8


def grey_shift(was: Sample, now: Sample) -> float:
    """Shift of greys in a and b of CIELAB, beyond that of the same surface under more or less light: 90 % shift less.

    Light scales a and b with L + 16 (see `materials.hue_at`), so a grey may keep its little tint, or lose some of it,
    and nothing else. `was` and `now` are the same Gaussians in the same order; 0 if hardly any of them is a grey.
    """
    chroma = torch.linalg.vector_norm(was.lab[:, 1:], dim=1)
    shown = ((now.rgb >= 0) & (now.rgb <= 1) & (was.rgb >= 0) & (was.rgb <= 1)).all(dim=1)
    grey = (chroma < _GREY) & (was.lab[:, 0] > _SEEN) & (now.lab[:, 0] > _SEEN) & shown
    if int(grey.sum()) < _FEWEST:
        return 0.0
    old, new = was.lab[grey], now.lab[grey]
    expected = hue_at(old, 0.0) * ((new[:, :1] + 16) / 16)
    along = (new[:, 1:] * expected).sum(dim=1) / (expected**2).sum(dim=1).clamp(min=1e-12)
    shift = torch.linalg.vector_norm(new[:, 1:] - along.clamp(0, 1)[:, None] * expected, dim=1)
    return quantile(shift, was.weight[grey], 0.9)

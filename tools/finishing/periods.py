"""Find the period of a pattern along the rows and along the columns of a picture, by autocorrelation.

A pattern may have a period along one direction only (stripes), or none. Periods are refined on the farthest repetition
that is seen, so that they are exact to a fraction of a cell.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

_OVERLAP = 0.35  # of the picture that a shift must leave on itself
_SHORTEST = 4  # cells
_STRONG = 0.3  # correlation at a shift from which the pattern repeats
_RISES = 0.08  # by which it must be above the lowest correlation at shorter shifts
_ALIKE = 0.85  # of the strongest repetition: the first shift that repeats so well is the period
_ASIDE = 1  # cells by which a repetition may lie off the axis: a picture is seldom quite straight


class Periods(NamedTuple):
    """Periods in cells, None where there is none; and the correlation of the picture with itself one period on."""

    across: float | None
    up: float | None
    strength: float


def periods(detail: F64) -> Periods:
    """The periods of a picture `[H, W, C]` without its low frequencies."""
    table = autocorrelation(detail)
    h, w = detail.shape[:2]
    across, first = _period(_along(table, w, 1), int(w * (1 - _OVERLAP)))
    up, second = _period(_along(table, h, 0), int(h * (1 - _OVERLAP)))
    return Periods(across, up, max(first, second))


def autocorrelation(detail: F64) -> F64:
    """`[2H, 2W]` correlation of a picture with itself at every shift, in [-1, 1] about; shifts wrap around."""
    h, w = detail.shape[:2]
    size = (2 * h, 2 * w)
    ones = np.fft.rfft2(np.ones((h, w)), size)
    count = np.fft.irfft2(np.abs(ones) ** 2, size)
    product, energy = np.zeros(size), np.zeros(size)
    for c in range(detail.shape[2]):
        own = detail[..., c] - detail[..., c].mean()
        turned = np.fft.rfft2(own, size)
        product += np.fft.irfft2(np.abs(turned) ** 2, size)
        squares = np.fft.rfft2(own**2, size)
        energy += np.fft.irfft2(squares * np.conj(ones) + np.conj(squares) * ones, size) / 2
    seen = count > 0.5
    return np.where(seen, product / np.maximum(energy, 1e-12 * max(float(energy.max()), 1e-30)), 0.0)


def _along(table: F64, size: int, axis: int) -> F64:
    """`[size]` correlation at shifts along one axis, the best of those a cell aside."""
    sides = [np.take(table, k, axis=1 - axis)[:size] for k in range(-_ASIDE, _ASIDE + 1)]
    return np.maximum.reduce(sides)


def _period(values: F64, farthest: int) -> tuple[float | None, float]:
    """The first shift at which a correlation `[size]` is nearly as strong as anywhere, refined; and the correlation."""
    if farthest < 2 * _SHORTEST:
        return None, 0.0
    lowest = np.minimum.accumulate(values)
    peak = np.zeros(len(values), bool)
    peak[1:-1] = (values[1:-1] >= values[:-2]) & (values[1:-1] >= values[2:])
    peak &= (values > _STRONG) & (values - lowest > _RISES)
    peak[:_SHORTEST] = False
    peak[farthest:] = False
    found = np.flatnonzero(peak)
    if not len(found):
        return None, 0.0
    strongest = float(values[found].max())
    first = int(found[np.argmax(values[found] >= _ALIKE * strongest)])
    return _refined(values, first, farthest), float(values[first])


def _refined(values: F64, first: int, farthest: int) -> float:
    """The period from the farthest multiple of a first guess at which the pattern still repeats."""
    period = _top(values, first)
    count = 1
    while (count + 1) * period < farthest - 1:
        guess = (count + 1) * period
        reach = max(1, round(0.2 * period))
        low, high = max(1, round(guess) - reach), min(len(values) - 1, round(guess) + reach + 1)
        at = low + int(np.argmax(values[low:high]))
        if values[at] < 0.5 * values[first] or at in (low, high - 1):
            break
        count += 1
        period = _top(values, at) / count
    return period


def _top(values: F64, at: int) -> float:
    """The place of a peak near a cell, by a parabola through three of them."""
    if not 0 < at < len(values) - 1:
        return float(at)
    left, middle, right = values[at - 1 : at + 2]
    bend = left - 2 * middle + right
    return at + float(np.clip(0.5 * (left - right) / bend, -0.5, 0.5)) if bend < 0 else float(at)

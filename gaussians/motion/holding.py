"""Spans of time in which a measured value holds: samples, the crossings between them, and peaks that samples miss.

A value that stays between `release` and `hold` for a moment does not end a span, so that a thing which touches another
does not flicker; the ends of a span are always where the value crosses `hold`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
Span = tuple[float, float]  # start and stop, seconds
Value = Callable[[F64], F64]  # times `[T]`, seconds -> values `[T]`

STEP = 1 / 60  # seconds between samples
_HALVINGS = 9  # of a step: crossings are exact to 0.03 ms
_GOLDEN = 0.5 * (5**0.5 - 1)
_RISE = 2.0  # how far a peak may rise above its highest sample, in falls to the sample beside it
_NARROWINGS = 12  # of two steps around a peak, by the golden section: 0.1 ms


def grid(start: float, stop: float, step: float = STEP) -> F64:
    """Times `[T]` from start to stop, both included, at most `step` apart; one time if both are equal."""
    return np.linspace(start, stop, max(int(np.ceil((stop - start) / step - 1e-9)), 0) + 1)


def spans(value: Value, times: F64, hold: float, release: float | None = None) -> list[Span]:
    """The spans of time in which `value(t) >= hold`, in order.

    Args:
        value: vectorised over times.
        times: `[T]` ascending; the first and the last bound the spans.
        hold: the value from which it holds.
        release: spans between which the value stays at or above it are one; None: `hold`.
    """
    times, values = _with_peaks(value, times, value(times), hold)
    holds = values >= hold
    if not holds.any():
        return []
    edges = np.flatnonzero(holds[1:] != holds[:-1])
    exact = _crossings(value, times[edges], times[edges + 1], holds[edges], hold)
    bounds = [float(t) for t in exact]
    if holds[0]:
        bounds.insert(0, float(times[0]))
    if holds[-1]:
        bounds.append(float(times[-1]))
    found = list(zip(bounds[::2], bounds[1::2], strict=True))
    return found if release is None else _joined(found, times, values, release)


def joined(found: list[Span], pause: float) -> list[Span]:
    """Spans, those that are less than `pause` seconds apart as one."""
    kept: list[Span] = []
    for start, stop in found:
        if kept and start - kept[-1][1] < pause:
            kept[-1] = (kept[-1][0], max(kept[-1][1], stop))
        else:
            kept.append((start, stop))
    return kept


def common(first: list[Span], second: list[Span]) -> list[Span]:
    """The spans of time that lie in a span of both."""
    both = [(max(a, c), min(b, d)) for a, b in first for c, d in second]
    return sorted((a, b) for a, b in both if a < b)


def rest(found: list[Span], start: float, stop: float) -> list[Span]:
    """What the spans leave of a time from start to stop."""
    bounds = [start, *(t for span in found for t in span), stop]
    return [(a, b) for a, b in zip(bounds[::2], bounds[1::2], strict=True) if a < b]


def lowest(value: Value, start: float, stop: float, step: float = STEP) -> float:
    """The time at which a value is lowest between start and stop; the first of several."""
    times = grid(start, stop, step)
    at = int(np.argmin(value(times)))
    low, high = times[max(at - 1, 0)], times[min(at + 1, len(times) - 1)]
    inner = _peak(lambda t: -value(t), np.array([low]), np.array([high]))
    tried = np.array([times[at], inner[0]])
    return float(tried[int(np.argmin(value(tried)))])


def _joined(found: list[Span], times: F64, values: F64, release: float) -> list[Span]:
    kept = [found[0]]
    for start, stop in found[1:]:
        between = values[(times > kept[-1][1]) & (times < start)]
        if (between >= release).all():
            kept[-1] = (kept[-1][0], stop)
        else:
            kept.append((start, stop))
    return kept


def _with_peaks(value: Value, times: F64, values: F64, hold: float) -> tuple[F64, F64]:
    """The samples with those of their peaks added at which the value holds though no sample near it does."""
    inner, before, after = values[1:-1], values[:-2], values[2:]
    reach = inner + _RISE * np.maximum(inner - before, inner - after)  # what is between samples is not far above them
    peaks = np.flatnonzero((inner < hold) & (inner >= before) & (inner >= after) & (reach >= hold)) + 1
    if not len(peaks):
        return times, values
    found = _peak(value, times[peaks - 1], times[peaks + 1])
    high = value(found)
    found, high = found[high >= hold], high[high >= hold]
    every, every_value = np.concatenate([times, found]), np.concatenate([values, high])
    order = np.argsort(every, kind="stable")
    return every[order], every_value[order]


def _peak(value: Value, low: F64, high: F64) -> F64:
    """The times `[K]` of the largest values between `low` and `high` `[K]`, by the golden section."""
    for _ in range(_NARROWINGS):
        reach = _GOLDEN * (high - low)
        left, right = high - reach, low + reach
        better = value(left) > value(right)
        low, high = np.where(better, low, left), np.where(better, right, high)
    return (low + high) / 2


def _crossings(value: Value, low: F64, high: F64, before: NDArray[np.bool_], hold: float) -> F64:
    """The times `[K]` at which the value crosses `hold` between `low` and `high`; `before`: whether it holds at low."""
    for _ in range(_HALVINGS if len(low) else 0):
        middle = (low + high) / 2
        same = (value(middle) >= hold) == before
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return (low + high) / 2

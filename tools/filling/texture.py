"""Continue a picture of a surface into a hole: a smooth solve for its shading, copies of its own texture for the rest.

The texture is copied by few shifts that map the surface onto itself, so that tiles and boards keep period and phase
(compare He and Sun, "Statistics of Patch Offsets for Image Completion", 2012). Each cell of the hole takes the shift
under which the border near it agrees best.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, TypeVar

import numpy as np
import scipy
from numpy.typing import NDArray

from .smooth import F64, Mask, averaged, harmonic

Scalar = TypeVar("Scalar", bound=np.generic)
SHIFTS = 48  # shifts that are tried in each cell
_WIDE = 0.15  # of the picture's shorter side: standard deviation of the low-pass that tells shading from texture
_CUT = 2.5  # standard deviations at which the border near a cell ends
_MOST = 6  # shifts that are used in one hole
_PATCHED = 1.5  # how much worse a shift may meet the border that reaches all of the hole at once
_APART = 2  # cells between two shifts that are tried
_OVERLAP = 0.25  # of the border: what a shift must map onto known cells at least
_FLAT = 2.5e-3  # standard deviation of a texture that is not worth copying, display space
_DARK = 0.03  # added to colours before the logarithm
_RING = 6  # cells around the hole, at most, on which ways to fill it are tried
_PALE, _SMEARED = 1.1, 1.25  # how much worse a fill counts that loses broad texture, or all of it


@dataclass(frozen=True, eq=False)
class Continued:
    """A picture with its hole filled.

    Attributes:
        picture: `[H, W, C]`.
        error: root mean square by which known cells around the hole, filled in the same way from beyond them, differ
            from what they are; display space.
        spread: standard deviation of the surface around the hole, display space.
    """

    picture: F64
    error: float
    spread: float


class _Way(NamedTuple):
    """One way to fill: the low-pass that tells shading from texture, cells; and whether texture is copied."""

    sigma: float
    copies: bool
    price: float = 1.0  # by which its error counts more


def continued(picture: F64, known: Mask, hole: Mask) -> Continued:
    """The picture with a hole filled from its known cells, in that of several ways that fills the known cells around
    the hole best.

    Light and pigment multiply, so shading and texture are told apart in logarithms.

    Args:
        picture: `[H, W, C]`, valid where known.
        known: `[H, W]`.
        hole: `[H, W]`, disjoint from `known`.
    """
    depth = max(1.0, float(scipy.ndimage.distance_transform_edt(hole).max()))
    ring = scipy.ndimage.binary_dilation(hole, iterations=int(np.clip(depth / 2, 2, _RING))) & known
    logs = np.log(np.maximum(picture, 0.0) + _DARK)
    spread = float(picture[ring].std(axis=0).mean()) if ring.any() else 0.0
    broad = float(np.clip(max(depth, _WIDE * min(hole.shape)), 4.0, 24.0))
    narrow = float(np.clip(depth / 2, 2.0, 12.0))
    ways = (_Way(broad, True), _Way(narrow, True, _PALE), _Way(narrow, False, _SMEARED))
    beyond = known & ~ring
    if spread < _FLAT or beyond.sum() < ring.sum() or not ring.any():
        return Continued(_shown(picture, _filled(logs, known, hole, ways[-1]), hole), spread, spread)
    errors = []
    for way in ways:
        tried = np.exp(_filled(logs, beyond, hole | ring, way)) - _DARK
        errors.append(float(np.sqrt(((tried - picture)[ring] ** 2).mean())) * way.price)
    best = int(np.argmin(errors))
    return Continued(_shown(picture, _filled(logs, known, hole, ways[best]), hole), errors[best], spread)


def continued_far(picture: F64, known: Mask, hole: Mask) -> F64:
    """The picture with a large hole filled by its texture alone, `[H, W, C]`: what to compare a shadow with."""
    logs = np.log(np.maximum(picture, 0.0) + _DARK)
    depth = max(1.0, float(scipy.ndimage.distance_transform_edt(hole).max()))
    broad = float(np.clip(max(depth, _WIDE * min(hole.shape)), 4.0, 24.0))
    return _shown(picture, _filled(logs, known, hole, _Way(broad, True)), hole)


def _shown(picture: F64, logs: F64, hole: Mask) -> F64:
    """The picture with the colours of a hole taken from logarithms."""
    return np.where(hole[..., None], np.exp(logs) - _DARK, picture)


def _filled(logs: F64, known: Mask, hole: Mask, way: _Way) -> F64:
    """`[H, W, C]` logarithms of colours with the hole filled in one way."""
    weight = known.astype(np.float64)
    low = averaged(logs, weight, way.sigma)
    out = np.where(hole[..., None], harmonic(low, known, hole), logs)
    if not way.copies:
        return out
    detail = np.where(known[..., None], logs - low, 0.0)
    depth = max(1.0, float(scipy.ndimage.distance_transform_edt(hole).max()))
    border = scipy.ndimage.binary_dilation(hole, iterations=max(4, int(depth))) & known
    out[hole] += _copied(detail, known, hole, border)[hole]
    return out


def _copied(detail: F64, known: Mask, hole: Mask, border: Mask) -> F64:
    """`[H, W, C]` detail in the hole, copied by few shifts.

    Shifts are taken one after another: that which meets the border near what is left best, and reaches most of it.
    """
    shifts = _shifts(detail, known, hole, border)
    taken = np.zeros_like(detail)
    if not len(shifts):
        return taken
    width = max(2.0, float(scipy.ndimage.distance_transform_edt(hole).max()) * 0.7)
    prices = np.stack([_price(detail, known, hole, border, shift, width) for shift in shifts])  # [S, H, W]
    left = hole.copy()
    for _ in range(_MOST):
        reached = np.isfinite(prices) & left
        count = reached.sum(axis=(1, 2))
        if not count.max(initial=0):
            break
        mean = np.where(reached, prices, 0.0).sum(axis=(1, 2)) / np.maximum(count, 1)
        share = count / max(int(left.sum()), 1)
        best = int(np.argmin(np.where(count > 0, mean * (1 + _PATCHED * (1 - share)) + 1e-4 * (1 - share), np.inf)))
        here = reached[best]
        taken[here] = moved(detail, *shifts[best])[here]
        left &= ~here
    return _blended(taken, hole, left)


def _price(detail: F64, known: Mask, hole: Mask, border: Mask, shift: tuple[int, int], width: float) -> F64:
    """`[H, W]` mean squared disagreement of a shift with the border near each cell; infinite where it has no source."""
    valid = moved(known, *shift)
    both = border & valid
    wrong = ((detail - moved(detail, *shift)) ** 2).mean(axis=2) * both
    near = scipy.ndimage.gaussian_filter(wrong, width, mode="constant", truncate=_CUT)
    share = scipy.ndimage.gaussian_filter(both.astype(np.float64), width, mode="constant", truncate=_CUT)
    # A shift that only a few border cells speak for is worth less.
    return np.where(hole & valid, (near + 1e-5) / np.maximum(share, 1e-9), np.inf)


def _blended(taken: F64, hole: Mask, left: Mask) -> F64:
    """The detail with the cells that no shift reaches averaged from their neighbours."""
    if not left.any():
        return taken
    weight = (hole & ~left).astype(np.float64)
    return np.where(left[..., None], averaged(taken, weight, 2.0) if weight.any() else 0.0, taken)


def moved(values: NDArray[Scalar], dy: int, dx: int) -> NDArray[Scalar]:
    """`out[y, x] = values[y + dy, x + dx]`; zero (or False) where that lies outside."""
    out = np.zeros_like(values)
    h, w = values.shape[:2]
    ys, xs = slice(max(0, -dy), min(h, h - dy)), slice(max(0, -dx), min(w, w - dx))
    if ys.start < ys.stop and xs.start < xs.stop:
        out[ys, xs] = values[ys.start + dy : ys.stop + dy, xs.start + dx : xs.stop + dx]
    return out


def _shifts(detail: F64, known: Mask, hole: Mask, border: Mask) -> list[tuple[int, int]]:
    """The shifts `(dy, dx)` under which the border agrees best with known cells, the best first; and those that
    bring most of the hole onto known cells, so that every cell has a source."""
    h, w = known.shape
    size = (2 * h, 2 * w)
    edge, full = border.astype(np.float64), known.astype(np.float64)
    turn = [np.conj(np.fft.rfft2(edge, size)), np.fft.rfft2(full, size)]
    count = np.fft.irfft2(turn[0] * turn[1], size)
    error = np.zeros(size)
    for c in range(detail.shape[2]):
        d = detail[..., c]
        own, all_ = d * edge, d * full
        error += np.fft.irfft2(np.conj(np.fft.rfft2(own * d, size)) * turn[1], size)
        error += np.fft.irfft2(turn[0] * np.fft.rfft2(all_ * d, size), size)
        error -= 2 * np.fft.irfft2(np.conj(np.fft.rfft2(own, size)) * np.fft.rfft2(all_, size), size)
    covers = np.fft.irfft2(np.conj(np.fft.rfft2(hole.astype(np.float64), size)) * turn[1], size)
    dy, dx = (np.fft.fftfreq(n, 1 / n).astype(int) for n in size)
    fits = (np.abs(dy)[:, None] < h) & (np.abs(dx)[None, :] < w) & (count > _OVERLAP * edge.sum())
    fits &= covers > 0.02 * hole.sum()
    fits &= np.maximum(np.abs(dy)[:, None], np.abs(dx)[None, :]) > 3
    mean = np.where(fits, np.maximum(error, 0) / np.maximum(count, 1.0), np.inf)
    lowest = mean <= scipy.ndimage.minimum_filter(mean, 2 * _APART + 1, mode="wrap")
    covered = np.clip(covers / max(int(hole.sum()), 1), 0.0, 1.0)
    found: list[tuple[int, int]] = []
    for table in (np.where(lowest, mean, np.inf), np.where(lowest, mean / (0.05 + covered**2), np.inf)):
        order = np.argsort(table, axis=None, kind="stable")[: SHIFTS // 2]
        ys, xs = np.unravel_index(order, size)
        found += [(int(dy[y]), int(dx[x])) for y, x in zip(ys, xs, strict=True) if np.isfinite(table[y, x])]
    return list(dict.fromkeys(found))

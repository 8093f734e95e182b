"""Continue a picture of a surface into a hole: a smooth solve for its shading, copies of its own texture for the rest.

The texture is copied by few shifts that map the surface onto itself, so that tiles and boards keep period and phase
(compare He and Sun, "Statistics of Patch Offsets for Image Completion", 2012). Each cell of the hole takes the shift
under which the border near it agrees best.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from .smooth import F64, Mask, averaged, harmonic

Scalar = TypeVar("Scalar", bound=np.generic)
SHIFTS = 48  # shifts that are tried in each cell
_APART = 2  # cells between two shifts that are tried
_OVERLAP = 0.25  # of the border: what a shift must map onto known cells at least
_FLAT = 2.5e-3  # standard deviation of a texture that is not worth copying, display space


@dataclass(frozen=True, eq=False)
class Continued:
    """A picture with its hole filled.

    Attributes:
        picture: `[H, W, C]`.
        error: root mean square by which the copied texture disagrees with the border, display space.
        spread: standard deviation of the surface's texture around the hole, display space.
    """

    picture: F64
    error: float
    spread: float


def continued(picture: F64, known: Mask, hole: Mask, lit: F64 | None = None) -> Continued:
    """The picture with a hole filled from its known cells.

    Args:
        picture: `[H, W, C]`, valid where known.
        known: `[H, W]`.
        hole: `[H, W]`, disjoint from `known`.
        lit: `[H, W]` weight of known cells for the shading; less than one where a shadow lies. None: all the same.
    """
    weight = known.astype(np.float64) * (1.0 if lit is None else np.clip(lit, 0.0, 1.0))
    depth = max(1.0, float(ndimage.distance_transform_edt(hole).max()))
    sigma = float(np.clip(depth / 2, 2.0, 12.0))
    low = averaged(picture, weight, sigma)
    trusted = known & (weight > 0.5) if (weight > 0.5).any() else known
    smooth = harmonic(low, trusted, hole | (known & ~trusted))
    detail = np.where(known[..., None], picture - averaged(picture, known.astype(np.float64), sigma), 0.0)
    border = ndimage.binary_dilation(hole, iterations=max(3, int(depth))) & known
    spread = float(detail[border].std()) if border.any() else 0.0
    out = picture.astype(np.float64, copy=True)
    out[hole] = smooth[hole]
    if spread < _FLAT:
        return Continued(out, spread, spread)
    taken, error = _copied(detail, known, hole, border)
    out[hole] += taken[hole]
    return Continued(out, min(error, spread * 1.5), spread)


def _copied(detail: F64, known: Mask, hole: Mask, border: Mask) -> tuple[F64, float]:
    """`[H, W, C]` detail in the hole, copied by the best shifts, and its error along the border."""
    shifts = _shifts(detail, known, hole, border)
    taken = np.zeros_like(detail)
    if not len(shifts):
        return taken, float(detail[border].std()) if border.any() else 0.0
    best, cost = np.full(hole.shape, -1), np.full(hole.shape, np.inf)
    width = max(2.0, float(ndimage.distance_transform_edt(hole).max()) * 0.7)
    for number, (dy, dx) in enumerate(shifts):
        there, valid = moved(detail, dy, dx), moved(known, dy, dx)
        both = border & valid
        wrong = (((detail - there) ** 2).mean(axis=2)) * both
        near = ndimage.gaussian_filter(wrong, width, mode="constant")
        share = ndimage.gaussian_filter(both.astype(np.float64), width, mode="constant")
        # A shift that only a few border cells speak for is worth less.
        price = (near + 1e-5) / np.maximum(share, 1e-9)
        better = hole & valid & (price < cost)
        best[better], cost[better] = number, price[better]
    best = _settled(best, hole)
    for number, (dy, dx) in enumerate(shifts):
        here = hole & (best == number)
        if here.any():
            taken[here] = moved(detail, dy, dx)[here]
    found = hole & (best >= 0)
    error = float(np.sqrt(np.median(cost[found]))) if found.any() else float(detail[border].std())
    return taken, error


def _settled(best: NDArray[np.int64], hole: Mask) -> NDArray[np.int64]:
    """The label of each hole cell after a vote among its neighbours; cells without a label stay without one."""
    labels = np.unique(best[hole & (best >= 0)])
    if len(labels) < 2:
        return best
    votes = np.stack([ndimage.uniform_filter((best == k).astype(np.float32), 5) for k in labels])
    winner = labels[votes.argmax(axis=0)]
    return np.where(hole & (best >= 0), winner, best)


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
    lowest = mean <= ndimage.minimum_filter(mean, 2 * _APART + 1, mode="wrap")
    covered = np.clip(covers / max(int(hole.sum()), 1), 0.0, 1.0)
    found: list[tuple[int, int]] = []
    for table in (np.where(lowest, mean, np.inf), np.where(lowest, mean / (0.05 + covered**2), np.inf)):
        order = np.argsort(table, axis=None, kind="stable")[: SHIFTS // 2]
        ys, xs = np.unravel_index(order, size)
        found += [(int(dy[y]), int(dx[x])) for y, x in zip(ys, xs, strict=True) if np.isfinite(table[y, x])]
    return list(dict.fromkeys(found))

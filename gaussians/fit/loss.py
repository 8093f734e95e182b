"""The photometric training loss, L1 and D-SSIM, with its gradient by the image.

`(1 - s) |x - y| + s (1 - SSIM(x, y))`, means over pixels and channels, as in Kerbl et al. 2023 (section 5.1); SSIM of
Wang et al. 2004 in windows of 11x11 with a Gaussian of 1.5 px, zero-padded. `photometric` is compiled, `reference` is
the same in torch.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from .. import compiled
from ..compiled import exact, exact_helper

F32 = NDArray[np.float32]
Array = NDArray[Any]
Slope = Callable[[F32], tuple[float, F32]]  # of a picture [H, W, 3], not clipped: a loss, and its gradient by it

BLACK = (0.0, 0.0, 0.0)  # background of the renders that are compared with photographs
RADIUS = 5  # px on each side of a window's centre
SIGMA = 1.5  # px
C1, C2 = 0.01**2, 0.03**2  # for values in [0, 1]

f4 = np.float32
ONE, TWO, FIRST, SECOND = f4(1), f4(2), f4(C1), f4(C2)


def photometric(picture: F32, photo: F32, ssim_lambda: float = 0.2) -> tuple[float, F32]:
    """The loss and its gradient by the rendered image, `[H, W, 3]`.

    Args:
        picture, photo: `[H, W, 3]` float32, contiguous.
        ssim_lambda: weight of D-SSIM in the loss, in [0, 1].
    """
    height, _, channels = picture.shape
    x, y = picture.reshape(height, -1), photo.reshape(height, -1)
    gradient, rows = np.empty_like(x), np.zeros((height, 2), np.float64)
    count = compiled.workers()
    maps = np.empty((5, *x.shape), np.float32)
    slopes = np.empty((3, *x.shape), np.float32)
    taps, step = _taps(), channels
    line = np.empty((count, 5, x.shape[1]), np.float32)
    if ssim_lambda > 0:
        compiled.run(_blur_rows, count, x, y, taps, step, maps, line)
        compiled.run(_ssim_backward, count, maps, taps, slopes, rows, line)
        compiled.run(_blur_columns, count, slopes, taps, maps)
    weights = f4((1 - ssim_lambda) / x.size), f4(-ssim_lambda / x.size)
    compiled.run(_loss_backward, count, x, y, maps, taps, step, weights, line, rows, gradient)
    similarity, l1 = rows.sum(axis=0) / x.size
    return float((1 - ssim_lambda) * l1 + ssim_lambda * (1 - similarity)), gradient.reshape(picture.shape)


def reference(picture: Tensor, photo: Tensor, ssim_lambda: float = 0.2) -> Tensor:
    """The loss of `photometric` as a differentiable scalar of any float type."""
    return (1 - ssim_lambda) * (picture - photo).abs().mean() + ssim_lambda * (1 - ssim(picture, photo))


def ssim(picture: Tensor, photo: Tensor) -> Tensor:
    """Mean SSIM of two images `[H, W, 3]` with values in [0, 1]."""
    x, y = (p.permute(2, 0, 1)[:, None] for p in (picture, photo))
    taps = torch.from_numpy(_taps()).to(picture)

    def blur(image: Tensor) -> Tensor:
        along = torch.nn.functional.conv2d(image, taps.view(1, 1, 1, -1), padding=(0, RADIUS))
        return torch.nn.functional.conv2d(along, taps.view(1, 1, -1, 1), padding=(RADIUS, 0))

    mx, my, xx, yy, xy = (blur(image) for image in (x, y, x * x, y * y, x * y))
    alike = (2 * mx * my + C1) * (2 * (xy - mx * my) + C2)
    return (alike / ((mx * mx + my * my + C1) * (xx - mx * mx + yy - my * my + C2))).mean()


@cache
def _taps() -> F32:
    """`[11]` weights of the Gaussian window along one axis."""
    weights = np.exp(-0.5 * (np.arange(-RADIUS, RADIUS + 1) / SIGMA) ** 2)
    return (weights / weights.sum()).astype(np.float32)


@exact_helper
def _add(target, source, weight):  # type: ignore[no-untyped-def]
    """`target += weight * source`, two lines of equal length; compilers vectorise this loop."""
    for i in range(target.shape[0]):
        target[i] += weight * source[i]


@exact
def _blur_rows(worker, workers, x, y, taps, step, maps, scratch):  # type: ignore[no-untyped-def]
    """Blur x, y, xx, yy and xy `[H, W * step]` horizontally into `maps` `[5, H, W * step]`."""
    height, width = x.shape
    line = scratch[worker]
    for row in range(height * worker // workers, height * (worker + 1) // workers):
        a, b = x[row], y[row]
        aa, bb, ab = line[0], line[1], line[2]
        for i in range(width):
            aa[i], bb[i], ab[i] = a[i] * a[i], b[i] * b[i], a[i] * b[i]
        for k in range(5):
            maps[k, row] = f4(0)
        for tap in range(taps.shape[0]):
            offset = (tap - RADIUS) * step
            low, high = max(0, -offset), min(width, width - offset)
            if low < high:
                _add(maps[0, row, low:high], a[low + offset : high + offset], taps[tap])
                _add(maps[1, row, low:high], b[low + offset : high + offset], taps[tap])
                _add(maps[2, row, low:high], aa[low + offset : high + offset], taps[tap])
                _add(maps[3, row, low:high], bb[low + offset : high + offset], taps[tap])
                _add(maps[4, row, low:high], ab[low + offset : high + offset], taps[tap])


@exact
def _ssim_backward(worker, workers, maps, taps, slopes, rows, scratch):  # type: ignore[no-untyped-def]
    """Blur vertically and compute SSIM with its gradient.

    `rows[:, 0]` gets each row's sum of SSIM, `slopes` its derivatives by the blurred x, xx and xy.
    """
    _, height, width = maps.shape
    mean_x, mean_y, square_x = scratch[worker, 0], scratch[worker, 1], scratch[worker, 2]
    square_y, product = scratch[worker, 3], scratch[worker, 4]
    similar = scratch[worker, 0]
    for row in range(height * worker // workers, height * (worker + 1) // workers):
        scratch[worker] = f4(0)
        for tap in range(taps.shape[0]):
            other = row + tap - RADIUS
            if 0 <= other < height:
                for k in range(5):
                    _add(scratch[worker, k], maps[k, other], taps[tap])
        by_mean, by_square, by_product = slopes[0, row], slopes[1, row], slopes[2, row]
        for i in range(width):
            mx, my = mean_x[i], mean_y[i]
            a1, b1 = TWO * mx * my + FIRST, mx * mx + my * my + FIRST
            a2, b2 = TWO * (product[i] - mx * my) + SECOND, square_x[i] - mx * mx + square_y[i] - my * my + SECOND
            both = ONE / (b1 * b2)
            alike = a1 * a2 * both
            by_mean[i] = TWO * my * (a2 - a1) * both + TWO * mx * alike * (ONE / b2 - ONE / b1)
            by_square[i] = -alike / b2
            by_product[i] = TWO * a1 * both
            similar[i] = alike
        rows[row, 0] = _total(similar)


@exact_helper
def _total(line):  # type: ignore[no-untyped-def]
    """Sum of a line, added up in float64 from left to right."""
    total = 0.0
    for i in range(line.shape[0]):
        total += line[i]
    return total


@exact
def _blur_columns(worker, workers, slopes, taps, maps):  # type: ignore[no-untyped-def]
    """Blur three maps vertically, into the first three of `maps`."""
    _, height, _ = slopes.shape
    for row in range(height * worker // workers, height * (worker + 1) // workers):
        for k in range(3):
            maps[k, row] = f4(0)
            for tap in range(taps.shape[0]):
                other = row + tap - RADIUS
                if 0 <= other < height:
                    _add(maps[k, row], slopes[k, other], taps[tap])


@exact
def _loss_backward(worker, workers, x, y, maps, taps, step, weights, scratch, rows, gradient):  # type: ignore[no-untyped-def]
    """Blur the first three maps horizontally and compute the gradient; `rows[:, 1]` gets each row's sum of |x - y|."""
    height, width = x.shape
    plain, similar = weights
    by_mean, by_square, by_product = scratch[worker, 0], scratch[worker, 1], scratch[worker, 2]
    distance = scratch[worker, 0]
    for row in range(height * worker // workers, height * (worker + 1) // workers):
        scratch[worker] = f4(0)
        if similar != f4(0):
            for tap in range(taps.shape[0]):
                offset = (tap - RADIUS) * step
                low, high = max(0, -offset), min(width, width - offset)
                if low < high:
                    for k in range(3):
                        _add(scratch[worker, k, low:high], maps[k, row, low + offset : high + offset], taps[tap])
        a, b, out = x[row], y[row], gradient[row]
        for i in range(width):
            off = a[i] - b[i]
            sign = f4(off > f4(0)) - f4(off < f4(0))
            out[i] = plain * sign + similar * (by_mean[i] + TWO * a[i] * by_square[i] + b[i] * by_product[i])
            distance[i] = abs(off)
        rows[row, 1] = _total(distance)

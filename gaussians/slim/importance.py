"""Measures the squared error of pictures that each Gaussian, or its higher SH bands, causes if it is left out.

A picture is linear in the opacity of one Gaussian. Leaving it out therefore changes pixel p by exactly
`opacity * d color_p / d opacity`, which holds what shows behind it: a Gaussian inside a surface of its own colour costs
nothing, however opaque it is. The sum over pixels of the squares of such derivatives is estimated with one backward
pass per view, from a picture v of random signs: `(sum_p v_p d_p)^2` has the mean `sum_p d_p^2` (Hutchinson 1990).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ..cloud import GaussianCloud
from ..harmonics import SH_C0, basis
from ..render.cpu import gradient
from .views import View

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

ROUND_SHARE = 0.9  # of the Gaussians kept from one round of the ranking to the next
RANKED_SHARE = 0.2  # of all Gaussians, at which the rounds end
SEED = 16

Progress = Callable[[str, float], None]


@dataclass(frozen=True, eq=False)
class Importance:
    """Squared errors summed over the channels and pixels of all views, with everything else unchanged.

    Attributes:
        removal: `[N]`, of leaving out each Gaussian.
        bands: `[N, degree]`, column d: of leaving out its SH bands above d.
        weights: `[N]`, squared blending weight summed over pixels: how much the colour of each Gaussian matters.
        mean_basis: `[N, K - 1]`, SH basis functions above the constant one, averaged over the views with these weights:
            a change d of the higher coefficients changes the mean colour by `mean_basis @ d`.
        basis_spread: `[K - 1, K - 1]`, covariance of these functions over the views of a Gaussian, averaged over the
            Gaussians with their weights: a change d changes the squared colour by `d @ basis_spread @ d` on average,
            its mean aside.
        pixels: channels times pixels of the views.
        slopes: mean over the Gaussians of the squared derivative by one value of "means", "log_means" (`sign(x)
            log(1 + |x|)`), "log_scales", "quats", "opacities" and "sh" (the constant band): what rounding it costs.
    """

    removal: F64
    bands: F64
    weights: F64
    mean_basis: F64
    basis_spread: F64
    pixels: int
    slopes: dict[str, float]


def measure(cloud: GaussianCloud, views: Sequence[View], seed: int = SEED) -> Importance:
    """Measure the importance of every Gaussian of a cloud to some views. Same input, same result."""
    columns = tuple(c.detach().cpu().contiguous().numpy() for c in _columns(cloud))
    means, _, scales, opacities, sh = columns
    rng, count, degree = np.random.default_rng(seed), len(cloud), cloud.degree
    removal, bands, squares = np.zeros(count), np.zeros((count, degree)), dict.fromkeys(_SLOPES, 0.0)
    weights, mean_basis, pixels = np.zeros(count), np.zeros((count, sh.shape[1] - 1)), 0
    squared = np.zeros((sh.shape[1] - 1, sh.shape[1] - 1))
    for view in views:
        drawn = gradient.draw(columns, view.camera, view.background)
        signs = rng.integers(0, 2, drawn.rgb.shape).astype(np.float32) * 2 - 1
        found = gradient.draw_backward(drawn, signs, np.zeros(signs.shape[:2], np.float32))
        removal += (found.opacities.astype(np.float64) * opacities) ** 2
        weight = (found.sh[:, 0].astype(np.float64) ** 2).mean(axis=1) / SH_C0**2
        weights += weight
        if degree:
            values = _basis(means, degree, view)
            bands += weight[:, None] * _higher_colors(values, sh)
            mean_basis += weight[:, None] * values[:, 1:]
            squared += (weight[:, None] * values[:, 1:]).T @ values[:, 1:]
        pixels += signs.size
        logs = found.means * (1 + np.abs(means))
        by_value = found.means, logs, found.scales * scales, found.quats, found.opacities, found.sh[:, 0]
        for name, slope in zip(_SLOPES, by_value, strict=True):
            squares[name] += float(np.nansum(np.square(slope, dtype=np.float64))) / slope.size
    mean_basis /= np.maximum(weights, 1e-12)[:, None]
    spread = (squared - (weights[:, None] * mean_basis).T @ mean_basis) / max(float(weights.sum()), 1e-12)
    return Importance(removal, bands, weights, mean_basis, spread, pixels, squares)


_SLOPES = ("means", "log_means", "log_scales", "quats", "opacities", "sh")


def rank(cloud: GaussianCloud, views: Sequence[View], progress: Progress | None = None) -> tuple[I64, Importance]:
    """Rows `[N]` of a cloud in the order in which they should be kept, and the importance in the whole cloud.

    In rounds, the least important tenth is left out and the rest is measured again, by one half of the views and then
    by the other: where one of two Gaussians that show the same is gone, the other has become important. Leaving out a
    fifth in a round loses 2.5 to 4 dB more on a capture that has few Gaussians to spare.
    """
    whole = measure(cloud, views)
    rows, last = np.arange(len(cloud)), list[I64]()
    halves = [whole.removal / 2, whole.removal / 2]
    target = max(1, round(RANKED_SHARE * len(cloud)))
    rounds = max(1, math.ceil(math.log(target / max(len(cloud), 1)) / math.log(ROUND_SHARE)))
    for number in range(rounds):
        order = np.argsort(-(halves[0] + halves[1])[rows], kind="stable")
        kept = max(target, round(ROUND_SHARE * len(rows)))
        last.append(rows[order[kept:]])
        rows = np.sort(rows[order[:kept]])
        if progress:
            progress("ranking", (number + 1) / rounds)
        half = views[number % 2 :: 2] or views
        halves[number % 2][rows] = measure(cloud[torch.from_numpy(rows)], half, SEED + number + 1).removal
    last.append(rows[np.argsort(-(halves[0] + halves[1])[rows], kind="stable")])
    return np.concatenate(last[::-1]), whole


def _columns(cloud: GaussianCloud) -> tuple[torch.Tensor, ...]:
    return cloud.means, cloud.quats, cloud.scales, cloud.opacities, cloud.sh


def _basis(means: NDArray[np.float32], degree: int, view: View) -> NDArray[np.float32]:
    """`[N, K]` SH basis functions in the direction from a view's eye to each centre."""
    away = means - view.camera.position.astype(np.float32)
    away /= np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1e-12)
    values: NDArray[np.float32] = basis(torch.from_numpy(away), degree).numpy()
    return values


def _higher_colors(values: NDArray[np.float32], sh: NDArray[np.float32]) -> F64:
    """`[N, degree]` squared colour, summed over channels, of the SH bands above 0, 1, ... at some basis values."""
    degree = int(np.sqrt(sh.shape[1])) - 1
    out, color = np.zeros((len(sh), degree)), np.zeros((len(sh), 3), np.float32)
    for band in range(degree, 0, -1):
        for k in range(band**2, (band + 1) ** 2):
            color += values[:, k, None] * sh[:, k]
        out[:, band - 1] = np.square(color, dtype=np.float64).sum(axis=1)
    return out

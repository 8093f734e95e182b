"""Kernels: what merging two Gaussians changes in pictures, and disjoint pairs of least cost.

A Gaussian is seen as `opacity * exp(-q / 2)` in an orthographic view. The squared difference between two Gaussians and
the one that replaces them has a closed form: the integral of a product of two Gaussians. It is averaged over three
views along the axes of the larger one, so that neither their distance along its normal nor in its plane goes unnoticed.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..compiled import exact, exact_helper

OPAQUE = 0.999  # largest opacity of a merged Gaussian
COVERAGE = 0.05  # weight of changed coverage against changed colour: what shows behind is mostly alike
TINY = 1e-30


class Covariance(NamedTuple):
    """The upper triangle of a symmetric 3x3 matrix."""

    xx: float
    xy: float
    xz: float
    yy: float
    yz: float
    zz: float


class Shadow(NamedTuple):
    """The covariance of a Gaussian in a view along one axis, and the root of its determinant."""

    uu: float
    uv: float
    vv: float
    root: float


@exact
def pair_costs(worker, workers, first, second, means, covariances, frames, mass, area, colors, shown, cost):  # type: ignore[no-untyped-def]
    """Write to `cost` `[P]` the squared change of pictures by merging the rows `first[p]` and `second[p]`.

    `means` `[N, 3]`, `covariances` `[N, 6]` (see `Covariance`), `frames` `[N, 3, 3]` (columns: axes to look along),
    `mass` and `area` `[N]` (their ratio is the opacity), `colors` `[N, C]` (squared distance: squared difference of
    colour), `shown` `[N]`, the weight of a squared change in the place of a Gaussian.
    """
    for p in range(first.shape[0] * worker // workers, first.shape[0] * (worker + 1) // workers):
        i, j = first[p], second[p]
        total = mass[i] + mass[j]
        share, other = mass[i] / total, mass[j] / total
        dx, dy, dz = means[j, 0] - means[i, 0], means[j, 1] - means[i, 1], means[j, 2] - means[i, 2]
        a, b = _row(covariances, i), _row(covariances, j)
        both = _mixed(a, b, share, other, dx, dy, dz)
        alpha_i = min(mass[i] / area[i], OPAQUE)
        alpha_j = min(mass[j] / area[j], OPAQUE)
        alpha = min(total / mean_area(both), OPAQUE)
        color = 0.0
        for c in range(colors.shape[1]):
            color += (colors[i, c] - colors[j, c]) ** 2
        large = i if area[i] > area[j] else j
        change = 0.0
        for axis in range(3):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            x = dx * frames[large, 0, u] + dy * frames[large, 1, u] + dz * frames[large, 2, u]
            y = dx * frames[large, 0, v] + dy * frames[large, 1, v] + dz * frames[large, 2, v]
            s = _shadow(frames, large, a, u, v)
            t = _shadow(frames, large, b, u, v)
            m = _shadow(frames, large, both, u, v)
            own_i, own_j = 0.5 * alpha_i * alpha_i * s.root, 0.5 * alpha_j * alpha_j * t.root
            between = alpha_i * alpha_j * _product(s, t, x, y)
            with_i = alpha_i * alpha * _product(s, m, other * x, other * y)
            with_j = alpha_j * alpha * _product(t, m, share * x, share * y)
            coverage = own_i + own_j + 0.5 * alpha * alpha * m.root + 2 * (between - with_i - with_j)
            hue = other * other * own_i + share * share * own_j - 2 * share * other * between
            change += COVERAGE * coverage + color * hue
        cost[p] = change * (share * shown[i] + other * shown[j])


@exact
def disjoint(order, first, second, most, used, picked):  # type: ignore[no-untyped-def]
    """Take pairs in an order, each row at most once, until there are `most`; returns how many stand in `picked`.

    `used` is `[N]` bool, all false.
    """
    count = 0
    for p in order:
        if count >= most:
            break
        if not used[first[p]] and not used[second[p]]:
            used[first[p]] = used[second[p]] = True
            picked[count] = p
            count += 1
    return count


@exact_helper
def mean_area(c):  # type: ignore[no-untyped-def]
    """Root mean square, over all directions, of the area that a Gaussian projects to, in units of 2 pi."""
    minors = c.xx * c.yy - c.xy * c.xy + c.xx * c.zz - c.xz * c.xz + c.yy * c.zz - c.yz * c.yz
    return math.sqrt(max(minors / 3, TINY))


@exact_helper
def _row(covariances, i):  # type: ignore[no-untyped-def]
    return Covariance(
        covariances[i, 0], covariances[i, 1], covariances[i, 2], covariances[i, 3], covariances[i, 4], covariances[i, 5]
    )  # fmt: skip


@exact_helper
def _mixed(a, b, share, other, dx, dy, dz):  # type: ignore[no-untyped-def]
    """The covariance of two Gaussians with weights that sum to one, a distance apart."""
    apart = share * other
    return Covariance(
        share * a.xx + other * b.xx + apart * dx * dx, share * a.xy + other * b.xy + apart * dx * dy,
        share * a.xz + other * b.xz + apart * dx * dz, share * a.yy + other * b.yy + apart * dy * dy,
        share * a.yz + other * b.yz + apart * dy * dz, share * a.zz + other * b.zz + apart * dz * dz,
    )  # fmt: skip


@exact_helper
def _shadow(frames, row, c, u, v):  # type: ignore[no-untyped-def]
    """A covariance projected on two axes of a frame."""
    ux, uy, uz = frames[row, 0, u], frames[row, 1, u], frames[row, 2, u]
    vx, vy, vz = frames[row, 0, v], frames[row, 1, v], frames[row, 2, v]
    ax, ay, az = c.xx * ux + c.xy * uy + c.xz * uz, c.xy * ux + c.yy * uy + c.yz * uz, c.xz * ux + c.yz * uy + c.zz * uz
    bx, by, bz = c.xx * vx + c.xy * vy + c.xz * vz, c.xy * vx + c.yy * vy + c.yz * vz, c.xz * vx + c.yz * vy + c.zz * vz
    uu, uv, vv = ax * ux + ay * uy + az * uz, ax * vx + ay * vy + az * vz, bx * vx + by * vy + bz * vz
    return Shadow(uu, uv, vv, math.sqrt(max(uu * vv - uv * uv, 0.0)))


@exact_helper
def _product(s, t, x, y):  # type: ignore[no-untyped-def]
    """The integral of the product of two Gaussians of height one, `(x, y)` apart, in units of 2 pi."""
    uu, uv, vv = s.uu + t.uu, s.uv + t.uv, s.vv + t.vv
    determinant = max(uu * vv - uv * uv, TINY)
    apart = (vv * x * x - 2 * uv * x * y + uu * y * y) / determinant
    return s.root * t.root / math.sqrt(determinant) * math.exp(-0.5 * apart)


def mean_areas(covariances: np.ndarray) -> np.ndarray:
    """`[N]`, `mean_area` of covariances `[N, 6]`."""
    xx, xy, xz, yy, yz, zz = covariances.T
    minors = xx * yy - xy * xy + xx * zz - xz * xz + yy * zz - yz * yz
    areas: np.ndarray = np.sqrt(np.maximum(minors / 3, TINY))
    return areas

"""Depth of the surface that a camera sees: where the light along a pixel's ray has fallen to a given share.

The depth of `render` is a blend of centres. This one is that of a single Gaussian, the one that takes the light below
the share: along the ray it is a Gaussian too, which has taken its whole share at its peak (Yu et al. 2024, "Gaussian
Opacity Fields"). On a flat disc seen at an angle the two depths differ by the disc's radius.
"""

from __future__ import annotations

import math

import numpy as np

from ...compiled import fetch_add, helper, kernel
from .layout import L1, L2, L3, SHIFT, TILE, Array, X, Y

MOST = 48  # Gaussians of a ray that are sorted
DARK = np.float32(0.02)  # light that is left when no more are: in the order of their centres others may follow
REACH = np.float32(3.0)  # standard deviations of the longest axis that the depth may lie from the centre

f4 = np.float32
ZERO, HALF, ONE, TWO, EIGHT, TINY = f4(0), f4(0.5), f4(1), f4(2), f4(8), f4(1e-6)


@kernel
def draw(worker, workers, first, entries, records, size, limits, shapes, view, level, rays, out, counter):  # type: ignore[no-untyped-def]
    """Write the depth and slant `[H, W]` of every pixel, tile by tile; infinite and 1 where the light stays above
    `level`.

    Tile t's footprints are `entries[first[t]:first[t + 1]]`, nearest first. `shapes` is from `make_shapes`, `rays`
    `[workers, MOST, 4]` is scratch memory.
    """
    depth, slant = out
    ray = rays[worker]
    tiles_wide = (size[0] + TILE - 1) // TILE
    most, q_max = limits[0], limits[2]
    while True:
        tile = fetch_add(counter, 1)
        if tile >= first.shape[0] - 1:
            break
        left, top = tile % tiles_wide * TILE, tile // tiles_wide * TILE
        for y in range(top, min(top + TILE, size[1])):
            for x in range(left, min(left + TILE, size[0])):
                px, py = f4(x) + HALF, f4(y) + HALF
                light, count = ONE, 0
                for k in range(first[tile], first[tile + 1]):
                    n = entries[k]
                    dx, dy = px - records[n, X], py - records[n, Y]
                    e, f = records[n, L1] * dx + records[n, L2] * dy, records[n, L3] * dy
                    q = e * e + f * f + records[n, SHIFT]
                    if q > q_max:
                        continue
                    rest = ONE - min(most, math.exp(-EIGHT * q))
                    at, slope, deep = _depth(shapes, n, (px - view.cx) / view.fx, (py - view.cy) / view.fy, view)
                    _insert(ray, count, at, slope, rest, deep)
                    count += 1
                    light *= rest
                    if light <= DARK or count == MOST:
                        break
                depth[y, x], slant[y, x] = _crossing(ray, count, level)


@helper
def _insert(ray, count, at, slope, rest, deep):  # type: ignore[no-untyped-def]
    """Insert a Gaussian into those of a ray, sorted by depth."""
    k = count
    while k > 0 and ray[k - 1, 0] > at:
        for i in range(4):
            ray[k, i] = ray[k - 1, i]
        k -= 1
    ray[k, 0], ray[k, 1], ray[k, 2], ray[k, 3] = at, slope, rest, deep


@helper
def _crossing(ray, count, level):  # type: ignore[no-untyped-def]
    """Depth at which a Gaussian takes the light below `level`, and its slant."""
    light = ONE
    for k in range(count):
        if light * ray[k, 2] <= level:
            # On its way to the peak its alpha grows as exp(-d^2 / 2): where is it what is needed?
            needed, alpha = ONE - level / light, ONE - ray[k, 2]
            before = math.sqrt(max(TWO * math.log(alpha / max(needed, TINY)), ZERO))
            return ray[k, 0] - min(before, REACH) * ray[k, 3], ray[k, 1]
        light *= ray[k, 2]
    return f4(np.inf), ONE


@helper
def _depth(shapes, n, u, v, view):  # type: ignore[no-untyped-def]
    """Depth along the ray of the tangents (u, v) at which row n is densest, near its centre; the distance from its
    plane that a step of 1 in depth covers; and its standard deviation in depth along the ray."""
    ax = view.r00 * u + view.r10 * v + view.r20
    ay = view.r01 * u + view.r11 * v + view.r21
    az = view.r02 * u + view.r12 * v + view.r22
    cx, cy, cz = shapes[n, 0] - view.ex, shapes[n, 1] - view.ey, shapes[n, 2] - view.ez
    bx = shapes[n, 3] * ax + shapes[n, 4] * ay + shapes[n, 5] * az
    by = shapes[n, 4] * ax + shapes[n, 6] * ay + shapes[n, 7] * az
    bz = shapes[n, 5] * ax + shapes[n, 7] * ay + shapes[n, 8] * az
    middle = view.r20 * cx + view.r21 * cy + view.r22 * cz
    below = bx * ax + by * ay + bz * az
    peak = (bx * cx + by * cy + bz * cz) / below if below > ZERO else middle
    reach = REACH * shapes[n, 9]
    slope = math.sqrt(max(below, ZERO))
    return min(max(peak, middle - reach), middle + reach), slope, min(shapes[n, 10] / max(slope, TINY), shapes[n, 9])


def make_shapes(means: Array, quats: Array, scales: Array) -> Array:
    """What `draw` needs of `N` Gaussians, `[N, 11]` float32: centres; inverse covariances (xx, xy, xz, yy, yz, zz)
    times the square of the least standard deviation; the largest and the least standard deviation, world."""
    w, x, y, z = (quats[:, i].astype(np.float64) for i in range(4))
    axes = np.stack(
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
         2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
         2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1,
    ).reshape(-1, 3, 3)  # fmt: skip
    thin = scales.min(axis=1, keepdims=True).astype(np.float64)
    weight = (thin / scales) ** 2  # [N, 3], of the axes; at most 1
    inverse = np.einsum("nij,nj,nkj->nik", axes, weight, axes)
    six = [inverse[:, i, j] for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))]
    return np.column_stack([means, *six, scales.max(axis=1), thin]).astype(np.float32)

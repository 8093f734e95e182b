"""From Gaussians in the world to footprints in the image: one compiled pass over the rows of a cloud.

Knows the camera, the covariance algebra, the harmonics and which tiles an ellipse touches. Refuses to know order and
blending. Output is written at the row's own index, so nothing depends on which thread did the work.

A footprint's exponent is kept as a sum of squares (Cholesky factor of the inverse covariance), scaled by 1/16:
`q = (l1 dx + l2 dy)^2 + (l3 dy)^2 = d' inv(cov) d / 16`. It cannot go negative by rounding, costs as little as the
quadratic form, and each row of an ellipse is an interval in closed form:
`dx in slope * dy -+ sqrt(limit - (l3 dy)^2) / l1`. alpha falls below its minimum where q > limit.
Why 1/16: `blend.py` evaluates `exp(-8 q)` as the eighth power of a polynomial.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ...camera import Camera
from .. import convention
from .threads import fetch_add

Array = NDArray[Any]

TILE = 16  # px, side of a tile
RECORD = 16  # float32 in a footprint's record: one 64-byte cache line
# Places in a record. GROUP holds the bits of an int32.
X, Y, L1, L2, L3, OPACITY, RED, GREEN, BLUE, DEPTH, LIMIT, GROUP, REACH_Y, SLOPE, WIDTH, EXTREME = range(RECORD)
# REACH_Y: half height of the ellipse, px. SLOPE: see above. WIDTH: 1 / l1. EXTREME: dy at its rightmost point, px.

MASK_SIDE = 8  # footprints of at most 8x8 tiles keep the tiles they touch as bits of a uint64, row by row
CHUNK = 2048  # rows a worker takes at a time

# Places in the float32 vector that carries a camera and the convention into the kernel.
ROTATION, EYE, FX, FY, CX, CY, U_MIN, U_MAX, V_MIN, V_MAX, NEAR, FAR, DILATION, ALPHA_MIN, MAX_DET = (
    0, 9, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24,
)  # fmt: skip

# No "nnan", no "ninf": degenerate rows must compare as IEEE says, so every test is written to fail on NaN.
FAST = {"contract", "reassoc", "arcp", "nsz", "afn"}
KERNEL: dict[str, Any] = {"nogil": True, "cache": True, "fastmath": FAST, "error_model": "numpy", "boundscheck": False}

# Bare Python floats would promote float32 arithmetic to float64.
f4 = np.float32
ZERO, HALF, ONE, TWO, THREE, FOUR, EIGHTH, QUARTER = (f4(v) for v in (0, 0.5, 1, 2, 3, 4, 0.125, 0.25))
HUGE, TINY = f4(3e38), f4(1e-30)
SIDE = f4(TILE)
BIT = np.uint64(1)
# Normalisation of the real harmonics, in the order of `gaussians/harmonics.py`.
C0, C1 = f4(0.28209479177387814), f4(0.4886025119029199)
C20, C21, C22 = f4(1.0925484305920792), f4(0.31539156525252005), f4(0.5462742152960396)
C30, C31, C32, C33, C34 = (
    f4(v) for v in (0.5900435899266435, 2.890611442640554, 0.4570457994644658, 0.3731763325901154, 1.445305721320277)
)


def view_vector(camera: Camera, top: int = 0) -> Array:
    """The camera and the convention as the float32 vector the kernel reads; image rows count from `top`."""
    margin_x, margin_y = convention.EDGE * camera.width, convention.EDGE * camera.height
    tangents = [
        (-camera.cx - margin_x) / camera.fx, (camera.width - camera.cx + margin_x) / camera.fx,
        (-camera.cy - margin_y) / camera.fy, (camera.height - camera.cy + margin_y) / camera.fy,
    ]  # fmt: skip
    limits = [convention.NEAR, convention.FAR, convention.DILATION, convention.ALPHA_MIN, convention.MAX_DETERMINANT]
    pose = [*camera.world_to_camera[:3, :3].ravel(), *camera.position]
    return np.array([*pose, camera.fx, camera.fy, camera.cx, camera.cy - top, *tangents, *limits], dtype=np.float32)


@njit(**KERNEL)
def project(worker, workers, means, quats, scales, opacities, sh, group, view, size, out, counter):  # type: ignore[no-untyped-def]
    """Project every row; all of `out` is written at the row's index. `size` is (width, height).

    `out` is: records `[N, 16]` float32; corner `[N]` uint32, the first tile (x | y << 16); mask `[N]` uint64, the tiles
    touched counted from the corner, 0 if they are too many; depth `[N]` int32, bits of the positive float; visible
    `[N]` int32, the rows seen, packed to the front of each chunk; found `[chunks]` int32, how many.
    `group` is `[N]` int32, `counter` `[1]` int64 holding 0.
    """
    records, corner, mask, depth, visible, found = out
    bits = records.view(np.int32)
    rows = means.shape[0]
    while True:
        chunk = fetch_add(counter, 1)
        start = chunk * CHUNK
        if start >= rows:
            break
        fill = start
        for n in range(start, min(start + CHUNK, rows)):
            z, reach_x = _footprint(n, means, quats, scales, opacities, view, size, records)
            if not z > ZERO:
                continue
            if not _touched_tiles(records, n, reach_x, size, corner, mask):
                continue
            if not _shade(n, means, sh, view, records):
                continue
            records[n, DEPTH] = z
            bits[n, GROUP] = group[n]
            depth[n] = bits[n, DEPTH]
            visible[fill] = n
            fill += 1
        found[chunk] = fill - start


@njit(**KERNEL)
def _footprint(n, means, quats, scales, opacities, view, size, records):  # type: ignore[no-untyped-def]
    """Write the geometry of row `n`; returns its depth (0 if it cannot be seen) and half its width, px."""
    dx, dy, dz = means[n, 0] - view[EYE], means[n, 1] - view[EYE + 1], means[n, 2] - view[EYE + 2]
    z = view[6] * dx + view[7] * dy + view[8] * dz
    opacity = min(opacities[n], ONE)
    if not (z > view[NEAR] and z < view[FAR] and opacities[n] > view[ALPHA_MIN] and opacities[n] < HUGE):
        return ZERO, ZERO
    inverse = ONE / z
    u = (view[0] * dx + view[1] * dy + view[2] * dz) * inverse
    v = (view[3] * dx + view[4] * dy + view[5] * dz) * inverse
    xx, xy, yy, det = _covariance(n, quats, scales, view, inverse, u, v)
    if not det < view[MAX_DET]:
        return ZERO, ZERO
    limit = math.log(opacity / view[ALPHA_MIN]) * EIGHTH  # of q: alpha = opacity * exp(-8 q) >= ALPHA_MIN
    x, y = view[FX] * u + view[CX], view[FY] * v + view[CY]
    stretch = math.sqrt(f4(16) * limit)
    reach_x, reach_y = stretch * math.sqrt(xx), stretch * math.sqrt(yy)
    if not (x + reach_x > ZERO and x - reach_x < size[0] and y + reach_y > ZERO and y - reach_y < size[1]):
        return ZERO, ZERO
    l1 = math.sqrt(yy / det) * QUARTER
    slope = xy / yy
    records[n, X], records[n, Y] = x, y
    records[n, L1], records[n, L2], records[n, L3] = l1, -slope * l1, QUARTER / math.sqrt(yy)
    records[n, OPACITY], records[n, LIMIT] = opacity, limit
    records[n, REACH_Y], records[n, SLOPE], records[n, WIDTH] = reach_y, slope, ONE / l1
    records[n, EXTREME] = xy / xx * reach_x
    return z, reach_x


@njit(**KERNEL)
def _covariance(n, quats, scales, view, inverse, u, v):  # type: ignore[no-untyped-def]
    """2-D covariance (xx, xy, yy) with dilation, px^2, and its determinant summed from squares (Cauchy-Binet):
    `xx * yy - xy * xy` would lose every digit of a long thin footprint."""
    u = min(max(u, view[U_MIN]), view[U_MAX])
    v = min(max(v, view[V_MIN]), view[V_MAX])
    j0, j2 = view[FX] * inverse, -view[FX] * inverse * u
    k1, k2 = view[FY] * inverse, -view[FY] * inverse * v
    m0, m1, m2 = j0 * view[0] + j2 * view[6], j0 * view[1] + j2 * view[7], j0 * view[2] + j2 * view[8]
    n0, n1, n2 = k1 * view[3] + k2 * view[6], k1 * view[4] + k2 * view[7], k1 * view[5] + k2 * view[8]
    w, x, y, z = quats[n, 0], quats[n, 1], quats[n, 2], quats[n, 3]
    norm = w * w + x * x + y * y + z * z
    if norm > HUGE:
        return ZERO, ZERO, ZERO, HUGE
    if norm <= TINY:
        w, norm = ONE, ONE  # no direction at all: the identity, as in `rotations.normalize`
    s = TWO / norm
    s0, s1, s2 = scales[n, 0], scales[n, 1], scales[n, 2]
    a00, a10, a20 = ONE - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)
    a01, a11, a21 = s * (x * y - w * z), ONE - s * (x * x + z * z), s * (y * z + w * x)
    a02, a12, a22 = s * (x * z + w * y), s * (y * z - w * x), ONE - s * (x * x + y * y)
    p0, q0 = (m0 * a00 + m1 * a10 + m2 * a20) * s0, (n0 * a00 + n1 * a10 + n2 * a20) * s0
    p1, q1 = (m0 * a01 + m1 * a11 + m2 * a21) * s1, (n0 * a01 + n1 * a11 + n2 * a21) * s1
    p2, q2 = (m0 * a02 + m1 * a12 + m2 * a22) * s2, (n0 * a02 + n1 * a12 + n2 * a22) * s2
    xx, xy, yy = p0 * p0 + p1 * p1 + p2 * p2, p0 * q0 + p1 * q1 + p2 * q2, q0 * q0 + q1 * q1 + q2 * q2
    c0, c1, c2 = p0 * q1 - p1 * q0, p0 * q2 - p2 * q0, p1 * q2 - p2 * q1
    dilation = view[DILATION]
    det = c0 * c0 + c1 * c1 + c2 * c2 + dilation * (xx + yy) + dilation * dilation
    return xx + dilation, xy, yy + dilation, det


@njit(**KERNEL)
def span(records, n, low, high):  # type: ignore[no-untyped-def]
    """Interval of x (px) that the ellipse of record `n` covers over pixel-centre rows `low` to `high`; empty: 1, 0."""
    reach = records[n, REACH_Y]
    d0, d1 = max(low - records[n, Y], -reach), min(high - records[n, Y], reach)
    if not d0 <= d1:
        return ONE, ZERO
    extreme, l3 = records[n, EXTREME], records[n, L3]
    at = min(max(extreme, d0), d1)  # the row of the band where the ellipse reaches furthest right
    root = math.sqrt(max(records[n, LIMIT] - (l3 * at) * (l3 * at), ZERO))
    right = records[n, SLOPE] * at + root * records[n, WIDTH]
    at = min(max(-extreme, d0), d1)
    root = math.sqrt(max(records[n, LIMIT] - (l3 * at) * (l3 * at), ZERO))
    left = records[n, SLOPE] * at - root * records[n, WIDTH]
    return records[n, X] + left, records[n, X] + right


@njit(**KERNEL)
def tile_rows(records, n, size):  # type: ignore[no-untyped-def]
    """First and one past the last row of tiles that the box of record `n` touches, within the image."""
    y, reach = records[n, Y], records[n, REACH_Y]
    first = int(max(y - reach, ZERO) / SIDE)
    last = int(min(y + reach, f4(size[1]) - HALF) / SIDE)
    return first, last + 1


@njit(**KERNEL)
def tile_span(records, n, row, size):  # type: ignore[no-untyped-def]
    """First and one past the last tile of a row of tiles that the ellipse of record `n` touches; empty: first >= last."""
    low, high = span(records, n, f4(row * TILE) + HALF, f4(row * TILE + TILE) - HALF)
    if not (low <= high and high >= HALF and low <= f4(size[0]) - HALF):
        return 0, 0
    # A tile's pixel centres start half a pixel inside it.
    first = int(max(math.ceil((low + HALF) / SIDE) - ONE, ZERO))
    last = int(min(high - HALF, f4(size[0]) - ONE) / SIDE)
    return first, last + 1


@njit(**KERNEL)
def _touched_tiles(records, n, reach_x, size, corner, mask):  # type: ignore[no-untyped-def]
    """Write the tiles that record `n` touches; returns whether there are any."""
    top, bottom = tile_rows(records, n, size)
    x = records[n, X]
    left = int(max(x - reach_x, ZERO) / SIDE)
    right = int(min(x + reach_x, f4(size[0]) - HALF) / SIDE) + 1
    corner[n] = np.uint32(left) | (np.uint32(top) << np.uint32(16))
    if (right - left) * (bottom - top) == 1:
        mask[n] = BIT
        return True
    mask[n] = np.uint64(0)
    if right - left > MASK_SIDE or bottom - top > MASK_SIDE:
        return True
    touched = np.uint64(0)
    for row in range(top, bottom):
        first, last = tile_span(records, n, row, size)
        first, last = max(first, left), min(last, left + MASK_SIDE)
        if first < last:
            run = (BIT << np.uint64(last - first)) - BIT
            touched |= run << np.uint64((row - top) * MASK_SIDE + first - left)
    mask[n] = touched
    return touched != np.uint64(0)


@njit(**KERNEL)
def _shade(n, means, sh, view, records):  # type: ignore[no-untyped-def]
    """Write the colour of row `n` seen from the eye, `max(0, 0.5 + harmonics)`; returns whether it is finite."""
    x, y, z = means[n, 0] - view[EYE], means[n, 1] - view[EYE + 1], means[n, 2] - view[EYE + 2]
    inverse = ONE / math.sqrt(x * x + y * y + z * z)
    x, y, z = x * inverse, y * inverse, z * inverse
    finite = True
    for channel in range(3):
        value = HALF + C0 * sh[n, 0, channel]
        if sh.shape[1] > 1:
            value += C1 * (z * sh[n, 2, channel] - y * sh[n, 1, channel] - x * sh[n, 3, channel])
        if sh.shape[1] > 4:
            value += _band_2(n, channel, sh, x, y, z)
        if sh.shape[1] > 9:
            value += _band_3(n, channel, sh, x, y, z)
        finite = finite and abs(value) < HUGE
        records[n, RED + channel] = max(value, ZERO)
    return finite


@njit(**KERNEL)
def _band_2(n, channel, sh, x, y, z):  # type: ignore[no-untyped-def]
    return (
        C20 * (x * y * sh[n, 4, channel] - y * z * sh[n, 5, channel] - x * z * sh[n, 7, channel])
        + C21 * (TWO * z * z - x * x - y * y) * sh[n, 6, channel]
        + C22 * (x * x - y * y) * sh[n, 8, channel]
    )


@njit(**KERNEL)
def _band_3(n, channel, sh, x, y, z):  # type: ignore[no-untyped-def]
    xx, yy, zz = x * x, y * y, z * z
    return (
        -C30 * (y * (THREE * xx - yy) * sh[n, 9, channel] + x * (xx - THREE * yy) * sh[n, 15, channel])
        + C31 * x * y * z * sh[n, 10, channel]
        - C32 * (FOUR * zz - xx - yy) * (y * sh[n, 11, channel] + x * sh[n, 13, channel])
        + C33 * z * (TWO * zz - THREE * xx - THREE * yy) * sh[n, 12, channel]
        + C34 * z * (xx - yy) * sh[n, 14, channel]
    )

"""Project Gaussians to image footprints (EWA splatting): one compiled pass over the rows of a cloud.

Output is written at the row's own index, so the result does not depend on which thread processed a row.

A footprint's exponent is stored as a sum of squares (Cholesky factor of the inverse covariance), scaled by 1/16:
`q = (l1 dx + l2 dy)^2 + (l3 dy)^2 = d' inv(cov) d / 16`. It cannot go negative by rounding, costs as little as the
quadratic form, and each row of an ellipse is an interval in closed form:
`dx in slope * dy -+ sqrt(limit - (l3 dy)^2) / l1`, where limit is the q at which alpha falls to its minimum.
Opacity is folded into the exponent: `alpha = exp(-8 (q + shift))`, so the cut-off at alpha's minimum is one constant,
`Q_MAX`.
Why 1/16: `simd.py` evaluates `exp(-8 q)` as the eighth power of a polynomial.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...camera import Camera
from ...compiled import fetch_add, helper, kernel
from .. import convention
from .shade import shade

Array = NDArray[Any]

TILE = 16  # px, side of a tile
RECORD = 16  # float32 in a footprint's record: one 64-byte cache line
# Places in a record. GROUP holds the bits of an int32.
X, Y, L1, L2, L3, SHIFT, LIMIT, REACH_Y, SLOPE, WIDTH, EXTREME, RED, GREEN, BLUE, DEPTH, GROUP = range(RECORD)
MASK_SIDE = 8  # footprints of at most 8x8 tiles keep the tiles they touch as bits of a uint64, row by row
SMALL = 6  # bounding boxes of at most this many tiles are not tested tile by tile
CHUNK = 2048  # rows a worker takes at a time

Q_MAX = math.log(1 / convention.ALPHA_MIN) / 8  # exp(-8 Q_MAX) is the least alpha

# Bare Python floats would promote float32 arithmetic to float64.
f4 = np.float32
ZERO, HALF, ONE, TWO, FOUR, SIXTEEN = (f4(v) for v in (0, 0.5, 1, 2, 4, 16))
QUARTER, EIGHTH, PER_TILE = f4(0.25), f4(0.125), f4(1 / TILE)
HUGE, TINY = f4(3e38), f4(1e-30)
SLACK = f4(1.01)  # safety factor, larger than any rounding error
BIT, EACH_ROW = np.uint64(1), np.uint64(0x0101010101010101)  # of a mask: its first tile, the first of each row
CORNER_Y = np.uint64(16)  # where a corner's row begins; its column is below
KEY = np.uint64(32)  # where the bits of the depth begin; the row is below


class View(NamedTuple):
    """A camera and the convention, all float32: rotation rows r, eye e, tangents clamped to u0..u1 and v0..v1."""

    r00: Any
    r01: Any
    r02: Any
    r10: Any
    r11: Any
    r12: Any
    r20: Any
    r21: Any
    r22: Any
    ex: Any
    ey: Any
    ez: Any
    fx: Any
    fy: Any
    cx: Any
    cy: Any
    width: Any
    height: Any
    u0: Any
    u1: Any
    v0: Any
    v1: Any
    near: Any
    far: Any
    dilation: Any
    alpha_min: Any
    q_max: Any
    max_determinant: Any


class Ellipse(NamedTuple):
    """Where a footprint reaches alpha's minimum, px: centre, half height, and the fields that the module names.

    `width` is 1 / l1; `extreme` is dy at the rightmost point.
    """

    x: Any
    y: Any
    l3: Any
    limit: Any
    reach_y: Any
    slope: Any
    width: Any
    extreme: Any


def make_view(camera: Camera, near: float, top: int, bottom: int) -> View:
    """The kernel's view of a camera with a near plane for the image rows `top` to `bottom`."""
    margin_x, margin_y = convention.EDGE * camera.width, convention.EDGE * camera.height
    numbers = [
        *camera.world_to_camera[:3, :3].ravel(), *camera.position,
        camera.fx, camera.fy, camera.cx, camera.cy - top, camera.width, bottom - top,
        (-camera.cx - margin_x) / camera.fx, (camera.width - camera.cx + margin_x) / camera.fx,
        (-camera.cy - margin_y) / camera.fy, (camera.height - camera.cy + margin_y) / camera.fy,
        near, convention.FAR, convention.DILATION, convention.ALPHA_MIN, Q_MAX, convention.MAX_DETERMINANT,
    ]  # fmt: skip
    return View(*(np.float32(number) for number in numbers))


def make_records(count: int) -> Array:
    """Allocate records `[count, 16]` float32, each on one cache line: numpy aligns large arrays to 16 bytes."""
    line = RECORD * np.dtype(np.float32).itemsize
    room = np.empty(count * RECORD + RECORD, np.float32)
    start = -room.ctypes.data % line // room.itemsize
    return room[start : start + count * RECORD].reshape(count, RECORD)


@kernel
def project(worker, workers, means, quats, scales, opacities, sh, group, view, out, counter):  # type: ignore[no-untyped-def]
    """Project every row; the records and spots of visible rows are written at the row's index.

    `out` is: records `[N, 16]` float32; spots `[N, 2]` uint64, the tiles touched as a mask from the corner on (0 if
    they are too many) and the corner, the first tile (x | y << 16); visible `[N]` uint64, the visible rows below
    the bits of their depths (a positive float), packed to the front of each chunk; found `[chunks]` int32, how many.
    `group` is `[N]` int32, `counter` `[1]` int64 holding 0.
    """
    records, spots, visible, found = out
    bits = records.view(np.int32)
    rows = means.shape[0]
    while True:
        chunk = fetch_add(counter, 1)
        start = chunk * CHUNK
        if start >= rows:
            break
        fill = start
        for n in range(start, min(start + CHUNK, rows)):
            dx, dy, dz = means[n, 0] - view.ex, means[n, 1] - view.ey, means[n, 2] - view.ez
            z = view.r20 * dx + view.r21 * dy + view.r22 * dz
            if not (z > view.near and z < view.far and opacities[n] > view.alpha_min and opacities[n] < HUGE):
                continue
            scale = (scales[n, 0], scales[n, 1], scales[n, 2])
            inverse = ONE / z
            u = (view.r00 * dx + view.r01 * dy + view.r02 * dz) * inverse
            v = (view.r10 * dx + view.r11 * dy + view.r12 * dz) * inverse
            if _outside_image(u, v, inverse, scale, view):
                continue
            quat = (quats[n, 0], quats[n, 1], quats[n, 2], quats[n, 3])
            opacity = min(opacities[n], ONE)
            ellipse, reach_x, seen = _footprint(u, v, inverse, quat, scale, opacity, view)
            if not seen:
                continue
            left, top, touched, some = _tiles(ellipse, reach_x, view)
            if not some:
                continue
            if not shade(n, sh, dx, dy, dz, records[n, RED : BLUE + 1]):
                continue
            _record(records, n, ellipse, view.q_max, z)
            bits[n, GROUP] = group[n]
            spots[n, 0] = touched
            spots[n, 1] = np.uint64(left) | (np.uint64(top) << CORNER_Y)
            visible[fill] = (np.uint64(bits[n, DEPTH]) << KEY) | np.uint64(n)
            fill += 1
        found[chunk] = fill - start


@helper
def _outside_image(u, v, inverse, scale, view):  # type: ignore[no-untyped-def]
    """Whether a Gaussian at the tangents (u, v) misses the image even as an opaque ball of its largest scale.

    This culls most invisible Gaussians of an indoor scene at a tenth of the cost of a footprint. NaN gives False.
    """
    x, y = view.fx * u + view.cx, view.fy * v + view.cy
    cu, cv = min(max(u, view.u0), view.u1), min(max(v, view.v0), view.v1)
    largest = max(max(abs(scale[0]), abs(scale[1])), abs(scale[2])) * inverse
    j, k = view.fx * largest, view.fy * largest
    stretch = SLACK * SIXTEEN * view.q_max  # squared Mahalanobis distance at which an opaque footprint ends
    reach_x = stretch * (j * j * (ONE + cu * cu) + view.dilation)
    reach_y = stretch * (k * k * (ONE + cv * cv) + view.dilation)
    aside, above = max(-x, x - view.width), max(-y, y - view.height)
    return (aside > ZERO and aside * aside > reach_x) or (above > ZERO and above * above > reach_y)


@helper
def _footprint(u, v, inverse, quat, scale, opacity, view):  # type: ignore[no-untyped-def]
    """Ellipse of a Gaussian at the tangents (u, v), half its width (px), and whether it can be visible."""
    xx, xy, yy, determinant = _covariance(quat, scale, inverse, u, v, view)
    limit = math.log(opacity / view.alpha_min) * EIGHTH  # of q: alpha = opacity * exp(-8 q) >= alpha_min
    x, y = view.fx * u + view.cx, view.fy * v + view.cy
    stretch = math.sqrt(SIXTEEN * limit)
    reach_x, reach_y = stretch * math.sqrt(xx), stretch * math.sqrt(yy)
    inside = x + reach_x > ZERO and x - reach_x < view.width and y + reach_y > ZERO and y - reach_y < view.height
    width = FOUR * math.sqrt(determinant / yy)
    ellipse = Ellipse(x, y, QUARTER / math.sqrt(yy), limit, reach_y, xy / yy, width, xy / xx * reach_x)
    return ellipse, reach_x, inside and determinant < view.max_determinant


@helper
def _covariance(quat, scale, inverse, u, v, view):  # type: ignore[no-untyped-def]
    """2-D covariance (xx, xy, yy) with dilation, px^2, and its determinant summed from squares (Cauchy-Binet):
    `xx * yy - xy * xy` would lose every digit of a long thin footprint. `inverse` is 1 / depth."""
    u = min(max(u, view.u0), view.u1)
    v = min(max(v, view.v0), view.v1)
    j, k = view.fx * inverse, view.fy * inverse
    m0, m1, m2 = j * (view.r00 - u * view.r20), j * (view.r01 - u * view.r21), j * (view.r02 - u * view.r22)
    n0, n1, n2 = k * (view.r10 - v * view.r20), k * (view.r11 - v * view.r21), k * (view.r12 - v * view.r22)
    w, x, y, z = quat
    norm = w * w + x * x + y * y + z * z
    zero = norm <= TINY  # a zero quaternion counts as the identity, as in `rotations.normalize`
    s = ZERO if zero else TWO / norm
    a00, a10, a20 = ONE - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)
    a01, a11, a21 = s * (x * y - w * z), ONE - s * (x * x + z * z), s * (y * z + w * x)
    a02, a12, a22 = s * (x * z + w * y), s * (y * z - w * x), ONE - s * (x * x + y * y)
    p0, q0 = (m0 * a00 + m1 * a10 + m2 * a20) * scale[0], (n0 * a00 + n1 * a10 + n2 * a20) * scale[0]
    p1, q1 = (m0 * a01 + m1 * a11 + m2 * a21) * scale[1], (n0 * a01 + n1 * a11 + n2 * a21) * scale[1]
    p2, q2 = (m0 * a02 + m1 * a12 + m2 * a22) * scale[2], (n0 * a02 + n1 * a12 + n2 * a22) * scale[2]
    xx, xy, yy = p0 * p0 + p1 * p1 + p2 * p2, p0 * q0 + p1 * q1 + p2 * q2, q0 * q0 + q1 * q1 + q2 * q2
    c0, c1, c2 = p0 * q1 - p1 * q0, p0 * q2 - p2 * q0, p1 * q2 - p2 * q1
    dilation = view.dilation
    determinant = c0 * c0 + c1 * c1 + c2 * c2 + dilation * (xx + yy) + dilation * dilation
    return xx + dilation, xy, yy + dilation, determinant


@helper
def span(e, low, high):  # type: ignore[no-untyped-def]
    """Interval of x (px) that ellipse `e` covers over the pixel-centre rows `low` to `high`; empty: first > second."""
    d0, d1 = max(low - e.y, -e.reach_y), min(high - e.y, e.reach_y)
    at = min(max(e.extreme, d0), d1)  # the row of the band where the ellipse reaches furthest right
    right = e.slope * at + math.sqrt(max(e.limit - (e.l3 * at) * (e.l3 * at), ZERO)) * e.width
    at = min(max(-e.extreme, d0), d1)
    left = e.slope * at - math.sqrt(max(e.limit - (e.l3 * at) * (e.l3 * at), ZERO)) * e.width
    empty = not d0 <= d1
    return HUGE if empty else e.x + left, -HUGE if empty else e.x + right


@helper
def tile_rows(e, height):  # type: ignore[no-untyped-def]
    """First and one past the last row of tiles that the box of ellipse `e` touches, in an image of `height` px."""
    first = int(max(e.y - e.reach_y, ZERO) * PER_TILE)
    return first, int(min(e.y + e.reach_y, height - HALF) * PER_TILE) + 1


@helper
def tile_span(e, row, width):  # type: ignore[no-untyped-def]
    """First and one past the last tile of a row of tiles that ellipse `e` touches; empty: first >= second.

    Tile t touches [low, high] if `low <= 16 t + 15.5` and `high >= 16 t + 0.5`: its outermost pixel centres.
    """
    low, high = span(e, f4(row * TILE) + HALF, f4(row * TILE + TILE) - HALF)
    low, high = min(max(low, HALF), width), max(min(high, width - HALF), -ONE)  # within what an integer can hold
    return math.ceil((low + HALF) * PER_TILE) - 1, math.floor((high - HALF) * PER_TILE) + 1


@helper
def _tiles(e, reach_x, view):  # type: ignore[no-untyped-def]
    """First column and row of the tiles that ellipse `e` touches, the mask of tiles from there (0: too many for a
    mask), and whether there are any. A bounding box of at most `SMALL` tiles is taken whole: testing its tiles costs
    more than it saves."""
    top, bottom = tile_rows(e, view.height)
    left = int(max(e.x - reach_x, ZERO) * PER_TILE)
    right = int(min(e.x + reach_x, view.width - HALF) * PER_TILE) + 1
    wide, high = right - left, bottom - top
    mask = np.uint64(0)
    if wide * high <= SMALL:
        mask = ((BIT << np.uint64(wide)) - BIT) * (EACH_ROW & ((BIT << np.uint64(high * MASK_SIDE)) - BIT))
    elif wide <= MASK_SIDE and high <= MASK_SIDE:
        for row in range(top, bottom):
            first, last = tile_span(e, row, view.width)
            first, last = max(first, left), min(last, right)
            run = (BIT << np.uint64(max(last - first, 0))) - BIT
            mask |= run << np.uint64((row - top) * MASK_SIDE + max(first - left, 0))
    return left, top, mask, mask != np.uint64(0) or wide > MASK_SIDE or high > MASK_SIDE


@helper
def _record(records, n, e, q_max, z):  # type: ignore[no-untyped-def]
    """Write the geometry of row `n`, whose ellipse is `e` and whose depth is `z`."""
    l1 = ONE / e.width
    records[n, X], records[n, Y], records[n, DEPTH] = e.x, e.y, z
    records[n, L1], records[n, L2], records[n, L3] = l1, -e.slope * l1, e.l3
    records[n, SHIFT], records[n, LIMIT] = q_max - e.limit, e.limit
    records[n, REACH_Y], records[n, SLOPE], records[n, WIDTH], records[n, EXTREME] = (
        e.reach_y,
        e.slope,
        e.width,
        e.extreme,
    )

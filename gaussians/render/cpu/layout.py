"""What the stages of the renderer hand on to each other: cameras as numbers, footprints as records, tiles as masks.

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
from ...compiled import helper
from .. import convention

Array = NDArray[Any]

TILE = 16  # px, side of a tile
RECORD = 16  # float32 in a footprint's record: one 64-byte cache line
# Places in a record. GROUP holds the bits of an int32.
X, Y, L1, L2, L3, SHIFT, LIMIT, REACH_Y, SLOPE, WIDTH, EXTREME, RED, GREEN, BLUE, DEPTH, GROUP = range(RECORD)
MASK_SIDE = 8  # footprints of at most 8x8 tiles keep the tiles they touch as bits of a uint64, row by row

Q_MAX = math.log(1 / convention.ALPHA_MIN) / 8  # exp(-8 Q_MAX) is the least alpha

# Bare Python floats would promote float32 arithmetic to float64.
f4 = np.float32
ZERO, HALF, ONE, TWO, FOUR, SIXTEEN = (f4(v) for v in (0, 0.5, 1, 2, 4, 16))
PER_TILE = f4(1 / TILE)
HUGE, TINY = f4(3e38), f4(1e-30)
BIT = np.uint64(1)  # of a mask: its first tile
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

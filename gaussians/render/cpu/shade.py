"""Evaluate a Gaussian's colour in a view direction: `max(0, 0.5 + SH)`, real spherical harmonics up to degree 3."""

from __future__ import annotations

import math

import numpy as np

from ...compiled import helper

f4 = np.float32
ZERO, HALF, ONE, TWO, THREE, FOUR = (f4(v) for v in (0, 0.5, 1, 2, 3, 4))
HUGE = f4(3e38)
# Normalisation of the real harmonics, in the order of `gaussians/harmonics.py`.
C0, C1 = f4(0.28209479177387814), f4(0.4886025119029199)
C20, C21, C22 = f4(1.0925484305920792), f4(0.31539156525252005), f4(0.5462742152960396)
C30, C31, C32, C33, C34 = (
    f4(v) for v in (0.5900435899266435, 2.890611442640554, 0.4570457994644658, 0.3731763325901154, 1.445305721320277)
)


@helper
def shade(n, sh, x, y, z, record):  # type: ignore[no-untyped-def]
    """Write the colour of row `n` in view direction (x, y, z), any length, to `record` `[3]`; returns whether it is
    finite."""
    inverse = ONE / math.sqrt(x * x + y * y + z * z)
    x, y, z = x * inverse, y * inverse, z * inverse
    finite = True
    for channel in range(3):
        value = HALF + _harmonics(n, channel, sh, x, y, z)
        finite = finite and abs(value) < HUGE
        record[channel] = max(value, ZERO)
    return finite


@helper
def _harmonics(n, c, sh, x, y, z):  # type: ignore[no-untyped-def]
    """Channel `c` of the harmonics of row `n` in the unit direction (x, y, z)."""
    value = C0 * sh[n, 0, c]
    if sh.shape[1] > 1:
        value += C1 * (z * sh[n, 2, c] - y * sh[n, 1, c] - x * sh[n, 3, c])
    if sh.shape[1] > 4:
        value += C20 * (x * y * sh[n, 4, c] - y * z * sh[n, 5, c] - x * z * sh[n, 7, c])
        value += C21 * (TWO * z * z - x * x - y * y) * sh[n, 6, c] + C22 * (x * x - y * y) * sh[n, 8, c]
    if sh.shape[1] > 9:
        xx, yy, zz = x * x, y * y, z * z
        value += C31 * x * y * z * sh[n, 10, c] + C33 * z * (TWO * zz - THREE * xx - THREE * yy) * sh[n, 12, c]
        value -= C30 * (y * (THREE * xx - yy) * sh[n, 9, c] + x * (xx - THREE * yy) * sh[n, 15, c])
        value -= C32 * (FOUR * zz - xx - yy) * (y * sh[n, 11, c] + x * sh[n, 13, c])
        value += C34 * z * (xx - yy) * sh[n, 14, c]
    return value

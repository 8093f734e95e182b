"""Backward pass of `project`: from the gradient of footprints to that of Gaussians, one compiled pass over the rows.

Intermediate values of the forward pass beyond a footprint's record are recomputed: storing them would cost more memory
traffic than it saves. Names as in `project`: u, v are tangents, m and o the rows of the Jacobian in the world, p and q
the principal axes projected on x and on y.
"""

from __future__ import annotations

import math

from ...compiled import fetch_add, helper, kernel
from .blend_backward import D_L1, D_L2, D_L3, D_RED, D_SHIFT, D_X, D_Y
from .layout import FOUR, HALF, L1, L3, ONE, RED, SIXTEEN, SLOPE, TINY, TWO, ZERO, f4
from .shade import C0, C1, C20, C21, C22, C30, C31, C32, C33, C34, THREE

ROWS = 2048  # rows a worker takes at a time
SIX, EIGHT = f4(6), f4(8)


@kernel
def project_backward(worker, workers, columns, view, records, footprints, out, counter):  # type: ignore[no-untyped-def]
    """Add the chain rule's result to `out`: gradients of means, quats, scales, opacities, harmonics and centres.

    `columns` are the first five of these, `footprints` `[N, GRADIENT]` the gradients of the footprints, zero for rows
    without one. Rows are visited in memory order: in depth order, most of the time was spent waiting for memory.
    """
    means, quats, scales, opacities, sh = columns
    d_means, d_quats, d_scales, d_opacities, d_sh, d_centers = out
    while True:
        start = fetch_add(counter, 1) * ROWS
        if start >= means.shape[0]:
            break
        for n in range(start, min(start + ROWS, means.shape[0])):
            if not _has_gradient(n, footprints):
                continue  # many footprints are occluded in all their pixels
            toward = (means[n, 0] - view.ex, means[n, 1] - view.ey, means[n, 2] - view.ez)
            by_shape = _footprint_backward(n, toward, quats, scales, view, records, footprints, d_quats, d_scales)
            by_color = _shade_backward(n, toward, sh, records, footprints, d_sh)
            for axis in range(3):
                d_means[n, axis] += by_shape[axis] + by_color[axis]
            d_centers[n, 0] += footprints[n, D_X]
            d_centers[n, 1] += footprints[n, D_Y]
            if opacities[n] < ONE:
                d_opacities[n] -= footprints[n, D_SHIFT] / (EIGHT * opacities[n])


@helper
def _has_gradient(n, footprints):  # type: ignore[no-untyped-def]
    """Whether any field of row `n`'s footprint has a non-zero gradient."""
    largest = ZERO
    for place in range(footprints.shape[1]):
        largest = max(largest, abs(footprints[n, place]))
    return largest > ZERO


@helper
def _footprint_backward(n, toward, quats, scales, view, records, footprints, d_quats, d_scales):  # type: ignore[no-untyped-def]
    """Gradient of the offset from the eye through centre and covariance; adds to those of quats and scales."""
    dx, dy, dz = toward
    x = view.r00 * dx + view.r01 * dy + view.r02 * dz
    y = view.r10 * dx + view.r11 * dy + view.r12 * dz
    inverse = ONE / (view.r20 * dx + view.r21 * dy + view.r22 * dz)
    u, v = x * inverse, y * inverse
    cu, cv = min(max(u, view.u0), view.u1), min(max(v, view.v0), view.v1)
    j, k = view.fx * inverse, view.fy * inverse
    m = (j * (view.r00 - cu * view.r20), j * (view.r01 - cu * view.r21), j * (view.r02 - cu * view.r22))
    o = (k * (view.r10 - cv * view.r20), k * (view.r11 - cv * view.r21), k * (view.r12 - cv * view.r22))
    axes, two_over_norm = _axes(n, quats)
    s0, s1, s2 = scales[n, 0], scales[n, 1], scales[n, 2]
    mp = (_dot(m, axes[0]), _dot(m, axes[1]), _dot(m, axes[2]))
    oq = (_dot(o, axes[0]), _dot(o, axes[1]), _dot(o, axes[2]))
    p, q = (mp[0] * s0, mp[1] * s1, mp[2] * s2), (oq[0] * s0, oq[1] * s1, oq[2] * s2)
    dp, dq = _conic_backward(n, p, q, view.dilation, records, footprints)
    d_scales[n, 0] += dp[0] * mp[0] + dq[0] * oq[0]
    d_scales[n, 1] += dp[1] * mp[1] + dq[1] * oq[1]
    d_scales[n, 2] += dp[2] * mp[2] + dq[2] * oq[2]
    dp, dq = (dp[0] * s0, dp[1] * s1, dp[2] * s2), (dq[0] * s0, dq[1] * s1, dq[2] * s2)
    _rotation_backward(n, quats, two_over_norm, m, o, dp, dq, d_quats)
    dm = _combine(axes, dp)
    do = _combine(axes, dq)
    r2 = (view.r20, view.r21, view.r22)
    d_inverse = view.fx * _dot(dm, (view.r00 - cu * r2[0], view.r01 - cu * r2[1], view.r02 - cu * r2[2]))
    d_inverse += view.fy * _dot(do, (view.r10 - cv * r2[0], view.r11 - cv * r2[1], view.r12 - cv * r2[2]))
    du, dv = view.fx * footprints[n, D_X], view.fy * footprints[n, D_Y]
    if view.u0 < u < view.u1:
        du -= j * _dot(dm, r2)
    if view.v0 < v < view.v1:
        dv -= k * _dot(do, r2)
    d_inverse += du * x + dv * y
    gx, gy, gz = du * inverse, dv * inverse, -inverse * inverse * d_inverse
    return (
        view.r00 * gx + view.r10 * gy + view.r20 * gz,
        view.r01 * gx + view.r11 * gy + view.r21 * gz,
        view.r02 * gx + view.r12 * gy + view.r22 * gz,
    )


@helper
def _dot(a, b):  # type: ignore[no-untyped-def]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@helper
def _combine(axes, amounts):  # type: ignore[no-untyped-def]
    """Linear combination of three axes."""
    a, b, c = axes
    return (
        amounts[0] * a[0] + amounts[1] * b[0] + amounts[2] * c[0],
        amounts[0] * a[1] + amounts[1] * b[1] + amounts[2] * c[1],
        amounts[0] * a[2] + amounts[1] * b[2] + amounts[2] * c[2],
    )


@helper
def _axes(n, quats):  # type: ignore[no-untyped-def]
    """The three axes of row `n` (columns of its rotation), and 2 / |quat|^2, 0 for a zero quaternion."""
    w, x, y, z = quats[n, 0], quats[n, 1], quats[n, 2], quats[n, 3]
    norm = w * w + x * x + y * y + z * z
    s = ZERO if norm <= TINY else TWO / norm
    axes = (
        (ONE - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)),
        (s * (x * y - w * z), ONE - s * (x * x + z * z), s * (y * z + w * x)),
        (s * (x * z + w * y), s * (y * z - w * x), ONE - s * (x * x + y * y)),
    )
    return axes, s


@helper
def _conic_backward(n, p, q, dilation, records, footprints):  # type: ignore[no-untyped-def]
    """Gradient of the axes projected on x (`p`) and y (`q`) from that of the exponent's fields.

    `l3 = 1 / (4 sqrt(yy))`, `l1 = sqrt(yy / det) / 4`, `l2 = -xy / yy l1`, so the record holds everything but the
    minors, whose squares sum to det as in the forward pass.
    """
    l1, l3, slope = records[n, L1], records[n, L3], records[n, SLOPE]
    per_yy = SIXTEEN * l3 * l3
    per_det = per_yy * (SIXTEEN * l1 * l1)
    c0, c1, c2 = p[0] * q[1] - p[1] * q[0], p[0] * q[2] - p[2] * q[0], p[1] * q[2] - p[2] * q[1]
    d_l2 = l1 * footprints[n, D_L2]
    d_l1 = l1 * footprints[n, D_L1] - slope * d_l2
    d_xy = -d_l2 * per_yy
    d_det = -HALF * d_l1 * per_det
    d_xx = dilation * d_det
    d_yy = (HALF * (d_l1 - footprints[n, D_L3] * l3) + slope * d_l2) * per_yy + d_xx
    g0, g1, g2 = TWO * c0 * d_det, TWO * c1 * d_det, TWO * c2 * d_det
    dp = (
        TWO * p[0] * d_xx + q[0] * d_xy + g0 * q[1] + g1 * q[2],
        TWO * p[1] * d_xx + q[1] * d_xy - g0 * q[0] + g2 * q[2],
        TWO * p[2] * d_xx + q[2] * d_xy - g1 * q[0] - g2 * q[1],
    )
    dq = (
        TWO * q[0] * d_yy + p[0] * d_xy - g0 * p[1] - g1 * p[2],
        TWO * q[1] * d_yy + p[1] * d_xy + g0 * p[0] - g2 * p[2],
        TWO * q[2] * d_yy + p[2] * d_xy + g1 * p[0] + g2 * p[1],
    )
    return dp, dq


@helper
def _rotation_backward(n, quats, s, m, o, dp, dq, d_quats):  # type: ignore[no-untyped-def]
    """Add the gradient of row `n`'s quaternion, of any length.

    The gradient of entry (i, k) of its rotation matrix is `m_i dp_k + o_i dq_k`.
    """
    w, x, y, z = quats[n, 0], quats[n, 1], quats[n, 2], quats[n, 3]
    r00, r10, r20 = m[0] * dp[0] + o[0] * dq[0], m[1] * dp[0] + o[1] * dq[0], m[2] * dp[0] + o[2] * dq[0]
    r01, r11, r21 = m[0] * dp[1] + o[0] * dq[1], m[1] * dp[1] + o[1] * dq[1], m[2] * dp[1] + o[2] * dq[1]
    r02, r12, r22 = m[0] * dp[2] + o[0] * dq[2], m[1] * dp[2] + o[1] * dq[2], m[2] * dp[2] + o[2] * dq[2]
    dw = z * (r10 - r01) + y * (r02 - r20) + x * (r21 - r12)
    dx = y * (r10 + r01) + z * (r20 + r02) + w * (r21 - r12) - TWO * x * (r11 + r22)
    dy = x * (r10 + r01) + z * (r21 + r12) + w * (r02 - r20) - TWO * y * (r00 + r22)
    dz = x * (r20 + r02) + y * (r21 + r12) + w * (r10 - r01) - TWO * z * (r00 + r11)
    radial = HALF * s * (w * dw + x * dx + y * dy + z * dz)  # the rotation does not depend on the quaternion's length
    d_quats[n, 0] += s * (dw - radial * w)
    d_quats[n, 1] += s * (dx - radial * x)
    d_quats[n, 2] += s * (dy - radial * y)
    d_quats[n, 3] += s * (dz - radial * z)


@helper
def _shade_backward(n, toward, sh, records, footprints, d_sh):  # type: ignore[no-untyped-def]
    """Gradient of the offset from the eye through the colour; adds to that of the harmonics."""
    gx, gy, gz = ZERO, ZERO, ZERO
    if sh.shape[1] == 1:  # the colour does not depend on the view direction
        for channel in range(3):
            d_sh[n, 0, channel] += C0 * _clamp_backward(n, channel, records, footprints)
        return gx, gy, gz
    length = math.sqrt(_dot(toward, toward))
    x, y, z = toward[0] / length, toward[1] / length, toward[2] / length
    for channel in range(3):
        g = _clamp_backward(n, channel, records, footprints)
        d_sh[n, 0, channel] += C0 * g
        a, b, c = _bands_1_2_backward(n, channel, sh, x, y, z, g, d_sh)
        gx, gy, gz = gx + a, gy + b, gz + c
        if sh.shape[1] > 9:
            a, b, c = _band_3_backward(n, channel, sh, x, y, z, g, d_sh)
            gx, gy, gz = gx + a, gy + b, gz + c
    radial = gx * x + gy * y + gz * z
    return (gx - radial * x) / length, (gy - radial * y) / length, (gz - radial * z) / length


@helper
def _clamp_backward(n, channel, records, footprints):  # type: ignore[no-untyped-def]
    """Gradient of a colour channel before it is clamped at zero."""
    return footprints[n, D_RED + channel] if records[n, RED + channel] > ZERO else ZERO


@helper
def _bands_1_2_backward(n, c, sh, x, y, z, g, d_sh):  # type: ignore[no-untyped-def]
    """SH bands 1 and 2 of channel `c`: gradient of the direction; adds to that of the coefficients."""
    d_sh[n, 1, c] -= C1 * y * g
    d_sh[n, 2, c] += C1 * z * g
    d_sh[n, 3, c] -= C1 * x * g
    gx, gy, gz = -C1 * sh[n, 3, c], -C1 * sh[n, 1, c], C1 * sh[n, 2, c]
    if sh.shape[1] > 4:
        d_sh[n, 4, c] += C20 * x * y * g
        d_sh[n, 5, c] -= C20 * y * z * g
        d_sh[n, 6, c] += C21 * (TWO * z * z - x * x - y * y) * g
        d_sh[n, 7, c] -= C20 * x * z * g
        d_sh[n, 8, c] += C22 * (x * x - y * y) * g
        k4, k5, k6, k7, k8 = (
            C20 * sh[n, 4, c],
            -C20 * sh[n, 5, c],
            C21 * sh[n, 6, c],
            -C20 * sh[n, 7, c],
            C22 * sh[n, 8, c],
        )
        gx += k4 * y - TWO * k6 * x + k7 * z + TWO * k8 * x
        gy += k4 * x + k5 * z - TWO * k6 * y - TWO * k8 * y
        gz += k5 * y + FOUR * k6 * z + k7 * x
    return gx * g, gy * g, gz * g


@helper
def _band_3_backward(n, c, sh, x, y, z, g, d_sh):  # type: ignore[no-untyped-def]
    """As `_bands_1_2_backward` for band 3."""
    xx, yy, zz = x * x, y * y, z * z
    d_sh[n, 9, c] -= C30 * y * (THREE * xx - yy) * g
    d_sh[n, 10, c] += C31 * x * y * z * g
    d_sh[n, 11, c] -= C32 * y * (FOUR * zz - xx - yy) * g
    d_sh[n, 12, c] += C33 * z * (TWO * zz - THREE * xx - THREE * yy) * g
    d_sh[n, 13, c] -= C32 * x * (FOUR * zz - xx - yy) * g
    d_sh[n, 14, c] += C34 * z * (xx - yy) * g
    d_sh[n, 15, c] -= C30 * x * (xx - THREE * yy) * g
    a, b, d, e = -C30 * sh[n, 9, c], C31 * sh[n, 10, c], -C32 * sh[n, 11, c], C33 * sh[n, 12, c]
    f, h, i = -C32 * sh[n, 13, c], C34 * sh[n, 14, c], -C30 * sh[n, 15, c]
    gx = SIX * a * x * y + b * y * z - TWO * d * x * y - SIX * e * x * z
    gx += f * (FOUR * zz - THREE * xx - yy) + TWO * h * x * z + THREE * i * (xx - yy)
    gy = THREE * a * (xx - yy) + b * x * z + d * (FOUR * zz - xx - THREE * yy) - SIX * e * y * z
    gy += -TWO * f * x * y - TWO * h * y * z - SIX * i * x * y
    gz = b * x * y + EIGHT * d * y * z + e * (SIX * zz - THREE * xx - THREE * yy) + EIGHT * f * x * z + h * (xx - yy)
    return gx * g, gy * g, gz * g

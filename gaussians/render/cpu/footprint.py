"""Compute the footprints of 16 Gaussians at once: the arithmetic of `project`, one Gaussian a lane.

Called from an `exact` kernel, so that each operation is rounded as it stands here: `fused(a, b, c)` is `a * b + c` in
one rounding. Names: u, v are the tangents of a centre, m and n the rows of the Jacobian in the world, p and q the
principal axes projected on x and on y.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from llvmlite import ir
from numba import types

from ...compiled import intrinsic
from .lanes import I32, I64, LANES, VECTOR, Lanes, Number, fused, least, most, pointer_to, root, where
from .layout import MASK_SIDE, REACH_Y, RECORD, TILE, View, X, Y

# Rows of a worker's scratch memory `[PLACES, LANES]`: offset from the eye, depth and its inverse, tangents,
# log(opacity / ALPHA_MIN).
PLACES = 8
DX, DY, DZ, DEPTH, INVERSE, U, V, LEVEL = range(PLACES)
SMALL = 6  # bounding boxes of at most this many tiles are taken whole: testing each tile costs more than it saves
TINY = 1e-30
HUGE = 3e38
SLACK = 1.01  # safety factor, larger than any rounding error
EACH_ROW = 0x0101010101010101  # of a mask: the first tile of each row

Quad = tuple[Number, Number, Number, Number]
Triple = tuple[Number, Number, Number]


def _camera(v: Lanes, view: ir.Value) -> View:
    """The view with every number in all lanes."""
    return View(*(v.number(number) for number in v.spread_all(view)))


@intrinsic
def approach(typing_context: Any, means: Any, scales: Any, opacities: Any, row: Any, view: Any, scratch: Any) -> Any:
    """Place rows `row` to `row + 15` before the eye: fills all of `scratch` but LEVEL.

    Returns a bit for each row that may be visible: between near and far plane, of some opacity, and not outside the
    image even as an opaque ball of its largest scale. This culls most invisible Gaussians of an indoor scene at a tenth
    of the cost of a footprint.
    """

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = Lanes(builder)
        means, scales, opacities, scratch = (
            pointer_to(context, builder, signature, arguments, i) for i in (0, 1, 2, 5)
        )
        row, view = arguments[3], _camera(v, arguments[4])
        x, y, z = v.columns(means, row, 3)
        dx, dy, dz = x - view.ex, y - view.ey, z - view.ez
        depth = _along((view.r20, view.r21, view.r22), dx, dy, dz)
        inverse = 1 / depth
        tangent_u = _along((view.r00, view.r01, view.r02), dx, dy, dz) * inverse
        tangent_v = _along((view.r10, view.r11, view.r12), dx, dy, dz) * inverse
        for place, value in enumerate((dx, dy, dz, depth, inverse, tangent_u, tangent_v)):
            v.store(value.value, v.at(scratch, ir.Constant(I64, place * LANES)))
        opacity = v.columns(opacities, row, 1)[0]
        seen = [depth > view.near, depth < view.far, opacity > view.alpha_min, opacity < HUGE]
        outside = _outside_image(tangent_u, tangent_v, inverse, v.columns(scales, row, 3), view)
        return v.bits(_all(builder, [*seen, builder.not_(outside)]))

    signature = types.int64(means, scales, opacities, types.int64, view, scratch)
    return signature, generate


def _all(builder: ir.IRBuilder, masks: list[ir.Value]) -> ir.Value:
    """The lanes that all masks have."""
    found = masks[0]
    for mask in masks[1:]:
        found = builder.and_(found, mask)
    return found


def _along(axis: Triple, dx: Number, dy: Number, dz: Number) -> Number:
    """Scalar product of an axis and an offset."""
    return fused(axis[2], dz, fused(axis[1], dy, axis[0] * dx))


def _outside_image(u: Number, v: Number, inverse: Number, scales: list[Number], view: View) -> ir.Value:
    """Mask of Gaussians at the tangents (u, v) that miss the image even as an opaque ball of their largest scale."""
    b, zero = u.lanes.b, u.lanes.number(0)
    x, y = fused(view.fx, u, view.cx), fused(view.fy, v, view.cy)
    cu, cv = least(most(u, view.u0), view.u1), least(most(v, view.v0), view.v1)
    sizes = [most(scale, -scale) for scale in scales]
    largest = most(most(sizes[0], sizes[1]), sizes[2]) * inverse
    j, k = view.fx * largest, view.fy * largest
    stretch = SLACK * 16 * view.q_max  # squared Mahalanobis distance at which an opaque footprint ends
    reach_x = stretch * fused(j * j, fused(cu, cu, 1.0), view.dilation)
    reach_y = stretch * fused(k * k, fused(cv, cv, 1.0), view.dilation)
    aside, above = most(most(-x, x - view.width), zero), most(most(-y, y - view.height), zero)
    return b.or_(aside * aside > reach_x, above * above > reach_y)


@dataclass(frozen=True)
class _Footprints:
    """16 footprints: the fields of their records but group, the last four of which hold no colours yet and the depth;
    half their width, px; and the mask of those that touch the image."""

    fields: tuple[Number, ...]
    reach_x: Number
    visible: ir.Value


@intrinsic
def footprints(
    typing_context: Any, quats: Any, scales: Any, group: Any, row: Any, view: Any, scratch: Any, seen: Any,
    records: Any, tiles: Any,
) -> Any:  # fmt: skip
    """Footprints of rows `row` to `row + 15` whose bit in `seen` is set; returns a bit for each that touches the image.

    If there are any, fills `records` `[LANES, RECORD]` without the colours, and `tiles` `[3, LANES]` uint64: the tiles
    of a bounding box of at most `SMALL` as a mask, else 0; its first tile (x | y << 16); and its width and height in
    tiles (x | y << 16). `scratch` is what `approach` filled, and LEVEL.
    """

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = Lanes(builder)
        quats, scales, group, scratch, records, tiles = (
            pointer_to(context, builder, signature, arguments, i) for i in (0, 1, 2, 5, 7, 8)
        )
        row, view, seen = arguments[3], _camera(v, arguments[4]), arguments[6]
        places = [v.number(v.load(v.at(scratch, ir.Constant(I64, place * LANES)))) for place in range(PLACES)]
        w, x, y, z = v.columns(quats, row, 4)
        found = _project(places, (w, x, y, z), v.columns(scales, row, 3), view)
        mask = builder.bitcast(builder.trunc(seen, ir.IntType(LANES)), found.visible.type)
        bits = v.bits(builder.and_(mask, found.visible))
        with builder.if_then(builder.icmp_unsigned("!=", bits, ir.Constant(I64, 0))):
            groups = v.load(v.at(group, row), ir.VectorType(I32, LANES))
            fields = [*(field.value for field in found.fields), builder.bitcast(groups, VECTOR)]
            for lane, record in enumerate(v.transpose(fields)):
                v.store(record, v.at(records, ir.Constant(I64, lane * RECORD)))
            for place, words in enumerate(_boxes(v, found, view)):
                v.store(words, v.at(tiles, ir.Constant(I64, place * LANES)))
        return bits

    signature = types.int64(quats, scales, group, types.int64, view, scratch, types.int64, records, tiles)
    return signature, generate


def _project(places: list[Number], quat: Quad, scales: list[Number], view: View) -> _Footprints:
    """Footprints of Gaussians whose offsets, depths, tangents and levels are given."""
    level = places[LEVEL]
    x, y = fused(view.fx, places[U], view.cx), fused(view.fy, places[V], view.cy)
    xx, xy, yy, determinant = _covariance(places, quat, scales, view)
    limit, stretch = level * 0.125, root(level + level)
    tall = root(yy)
    reach_x, reach_y = root(xx) * stretch, tall * stretch
    per_yy = 1 / yy
    slope, quarter = xy * per_yy, root(determinant * per_yy)
    l1 = 0.25 / quarter
    b = x.lanes.b
    inside = [x + reach_x > 0, x - reach_x < view.width, y + reach_y > 0, y - reach_y < view.height]
    nothing = x.lanes.number(0)
    fields = (
        x, y, l1, l1 * -slope, 0.25 / tall, view.q_max - limit, limit, reach_y, slope, quarter * 4, xy * reach_x / xx,
        nothing, nothing, nothing, places[DEPTH],
    )  # fmt: skip
    return _Footprints(fields, reach_x, _all(b, [*inside, determinant < view.max_determinant]))


def _covariance(
    places: list[Number], quat: Quad, scales: list[Number], view: View
) -> tuple[Number, Number, Number, Number]:
    """2-D covariances (xx, xy, yy) with dilation, px^2, and their determinants summed from squares (Cauchy-Binet):
    `xx * yy - xy * xy` would lose every digit of a long thin footprint."""
    u, v = least(most(places[U], view.u0), view.u1), least(most(places[V], view.v0), view.v1)
    j, k = view.fx * places[INVERSE], view.fy * places[INVERSE]
    r0, r1, r2 = (view.r00, view.r01, view.r02), (view.r10, view.r11, view.r12), (view.r20, view.r21, view.r22)
    m = [fused(-u, far, near) * j for near, far in zip(r0, r2, strict=True)]
    n = [fused(-v, far, near) * k for near, far in zip(r1, r2, strict=True)]
    a = _axes(quat)
    # The order of each sum is part of a picture's bytes.
    p = (
        fused(m[0], a[0][0], fused(m[2], a[2][0], m[1] * a[1][0])) * scales[0],
        fused(m[1], a[1][1], fused(m[2], a[2][1], m[0] * a[0][1])) * scales[1],
        fused(m[2], a[2][2], fused(m[0], a[0][2], m[1] * a[1][2])) * scales[2],
    )
    q = (
        fused(n[0], a[0][0], fused(n[2], a[2][0], n[1] * a[1][0])) * scales[0],
        fused(n[1], a[1][1], fused(n[2], a[2][1], n[0] * a[0][1])) * scales[1],
        fused(n[2], a[2][2], fused(n[0], a[0][2], n[1] * a[1][2])) * scales[2],
    )
    xx = fused(p[0], p[0], fused(p[1], p[1], fused(p[2], p[2], view.dilation)))
    yy = fused(q[0], q[0], fused(q[1], q[1], q[2] * q[2]))
    xy = fused(p[0], q[0], fused(p[1], q[1], p[2] * q[2]))
    c0, c1, c2 = (fused(p[i], q[j], -(p[j] * q[i])) for i, j in ((0, 1), (0, 2), (1, 2)))
    squares = fused(c2, c2, fused(c0, c0, c1 * c1))
    return xx, xy, yy + view.dilation, fused(view.dilation, xx + yy, squares)


def _axes(quat: Quad) -> tuple[Triple, Triple, Triple]:
    """Rotation matrices of quaternions of any length; a zero quaternion is the identity, as in
    `rotations.normalize`."""
    w, x, y, z = quat
    xx, yy, zz, xy, xz, yz = x * x, y * y, z * z, x * y, x * z, y * z
    wx, wy, wz = w * x, w * y, w * z
    norm = fused(w, w, xx + yy) + zz
    s = where(norm > TINY, 2 / norm, w.lanes.number(0))
    return (
        (fused(-s, yy + zz, 1.0), s * (xy - wz), s * (xz + wy)),
        (s * (xy + wz), fused(-s, xx + zz, 1.0), s * (yz - wx)),
        (s * (xz - wy), s * (yz + wx), fused(-s, xx + yy, 1.0)),
    )


def _boxes(v: Lanes, found: _Footprints, view: View) -> tuple[ir.Value, ir.Value, ir.Value]:
    """What `footprints` writes to `tiles`."""
    b, integers, words = v.b, ir.VectorType(I32, LANES), ir.VectorType(I64, LANES)

    def tile(x: Number) -> ir.Value:
        return b.zext(b.fptosi((x * (1 / TILE)).value, integers), words)

    def number(value: int) -> ir.Value:
        return ir.Constant(words, [value] * LANES)

    x, y, reach_x, reach_y = found.fields[X], found.fields[Y], found.reach_x, found.fields[REACH_Y]
    left, top = tile(most(x - reach_x, 0)), tile(most(y - reach_y, 0))
    right, bottom = tile(least(x + reach_x, view.width - 0.5)), tile(least(y + reach_y, view.height - 0.5))
    wide, high = b.add(b.sub(right, left), number(1)), b.add(b.sub(bottom, top), number(1))
    small = b.icmp_unsigned("<=", b.mul(wide, high), number(SMALL))
    few, rows = b.select(small, wide, number(0)), b.select(small, high, number(0))
    row = b.sub(b.shl(number(1), few), number(1))
    column = b.and_(number(EACH_ROW), b.sub(b.shl(number(1), b.mul(rows, number(MASK_SIDE))), number(1)))
    return b.mul(row, column), b.or_(left, b.shl(top, number(16))), b.or_(wide, b.shl(high, number(16)))

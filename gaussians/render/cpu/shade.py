"""Evaluate the colours of Gaussians in a view direction: `max(0, 0.5 + SH)`, real spherical harmonics up to degree 3.

Called from an `exact` kernel. What depends only on the direction is computed for 16 Gaussians at once, and the three
channels of a Gaussian together.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types

from ...compiled import helper, intrinsic
from .footprint import DX, DY, DZ
from .lanes import F32, I64, LANES, Lanes, Number, fused, most, pointer_to, root
from .layout import RECORD, RED

f4 = np.float32
THREE = f4(3)
HUGE = 3e38
# Normalisation of the real harmonics, in the order of `gaussians/harmonics.py`.
C0, C1 = f4(0.28209479177387814), f4(0.4886025119029199)
C20, C21, C22 = f4(1.0925484305920792), f4(0.31539156525252005), f4(0.5462742152960396)
C30, C31, C32, C33, C34 = (
    f4(v) for v in (0.5900435899266435, 2.890611442640554, 0.4570457994644658, 0.3731763325901154, 1.445305721320277)
)
# Rows of a worker's `terms` `[TERMS, LANES]`: the direction, and the factors of the coefficients of these numbers.
# With degree 0 the first three rows are the colours.
TERMS = 14
X, Y, Z, YZ_5, XZ_7, XY_4, K6, K8, K9, K10, K11, K12, K14, K15 = range(TERMS)


@intrinsic
def _directions(typing_context: Any, scratch: Any, terms: Any) -> Any:
    """Write the unit vectors of the offsets in `scratch` (from `footprint.approach`) to `terms`."""

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = Lanes(builder, LANES // 2)  # in halves: LLVM's estimate of 1 / sqrt differs with 16 lanes
        scratch, terms = (pointer_to(context, builder, signature, arguments, i) for i in (0, 1))
        for half in range(0, LANES, LANES // 2):
            kind = ir.VectorType(F32, LANES // 2)
            offset = [
                v.number(v.load(v.at(scratch, ir.Constant(I64, place * LANES + half)), kind)) for place in (DX, DY, DZ)
            ]
            x, y, z = offset
            inverse = 1 / root(fused(z, z, fused(y, y, x * x)))
            for place, value in zip((X, Y, Z), offset, strict=True):
                v.store((inverse * value).value, v.at(terms, ir.Constant(I64, place * LANES + half)))
        return context.get_dummy_value()

    return types.void(scratch, terms), generate


@helper
def directions(scratch, terms):  # type: ignore[no-untyped-def]
    """As `_directions`, with LLVM's estimate of 1 / sqrt."""
    _directions(scratch, terms)


@intrinsic
def plain(typing_context: Any, sh: Any, row: Any, terms: Any) -> Any:
    """Write the colours of rows `row` to `row + 15` of degree 0 to the first rows of `terms`; returns a bit for each
    finite one."""

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = Lanes(builder)
        sh, terms = (pointer_to(context, builder, signature, arguments, i) for i in (0, 2))
        red, green, blue = v.columns(sh, arguments[1], 3)
        # Green is rounded once and the others twice, as compilers once chose: pictures keep their bytes.
        values = red * float(C0) + 0.5, fused(green, float(C0), 0.5), blue * float(C0) + 0.5
        finite = None
        for channel, value in enumerate(values):
            v.store(most(v.number(0), value).value, v.at(terms, ir.Constant(I64, channel * LANES)))
            below = _finite(value)
            finite = below if finite is None else builder.and_(finite, below)
        return v.bits(finite)

    return types.int64(sh, types.int64, terms), generate


def _finite(value: Number) -> ir.Value:
    return most(value, -value) < HUGE


@intrinsic
def fill_terms(typing_context: Any, terms: Any, bands: Any) -> Any:
    """Fill `terms` from its directions as far as `bands` coefficients a channel need."""

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = Lanes(builder)
        terms = pointer_to(context, builder, signature, arguments, 0)

        def put(place: int, value: Number) -> None:
            v.store(value.value, v.at(terms, ir.Constant(I64, place * LANES)))

        x, y, z = (v.number(v.load(v.at(terms, ir.Constant(I64, place * LANES)))) for place in (X, Y, Z))
        with builder.if_then(builder.icmp_unsigned(">", arguments[1], ir.Constant(I64, 4))):
            xx, yy, zz, xy = x * x, y * y, z * z, x * y
            across, between = xx + yy, xx - yy
            for place, value in ((YZ_5, y * z), (XZ_7, x * z), (XY_4, xy)):
                put(place, value)
            put(K6, (zz + zz - across) * float(C21))
            put(K8, between * float(C22))
            with builder.if_then(builder.icmp_unsigned(">", arguments[1], ir.Constant(I64, 9))):
                xxx, yyy = xx * 3, yy * 3
                put(K9, (xxx - yy) * y)
                put(K15, (xx - yyy) * x)
                put(K10, xy * float(C31))
                put(K11, fused(zz, -4.0, across) * float(C32))
                put(K12, (zz + zz - (xxx + yyy)) * float(C33))
                put(K14, between * float(C34))
        return context.get_dummy_value()

    return types.void(terms, types.int64), generate


@intrinsic
def shade(typing_context: Any, sh: Any, row: Any, terms: Any, lane: Any, bands: Any, records: Any) -> Any:
    """Write the colour of row `row`, whose factors lie in `lane` of `terms`, to its record; returns whether it is
    finite.

    The three channels are the first three of four lanes. A coefficient that may be the last of the array is read from
    one number further to the front, for there need not be a fourth number behind it.
    """

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = Lanes(builder, 4)
        sh, terms, records = (pointer_to(context, builder, signature, arguments, i) for i in (0, 2, 5))
        row, lane, bands = arguments[1], arguments[3], arguments[4]
        first = v.at(sh, builder.mul(row, builder.mul(bands, ir.Constant(I64, 3))))
        kind = ir.VectorType(F32, 4)

        def of(number: int) -> Number:
            """A coefficient of all channels."""
            last = number in (3, 8, 15)
            loaded = v.load(builder.gep(first, [ir.Constant(I64, 3 * number - last)]), kind)
            return v.number(v.pick(loaded, loaded, (1, 2, 3, 3)) if last else loaded)

        def term(place: int) -> Number:
            return v.number(v.spread(v.load(v.at(terms, lane, place * LANES), F32)))

        x, y, z = term(X), term(Y), term(Z)
        # The order of each sum is part of a picture's bytes.
        slope = fused(-z, of(2), fused(x, of(3), y * of(1)))
        value = fused(slope, -float(C1), of(0) * float(C0))
        entry = builder.block
        with builder.if_then(builder.icmp_unsigned(">", bands, ir.Constant(I64, 4))):
            second = fused(-term(XY_4), of(4), fused(term(XZ_7), of(7), term(YZ_5) * of(5)))
            more = fused(term(K8), of(8), fused(second, -float(C20), fused(term(K6), of(6), value)))
            middle = builder.block
            with builder.if_then(builder.icmp_unsigned(">", bands, ir.Constant(I64, 9))):
                third = fused(term(K15), of(15), term(K9) * of(9))
                fourth = fused(term(K14), of(14), fused(term(K12), of(12), term(K10) * of(10)))
                fifth = fused(x, of(13), y * of(11))
                most_ = fused(fourth, z, fused(fifth, term(K11), fused(third, -float(C30), more)))
                inner = builder.block
            joined = builder.phi(kind)
            joined.add_incoming(more.value, middle)
            joined.add_incoming(most_.value, inner)
            outer = builder.block
        whole = builder.phi(kind)
        whole.add_incoming(value.value, entry)
        whole.add_incoming(joined, outer)
        color = v.number(whole) + 0.5
        target = builder.mul(row, ir.Constant(I64, RECORD))
        channels = v.pick(most(v.number(0), color).value, whole, range(3))
        v.store(channels, v.at(records, target, RED))
        finite = builder.and_(v.bits(_finite(color)), ir.Constant(I64, 7))
        return builder.zext(builder.icmp_unsigned("==", finite, ir.Constant(I64, 7)), I64)

    i = types.int64
    return i(sh, i, terms, i, i, records), generate

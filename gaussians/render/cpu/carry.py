"""Move rows of a cloud by one rigid map: means, rotations and harmonics in one pass, without temporary arrays.

Each row is read before it is written, so that the columns written may be those read. A row's bytes depend on it and on
the map alone, not on the number of workers.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numpy.typing import NDArray

from ... import compiled
from ...compiled import exact, intrinsic
from .lanes import F32, I64, Lanes, Number, fused, pointer_to

WIDE = 4  # lanes: the three channels of a coefficient, and one that is not used; or a quaternion
QUAD = ir.VectorType(F32, WIDE)
ALONE = 1 << 12  # rows up to which a second thread costs more than it saves


def run(kernel: Any, rows: NDArray[np.int64], *arguments: Any) -> None:
    """Call one of the kernels below for some rows."""
    compiled.run(kernel, compiled.workers() if len(rows) > ALONE else 1, rows, *arguments)


@exact
def carry(worker, workers, rows, columns, out, turn, shift, product, bands):  # type: ignore[no-untyped-def]
    """Write rows `[M]` (int64) of means, quats and sh in `columns` to the same rows of `out`, moved by
    `x -> turn @ x + shift`.

    `turn` `[3, 3]` and `shift` `[3]` are float64, `product` `[4, 4]` float32: row i is the product of the turn's
    quaternion and the i-th basis quaternion; `bands` float32: the matrices of bands 1, 2, ... row by row, each number
    `WIDE` times. Of harmonics without view-dependent bands nothing is read or written.
    """
    means, quats, sh = columns
    for k in range(rows.shape[0] * worker // workers, rows.shape[0] * (worker + 1) // workers):
        n = rows[k]
        x, y, z = means[n, 0], means[n, 1], means[n, 2]
        for axis in range(3):
            out[0][n, axis] = turn[axis, 0] * x + turn[axis, 1] * y + turn[axis, 2] * z + shift[axis]
        _turn_quat(quats, n, product, out[1])
        if sh.shape[1] > 1:
            for channel in range(3):
                out[2][n, 0, channel] = sh[n, 0, channel]
            _turn_bands(sh, n, sh.shape[1], bands, out[2])


@exact
def shift_means(worker, workers, rows, means, out, shift):  # type: ignore[no-untyped-def]
    """Write rows `[M]` (int64) of `means` to the same rows of `out`, moved by `shift` `[3]` float64."""
    for k in range(rows.shape[0] * worker // workers, rows.shape[0] * (worker + 1) // workers):
        n = rows[k]
        for axis in range(3):
            out[n, axis] = means[n, axis] + shift[axis]


@intrinsic
def _turn_quat(typing_context: Any, quats: Any, row: Any, product: Any, out: Any) -> Any:
    """Multiply a row of `quats` by the matrix `product` from the right, into that row of `out`."""

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = Lanes(builder, WIDE)
        quats, product, out = (pointer_to(context, builder, signature, arguments, i) for i in (0, 2, 3))
        start = builder.mul(arguments[1], ir.Constant(I64, WIDE))
        quat = v.load(v.at(quats, start), QUAD)
        parts = [v.number(v.pick(quat, quat, [place] * WIDE)) for place in range(WIDE)]
        rows = [v.number(v.load(v.at(product, ir.Constant(I64, WIDE * place)), QUAD)) for place in range(WIDE)]
        v.store(_sum(parts, rows).value, v.at(out, start))
        return context.get_dummy_value()

    return types.void(quats, types.int64, product, out), generate


@intrinsic
def _turn_bands(typing_context: Any, sh: Any, row: Any, count: Any, bands: Any, out: Any) -> Any:
    """Rotate all bands but the constant one of row `row` of `sh`, of `count` coefficients, into that row of `out`."""

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = Lanes(builder, WIDE)
        sh, bands, out = (pointer_to(context, builder, signature, arguments, i) for i in (0, 3, 4))
        start = builder.mul(arguments[1], builder.mul(arguments[2], ir.Constant(I64, 3)))
        for degree in (1, 2, 3):
            with builder.if_then(builder.icmp_unsigned(">", arguments[2], ir.Constant(I64, degree * degree))):
                _turn_band(v, degree, v.at(sh, start), bands, v.at(out, start))
        return context.get_dummy_value()

    return types.void(sh, types.int64, types.int64, bands, out), generate


def _turn_band(v: Lanes, degree: int, sh: ir.Value, bands: ir.Value, out: ir.Value) -> None:
    """Emit the rotation of the band `degree` of one row.

    The last coefficient of a band is read and written from one number further to the front: there need not be a number
    behind it, and the next band's first one stays.
    """
    first, count = degree * degree, 2 * degree + 1
    skipped = sum((2 * lower + 1) ** 2 for lower in range(1, degree))  # numbers of the matrices before this one

    def at(base: ir.Value, place: int) -> ir.Value:
        return v.b.gep(base, [ir.Constant(I64, 3 * (first + place) - (place == count - 1))])

    loaded = [v.load(at(sh, place), QUAD) for place in range(count)]
    loaded[-1] = v.pick(loaded[-1], loaded[-1], (1, 2, 3, 3))
    coefficients = [v.number(value) for value in loaded]
    turned = []
    for place in range(count):
        row = [(skipped + place * count + k) * WIDE for k in range(count)]
        factors = [v.number(v.load(v.at(bands, ir.Constant(I64, number)), QUAD)) for number in row]
        turned.append(_sum(coefficients, factors).value)
    for place, value in enumerate(turned[:-1]):
        v.store(value, at(out, place))
    v.store(v.pick(turned[-2], turned[-1], (2, WIDE, WIDE + 1, WIDE + 2)), at(out, count - 1))


def _sum(numbers: list[Number], factors: list[Number]) -> Number:
    """The sum of products, in their order."""
    total = numbers[0] * factors[0]
    for number, factor in zip(numbers[1:], factors[1:], strict=True):
        total = fused(number, factor, total)
    return total

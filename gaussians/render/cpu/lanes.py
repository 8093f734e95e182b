"""Emit LLVM vector instructions from numba intrinsics.

Compilers do not vectorise the renderer's loops automatically, so they are written as LLVM vectors, which LLVM lowers to
AVX-512, AVX2, SSE or NEON.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils

from ...compiled import intrinsic

LANES = 16
F32, I16, I32, I64 = ir.FloatType(), ir.IntType(16), ir.IntType(32), ir.IntType(64)
VECTOR, INTEGERS = ir.VectorType(F32, LANES), ir.VectorType(I32, LANES)


class Lanes:
    """Emitter of vector instructions on 16 pixels (or another `count` of numbers).

    Sums and products may be fused and reordered as far as the options of the enclosing kernel allow.
    """

    def __init__(self, builder: ir.IRBuilder, count: int = LANES) -> None:
        self.b, self.count = builder, count

    def constant(self, values: Sequence[float]) -> ir.Value:
        return ir.Constant(ir.VectorType(F32, len(values)), [ir.Constant(F32, float(np.float32(v))) for v in values])

    def same(self, value: float) -> ir.Value:
        return self.constant([value] * self.count)

    def spread(self, scalar: ir.Value) -> ir.Value:
        """Broadcast a scalar to every lane."""
        nothing = ir.Constant(ir.VectorType(scalar.type, self.count), ir.Undefined)
        first = self.b.insert_element(nothing, scalar, ir.Constant(I32, 0))
        return self.b.shuffle_vector(first, nothing, ir.Constant(ir.VectorType(I32, self.count), [0] * self.count))

    def spread_all(self, numbers: ir.Value) -> list[ir.Value]:
        """Broadcast each number of a tuple to a vector of its own."""
        return [self.spread(number) for number in cgutils.unpack_tuple(self.b, numbers)]  # type: ignore[no-untyped-call]

    def at(self, base: ir.Value, offset: ir.Value, step: int = 0) -> ir.Value:
        """Pointer to element `offset + step`."""
        return self.b.gep(base, [self.b.add(offset, ir.Constant(I64, step))])

    def load(self, pointer: ir.Value, kind: ir.Type = VECTOR) -> ir.Value:
        value = self.b.load(self.b.bitcast(pointer, kind.as_pointer()))
        value.align = 4
        return value

    def store(self, value: ir.Value, pointer: ir.Value) -> None:
        self.b.store(value, self.b.bitcast(pointer, value.type.as_pointer())).align = 4

    def add(self, x: ir.Value, y: ir.Value) -> ir.Value:
        return self.b.fadd(x, y)

    def sub(self, x: ir.Value, y: ir.Value) -> ir.Value:
        return self.b.fsub(x, y)

    def mul(self, x: ir.Value, y: ir.Value) -> ir.Value:
        return self.b.fmul(x, y)

    def less(self, x: ir.Value, y: ir.Value) -> ir.Value:
        return self.b.fcmp_ordered("<", x, y)

    def min(self, x: ir.Value, y: ir.Value) -> ir.Value:
        return self.b.select(self.less(x, y), x, y)

    def max(self, x: ir.Value, y: ir.Value) -> ir.Value:
        return self.b.select(self.less(x, y), y, x)

    def sqrt(self, x: ir.Value) -> ir.Value:
        kind = ir.FunctionType(x.type, [x.type])
        name = f"llvm.sqrt.v{self.count}f32"
        function = cgutils.get_or_insert_function(self.b.module, kind, name)  # type: ignore[no-untyped-call]
        return self.b.call(function, [x])

    def pick(self, x: ir.Value, y: ir.Value, lanes: Iterable[int]) -> ir.Value:
        """Shuffle: the given lanes of x (0 to 15, if it has 16) and y (from there on)."""
        chosen = [ir.Constant(I32, lane) for lane in lanes]
        return self.b.shuffle_vector(x, y, ir.Constant(ir.VectorType(I32, len(chosen)), chosen))

    def bits(self, mask: ir.Value) -> ir.Value:
        """A mask as the low bits of an int64."""
        low = self.b.bitcast(mask, ir.IntType(mask.type.count))
        return low if low.type == I64 else self.b.zext(low, I64)

    def number(self, value: ir.Value | float) -> Number:
        """A vector, or the same number in every lane."""
        return Number(self, value if isinstance(value, ir.Value) else self.same(value))

    def fused(self, x: ir.Value, y: ir.Value, z: ir.Value) -> ir.Value:
        """`x * y + z`, rounded once where the processor has an instruction for it."""
        kind = ir.FunctionType(x.type, [x.type] * 3)
        function = cgutils.get_or_insert_function(self.b.module, kind, f"llvm.fmuladd.v{self.count}f32")  # type: ignore[no-untyped-call]
        return self.b.call(function, [x, y, z])

    def columns(self, base: ir.Value, row: ir.Value, width: int) -> list[Number]:
        """The columns of as many rows as there are lanes, from `row` on, of a contiguous array `[N, width]`."""
        start = self.b.mul(row, ir.Constant(I64, width))
        loaded = [self.load(self.at(base, start, part * self.count)) for part in range(width)]
        return [self.number(self._column(loaded, place)) for place in range(width)]

    def _column(self, loaded: list[ir.Value], place: int) -> ir.Value:
        """Every `len(loaded)`-th number of consecutive vectors, from `place` on."""
        source = [divmod(lane * len(loaded) + place, self.count) for lane in range(self.count)]
        found = self.pick(loaded[0], loaded[0], [at if part == 0 else 0 for part, at in source])
        for number, vector in enumerate(loaded[1:], start=1):
            lanes = [self.count + at if part == number else lane for lane, (part, at) in enumerate(source)]
            found = self.pick(found, vector, lanes)
        return found

    def transpose(self, rows: list[ir.Value]) -> list[ir.Value]:
        """As many vectors as there are lanes, such that lane i of the j-th becomes lane j of the i-th."""
        step = 1
        while step < self.count:
            swapped = list(rows)
            low = [lane if not lane & step else self.count + lane - step for lane in range(self.count)]
            high = [lane + step if not lane & step else self.count + lane for lane in range(self.count)]
            for place in range(self.count):
                if not place & step:
                    pair = rows[place], rows[place + step]
                    swapped[place], swapped[place + step] = self.pick(*pair, low), self.pick(*pair, high)
            rows, step = swapped, 2 * step
        return rows


class Number:
    """A vector of float32 with the operators of Python; comparisons give masks.

    In an `exact` kernel each operation is rounded once, in the order of the source.
    """

    def __init__(self, lanes: Lanes, value: ir.Value) -> None:
        self.lanes, self.value = lanes, value

    def _with(self, other: Number | float) -> ir.Value:
        return other.value if isinstance(other, Number) else self.lanes.same(other)

    def __add__(self, other: Number | float) -> Number:
        return Number(self.lanes, self.lanes.add(self.value, self._with(other)))

    def __sub__(self, other: Number | float) -> Number:
        return Number(self.lanes, self.lanes.sub(self.value, self._with(other)))

    def __mul__(self, other: Number | float) -> Number:
        return Number(self.lanes, self.lanes.mul(self.value, self._with(other)))

    def __truediv__(self, other: Number | float) -> Number:
        return Number(self.lanes, self.lanes.b.fdiv(self.value, self._with(other)))

    def __rtruediv__(self, other: float) -> Number:
        return self.lanes.number(other) / self

    __radd__, __rmul__ = __add__, __mul__

    def __neg__(self) -> Number:
        return Number(self.lanes, self.lanes.b.fneg(self.value))

    def __lt__(self, other: Number | float) -> ir.Value:
        return self.lanes.less(self.value, self._with(other))

    def __gt__(self, other: Number | float) -> ir.Value:
        return self.lanes.less(self._with(other), self.value)


def fused(x: Number, y: Number | float, z: Number | float) -> Number:
    """`x * y + z`, rounded once where the processor can."""
    return Number(x.lanes, x.lanes.fused(x.value, x._with(y), x._with(z)))


def least(x: Number, y: Number | float) -> Number:
    """The smaller one; y where either is not a number."""
    return Number(x.lanes, x.lanes.min(x.value, x._with(y)))


def most(x: Number, y: Number | float) -> Number:
    """The larger one; x where either is not a number."""
    return Number(x.lanes, x.lanes.max(x.value, x._with(y)))


def root(x: Number) -> Number:
    """The square root."""
    return Number(x.lanes, x.lanes.sqrt(x.value))


def where(mask: ir.Value, x: Number | float, y: Number) -> Number:
    """x in the lanes of the mask, y in the others."""
    return Number(y.lanes, y.lanes.b.select(mask, y._with(x), y.value))


def pointer_to(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any, index: int) -> ir.Value:
    """Pointer to the first element of array argument `index`."""
    return context.make_array(signature.args[index])(context, builder, arguments[index]).data


@intrinsic
def lane_sum(typing_context: Any, weights: Any, slot: Any) -> Any:
    """Sum of row `slot` of `weights` `[CHUNK, LANES]`, always added in the same order: halves, quarters and so on.

    A plain loop would not be deterministic: LLVM may reorder it, and compiles two versions between which it chooses by
    the addresses of the arrays.
    """

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = Lanes(builder)
        base = pointer_to(context, builder, signature, arguments, 0)
        row = v.load(v.at(base, builder.mul(arguments[1], ir.Constant(I64, LANES))))
        half = LANES // 2
        while half:
            row = v.add(v.pick(row, row, range(half)), v.pick(row, row, range(half, 2 * half)))
            half //= 2
        return builder.extract_element(row, ir.Constant(I32, 0))

    return types.float32(weights, types.int64), generate

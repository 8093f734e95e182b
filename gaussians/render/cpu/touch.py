"""Test footprints against the 4x4-pixel blocks of a tile: which blocks a footprint touches, and the reverse."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils

from ...compiled import intrinsic
from .lanes import F32, I16, I32, I64, LANES, Lanes, pointer_to
from .layout import EXTREME, L1, L2, L3, LIMIT, REACH_Y, RECORD, SLOPE, TILE, WIDTH, X, Y

BLOCK_WIDTH, BLOCK_HEIGHT = 4, 4  # a square block leaves the fewest lanes idle under an ellipse
BLOCKS_WIDE, BLOCKS_HIGH = TILE // BLOCK_WIDTH, TILE // BLOCK_HEIGHT
BLOCKS = TILE * TILE // LANES
CHUNK = 64  # footprints a tile processes at once: those that touch a block fit the bits of one word


@intrinsic
def copy_record(typing_context: Any, records: Any, row: Any, chunk: Any, slot: Any, x: Any, y: Any) -> Any:
    """Copy record `row` into `chunk[slot]`; returns a bit for each block of the tile at (x, y) px that it touches.

    In the copy, X and Y hold `-(l1 cx + l2 cy)` and `-l3 cy` for the centre c relative to the tile, so that two
    multiply-adds a coordinate give the exponent anywhere in it.
    """
    signature = types.int64(records, types.int64, chunk, types.int64, types.float32, types.float32)

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = Lanes(builder)
        source, target = (pointer_to(context, builder, signature, arguments, i) for i in (0, 2))
        _, row, _, slot, x, y = arguments
        size = ir.Constant(I64, RECORD)
        source, target = v.at(source, builder.mul(row, size)), v.at(target, builder.mul(slot, size))

        def field(place: int) -> ir.Value:
            return v.load(builder.gep(source, [ir.Constant(I64, place)]), F32)

        v.store(v.load(source), target)
        x, y = builder.fsub(field(X), x), builder.fsub(field(Y), y)
        along = builder.fneg(v.add(v.mul(field(L1), x), v.mul(field(L2), y)))
        v.store(along, target)
        v.store(builder.fneg(v.mul(field(L3), y)), builder.gep(target, [ir.Constant(I64, Y)]))
        return v.bits(_touched(builder, x, y, field))

    return signature, generate


def _touched(builder: ir.IRBuilder, x: ir.Value, y: ir.Value, field: Callable[[int], ir.Value]) -> ir.Value:
    """Mask over a tile's blocks: whether the ellipse at (x, y) reaches the block's pixel centres (see `layout.span`).

    The right ends of its intervals, one for each row of blocks, and the left ends are computed as one vector.
    """
    v = Lanes(builder, 2 * BLOCKS_HIGH)
    top = [row * BLOCK_HEIGHT + 0.5 for row in range(BLOCKS_HIGH)] * 2
    side = v.constant([1.0] * BLOCKS_HIGH + [-1.0] * BLOCKS_HIGH)
    slope, width, l3, limit, extreme, reach = (
        v.spread(field(place)) for place in (SLOPE, WIDTH, L3, LIMIT, EXTREME, REACH_Y)
    )
    y = v.spread(y)
    low = v.max(v.sub(v.constant(top), y), v.sub(v.same(0), reach))
    high = v.min(v.sub(v.constant([row + BLOCK_HEIGHT - 1 for row in top]), y), reach)
    at = v.min(v.max(v.mul(side, extreme), low), high)  # the row of the band where the ellipse reaches furthest
    drop = v.mul(l3, at)
    root = v.sqrt(v.max(v.sub(limit, v.mul(drop, drop)), v.same(0)))
    end = v.add(v.spread(x), v.add(v.mul(slope, at), v.mul(side, v.mul(root, width))))
    end = builder.select(builder.fcmp_ordered("<=", low, high), end, v.mul(side, v.same(-math.inf)))
    rows = [block // BLOCKS_WIDE for block in range(BLOCKS)]
    left = [block % BLOCKS_WIDE * BLOCK_WIDTH + 0.5 for block in range(BLOCKS)]
    return builder.and_(
        builder.fcmp_ordered(">=", v.pick(end, end, rows), v.constant(left)),
        builder.fcmp_ordered(
            "<=", v.pick(end, end, [BLOCKS_HIGH + row for row in rows]), v.constant([x + BLOCK_WIDTH - 1 for x in left])
        ),
    )


@intrinsic
def slots_touching(typing_context: Any, touched: Any, block: Any) -> Any:
    """A bit for each slot of a chunk that touches `block`: whose word in `touched` `[CHUNK]` uint16 has its bit set."""

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = Lanes(builder, CHUNK)
        words = v.load(pointer_to(context, builder, signature, arguments, 0), ir.VectorType(I16, CHUNK))
        bit = v.spread(builder.shl(ir.Constant(I16, 1), builder.trunc(arguments[1], I16)))
        none = ir.Constant(words.type, [0] * CHUNK)
        return v.bits(builder.icmp_unsigned("!=", builder.and_(words, bit), none))

    return types.uint64(touched, types.int64), generate


@intrinsic
def lowest_bit(typing_context: Any, value: Any) -> Any:
    """Index of the lowest set bit of a non-zero uint64."""

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        return builder.cttz(arguments[0], ir.Constant(ir.IntType(1), 1))

    return types.int64(types.uint64), generate


@intrinsic
def prefetch(typing_context: Any, rows: Any, row: Any) -> Any:
    """Prefetch the cache line in which a row of the contiguous array `rows` `[N, M]` begins."""

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = Lanes(builder)
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        width = cgutils.unpack_tuple(builder, array.shape)[1]  # type: ignore[no-untyped-call]
        pointer = v.at(array.data, builder.mul(arguments[1], width))
        byte = ir.IntType(8).as_pointer()
        kind = ir.FunctionType(ir.VoidType(), [byte, I32, I32, I32])
        function = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0")  # type: ignore[no-untyped-call]
        read, keep, data = (ir.Constant(I32, n) for n in (0, 3, 1))
        builder.call(function, [builder.bitcast(pointer, byte), read, keep, data])
        return context.get_dummy_value()

    return types.void(rows, types.int64), generate

"""Explicit SIMD: what one instruction sequence does to a block of 8x2 pixels.

Knows vectors of 16 floats, records and the blending rule. Refuses to know tiles, lists and images as a whole. Compilers
do not vectorise this by themselves, so it is written as LLVM vectors, which LLVM lowers to AVX-512, AVX2, SSE or NEON.

The only chain from one footprint to the next is one multiplication: the running transmittance simply goes on falling
in a finished pixel, where comparing it with the least transmittance masks every weight; the last value above that is
kept beside it. `exp(-8 q)` is the eighth power of a degree-5 polynomial in q: three squarings, no bit tricks, relative
error below 1e-6.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils

from ...compiled import intrinsic
from .project import (
    BLUE,
    DEPTH,
    EXTREME,
    GREEN,
    GROUP,
    L1,
    L2,
    L3,
    LIMIT,
    REACH_Y,
    RECORD,
    RED,
    SHIFT,
    SLOPE,
    TILE,
    WIDTH,
    X,
    Y,
)

LANES = 16
BLOCK_WIDTH, BLOCK_HEIGHT = 8, 2
BLOCKS_WIDE = TILE // BLOCK_WIDTH
BLOCKS = TILE * TILE // LANES
# A block's state: running transmittance, red, green, blue, depth, kept transmittance, best weight, its group's bits.
CHANNELS = 8
REST, WINNER = 5 * LANES, 7 * LANES
STATE = CHANNELS * LANES
DIMMEST = 1e-30  # the running transmittance stops here: denormal numbers are slow

# exp(-q) on [0, 0.693] = [0, Q_MAX], least largest relative error (Lawson's iteration), ascending powers.
EXP_COEFFICIENTS = (0.99999994, -0.9999929, 0.49988723, -0.16599411, 0.039808128, -0.0058686733)

_F32, _I32, _I64 = ir.FloatType(), ir.IntType(32), ir.IntType(64)
_VECTOR, _INTEGERS = ir.VectorType(_F32, LANES), ir.VectorType(_I32, LANES)
_FUSE = ("contract",)  # multiply-adds may fuse; nothing else is relaxed


class _Lanes:
    """16 pixels at once: a thin spelling of LLVM's vector instructions."""

    def __init__(self, builder: ir.IRBuilder) -> None:
        self.b = builder

    def constant(self, values: Sequence[float]) -> ir.Value:
        return ir.Constant(_VECTOR, [ir.Constant(_F32, float(np.float32(v))) for v in values])

    def same(self, value: float) -> ir.Value:
        return self.constant([value] * LANES)

    def spread(self, scalar: ir.Value) -> ir.Value:
        """A scalar (float or int32) in every lane."""
        kind = _INTEGERS if scalar.type == _I32 else _VECTOR
        nothing = ir.Constant(kind, ir.Undefined)
        first = self.b.insert_element(nothing, scalar, ir.Constant(_I32, 0))
        return self.b.shuffle_vector(first, nothing, ir.Constant(_INTEGERS, [0] * LANES))

    def spread_all(self, numbers: ir.Value) -> list[ir.Value]:
        """Each number of a tuple in every lane of its own vector."""
        return [self.spread(number) for number in cgutils.unpack_tuple(self.b, numbers)]  # type: ignore[no-untyped-call]

    def at(self, base: ir.Value, offset: ir.Value, step: int = 0) -> ir.Value:
        """Pointer to element `offset + step`."""
        return self.b.gep(base, [self.b.add(offset, ir.Constant(_I64, step))])

    def load(self, pointer: ir.Value, kind: ir.Type = _VECTOR) -> ir.Value:
        value = self.b.load(self.b.bitcast(pointer, kind.as_pointer()))
        value.align = 4
        return value

    def store(self, value: ir.Value, pointer: ir.Value) -> None:
        self.b.store(value, self.b.bitcast(pointer, value.type.as_pointer())).align = 4

    def add(self, x: ir.Value, y: ir.Value) -> ir.Value:
        return self.b.fadd(x, y, _FUSE)

    def sub(self, x: ir.Value, y: ir.Value) -> ir.Value:
        return self.b.fsub(x, y, _FUSE)

    def mul(self, x: ir.Value, y: ir.Value) -> ir.Value:
        return self.b.fmul(x, y, _FUSE)

    def less(self, x: ir.Value, y: ir.Value) -> ir.Value:
        return self.b.fcmp_ordered("<", x, y)

    def min(self, x: ir.Value, y: ir.Value) -> ir.Value:
        return self.b.select(self.less(x, y), x, y)

    def max(self, x: ir.Value, y: ir.Value) -> ir.Value:
        return self.b.select(self.less(x, y), y, x)

    def sqrt(self, x: ir.Value) -> ir.Value:
        kind = ir.FunctionType(_VECTOR, [_VECTOR])
        name = f"llvm.sqrt.v{LANES}f32"
        function = cgutils.get_or_insert_function(self.b.module, kind, name)  # type: ignore[no-untyped-call]
        return self.b.call(function, [x])

    def exp_minus_8(self, q: ir.Value) -> ir.Value:
        """`exp(-8 q)` for q in [0, Q_MAX]; finite or infinite nonsense beyond."""
        e = self.same(EXP_COEFFICIENTS[-1])
        for coefficient in EXP_COEFFICIENTS[-2::-1]:
            e = self.add(self.mul(e, q), self.same(coefficient))
        for _ in range(3):
            e = self.mul(e, e)
        return e

    def pick(self, x: ir.Value, y: ir.Value, lanes: Iterable[int]) -> ir.Value:
        """A vector of the named lanes of x (0 to 15) and y (16 to 31)."""
        chosen = [ir.Constant(_I32, lane) for lane in lanes]
        return self.b.shuffle_vector(x, y, ir.Constant(ir.VectorType(_I32, len(chosen)), chosen))

    def bits(self, mask: ir.Value) -> ir.Value:
        """A mask as the low 16 bits of an int64."""
        return self.b.zext(self.b.bitcast(mask, ir.IntType(LANES)), _I64)


def _data(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any, index: int) -> ir.Value:
    """Pointer to the first element of array argument `index`."""
    return context.make_array(signature.args[index])(context, builder, arguments[index]).data


@intrinsic
def take(typing_context: Any, records: Any, row: Any, chunk: Any, slot: Any, x: Any, y: Any) -> Any:
    """Copy record `row` into `chunk[slot]`; returns a bit for each block of the tile at (x, y) px that it touches.

    In the copy, X and Y hold `-(l1 cx + l2 cy)` and `-l3 cy` for the centre c relative to the tile, so that two
    multiply-adds a coordinate give the exponent anywhere in it.
    """
    signature = types.int64(records, types.int64, chunk, types.int64, types.float32, types.float32)

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = _Lanes(builder)
        source, target = (_data(context, builder, signature, arguments, i) for i in (0, 2))
        _, row, _, slot, x, y = arguments
        size = ir.Constant(_I64, RECORD)
        source, target = v.at(source, builder.mul(row, size)), v.at(target, builder.mul(slot, size))

        def field(place: int) -> ir.Value:
            return v.load(builder.gep(source, [ir.Constant(_I64, place)]), _F32)

        v.store(v.load(source), target)
        x, y = builder.fsub(field(X), x), builder.fsub(field(Y), y)
        along = builder.fneg(v.add(v.mul(field(L1), x), v.mul(field(L2), y)))
        v.store(along, target)
        v.store(builder.fneg(v.mul(field(L3), y)), builder.gep(target, [ir.Constant(_I64, Y)]))
        return v.bits(_touched(v, x, y, field))

    return signature, generate


def _touched(v: _Lanes, x: ir.Value, y: ir.Value, field: Any) -> ir.Value:
    """Mask over a tile's blocks: does the ellipse at (x, y) come within the block's pixel centres? (`project.span`)"""
    row = [i // BLOCKS_WIDE * BLOCK_HEIGHT for i in range(LANES)]
    column = [i % BLOCKS_WIDE * BLOCK_WIDTH for i in range(LANES)]
    y, reach = v.spread(y), v.spread(field(REACH_Y))
    low = v.max(v.sub(v.constant([r + 0.5 for r in row]), y), v.sub(v.same(0), reach))
    high = v.min(v.sub(v.constant([r + BLOCK_HEIGHT - 0.5 for r in row]), y), reach)
    slope, width, l3 = (v.spread(field(place)) for place in (SLOPE, WIDTH, L3))
    limit, extreme = v.spread(field(LIMIT)), v.spread(field(EXTREME))

    def side(at: ir.Value) -> tuple[ir.Value, ir.Value]:
        """Middle and half width of the ellipse at the row of the band nearest to `at`."""
        at = v.min(v.max(at, low), high)
        drop = v.mul(l3, at)
        root = v.sqrt(v.max(v.sub(limit, v.mul(drop, drop)), v.same(0)))
        return v.mul(slope, at), v.mul(root, width)

    x = v.spread(x)
    middle, half = side(extreme)
    right = v.add(x, v.add(middle, half))
    middle, half = side(v.sub(v.same(0), extreme))
    left = v.add(x, v.sub(middle, half))
    inside = v.b.and_(
        v.b.fcmp_ordered(">=", right, v.constant([c + 0.5 for c in column])),
        v.b.fcmp_ordered("<=", left, v.constant([c + BLOCK_WIDTH - 0.5 for c in column])),
    )
    return v.b.and_(inside, v.b.fcmp_ordered("<=", low, high))


@intrinsic
def fetch(typing_context: Any, records: Any, row: Any) -> Any:
    """Ask for a record's cache line; harmless if it is never used."""

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = _Lanes(builder)
        base = _data(context, builder, signature, arguments, 0)
        pointer = v.at(base, builder.mul(arguments[1], ir.Constant(_I64, RECORD)))
        byte = ir.IntType(8).as_pointer()
        kind = ir.FunctionType(ir.VoidType(), [byte, _I32, _I32, _I32])
        function = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0")  # type: ignore[no-untyped-call]
        read, keep, data = (ir.Constant(_I32, n) for n in (0, 3, 1))
        builder.call(function, [builder.bitcast(pointer, byte), read, keep, data])
        return context.get_dummy_value()

    return types.void(records, types.int64), generate


def footprint(v: _Lanes, record: ir.Value, x: ir.Value, y: ir.Value, limits: list[ir.Value]) -> Any:
    """One footprint in 16 pixels: alpha, the two squared terms of its exponent (not squared), reader of its fields."""

    def field(place: int, kind: ir.Type = _F32) -> ir.Value:
        return v.spread(v.load(v.b.gep(record, [ir.Constant(_I64, place)]), kind))

    alpha_max, _, q_max = limits
    along = v.add(v.mul(field(L1), x), v.add(v.mul(field(L2), y), field(X)))
    across = v.add(v.mul(field(L3), y), field(Y))
    q = v.add(v.mul(along, along), v.add(v.mul(across, across), field(SHIFT)))
    alpha = v.min(v.exp_minus_8(q), alpha_max)
    return v.b.select(v.b.fcmp_ordered("<=", q, q_max), alpha, v.same(0)), along, across, field


def behind_it(v: _Lanes, t: ir.Value, alpha: ir.Value, t_min: ir.Value) -> tuple[ir.Value, ir.Value]:
    """Transmittance behind a footprint, and the mask of pixels that are still open there."""
    behind = v.max(v.mul(t, v.sub(v.same(1), alpha)), v.same(DIMMEST))
    return behind, v.less(t_min, behind)


def _step(v: _Lanes, record: ir.Value, x: ir.Value, y: ir.Value, t: ir.Value, limits: list[ir.Value]) -> Any:
    """One footprint in 16 pixels: weight, new transmittance, mask of pixels still open, reader of its fields."""
    alpha, _, _, field = footprint(v, record, x, y, limits)
    behind, still_open = behind_it(v, t, alpha, limits[1])
    return v.b.select(still_open, v.mul(t, alpha), v.same(0)), behind, still_open, field


@intrinsic
def blend_block(
    typing_context: Any, chunk: Any, listed: Any, count: Any, state: Any, offset: Any, x: Any, y: Any, limits: Any
) -> Any:
    """Blend the `count` > 0 records of `chunk` named in `listed` into the block whose state begins at `offset`.

    (x, y) is the block's corner in the tile, `limits` a tuple of what `_step` takes. Returns whether
    any pixel is still open.
    """
    f = types.float32
    signature = types.int64(chunk, listed, types.int64, state, types.int64, f, f, limits)

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = _Lanes(builder)
        chunk, listed, state = (_data(context, builder, signature, arguments, i) for i in (0, 1, 3))
        count, offset, x, y, limits = (arguments[i] for i in (2, 4, 5, 6, 7))
        x, y = _pixels(v, x, y)
        limits = v.spread_all(limits)
        before = [v.load(v.at(state, offset, channel * LANES)) for channel in range(CHANNELS - 1)]
        before.append(v.load(v.at(state, offset, WINNER), _INTEGERS))

        def body(record: ir.Value, slot: ir.Value, values: list[ir.Value]) -> tuple[list[ir.Value], ir.Value]:
            t, *sums, rest, best, winner = values
            weight, t, still_open, field = _step(v, record, x, y, t, limits)
            rest = builder.select(still_open, t, rest)
            places = (RED, GREEN, BLUE, DEPTH)
            sums = [v.add(total, v.mul(weight, field(p))) for total, p in zip(sums, places, strict=True)]
            heavier = v.less(best, weight)
            winner = builder.select(heavier, field(GROUP, _I32), winner)
            return [t, *sums, rest, builder.select(heavier, weight, best), winner], still_open

        after, alive = _loop(v, chunk, listed, count, before, body)
        for channel, value in enumerate(after):
            v.store(value, v.at(state, offset, channel * LANES))
        return alive

    return signature, generate


@intrinsic
def weigh_block(
    typing_context: Any, chunk: Any, listed: Any, count: Any, state: Any, offset: Any, weights: Any, x: Any, y: Any,
    limits: Any,
) -> Any:  # fmt: skip
    """As `blend_block`, but add each footprint's weights to its row of `weights` `[CHUNK, LANES]`, not to colours."""
    f = types.float32
    signature = types.int64(chunk, listed, types.int64, state, types.int64, weights, f, f, limits)

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = _Lanes(builder)
        chunk, listed, state, weights = (_data(context, builder, signature, arguments, i) for i in (0, 1, 3, 5))
        count, offset, x, y, limits = (arguments[i] for i in (2, 4, 6, 7, 8))
        x, y = _pixels(v, x, y)
        limits = v.spread_all(limits)

        def body(record: ir.Value, slot: ir.Value, values: list[ir.Value]) -> tuple[list[ir.Value], ir.Value]:
            weight, t, still_open, _ = _step(v, record, x, y, values[0], limits)
            pointer = v.at(weights, builder.mul(slot, ir.Constant(_I64, LANES)))
            v.store(v.add(v.load(pointer), weight), pointer)
            return [t], still_open

        after, alive = _loop(v, chunk, listed, count, [v.load(v.at(state, offset))], body)
        v.store(after[0], v.at(state, offset))
        return alive

    return signature, generate


@intrinsic
def lane_sum(typing_context: Any, weights: Any, slot: Any) -> Any:
    """Sum of row `slot` of `weights` `[CHUNK, LANES]`, always in the same order: halves, quarters and so on.

    A plain loop may be reordered, and LLVM keeps two versions of it and picks one by the addresses of its arrays.
    """

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = _Lanes(builder)
        base = _data(context, builder, signature, arguments, 0)
        row = v.load(v.at(base, builder.mul(arguments[1], ir.Constant(_I64, LANES))))
        half = LANES // 2
        while half:
            row = v.add(v.pick(row, row, range(half)), v.pick(row, row, range(half, 2 * half)))
            half //= 2
        return builder.extract_element(row, ir.Constant(_I32, 0))

    return types.float32(weights, types.int64), generate


def _pixels(v: _Lanes, x: ir.Value, y: ir.Value) -> tuple[ir.Value, ir.Value]:
    """Pixel centres of the block with its corner at (x, y)."""
    columns = v.constant([i % BLOCK_WIDTH + 0.5 for i in range(LANES)])
    rows = v.constant([i // BLOCK_WIDTH + 0.5 for i in range(LANES)])
    return v.add(v.spread(x), columns), v.add(v.spread(y), rows)


@intrinsic
def store_block(
    typing_context: Any, state: Any, offset: Any, rgb: Any, alpha: Any, depth: Any, group: Any, pixel: Any, width: Any,
    red: Any, green: Any, blue: Any,
) -> Any:  # fmt: skip
    """Write the block whose state begins at `offset` to the image, its first pixel at index `pixel` of rows of `width`,
    over a background colour."""
    i, f = types.int64, types.float32
    signature = types.void(state, i, rgb, alpha, depth, group, i, i, f, f, f)

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = _Lanes(builder)
        state, rgb, alpha, depth, group = (_data(context, builder, signature, arguments, n) for n in (0, 2, 3, 4, 5))
        offset, pixel, width = arguments[1], arguments[6], arguments[7]
        r, g, b, z, rest = (v.load(v.at(state, offset, channel * LANES)) for channel in range(1, 6))
        winner = v.load(v.at(state, offset, WINNER), _INTEGERS)
        cover = v.sub(v.same(1), rest)
        z = builder.select(v.less(v.same(0), cover), builder.fdiv(z, cover), v.same(0))
        r, g, b = (v.add(x, v.mul(rest, v.spread(c))) for x, c in zip((r, g, b), arguments[8:], strict=True))
        for row in range(BLOCK_HEIGHT):
            start = builder.add(pixel, builder.mul(width, ir.Constant(_I64, row)))
            for target, value in ((alpha, cover), (depth, z), (group, winner)):
                v.store(v.pick(value, value, range(row * BLOCK_WIDTH, (row + 1) * BLOCK_WIDTH)), v.at(target, start))
            lanes = range(row * BLOCK_WIDTH, (row + 1) * BLOCK_WIDTH)
            red_green = v.pick(r, g, [k for lane in lanes for k in (lane, lane + LANES)])
            order = [k for n, lane in enumerate(lanes) for k in (2 * n, 2 * n + 1, LANES + lane)]
            v.store(v.pick(red_green, b, order), v.at(rgb, builder.mul(start, ir.Constant(_I64, 3))))
        return context.get_dummy_value()

    return signature, generate


def _loop(v: _Lanes, chunk: Any, listed: Any, count: Any, before: list[ir.Value], body: Any) -> Any:
    """Run `body` over listed records until none is left or no pixel is open; the state stays in registers.

    Returns the state after the loop and whether a pixel is open (int64).
    """
    b = v.b
    entry, head, done = b.block, b.append_basic_block("each"), b.append_basic_block("done")
    zero, one = ir.Constant(_I64, 0), ir.Constant(_I64, 1)
    b.branch(head)
    b.position_at_end(head)
    index = b.phi(_I64)
    index.add_incoming(zero, entry)
    state = [b.phi(value.type) for value in before]
    slot = b.zext(b.load(b.gep(listed, [index])), _I64)
    record = b.gep(chunk, [b.mul(slot, ir.Constant(_I64, RECORD))])
    after, still_open = body(record, slot, state)
    following = b.add(index, one)
    index.add_incoming(following, head)
    for phi, first, later in zip(state, before, after, strict=True):
        phi.add_incoming(first, entry)
        phi.add_incoming(later, head)
    alive = b.icmp_unsigned("!=", v.bits(still_open), zero)
    b.cbranch(b.and_(alive, b.icmp_signed("<", following, count)), head, done)
    b.position_at_end(done)
    return after, b.zext(alive, _I64)

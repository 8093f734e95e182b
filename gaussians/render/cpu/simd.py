"""SIMD kernels that blend footprints into a block of 4x4 pixels.

The loop-carried dependency from one footprint to the next is a single multiplication: the running transmittance keeps
falling in a finished pixel, and a comparison with the least transmittance masks all weights there; the last value
above that threshold is stored separately. `exp(-8 q)` is the eighth power of a degree-5 polynomial in q: three
squarings, no bit tricks, relative error below 1e-6.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types

from ...compiled import intrinsic
from .lanes import F32, I32, I64, INTEGERS, LANES, Lanes, pointer_to
from .layout import BLUE, DEPTH, GREEN, GROUP, L1, L2, L3, RECORD, RED, SHIFT, X, Y
from .touch import BLOCK_HEIGHT, BLOCK_WIDTH

# A block's state: running transmittance, red, green, blue, depth, final transmittance, largest weight and the bits of
# its group.
CHANNELS = 8
REST, WINNER = 5 * LANES, 7 * LANES
STATE = CHANNELS * LANES
T_FLOOR = 1e-30  # lower bound of the running transmittance: denormal numbers are slow

# exp(-q) on [0, 0.693] = [0, Q_MAX], minimax in the relative error (Lawson's iteration), ascending powers.
EXP_COEFFICIENTS = (0.99999994, -0.9999929, 0.49988723, -0.16599411, 0.039808128, -0.0058686733)


def exp_minus_8(v: Lanes, q: ir.Value) -> ir.Value:
    """`exp(-8 q)` for q in [0, Q_MAX]; outside, a meaningless value that is not NaN."""
    e = v.same(EXP_COEFFICIENTS[-1])
    for coefficient in EXP_COEFFICIENTS[-2::-1]:
        e = v.add(v.mul(e, q), v.same(coefficient))
    for _ in range(3):
        e = v.mul(e, e)
    return e


def footprint(v: Lanes, record: ir.Value, x: ir.Value, y: ir.Value, limits: list[ir.Value]) -> Any:
    """Evaluate one footprint in 16 pixels.

    Returns:
        alpha, the two terms of its exponent before squaring, and a function that reads a field of the record.
    """

    def field(place: int, kind: ir.Type = F32) -> ir.Value:
        return v.spread(v.load(v.b.gep(record, [ir.Constant(I64, place)]), kind))

    alpha_max, _, q_max = limits
    along = v.add(v.mul(field(L1), x), v.add(v.mul(field(L2), y), field(X)))
    across = v.add(v.mul(field(L3), y), field(Y))
    q = v.add(v.mul(along, along), v.add(v.mul(across, across), field(SHIFT)))
    alpha = v.min(exp_minus_8(v, q), alpha_max)
    return v.b.select(v.b.fcmp_ordered("<=", q, q_max), alpha, v.same(0)), along, across, field


def transmit(v: Lanes, t: ir.Value, alpha: ir.Value, t_min: ir.Value) -> tuple[ir.Value, ir.Value]:
    """Transmittance behind a footprint, and the mask of pixels that are not finished there."""
    behind = v.max(v.mul(t, v.sub(v.same(1), alpha)), v.same(T_FLOOR))
    return behind, v.less(t_min, behind)


def _step(v: Lanes, record: ir.Value, x: ir.Value, y: ir.Value, t: ir.Value, limits: list[ir.Value]) -> Any:
    """Evaluate one footprint in 16 pixels: weight, new transmittance, mask of unfinished pixels, reader of fields."""
    alpha, _, _, field = footprint(v, record, x, y, limits)
    behind, unfinished = transmit(v, t, alpha, limits[1])
    return v.b.select(unfinished, v.mul(t, alpha), v.same(0)), behind, unfinished, field


@intrinsic
def blend_block(
    typing_context: Any, chunk: Any, slots: Any, state: Any, offset: Any, x: Any, y: Any, limits: Any
) -> Any:
    """Blend the records of `chunk` whose bits are set in `slots`, at least one, into the block whose state begins at
    `offset`.

    (x, y) is the block's corner in the tile, `limits` the tuple that `_step` takes. Returns whether any pixel is
    unfinished.
    """
    return _blending(chunk, slots, state, limits, groups=True)


@intrinsic
def blend_block_alone(
    typing_context: Any, chunk: Any, slots: Any, state: Any, offset: Any, x: Any, y: Any, limits: Any
) -> Any:
    """As `blend_block`, without looking for the group of the largest weight."""
    return _blending(chunk, slots, state, limits, groups=False)


def _blending(chunk: Any, slots: Any, state: Any, limits: Any, groups: bool) -> Any:
    """Signature and code of `blend_block`, with or without its groups."""
    f = types.float32
    signature = types.int64(chunk, types.uint64, state, types.int64, f, f, limits)

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = Lanes(builder)
        chunk, state = (pointer_to(context, builder, signature, arguments, i) for i in (0, 2))
        slots, offset, x, y, limits = (arguments[i] for i in (1, 3, 4, 5, 6))
        x, y = _pixels(v, x, y)
        limits = v.spread_all(limits)
        floats = CHANNELS - 1 if groups else CHANNELS - 2
        before = [v.load(v.at(state, offset, channel * LANES)) for channel in range(floats)]
        if groups:
            before.append(v.load(v.at(state, offset, WINNER), INTEGERS))

        def body(record: ir.Value, slot: ir.Value, values: list[ir.Value]) -> tuple[list[ir.Value], ir.Value]:
            t, *sums, rest = values[: CHANNELS - 2]
            weight, t, unfinished, field = _step(v, record, x, y, t, limits)
            rest = builder.select(unfinished, t, rest)
            places = (RED, GREEN, BLUE, DEPTH)
            sums = [v.add(total, v.mul(weight, field(p))) for total, p in zip(sums, places, strict=True)]
            found = [t, *sums, rest]
            if groups:
                best, winner = values[CHANNELS - 2 :]
                heavier = v.less(best, weight)
                winner = builder.select(heavier, field(GROUP, I32), winner)
                found += [builder.select(heavier, weight, best), winner]
            return found, unfinished

        after, alive = _loop(v, chunk, slots, before, body)
        for channel, value in enumerate(after):
            v.store(value, v.at(state, offset, channel * LANES))
        return alive

    return signature, generate


@intrinsic
def weigh_block(
    typing_context: Any, chunk: Any, slots: Any, state: Any, offset: Any, weights: Any, x: Any, y: Any, limits: Any
) -> Any:
    """As `blend_block`, but add each footprint's weights to its row of `weights` `[CHUNK, LANES]`, not to colours."""
    f = types.float32
    signature = types.int64(chunk, types.uint64, state, types.int64, weights, f, f, limits)

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = Lanes(builder)
        chunk, state, weights = (pointer_to(context, builder, signature, arguments, i) for i in (0, 2, 4))
        slots, offset, x, y, limits = (arguments[i] for i in (1, 3, 5, 6, 7))
        x, y = _pixels(v, x, y)
        limits = v.spread_all(limits)

        def body(record: ir.Value, slot: ir.Value, values: list[ir.Value]) -> tuple[list[ir.Value], ir.Value]:
            weight, t, unfinished, _ = _step(v, record, x, y, values[0], limits)
            pointer = v.at(weights, builder.mul(slot, ir.Constant(I64, LANES)))
            v.store(v.add(v.load(pointer), weight), pointer)
            return [t], unfinished

        after, alive = _loop(v, chunk, slots, [v.load(v.at(state, offset))], body)
        v.store(after[0], v.at(state, offset))
        return alive

    return signature, generate


def _pixels(v: Lanes, x: ir.Value, y: ir.Value) -> tuple[ir.Value, ir.Value]:
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
        v = Lanes(builder)
        state, rgb, alpha, depth, group = (
            pointer_to(context, builder, signature, arguments, n) for n in (0, 2, 3, 4, 5)
        )
        offset, pixel, width = arguments[1], arguments[6], arguments[7]
        r, g, b, z, rest = (v.load(v.at(state, offset, channel * LANES)) for channel in range(1, 6))
        winner = v.load(v.at(state, offset, WINNER), INTEGERS)
        cover = v.sub(v.same(1), rest)
        z = builder.select(v.less(v.same(0), cover), builder.fdiv(z, cover), v.same(0))
        r, g, b = (v.add(x, v.mul(rest, v.spread(c))) for x, c in zip((r, g, b), arguments[8:], strict=True))
        for row in range(BLOCK_HEIGHT):
            start = builder.add(pixel, builder.mul(width, ir.Constant(I64, row)))
            for target, value in ((alpha, cover), (depth, z), (group, winner)):
                v.store(v.pick(value, value, range(row * BLOCK_WIDTH, (row + 1) * BLOCK_WIDTH)), v.at(target, start))
            lanes = range(row * BLOCK_WIDTH, (row + 1) * BLOCK_WIDTH)
            pairs = [k for lane in lanes for k in (lane, lane + LANES)]
            red_green = v.pick(r, g, (pairs * LANES)[:LANES])
            order = [k for n, lane in enumerate(lanes) for k in (2 * n, 2 * n + 1, LANES + lane)]
            v.store(v.pick(red_green, b, order), v.at(rgb, builder.mul(start, ir.Constant(I64, 3))))
        return context.get_dummy_value()

    return signature, generate


def _loop(v: Lanes, chunk: Any, slots: Any, before: list[ir.Value], body: Any) -> Any:
    """Run `body` over the records of `slots` until none is left or all pixels are finished; the state stays in
    registers.

    Returns the state after the loop and whether a pixel is unfinished (int64).
    """
    b = v.b
    entry, head, done = b.block, b.append_basic_block("each"), b.append_basic_block("done")
    zero, one = ir.Constant(I64, 0), ir.Constant(I64, 1)
    b.branch(head)
    b.position_at_end(head)
    left = b.phi(I64)
    left.add_incoming(slots, entry)
    state = [b.phi(value.type) for value in before]
    slot = b.cttz(left, ir.Constant(ir.IntType(1), 1))
    record = b.gep(chunk, [b.mul(slot, ir.Constant(I64, RECORD))])
    after, unfinished = body(record, slot, state)
    rest = b.and_(left, b.sub(left, one))
    left.add_incoming(rest, head)
    for phi, first, later in zip(state, before, after, strict=True):
        phi.add_incoming(first, entry)
        phi.add_incoming(later, head)
    alive = b.icmp_unsigned("!=", v.bits(unfinished), zero)
    b.cbranch(b.and_(alive, b.icmp_unsigned("!=", rest, zero)), head, done)
    b.position_at_end(done)
    return after, b.zext(alive, I64)

"""SIMD kernel of the backward pass of blending: from the gradient of 16 pixels to that of a footprint.

Footprints are visited front to back, in the order of the forward pass. The colour behind a footprint is the final
colour of the pixel minus what has been blended so far, so of the forward pass only the final image has to be stored.
With g the gradient of a pixel's colour, w = alpha T a weight and S the part of `g . colour` from behind the footprint,
`d alpha = T (g . c) - S / (1 - alpha)` (Kerbl et al. 2023, whose kernel goes back to front).
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types

from ...compiled import intrinsic
from .lanes import I32, I64, LANES, Lanes, pointer_to
from .layout import BLUE, GREEN, RECORD, RED
from .simd import footprint, transmit

# A block's state: transmittance, the remaining `g . colour` from behind, gradient of red, green and blue, and x and y
# of the pixels from the tile's corner.
CHANNELS = 7
STATE = CHANNELS * LANES
# Sums over a footprint's pixels. With e and f the gradients of the two squared terms of its exponent, and x, y from the
# tile's corner: e, e x, e y, f, f y, gradient of the shift, of red, green and blue.
SUMS = 9
(SUM_E, SUM_EX, SUM_EY, SUM_F, SUM_FY, SUM_SHIFT, SUM_RED, SUM_GREEN, SUM_BLUE) = range(SUMS)


@intrinsic
def blend_blocks_backward(
    typing_context: Any, chunk: Any, slot: Any, blocks: Any, state: Any, sums: Any, limits: Any
) -> Any:
    """Process record `slot` of `chunk` in the blocks of a tile whose bits are set in `blocks`, at least one.

    Writes the sums over its pixels into `sums` `[LANES]`, advances each block's state behind it, and returns the bits
    of the blocks in which any pixel is unfinished.
    """
    signature = types.int64(chunk, types.int64, types.int64, state, sums, limits)

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        v = Lanes(builder)
        chunk, state, sums = (pointer_to(context, builder, signature, arguments, i) for i in (0, 3, 4))
        record = v.at(chunk, builder.mul(arguments[1], ir.Constant(I64, RECORD)))
        limits = v.spread_all(arguments[5])
        entry, head, done = builder.block, builder.append_basic_block("block"), builder.append_basic_block("summed")
        zero, one = ir.Constant(I64, 0), ir.Constant(I64, 1)
        builder.branch(head)
        builder.position_at_end(head)
        left, unfinished = builder.phi(I64), builder.phi(I64)
        totals = [builder.phi(v.same(0).type) for _ in range(SUMS)]
        block = builder.cttz(left, ir.Constant(ir.IntType(1), 1))
        added, alive = _in_block(v, record, block, state, limits)
        after = [v.add(total, more) for total, more in zip(totals, added, strict=True)]
        open_after = builder.or_(unfinished, builder.shl(alive, block))
        rest = builder.and_(left, builder.sub(left, one))
        for phi, first, later in [
            (left, arguments[2], rest), (unfinished, zero, open_after),
            *((phi, v.same(0), total) for phi, total in zip(totals, after, strict=True)),
        ]:  # fmt: skip
            phi.add_incoming(first, entry)
            phi.add_incoming(later, builder.block)
        builder.cbranch(builder.icmp_unsigned("!=", rest, zero), head, done)
        builder.position_at_end(done)
        v.store(_lane_sums(v, after), sums)
        return open_after

    return signature, generate


def _in_block(
    v: Lanes, record: ir.Value, block: ir.Value, state: ir.Value, limits: list[ir.Value]
) -> tuple[list[ir.Value], ir.Value]:
    """The addends of the 16 pixels of one block, and whether (int64) any of them is unfinished; advances the state."""
    b = v.b
    offset = b.mul(block, ir.Constant(I64, STATE))
    t, to_come, *g, x, y = (v.load(v.at(state, offset, channel * LANES)) for channel in range(CHANNELS))
    alpha, along, across, field = footprint(v, record, x, y, limits)
    behind, unfinished = transmit(v, t, alpha, limits[1])
    alpha = b.select(unfinished, alpha, v.same(0))
    weight = v.mul(t, alpha)
    lit = v.mul(g[0], field(RED))
    for channel, place in ((1, GREEN), (2, BLUE)):
        lit = v.add(lit, v.mul(g[channel], field(place)))
    to_come = v.sub(to_come, v.mul(weight, lit))
    d_alpha = v.sub(v.mul(t, lit), b.fdiv(to_come, v.sub(v.same(1), alpha)))
    free = v.less(alpha, limits[0])  # a clamped alpha has no gradient by the exponent
    d_q = b.select(free, v.mul(v.mul(v.same(-8), alpha), d_alpha), v.same(0))
    d_along, d_across = (v.mul(v.add(term, term), d_q) for term in (along, across))
    v.store(behind, v.at(state, offset))
    v.store(to_come, v.at(state, offset, LANES))
    added = [d_along, v.mul(d_along, x), v.mul(d_along, y), d_across, v.mul(d_across, y), d_q]
    alive = b.zext(b.icmp_unsigned("!=", v.bits(unfinished), ir.Constant(I64, 0)), I64)
    return [*added, *(v.mul(weight, channel) for channel in g)], alive


def _lane_sums(v: Lanes, vectors: list[ir.Value]) -> ir.Value:
    """One vector whose lane i is the sum of the lanes of vector i; always added in the same order."""
    size = LANES
    while size > 1:
        half, groups = size // 2, LANES // size
        if len(vectors) % 2:
            vectors = [*vectors, v.same(0)]
        low = [g * size + i for g in range(2 * groups) for i in range(half)]
        vectors = [
            v.add(v.pick(a, b, low), v.pick(a, b, [lane + half for lane in low]))
            for a, b in zip(vectors[::2], vectors[1::2], strict=True)
        ]
        size = half
    assert len(vectors) == 1 and vectors[0].type.count == LANES and I32.width == 32
    return vectors[0]

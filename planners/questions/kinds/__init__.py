"""The kinds of questions that geometry answers, one module each with a `KIND`, in the order in which they are tried."""

from . import (
    color,
    comparison,
    counting,
    distance,
    existence,
    facing,
    identity,
    listing,
    nearest,
    order,
    placed,
    sides,
    size,
    superlative,
    whereabouts,
)

KINDS = (
    *order.KINDS,
    *distance.KINDS,
    *nearest.KINDS,
    *facing.KINDS,
    *whereabouts.KINDS,
    *sides.KINDS,
    *placed.KINDS,
    identity.KIND,
    counting.KIND,
    existence.KIND,
    superlative.KIND,
    color.KIND,
    comparison.KIND,
    size.KIND,
    listing.KIND,
)

"""The kinds of questions that geometry answers, one module each with a `KIND`, in the order in which they are tried."""

from . import color, comparison, counting, existence, identity, listing, size, superlative

KINDS = (
    identity.KIND,
    counting.KIND,
    existence.KIND,
    superlative.KIND,
    color.KIND,
    comparison.KIND,
    size.KIND,
    listing.KIND,
)

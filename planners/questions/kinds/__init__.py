"""The kinds of questions that geometry answers, one module each with a `KIND`, in the order in which they are tried."""

from . import color, counting, existence, size

KINDS = (counting.KIND, existence.KIND, color.KIND, size.KIND)

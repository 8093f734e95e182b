"""The language field: segmentation into groups, a text-aligned vector for each, and queries that select them."""

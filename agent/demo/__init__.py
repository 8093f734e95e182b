"""The demonstration: a furnished room, ten instructions and what they should do."""

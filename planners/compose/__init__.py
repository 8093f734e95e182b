"""From a sentence to a furnished room: what belongs into it, then where it goes (the layout solver)."""

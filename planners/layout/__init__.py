"""The layout solver: things with sizes and wishes to a scene graph. `solve` is its one door."""

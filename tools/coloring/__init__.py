"""Colour as light on a surface: the light of a scene, the materials of a thing, shading, and the maps that recolour."""

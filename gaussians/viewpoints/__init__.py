"""Cameras computed from a scene: coverage views, orbits and keyframe paths."""

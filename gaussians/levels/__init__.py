"""Levels of detail: a tree over a scene, levels made by merging Gaussians, and the choice of a level by distance."""

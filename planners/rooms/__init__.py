"""Rooms as scene graphs: checked, built as Gaussians, read from scenes and used to resolve words."""

"""Photographs with poses: transforms.json, COLMAP models and camera paths."""

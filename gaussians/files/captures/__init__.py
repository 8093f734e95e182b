"""Reads captures (photographs with camera poses: transforms.json, COLMAP models) and camera paths."""

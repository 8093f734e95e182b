"""Contours of a picture, and the hierarchy of regions that they bound."""

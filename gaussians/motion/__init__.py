"""Scenes with time: paths of Gaussians (`motion`), the scene at a time (`at`), boxes of groups over time (`boxes`)."""

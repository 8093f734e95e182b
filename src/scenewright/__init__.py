"""Scenewright: edit, build and question 3D Gaussian Splatting scenes in plain words."""

__version__ = "0.1.0"

"""Scenes that do not fit into memory: a folder of tiles along a Morton curve, read and edited a few at a time.

`making` writes such a folder from scene files, `store` reads it, `window` takes what an operation needs into an
ordinary scene, `changing` writes back what it changed, `drawing` renders all of it. docs/scale.md describes the folder.
"""

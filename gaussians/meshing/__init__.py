"""Meshes of Gaussians: a scene or a part of it as triangles with a texture (`mesh`), written as .glb."""

from .making import Mesh, check, mesh

__all__ = ["Mesh", "check", "mesh"]

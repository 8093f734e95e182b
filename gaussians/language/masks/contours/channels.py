"""The channels of a picture that contours are found in: colour, and depth and normals where the scene is good there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ....camera import Camera, Render
from ....render import render
from ....scene import Scene
from ....viewpoints.pictures import Picture

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

CHANNELS = 8
MIN_ALPHA = 0.9  # of the render from which its depth counts


def channels(picture: Picture, scene: Scene | None) -> F32:
    """A picture `[8, H, W]` float32.

    RGB in [0, 1]; inverse depth divided by its median in the picture; unit normal in camera axes; 1 where depth and
    normal are known. Depth and normals are 0 where they are not known.

    Args:
        scene: the scene that the picture shows; None to leave depth and normals unknown.
    """
    stack = np.zeros((CHANNELS, *picture.rgb.shape[:2]), np.float32)
    stack[:3] = picture.rgb.transpose(2, 0, 1) / np.float32(255)
    if scene is not None and len(scene.cloud):
        add_geometry(stack, render(scene.cloud, picture.camera), picture.camera)
    return stack


def add_geometry(stack: F32, seen: Render, camera: Camera) -> None:
    """Fill in the channels of depth and normals of `stack`, in place, from a render."""
    depth = seen.depth.cpu().numpy().astype(np.float64)
    known = (seen.alpha.cpu().numpy() >= MIN_ALPHA) & (depth > 0)
    if not known.any():
        return
    inverse = np.where(known, 1 / np.where(known, depth, 1), 0)
    stack[3] = inverse / np.median(inverse[known])
    normals = normals_of(depth, camera)
    known &= (normals != 0).any(axis=-1)
    stack[3] *= known
    stack[4:7] = normals.transpose(2, 0, 1) * known
    stack[7] = known


def normals_of(depth: F64, camera: Camera) -> F32:
    """Unit normals `[H, W, 3]` from depth, in camera axes; zero at the border of the image."""
    y, x = np.mgrid[: camera.height, : camera.width] + 0.5
    points = np.stack([(x - camera.cx) / camera.fx * depth, (y - camera.cy) / camera.fy * depth, depth], axis=-1)
    normals = np.zeros_like(points)
    if min(depth.shape) > 2:
        along, down = points[1:-1, 2:] - points[1:-1, :-2], points[2:, 1:-1] - points[:-2, 1:-1]
        normals[1:-1, 1:-1] = np.cross(along, down)
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    result: F32 = (normals / np.where(length > 0, length, 1)).astype(np.float32)
    return result

"""The channels of a picture that contours are found in: colour, and of a render depth and normals."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ....camera import Camera, Render
from ....viewpoints.pictures import Picture

F32 = NDArray[np.float32]

CHANNELS = 8
NEAREST = 8.0  # largest relative inverse depth
MIN_ALPHA = 0.9  # of the render from which its depth counts


def channels(picture: Picture) -> F32:
    """A picture `[8, H, W]` float32.

    RGB in [0, 1]; inverse depth divided by its median in the picture; unit normal in camera axes, towards the camera; 1
    where depth and normal are known. Depth and normals are 0 where they are not known, as in a photograph: geometry has
    its own say in the segmentation, and photographs show borders that it lacks, such as of a stand on a cloth.
    """
    stack = np.zeros((CHANNELS, *picture.rgb.shape[:2]), np.float32)
    stack[:3] = picture.rgb.transpose(2, 0, 1) / np.float32(255)
    if picture.seen is not None:
        add_geometry(stack, picture.seen, picture.camera)
    return stack


def add_geometry(stack: F32, seen: Render, camera: Camera) -> None:
    """Fill in the channels of depth and normals of `stack`, in place, from a render."""
    depth = seen.depth.cpu().numpy().astype(np.float64)
    known = (seen.alpha.cpu().numpy() >= MIN_ALPHA) & (depth > 0)
    if not known.any():
        return
    inverse = np.where(known, 1 / np.where(known, depth, 1), 0)
    stack[3] = np.minimum(inverse / np.median(inverse[known]), NEAREST)
    normals = normals_of(depth, camera)
    known &= (normals != 0).any(axis=-1)
    stack[3] *= known
    stack[4:7] = normals.transpose(2, 0, 1) * known
    stack[7] = known


def normals_of(depth: NDArray[np.floating], camera: Camera) -> F32:
    """Unit normals `[H, W, 3]` from depth, in camera axes, towards the camera; zero where there is no direction."""
    y, x = np.mgrid[: camera.height, : camera.width].astype(np.float32) + np.float32(0.5)
    z = depth.astype(np.float32)
    points = np.stack([(x - camera.cx) / camera.fx * z, (y - camera.cy) / camera.fy * z, z], axis=-1).astype(np.float32)
    if min(z.shape) < 2:
        return np.zeros_like(points)
    normals = np.cross(np.gradient(points, axis=0), np.gradient(points, axis=1))
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    away = (normals * points).sum(axis=-1, keepdims=True) > 0
    result: F32 = (np.where(away, -normals, normals) / np.where(length > 0, length, 1)).astype(np.float32)
    return result

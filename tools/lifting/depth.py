"""Depth in the hole of a picture, and Gaussians for its pixels."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from scipy import ndimage, sparse
from scipy.sparse.linalg import spsolve
from scipy.spatial import cKDTree

from ...gaussians.camera import Camera
from ...gaussians.cloud import GaussianCloud
from ...gaussians.harmonics import color_to_dc
from ...gaussians.rotations import from_matrix
from ..filling.new_rows import FLAT, OPACITY
from .target import F32, Mask

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

MOST_SEEDS = 12_000  # Gaussians of one view
_EDGE = 0.06  # difference of neighbouring pixels, display space, at which depth hardly goes on
_LEAST = 0.02  # of a link across an edge
_SMOOTH = 2.0  # px over which the direction of a surface is taken
_STEP = 0.06  # relative change of depth from pixel to pixel that is a step, not a slope
_STRETCH = 4.0  # by which a Gaussian on a slope is longer than it looks, at most
_COVER = 0.75  # standard deviation of a new Gaussian, in pixels between two of them


def continued_depth(depth: F64, known: Mask, hole: Mask, guide: F32, nearest: F64) -> F64:
    """The depth `[H, W]`, continued into a hole so that it bends where the picture has edges.

    The inverse depth is the solution of a weighted Laplace equation, whose links are weak across edges (the idea of
    Levin, Lischinski and Weiss 2004, for colours).

    Args:
        known: where the depth is known, disjoint from `hole`.
        guide: `[H, W, 3]`, the picture with the hole filled.
        nearest: `[H, W]`, the least depth: that of what was there.
    """
    out = depth.copy()
    area, count = ndimage.label(hole | known)
    reached = hole & np.isin(area, np.unique(area[known])) if count and known.any() else np.zeros_like(hole)
    if reached.any():
        out[reached] = 1 / np.maximum(_solved(1 / np.maximum(depth, 1e-9), known, reached, guide)[reached], 1e-9)
    rest = hole & ~reached
    if rest.any():
        out[rest] = float(np.median(out[known | reached])) if (known | reached).any() else nearest[rest].max()
    out[hole] = np.maximum(out[hole], nearest[hole])
    return out


def _solved(values: F64, known: Mask, unknown: Mask, guide: F32) -> F64:
    number = np.full(known.shape, -1, np.int64)
    number[unknown] = np.arange(int(unknown.sum()))
    count = int(unknown.sum())
    degree, right = np.full(count, 1e-12), np.zeros(count)
    rows, columns, links = list[I64](), list[I64](), list[F64]()
    for a, b in ((np.s_[:-1], np.s_[1:]), (np.s_[:, :-1], np.s_[:, 1:])):
        off = np.abs(guide[a] - guide[b]).mean(axis=2)
        weight = np.maximum(np.exp(-((off / _EDGE) ** 2)), _LEAST)
        for here, there in ((a, b), (b, a)):
            mine, inner, outer = unknown[here], unknown[here] & unknown[there], unknown[here] & known[there]
            linked = weight * (inner | outer)
            np.add.at(degree, number[here][mine], linked[mine])
            np.add.at(right, number[here][outer], (weight * values[there])[outer])
            rows.append(number[here][inner])
            columns.append(number[there][inner])
            links.append(-weight[inner])
    place = np.concatenate([*rows, np.arange(count)]), np.concatenate([*columns, np.arange(count)])
    table = sparse.csc_matrix((np.concatenate([*links, degree]), place), shape=(count, count))
    out = values.copy()
    out[unknown] = spsolve(table, right)
    return out


def seeds(camera: Camera, rgb: F32, depth: F64, pixels: Mask, like: GaussianCloud) -> GaussianCloud:
    """Gaussians for some pixels, one for each, or one for several of them where these are many.

    They lie flat on the surface that the depth forms; across its steps they face the camera.

    Args:
        rgb: `[H, W, 3]`, their colours.
        depth: `[H, W]`, their depth; that of other pixels tells how the surface lies.
        pixels: `[H, W]`, where.
        like: Gaussians around; each new one joins the group of the nearest, and has as many harmonics.
    """
    step = max(1, int(np.ceil(np.sqrt(pixels.sum() / MOST_SEEDS))))
    chosen = np.zeros_like(pixels)
    chosen[step // 2 :: step, step // 2 :: step] = True
    y, x = np.nonzero(chosen & pixels)
    local = points_at(camera, depth)
    normal = _normals(local, depth)[y, x]
    local = local[y, x]
    turn = camera.world_to_camera[:3, :3]
    means = torch.from_numpy((local @ turn + camera.position).astype(np.float32))
    frames, stretch = _frames(local, normal)
    side = _COVER * step * local[:, 2] / camera.fx
    scales = np.stack([side, side * stretch, FLAT * side], axis=1).astype(np.float32)
    quats = from_matrix(torch.from_numpy(np.ascontiguousarray(turn.T @ frames, dtype=np.float32)))
    smooth = ndimage.uniform_filter(rgb, (step, step, 1)) if step > 1 else rgb
    sh = torch.zeros(len(y), like.sh.shape[1], 3)
    sh[:, 0] = color_to_dc(torch.from_numpy(np.ascontiguousarray(smooth[y, x], dtype=np.float32)))
    made = GaussianCloud.create(
        means, torch.nn.functional.normalize(quats, dim=1), torch.from_numpy(scales), torch.full((len(y),), OPACITY),
        sh, _groups(means, like),
    )  # fmt: skip
    return made.to(like.device)


def points_at(camera: Camera, depth: F64) -> F64:
    """`[H, W, 3]`, the points of pixels in the camera's axes."""
    y, x = np.mgrid[0 : camera.height, 0 : camera.width]
    return np.stack(
        [(x + 0.5 - camera.cx) / camera.fx * depth, (y + 0.5 - camera.cy) / camera.fy * depth, depth], axis=2
    )


def _normals(points: F64, depth: F64) -> F64:
    """`[H, W, 3]` unit, towards the camera: of the surface, or against the view where its depth steps."""
    smooth = np.stack([ndimage.gaussian_filter(points[..., k], _SMOOTH) for k in range(3)], axis=2)
    normal = np.cross(np.gradient(smooth, axis=1), np.gradient(smooth, axis=0))
    length = np.linalg.norm(normal, axis=2, keepdims=True)
    ray = -points / np.maximum(np.linalg.norm(points, axis=2, keepdims=True), 1e-12)
    normal = np.where(length > 0, normal / np.maximum(length, 1e-300), ray)
    normal *= np.where((normal * ray).sum(axis=2, keepdims=True) < 0, -1.0, 1.0)
    steps = ndimage.generic_gradient_magnitude(np.log(np.maximum(depth, 1e-9)), ndimage.sobel) / 8
    flat = (normal * ray).sum(axis=2) > 1 / _STRETCH
    return np.where((flat & (steps < _STEP))[..., None], normal, ray)


def _frames(points: F64, normal: F64) -> tuple[F64, F64]:
    """Axes of Gaussians as columns `[M, 3, 3]`, the second along the slope and the third the normal, and by what the
    second is longer than seen, `[M]`."""
    ray = points / np.maximum(np.linalg.norm(points, axis=1, keepdims=True), 1e-12)
    cosine = np.clip(-(ray * normal).sum(axis=1), 1 / _STRETCH, 1.0)
    slope = ray + normal * -(ray * normal).sum(axis=1, keepdims=True)
    length = np.linalg.norm(slope, axis=1, keepdims=True)
    across = np.cross(normal, np.eye(3)[np.abs(normal).argmin(axis=1)])
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    slope = np.where(length > 1e-3, slope / np.maximum(length, 1e-12), across)
    return np.stack([np.cross(slope, normal), slope, normal], axis=2), 1 / cosine


def _groups(means: torch.Tensor, like: GaussianCloud) -> torch.Tensor:
    """`[M]` int32, group of the nearest of some Gaussians; -1 without any."""
    if not len(like) or not len(means):
        return torch.full((len(means),), -1, dtype=torch.int32)
    _, near = cKDTree(like.means.cpu().numpy()).query(means.numpy())
    return like.group.cpu()[torch.from_numpy(near)].to(torch.int32)

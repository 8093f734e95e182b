"""Fewer Gaussians: cutting a scene out of its surroundings, and keeping those that pictures are made of.

Knows clouds, cameras and blending weights. Refuses to know files and words.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray

from .camera import Camera, Vec3
from .cloud import GaussianCloud
from .errors import UserError
from .render import contributions, render
from .scene import Scene

BEST_PSNR = 120.0  # dB, where equal pictures are capped


def crop_box(scene: Scene, low: Vec3, high: Vec3) -> Scene:
    """The Gaussians whose centres lie in the box between two corners (scene units, world axes, edges included).

    Raises:
        UserError: the corners are in the wrong order, or nothing lies between them.
    """
    if not all(a < b for a, b in zip(low, high, strict=True)):
        raise UserError(f"the box from {low} to {high} is empty; give the lower corner first: x0,y0,z0,x1,y1,z1")
    means = scene.cloud.means
    inside = ((means >= torch.tensor(low)) & (means <= torch.tensor(high))).all(dim=1)
    return _cut(scene, inside, "box")


def crop_sphere(scene: Scene, center: Vec3, radius: float) -> Scene:
    """The Gaussians whose centres lie within `radius` of `center` (scene units).

    Raises:
        UserError: the radius is not positive, or nothing lies within it.
    """
    if not radius > 0:
        raise UserError(f"a sphere needs a positive radius, got {radius}; give x,y,z,radius")
    away = (scene.cloud.means.double() - torch.tensor(center, dtype=torch.float64)).norm(dim=1)
    return _cut(scene, away <= radius, "sphere")


def ranked(cloud: GaussianCloud, cameras: Sequence[Camera]) -> NDArray[np.int64]:
    """Rows of a cloud from the one that matters most to what these cameras see to the least, `[N]`.

    A Gaussian counts by the most that it is of any view, its blending weight summed over pixels
    (`render.contributions`; the maximum over views as in Niemeyer et al. 2024, RadSplat), times its opacity. Sums over
    views, roots of them, and size times opacity without looking lost more on real scenes (see docs/files.md).
    """
    score = np.zeros(len(cloud), np.float32)
    for camera in cameras:
        np.maximum(score, contributions(cloud, camera).numpy(), out=score)
    score *= cloud.opacities.numpy()
    # What no camera sees goes last, the larger and more opaque before the smaller.
    bulk = (cloud.opacities.double().log() + cloud.scales.double().log().sum(dim=1)).numpy()
    return np.lexsort((-bulk, -score))


def most_visible(scene: Scene, most: int, cameras: Sequence[Camera]) -> Scene:
    """The `most` Gaussians that matter most to what these cameras see (`ranked`), in their old order.

    Raises:
        UserError: `most` is not positive, or no camera is given.
    """
    if most < 1:
        raise UserError(f"a scene needs at least one Gaussian, {most} were asked for")
    if len(scene.cloud) <= most:
        return scene
    if not cameras:
        raise UserError("nothing can be seen of this scene, so there is no telling which Gaussians matter; crop it")
    kept = np.sort(ranked(scene.cloud, cameras)[:most])
    return scene.replace(cloud=scene.cloud[torch.from_numpy(kept)])


def psnr(truth: GaussianCloud, other: GaussianCloud, cameras: Sequence[Camera]) -> tuple[float, ...]:
    """PSNR in dB of what each camera sees of `other`, against what it sees of `truth`; at most `BEST_PSNR`."""
    return tuple(_psnr(_picture(truth, camera), _picture(other, camera)) for camera in cameras)


def _cut(scene: Scene, inside: torch.Tensor, what: str) -> Scene:
    if not bool(inside.any()):
        low, high = scene.cloud.means.amin(dim=0).tolist(), scene.cloud.means.amax(dim=0).tolist()
        spans = ", ".join(f"{axis} {a:.4g} to {b:.4g}" for axis, a, b in zip("xyz", low, high, strict=True))
        raise UserError(f"no Gaussian lies in the {what}; the scene spans {spans}")
    return scene.replace(cloud=scene.cloud[inside])


def _picture(cloud: GaussianCloud, camera: Camera) -> NDArray[np.float64]:
    """`[H, W, 3]` as shown, in [0, 1]."""
    return np.clip(render(cloud, camera).rgb.numpy().astype(np.float64), 0, 1)


def _psnr(truth: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    error = float(np.mean((truth - other) ** 2))
    return BEST_PSNR if error == 0 else min(BEST_PSNR, -10 * float(np.log10(error)))

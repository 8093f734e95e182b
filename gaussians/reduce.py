"""Reduces the number of Gaussians of a scene: cropping to a box or sphere, and pruning by contribution to views."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray

from .camera import Camera, Vec3
from .cloud import GaussianCloud
from .errors import UserError
from .motion.at import rows_at
from .motion.motion import with_only
from .render import contributions, render
from .scene import Scene

MAX_PSNR = 120.0  # dB, reported for equal images
_MOMENTS = 4  # of a scene with motion, from its start to its stop, at which its Gaussians are ranked


def crop_box(scene: Scene, low: Vec3, high: Vec3) -> Scene:
    """The Gaussians whose centres lie in the box between two corners (scene units, world axes, edges included).

    Raises:
        UserError: the corners are in the wrong order, or no Gaussian lies between them.
    """
    if not all(a < b for a, b in zip(low, high, strict=True)):
        raise UserError(f"the box from {low} to {high} is empty; give the lower corner first: x0,y0,z0,x1,y1,z1")
    means = scene.cloud.means
    inside = ((means >= torch.tensor(low)) & (means <= torch.tensor(high))).all(dim=1)
    return _cut(scene, inside, "box")


def crop_sphere(scene: Scene, center: Vec3, radius: float) -> Scene:
    """The Gaussians whose centres lie within `radius` of `center` (scene units).

    Raises:
        UserError: the radius is not positive, or no Gaussian lies within it.
    """
    if not radius > 0:
        raise UserError(f"a sphere needs a positive radius, got {radius}; give x,y,z,radius")
    away = (scene.cloud.means.double() - torch.tensor(center, dtype=torch.float64)).norm(dim=1)
    return _cut(scene, away <= radius, "sphere")


def rank_by_contribution(cloud: GaussianCloud, cameras: Sequence[Camera]) -> NDArray[np.int64]:
    """Rows `[N]` of a cloud by their contribution to the views of these cameras, largest first.

    The score of a Gaussian is its blending weight summed over the pixels of a view (`render.contributions`), maximised
    over views (as in Niemeyer et al. 2024, RadSplat), times its opacity. The sum over views, roots of it, and size
    times opacity without rendering lost more on real scenes (see docs/files.md).
    """
    score = np.zeros(len(cloud), np.float32)
    for camera in cameras:
        np.maximum(score, contributions(cloud, camera).numpy(), out=score)
    score *= cloud.opacities.numpy()
    # Gaussians that no camera sees come last, sorted by volume times opacity.
    bulk = (cloud.opacities.double().log() + cloud.scales.double().log().sum(dim=1)).numpy()
    return np.lexsort((-bulk, -score))


def prune(scene: Scene, max_gaussians: int, cameras: Sequence[Camera]) -> Scene:
    """At most `max_gaussians` Gaussians that contribute most to these views (`rank_by_contribution`), in row order; of
    a scene with motion, to these views at some time.

    Raises:
        UserError: `max_gaussians` is not positive, or no camera is given.
    """
    if max_gaussians < 1:
        raise UserError(f"a scene needs at least one Gaussian, {max_gaussians} were asked for")
    if len(scene.cloud) <= max_gaussians:
        return scene
    if not cameras:
        raise UserError("no view shows anything of this scene, so its Gaussians cannot be ranked; crop it instead")
    kept = np.sort(_ranked(scene, cameras)[:max_gaussians])
    return _rows(scene, torch.from_numpy(kept))


def _ranked(scene: Scene, cameras: Sequence[Camera]) -> NDArray[np.int64]:
    """Rows `[N]` by their contribution, largest first; where something moves, by the best rank that they have at some
    time, so that what is hidden at the start (in a closed drawer) is not taken for nothing."""
    motion = scene.motion
    if motion is None:
        return rank_by_contribution(scene.cloud, cameras)
    best = np.full(len(scene.cloud), len(scene.cloud))
    for time in np.linspace(motion.start, motion.stop, _MOMENTS):
        order = rank_by_contribution(rows_at(scene.cloud, motion, float(time))[0], cameras)
        places = np.empty(len(order), np.int64)
        places[order] = np.arange(len(order))
        best = np.minimum(best, places)
    return np.argsort(best, kind="stable")


def psnr(truth: GaussianCloud, other: GaussianCloud, cameras: Sequence[Camera]) -> tuple[float, ...]:
    """PSNR in dB of each camera's view of `other` against its view of `truth`; at most `MAX_PSNR`."""
    return tuple(_psnr(_image(truth, camera), _image(other, camera)) for camera in cameras)


def _cut(scene: Scene, inside: torch.Tensor, what: str) -> Scene:
    if not bool(inside.any()):
        low, high = scene.cloud.means.amin(dim=0).tolist(), scene.cloud.means.amax(dim=0).tolist()
        spans = ", ".join(f"{axis} {a:.4g} to {b:.4g}" for axis, a, b in zip("xyz", low, high, strict=True))
        raise UserError(f"no Gaussian lies in the {what}; the scene spans {spans}")
    return _rows(scene, inside)


def _rows(scene: Scene, rows: torch.Tensor) -> Scene:
    """The scene with some rows alone."""
    cloud = scene.cloud[rows]
    return scene.replace(cloud=cloud, motion=with_only(scene.motion, cloud.ids.cpu().numpy()))


def _image(cloud: GaussianCloud, camera: Camera) -> NDArray[np.float64]:
    """The rendered view `[H, W, 3]`, clipped to [0, 1]."""
    return np.clip(render(cloud, camera).rgb.numpy().astype(np.float64), 0, 1)


def _psnr(truth: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    error = float(np.mean((truth - other) ** 2))
    return MAX_PSNR if error == 0 else min(MAX_PSNR, -10 * float(np.log10(error)))

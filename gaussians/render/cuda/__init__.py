"""The renderer for NVIDIA GPUs: gsplat's CUDA kernels behind the interface that all back ends share.

`splatting` calls gsplat; `heaviest` finds the group of each pixel, which gsplat does not return. Columns are copied to
the device, images back to the device of the cloud. An image has the same bytes every time; contributions and splits
are sums in an order that the device chooses, so they repeat to about 1e-6 only.

How gsplat 1.5.3 (Ye et al. 2025, JMLR 26) differs from `..convention`, read from its kernels:

- The same: pixel centres at +0.5, `DILATION`, `ALPHA_MIN`, `ALPHA_MAX`, `T_MIN` (exclusive), `NEAR`, `FAR`, the margin
  `EDGE` of the tangents, harmonics with 0.5 added and clamped at zero, ties of depth (lower row first), quaternions
  wxyz, OpenCV axes, and what has no gradient (`..differentiable`).
- It uses the device's fast exponential, with an error of about 1e-6 in alpha: a pixel changes by 1e-6, or by up to
  1/255 of a colour where an alpha crosses `ALPHA_MIN`.
- It computes the determinant of a footprint as a difference of products. At 45 degrees the relative error is about
  2e-7 L^2 for a needle L px long (standard deviation) and no wider than the dilation: 0.2 % at 100 px, 20 % at 1000 px.
- It does not check for non-finite values, and it adds the pose's translation in float32, which loses precision far
  from the origin. Therefore non-finite rows get opacity zero, and means are passed relative to the camera position.
- `MAX_DETERMINANT` is applied as a bound on the footprint's width, `splatting.WIDEST`: only footprints of 10^8 px
  differ.
"""

from __future__ import annotations

import weakref

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...camera import Camera, Render, Vec3
from ...cloud import NO_GROUP, GaussianCloud
from ..shares import Split, sum_pairs
from . import splatting
from .heaviest import heaviest_rows
from .splatting import draw, missing, require

__all__ = ["contributions", "draw", "missing", "render", "require", "split"]

LABELS = 32  # labels split in one pass: the number of channels gsplat takes at once

_Columns = tuple[Tensor, Tensor, Tensor, Tensor, Tensor]
_cached: tuple[weakref.ref[GaussianCloud], _Columns] | None = None


@torch.no_grad()
def render(cloud: GaussianCloud, camera: Camera, background: Vec3) -> Render:
    """See `scenewright.gaussians.render.render`.

    The group channel costs more than the other channels, so it is computed only if the cloud has more than one group.
    """
    require()
    if not len(cloud):
        return _empty(cloud, camera, background)
    with splatting.within_memory():
        seen = splatting.rasterize(*_on_device(cloud), camera, background, depth=True)
        rgb, depth = seen.colors[..., :3], seen.colors[..., 3]
        single = bool((cloud.group == cloud.group[0]).all())
        group = cloud.group.to(rgb.device)
        if not single:
            group = group[heaviest_rows(seen, camera.width, camera.height).clamp(min=0)]
        group = torch.where(seen.alpha > 0, group[:1] if single else group, NO_GROUP)
        channels = rgb, seen.alpha, torch.where(seen.alpha > 0, depth, 0), group
        return Render(*(channel.contiguous().to(cloud.device) for channel in channels))


def contributions(cloud: GaussianCloud, camera: Camera) -> Tensor:
    """See `scenewright.gaussians.render.contributions`.

    Computed as a gradient: that of the sum of all pixels of one feature channel by the features.
    """
    require()
    if not len(cloud):
        return torch.zeros(0, device=cloud.device)
    with splatting.within_memory():
        return _weights(cloud, camera, None)[:, 0].to(cloud.device)


def split(cloud: GaussianCloud, camera: Camera, labels: NDArray[np.int32]) -> Split:
    """See `scenewright.gaussians.render.split`. One feature channel a label, sum_pairs over the label's pixels only."""
    require()
    names, place = np.unique(labels, return_inverse=True)
    rows, of, weights = [np.zeros(0, np.int64)], [np.zeros(0, np.int32)], [np.zeros(0, np.float32)]
    with splatting.within_memory():
        for first in range(0, len(names) if len(cloud) else 0, LABELS):
            count = min(LABELS, len(names) - first)
            channel = np.where((place >= first) & (place < first + count), place - first, count)
            mask = torch.nn.functional.one_hot(torch.from_numpy(channel.reshape(labels.shape)), count + 1)[..., :count]
            found = _weights(cloud, camera, mask.float()).cpu()
            row, column = (found > 0).nonzero(as_tuple=True)
            rows.append(row.numpy())
            of.append(names[first + column.numpy()].astype(np.int32))
            weights.append(found[row, column].numpy())
    return sum_pairs(len(cloud), np.concatenate(rows), np.concatenate(of), np.concatenate(weights))


def _weights(cloud: GaussianCloud, camera: Camera, mask: Tensor | None) -> Tensor:
    """`[N, D]` blending weights of each Gaussian, summed over each channel of `mask [H, W, D]`; None: all pixels."""
    means, quats, scales, opacities, _ = _on_device(cloud)
    features = torch.zeros(len(means), 1 if mask is None else mask.shape[2], device=means.device, requires_grad=True)
    seen = splatting.rasterize(means, quats, scales, opacities, features, camera)
    total = seen.colors.sum() if mask is None else (seen.colors * mask.to(means.device)).sum()
    (weights,) = torch.autograd.grad(total, features)
    return weights


def _empty(cloud: GaussianCloud, camera: Camera, background: Vec3) -> Render:
    """The render of a cloud without Gaussians."""
    size, device = (camera.height, camera.width), cloud.device
    group = torch.full(size, NO_GROUP, dtype=torch.int32, device=device)
    rgb = torch.tensor(background, dtype=torch.float32, device=device).repeat(*size, 1)
    return Render(rgb, torch.zeros(size, device=device), torch.zeros(size, device=device), group)


def _on_device(cloud: GaussianCloud) -> _Columns:
    """The columns to render, on the device.

    Those of the last cloud are cached while it is alive, since one cloud is rendered from many cameras. This is safe
    because clouds are never written in place.
    """
    global _cached
    cached = _cached
    if cached is not None and cached[0]() is cloud and cached[1][0].device.type == splatting.DEVICE:
        return cached[1]
    columns = cloud.means, cloud.quats, cloud.scales, cloud.opacities, cloud.sh
    means, quats, scales, opacities, sh = (column.detach().to(splatting.DEVICE).contiguous() for column in columns)
    copied = means, quats, scales, opacities, sh
    _cached = weakref.ref(cloud, _evict), copied
    return copied


def _evict(gone: weakref.ref[GaussianCloud]) -> None:
    """Free the device memory when the cached cloud is garbage-collected."""
    global _cached
    if _cached is not None and _cached[0] is gone:
        _cached = None

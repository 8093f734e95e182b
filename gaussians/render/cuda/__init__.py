"""The renderer for NVIDIA GPUs: gsplat's CUDA kernels behind the same three calls as every other back end.

Knows what of a picture gsplat tells, and how the rest follows from it. Refuses to know gsplat's own call (`splatting`)
and how the heaviest Gaussian of a pixel is found (`heaviest`). Columns are moved to the device, pictures back to where
the cloud lies. A picture has the same bytes every time; contributions and shares are sums whose order the device
chooses, so they repeat to about 1e-6 only.

How gsplat 1.5.3 (Ye et al. 2025, JMLR 26) differs from `..convention`, read from its kernels:

- The same: pixel centres at +0.5, `DILATION`, `ALPHA_MIN`, `ALPHA_MAX`, `T_MIN` (exclusive), `NEAR`, `FAR`, the margin
  `EDGE` of the tangents, harmonics with 0.5 added and clamped at zero, ties of depth (lower row first), quaternions
  wxyz, OpenCV axes, and what has no gradient (`..differentiable`).
- Its exponential is the device's fast one, about 1e-6 of an alpha: a pixel changes by 1e-6, or by up to 1/255 of a
  colour where an alpha falls on the other side of `ALPHA_MIN`.
- Its determinant of a footprint is a difference of products. At 45 degrees it is off by about 2e-7 L^2 of itself for a
  needle L px long (standard deviation) and no wider than the dilation: 0.2 % at 100 px, a fifth at 1000 px.
- It does not look for numbers that are not finite, and adds the pose's translation in float32, which loses digits far
  from the origin. So rows that are not finite get no opacity, and means are given relative to the eye.
- `MAX_DETERMINANT` is kept as a bound on the footprint's width, `splatting.WIDEST`: only footprints of 10^8 px differ.
"""

from __future__ import annotations

import weakref

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...camera import Camera, Render, Vec3
from ...cloud import NO_GROUP, GaussianCloud
from ..shares import Split, summed
from . import splatting
from .heaviest import heaviest_rows
from .splatting import draw, missing, require

__all__ = ["contributions", "draw", "missing", "render", "require", "split"]

LABELS = 32  # of a picture shared out in one pass: the channels gsplat takes at once

_Columns = tuple[Tensor, Tensor, Tensor, Tensor, Tensor]
_kept: tuple[weakref.ref[GaussianCloud], _Columns] | None = None


@torch.no_grad()
def render(cloud: GaussianCloud, camera: Camera, background: Vec3) -> Render:
    """See `scenewright.gaussians.render.render`.

    Groups cost more than the rest of the picture; they are looked for only where the cloud has more than one.
    """
    require()
    if not len(cloud):
        return _empty(cloud, camera, background)
    with splatting.within_memory():
        seen = splatting.rasterize(*_on_device(cloud), camera, background, depth=True)
        rgb, depth = seen.colors[..., :3], seen.colors[..., 3]
        alone = bool((cloud.group == cloud.group[0]).all())
        group = cloud.group.to(rgb.device)
        if not alone:
            group = group[heaviest_rows(seen, camera.width, camera.height).clamp(min=0)]
        group = torch.where(seen.alpha > 0, group[:1] if alone else group, NO_GROUP)
        channels = rgb, seen.alpha, torch.where(seen.alpha > 0, depth, 0), group
        return Render(*(channel.contiguous().to(cloud.device) for channel in channels))


def contributions(cloud: GaussianCloud, camera: Camera) -> Tensor:
    """See `scenewright.gaussians.render.contributions`: the gradient of all pixels' sum by one channel of ones."""
    require()
    if not len(cloud):
        return torch.zeros(0, device=cloud.device)
    with splatting.within_memory():
        return _weights(cloud, camera, None)[:, 0].to(cloud.device)


def split(cloud: GaussianCloud, camera: Camera, labels: NDArray[np.int32]) -> Split:
    """See `scenewright.gaussians.render.split`: one channel a label, of which only the label's own pixels count."""
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
    return summed(len(cloud), np.concatenate(rows), np.concatenate(of), np.concatenate(weights))


def _weights(cloud: GaussianCloud, camera: Camera, mask: Tensor | None) -> Tensor:
    """`[N, D]` blending weight of each Gaussian over the pixels of each channel of `mask [H, W, D]`; None: of all."""
    means, quats, scales, opacities, _ = _on_device(cloud)
    features = torch.zeros(len(means), 1 if mask is None else mask.shape[2], device=means.device, requires_grad=True)
    seen = splatting.rasterize(means, quats, scales, opacities, features, camera)
    total = seen.colors.sum() if mask is None else (seen.colors * mask.to(means.device)).sum()
    (weights,) = torch.autograd.grad(total, features)
    return weights


def _empty(cloud: GaussianCloud, camera: Camera, background: Vec3) -> Render:
    """A picture of nothing."""
    size, device = (camera.height, camera.width), cloud.device
    group = torch.full(size, NO_GROUP, dtype=torch.int32, device=device)
    rgb = torch.tensor(background, dtype=torch.float32, device=device).repeat(*size, 1)
    return Render(rgb, torch.zeros(size, device=device), torch.zeros(size, device=device), group)


def _on_device(cloud: GaussianCloud) -> _Columns:
    """The columns that make pixels, on the device. Those of the cloud asked for last stay there while it lives: a cloud
    is never written in place, and one is drawn from many sides."""
    global _kept
    kept = _kept
    if kept is not None and kept[0]() is cloud and kept[1][0].device.type == splatting.DEVICE:
        return kept[1]
    columns = cloud.means, cloud.quats, cloud.scales, cloud.opacities, cloud.sh
    means, quats, scales, opacities, sh = (column.detach().to(splatting.DEVICE).contiguous() for column in columns)
    there = means, quats, scales, opacities, sh
    _kept = weakref.ref(cloud, _forget), there
    return there


def _forget(gone: weakref.ref[GaussianCloud]) -> None:
    """Give the device's memory back when the cloud is gone."""
    global _kept
    if _kept is not None and _kept[0] is gone:
        _kept = None

"""Colours of a thing as they are seen: pixels of small pictures of it alone, from a few sides.

Many Gaussians of a fitted scene lie inside of things, are black because no photograph saw them, or have wild colours
that cancel in a pixel. A mean over Gaussians counts them; a picture does not.
"""

from __future__ import annotations

import math

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.camera import Camera
from ...gaussians.cloud import GaussianCloud
from ...gaussians.color import rgb_to_lab
from ...gaussians.language.field.measure import Sample, sample
from ...gaussians.language.segmentation.group_renders import cameras_around
from ...gaussians.render import render
from ...gaussians.scene import Scene
from ..color_map import LUMA

VIEWS = 3
PIXELS = 80  # side of a picture
_INSIDE = 0.5  # alpha of a pixel inside an outline
_SOLID = 0.8  # alpha of a pixel that shows the thing and not what is behind it
_MOST = 6000  # Gaussians that are rendered
_FEWEST = 32  # pixels, or the Gaussians themselves are sampled
_LIT = (0.45, 0.95)  # quantiles of luma between which the lit faces are: without shadows and highlights


def seen_pixels(cloud: GaussianCloud, scene: Scene, views: int = VIEWS, pixels: int = PIXELS) -> Tensor:
    """`[P, 3]` float64 display colours of the pixels that show a cloud rendered alone; P may be 0."""
    if not len(cloud):
        return torch.zeros(0, 3, dtype=torch.float64)
    cloud = few_of(cloud, torch.arange(len(cloud))) if len(cloud) > _MOST else cloud
    found = []
    for camera in _around(cloud, scene, pixels, views):
        seen = render(cloud, camera)
        solid = seen.alpha > _SOLID
        found.append((seen.rgb[solid] / seen.alpha[solid][:, None]).clamp(0, 1).double())
    return torch.cat(found)


def _around(cloud: GaussianCloud, scene: Scene, pixels: int, views: int) -> list[Camera]:
    """Cameras that see a cloud of a scene alone from a few sides, towards the middle of the scene first."""
    return cameras_around(cloud.means.double().numpy(), scene.frame, middle_of(scene), pixels, views)


def middle_of(scene: Scene) -> NDArray[np.float64]:
    """`[3]` the middle of a scene's things; the origin where none are known."""
    return scene.language.middle if scene.language is not None else np.zeros(3)


def few_of(cloud: GaussianCloud, rows: Tensor) -> GaussianCloud:
    """Some rows `[M]` of a cloud; of many an evenly spaced sample, grown so that it covers the same area."""
    if len(rows) <= _MOST:
        return cloud[rows]
    few = cloud[rows[torch.linspace(0, len(rows) - 1, _MOST).long()]]
    return few.replace(scales=few.scales * math.sqrt(len(rows) / _MOST))


def seen_colors(scene: Scene, rows: Tensor) -> Sample:
    """The seen colours of some rows `[M]` of a scene's cloud; those of the Gaussians where too little is solid."""
    step = max(1, len(rows) // _MOST)
    cloud = scene.cloud[rows[::step]]
    rgb = seen_pixels(cloud.replace(scales=cloud.scales * math.sqrt(step)), scene)
    if len(rgb) < _FEWEST:
        return sample(scene.cloud, rows)
    return Sample(rgb, torch.full((len(rgb),), 1 / len(rgb), dtype=torch.float64))


def lit_color(colors: Sample) -> Tensor:
    """`[3]` mean display colour of the lit faces, after which people name a colour."""
    luma = colors.rgb @ torch.tensor(LUMA, dtype=torch.float64)
    order = luma.argsort()
    total = colors.weight[order].cumsum(dim=0)
    low, high = (q * float(total[-1]) for q in _LIT)
    lit = order[(total >= low) & (total <= high)]
    if not len(lit):
        lit = order[torch.searchsorted(total, torch.tensor([low], dtype=total.dtype)).clamp(max=len(order) - 1)]
    weight = colors.weight[lit]
    mean: Tensor = (weight[:, None] * colors.rgb[lit]).sum(dim=0) / weight.sum().clamp(min=1e-30)
    return mean


def lit_face(colors: Sample) -> Tensor:
    """`[3]` CIE Lab of `lit_color`."""
    return rgb_to_lab(lit_color(colors).clamp(0, 1))


def outline_difference(was: GaussianCloud, now: GaussianCloud, scene: Scene) -> float:
    """Area by which the outlines of two clouds differ, relative to that of the first, in small pictures of each alone
    from a few sides: the same cameras, those of the first."""
    apart = area = 0.0
    for camera in _around(was, scene, PIXELS, VIEWS):
        old, new = (render(cloud, camera).alpha for cloud in (was, now))
        apart += float(((old > _INSIDE) != (new > _INSIDE)).sum())
        area += float((old > _INSIDE).sum())
    return apart / max(area, 1.0)

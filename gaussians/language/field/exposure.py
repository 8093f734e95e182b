"""The exposure of a scene: a dim one is shown brighter to what learnt from lit pictures; its own colours stay."""

from __future__ import annotations

import torch

from ...cloud import GaussianCloud
from ...color import LUMA
from ...harmonics import SH_C0
from ..segmentation.surface import MIN_OPACITY

BRIGHT = 0.95  # quantile of the luma of visible Gaussians that tells how bright a scene is
DIM = 0.35  # a scene whose bright parts are below this is dim: captures by day have .8, a room at .4 of its light .34
LIT = 0.7  # where the bright parts of a dim scene are put
MOST = 16.0  # gain of a scene in which hardly anything can be seen
_SAMPLE = 1 << 16


def gain_of(cloud: GaussianCloud) -> float:
    """How many times brighter a scene is to be shown: 1 unless it is dim."""
    part = cloud[torch.arange(0, len(cloud), max(1, len(cloud) // _SAMPLE))]
    luma = (part.sh[part.opacities > MIN_OPACITY][:, 0] * SH_C0 + 0.5).clamp(0, 1) @ torch.tensor(LUMA)
    luma = luma[luma.isfinite()]
    if not len(luma):
        return 1.0
    bright = float(luma.quantile(BRIGHT))
    return min(LIT / max(bright, LIT / MOST), MOST) if bright < DIM else 1.0


def exposed(cloud: GaussianCloud, gain: float) -> GaussianCloud:
    """The cloud with its display colours times a gain, in every direction."""
    if gain == 1.0:
        return cloud
    sh = cloud.sh * gain
    sh[:, 0] += (gain - 1) * 0.5 / SH_C0
    return cloud.replace(sh=sh)

"""Uniform quantization of a trained scene: harmonics in 8 bits a number, positions in 16.

One column is quantized at a time, to measure its cost alone. The file formats do better; `bench files` measures them.
"""

from __future__ import annotations

import torch
from torch import Tensor

from ..gaussians.cloud import GaussianCloud

FLOAT = 4  # bytes


def eight_bit_harmonics(cloud: GaussianCloud) -> GaussianCloud:
    """Every band quantized to 256 uniform levels between its least and its greatest number."""
    bands = [cloud.sh[:, d * d : (d + 1) ** 2] for d in range(cloud.degree + 1)]
    return cloud.replace(sh=torch.cat([stepped(band, 8) for band in bands], dim=1))


def sixteen_bit_positions(cloud: GaussianCloud) -> GaussianCloud:
    """Every axis quantized to 65,536 uniform levels of the box around all Gaussians."""
    return cloud.replace(means=torch.stack([stepped(axis, 16) for axis in cloud.means.unbind(dim=1)], dim=1))


def half_float_positions(cloud: GaussianCloud) -> GaussianCloud:
    """Positions as IEEE half floats: eleven bits, finest near the origin."""
    return cloud.replace(means=cloud.means.half().float())


def stepped(numbers: Tensor, bits: int) -> Tensor:
    """Each number rounded to the nearest of `2^bits` uniform levels from the least to the greatest of them."""
    low, high = numbers.min().double(), numbers.max().double()
    step = ((high - low) / (2**bits - 1)).clamp(min=1e-30)
    return (low + torch.round((numbers.double() - low) / step) * step).float()


def bytes_saved(cloud: GaussianCloud, harmonics: bool, positions: bool) -> int:
    """Bytes saved against an INRIA .ply, where every number is a float; the stored ranges are counted."""
    count, numbers = len(cloud), int(cloud.sh.shape[1]) * 3
    bands = 2 * FLOAT * (cloud.degree + 1)
    box = 2 * FLOAT * 3
    return harmonics * (count * numbers * (FLOAT - 1) - bands) + positions * (count * 3 * (FLOAT - 2) - box)

"""Data augmentation on batches of crops: framing, resolution, light, hue and backgrounds. Deterministic by seed."""

from __future__ import annotations

import math

import torch
from torch import Tensor
from torch.nn import functional

from .model import IMAGE_SIZE

_GREY = torch.full((3,), 1 / math.sqrt(3))


def augment(pixels: Tensor, seed: int, size: int = IMAGE_SIZE) -> Tensor:
    """`[B, S, S, 4]` uint8 premultiplied crops to `[B, 3, size, size]` float pictures in [0, 1]."""
    g = torch.Generator().manual_seed(seed)
    rgba = pixels.permute(0, 3, 1, 2).float() / 255
    rgba = _reframed(rgba, g, size)
    rgba = _coarsened(rgba, g)
    alpha = rgba[:, 3:]
    light = _relit(rgba[:, :3] / alpha.clamp(min=0.02), g)
    image = light * alpha + backgrounds(len(pixels), size, g) * (1 - alpha)
    noise = torch.rand(image.shape, generator=g) - 0.5  # uniform: four times cheaper than Gaussian, and as good here
    return (image + noise * (torch.rand(len(image), 1, 1, 1, generator=g) ** 3 * 0.28)).clamp(0, 1)


def plain(pixels: Tensor, size: int = IMAGE_SIZE) -> Tensor:
    """The crops without augmentation over neutral grey, `[B, 3, size, size]`, for evaluation."""
    rgba = pixels.permute(0, 3, 1, 2).float() / 255
    rgba = functional.interpolate(rgba, (size, size), mode="bilinear", antialias=True)
    return (rgba[:, :3] + (1 - rgba[:, 3:]) * 0.5).clamp(0, 1)


def backgrounds(count: int, size: int, g: torch.Generator) -> Tensor:
    """`[B, 3, size, size]`: mostly plain greys near the neutral one, some two-tone, some soft clutter, some noise."""
    kind = torch.rand(count, 1, 1, 1, generator=g)
    grey = 0.5 + 0.03 * torch.randn(count, 1, 1, 1, generator=g).expand(count, 3, size, size)
    tint = torch.rand(count, 3, 2, 1, generator=g) * 0.25 + torch.rand(count, 1, 2, 1, generator=g) * 0.75
    row = torch.linspace(0, 1, size)[None, None, :, None]
    edge = torch.rand(count, 1, 1, 1, generator=g) * 0.6 + 0.2
    two = torch.where(row < edge, tint[:, :, :1], tint[:, :, 1:]).expand(count, 3, size, size)
    seed = torch.rand(count, 3, 5, 5, generator=g) * 0.5 + torch.rand(count, 1, 1, 1, generator=g) * 0.5
    soft = functional.interpolate(seed, (size, size), mode="bilinear", align_corners=False)
    grain = torch.rand(count, 3, size // 2, size // 2, generator=g)
    noisy = functional.interpolate(grain, (size, size), mode="nearest")
    result = torch.where(kind < 0.8, grey, torch.where(kind < 0.88, two, torch.where(kind < 0.95, soft, noisy)))
    return result.clamp(0, 1)


def _reframed(rgba: Tensor, g: torch.Generator, size: int) -> Tensor:
    """Mirror, rotate a little, scale, stretch and shift the crops; some borders are cut off."""
    n = len(rgba)
    turn = torch.randn(n, generator=g) * 0.06
    scale = torch.exp(torch.randn(n, generator=g) * 0.1) * 0.97
    stretch = torch.exp(torch.randn(n, generator=g) * 0.05)
    flip = torch.where(torch.rand(n, generator=g) < 0.5, -1.0, 1.0)
    shift = torch.randn(n, 2, generator=g) * 0.05
    theta = torch.zeros(n, 2, 3)
    theta[:, 0, 0], theta[:, 0, 1] = flip * scale * stretch * torch.cos(turn), -scale * torch.sin(turn)
    theta[:, 1, 0], theta[:, 1, 1] = flip * scale * torch.sin(turn), scale / stretch * torch.cos(turn)
    theta[:, :, 2] = shift
    grid = functional.affine_grid(theta, [n, 4, size, size], align_corners=False)
    return functional.grid_sample(rgba, grid, mode="bilinear", padding_mode="zeros", align_corners=False)


def _coarsened(rgba: Tensor, g: torch.Generator) -> Tensor:
    """Downsample a third of the batch to between 18 and 44 pixels and upsample it again."""
    count = len(rgba) // 3
    side = int(torch.randint(18, 45, (1,), generator=g))
    rows = torch.randperm(len(rgba), generator=g)[:count]
    small = functional.interpolate(rgba[rows], (side, side), mode="bilinear", antialias=True)
    back = functional.interpolate(small, tuple(rgba.shape[2:]), mode="bilinear", align_corners=False)
    return rgba.index_copy(0, rows, back)


def _relit(rgb: Tensor, g: torch.Generator) -> Tensor:
    """Vary gain, gamma and tint of all crops, and hue and saturation of 60 %: names depend on shape."""
    n = len(rgb)
    gain = torch.exp(torch.randn(n, 1, 1, 1, generator=g) * 0.25)
    gamma = torch.exp(torch.randn(n, 1, 1, 1, generator=g) * 0.2)
    tint = torch.exp(torch.randn(n, 3, 1, 1, generator=g) * 0.08)
    strong = (torch.rand(n, generator=g) < 0.6).float()
    angle = (torch.rand(n, generator=g) * 2 - 1) * math.pi * strong
    saturation = 1 + (torch.rand(n, generator=g) * 1.5 - 0.9) * strong
    turned = torch.einsum("nij,njhw->nihw", _hue_matrices(angle, saturation), rgb)
    return (turned.clamp(0, 1) ** gamma * gain * tint).clamp(0, 1)


def _hue_matrices(angle: Tensor, saturation: Tensor) -> Tensor:
    """`[B, 3, 3]` rotations about the grey axis (Rodrigues); components perpendicular to it are scaled by
    `saturation`."""
    axis = _GREY
    along = torch.outer(axis, axis)
    cross = torch.tensor([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    c, s = torch.cos(angle)[:, None, None], torch.sin(angle)[:, None, None]
    return along + saturation[:, None, None] * (c * (torch.eye(3) - along) + s * cross)

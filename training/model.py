"""The two towers: a small residual convnet over images and one attention layer over words."""

from __future__ import annotations

import math

import torch
from torch import Tensor, nn
from torch.nn import functional

DIM = 128  # length of the shared vectors
IMAGE_SIZE = 64  # side of the pictures, pixels
LENGTH = 10  # words a phrase at most
WIDTHS = (24, 48, 96, 192)  # channels at 1/2, 1/4, 1/8 and 1/16 of the side


class _Block(nn.Module):
    """Two 3x3 convolutions and a shortcut (He et al. 2016)."""

    def __init__(self, inner: int, outer: int, stride: int) -> None:
        super().__init__()
        self.first = nn.Conv2d(inner, outer, 3, stride, 1, bias=False)
        self.first_norm = nn.BatchNorm2d(outer)
        self.second = nn.Conv2d(outer, outer, 3, 1, 1, bias=False)
        self.second_norm = nn.BatchNorm2d(outer)
        same = stride == 1 and inner == outer
        self.shortcut: nn.Module = (
            nn.Identity()
            if same
            else nn.Sequential(nn.Conv2d(inner, outer, 1, stride, bias=False), nn.BatchNorm2d(outer))
        )

    def forward(self, x: Tensor) -> Tensor:
        y = functional.relu(self.first_norm(self.first(x)))
        result: Tensor = functional.relu(self.second_norm(self.second(y)) + self.shortcut(x))
        return result


class ImageTower(nn.Module):
    """Pictures `[B, 3, S, S]` in [0, 1] to unit rows `[B, D]`."""

    def __init__(self, widths: tuple[int, int, int, int] = WIDTHS, dim: int = DIM) -> None:
        super().__init__()
        a, b, c, d = widths
        self.body = nn.Sequential(
            nn.Conv2d(3, a, 3, 2, 1, bias=False), nn.BatchNorm2d(a), nn.ReLU(),
            _Block(a, b, 2), _Block(b, b, 1), _Block(b, c, 2), _Block(c, c, 1), _Block(c, d, 2), _Block(d, d, 1),
        )  # fmt: skip
        self.head = nn.Linear(2 * d, dim)

    def forward(self, images: Tensor) -> Tensor:
        x = self.body((images - 0.5) * 4.0)  # grey, the neutral background, becomes 0
        x = torch.cat([x.mean(dim=(2, 3)), x.amax(dim=(2, 3))], dim=1)  # [B, 2d]: mean and maximum of each feature
        return functional.normalize(self.head(x), dim=1)


class TextTower(nn.Module):
    """Word numbers `[T, L]` (0 is padding, on the left) to unit rows `[T, D]`."""

    def __init__(self, words: int, width: int = 96, heads: int = 4, dim: int = DIM, length: int = LENGTH) -> None:
        super().__init__()
        self.heads = heads
        self.table = nn.Embedding(words + 1, width, padding_idx=0)
        self.place = nn.Parameter(torch.randn(length, width) * 0.02)
        self.norm = nn.LayerNorm(width)
        self.mix = nn.Linear(width, 3 * width)
        self.out = nn.Linear(width, width)
        self.head = nn.Sequential(
            nn.LayerNorm(2 * width), nn.Linear(2 * width, 2 * width), nn.GELU(), nn.Linear(2 * width, dim)
        )

    def forward(self, tokens: Tensor) -> Tensor:
        real = (tokens > 0).to(self.place.dtype)  # [T, L]
        x = self.table(tokens) + self.place
        x = x + self._attend(self.norm(x), real)
        mean = (x * real[..., None]).sum(dim=1) / real.sum(dim=1, keepdim=True).clamp(min=1.0)
        return functional.normalize(self.head(torch.cat([x[:, -1], mean], dim=1)), dim=1)

    def _attend(self, x: Tensor, real: Tensor) -> Tensor:
        """Self-attention over the real words `[T, L, W]`."""
        count, length, width = x.shape
        each = width // self.heads
        q, k, v = self.mix(x).view(count, length, 3, self.heads, each).permute(2, 0, 3, 1, 4).unbind(0)
        weights = q @ k.transpose(-1, -2) / math.sqrt(each)  # [T, heads, L, L]
        weights = weights - 1e4 * (1.0 - real)[:, None, None, :]
        mixed = torch.softmax(weights, dim=-1) @ v
        result: Tensor = self.out(mixed.transpose(1, 2).reshape(count, length, width))
        return result


class ImageGraph(nn.Module):
    """What is exported: the tower with its preprocessing, uint8 `[B, S, S, 3]` in, unit rows out."""

    def __init__(self, tower: ImageTower) -> None:
        super().__init__()
        self.tower = tower

    def forward(self, images: Tensor) -> Tensor:
        result: Tensor = self.tower(images.permute(0, 3, 1, 2).to(torch.float32) / 255.0)
        return result

"""The contour network: a residual encoder down to a sixteenth of the side and a light decoder back to full size."""

from __future__ import annotations

import torch
from torch import Tensor, nn
from torch.nn import functional

CHANNELS = 8  # RGB, relative inverse depth, normal, known
WIDTHS = (12, 24, 48, 80, 112)  # channels at 1, 1/2, 1/4, 1/8 and 1/16 of the side
BLOCKS = (0, 1, 2, 2, 2)  # residual blocks at each
STRIDE = 16  # sides of a picture are multiples of it


class _Block(nn.Module):
    """Two 3x3 convolutions and a shortcut (He et al. 2016)."""

    def __init__(self, width: int, dilation: int = 1) -> None:
        super().__init__()
        self.first = nn.Conv2d(width, width, 3, 1, dilation, dilation, bias=False)
        self.first_norm = nn.BatchNorm2d(width)
        self.second = nn.Conv2d(width, width, 3, 1, 1, bias=False)
        self.second_norm = nn.BatchNorm2d(width)

    def forward(self, x: Tensor) -> Tensor:
        y = functional.relu(self.first_norm(self.first(x)))
        result: Tensor = functional.relu(self.second_norm(self.second(y)) + x)
        return result


def _convolution(inner: int, outer: int, stride: int = 1, size: int = 3) -> nn.Sequential:
    return nn.Sequential(nn.Conv2d(inner, outer, size, stride, size // 2, bias=False), nn.BatchNorm2d(outer), nn.ReLU())


class Contours(nn.Module):
    """Pictures `[B, 8, H, W]` to logits `[B, 1, H, W]` of borders, and in training to those of coarser scales too."""

    def __init__(self, widths: tuple[int, ...] = WIDTHS, blocks: tuple[int, ...] = BLOCKS) -> None:
        super().__init__()
        self.widths, self.blocks = widths, blocks
        self.stem = _convolution(CHANNELS, widths[0])
        self.down = nn.ModuleList(
            nn.Sequential(
                _convolution(widths[i - 1], widths[i], 2),
                *(_Block(widths[i], 2 if i == len(widths) - 1 and k else 1) for k in range(blocks[i])),
            )
            for i in range(1, len(widths))
        )
        self.context = nn.Sequential(nn.Conv2d(widths[-1], widths[-1], 1), nn.ReLU())
        self.narrow = nn.ModuleList(_convolution(widths[i], widths[i - 1], size=1) for i in range(1, len(widths)))
        self.mix = nn.ModuleList(_convolution(widths[i - 1], widths[i - 1]) for i in range(1, len(widths)))
        self.heads = nn.ModuleList(nn.Conv2d(widths[i], 1, 1) for i in range(3))

    def features(self, picture: Tensor) -> list[Tensor]:
        """Decoder features at 1, 1/2 and 1/4 of the side."""
        x = torch.cat([(picture[:, :3] - 0.5) * 4, picture[:, 3:]], dim=1)
        levels = [self.stem(x)]
        for down in self.down:
            levels.append(down(levels[-1]))
        x = levels[-1] + self.context(levels[-1].mean(dim=(2, 3), keepdim=True))
        outs = []
        for i in range(len(levels) - 1, 0, -1):
            up = functional.interpolate(self.narrow[i - 1](x), scale_factor=2.0, mode="bilinear", align_corners=False)
            x = self.mix[i - 1](up + levels[i - 1])
            outs.append(x)
        return outs[::-1][:3]

    def forward(self, picture: Tensor) -> list[Tensor]:
        return [head(x) for head, x in zip(self.heads, self.features(picture), strict=True)]


class ContourGraph(nn.Module):
    """What is exported: probabilities `[B, 1, H, W]` from the finest head."""

    def __init__(self, net: Contours) -> None:
        super().__init__()
        self.net = net

    def forward(self, picture: Tensor) -> Tensor:
        return torch.sigmoid(self.net.heads[0](self.net.features(picture)[0]))

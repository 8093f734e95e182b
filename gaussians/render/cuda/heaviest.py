"""Find the Gaussian with the largest blending weight in each pixel, from the footprints and tile lists of gsplat.

gsplat does not return it. All tiles step through their lists together, a few entries at a time, which keeps the device
busy; a tile whose pixels are all finished is skipped from then on.
"""

from __future__ import annotations

import torch
from torch import Tensor

from .. import convention as c
from .splatting import Seen

CHUNK = 8  # entries of a tile blended at once
MAX_ALPHAS = 1 << 24  # alphas computed at once (64 MB a copy)


def heaviest_rows(seen: Seen, width: int, height: int) -> Tensor:
    """`[H, W]` int64: the row with the largest blending weight, -1 where nothing was drawn."""
    side, offsets = int(seen.info["tile_size"]), seen.info["isect_offsets"][0]
    rows, columns = offsets.shape
    first = offsets.reshape(-1).long()
    last = torch.cat([first[1:], first.new_tensor([len(seen.info["flatten_ids"])])])
    pixels = _pixels(rows, columns, side, seen.alpha)  # [T, P, 2]
    T = pixels.new_ones(pixels.shape[:2])
    best, winner = torch.zeros_like(T), torch.full(T.shape, -1, dtype=torch.int64, device=T.device)
    open_ = (pixels < pixels.new_tensor([width, height])).all(dim=2)
    at = 0
    while len(tiles := ((first + at < last) & open_.any(dim=1)).nonzero().squeeze(1)):
        for part in tiles.split(max(1, MAX_ALPHAS // (CHUNK * T.shape[1]))):
            entry = first[part, None] + at + torch.arange(CHUNK, device=T.device)  # [t, c]
            listed = entry < last[part, None]
            row = seen.info["flatten_ids"][torch.where(listed, entry, first[part, None])].long()
            alpha = torch.where(listed[:, None], _alpha(seen, row, pixels[part]), 0)  # [t, P, c]
            behind = T[part, :, None] * torch.cumprod(1 - alpha, dim=2)
            before = torch.cat([T[part, :, None], behind[:, :, :-1]], dim=2)
            drawn = (behind > c.T_MIN) & open_[part, :, None]  # a prefix, since transmittance never rises
            weight, which = torch.where(drawn, alpha * before, 0).max(dim=2)
            more = weight > best[part]
            winner[part] = torch.where(more, row.gather(1, which), winner[part])
            best[part] = torch.maximum(weight, best[part])
            T[part] = behind[:, :, -1]
            open_[part] = drawn[:, :, -1]
        at += CHUNK
    whole = winner.reshape(rows, columns, side, side).transpose(1, 2).reshape(rows * side, columns * side)
    return whole[:height, :width]


def _pixels(rows: int, columns: int, side: int, like: Tensor) -> Tensor:
    """`[T, P, 2]` x, y of the pixel centres of every tile, in row-major order."""
    y = (torch.arange(rows * side, device=like.device) + 0.5).to(like.dtype).reshape(rows, 1, side, 1)
    x = (torch.arange(columns * side, device=like.device) + 0.5).to(like.dtype).reshape(1, columns, 1, side)
    shape = rows, columns, side, side
    return torch.stack([x.expand(shape), y.expand(shape)], dim=-1).reshape(rows * columns, side * side, 2)


def _alpha(seen: Seen, row: Tensor, pixels: Tensor) -> Tensor:
    """`[t, P, c]` alpha of the footprints `[t, c]` at the pixels `[t, P, 2]`, computed as in gsplat."""
    dx, dy = (pixels[:, :, None] - seen.info["means2d"][0, row][:, None]).unbind(dim=3)
    xx, xy, yy = (entry[:, None] for entry in seen.info["conics"][0, row].unbind(dim=2))
    exponent = 0.5 * (xx * dx * dx + yy * dy * dy) + xy * dx * dy
    alpha = (seen.info["opacities"][0, row][:, None] * torch.exp(-exponent)).clamp(max=c.ALPHA_MAX)
    return torch.where((exponent >= 0) & (alpha >= c.ALPHA_MIN), alpha, 0)

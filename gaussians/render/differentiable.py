"""The fast CPU renderer as a differentiable torch function; the kernels are behind `cpu.gradient`."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from ..camera import Camera, Vec3
from ..errors import UserError


def draw(
    means: Tensor,
    quats: Tensor,
    scales: Tensor,
    opacities: Tensor,
    sh: Tensor,
    camera: Camera,
    background: Vec3 = (0.0, 0.0, 0.0),
    centers: Tensor | None = None,
) -> tuple[Tensor, Tensor]:
    """Render `rgb [H, W, 3]` and `alpha [H, W]`, differentiable by all five columns.

    The image is bit-identical to that of `render` for the same values. Discontinuities have no gradient: the depth
    order, the cut-off of footprints, colours clamped at zero, alphas clamped at their maximum, tangents clamped at the
    image margin (as in the rasteriser of Kerbl et al. 2023).

    Args:
        means: `[N, 3]` world, scene units.
        quats: `[N, 4]` wxyz, of any length but zero.
        scales: `[N, 3]` > 0, scene units.
        opacities: `[N]` in (0, 1).
        sh: `[N, K, 3]`, K = (degree + 1)^2.
        centers: `[N, 2]` zeros; they receive the gradient of the footprint centres, in 1/px, which densification
            uses (gsplat: `means2d`).

    Raises:
        UserError: the columns are not float32 on the CPU.
    """
    columns = (means, quats, scales, opacities, sh)
    if any(c.dtype != torch.float32 or c.device.type != "cpu" for c in columns):
        raise UserError("the differentiable CPU renderer takes float32 columns on the CPU; convert or move them first")
    nowhere = means.new_zeros(len(means), 2) if centers is None else centers
    rgb, alpha = _Draw.apply(*columns, nowhere, camera, background)  # type: ignore[no-untyped-call]
    return rgb, alpha


class _Draw(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, *inputs: Any) -> tuple[Tensor, Tensor]:
        from .cpu import gradient

        *columns, _, camera, background = inputs
        drawn = gradient.draw(tuple(c.detach().contiguous().numpy() for c in columns), camera, background)
        ctx.drawn = drawn
        ctx.save_for_backward(*columns)  # torch then raises if they are changed in place before the backward pass
        return torch.from_numpy(drawn.rgb), torch.from_numpy(drawn.alpha)

    @staticmethod
    def backward(ctx: Any, *outputs: Tensor) -> Any:
        from .cpu import gradient

        _ = ctx.saved_tensors
        d_rgb, d_alpha = (g.contiguous().numpy() for g in outputs)
        found = gradient.draw_backward(ctx.drawn, d_rgb, d_alpha)
        return (*(torch.from_numpy(g) for g in vars(found).values()), None, None)

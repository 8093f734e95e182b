"""The fast CPU renderer as a function that torch can differentiate.

Knows torch's bookkeeping. Refuses to know kernels (`cpu.gradient`), losses and optimisers.
"""

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
    """Draw Gaussians, `rgb [H, W, 3]` and `alpha [H, W]`, so that gradients flow back to all five columns.

    The picture is that of `render` with the same numbers, to the byte. What is not continuous has no gradient: order,
    the ends of footprints, a colour below zero, an alpha at its maximum, a tangent beyond the image's margin (Kerbl et
    al. 2023, whose rasteriser decides the same).

    Args:
        means: `[N, 3]` world, scene units.
        quats: `[N, 4]` wxyz, of any length but zero.
        scales: `[N, 3]` > 0, scene units.
        opacities: `[N]` in (0, 1).
        sh: `[N, K, 3]`, K = (degree + 1)^2.
        centers: `[N, 2]` zeros; their gradient is that of the footprints' centres, in 1/px, by which training decides
            where Gaussians are missing.

    Raises:
        UserError: the columns are not float32 on the CPU.
    """
    columns = (means, quats, scales, opacities, sh)
    if any(c.dtype != torch.float32 or c.device.type != "cpu" for c in columns):
        raise UserError("the CPU renderer differentiates float32 columns on the CPU; move or convert them first")
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
        ctx.save_for_backward(*columns)  # so that torch notices if they are changed in place before the way back
        return torch.from_numpy(drawn.rgb), torch.from_numpy(drawn.alpha)

    @staticmethod
    def backward(ctx: Any, *outputs: Tensor) -> Any:
        from .cpu import gradient

        _ = ctx.saved_tensors
        d_rgb, d_alpha = (g.contiguous().numpy() for g in outputs)
        found = gradient.undraw(ctx.drawn, d_rgb, d_alpha)
        return (*(torch.from_numpy(g) for g in vars(found).values()), None, None)

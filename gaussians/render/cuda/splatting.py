"""Call gsplat's `rasterization` (version 1.5.3): convert columns and cameras to its arguments and its results back.

No other module calls gsplat. It is imported on first use, and it compiles its kernels when they first run.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import torch
from torch import Tensor

from ... import rotations
from ...camera import Camera, Vec3
from ...cloud import SH_BANDS
from ...errors import BackendError
from .. import convention as c

DEVICE = "cuda"
WIDEST = 1e8  # px, largest standard deviation of a footprint that is drawn: its square stays within float32

_INSTALL = 'pip install "scenewright[cuda]" together with a CUDA build of torch'
_ELSE = "or use the CPU: --backend cpu, --device cpu"


@dataclass(frozen=True)
class Seen:
    """Result of a rasterisation by gsplat.

    Attributes:
        colors: `[H, W, D]`, composited; with depth, the last channel is camera z averaged with the blending weights.
        alpha: `[H, W]`.
        info: gsplat's intermediate results: `means2d [1, N, 2]` (px), `conics [1, N, 3]`, `opacities [1, N]`, and the
            tile lists `tile_size`, `isect_offsets [1, rows, columns]` and `flatten_ids`, the rows of tile after tile,
            nearest first.
    """

    colors: Tensor
    alpha: Tensor
    info: dict[str, Any]


def missing() -> str:
    """What this machine lacks to render on a GPU and how to fix it, one sentence; "" if nothing is missing."""
    if importlib.util.find_spec("gsplat") is None:
        return f"gsplat is not installed; {_INSTALL}, {_ELSE}"
    if DEVICE == "cuda" and not torch.cuda.is_available():
        return f"torch {torch.__version__} finds no CUDA device; install a driver and a CUDA build of torch, {_ELSE}"
    return _kernels(DEVICE)


def require() -> None:
    """Raise BackendError if something is missing."""
    lacking = missing()
    if lacking:
        raise BackendError(f"cannot render on a GPU: {lacking}")


@cache
def _kernels(device: str) -> str:
    """Why gsplat's kernels do not run, tested with one Gaussian in one pixel; "" if they run.

    The kernels are compiled on first use, which can fail with many kinds of error.
    """
    view, pinhole = torch.eye(4, device=device)[None], torch.eye(3, device=device)[None]
    one = torch.tensor([[0.0, 0.0, 1.0]], device=device)
    try:
        import gsplat

        gsplat.rasterization(
            one, torch.ones(1, 4, device=device), torch.ones(1, 3, device=device), torch.full((1,), 0.5, device=device),
            one, view, pinhole, 1, 1, packed=False,
        )  # fmt: skip
    except Exception as error:
        reason = (str(error).strip().splitlines() or ["no message"])[0]
        fix = "gsplat compiles them on first use and needs nvcc of the CUDA version of torch"
        return (
            f"gsplat's kernels do not run ({type(error).__name__}: {reason}); {fix}: install the CUDA toolkit, {_ELSE}"
        )
    return ""


@contextmanager
def within_memory() -> Iterator[None]:
    """Turn torch's out-of-memory error into a BackendError."""
    try:
        yield
    except torch.cuda.OutOfMemoryError as error:
        reason = "the scene at this size does not fit the GPU's memory"
        raise BackendError(f"{reason}; use a smaller image or fewer Gaussians, {_ELSE}") from error


def rasterize(
    means: Tensor,
    quats: Tensor,
    scales: Tensor,
    opacities: Tensor,
    colors: Tensor,
    camera: Camera,
    background: Vec3 | None = None,
    *,
    depth: bool = False,
) -> Seen:
    """Rasterise columns that lie on the device. Differentiable by all of them.

    Args:
        means: `[N, 3]` world, scene units; N > 0.
        quats: `[N, 4]` wxyz, of any length.
        scales: `[N, 3]` > 0, scene units.
        opacities: `[N]`.
        colors: `[N, K, 3]` spherical harmonics, or `[N, D]` features composited as they are.
        background: RGB, only with harmonics; None: black.
        depth: whether to append a depth channel.
    """
    import gsplat

    device = means.device
    rotation = torch.from_numpy(camera.world_to_camera[:3, :3].copy()).to(device, torch.float32)
    eye = torch.from_numpy(camera.position.copy()).to(device, torch.float32)
    toward = means - eye  # subtracting the eye first keeps precision far from the origin
    view = torch.eye(4, device=device)
    view[:3, :3] = rotation
    pinhole = torch.tensor([[camera.fx, 0, camera.cx], [0, camera.fy, camera.cy], [0, 0, 1]], device=device)
    turned = rotations.normalize(quats)
    sound = _sound(toward, quats, scales, opacities, colors, rotation[2], max(camera.fx, camera.fy))
    rendered, alphas, info = gsplat.rasterization(
        means=toward,
        quats=turned,
        scales=scales,
        opacities=torch.where(sound, opacities.clamp(max=1), 0),  # gsplat culls opacity 0 before anything else
        colors=colors,
        viewmats=view[None],
        Ks=pinhole[None],
        width=camera.width,
        height=camera.height,
        near_plane=c.near_plane(means),
        far_plane=c.FAR,
        radius_clip=0.0,
        eps2d=c.DILATION,
        sh_degree=SH_BANDS[colors.shape[1]] if colors.ndim == 3 else None,
        packed=False,
        backgrounds=None if background is None else torch.tensor([background], dtype=torch.float32, device=device),
        render_mode="RGB+ED" if depth else "RGB",
        rasterize_mode="classic",
    )
    return Seen(rendered[0], alphas[0, :, :, 0], info)


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
    """`render.differentiable.draw` for columns on the device: the same arguments and results.

    The backward pass also adds the gradient of the footprint centres, in 1/px, to `centers`.
    """
    seen = rasterize(means, quats, scales, opacities, sh, camera, background)
    if centers is not None and seen.info["means2d"].requires_grad:
        seen.info["means2d"].register_hook(partial(_add_gradient, centers))
    return seen.colors, seen.alpha


def _add_gradient(centers: Tensor, gradient: Tensor) -> None:
    """Add the gradient of the footprint centres, `[1, N, 2]`, to `centers.grad`."""
    centers.grad = gradient[0].clone() if centers.grad is None else centers.grad + gradient[0]


@torch.no_grad()
def _sound(
    toward: Tensor, quats: Tensor, scales: Tensor, opacities: Tensor, colors: Tensor, forward: Tensor, focal: float
) -> Tensor:
    """`[N]` bool: all values are finite, and the footprint is narrower than `WIDEST`."""
    columns = toward, quats, scales, opacities[:, None], colors
    finite = torch.stack([torch.isfinite(column).flatten(1).all(dim=1) for column in columns]).all(dim=0)
    depth = (toward * forward).sum(dim=1).clamp(min=c.NEAR)
    return finite & (scales.amax(dim=1) * focal < WIDEST * depth)

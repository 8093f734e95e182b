"""A stand-in for gsplat, which does not run without CUDA: its signature and results, drawn by our own reference."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch

from scenewright.gaussians import rotations
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.render import reference


def rasterization(
    means: Any, quats: Any, scales: Any, opacities: Any, colors: Any, viewmats: Any, Ks: Any, width: int, height: int,
    near_plane: float = 0.01, far_plane: float = 1e10, radius_clip: float = 0.0, eps2d: float = 0.3,
    sh_degree: int | None = None, packed: bool = True, tile_size: int = 16, backgrounds: Any = None,
    render_mode: str = "RGB", sparse_grad: bool = False, absgrad: bool = False, rasterize_mode: str = "classic",
    channel_chunk: int = 32, distributed: bool = False, camera_model: str = "pinhole", segmented: bool = False,
    covars: Any = None, with_ut: bool = False, with_eval3d: bool = False, radial_coeffs: Any = None,
    tangential_coeffs: Any = None, thin_prism_coeffs: Any = None, ftheta_coeffs: Any = None,
    rolling_shutter: Any = None, viewmats_rs: Any = None,
) -> tuple[Any, Any, dict[str, Any]]:  # fmt: skip
    """Stands in for that of gsplat 1.5.3: its parameters and its answers' shapes, drawn by the readable renderer.

    Only what Scenewright asks for: one camera, unpacked, classic. Anything else fails.
    """
    n, like = len(means), means.detach()
    assert (means.shape, quats.shape, scales.shape, opacities.shape) == ((n, 3), (n, 4), (n, 3), (n,))
    assert viewmats.shape == (1, 4, 4) and Ks.shape == (1, 3, 3) and not packed and n > 0
    assert (near_plane, far_plane, radius_clip, eps2d) == (0.01, 1e10, 0.0, 0.3)
    assert (tile_size, rasterize_mode, camera_model) == (reference.TILE, "classic", "pinhole")
    assert render_mode in ("RGB", "RGB+ED")
    drawn = opacities.detach() >= 1 / 255  # the kernels look at no number of the others
    for column in (means, quats, scales, opacities[:, None], colors):
        assert bool(torch.isfinite(column[drawn]).all())
    focal_x, focal_y, center_x, center_y = (float(Ks[0][at]) for at in ((0, 0), (1, 1), (0, 2), (1, 2)))
    camera = Camera(viewmats[0].double().numpy(), focal_x, focal_y, center_x, center_y, width, height)
    sh = colors if sh_degree is not None else like.new_zeros(n, 1, 3)
    assert sh_degree is None or sh.shape == (n, (sh_degree + 1) ** 2, 3)
    splats = reference.project(GaussianCloud.create(means, rotations.normalize(quats), scales, opacities, sh), camera)
    row = splats.row
    means2d = like.new_zeros(1, n, 2).index_put((torch.zeros_like(row), row), splats.center)
    conics = like.new_zeros(1, n, 3).index_put((torch.zeros_like(row), row), splats.conic.detach())
    features = splats.color if sh_degree is not None else colors[row]
    features = torch.cat([features, splats.depth[:, None]], dim=1) if render_mode == "RGB+ED" else features
    moved = reference.Splats(**{**vars(splats), "center": means2d[0, row]})
    behind = like.new_zeros(features.shape[1])
    if backgrounds is not None:
        assert backgrounds.shape == (1, 3) and sh_degree is not None
        behind[:3] = backgrounds[0]
    picture = behind.repeat(height, width, 1) + 0 * features.sum()  # depends on them even where nothing is drawn
    alpha = like.new_zeros(height, width)
    tiles = -(-height // tile_size), -(-width // tile_size)
    listed: dict[int, Any] = {}
    for y, x, index in reference._tiles(moved, camera):
        listed[y // tile_size * tiles[1] + x // tile_size] = row[index].int()
        box = (slice(y, min(y + tile_size, height)), slice(x, min(x + tile_size, width)))
        pixels = reference._pixel_centers(box, means)
        total, T = like.new_zeros(len(pixels), len(behind)), like.new_ones(len(pixels))
        for part, weights, T in reference._blend(moved.take(index), pixels):  # noqa: B007
            total = total + weights @ features[index][part]
        shape = alpha[box].shape
        picture[box], alpha[box] = (total + T[:, None] * behind).reshape(*shape, -1), (1 - T).reshape(shape)
    if render_mode == "RGB+ED":
        picture = torch.cat([picture[..., :-1], picture[..., -1:] / alpha[..., None].clamp(min=1e-10)], dim=-1)
    lists = [listed.get(t, row[:0].int()) for t in range(tiles[0] * tiles[1])]
    offsets = torch.tensor([0, *np.cumsum([len(rows) for rows in lists])[:-1]], dtype=torch.int32)
    info = {
        "means2d": means2d, "conics": conics, "opacities": opacities[None], "tile_size": tile_size,
        "isect_offsets": offsets.reshape(1, *tiles), "flatten_ids": torch.cat(lists),
    }  # fmt: skip
    return picture[None], alpha[None, ..., None], info

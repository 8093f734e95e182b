"""The reference renderer: plain torch on any device, one image tile after another, written to be read.

The fast back ends are tested against it. Names used throughout: `xx, xy, yy` entries of a 2-D covariance (px^2),
`T` transmittance.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from .. import harmonics, rotations
from ..camera import Camera, Render, Vec3
from ..cloud import NO_GROUP, GaussianCloud
from . import convention as c
from .shares import Split, sum_pairs

TILE = 16  # px, side of a tile
# Gaussians blended at once in a tile. Small enough that a finished tile stops early and torch uses one thread.
CHUNK = 128


@dataclass(frozen=True)
class Splats:
    """M visible Gaussians as footprints in the image, nearest first.

    Attributes:
        row: `[M]` int64, row in the cloud.
        center: `[M, 2]` px, origin at the outer corner of the top-left pixel.
        conic: `[M, 3]` entries xx, xy, yy of the inverse 2-D covariance, 1/px^2.
        reach: `[M, 2]` px, half sides of the box outside which alpha is below `ALPHA_MIN`.
        opacity: `[M]`.
        color: `[M, 3]` display space, as seen from the eye.
        depth: `[M]` camera z of the centre, scene units.
    """

    row: Tensor
    center: Tensor
    conic: Tensor
    reach: Tensor
    opacity: Tensor
    color: Tensor
    depth: Tensor

    def take(self, index: Tensor) -> Splats:
        """The splats at `index` (integers), in that order."""
        return Splats(**{name: column[index] for name, column in vars(self).items()})


def render(
    cloud: GaussianCloud,
    camera: Camera,
    background: Vec3,
    dtype: torch.dtype = torch.float32,
    centers: Tensor | None = None,
) -> Render:
    """See `scenewright.gaussians.render.render`.

    Args:
        dtype: of all arithmetic and of the returned channels.
        centers: `[N, 2]` zeros that receive the gradient of the footprint centres, as in `render.differentiable.draw`.
    """
    splats = project(cloud, camera, dtype)
    if centers is not None:
        splats = replace(splats, center=splats.center + centers[splats.row])
    h, w, like = camera.height, camera.width, splats.center
    rgb = like.new_tensor(background).repeat(h, w, 1)
    alpha, depth = like.new_zeros(h, w), like.new_zeros(h, w)
    group = torch.full((h, w), NO_GROUP, dtype=torch.int32, device=like.device)
    for y, x, index in _tiles(splats, camera):
        tile = splats.take(index)
        box = (slice(y, min(y + TILE, h)), slice(x, min(x + TILE, w)))
        pixels = _pixel_centers(box, like)
        features = torch.cat([tile.color, tile.depth[:, None]], dim=1)  # [L, 4]
        total, best, T = pixels.new_zeros(len(pixels), 4), pixels.new_zeros(len(pixels)), pixels.new_ones(len(pixels))
        winner = torch.full((len(pixels),), NO_GROUP, dtype=torch.int32, device=like.device)
        for part, weights, behind in _blend(tile, pixels):
            T = behind
            total = total + weights @ features[part]
            heaviest, at = weights.max(dim=1)
            winner = torch.where(heaviest > best, cloud.group[tile.row[part][at]], winner)
            best = torch.maximum(best, heaviest)
        shape = alpha[box].shape
        rgb[box] = (total[:, :3] + T[:, None] * rgb[box].reshape(-1, 3)).reshape(*shape, 3)
        alpha[box] = (1 - T).reshape(shape)
        depth[box] = torch.where(T < 1, total[:, 3] / (1 - T).clamp(min=1e-12), 0).reshape(shape)
        group[box] = winner.reshape(shape)
    return Render(rgb, alpha, depth, group)


def contributions(cloud: GaussianCloud, camera: Camera) -> Tensor:
    """See `scenewright.gaussians.render.contributions`."""
    splats = project(cloud, camera)
    h, w = camera.height, camera.width
    total = torch.zeros(len(cloud), dtype=torch.float64, device=cloud.device)
    for y, x, index in _tiles(splats, camera):
        tile = splats.take(index)
        pixels = _pixel_centers((slice(y, min(y + TILE, h)), slice(x, min(x + TILE, w))), splats.center)
        for part, weights, _ in _blend(tile, pixels):
            rows = tile.row[part]  # no row occurs twice in a tile, so indexed assignment is safe
            total[rows] = total[rows] + weights.sum(dim=0, dtype=torch.float64)
    return total.float()


def split(cloud: GaussianCloud, camera: Camera, labels: NDArray[np.int32]) -> Split:
    """See `scenewright.gaussians.render.split`."""
    splats = project(cloud, camera)
    parts: list[tuple[Tensor, Tensor, Tensor]] = []
    for y, x, index in _tiles(splats, camera):
        tile = splats.take(index)
        box = (slice(y, min(y + TILE, camera.height)), slice(x, min(x + TILE, camera.width)))
        here = torch.from_numpy(labels[box].reshape(-1).copy()).to(cloud.device)
        for part, weights, _ in _blend(tile, _pixel_centers(box, splats.center)):
            for label in np.unique(labels[box]).tolist():
                rows = tile.row[part]
                parts.append(
                    (rows, torch.full_like(rows, label), weights[here == label].sum(dim=0, dtype=torch.float64))
                )
    if not parts:
        return sum_pairs(len(cloud), np.zeros(0, np.int64), np.zeros(0, np.int32), np.zeros(0))
    row, label, weight = (torch.cat(column).cpu().numpy() for column in zip(*parts, strict=True))
    return sum_pairs(len(cloud), row, label, weight)


def count_blends(cloud: GaussianCloud, camera: Camera) -> int:
    """Number of (Gaussian, pixel) pairs that are blended: the least work a renderer of this convention has to do."""
    splats, count = project(cloud, camera), 0
    for y, x, index in _tiles(splats, camera):
        box = (slice(y, min(y + TILE, camera.height)), slice(x, min(x + TILE, camera.width)))
        for _, weights, _ in _blend(splats.take(index), _pixel_centers(box, splats.center)):
            count += int((weights > 0).sum())
    return count


def project(cloud: GaussianCloud, camera: Camera, dtype: torch.dtype = torch.float32) -> Splats:
    """Project and cull: the Gaussians that can touch the image, sorted by depth. Non-finite rows are dropped."""
    rotation, eye = _pose(camera, cloud.device, dtype)
    toward = cloud.means - eye  # [N, 3]; subtracting the eye first keeps precision far from the origin
    local = toward @ rotation.T
    z = local[:, 2]
    keep = (z > c.near_plane(cloud.means)) & (z < c.FAR) & (cloud.opacities > c.ALPHA_MIN) & _finite_rows(cloud)
    row = keep.nonzero().squeeze(1)
    row = row[torch.argsort(z[row], stable=True)]
    cloud, toward, local, z = cloud[row], toward[row], local[row], z[row]

    xx, xy, yy, determinant = _footprint(cloud, camera, rotation, local)
    opacity = cloud.opacities.to(dtype).clamp(max=1)
    # alpha >= ALPHA_MIN  <=>  d' inv(cov) d / 2 <= log(opacity / ALPHA_MIN): an ellipse with this bounding box.
    limit = 2 * torch.log(opacity / c.ALPHA_MIN)
    center = local[:, :2] / z[:, None] * local.new_tensor([camera.fx, camera.fy]) + local.new_tensor(
        [camera.cx, camera.cy]
    )
    splats = Splats(
        row=row,
        center=center,
        conic=torch.stack([yy, -xy, xx], dim=1) / determinant[:, None],
        reach=torch.sqrt(limit[:, None] * torch.stack([xx, yy], dim=1)),
        opacity=opacity,
        color=harmonics.to_color(cloud.sh.to(dtype), torch.nn.functional.normalize(toward, dim=1)),
        depth=z,
    )
    size = center.new_tensor([camera.width, camera.height])
    seen = ((center + splats.reach > 0) & (center - splats.reach < size)).all(dim=1)
    return splats.take((seen & (determinant < c.MAX_DETERMINANT)).nonzero().squeeze(1))


def _pose(camera: Camera, device: torch.device, dtype: torch.dtype) -> tuple[Tensor, Tensor]:
    """World-to-camera rotation `[3, 3]` and the eye `[3]` in the world."""
    pose = torch.from_numpy(camera.world_to_camera[:3, :3].copy())
    eye = torch.from_numpy(camera.position.copy())
    return pose.to(device, dtype), eye.to(device, dtype)


def _finite_rows(cloud: GaussianCloud) -> Tensor:
    """`[N]` bool: whether all values of a Gaussian are finite."""
    columns = (cloud.means, cloud.quats, cloud.scales, cloud.opacities[:, None], cloud.sh)
    return torch.stack([torch.isfinite(x).flatten(1).all(dim=1) for x in columns]).all(dim=0)


def _footprint(
    cloud: GaussianCloud, camera: Camera, rotation: Tensor, local: Tensor
) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """2-D covariance `xx, xy, yy` and its determinant, `[M]` each: `J R S S' R' J' + DILATION I`.

    The determinant is sum_pairs from squares (Cauchy-Binet), since `xx * yy - xy^2` cancels for long thin footprints.
    """
    z = local[:, 2]
    u = (local[:, 0] / z).clamp(*_tangent_range(camera.width, camera.fx, camera.cx))
    v = (local[:, 1] / z).clamp(*_tangent_range(camera.height, camera.fy, camera.cy))
    zero = torch.zeros_like(z)
    jacobian = torch.stack(
        [camera.fx / z, zero, -camera.fx * u / z, zero, camera.fy / z, -camera.fy * v / z], dim=1
    ).reshape(-1, 2, 3)
    axes = rotations.to_matrix(rotations.normalize(cloud.quats.to(local.dtype))) * cloud.scales[:, None, :]  # [M, 3, 3]
    p, q = (jacobian @ rotation @ axes).unbind(dim=1)  # [M, 3] each: the principal axes seen along x and along y
    xx, xy, yy = (p * p).sum(dim=1), (p * q).sum(dim=1), (q * q).sum(dim=1)
    minors = torch.linalg.cross(p, q).square().sum(dim=1)
    determinant = minors + c.DILATION * (xx + yy) + c.DILATION**2
    return xx + c.DILATION, xy, yy + c.DILATION, determinant


def _tangent_range(size: int, focal: float, principal: float) -> tuple[float, float]:
    """Tangents of the viewing angle at both image edges, widened by `EDGE`."""
    margin = c.EDGE * size
    return (-principal - margin) / focal, (size - principal + margin) / focal


def _tiles(splats: Splats, camera: Camera) -> Iterator[tuple[int, int, Tensor]]:
    """Corner y, x and the splats (indices, nearest first) of each tile that any splat's box touches."""
    low = ((splats.center - splats.reach) / TILE).floor()
    high = ((splats.center + splats.reach) / TILE).floor()
    for ty in range(-(-camera.height // TILE)):
        line = ((low[:, 1] <= ty) & (high[:, 1] >= ty)).nonzero().squeeze(1)
        for tx in range(-(-camera.width // TILE)):
            index = line[(low[line, 0] <= tx) & (high[line, 0] >= tx)]
            if len(index):
                yield ty * TILE, tx * TILE, index


def _pixel_centers(box: tuple[slice, slice], like: Tensor) -> Tensor:
    """`[P, 2]` x, y of the pixel centres in a box of rows and columns, row by row; type and device as of `like`."""
    y = torch.arange(box[0].start, box[0].stop, dtype=like.dtype, device=like.device) + 0.5
    x = torch.arange(box[1].start, box[1].stop, dtype=like.dtype, device=like.device) + 0.5
    return torch.stack(torch.meshgrid(x, y, indexing="xy"), dim=-1).reshape(-1, 2)


def _blend(tile: Splats, pixels: Tensor) -> Iterator[tuple[slice, Tensor, Tensor]]:
    """Blend L splats into P pixels, a chunk at a time.

    Yields:
        the chunk as a slice of the splats, its weights `[P, l]`, and the transmittance `[P]` left behind it.
    """
    T = pixels.new_ones(len(pixels))
    open_ = torch.ones(len(pixels), dtype=torch.bool, device=pixels.device)
    for start in range(0, len(tile.row), CHUNK):
        part = slice(start, start + CHUNK)
        alpha = _alpha(tile, part, pixels)
        behind = T[:, None] * torch.cumprod(1 - alpha, dim=1)  # [P, l] transmittance after each splat
        before = torch.cat([T[:, None], behind[:, :-1]], dim=1)
        drawn = (behind > c.T_MIN) & open_[:, None]  # a prefix of each row, since `behind` only falls
        last = torch.where(drawn, behind, torch.inf).amin(dim=1)
        T = torch.where(drawn.any(dim=1), last, T)
        open_ = open_ & drawn[:, -1]
        yield part, torch.where(drawn, alpha * before, 0), T
        if not open_.any():
            return


def _alpha(tile: Splats, part: slice, pixels: Tensor) -> Tensor:
    """`[P, l]` opacity of each splat of the chunk at each pixel."""
    dx, dy = (pixels[:, None, :] - tile.center[part]).unbind(dim=2)
    a, b, d = tile.conic[part].unbind(dim=1)
    exponent = 0.5 * (a * dx * dx + d * dy * dy) + b * dx * dy
    alpha = (tile.opacity[part] * torch.exp(-exponent)).clamp(max=c.ALPHA_MAX)
    return torch.where(alpha >= c.ALPHA_MIN, alpha, 0)

"""Depth of pictures from a few posed cameras, as points to start from (`points_of`).

For each picture: the cost of a pixel at each of a number of depths is how much its colour differs from where the
nearest cameras see that point (plane sweep; Collins 1996). Costs are summed along paths in four directions with a
penalty for changes of depth (Hirschmueller 2008), so that plain walls take the depth of their borders. Each depth is
then compared with those of other pictures, which confirm it or look through it: of many pictures, with a dozen from
near to far, so that the work grows with their number and not with its square.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ... import compiled
from ...camera import Camera
from ...compiled import exact

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

APART = 1.0  # pixels of the nearest cameras between two depths that are tried, evenly spaced in inverse depth
FEWEST, MOST = 72, 256  # depths that are tried
COSTS = 2**27  # of a picture at most (4 bytes each): fewer depths are tried of large pictures
NEIGHBOURS = 4  # cameras that a picture is compared with
ASIDE = 0.1  # of the radius of the cameras: pictures from nearer by hardly tell a depth, and are taken last
WITNESSES = 12  # other pictures that may confirm the depths of one
ASKEW = 1.2  # radians between two sights, beyond which pictures hardly show the same
NEAREST, FARTHEST = 0.12, 4.0  # depths that are tried, of the radius of the cameras
WORST = 0.2  # difference of colour beyond which it does not matter, and that of what no other camera sees
BEND, JUMP = 0.02, 0.12  # penalties of a change by one depth, and of a larger one
AGREE = 0.04  # of the depth: as near another picture's depth must be to confirm one
BEHIND = 0.08  # of the depth: as far behind a point another picture's confirmed depth must be to deny it

f4 = np.float32


@dataclass(frozen=True, eq=False)
class Points:
    """Points on surfaces that pictures show.

    Attributes:
        means: `[N, 3]` world.
        colors: `[N, 3]` in [0, 1].
        sizes: `[N]` scene units, the side of a pixel at the point.
        depths: `[N]` from the camera of its picture.
        agreed: `[N]` how many of the pictures that are asked confirm its depth.
        denied: `[N]` how many of these look through it: their depth there is confirmed, and behind it.
    """

    means: F64
    colors: F64
    sizes: F64
    depths: F64
    agreed: I64
    denied: I64


def points_of(
    cameras: Sequence[Camera], photos: Sequence[F32], radius: float,
    beside: tuple[Sequence[Camera], Sequence[F32]] = ((), ()),
) -> Points:  # fmt: skip
    """A point for each pixel of some pictures.

    The work is that of `NEIGHBOURS` and `WITNESSES` other pictures for each of them, and grows with the pixels.

    Args:
        photos: `[H, W, 3]` in [0, 1], one for each camera.
        radius: of the cameras around their middle, scene units.
        beside: more cameras and photos, that these pictures are compared with too.
    """
    count = len(cameras)
    everything = [*cameras, *beside[0]], [*photos, *beside[1]]
    depths = [_depth(i, *everything, radius) for i in range(count)]
    means = [unprojected(camera, depth) for camera, depth in zip(cameras, depths, strict=True)]
    agreed, denied = ([np.zeros(len(m), np.int64) for m in means] for _ in range(2))
    asked = [witnesses(i, cameras) for i in range(count)]
    for i in range(count):
        for k in asked[i]:
            agreed[i] += confirms(means[i], cameras[k], depths[k])
    sure = [(a > 0).reshape(d.shape) for a, d in zip(agreed, depths, strict=True)]
    for i in range(count):
        for k in asked[i]:
            denied[i] += denies(means[i], cameras[k], depths[k], sure[k])
    colors = np.concatenate([photo.reshape(-1, 3) for photo in photos]).astype(np.float64)
    sizes = np.concatenate([d.reshape(-1) / camera.fx for camera, d in zip(cameras, depths, strict=True)])
    each = np.concatenate([d.reshape(-1) for d in depths])
    return Points(np.concatenate(means), colors, sizes, each, np.concatenate(agreed), np.concatenate(denied))


def unprojected(camera: Camera, depth: F64) -> F64:
    """World points `[H * W, 3]` of the pixels of a camera at depths `[H, W]`."""
    x, y = np.meshgrid(np.arange(camera.width) + 0.5, np.arange(camera.height) + 0.5)
    rays = np.stack([(x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, np.ones_like(x)], axis=-1)
    local = (rays * depth[..., None]).reshape(-1, 3)
    return np.asarray(camera.position + local @ camera.world_to_camera[:3, :3])


def _depth(own: int, cameras: Sequence[Camera], photos: Sequence[F32], radius: float) -> F64:
    """Depth `[H, W]` of one picture."""
    camera, photo = cameras[own], photos[own]
    others = neighbours(own, cameras, radius)
    inverse = _inverse_depths(camera, [cameras[k] for k in others], radius)
    maps = np.stack([_mapping(camera, cameras[k]) for k in others]).astype(np.float32)
    costs = np.empty((camera.height, camera.width, len(inverse)), np.float32)
    pictures = np.stack([np.ascontiguousarray(photos[k], np.float32) for k in others])
    count = compiled.workers()
    compiled.run(
        _sweep, count, np.ascontiguousarray(photo, np.float32), pictures, maps, (1 / inverse).astype(f4), costs
    )
    total = np.zeros_like(costs)
    for flipped in (False, True):
        for turned in (False, True):
            view, out, picture = costs, total, photo
            if turned:
                view, out, picture = view.swapaxes(0, 1), out.swapaxes(0, 1), picture.swapaxes(0, 1)
            if flipped:
                view, out, picture = view[:, ::-1], out[:, ::-1], picture[:, ::-1]
            compiled.run(_along, count, view, out, picture, np.zeros((count, len(inverse)), np.float32))
    best = total.argmin(axis=2)
    return np.asarray(1 / _between(total, best, inverse))


def _inverse_depths(camera: Camera, others: Sequence[Camera], radius: float) -> F64:
    """`[D]` the inverse depths that are tried of a picture, from the nearest to the farthest."""
    nearest, farthest = 1 / (NEAREST * radius), 1 / (FARTHEST * radius)
    aside = max((float(np.linalg.norm(c.position - camera.position)) * c.fx for c in others), default=0.0)
    most = max(FEWEST, min(MOST, COSTS // (camera.width * camera.height)))
    return np.linspace(nearest, farthest, int(np.clip(aside * (nearest - farthest) / APART, FEWEST, most)))


def _between(total: F32, best: NDArray[np.int64], inverse: F64) -> F64:
    """Inverse depths `[H, W]` at the lowest point of a parabola through the best depth and the two beside it."""
    inner = np.clip(best, 1, len(inverse) - 2)
    low, mid, high = (np.take_along_axis(total, inner[..., None] + k, 2)[..., 0].astype(np.float64) for k in (-1, 0, 1))
    bend = low - 2 * mid + high
    shift = np.where(bend > 1e-9, 0.5 * (low - high) / np.maximum(bend, 1e-9), 0.0)
    place = np.where(inner == best, inner + np.clip(shift, -0.5, 0.5), best)
    return np.asarray(inverse[0] + place * (inverse[1] - inverse[0]))


def witnesses(own: int, cameras: Sequence[Camera]) -> list[int]:
    """The cameras whose depths are compared with those of one: all, or `WITNESSES`, evenly chosen from the nearest to
    the farthest of those that look roughly the same way."""
    order, turn = _by_nearness(own, cameras)
    if len(order) <= WITNESSES:
        return order
    alike = sum(turn[k] < ASKEW for k in order)
    order = sorted(order, key=lambda k: turn[k] >= ASKEW)[: max(WITNESSES, alike)]
    return [order[k] for k in np.linspace(0, len(order) - 1, WITNESSES).round().astype(int)]


def neighbours(own: int, cameras: Sequence[Camera], radius: float) -> list[int]:
    """The cameras that stand nearest and look the same way, of those that stand far enough aside to tell a depth."""
    order, _ = _by_nearness(own, cameras)
    place = cameras[own].position
    near = [bool(np.linalg.norm(cameras[k].position - place) < ASIDE * radius) for k in order]
    return [k for _, k in sorted(zip(near, order, strict=True), key=lambda pair: pair[0])][:NEIGHBOURS]


def _by_nearness(own: int, cameras: Sequence[Camera]) -> tuple[list[int], list[float]]:
    """The other cameras, those that stand nearest and look the same way first; and the angle between each sight and
    that of this camera, radians."""
    camera = cameras[own]
    away = [float(np.linalg.norm(c.position - camera.position)) for c in cameras]
    turn = [float(np.arccos(np.clip(c.forward @ camera.forward, -1, 1))) for c in cameras]
    reach = max(float(np.median(away)), 1e-9)
    return sorted((k for k in range(len(cameras)) if k != own), key=lambda k: (away[k] / reach + turn[k], k)), turn


def _mapping(camera: Camera, other: Camera) -> F64:
    """`[3, 4]`: from (x z, y z, z, 1) with a pixel and its depth to a homogeneous pixel of another camera."""

    def inner(c: Camera) -> F64:
        return np.array([[c.fx, 0, c.cx], [0, c.fy, c.cy], [0, 0, 1]])

    between = other.world_to_camera @ np.linalg.inv(camera.world_to_camera)
    turn = inner(other) @ between[:3, :3] @ np.linalg.inv(inner(camera))
    return np.concatenate([turn, (inner(other) @ between[:3, 3])[:, None]], axis=1)


def confirms(world: F64, camera: Camera, depth: F64) -> NDArray[np.bool_]:
    """`[N]` whether a camera's own depth is that of the point."""
    inside, x, y, z = _pixels(world, camera)
    return np.asarray(inside & (np.abs(depth[y, x] - z) < AGREE * z))


def denies(world: F64, camera: Camera, depth: F64, sure: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """`[N]` whether a camera's own depth is sure and behind the point."""
    inside, x, y, z = _pixels(world, camera)
    return np.asarray(inside & sure[y, x] & (z < depth[y, x] * (1 - BEHIND)))


def _pixels(world: F64, camera: Camera) -> tuple[NDArray[np.bool_], I64, I64, F64]:
    """`[N]` whether a camera sees the place of a point, column and row of its pixel, and its depth."""
    pixels, z = camera.project(world)
    inside = camera.contains(pixels, z)
    x, y = np.clip(pixels.astype(np.int64).T, 0, [[camera.width - 1], [camera.height - 1]])
    return inside, x, y, z


@exact
def _sweep(worker, workers, photo, pictures, maps, depths, costs):  # type: ignore[no-untyped-def]
    """Costs `[H, W, D]`: the mean of the two best differences to the other pictures."""
    height, width, _ = photo.shape
    for row in range(height * worker // workers, height * (worker + 1) // workers):
        for column in range(width):
            for d in range(depths.shape[0]):
                z = depths[d]
                a, b = (f4(column) + f4(0.5)) * z, (f4(row) + f4(0.5)) * z
                first, second = f4(WORST), f4(WORST)
                for k in range(maps.shape[0]):
                    m = maps[k]
                    w = m[2, 0] * a + m[2, 1] * b + m[2, 2] * z + m[2, 3]
                    if w <= f4(1e-6):
                        continue
                    x = (m[0, 0] * a + m[0, 1] * b + m[0, 2] * z + m[0, 3]) / w - f4(0.5)
                    y = (m[1, 0] * a + m[1, 1] * b + m[1, 2] * z + m[1, 3]) / w - f4(0.5)
                    if not (x >= f4(0) and y >= f4(0) and x < f4(width - 1) and y < f4(height - 1)):
                        continue
                    i, j = int(y), int(x)
                    u, v = x - f4(j), y - f4(i)
                    off = f4(0)
                    for c in range(3):
                        top = pictures[k, i, j, c] * (f4(1) - u) + pictures[k, i, j + 1, c] * u
                        low = pictures[k, i + 1, j, c] * (f4(1) - u) + pictures[k, i + 1, j + 1, c] * u
                        off += abs(photo[row, column, c] - (top * (f4(1) - v) + low * v))
                    off = min(off / f4(3), f4(WORST))
                    if off < first:
                        first, second = off, first
                    elif off < second:
                        second = off
                costs[row, column, d] = f4(0.5) * (first + second)


@exact
def _along(worker, workers, costs, total, photo, last):  # type: ignore[no-untyped-def]
    """Add to `total` the costs along each row from its start; the penalty of a jump is less across an edge."""
    height, width, count = costs.shape
    for row in range(height * worker // workers, height * (worker + 1) // workers):
        least = f4(0)
        for column in range(width):
            edge = f4(0)
            if column:
                for c in range(3):
                    edge += abs(photo[row, column, c] - photo[row, column - 1, c])
            jump = max(f4(JUMP) / (f4(1) + f4(8) * edge), f4(BEND))
            lowest = f4(1e9)
            before = f4(0)  # the path's cost at this pixel's predecessor and the depth before
            for d in range(count):
                value = costs[row, column, d]
                if column:
                    here = last[worker, d]
                    best = min(here, least + jump)
                    if d:
                        best = min(best, before + f4(BEND))
                    if d + 1 < count:
                        best = min(best, last[worker, d + 1] + f4(BEND))
                    value += best - least
                    before = here
                last[worker, d] = value
                total[row, column, d] += value
                lowest = min(lowest, value)
            least = lowest

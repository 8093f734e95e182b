"""Colours of a mesh solved against pictures of the splats: each pixel says what the texels it shows must mix to.

The second stage of DreamGaussian (Tang et al. 2024) optimises a texture through a rasteriser. A picture of a textured
mesh is linear in its texels, so that the best texture is a least-squares solution and needs no learning rate.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from .. import compiled
from ..camera import Camera
from ..cloud import GaussianCloud
from ..compiled import exact
from ..errors import BackendError
from ..render import render
from .raster import draw
from .shaping import Shape

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
Int = NDArray[np.int64]

RINGS = 2
PADDING = 2  # texels between charts
OPAQUE = 0.6  # alpha from which a pixel of the splats has a colour of its own
FACING = 0.15  # cosine between ray and normal from which a pixel counts
ROUNDS = 14  # of conjugate gradients
HOLD = 0.05  # weight of a texel's first colour, the mean of what is seen of it; a pixel's is up to 1


@dataclass(frozen=True, eq=False)
class Atlas:
    """A mesh cut into charts.

    Attributes:
        source: `[U]` the shape's vertex of each vertex of the atlas.
        faces: `[F, 3]` into those, in the order of the shape's faces.
        uv: `[U, 2]`, 0 to 1, from the picture's top-left corner.
    """

    source: Int
    faces: Int
    uv: F64


@dataclass(frozen=True, eq=False)
class Observations:
    """`R` pixels: the unknowns that each shows, with their weights, its colour, and what it counts.

    `at` `[R, K]` int32, `share` `[R, K]`, `rgb` `[R, 3]`, `weight` `[R]`, all float32; and which faces were seen `[F]`.
    """

    at: NDArray[np.int32]
    share: F32
    rgb: F32
    weight: F32


def installed() -> bool:
    """Whether textures can be made."""
    return importlib.util.find_spec("xatlas") is not None


def check_installed() -> None:
    """Check that textures can be made.

    Raises:
        BackendError: xatlas is not installed.
    """
    if not installed():
        raise BackendError(
            'a texture needs xatlas; install it with: pip install "scenewright[mesh]", or ask for --texture 0 '
            "(colours of the vertices)"
        )


def without_hidden(shape: Shape, cameras: Sequence[Camera]) -> Shape:
    """The shape without the faces that no camera sees, but for those within `RINGS` of one that is seen: a camera
    may miss a sliver."""
    seen = np.zeros(len(shape.faces), bool)
    for camera in cameras:
        face = draw(shape.vertices, shape.faces, camera).face
        seen[face[face >= 0]] = True
    for _ in range(RINGS):
        near = np.zeros(len(shape.vertices), bool)
        near[shape.faces[seen]] = True
        seen |= near[shape.faces].any(axis=1)
    return shape.keep(seen) if seen.any() else shape


def unwrap(shape: Shape, side: int) -> Atlas:
    """Charts of a shape, packed for a texture of `side` texels.

    Raises:
        BackendError: xatlas is not installed.
    """
    check_installed()
    import xatlas

    atlas = xatlas.Atlas()
    # Its own unit may be too small for its tolerances: a shape of about one unit.
    low, high = shape.vertices.min(axis=0), shape.vertices.max(axis=0)
    scaled = (shape.vertices - low) / max(float((high - low).max()), 1e-12)
    atlas.add_mesh(np.ascontiguousarray(scaled, np.float32), shape.faces.astype(np.uint32))
    charts, packing = xatlas.ChartOptions(), xatlas.PackOptions()
    charts.max_iterations = 1
    packing.resolution, packing.padding = side, PADDING
    atlas.generate(charts, packing)
    source, faces, uv = atlas[0]
    return Atlas(source.astype(np.int64), faces.astype(np.int64), uv.astype(np.float64))


def texture_of(shape: Shape, atlas: Atlas, cloud: GaussianCloud, cameras: Sequence[Camera], side: int) -> F64:
    """Display colours `[side, side, 3]`, 0 to 1, with which the mesh looks as the splats do from these cameras."""
    found = observe(shape, cloud, cameras, lambda face, weights: _texels(atlas, side, face, weights))
    return solve(found, side * side, lambda colors, known: _spread(colors, known, side)).reshape(side, side, 3)


def vertex_colors(shape: Shape, cloud: GaussianCloud, cameras: Sequence[Camera]) -> F64:
    """Display colours `[V, 3]` of the vertices, as `texture_of`."""
    found = observe(shape, cloud, cameras, lambda face, weights: (shape.faces[face].astype(np.int32), weights))

    def fill(colors: F32, known: NDArray[np.bool_]) -> F32:
        from scipy.spatial import cKDTree

        if known.all() or not known.any():
            return colors
        nearest = cKDTree(shape.vertices[known]).query(shape.vertices)[1]
        return np.where(known[:, None], colors, colors[known][nearest])

    return solve(found, len(shape.vertices), fill)


def observe(shape: Shape, cloud: GaussianCloud, cameras: Sequence[Camera], unknowns) -> Observations:  # type: ignore[no-untyped-def]
    """What the cameras' pictures of the splats say of the unknowns on a mesh.

    Args:
        unknowns: from faces `[R]` and barycentric weights `[R, 3]` to the unknowns there and their shares `[R, K]`.
    """
    parts = [_pixels(shape, cloud, camera) for camera in cameras]
    face, weights, rgb, weight = (np.concatenate(column) for column in zip(*parts, strict=True))
    at, share = unknowns(face, weights)
    return Observations(
        np.ascontiguousarray(at, np.int32), np.ascontiguousarray(share, np.float32), rgb.astype(np.float32),
        weight.astype(np.float32),
    )  # fmt: skip


def _pixels(shape: Shape, cloud: GaussianCloud, camera: Camera) -> tuple[NDArray[np.generic], ...]:
    """Face, weights, colour and what it counts of each pixel that shows the mesh and the splats."""
    drawn, splats = draw(shape.vertices, shape.faces, camera), render(cloud, camera)
    alpha = splats.alpha.numpy()
    rows, columns = np.nonzero((drawn.face >= 0) & (alpha > OPAQUE))
    face = drawn.face[rows, columns].astype(np.int64)
    a, b, c = (shape.vertices[shape.faces[face, k]] for k in range(3))
    normal, toward = np.cross(b - a, c - a), camera.position - a
    length = np.linalg.norm(normal, axis=1) * np.linalg.norm(toward, axis=1)
    facing = (normal * toward).sum(axis=1) / np.maximum(length, 1e-300)
    kept = facing > FACING
    rows, columns, face, facing = rows[kept], columns[kept], face[kept], facing[kept]
    rgb = splats.rgb.numpy()[rows, columns] / alpha[rows, columns, None]
    return face, drawn.weights[rows, columns], rgb, facing * alpha[rows, columns] ** 4


def _texels(atlas: Atlas, side: int, face: Int, weights: F32) -> tuple[NDArray[np.int32], F32]:
    """The four texels around each point and their bilinear weights, `[R, 4]`."""
    uv = np.einsum("rk,rkc->rc", weights, atlas.uv[atlas.faces[face]])
    place = uv * side - 0.5
    low = np.clip(np.floor(place), 0, side - 2)
    u, v = np.clip(place - low, 0, 1).T
    x, y = low.astype(np.int64).T
    at = np.stack([y * side + x, y * side + x + 1, (y + 1) * side + x, (y + 1) * side + x + 1], axis=1)
    share = np.stack([(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v], axis=1)
    return at.astype(np.int32), share.astype(np.float32)


def _spread(colors: F32, known: NDArray[np.bool_], side: int) -> F32:
    """The texels, with the colour of the nearest known one where nothing is known: between charts, what is hidden."""
    if known.all() or not known.any():
        return colors
    nearest = ndimage.distance_transform_edt(~known.reshape(side, side), return_distances=False, return_indices=True)
    return colors.reshape(side, side, 3)[nearest[0], nearest[1]].reshape(-1, 3)


def solve(found: Observations, count: int, fill) -> F64:  # type: ignore[no-untyped-def]
    """Colours `[count, 3]` whose mixtures are nearest to what was observed (weighted least squares, conjugate
    gradients), held to the mean of what shows them; `fill(colors, known)` gives the others a colour."""
    total, weight = np.zeros((count, 3), np.float32), np.zeros(count, np.float32)
    compiled.run_alone(_gather, found.at, found.share, found.rgb, found.weight, total, weight)
    known = weight > 1e-4
    start = np.asarray(fill(total / np.maximum(weight, 1e-12)[:, None], known), np.float32)
    x = start.copy()
    residual = np.zeros((count, 3), np.float32)
    mixed = np.empty((len(found.at), 3), np.float32)
    compiled.run_alone(_mix, found.at, found.share, x, mixed)
    compiled.run_alone(_scatter, found.at, found.share, found.weight, found.rgb - mixed, residual)
    scale = 1.0 / (weight + HOLD)[:, None]  # Jacobi
    step = scale * residual
    size = (residual * step).sum(axis=0, dtype=np.float64)
    for _ in range(ROUNDS):
        compiled.run_alone(_mix, found.at, found.share, step, mixed)
        image = np.float32(HOLD) * step
        compiled.run_alone(_scatter, found.at, found.share, found.weight, mixed, image)
        along = size / np.maximum((step * image).sum(axis=0, dtype=np.float64), 1e-30)
        x += along.astype(np.float32) * step
        residual -= along.astype(np.float32) * image
        better = scale * residual
        new = (residual * better).sum(axis=0, dtype=np.float64)
        step = better + (new / np.maximum(size, 1e-30)).astype(np.float32) * step
        size = new
    return np.clip(np.asarray(fill(x, known), np.float64), 0, 1)


@exact
def _gather(at, share, rgb, weight, total, summed):  # type: ignore[no-untyped-def]
    for r in range(at.shape[0]):
        for k in range(at.shape[1]):
            w = share[r, k] * weight[r]
            summed[at[r, k]] += w
            for c in range(3):
                total[at[r, k], c] += w * rgb[r, c]


@exact
def _mix(at, share, colors, out):  # type: ignore[no-untyped-def]
    for r in range(at.shape[0]):
        for c in range(3):
            value = np.float32(0)
            for k in range(at.shape[1]):
                value += share[r, k] * colors[at[r, k], c]
            out[r, c] = value


@exact
def _scatter(at, share, weight, values, out):  # type: ignore[no-untyped-def]
    for r in range(at.shape[0]):
        for k in range(at.shape[1]):
            w = share[r, k] * weight[r]
            for c in range(3):
                out[at[r, k], c] += w * values[r, c]

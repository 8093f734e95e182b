"""Imports an asset from a file: a mesh (.glb, .ply) or a splat (.ply), turned upright and stretched to a box.

Files are untrusted: every failure of a reader becomes a `FileError`, and the size of a file is checked before it is
opened.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import torch
from numpy.typing import NDArray

from ...camera import Vec3
from ...cloud import GaussianCloud
from ...color import Rgb
from ...errors import FileError, ScenewrightError
from ...rotations import from_matrix, multiply, normalize, to_matrix
from .make import Asset, Parts, Unlit, basic_name
from .sampling import Samples
from .triangles import cut

Array = NDArray[np.float64]
MAX_BYTES = 256 << 20
MAX_FACES = 4_000_000
MAX_GAUSSIANS = 60_000  # per asset; larger splats are subsampled evenly, because a room holds dozens of assets
SAMPLES = 10_000  # Gaussians per mesh, at most
CELLS = 5_000  # of them that a mesh without outlines is cut into
MOST_CUT = 300_000  # triangles up to which a mesh is cut into cells; of more, points are drawn
COARSEST = 3.0  # times the spacing of `CELLS`: from which cells are too coarse, and points are drawn instead
CELL_SCALE = 1.35  # samples are random: larger cells close the holes between them
# Rows: our x, y, z in the axes of a file whose y points up; its front +z becomes our -y.
FROM_Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


@dataclass(frozen=True, eq=False)
class _Captured(Unlit):
    """A captured splat, which keeps the lighting of its capture."""

    is_pigment: ClassVar[bool] = False
    lit: GaussianCloud

    def cloud(self, sun: Array) -> GaussianCloud:
        return self.lit


def read(path: Path, size: Vec3, kind: str, up: str = "", tint: Rgb | None = None) -> Asset:
    """The asset in a file, stretched to `size`, standing on z = 0, centred in x and y, facing -y.

    Args:
        kind: name of its kind.
        up: the file's axis that points up, "y" or "z"; "" means that of its format (glTF: y, others: z).
        tint: colour of the whole asset; None keeps its own colours.

    Raises:
        FileError: the file cannot be read, holds no surface, or is too large.
    """
    _check_bytes(path)
    turn = _turn(path, up)
    if path.suffix.lower() == ".ply" and (cloud := _splats(path)) is not None:
        return _splat_asset(cloud, turn, size, kind)
    return _mesh_asset(path, turn, size, kind, tint)


def natural_size(path: Path, up: str = "") -> Vec3:
    """Width, depth and height of the asset in a file, in the file's unit; arguments and errors as `read`."""
    _check_bytes(path)
    turn = _turn(path, up)
    if path.suffix.lower() == ".ply" and (cloud := _splats(path)) is not None:
        points = cloud.means.numpy().astype(np.float64) @ turn.T
        low, high = np.quantile(points, [0.005, 0.995], axis=0)
    else:
        points = surface(path)[0] @ turn.T
        low, high = points.min(axis=0), points.max(axis=0)
    span = high - low
    if not np.isfinite(span).all() or span.max() <= 0:
        raise FileError(f"{path.name}: its bounding box is empty or not finite")
    w, d, h = (float(max(side, 1e-4 * span.max())) for side in span)
    return w, d, h


def _check_bytes(path: Path) -> None:
    try:
        if path.stat().st_size > MAX_BYTES:
            raise FileError(f"{path} is larger than {MAX_BYTES >> 20} MB; make it smaller")
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror or error}") from error


def _turn(path: Path, up: str) -> Array:
    """`[3, 3]`, from the file's axes to ours."""
    return FROM_Y_UP if (up or ("y" if path.suffix.lower() == ".glb" else "z")) == "y" else np.eye(3)


def _splats(path: Path) -> GaussianCloud | None:
    """The Gaussians in a file; None if it holds none (a mesh)."""
    from ...files import load

    try:
        cloud = load(path).cloud
    except ScenewrightError:
        return None
    step = -(-len(cloud) // MAX_GAUSSIANS)
    return cloud[torch.arange(0, len(cloud), step)] if step > 1 else cloud


def _gain(low: Array, high: Array, size: Vec3) -> tuple[Array, Array]:
    """Scale factor of each axis, and the point that is moved to the origin."""
    span = high - low
    if not np.isfinite(span).all() or span.max() <= 0:
        raise FileError("its bounding box is empty or not finite")
    gain = np.array(size) / np.maximum(span, 1e-4 * span.max())
    return gain, np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])


def _splat_asset(cloud: GaussianCloud, turn: Array, size: Vec3, kind: str) -> Asset:
    """A splat rotated and stretched; its harmonics are cut to the constant band, which needs no rotation."""
    means = cloud.means.numpy().astype(np.float64) @ turn.T
    # Floaters around a captured object must not shrink it: the box is that of all but the outermost 1 %.
    low, high = np.quantile(means, [0.005, 0.995], axis=0)
    gain, foot = _gain(low, high, size)
    spin = from_matrix(torch.from_numpy(turn)).to(torch.float32)
    quats = normalize(multiply(spin, cloud.quats))
    inside = (np.abs((means - foot) * gain - [0, 0, size[2] / 2]) <= np.array(size) / 2 + 0.01).all(axis=1)
    # Each axis of a Gaussian is scaled by its change of length; the shear of an uneven stretch is ignored.
    axes = to_matrix(quats).numpy().astype(np.float64) * cloud.scales.numpy()[:, None, :]  # [N, 3, 3 axes]
    scales = np.linalg.norm(axes * gain[:, None], axis=1)
    keep = torch.from_numpy(inside)
    fitted = GaussianCloud.create(
        means=torch.from_numpy(((means - foot) * gain).astype(np.float32))[keep],
        quats=quats[keep],
        scales=torch.from_numpy(np.maximum(scales, 1e-6).astype(np.float32))[keep],
        opacities=cloud.opacities[keep],
        sh=cloud.sh[keep][:, :1].contiguous(),
    )
    nothing = Samples(np.zeros((0, 3)), np.zeros((0, 3, 3)), np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0, np.int64))
    unlit = _Captured(nothing, np.zeros((0, 3)), np.zeros(0, dtype=bool), fitted)
    return _asset(unlit, fitted, size, kind)


def _mesh_asset(path: Path, turn: Array, size: Vec3, kind: str, tint: Rgb | None) -> Asset:
    meshes = _meshes(path)
    made = _cut(path, meshes, turn, size) if sum(len(m.faces) for m in meshes) <= MOST_CUT else None
    samples, albedo = made or _spread(path, turn, size)
    albedo = albedo if tint is None else np.tile(np.array(tint), (len(albedo), 1))
    unlit = Unlit(samples, albedo, np.ones(len(samples.xyz), dtype=bool))
    return _asset(unlit, unlit.cloud(np.array([-0.45, -0.6, 0.66])), size, kind)


def _cut(path: Path, meshes: list[Any], turn: Array, size: Vec3) -> tuple[Samples, Array] | None:
    """Cells of all triangles of some meshes, stretched to `size`, and their colours `[N, 3]`; None if they are in so
    many pieces, as the leaves of a tree, that cells few enough would be far too coarse for the rest of it."""
    corners = np.concatenate([np.asarray(m.triangles, dtype=np.float64) for m in meshes]) @ turn.T
    if not np.isfinite(corners).all():
        raise FileError(f"the mesh in {path.name} has corners that are not numbers")
    gain, foot = _gain(corners.min(axis=(0, 1)), corners.max(axis=(0, 1)), size)
    triangles = (corners - foot) * gain
    one, other = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    area = float(np.linalg.norm(np.cross(one, other), axis=1).sum()) / 2
    step = math.sqrt(area / CELLS)
    ends = np.cumsum([0, *(len(m.faces) for m in meshes)])
    part = np.repeat(np.arange(len(meshes)), np.diff(ends))
    cells = cut(triangles, step, part)
    coarsest = COARSEST * step
    while len(cells.xyz) > SAMPLES:  # many sides need many strips
        if step >= coarsest:
            return None
        step *= 1.03 * math.sqrt(len(cells.xyz) / SAMPLES)
        cells = cut(triangles, step, part)
    if len(cells.xyz) < 3:
        raise FileError(f"the mesh in {path.name} has no surface")
    rgb = np.empty((len(cells.xyz), 3))
    for mesh, start, end in zip(meshes, ends, ends[1:], strict=False):
        rows = (cells.face >= start) & (cells.face < end)
        face = cells.face[rows] - start
        points = (cells.weights[rows, :, None] * np.asarray(mesh.triangles)[face]).sum(axis=1)
        rgb[rows] = _colors(mesh, points, face)
    count = len(cells.xyz)
    uv, piece = np.zeros((count, 2)), np.zeros(count, dtype=np.int64)
    return Samples(cells.xyz, cells.frame, cells.size, uv, piece), rgb


def _spread(path: Path, turn: Array, size: Vec3) -> tuple[Samples, Array]:
    """Random samples of a mesh of many triangles, stretched to `size`, and their colours `[N, 3]`."""
    xyz, normal, rgb, area = surface(path)
    xyz, normal = xyz @ turn.T, normal @ turn.T
    gain, foot = _gain(xyz.min(axis=0), xyz.max(axis=0), size)
    xyz, normal = (xyz - foot) * gain, normal / gain
    # The area of a patch with unit normal n grows by det(A) |A^-T n| under the stretch A; samples are even over the
    # unstretched surface.
    area *= float(np.prod(gain) * np.linalg.norm(normal, axis=1).mean())
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    side = np.full((len(xyz), 2), CELL_SCALE * np.sqrt(area / len(xyz)))
    return Samples(xyz, frames(normal), side, np.zeros((len(xyz), 2)), np.zeros(len(xyz), dtype=np.int64)), rgb


def surface(path: Path) -> tuple[Array, Array, Array, float]:
    """Evenly sampled points of a mesh, their normals and colours, and its area, in the file's frame and unit."""
    meshes = _meshes(path)
    total = sum(float(m.area) for m in meshes)
    try:
        parts = [
            _sampled(m, max(20, round(SAMPLES * float(m.area) / total)), index) for index, m in enumerate(meshes[:512])
        ]
    except Exception as error:  # as in `_meshes`
        raise FileError(f"{path.name} cannot be read as a mesh ({type(error).__name__}: {error})") from error
    xyz, normal, rgb = (np.concatenate(column) for column in zip(*parts, strict=True))
    good = np.isfinite(xyz).all(axis=1) & np.isfinite(normal).all(axis=1) & np.isfinite(rgb).all(axis=1)
    if good.sum() < 10:
        raise FileError(f"the mesh in {path.name} has no surface")
    return xyz[good], normal[good], rgb[good], total


def _meshes(path: Path) -> list[Any]:
    """The meshes in a file, as they stand in its scene; they have an area. Raises FileError."""
    try:
        import trimesh

        scene: Any = trimesh.load(path, force="scene", process=False)
        meshes = [
            scene.geometry[scene.graph[node][1]].copy().apply_transform(scene.graph[node][0])
            for node in scene.graph.nodes_geometry
        ]
        meshes = [m for m in meshes if isinstance(m, trimesh.Trimesh) and len(m.faces)]
        if not meshes or sum(len(m.faces) for m in meshes) > MAX_FACES:
            raise FileError(f"{path.name} holds no mesh of 1 to {MAX_FACES:,} triangles")
        total = sum(float(m.area) for m in meshes)
        if not np.isfinite(total) or total <= 0:
            raise FileError(f"the mesh in {path.name} has no surface")
        return meshes
    except FileError:
        raise
    except Exception as error:  # readers of mesh formats raise all kinds of exceptions on a broken file
        raise FileError(f"{path.name} cannot be read as a mesh ({type(error).__name__}: {error})") from error


def _sampled(mesh: Any, count: int, seed: int) -> tuple[Array, Array, Array]:
    import trimesh

    points, faces = trimesh.sample.sample_surface(mesh, count, seed=seed)
    return np.asarray(points), np.asarray(mesh.face_normals)[faces], _colors(mesh, np.asarray(points), faces)


def _colors(mesh: Any, points: Array, faces: NDArray[np.int64]) -> Array:
    """Display colours `[N, 3]` of points on faces: from the texture, the vertices or the material's base colour."""
    import trimesh

    visual = mesh.visual
    material = getattr(visual, "material", None)
    uv = getattr(visual, "uv", None)
    image = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    factor = getattr(material, "baseColorFactor", None)
    linear = np.array([255, 255, 255] if factor is None else factor[:3], dtype=np.float64) / 255
    base = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)  # factors are linear
    if image is not None and uv is not None:
        weights = trimesh.triangles.points_to_barycentric(mesh.triangles[faces], points)  # type: ignore[no-untyped-call]
        at = np.einsum("nk,nkc->nc", weights, np.asarray(uv)[mesh.faces[faces]])
        shown = trimesh.visual.color.uv_to_interpolated_color(at, image)
        return np.asarray(shown[:, :3], dtype=np.float64) / 255 * base
    if material is None and getattr(visual, "defined", False):
        return np.asarray(visual.face_colors[faces][:, :3], dtype=np.float64) / 255
    if factor is None:
        base = np.full(3, 0.6)
    return np.tile(base, (len(points), 1))


def frames(normal: Array) -> Array:
    """`[N, 3, 3]` orthonormal frames in columns; the last column is the normal."""
    helper = np.where(np.abs(normal[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]])
    first = np.cross(helper, normal)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([first, np.cross(normal, first), normal], axis=2)


def _asset(unlit: Unlit, cloud: GaussianCloud, size: Vec3, kind: str) -> Asset:
    if not len(cloud):
        raise FileError("no Gaussian of it lies inside its box")
    rgb = (cloud.sh[:, 0].mean(dim=0) * 0.28209479177387814 + 0.5).clamp(0, 1).tolist()
    parts = Parts(torch.zeros(len(cloud), dtype=torch.int32), ("whole",))
    whole = torch.ones(len(cloud), dtype=torch.bool)
    return Asset(cloud, kind, size, basic_name((rgb[0], rgb[1], rgb[2])), parts, whole, 0, unlit)

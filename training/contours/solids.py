"""Triangle meshes to build scenes from: other artists' objects, our own furniture, simple bodies and flat sheets.

All stand on z = 0, centred in x and y, front towards -y, in metres.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...gaussians.assets import registry
from ...gaussians.assets.modeling.make import design, fit_to_size
from ...gaussians.assets.modeling.shapes import Piece
from ...gaussians.camera import Vec3
from ...gaussians.errors import UserError

F32 = NDArray[np.float32]
MAX_FACES = 9000  # of one object: more take time and show nothing at the size of the pictures


@dataclass(frozen=True, eq=False)
class Solid:
    """`F` triangles.

    Attributes:
        corners: `[F, 3, 3]` float32, metres.
        normals: `[F, 3, 3]` float32, unit, of the corners.
        colors: `[F, 3, 3]` float32 display RGB of the corners.
        part: `[F]` int32 from 0; faces of one part have one material.
        kind: of our own furniture; "" of others.
    """

    corners: F32
    normals: F32
    colors: F32
    part: NDArray[np.int32]
    kind: str = ""

    @property
    def size(self) -> F32:
        """`[3]` extents."""
        points = self.corners.reshape(-1, 3)
        extent: F32 = points.max(axis=0) - points.min(axis=0)
        return extent

    def standing(self) -> Solid:
        """Moved onto z = 0 and centred in x and y."""
        points = self.corners.reshape(-1, 3)
        low, high = points.min(axis=0), points.max(axis=0)
        middle = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]], np.float32)
        return replace(self, corners=self.corners - middle)

    def transformed(self, matrix: NDArray[np.floating], offset: Sequence[float] | F32 = (0, 0, 0)) -> Solid:
        """`x -> matrix @ x + offset`; normals follow the inverse transpose."""
        m = np.asarray(matrix, np.float32)
        normals = self.normals @ np.linalg.inv(m).astype(np.float32)
        normals /= np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-9)
        return replace(self, corners=self.corners @ m.T + np.asarray(offset, np.float32), normals=normals)

    def sized(self, longest: float) -> Solid:
        """Scaled evenly so that its longest side is `longest` metres."""
        return self.transformed(np.eye(3) * (longest / max(1e-6, float(self.size.max()))))


def foreign(folder: Path) -> list[Solid]:
    """The objects of `folder/index.json` at their sizes in metres; glTF's y-up becomes z-up.

    Raises:
        UserError: the folder has no index.
    """
    index = folder / "index.json"
    if not index.is_file():
        raise UserError(f"{index} is missing; give --meshes a folder of .glb files with an index.json, or none")
    entries = json.loads(index.read_text(encoding="utf-8"))
    solids = [read(folder / entry["file"]) for entry in entries]
    return [s.sized(float(e["size_m"])) for s, e in zip(solids, entries, strict=True) if s is not None]


def read(path: Path) -> Solid | None:
    """One mesh file with the colours of its materials and textures at the corners; None if it holds no surface."""
    import trimesh

    scene: Any = trimesh.load(path, force="scene")
    columns: list[tuple[F32, F32, F32]] = []
    turn = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], np.float32)
    for node in scene.graph.nodes_geometry:
        pose, name = scene.graph[node]
        mesh = scene.geometry[name].copy()
        if not hasattr(mesh, "faces") or len(mesh.faces) == 0:
            continue
        mesh.apply_transform(pose)
        corners = np.asarray(mesh.triangles, np.float32) @ turn.T
        normals = np.asarray(mesh.vertex_normals, np.float32)[mesh.faces] @ turn.T
        columns.append((corners, normals, _colors(mesh)))
    if not columns:
        return None
    corners, normals, colors = (np.concatenate(c) for c in zip(*columns, strict=True))
    if len(corners) > MAX_FACES:
        area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        keep = np.sort(np.argsort(-area)[:MAX_FACES])
        corners, normals, colors = corners[keep], normals[keep], colors[keep]
    coarse = (colors.mean(axis=1) * 5.99).astype(np.int64) @ np.array([36, 6, 1])
    part = np.unique(coarse, return_inverse=True)[1].astype(np.int32).reshape(-1)
    return Solid(corners, normals, colors, part).standing()


def _colors(mesh: Any) -> F32:
    """`[F, 3, 3]` display colours at the corners, read a little inside of each face."""
    faces = np.asarray(mesh.faces)
    material = getattr(mesh.visual, "material", None)
    image = getattr(material, "baseColorTexture", None)
    uv = getattr(mesh.visual, "uv", None)
    factor = getattr(material, "baseColorFactor", None)
    linear = np.array([1.0, 1.0, 1.0]) if factor is None else np.asarray(factor[:3], dtype=np.float64) / 255
    tint = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    if image is not None and uv is not None and len(uv) == len(mesh.vertices):
        pixels = np.asarray(image.convert("RGB"), np.float32) / 255
        at = np.asarray(uv, np.float64)[faces]
        at = 0.9 * at + 0.1 * at.mean(axis=1, keepdims=True)
        cols = (np.mod(at[..., 0], 1.0) * (pixels.shape[1] - 1)).round().astype(int)
        rows = (np.mod(1 - at[..., 1], 1.0) * (pixels.shape[0] - 1)).round().astype(int)
        return np.asarray(pixels[rows, cols] * tint, np.float32)
    vertex = getattr(mesh.visual, "vertex_colors", None)
    if vertex is not None and len(vertex) == len(mesh.vertices):
        return np.asarray(vertex, np.float32)[faces][..., :3] / 255
    return np.tile(tint.astype(np.float32), (len(faces), 3, 1))


def own(kind: str, seed: int, size: Vec3 | None = None) -> Solid:
    """One design of our own furniture; its parts are those of its materials."""
    pieces, _ = design(registry.find(kind), seed)
    solid = _of_pieces(fit_to_size(pieces, size) if size is not None else pieces)
    return replace(solid.standing(), kind=kind)


def _of_pieces(pieces: Sequence[Piece]) -> Solid:
    columns = [(*_grid(s.points), index) for index, piece in enumerate(pieces) for s in piece.sheets]
    corners = np.concatenate([c for c, _, _ in columns])
    colors = np.concatenate(
        [np.full((len(c), 3, 3), p.color if (p := pieces[i].material) else (0.5, 0.5, 0.5)) for c, _, i in columns]
    )
    names = [(p.material.color, p.material.pattern) if p.material else None for p in pieces]
    part_of = {name: number for number, name in enumerate(dict.fromkeys(names))}
    part = np.concatenate([np.full(len(c), part_of[names[i]], np.int32) for c, _, i in columns])
    return Solid(corners, np.concatenate([n for _, n, _ in columns]), colors.astype(np.float32), part)


def _grid(points: NDArray[np.float64]) -> tuple[F32, F32]:
    """Triangles and corner normals `[F, 3, 3]` of grids `[B, U, V, 3]`."""
    du = np.gradient(points, axis=1) if points.shape[1] > 2 else np.diff(points, axis=1).repeat(2, axis=1)
    dv = np.gradient(points, axis=2) if points.shape[2] > 2 else np.diff(points, axis=2).repeat(2, axis=2)
    normal = np.cross(du, dv)
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12)

    def faces(a: NDArray[np.float64]) -> F32:
        p, q, r, s = a[:, :-1, :-1], a[:, 1:, :-1], a[:, 1:, 1:], a[:, :-1, 1:]
        both = np.stack([np.stack([p, q, r], axis=3), np.stack([p, r, s], axis=3)], axis=3)  # [B, U-1, V-1, 2, 3, 3]
        return np.ascontiguousarray(both.reshape(-1, 3, 3), np.float32)

    return faces(points), faces(normal)


def sheet(width: float, depth: float, cell: float = 0.4) -> Solid:
    """A horizontal rectangle facing up, in cells of about `cell` metres."""
    u, v = (np.linspace(-s / 2, s / 2, max(2, int(np.ceil(s / cell)) + 1)) for s in (width, depth))
    grid = np.stack([*np.meshgrid(u, v, indexing="ij"), np.zeros((len(u), len(v)))], axis=-1)[None]
    corners, normals = _grid(grid)
    return Solid(corners, normals, np.full(corners.shape, 0.5, np.float32), np.zeros(len(corners), np.int32))


def block(width: float, depth: float, height: float, cell: float = 0.4) -> Solid:
    """A box."""
    sides = []
    for axis, (a, b, c) in enumerate(((width, depth, height), (width, height, depth), (depth, height, width))):
        face = sheet(a, b, cell)
        for flip in (1.0, -1.0):
            turn = {
                0: np.array([[1, 0, 0], [0, flip, 0], [0, 0, flip]]),
                1: np.array([[1, 0, 0], [0, 0, -flip], [0, flip, 0]]),
                2: np.array([[0, 0, flip], [flip, 0, 0], [0, 1, 0]]),
            }[axis]
            moved = face.transformed(turn)
            sides.append(moved.transformed(np.eye(3), (turn @ [0, 0, 1.0] * c / 2).astype(np.float32)))
    return merged(sides).standing()


def lathe(rng: np.random.Generator, height: float, radius: float) -> Solid:
    """A turned body with a random profile: vase, bottle, bowl, ball, pole."""
    steps = int(rng.integers(4, 14))
    t = np.linspace(0, 1, steps)
    draw = rng.random()
    if draw < 0.25:
        profile = np.sqrt(np.maximum(1e-4, 1 - (2 * t - 1) ** 2))  # ball
    elif draw < 0.5:
        profile = np.full(steps, 1.0) * (1 + rng.uniform(-0.4, 0.4) * t)
    else:
        knots = rng.uniform(0.2, 1, size=int(rng.integers(3, 6)))
        profile = np.interp(t, np.linspace(0, 1, len(knots)), knots)
    profile = np.concatenate([[1e-4], profile, [1e-4]])
    z = np.concatenate([[0], t, [1.0]]) * height
    angle = np.linspace(0, -2 * np.pi, int(rng.integers(8, 25)))
    ring = profile[:, None] * radius
    grid = np.stack([ring * np.cos(angle), ring * np.sin(angle), z[:, None] + 0 * angle], axis=-1)[None]
    corners, normals = _grid(np.swapaxes(grid, 1, 2))
    return Solid(corners, normals, np.full(corners.shape, 0.5, np.float32), np.zeros(len(corners), np.int32))


def wire(rng: np.random.Generator, points: NDArray[np.float64], radius: float) -> Solid:
    """A tube along points `[K, 3]`: spokes, poles, cables, stems."""
    along = np.gradient(points, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    helper = rng.normal(size=3)
    a = np.cross(along, helper)
    a /= np.maximum(np.linalg.norm(a, axis=1, keepdims=True), 1e-9)
    b = np.cross(along, a)
    angle = np.linspace(0, 2 * np.pi, 6)
    ring = np.cos(angle)[None, :, None] * a[:, None] + np.sin(angle)[None, :, None] * b[:, None]
    corners, normals = _grid((points[:, None] + radius * ring)[None])
    return Solid(corners, normals, np.full(corners.shape, 0.5, np.float32), np.zeros(len(corners), np.int32))


def wheel(rng: np.random.Generator, radius: float) -> Solid:
    """A spoked wheel, upright: one thing that is mostly holes."""
    angle = np.linspace(0, 2 * np.pi, 33)
    rim = np.stack([radius * np.cos(angle), 0 * angle, radius * np.sin(angle)], axis=1)
    parts = [wire(rng, rim, radius * rng.uniform(0.02, 0.06))]
    for turn in np.linspace(0, 2 * np.pi, int(rng.integers(5, 25)), endpoint=False):
        end = radius * np.array([np.cos(turn), 0, np.sin(turn)])
        parts.append(wire(rng, np.linspace(0 * end, end, 3), radius * rng.uniform(0.006, 0.02)))
    return merged(parts).standing()


def foliage(rng: np.random.Generator, height: float) -> Solid:
    """A plant of stems and many leaves."""
    parts = []
    leaf = sheet(1.0, 1.0, cell=1.0)
    size = height * rng.uniform(0.06, 0.22)
    for _ in range(int(rng.integers(4, 14))):
        lean = rng.normal(size=2) * rng.uniform(0.1, 0.5)
        t = np.linspace(0, 1, 5)[:, None]
        stem = np.concatenate([lean * t**1.5, t], axis=1) * height * rng.uniform(0.4, 1)
        parts.append(wire(rng, stem, height * 0.008))
        for _ in range(int(rng.integers(3, 12))):
            at = stem[int(rng.integers(1, 5))] + rng.normal(size=3) * size * 0.8
            frame = np.linalg.qr(rng.normal(size=(3, 3)))[0] @ np.diag([size, size * rng.uniform(0.2, 0.7), size])
            parts.append(replace(leaf.transformed(frame, at.astype(np.float32)), part=leaf.part + 1))
    return merged(parts).standing()


def merged(solids: Sequence[Solid]) -> Solid:
    """All triangles in one solid; part numbers are kept."""
    return Solid(
        np.concatenate([s.corners for s in solids]),
        np.concatenate([s.normals for s in solids]),
        np.concatenate([s.colors for s in solids]),
        np.concatenate([s.part for s in solids]),
    )

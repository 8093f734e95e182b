"""Photograph a world: materials, lamps with soft shadows, ambient occlusion, highlights, and the true maps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import materials, raster, textures
from .worlds import World

F32 = NDArray[np.float32]
WIDTH, HEIGHT = 320, 240  # pixels of a picture; rendered at twice this
SHADOW_SIDE = 640
CANDIDATES = 3  # places of the camera that are tried; the one that shows the most things is taken


@dataclass(frozen=True, eq=False)
class Shot:
    """One picture with its truth.

    Attributes:
        picture: `[H, W, 3]` uint8.
        things: `[H, W]` uint8, number of the thing, 0 the void.
        inverse: `[H, W]` float16, inverse depth, 1/m, 0 in the void.
        focal: pixels.
    """

    picture: NDArray[np.uint8]
    things: NDArray[np.uint8]
    inverse: NDArray[np.float16]
    focal: float


@dataclass(frozen=True, eq=False)
class _Pose:
    """A camera: world-to-camera rotation `[3, 3]`, eye `[3]` and focal length in pixels of the oversampled picture."""

    turn: F32
    eye: F32
    focal: float

    def see(self, points: F32) -> F32:
        """Points `[..., 3]` in camera space."""
        return np.asarray((points - self.eye) @ self.turn.T, np.float32)


def photograph(world: World, rng: np.random.Generator, prints: F32) -> Shot | None:
    """A picture from a random place with random materials and light; None where the view shows too little."""
    poses = [_pose(world, rng) for _ in range(CANDIDATES)]
    pose = max(poses, key=lambda p: _variety(world, p))
    size = (2 * WIDTH, 2 * HEIGHT)
    inverse, face, bary = raster.rasterise(pose.see(world.solid.corners), pose.focal, *size)
    things = np.where(face >= 0, world.thing[np.maximum(face, 0)], 0).astype(np.uint8)
    if not _worth(things, inverse):
        return None
    rgb = _shaded(world, rng, prints, pose, (inverse, face, bary))
    rgb = rgb.reshape(HEIGHT, 2, WIDTH, 2, 3).mean(axis=(1, 3))
    shown = (np.clip(_developed(rgb, rng), 0, 1) * 255 + 0.5).astype(np.uint8)
    return Shot(shown, things[1::2, 1::2].copy(), inverse[1::2, 1::2].astype(np.float16), pose.focal / 2)


def _variety(world: World, pose: _Pose) -> int:
    """How many things a view shows, judged at an eighth of the size."""
    _, face, _ = raster.rasterise(pose.see(world.solid.corners), pose.focal / 8, WIDTH // 4, HEIGHT // 4)
    return int((np.bincount(world.thing[face[face >= 0]], minlength=1) > 4).sum())


def _worth(things: NDArray[np.uint8], inverse: F32) -> bool:
    """Whether a view shows several things, none of them over most of the picture or right before the lens."""
    count = np.bincount(things.reshape(-1), minlength=8) / things.size
    several = (count > 0.002).sum() >= 4
    return bool(several and count[7:].max(initial=0) < 0.6 and count.max() < 0.85 and (inverse > 5).mean() < 0.15)


def _look(eye: F32, target: F32, focal: float, roll: float = 0.0) -> _Pose:
    forward = target - eye
    forward = forward / max(1e-6, float(np.linalg.norm(forward)))
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right = right / max(1e-6, float(np.linalg.norm(right))) if np.linalg.norm(right) > 1e-4 else np.array([1.0, 0, 0])
    down = np.cross(forward, right)
    c, s = np.cos(roll), np.sin(roll)
    turn = np.stack([c * right + s * down, -s * right + c * down, forward]).astype(np.float32)
    return _Pose(turn, np.asarray(eye, np.float32), focal)


def _pose(world: World, rng: np.random.Generator) -> _Pose:
    low, high, (near, far) = world.inside
    target = world.targets[int(rng.integers(len(world.targets)))] + rng.normal(size=3) * 0.15 * near
    for _ in range(20):
        away = rng.normal(size=3) * [1, 1, 0.6]
        away[2] = abs(away[2]) if rng.random() < 0.8 else away[2]
        eye = target + away / np.linalg.norm(away) * rng.uniform(near, far)
        if ((eye > low) & (eye < high)).all():
            break
    eye = np.clip(eye, low, high)
    focal = HEIGHT / np.tan(np.radians(rng.uniform(28, 65)) / 2)
    return _look(eye.astype(np.float32), target.astype(np.float32), float(focal), float(rng.normal() * 0.06))


def _materials(world: World, rng: np.random.Generator) -> F32:
    """A row for each part of the world."""
    palette = materials.Palette(rng, float(rng.choice([0.0, 0.3, 0.8], p=[0.4, 0.4, 0.2])))
    rows = np.zeros((len(world.looks), textures.WIDTH), np.float32)
    start = 0
    while start < len(rows):
        role, thing = world.looks[start]
        stop = start
        while stop < len(rows) and world.looks[stop] == (role, thing):
            stop += 1
        if role == "thing":
            points = world.solid.corners[world.thing == thing].reshape(-1, 3)
            rows[start:stop] = materials.of_thing(palette, stop - start, float(np.ptp(points, axis=0).max()))
        else:
            weights = materials.FLOORS if role == "floor" else materials.WALLS
            rows[start:stop] = materials.material(palette, weights, 3.0)
            if role == "wall" and start > 0 and world.looks[start - 1][0] == "wall" and rng.random() < 0.85:
                rows[start:stop] = rows[start - 1]  # walls of a room are mostly painted alike
        start = stop
    return rows


def _shaded(
    world: World, rng: np.random.Generator, prints: F32, pose: _Pose, buffers: tuple[F32, raster.I32, F32]
) -> F32:
    """Linear light `[2H, 2W, 3]`."""
    inverse, face, bary = buffers
    height, width = face.shape
    hit = np.flatnonzero(face.reshape(-1) >= 0)
    f, corner = face.reshape(-1)[hit], bary.reshape(-1, 2)[hit]
    rows, uv = world.solid.part[f], raster.interpolated(world.local, f, corner)
    table = _materials(world, rng)
    own = raster.interpolated(world.solid.colors, f, corner)
    albedo = textures.paint(table, rows, uv, own, prints)
    normal = raster.interpolated(world.solid.normals, f, corner) @ pose.turn.T
    normal[:, :2] += textures.bumps(table, rows, uv)
    point = raster.lifted(hit, inverse, pose.focal)
    raster.face_viewer(normal, point)
    light, shine = _lamps(world, rng, pose, (point, normal, table[rows, textures.Slot.SHARP]))
    whole = np.zeros((height * width, 3), np.float32)
    whole[hit] = normal
    ways = rng.normal(size=(512, 3)).astype(np.float32)
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    hidden = raster.occlusion(
        inverse[::2, ::2].copy(), whole.reshape(height, width, 3)[::2, ::2].copy(), pose.focal / 2,
        float(rng.uniform(0.08, 0.5)), ways,
    )  # fmt: skip
    soft = _blurred(hidden, 1).repeat(2, axis=0).repeat(2, axis=1).reshape(-1)[hit]
    up = normal @ (pose.turn @ np.array([0, 0, 1], np.float32))
    dim = np.clip(1 - np.float32(rng.uniform(0.5, 1.5)) * soft, 0.05, 1)
    ambient = np.float32(rng.uniform(0.1, 0.7)) * (1 + np.float32(rng.uniform(0, 0.4)) * up) * dim
    whole[:] = rng.uniform(0, 1, 3) ** 2.2
    tint, gloss = rng.uniform(0.85, 1.1, 3).astype(np.float32), table[rows, textures.Slot.GLOSS]
    whole[hit] = albedo**2.2 * (ambient[:, None] * tint + light) + gloss[:, None] * shine
    return whole.reshape(height, width, 3)


def _blurred(image: F32, radius: int) -> F32:
    """Box blur `[H, W]`."""
    from scipy.ndimage import uniform_filter

    blurred: F32 = uniform_filter(image, 2 * radius + 1, mode="nearest")
    return blurred


def _lamps(world: World, rng: np.random.Generator, pose: _Pose, surface: tuple[F32, F32, F32]) -> tuple[F32, F32]:
    """Diffuse light and highlights `[M, 3]` of one to three lamps; most cast shadows."""
    point, normal, sharp = surface
    low, high, _ = world.inside
    light, shine = np.zeros_like(point), np.zeros_like(point)
    middle = world.targets.mean(axis=0)
    there = point @ pose.turn + pose.eye
    for _ in range(int(rng.integers(1, 4))):
        at = (low + (high - low) * rng.uniform(-0.05, 1.05, 3)).astype(np.float32)
        at[2] = high[2] + rng.uniform(-0.3, 0.4)
        strength = (rng.uniform(0.2, 1.6) * rng.uniform(0.7, 1.1, 3)).astype(np.float32)
        lit = np.ones(len(point), np.float32)
        if rng.random() < 0.75:
            toward = middle.astype(np.float32) + rng.normal(size=3).astype(np.float32) * 0.1
            lamp = _look(at, toward, SHADOW_SIDE * 0.35)
            buffer, _, _ = raster.rasterise(lamp.see(world.solid.corners), lamp.focal, SHADOW_SIDE, SHADOW_SIDE)
            lit = raster.shadow(lamp.see(there), buffer, lamp.focal, int(rng.integers(1, 7)), 0.012)
        lamp_at = pose.see(at)
        raster.lamp((point, normal, sharp, lit), lamp_at, strength, float(rng.uniform(1, 6)), light, shine)
    return light, shine


def _developed(linear: F32, rng: np.random.Generator) -> F32:
    """Display values of linear light: exposure on the median or the highlights, and a tone curve."""
    level = np.quantile(linear.mean(axis=2), rng.uniform(0.4, 0.8))
    rgb = linear * (rng.uniform(0.12, 0.5) / max(level, 1e-4))
    if rng.random() < 0.6:
        rgb = rgb * (1 + rgb / 4) / (1 + rgb)  # Reinhard et al. 2002, white at 2
    shown: F32 = np.clip(rgb, 0, None) ** (1 / rng.uniform(1.9, 2.5))
    return shown

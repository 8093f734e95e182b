"""Photograph rooms of Gaussians with the renderer that users have, intact and degraded as trained scenes are."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...gaussians import assets
from ...gaussians.camera import Camera
from ...gaussians.cloud import GaussianCloud
from ...gaussians.render import render
from .. import damage
from .shading import HEIGHT, WIDTH, Shot
from .worlds import STRUCTURE

_C0 = 0.28209479177387814
LEAST = 4  # things that a view must show


def shots(rng: np.random.Generator, count: int) -> list[Shot]:
    """Up to `count` pictures of one furnished room; floor and walls are told apart by their place."""
    room = assets.furnish(
        int(rng.integers(1 << 30)), detail=float(rng.choice([0.5, 1.0])), ceiling=bool(rng.random() < 0.5)
    )
    owner = room.truth.ids.numpy()
    number = np.where(owner >= 0, owner + STRUCTURE + 1, _structure(room))
    cloud = room.scene.cloud.with_degree(0)
    cloud = cloud.replace(group=torch.from_numpy(number.astype(np.int32)))
    cloud = cloud[torch.from_numpy(~_behind_hung(room))]
    result: list[Shot] = []
    for _ in range(2 * count):
        if len(result) == count:
            break
        shot = _shot(_degraded(cloud, rng), _camera(room, rng))
        if shot is not None:
            result.append(shot)
    return result


def _structure(room: assets.Room) -> NDArray[np.int64]:
    """Number of floor (1), wall (2 to 5) or ceiling (6) for each Gaussian, by the face it is closest to."""
    xyz = room.scene.cloud.means.numpy()
    w, d, h = room.size
    away = np.abs(
        [xyz[:, 2], d / 2 - xyz[:, 1], w / 2 + xyz[:, 0], d / 2 + xyz[:, 1], w / 2 - xyz[:, 0], h - xyz[:, 2]]
    )
    return np.asarray(away.argmin(axis=0) + 1)


def _behind_hung(room: assets.Room) -> NDArray[np.bool_]:
    """The wall right behind hung things: it is hidden, but its Gaussians would win single pixels of flat things."""
    owner, xyz = room.truth.ids.numpy(), room.scene.cloud.means.numpy()
    hung = np.isin(owner, [o.id for o in room.truth.objects if o.support == "wall"])
    if not hung.any():
        return hung
    near = cKDTree(xyz[hung]).query(xyz, distance_upper_bound=0.06)[0]
    return np.asarray((owner < 0) & np.isfinite(near))


def _degraded(cloud: GaussianCloud, rng: np.random.Generator) -> GaussianCloud:
    """Thinned, moved, grown and discoloured to a random degree, objects recoloured, in two of three pictures."""
    result = cloud
    group = cloud.group.numpy()
    if rng.random() < 0.7:  # other colours for things: a gain and a tint each
        gain = np.exp(
            rng.normal(size=(int(group.max()) + 1, 3)) * 0.25 + rng.normal(size=(int(group.max()) + 1, 1)) * 0.35
        )
        rgb = np.clip(cloud.sh[:, 0].numpy() * _C0 + 0.5, 0, 1) * gain[group]
        result = result.replace(sh=torch.from_numpy(((np.clip(rgb, 0, 1) - 0.5) / _C0).astype(np.float32))[:, None])
    if rng.random() < 0.67:
        drop = float(rng.uniform(0, 0.6))
        result = damage.thinned(result.replace(ids=torch.arange(len(result))), rng, drop)
        noise = torch.from_numpy(rng.normal(size=(len(result), 1, 3)).astype(np.float32)) * float(rng.uniform(0, 0.25))
        result = result.replace(sh=result.sh + noise)
    return result


def _camera(room: assets.Room, rng: np.random.Generator) -> Camera:
    w, d, h = room.size
    thing = room.truth.objects[int(rng.integers(len(room.truth.objects)))]
    target = np.array(thing.position) + rng.normal(size=3) * 0.2
    for _ in range(20):
        away = rng.normal(size=3) * [1, 1, 0.4]
        away[2] = abs(away[2])
        eye = target + away / np.linalg.norm(away) * rng.uniform(0.7, 3.5)
        if abs(eye[0]) < w / 2 - 0.2 and abs(eye[1]) < d / 2 - 0.2 and 0.4 < eye[2] < h - 0.2:
            break
    eye = np.clip(eye, [-w / 2 + 0.2, -d / 2 + 0.2, 0.4], [w / 2 - 0.2, d / 2 - 0.2, h - 0.2])
    return Camera.look_at(eye, target, (0.0, 0.0, 1.0), WIDTH, HEIGHT, float(rng.uniform(30, 65)))


def _shot(cloud: GaussianCloud, camera: Camera) -> Shot | None:
    seen = render(cloud, camera)
    things = np.maximum(seen.group.numpy(), 0)
    count = np.bincount(things.reshape(-1)) / things.size
    if (count > 0.003).sum() < LEAST or count.max() > 0.8 or len(count) > 255:
        return None
    depth = seen.depth.numpy()
    inverse = np.where((depth > 0.03) & (seen.alpha.numpy() > 0.5), 1 / np.maximum(depth, 0.03), 0)
    return Shot(seen.to_uint8(), things.astype(np.uint8), inverse.astype(np.float16), camera.fy)

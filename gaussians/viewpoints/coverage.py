"""Chooses few cameras that together see every visible Gaussian of a scene, and a default camera for viewing it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy
import torch
from numpy.typing import NDArray

from ..camera import Camera
from ..cloud import GaussianCloud
from ..render import contributions
from ..scene import Frame, Scene

F64 = NDArray[np.float64]

SIZE = 160  # pixels per side of the views that are compared
SEEN = 0.01  # summed blending weight (pixels at SIZE) from which a Gaussian counts as seen
COVERAGE = 0.985  # share of the Gaussians that any candidate sees, at which the choice ends
MIN_GAIN = 0.003  # share of all Gaussians that a further view must add
MAX_VIEWS = 24
SAMPLE = 160_000  # Gaussians considered; more do not change the choice of views
GROUND_SHARE = 0.12  # of the scene's height, counted as the ground and what lies on it
EYE_HEIGHT = 0.55  # share of the scene's height, for cameras inside
PLAN_CELLS = 24  # per side of the floor plan in which free space is searched


@dataclass(frozen=True)
class Views:
    """Chosen cameras and what they see.

    Attributes:
        cameras: best first.
        rows: `[S]` int64, the rows of the cloud that were considered: all, or an even sample of a large cloud.
        seen_by: `[V, S]` bool, which of these rows each camera sees.
        unseen: share of these rows that no candidate sees.
    """

    cameras: tuple[Camera, ...]
    rows: NDArray[np.int64]
    seen_by: NDArray[np.bool_]
    unseen: float

    def count_of(self, rows: NDArray[np.int64]) -> int:
        """Number of views that see more than a twentieth of the Gaussians at `rows [M]`."""
        within = np.isin(self.rows, rows, assume_unique=True, kind="table")
        return int((self.seen_by[:, within].mean(axis=1) > 0.05).sum()) if within.any() else 0


def choose_views(scene: Scene, max_views: int = MAX_VIEWS, size: int = SIZE) -> Views:
    """Greedy set cover by at most `max_views` views of `size` pixels per side.

    The candidates are the scene's own cameras, and cameras around and inside it if its own are fewer than `max_views`.
    """
    rows, cloud = sample(scene.cloud)
    own = [_downscaled(c, size) for c in scene.cameras]
    pool = own if len(own) >= max_views else own + candidates(scene.cloud, scene.frame, size)
    if not len(cloud) or not pool:
        return Views((), rows, np.zeros((0, len(rows)), bool), 0.0)
    if len(pool) > 4 * max_views:
        pool = [pool[i] for i in np.linspace(0, len(pool) - 1, 4 * max_views).astype(int)]
    seen = np.stack([(contributions(cloud, c) > SEEN).numpy() for c in pool])
    visible = int(seen.any(axis=0).sum())
    covered = np.zeros(len(cloud), bool)
    chosen: list[int] = []
    while len(chosen) < max_views and covered.sum() < COVERAGE * visible:
        gain = (seen & ~covered).sum(axis=1)
        best = int(np.argmax(gain))
        if chosen and gain[best] < MIN_GAIN * len(cloud):
            break
        chosen.append(best)
        covered |= seen[best]
    return Views(tuple(pool[i] for i in chosen), rows, seen[chosen], 1 - visible / len(cloud))


def sample(cloud: GaussianCloud) -> tuple[NDArray[np.int64], GaussianCloud]:
    """Rows and cloud of at most SAMPLE Gaussians, enlarged so that they cover the same surfaces as all."""
    step = max(1, -(-len(cloud) // SAMPLE))
    rows = np.arange(0, len(cloud), step)
    part = cloud[::step]
    return rows, part.replace(scales=part.scales * float(np.sqrt(step)))


def default_viewer(scene: Scene, width: int = 640, height: int = 480) -> Camera:
    """The scene's first camera at this size, or the candidate that sees most of the scene."""
    if scene.cameras:
        return fit_camera(scene.cameras[0], width, height)
    pool = candidates(scene.cloud, scene.frame, 96)
    if not pool:
        return Camera.look_at([0, -3, 1], [0, 0, 0], scene.frame.up, width, height)
    _, cloud = sample(scene.cloud)
    heights = scene.frame.heights(cloud.means.numpy())
    low, high = np.quantile(heights, [0.02, 0.98])
    raised = torch.from_numpy(heights > low + GROUND_SHARE * (high - low))
    scores = [_score(cloud, c, raised) for c in pool]
    return fit_camera(pool[int(np.argmax(scores))], width, height)


def fit_camera(camera: Camera, width: int, height: int) -> Camera:
    """The same pose at another image size: the old view stays whole and centred, the longer side shows more."""
    gain = min(width / camera.width, height / camera.height)
    cx = width / 2 + gain * (camera.cx - camera.width / 2)
    cy = height / 2 + gain * (camera.cy - camera.height / 2)
    return replace(camera, fx=camera.fx * gain, fy=camera.fy * gain, cx=cx, cy=cy, width=width, height=height)


def candidates(cloud: GaussianCloud, frame: Frame, size: int) -> list[Camera]:
    """Cameras on two rings around the scene, in its free space at eye height, and around its densest detail."""
    if not len(cloud):
        return []
    solid = cloud.opacities > 0.1
    means = (cloud.means[solid] if bool(solid.any()) else cloud.means).numpy()
    points = means[:: max(1, len(means) // 50_000)].astype(np.float64)
    basis = frame.basis()
    local = points @ basis.T
    low, high = np.quantile(local, 0.02, axis=0), np.quantile(local, 0.98, axis=0)
    return _around(low, high, frame, size) + _inside(local, low, high, frame, size) + _toward(local, frame, size)


def _around(low: F64, high: F64, frame: Frame, size: int) -> list[Camera]:
    basis, center, half = frame.basis(), (low + high) / 2, (high - low) / 2
    radius = 2.2 * float(np.linalg.norm(half)) + 1e-6
    eyes = []
    for elevation in (18.0, 42.0):
        for azimuth in np.arange(8) * 45.0 - 90.0 + (22.5 if elevation > 30 else 0.0):
            a, e = np.radians(azimuth), np.radians(elevation)
            eyes.append(center + radius * np.array([np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)]))
    target = center @ basis
    return [
        Camera.look_at(eye @ basis, target, frame.up, size, size, 46.0, f"around {i}") for i, eye in enumerate(eyes)
    ]


def _inside(local: F64, low: F64, high: F64, frame: Frame, size: int) -> list[Camera]:
    """Cameras over free cells of the floor plan, far apart, in six directions each, tilted slightly down."""
    span = np.maximum(high - low, 1e-9)
    eye_height = low[2] + EYE_HEIGHT * span[2]
    cell = span[:2] / PLAN_CELLS
    body = (local[:, 2] > low[2] + 0.35 * span[2]) & (local[:, 2] < low[2] + 0.75 * span[2])
    index = np.clip(((local[body, :2] - low[:2]) / cell).astype(int), 0, PLAN_CELLS - 1)
    taken = np.zeros((PLAN_CELLS, PLAN_CELLS), bool)
    taken[index[:, 0], index[:, 1]] = True
    clear = scipy.ndimage.distance_transform_edt(np.pad(~taken, 1))[1:-1, 1:-1]
    basis, cameras = frame.basis(), []
    for spot in range(5):
        i, j = np.unravel_index(int(np.argmax(clear)), clear.shape)
        if clear[i, j] < 2:
            break
        eye = np.array([*(low[:2] + (np.array([i, j]) + 0.5) * cell), eye_height])
        for k in range(6):
            a = np.radians(60 * k)
            aim = eye + np.array([np.cos(a), np.sin(a), -0.35])
            cameras.append(Camera.look_at(eye @ basis, aim @ basis, frame.up, size, size, 70.0, f"inside {spot}.{k}"))
        grid = np.stack(np.meshgrid(*[np.arange(PLAN_CELLS)] * 2, indexing="ij"), axis=-1)
        clear = np.where(np.linalg.norm(grid - [i, j], axis=-1) < PLAN_CELLS / 4, 0, clear)
    return cameras


def _toward(local: F64, frame: Frame, size: int) -> list[Camera]:
    """Cameras around the densest detail, for captures of one object in a larger room."""
    from scipy.spatial import cKDTree

    above = local[local[:, 2] >= np.quantile(local[:, 2], 0.35)]
    focus = np.median(above, axis=0)
    reach = float(np.median(np.linalg.norm(above - focus, axis=1))) + 1e-9
    tree = cKDTree(local)
    basis, cameras = frame.basis(), []
    for k, distance in enumerate((1.0, 1.6, 2.8)):
        for azimuth in np.radians(np.arange(8) * 45.0 + 22.5 * k - 90.0):
            eye = focus + distance * reach * np.array([np.cos(azimuth), np.sin(azimuth), 0.45])
            if float(tree.query(eye)[0]) > 0.12 * reach:
                cameras.append(Camera.look_at(eye @ basis, focus @ basis, frame.up, size, size, 55.0, "toward"))
    return cameras


def _score(cloud: GaussianCloud, camera: Camera, raised: torch.Tensor) -> float:
    """Share of the Gaussians above the ground that a view sees, reduced by the empty share of its image."""
    weight = contributions(cloud, camera)
    seen = float((weight[raised] > SEEN).sum()) / max(int(raised.sum()), 1)
    filled = float(weight.sum()) / (camera.width * camera.height)
    return seen * min(1.0, 0.6 + filled)


def _downscaled(camera: Camera, size: int) -> Camera:
    gain = size / max(camera.width, camera.height)
    return camera.resized(max(1, round(camera.width * gain)), max(1, round(camera.height * gain)))

"""Chooses a ring of cameras to orbit a scene: fitted to its photographs, or by how much of the scene its views show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from ..cloud import GaussianCloud
from ..render import contributions
from ..scene import Frame, Scene
from .coverage import GROUND_SHARE, SEEN, fit_camera, sample

F64 = NDArray[np.float64]

MIN_CAMERAS = 8  # from which an orbit can be fitted; fewer cameras are single views
AGREEMENT = 0.8  # share of the cameras that must look towards, or away from, the point where their axes meet
MAX_GAP = 100.0  # degrees of the ring without photographs; with a wider gap the orbit swings back and forth
FOV = 50.0  # degrees, where no photographs give it
MIDDLE = 0.75  # share of the scene's extent that an orbit should show; walls and far background lie outside
DISTANCES = (0.7, 1.0, 1.4, 2.0, 2.8)  # radii that are tried, in median distances of the scene from its focus
ELEVATIONS = (10.0, 28.0)  # degrees
FRAMING_DISTANCES = (1.2, 1.4, 1.7, 2.1, 2.5)  # half diagonals; the first that frames the whole scene is taken
FRAMED = 0.99  # share of the points in an image that counts as the whole scene
FRAMED_WEIGHT = 2.0  # of the score of a ring that frames all: right for a single object, of a room it shows only walls
SCORED_VIEWS = 8  # by which a ring is scored
SCORED_SIZE = 128  # pixels per side of these views


@dataclass(frozen=True, eq=False)
class Ring:
    """A level circle of camera positions.

    Attributes:
        frame: the scene's frame; the circle is perpendicular to its up.
        center: `[3]`, world, at the height of the cameras.
        radius: scene units; 0 rotates on the spot.
        target: `[3]`, world, the point that every camera looks at; None looks outward.
        pitch: degrees below the horizon, for cameras that look outward.
        fov: degrees, of the image's shorter side.
        start: degrees, the azimuth of the first camera in the frame's basis.
        arc: degrees that are swept: 360 is a full orbit, less swings from `start` to its end and back.
    """

    frame: Frame
    center: F64
    radius: float
    target: F64 | None
    pitch: float = 0.0
    fov: float = FOV
    start: float = -90.0
    arc: float = 360.0

    def cameras(self, count: int, width: int, height: int) -> list[Camera]:
        """`count` cameras along the orbit or swing; the camera after the last would be the first again."""
        turns = np.arange(count) / count
        swept = turns if self.arc >= 360 else (1 - np.cos(2 * np.pi * turns)) / 2
        return [
            fit_camera(self._camera(a, f"orbit {i}"), width, height)
            for i, a in enumerate(self.start + self.arc * swept)
        ]

    def _camera(self, azimuth: float, name: str) -> Camera:
        a, p = np.radians(azimuth), np.radians(self.pitch)
        east, north, up = self.frame.basis()
        outward = np.cos(a) * east + np.sin(a) * north
        eye = self.center + self.radius * outward
        aim = self.target if self.target is not None else eye + np.cos(p) * outward - np.sin(p) * up
        return Camera.look_at(eye, aim, up, SCORED_SIZE, SCORED_SIZE, self.fov, name)


def choose_ring(scene: Scene, cameras: Sequence[Camera] = ()) -> Ring:
    """The ring for an orbit of a scene whose frame is known or estimated.

    `cameras` are those of its photographs. If there are none, or if they look neither at one point nor outward from
    it, the ring is searched around the middle of the scene.
    """
    return (_ring_of_cameras(scene.frame, cameras) if cameras else None) or _best_ring(scene)


def _ring_of_cameras(frame: Frame, cameras: Sequence[Camera]) -> Ring | None:
    """The ring on which photographs were taken: around what they show, or on the spot if they look outward."""
    eyes, axes = np.stack([c.position for c in cameras]), np.stack([c.forward for c in cameras])
    basis = frame.basis()
    fov = float(np.median([2 * np.degrees(np.arctan(0.5 * min(c.width / c.fx, c.height / c.fy))) for c in cameras]))
    across = np.eye(3) - axes[:, :, None] * axes[:, None, :]  # [V, 3, 3], projectors perpendicular to each axis
    if np.linalg.cond(across.sum(axis=0)) > 1e4:  # parallel axes meet nowhere
        return None
    focus = np.linalg.solve(across.sum(axis=0), np.einsum("vij,vj->i", across, eyes))
    ahead = float((np.einsum("vi,vi->v", focus - eyes, axes) > 0).mean())
    if ahead <= 1 - AGREEMENT:
        pitch = float(np.degrees(np.arcsin(np.clip(np.median(-axes @ basis[2]), -1, 1))))
        return Ring(frame, np.median(eyes, axis=0), 0.0, None, pitch, fov)
    if ahead < AGREEMENT:
        return None
    local = (eyes - focus) @ basis.T
    radius = float(np.median(np.hypot(local[:, 0], local[:, 1])))
    if not radius > 0:
        return None
    center = focus + float(np.median(local[:, 2])) * basis[2]
    azimuths = np.degrees(np.arctan2(local[:, 1], local[:, 0]))
    gaps = np.diff(np.append(np.sort(azimuths), azimuths.min() + 360))
    widest = int(np.argmax(gaps))
    if gaps[widest] <= MAX_GAP:
        return Ring(frame, center, radius, focus, fov=fov, start=float(azimuths[0]))
    start = float(np.append(np.sort(azimuths), azimuths.min() + 360)[widest + 1])
    return Ring(frame, center, radius, focus, fov=fov, start=start, arc=float(360 - gaps[widest]))


def _best_ring(scene: Scene) -> Ring:
    """The ring whose worst view shows most of the scene's middle; for a single object, one that frames all of it.

    From outside a room its middle is hidden. From too near, most of it is outside the image or occluded.
    """
    _, cloud = sample(scene.cloud)
    basis = scene.frame.basis()
    local = cloud.means.numpy().astype(np.float64) @ basis.T
    solid = (cloud.opacities > 0.1).numpy()
    solid = solid if solid.any() else np.ones(len(cloud), bool)
    low, high = np.quantile(local[solid], 0.02, axis=0), np.quantile(local[solid], 0.98, axis=0)
    raised = solid & (local[:, 2] > low[2] + GROUND_SHARE * (high[2] - low[2]))
    raised = raised if raised.any() else solid
    middle = raised & (np.abs(local - (low + high) / 2) <= MIDDLE * (high - low) / 2).all(axis=1)
    middle = middle if middle.any() else raised
    focus = np.median(local[raised], axis=0)
    reach = float(np.median(np.linalg.norm(local[raised] - focus, axis=1))) + 1e-6
    tried = [(_ring_about(scene.frame, focus, d * reach, e), 1.0) for e in ELEVATIONS for d in DISTANCES]
    some = local[solid][:: max(1, int(solid.sum()) // 20_000)]
    tried += [(_framing_ring(scene.frame, some, low, high, e), FRAMED_WEIGHT) for e in ELEVATIONS]
    scored = [(_score(ring, cloud, middle), ring, weight) for ring, weight in tried]
    (_, first), ring, _ = max(scored, key=lambda t: t[0][0] * t[2])
    return replace(ring, start=ring.start + 360 / SCORED_VIEWS * first)


def _ring_about(frame: Frame, focus: F64, distance: float, elevation: float) -> Ring:
    """Cameras that look at `focus` `[3]` (in the frame's basis) from `elevation` degrees above the horizon."""
    e = np.radians(elevation)
    center = focus + distance * np.sin(e) * np.array([0.0, 0.0, 1.0])
    basis = frame.basis()
    return Ring(frame, center @ basis, distance * float(np.cos(e)), focus @ basis)


def _framing_ring(frame: Frame, points: F64, low: F64, high: F64, elevation: float) -> Ring:
    """The nearest ring around the box from `low` to `high` whose every image holds nearly all `points` `[P, 3]`.

    All coordinates are in the frame's basis.
    """
    half = float(np.linalg.norm(high - low)) / 2 + 1e-6
    world = points @ frame.basis()
    for distance in FRAMING_DISTANCES:
        ring = _ring_about(frame, (low + high) / 2, distance * half, elevation)
        if min(_framed(camera, world) for camera in ring.cameras(SCORED_VIEWS, SCORED_SIZE, SCORED_SIZE)) >= FRAMED:
            break
    return ring


def _framed(camera: Camera, points: F64) -> float:
    """Share of world points that lie within the image."""
    pixels, depth = camera.project(points)
    return float(((depth > 0) & (pixels >= 0).all(axis=1) & (pixels <= SCORED_SIZE).all(axis=1)).mean())


def _score(ring: Ring, cloud: GaussianCloud, middle: NDArray[np.bool_]) -> tuple[float, int]:
    """A ring's score and the index of its best view.

    The score is the share of the middle that the worst view shows, times the share that all views show together.
    """
    views = ring.cameras(SCORED_VIEWS, SCORED_SIZE, SCORED_SIZE)
    seen = np.stack([(contributions(cloud, camera) > SEEN).numpy()[middle] for camera in views])
    shown = seen.mean(axis=1)
    return float(shown.min() * seen.any(axis=0).mean()), int(np.argmax(shown))

"""A ring of eyes to turn about a scene on: where its photographs were taken, or where most of its middle is seen.

Knows clouds, cameras and the renderer's blending weights. Refuses to know how many pictures are made of it, and files.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from ..cloud import GaussianCloud
from ..render import contributions
from ..scene import Frame, Scene
from .coverage import ABOVE, SEEN, fit_camera, sample

F64 = NDArray[np.float64]

FEWEST = 8  # cameras that say how a place was walked around; fewer are single views
AGREE = 0.8  # of the cameras that must look towards, or away from, what their axes meet in
GAP = 100.0  # degrees of the ring that nobody photographed, from which the orbit swings to and fro instead
FOV = 50.0  # degrees, of eyes of our own choice
MIDDLE = 0.75  # of the scene's extent: what lies within is what an orbit is to show, not walls and far background
DISTANCES = (0.7, 1.0, 1.4, 2.0, 2.8)  # of the middle half's extent
ELEVATIONS = (10.0, 28.0)  # degrees
WHOLE = (1.2, 1.4, 1.7, 2.1, 2.5)  # half diagonals away: the first from which next to all is in the picture is taken
NEXT_TO_ALL = 0.99
WORTH = 2.0  # times, to have all in the picture: of a thing alone that is wanted, of a room only its walls are seen
LOOKS = 8  # pictures by which a ring is judged
SIDE = 128  # pixels of each


@dataclass(frozen=True, eq=False)
class Ring:
    """A level circle of eyes.

    Attributes:
        frame: whose up the circle is level to.
        center: `[3]`, world, at the eyes' height.
        radius: scene units; 0 turns on the spot.
        target: `[3]`, world, what every eye looks at; None looks outward.
        pitch: degrees below the horizon, where it looks outward.
        fov: degrees, of the picture's shorter side.
        start: degrees, the first eye's azimuth in the frame's basis.
        arc: degrees that are swept: 360 goes round, less swings from `start` to the end and back.
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
        """`count` cameras evenly round, or to and fro; the one after the last would be the first again."""
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
        return Camera.look_at(eye, aim, up, SIDE, SIDE, self.fov, name)


def choose_ring(scene: Scene, cameras: Sequence[Camera] = ()) -> Ring:
    """Where to turn about a scene, whose frame must be known or estimated.

    `cameras` say where people stood; if they neither look at one thing nor all outward from their middle, or are none,
    the ring is sought around the middle of the scene.
    """
    return (_walked(scene.frame, cameras) if cameras else None) or _sought(scene)


def _walked(frame: Frame, cameras: Sequence[Camera]) -> Ring | None:
    """The ring on which photographs were taken: about what they show, or on the spot if they look outward."""
    eyes, axes = np.stack([c.position for c in cameras]), np.stack([c.forward for c in cameras])
    basis = frame.basis()
    fov = float(np.median([2 * np.degrees(np.arctan(0.5 * min(c.width / c.fx, c.height / c.fy))) for c in cameras]))
    across = np.eye(3) - axes[:, :, None] * axes[:, None, :]  # [V, 3, 3], what of a vector is off each axis
    if np.linalg.cond(across.sum(axis=0)) > 1e4:  # parallel axes meet nowhere
        return None
    focus = np.linalg.solve(across.sum(axis=0), np.einsum("vij,vj->i", across, eyes))
    ahead = float((np.einsum("vi,vi->v", focus - eyes, axes) > 0).mean())
    if ahead <= 1 - AGREE:
        pitch = float(np.degrees(np.arcsin(np.clip(np.median(-axes @ basis[2]), -1, 1))))
        return Ring(frame, np.median(eyes, axis=0), 0.0, None, pitch, fov)
    if ahead < AGREE:
        return None
    local = (eyes - focus) @ basis.T
    radius = float(np.median(np.hypot(local[:, 0], local[:, 1])))
    if not radius > 0:
        return None
    center = focus + float(np.median(local[:, 2])) * basis[2]
    azimuths = np.degrees(np.arctan2(local[:, 1], local[:, 0]))
    gaps = np.diff(np.append(np.sort(azimuths), azimuths.min() + 360))
    widest = int(np.argmax(gaps))
    if gaps[widest] <= GAP:
        return Ring(frame, center, radius, focus, fov=fov, start=float(azimuths[0]))
    start = float(np.append(np.sort(azimuths), azimuths.min() + 360)[widest + 1])
    return Ring(frame, center, radius, focus, fov=fov, start=start, arc=float(360 - gaps[widest]))


def _sought(scene: Scene) -> Ring:
    """The ring whose worst view shows most of the scene's middle; for a thing alone, one that shows all of it.

    From outside a room the middle is hidden; too near, most of it is out of the picture or behind something.
    """
    _, cloud = sample(scene.cloud)
    basis = scene.frame.basis()
    local = cloud.means.numpy().astype(np.float64) @ basis.T
    solid = (cloud.opacities > 0.1).numpy()
    solid = solid if solid.any() else np.ones(len(cloud), bool)
    low, high = np.quantile(local[solid], 0.02, axis=0), np.quantile(local[solid], 0.98, axis=0)
    raised = solid & (local[:, 2] > low[2] + ABOVE * (high[2] - low[2]))
    raised = raised if raised.any() else solid
    middle = raised & (np.abs(local - (low + high) / 2) <= MIDDLE * (high - low) / 2).all(axis=1)
    middle = middle if middle.any() else raised
    focus = np.median(local[raised], axis=0)
    reach = float(np.median(np.linalg.norm(local[raised] - focus, axis=1))) + 1e-6
    tried = [(_about(scene.frame, focus, d * reach, e), 1.0) for e in ELEVATIONS for d in DISTANCES]
    some = local[solid][:: max(1, int(solid.sum()) // 20_000)]
    tried += [(_around(scene.frame, some, low, high, e), WORTH) for e in ELEVATIONS]
    judged = [(_judged(ring, cloud, middle), ring, worth) for ring, worth in tried]
    (_, first), ring, _ = max(judged, key=lambda t: t[0][0] * t[2])
    return replace(ring, start=ring.start + 360 / LOOKS * first)


def _about(frame: Frame, focus: F64, distance: float, elevation: float) -> Ring:
    """Eyes that look down at `focus` `[3]` (in the frame's basis) from `elevation` degrees above the horizon."""
    e = np.radians(elevation)
    center = focus + distance * np.sin(e) * np.array([0.0, 0.0, 1.0])
    basis = frame.basis()
    return Ring(frame, center @ basis, distance * float(np.cos(e)), focus @ basis)


def _around(frame: Frame, points: F64, low: F64, high: F64, elevation: float) -> Ring:
    """The nearest ring about the box from `low` to `high` that has next to all `points` `[P, 3]` in every picture, all
    in the frame's basis.
    """
    half = float(np.linalg.norm(high - low)) / 2 + 1e-6
    for distance in WHOLE:
        ring = _about(frame, (low + high) / 2, distance * half, elevation)
        if min(_framed(camera, points @ frame.basis()) for camera in ring.cameras(LOOKS, SIDE, SIDE)) >= NEXT_TO_ALL:
            break
    return ring


def _framed(camera: Camera, points: F64) -> float:
    """Share of world points that lie within the picture."""
    pixels, depth = camera.project(points)
    return float(((depth > 0) & (pixels >= 0).all(axis=1) & (pixels <= SIDE).all(axis=1)).mean())


def _judged(ring: Ring, cloud: GaussianCloud, middle: NDArray[np.bool_]) -> tuple[float, int]:
    """A ring's score (what its worst view shows of the middle, times what all views show together) and the number of
    its best view.
    """
    views = ring.cameras(LOOKS, SIDE, SIDE)
    seen = np.stack([(contributions(cloud, camera) > SEEN).numpy()[middle] for camera in views])
    shown = seen.mean(axis=1)
    return float(shown.min() * seen.any(axis=0).mean()), int(np.argmax(shown))

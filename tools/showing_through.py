"""What shows a thing of a capture where it is taken away: further layers of it, and how much of its picture stays.

A trained scene draws a surface with several layers of Gaussians, and a segmentation gives the hidden ones to what is
behind. Taking the thing away then leaves its image. Whatever gives the same colours at the same pixels, and lies where
the thing lies, is part of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ..gaussians.camera import Camera
from ..gaussians.cloud import GaussianCloud
from ..gaussians.color import rgb_to_lab
from ..gaussians.render import render, split
from ..gaussians.scene import Scene
from ..gaussians.world.box import Box

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]

VIEWS = 3
SIZE = 96  # pixels of the longer side of the pictures, which show the thing alone
MARGIN = 1.15  # of what the thing fills of a picture: what the picture shows
CLOSE = 9.0  # Lab distance up to which a pixel looks as before
SHOWN = 0.06  # share of the thing's pixels that look as before, from which something shows through
ROUNDS = 2  # layers
OWN = 0.6  # share of what a Gaussian draws there: it has hardly another place where it is seen
FAINT = 0.02  # summed blending weight below which a Gaussian is not seen
PADDED = 0.04  # of its largest side: how far beyond the box of a thing its layers lie
LEAST = 0.02  # share of the pixels of a picture that show the thing
BEYOND = 0.8  # of the size of a picture, from its middle: Gaussians farther out are not drawn
RING = 4  # views around a thing of a scene without cameras


def showing_through(scene: Scene, own: torch.Tensor, box: Box, others: torch.Tensor) -> tuple[torch.Tensor, float]:
    """`[N]` bool: Gaussians that show a thing after it is taken away, and the share of the thing's pixels that would
    look as before even without them.

    Args:
        own: `[N]` bool, the thing.
        box: of its core; what lies lower is what it stands on.
        others: `[N]` bool, what is known to be of other things.
    """
    cloud = scene.cloud
    found = torch.zeros_like(own)
    views = [v for camera in _cameras(scene, box) if (v := _close_up(camera, box)) is not None]
    shown = [s for view in views[:VIEWS] if (s := Shown.of(cloud, own, view)) is not None]
    if not shown:
        return found, 0.0
    free = _within(cloud, box) & ~own & ~others
    for done in range(ROUNDS + 1):
        there, every = np.zeros(len(cloud)), np.zeros(len(cloud))
        same = pixels = 0
        for one in shown:
            rows = one.rows[(~(own | found))[one.rows]]
            rest = cloud[rows]
            alike = one.mask & (np.linalg.norm(_lab(rest, one.view) - one.lab, axis=2) <= CLOSE)
            same, pixels = same + int(alike.sum()), pixels + int(one.mask.sum())
            if done < ROUNDS:
                made = split(rest, one.view, alike.astype(np.int32))
                at = rows.cpu().numpy()[made.rows]
                np.add.at(there, at, made.weights * (made.labels == 1))
                np.add.at(every, at, made.weights)
        left = same / max(pixels, 1)
        taken = torch.from_numpy((there >= OWN * every) & (there > FAINT)).to(cloud.device) & free & ~found
        if left < SHOWN or done == ROUNDS or not bool(taken.any()):
            break
        found |= taken
    return found, left


@dataclass(frozen=True, eq=False)
class Shown:
    """How a view shows a thing.

    Attributes:
        view: a camera cut to the thing.
        rows: `[K]` int64, the Gaussians in its picture.
        mask: `[H, W]` pixels that show the thing.
        lab: `[H, W, 3]` CIE Lab of the picture with the thing.
    """

    view: Camera
    rows: torch.Tensor
    mask: Flags
    lab: F64

    @classmethod
    def of(cls, cloud: GaussianCloud, own: torch.Tensor, view: Camera) -> Shown | None:
        """None where the thing is hardly seen."""
        pixels, depth = view.project(cloud.means.cpu().numpy())
        size = np.array([view.width, view.height])
        inside = (depth > 0) & (np.abs(pixels - size / 2) <= BEYOND * size).all(axis=1)
        rows = torch.from_numpy(np.flatnonzero(inside)).to(cloud.device)
        part = cloud[rows]
        drawn = render(part.replace(group=own[rows].int()), view)
        mask: Flags = ((drawn.group == 1) & (drawn.alpha > 0.5)).cpu().numpy()
        if mask.sum() < LEAST * mask.size:
            return None
        return cls(view, rows, mask, rgb_to_lab(drawn.rgb.double().clamp(0, 1)).cpu().numpy())


def _cameras(scene: Scene, box: Box) -> Sequence[Camera]:
    """Cameras of the scene that see the middle of a box, evenly spaced in their order; views around it where the scene
    has none."""
    center = np.array(box.center)
    if not scene.cameras:
        east, north, up = scene.frame.basis()
        far = 2.5 * max(box.size)
        turns = np.arange(RING) * 2 * np.pi / RING
        eyes = [center + far * (np.cos(t) * east + np.sin(t) * north + 0.35 * up) for t in turns]
        return [Camera.look_at(tuple(e), tuple(center), tuple(up), SIZE, SIZE, 45.0) for e in eyes]
    seen = []
    for camera in scene.cameras:
        ((x, y),), (depth,) = camera.project(center[None])
        if depth > 0 and 0 <= x < camera.width and 0 <= y < camera.height:
            seen.append(camera)
    step = max(1, len(seen) // VIEWS)
    return seen[step // 2 :: step]


def _close_up(camera: Camera, box: Box) -> Camera | None:
    """The camera cut to a box; None if the camera is inside or beside it."""
    pixels, depth = camera.project(box.corners())
    if bool((depth <= 0).any()):
        return None
    low = np.clip(pixels.min(axis=0), 0, (camera.width, camera.height))
    high = np.clip(pixels.max(axis=0), 0, (camera.width, camera.height))
    middle, side = (low + high) / 2, (high - low) * MARGIN
    if min(side) < 2:
        return None
    scale = SIZE / float(max(side))
    width, height = (max(8, round(float(s) * scale)) for s in side)
    cx, cy = ((c - m) * scale + s / 2 for c, m, s in zip((camera.cx, camera.cy), middle, (width, height), strict=True))
    return Camera(camera.world_to_camera, camera.fx * scale, camera.fy * scale, float(cx), float(cy), width, height)


def _lab(cloud: GaussianCloud, view: Camera) -> F64:
    lab: F64 = rgb_to_lab(render(cloud, view).rgb.double().clamp(0, 1)).cpu().numpy()
    return lab


def _within(cloud: GaussianCloud, box: Box) -> torch.Tensor:
    """`[N]` bool: whether a Gaussian lies in a box or close to it, and not below it."""
    local, half = box.local(cloud.means.double().cpu().numpy()), np.array(box.size) / 2
    inside = (np.abs(local) <= half + PADDED * max(box.size)).all(axis=1) & (local[:, 2] >= -half[2])
    return torch.from_numpy(inside).to(cloud.device)

"""Chooses a level of detail for each leaf by what it changes on the screen."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from ..files.formats.streamed_sog import Leaf, Streamed

PIXELS = 1.0  # by which Gaussians may move on the screen, by default: some 40 dB against the finest level
SPACINGS = 0.25  # by how much of their spacing Gaussians are taken to move where the file does not say it
BORDER = 0.15  # of the image, beside it: what lies there may reach into it


def choose(streamed: Streamed, camera: Camera, pixels: float = PIXELS) -> list[int]:
    """The level of each leaf: the coarsest one whose Gaussians are moved by at most `pixels` on the screen.

    They are taken to be where the leaf's box is nearest to the eye. A leaf beside the image has its coarsest level, and
    one around the eye its finest.
    """
    return [
        _level(leaf, _pixels_a_unit(leaf, camera), pixels if _in_view(leaf, camera) else math.inf)
        for leaf in streamed.leaves
    ]


def moved(leaf: Leaf, level: int) -> float:
    """How far the Gaussians of the finest level are from those that stand for them at a level, scene units.

    Where the file does not say it: a share of the distance between neighbours, if they lay evenly on a surface as large
    as half that of the box.
    """
    run = leaf.runs[level]
    if level == 0 or run.moved is not None:
        return run.moved or 0.0
    x, y, z = (b - a for a, b in zip(leaf.low, leaf.high, strict=True))
    return SPACINGS * math.sqrt((x * y + y * z + z * x) / run.count)


def _level(leaf: Leaf, pixels_a_unit: float, pixels: float) -> int:
    fitting = [k for k in leaf.runs if moved(leaf, k) * pixels_a_unit <= pixels]
    return max(fitting) if fitting else min(leaf.runs, default=0)


def _pixels_a_unit(leaf: Leaf, camera: Camera) -> float:
    """Pixels that a unit takes where the box of a leaf is nearest to the eye."""
    eye = camera.position
    distance = float(np.linalg.norm(eye - np.clip(eye, leaf.low, leaf.high)))
    return max(camera.fx, camera.fy) / max(distance, 1e-9)


def _in_view(leaf: Leaf, camera: Camera) -> bool:
    """Whether the box of a leaf may reach into the image and its border."""
    corners: NDArray[np.float64] = np.array(list(product(*zip(leaf.low, leaf.high, strict=True))))
    x, y, z = (corners @ camera.world_to_camera[:3, :3].T + camera.world_to_camera[:3, 3]).T
    left, right = (
        (-BORDER * camera.width - camera.cx) / camera.fx,
        ((1 + BORDER) * camera.width - camera.cx) / camera.fx,
    )
    top, bottom = (
        (-BORDER * camera.height - camera.cy) / camera.fy,
        ((1 + BORDER) * camera.height - camera.cy) / camera.fy,
    )
    outside = (z <= 0, x < left * z, x > right * z, y < top * z, y > bottom * z)
    return not any(side.all() for side in outside)

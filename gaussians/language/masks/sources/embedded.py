"""Masks of rendered views without a model: patches of similar depth, normals and colour.

The greedy graph merge of Felzenszwalb & Huttenlocher (IJCV 2004) over the pixels of a rendered RGB-D image. It finds
patches, not objects: a chair gives one mask each for seat, back and legs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ....camera import Camera, Render
from ....color import rgb_to_lab
from ....errors import UserError
from ....render import render
from ....scene import Scene
from ....viewpoints.coverage import choose_views, fit_camera
from ...segmentation.superpoints import COLOR_UNIT, LIGHTNESS, NORMAL_UNIT, merge_regions
from ..contours.channels import normals_of
from ..view import NONE, ViewMasks

SIDE = 256  # pixels of the rendered views
DEPTH_UNIT = 0.02  # of the depth: a step between two pixels that counts as one edge unit
MIN_ALPHA = 0.5  # pixels below it are empty
SCALE = 60.0  # of the merge, in edge units times pixels: larger gives larger patches
MIN_PIXELS = 60  # of a patch
SCORE = 0.5  # of every patch: whether it is an object is unknown


def load(argument: str = "", capture: Path | None = None) -> Embedded:
    """See `masks.load`. The views are rendered, from the cameras of the scene if it has any."""
    del capture
    if argument:
        raise UserError(f"embedded masks take no argument, got {argument!r}")
    return Embedded()


@dataclass(frozen=True)
class Embedded:
    """Patches of views that are chosen to cover the visible scene."""

    side: int = SIDE

    def masks(
        self, scene: Scene, progress: Callable[[str, float], None] = lambda stage, share: None
    ) -> Iterator[ViewMasks]:
        """See `Masker`."""
        cameras = choose_views(scene).cameras
        for i, camera in enumerate(cameras):
            gain = self.side / max(camera.width, camera.height)
            large = fit_camera(camera, max(1, round(camera.width * gain)), max(1, round(camera.height * gain)))
            yield of_view(render(scene.cloud, large), large)
            progress("masks", (i + 1) / len(cameras))


def of_view(seen: Render, camera: Camera) -> ViewMasks:
    """The patches of one rendered image; empty pixels are in none."""
    depth = seen.depth.cpu().numpy().astype(np.float64)
    filled = seen.alpha.cpu().numpy() >= MIN_ALPHA
    lab = rgb_to_lab(seen.rgb.cpu().clamp(0, 1)).numpy()
    normals = normals_of(depth, camera)
    height, width = depth.shape
    index = np.arange(height * width).reshape(height, width)
    pairs, weights = [], []
    for a, b in ((np.s_[:, :-1], np.s_[:, 1:]), (np.s_[:-1], np.s_[1:])):
        both = filled[a] & filled[b]
        difference = (lab[a] - lab[b]) * np.array([LIGHTNESS, 1, 1], np.float32)
        turn = 1 - np.abs((normals[a] * normals[b]).sum(axis=-1))
        step = np.abs(depth[a] - depth[b]) / np.maximum(np.minimum(depth[a], depth[b]), 1e-9)
        weight = np.linalg.norm(difference, axis=-1) / COLOR_UNIT + turn / NORMAL_UNIT + step / DEPTH_UNIT
        pairs.append(np.stack([index[a][both], index[b][both]], axis=1))
        weights.append(weight[both])
    label = merge_regions(height * width, np.concatenate(pairs), np.concatenate(weights), SCALE, MIN_PIXELS)
    label[~filled.ravel()] = NONE
    names, ids, size = np.unique(label, return_inverse=True, return_counts=True)
    good = (names >= 0) & (size >= MIN_PIXELS)
    place = np.where(good, np.cumsum(good) - 1, NONE).astype(np.int32)
    count = int(good.sum())
    return ViewMasks(camera, place[ids].reshape(height, width), ("",) * count, np.full(count, SCORE, np.float32))

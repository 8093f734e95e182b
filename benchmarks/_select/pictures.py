"""Cameras and masks of a case: chooses views, and makes masks from the truth with imprecise outlines.

The lifting of these masks gets only pixels and vectors, not the truth.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
import torch
from numpy.typing import NDArray
from scipy import ndimage

from ...gaussians.camera import Camera, Render
from ...gaussians.language.encoders import Encoder
from ...gaussians.language.encoders.framing import crop
from ...gaussians.language.masks import NONE, ViewMasks
from ...gaussians.render import contributions, render
from ...gaussians.scene import Scene
from ...gaussians.viewpoints.coverage import candidates, fit_camera
from .cases import Case

I32 = NDArray[np.int32]
LOOK = 96  # pixels a side of the views that are compared when cameras are chosen
SEEN = 0.01  # summed blending weight from which a Gaussian counts as seen
SHAKE = 0.006  # of the picture's side: standard deviation by which outlines wander
WAVE = 0.03  # of the picture's side: over which they do
UNLIKE = 0.45  # norm of the noise of an object and of each of its pictures: two pictures have a cosine of 0.86
MIN_PIXELS = 30  # of the smallest mask that is kept, at 256 a side


class Pictured(Protocol):
    """Makes the vectors of a picture's masks: `[M, D]` for the objects they are of, in their order."""

    def __call__(self, picture: Render, ids: I32, objects: Sequence[int]) -> NDArray[np.float32] | None: ...


@dataclass(frozen=True, eq=False)
class Seen:
    """Masks of one picture, and which true object each mask is of."""

    masks: ViewMasks
    objects: tuple[int, ...]


def eyes(scene: Scene, most: int, size: int) -> list[Camera]:
    """Cameras chosen greedily, best first: each next one sees most of the Gaussians that few cameras saw before."""
    pool = [fit_camera(c, LOOK, LOOK) for c in scene.cameras] + candidates(scene.cloud, scene.frame, LOOK)
    seen = np.stack([(contributions(scene.cloud, c) > SEEN).numpy() for c in pool]).astype(np.float32)  # [P, N]
    times = np.zeros(len(scene.cloud), np.float32)
    order: list[int] = []
    for _ in range(min(most, len(pool))):
        gain = seen @ (1 / (1 + times) ** 2)
        gain[order] = -1
        order.append(int(gain.argmax()))
        times += seen[order[-1]]
    return [pool[i].resized(size, size) for i in order]


def shaken(ids: I32, rng: np.random.Generator) -> I32:
    """An id map `[H, W]` with smoothly displaced outlines, like those of a segmentation model; the ids are the same."""
    side = max(ids.shape)
    drift = ndimage.gaussian_filter(rng.standard_normal((2, *ids.shape)), (0, WAVE * side, WAVE * side))
    drift *= SHAKE * side / max(float(drift.std()), 1e-12)
    place = np.indices(ids.shape) + drift
    moved: I32 = ndimage.map_coordinates(ids, place, order=0, mode="nearest")
    return moved


def true_masks(case: Case, camera: Camera, pictured: Pictured, seed: int) -> Seen:
    """The true objects in one picture, with shaky outlines; floor and walls are in no mask."""
    cloud = case.scene.cloud.replace(group=torch.from_numpy(case.ids))
    picture = render(cloud, camera)
    ids = shaken(picture.group.numpy(), np.random.default_rng([case.seed, seed]))
    ids[picture.alpha.numpy() < 0.5] = NONE
    kept, count = np.unique(ids[ids >= 0], return_counts=True)
    objects = [int(o) for o in kept[count >= MIN_PIXELS * ids.size / 256**2]]
    number = np.full(len(case.objects) + 1, NONE, np.int32)  # the last is that of -1
    number[objects] = np.arange(len(objects))
    vectors = pictured(picture, ids, objects)
    scores = np.ones(len(objects), np.float32)
    return Seen(ViewMasks(camera, number[ids], ("",) * len(objects), scores, vectors), tuple(objects))


@dataclass(frozen=True, eq=False)
class Crops:
    """Vectors of masks by the encoder that ships with the package: each mask's pixels alone before grey."""

    encoder: Encoder

    def __call__(self, picture: Render, ids: I32, objects: Sequence[int]) -> NDArray[np.float32]:
        shown = []
        for index in objects:
            alpha = torch.from_numpy(ids == index).float()
            cut = crop(picture.rgb * alpha[..., None], alpha, self.encoder.image_size)
            assert cut is not None  # a mask has pixels
            shown.append(cut)
        if not shown:
            return np.zeros((0, self.encoder.dim), np.float32)
        return self.encoder.encode_images(np.stack(shown))


@dataclass(frozen=True, eq=False)
class Photos:
    """Vectors of masks as of a real image encoder: the vector of a photo of the kind, with noise for each picture.

    Attributes:
        exemplars: `[O, D]` unit image vector of each true object's kind; zero where there is none.
        rng: of what each object and each of its pictures has of its own.
    """

    exemplars: NDArray[np.float64]
    rng: np.random.Generator

    @cached_property
    def _own(self) -> NDArray[np.float64]:
        return self.exemplars + self._noise(len(self.exemplars))

    def __call__(self, picture: Render, ids: I32, objects: Sequence[int]) -> NDArray[np.float32]:
        vectors = self._own[list(objects)] + self._noise(len(objects))
        there = self.exemplars[list(objects)].any(axis=1, keepdims=True)
        norms = np.linalg.norm(vectors, axis=1, keepdims=True)
        return np.where(there, vectors / np.maximum(norms, 1e-12), 0).astype(np.float32)

    def _noise(self, count: int) -> NDArray[np.float64]:
        """`[count, D]` rows about `UNLIKE` long."""
        width = self.exemplars.shape[1]
        return self.rng.standard_normal((count, width)) * UNLIKE / np.sqrt(width)


def nothing_said(picture: Render, ids: I32, objects: Sequence[int]) -> None:
    """No vectors at all."""

"""Render one group at a time, alone on neutral grey or before its own background, and average its image vectors."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import numpy as np
import torch
from numpy.typing import NDArray

from ...camera import Camera
from ...cloud import GaussianCloud, concat
from ...render import render
from ...scene import Frame
from ..encoders import Encoder, cache, uses_background
from ..encoders.framing import crop

F64 = NDArray[np.float64]
F32 = NDArray[np.float32]

# degrees: azimuth from the open side, elevation
VIEW_ANGLES = ((-45.0, 20.0), (0.0, 35.0), (45.0, 15.0), (150.0, 30.0))
FOV = 30.0  # degrees: narrow enough that near and far parts have similar sizes
OVERSAMPLE = 1.5  # renders are this much larger than the encoder's input, then cropped and resampled
MAX_GAUSSIANS = 6000  # in one render: more cannot be distinguished at the encoder's resolution
BATCH = 256  # images collected before they are encoded
FRONT_QUANTILE = 0.02  # of a group's depths: where its front begins


def open_side(center: F64, middle: F64, up: F64) -> F64:
    """Level unit vector from a group towards the middle of the scene, from where the group is visible."""
    toward = middle - center
    toward = toward - up * float(toward @ up)
    length = float(np.linalg.norm(toward))
    if length < 1e-6:
        toward = np.cross(up, np.eye(3)[int(np.argmin(np.abs(up)))])
        length = float(np.linalg.norm(toward))
    return toward / length


def cameras_around(points: F64, frame: Frame, middle: F64, pixels: int, count: int = len(VIEW_ANGLES)) -> list[Camera]:
    """`count` cameras that frame `points [M, 3]` (world), those on the open side first."""
    low, high = np.quantile(points, [0.01, 0.99], axis=0)
    center = (low + high) / 2
    radius = max(float(np.quantile(np.linalg.norm(points - center, axis=1), 0.98)), 1e-6)
    up = frame.up_vector
    front = open_side(center, middle, up)
    side = np.cross(up, front)
    distance = 1.08 * radius / math.sin(math.radians(FOV / 2))
    cameras = []
    for azimuth, elevation in VIEW_ANGLES[:count]:
        a, e = math.radians(azimuth), math.radians(elevation)
        eye = center + distance * (math.cos(e) * (math.cos(a) * front + math.sin(a) * side) + math.sin(e) * up)
        cameras.append(Camera.look_at(eye, center, up, pixels, pixels, FOV))
    return cameras


def render_group(
    cloud: GaussianCloud, frame: Frame, middle: F64, size: int, count: int, around: GaussianCloud | None = None
) -> list[NDArray[np.uint8]]:
    """Images `[size, size, 3]` of a small cloud from `count` views, without views that show nothing of it.

    With `around`, the scene that the cloud is part of, each image is followed by one of the same view in which the
    group stands before its own background.
    """
    others = None if around is None else around[~torch.isin(around.ids, cloud.ids)]
    if len(cloud) > MAX_GAUSSIANS:
        keep = torch.linspace(0, len(cloud) - 1, MAX_GAUSSIANS).long()
        grown = math.sqrt(len(cloud) / MAX_GAUSSIANS)  # fewer Gaussians must cover the same area
        cloud = cloud[keep]
        cloud = cloud.replace(scales=cloud.scales * grown)
    pixels = int(size * OVERSAMPLE)
    views = cameras_around(cloud.means.double().numpy(), frame, middle, pixels, count)
    pictures = []
    for camera in views:
        seen = render(cloud, camera)
        if (picture := crop(seen.rgb, seen.alpha, size)) is not None:
            pictures.append(picture)
            if others is not None:
                whole = render(concat([cloud, _background(others, cloud, camera)]), camera)
                placed = crop(whole.rgb, whole.alpha, size, outline=seen.alpha)
                pictures.append(picture if placed is None else placed)
    return pictures


def _background(others: GaussianCloud, cloud: GaussianCloud, camera: Camera) -> GaussianCloud:
    """The Gaussians of the scene behind the front of a group; those nearer would hide it from this camera."""
    forward = torch.tensor(camera.forward, dtype=torch.float32)
    front = (cloud.means @ forward).quantile(FRONT_QUANTILE)
    return others[others.means @ forward > front]


@contextmanager
def one_thread() -> Iterator[None]:
    """Run torch on one thread; thousands of small operations spend more time on waking threads than on computing."""
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)


def mean_vectors(
    encoder: Encoder,
    clouds: Sequence[GaussianCloud],
    frame: Frame,
    middle: F64,
    count: int = len(VIEW_ANGLES),
    progress: Callable[[float], None] = lambda share: None,
    around: GaussianCloud | None = None,
) -> F32:
    """Unit mean image vector `[len(clouds), D]` of each cloud over `count` views; zero where no view shows it.

    Args:
        around: the scene that the clouds are rows of. With it, encoders trained on photographs (`on_background`)
            get each view twice: the group alone, and before its own background.
    """
    vectors = np.zeros((len(clouds), encoder.dim), np.float32)
    if not encoder.image_size:  # an encoder without an image tower
        return vectors
    scene = around if uses_background(encoder) else None
    images: list[NDArray[np.uint8]] = []
    owners: list[int] = []

    def encode() -> None:
        if images:
            np.add.at(vectors, owners, cache.images(encoder, np.stack(images)))
            images.clear()
            owners.clear()

    for i, cloud in enumerate(clouds):
        taken = render_group(cloud, frame, middle, encoder.image_size, count, scene) if len(cloud) else []
        images.extend(taken)
        owners.extend([i] * len(taken))
        if len(images) >= BATCH:
            encode()
        progress((i + 1) / len(clouds))
    encode()
    norms = np.linalg.norm(vectors, axis=1, keepdims=True)
    units: F32 = (vectors / np.where(norms > 1e-8, norms, 1)).astype(np.float32)
    return units

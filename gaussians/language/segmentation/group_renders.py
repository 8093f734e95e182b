"""Pictures of one group at a time, alone before neutral grey or on its own background, and their mean vector.

Knows clouds, cameras, the renderer and an encoder. Refuses to know how the group was found.
"""

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
from ..encoders import Encoder, cache, looks_at_background
from ..encoders.framing import crop

F64 = NDArray[np.float64]
F32 = NDArray[np.float32]

ANGLES = ((-45.0, 20.0), (0.0, 35.0), (45.0, 15.0), (150.0, 30.0))  # azimuth from the open side, elevation, degrees
FOV = 30.0  # degrees: long enough a lens that near and far parts look alike in size
OVERSAMPLE = 1.5  # pictures are drawn this much larger than the encoder's input, then cut and resampled
MOST_GAUSSIANS = 6000  # in one picture: more cannot be told apart at the encoder's resolution
BATCH = 256  # pictures held before they are encoded
FRONT = 0.02  # share of a thing's Gaussians that may lie nearer than what counts as its front


def open_side(center: F64, middle: F64, up: F64) -> F64:
    """Level unit vector from a group towards the middle of the scene: where it can be seen from."""
    toward = middle - center
    toward = toward - up * float(toward @ up)
    length = float(np.linalg.norm(toward))
    if length < 1e-6:
        toward = np.cross(up, np.eye(3)[int(np.argmin(np.abs(up)))])
        length = float(np.linalg.norm(toward))
    return toward / length


def cameras_around(points: F64, frame: Frame, middle: F64, pixels: int, count: int = len(ANGLES)) -> list[Camera]:
    """`count` cameras that frame `points [M, 3]` (world), first those from the open side."""
    low, high = np.quantile(points, 0.01, axis=0), np.quantile(points, 0.99, axis=0)
    center = (low + high) / 2
    radius = max(float(np.quantile(np.linalg.norm(points - center, axis=1), 0.98)), 1e-6)
    up = frame.up_vector
    front = open_side(center, middle, up)
    side = np.cross(up, front)
    distance = 1.08 * radius / math.sin(math.radians(FOV / 2))
    cameras = []
    for azimuth, elevation in ANGLES[:count]:
        a, e = math.radians(azimuth), math.radians(elevation)
        eye = center + distance * (math.cos(e) * (math.cos(a) * front + math.sin(a) * side) + math.sin(e) * up)
        cameras.append(Camera.look_at(eye, center, up, pixels, pixels, FOV))
    return cameras


def portraits(
    cloud: GaussianCloud, frame: Frame, middle: F64, size: int, count: int, around: GaussianCloud | None = None
) -> list[NDArray[np.uint8]]:
    """Encoder pictures `[size, size, 3]` of a small cloud; fewer than `count` where nothing was to be seen.

    With `around`, the scene it is part of, each view is followed by one of the same thing on its own background.
    """
    others = None if around is None else around[~torch.isin(around.ids, cloud.ids)]
    if len(cloud) > MOST_GAUSSIANS:
        keep = torch.linspace(0, len(cloud) - 1, MOST_GAUSSIANS).long()
        grown = math.sqrt(len(cloud) / MOST_GAUSSIANS)  # the fewer must cover what all covered
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
                whole = render(concat([cloud, _behind(others, cloud, camera)]), camera)
                placed = crop(whole.rgb, whole.alpha, size, outline=seen.alpha)
                pictures.append(picture if placed is None else placed)
    return pictures


def _behind(others: GaussianCloud, cloud: GaussianCloud, camera: Camera) -> GaussianCloud:
    """What of a scene may stand in the picture of a thing: nothing that would hide it from a camera of our choice."""
    forward = torch.tensor(camera.forward, dtype=torch.float32)
    front = (cloud.means @ forward).quantile(FRONT)
    return others[others.means @ forward > front]


@contextmanager
def one_thread() -> Iterator[None]:
    """Torch on one thread: thousands of small operations spend their time waking threads, not computing."""
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
    count: int = len(ANGLES),
    progress: Callable[[float], None] = lambda share: None,
    around: GaussianCloud | None = None,
) -> F32:
    """`[len(clouds), D]` unit mean image vector of each cloud over `count` views; zero where nothing was seen.

    Args:
        around: the scene that the clouds are rows of. With it, encoders that learnt from photographs
            (`on_background`) are shown each view twice, alone and on the thing's own background.
    """
    vectors = np.zeros((len(clouds), encoder.dim), np.float32)
    if not encoder.image_size:  # text vectors alone: nothing looks at pictures
        return vectors
    scene = around if looks_at_background(encoder) else None
    images: list[NDArray[np.uint8]] = []
    owners: list[int] = []

    def encode() -> None:
        if images:
            np.add.at(vectors, owners, cache.images(encoder, np.stack(images)))
            images.clear()
            owners.clear()

    for i, cloud in enumerate(clouds):
        taken = portraits(cloud, frame, middle, encoder.image_size, count, scene) if len(cloud) else []
        images.extend(taken)
        owners.extend([i] * len(taken))
        if len(images) >= BATCH:
            encode()
        progress((i + 1) / len(clouds))
    encode()
    norms = np.linalg.norm(vectors, axis=1, keepdims=True)
    units: F32 = (vectors / np.where(norms > 1e-8, norms, 1)).astype(np.float32)
    return units

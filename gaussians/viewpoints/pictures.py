"""Pictures of a scene with their cameras: the photographs of its capture that show it best, or renders of chosen views.

Photographs are read at the size asked for and without the distortion of their lens, so that the scene's Gaussians
project where the photograph shows them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ..camera import Camera, Render
from ..errors import FileError, UserError
from ..files.captures.capture import Capture, is_file
from ..files.captures.image_file import read_photo
from ..lens import undistort
from ..render import contributions, render
from ..scene import Scene
from .coverage import SEEN, SIZE, choose_views, fit_camera

REPEAT = 0.6  # what a further photograph of a Gaussian is worth, as a share of the photograph before
POOL = 4  # candidates for each photograph that is chosen
SAMPLE = 20_000  # Gaussians that the choice considers
MIN_SEEN = 0.02  # share of the Gaussians that the photographs must show together


@dataclass(frozen=True, eq=False)
class Picture:
    """A photograph or a render.

    Attributes:
        camera: of the picture's size, without distortion.
        rgb: `[H, W, 3]` uint8, display space.
        seen: what was rendered; None for a photograph.
    """

    camera: Camera
    rgb: NDArray[np.uint8]
    seen: Render | None = None


def present(capture: Capture) -> tuple[int, ...]:
    """The photographs of a capture that exist, as indices."""
    return tuple(i for i, path in enumerate(capture.photos) if is_file(path))


def read_photographs(capture: Capture, chosen: tuple[int, ...], side: int) -> Iterator[Picture]:
    """Read some photographs of a capture, the longer side at most `side` pixels, without lens distortion.

    Raises:
        FileError: a photograph cannot be read, or has another aspect ratio than its camera; the message says what to
            do.
    """
    from PIL import Image

    for i in chosen:
        full, path = capture.cameras[i], capture.photos[i]
        try:
            photo = read_photo(path, (full.width, full.height))
        except FileError as error:
            advice = f"restore the file, or remove its frame from {capture.path}"
            raise FileError(f"{error}; {advice}") from error
        gain = min(1.0, side / max(photo.shape[:2]))
        height, width = (max(1, round(gain * n)) for n in photo.shape[:2])
        if gain < 1:
            photo = np.asarray(Image.fromarray(photo).resize((width, height), Image.Resampling.BOX))
        camera = full.resized(width, height)
        yield Picture(camera, undistort(photo, camera, capture.lenses[i]))


def render_views(scene: Scene, side: int, count: int) -> Iterator[Picture]:
    """Render views that cover the scene, the longer side `side` pixels, the best first."""
    for camera in rendered_cameras(scene, side, count):
        seen = render(scene.cloud, camera)
        yield Picture(camera, seen.to_uint8(), seen)


def rendered_cameras(scene: Scene, side: int, count: int) -> tuple[Camera, ...]:
    """The cameras of `render_views`."""
    chosen = []
    for camera in choose_views(scene, count).cameras:
        gain = side / max(camera.width, camera.height)
        chosen.append(fit_camera(camera, max(1, round(camera.width * gain)), max(1, round(camera.height * gain))))
    return tuple(chosen)


def choose_photographs(scene: Scene, capture: Capture, count: int) -> tuple[int, ...]:
    """At most `count` photographs of a capture that exist, ascending: those that together show most of the scene most
    often.

    Greedy: each photograph is worth the Gaussians that it sees, and a Gaussian seen before less each time.

    Raises:
        UserError: the photographs show hardly anything of the scene.
    """
    pool = np.array(present(capture), np.int64)
    if len(pool) > POOL * count:
        pool = pool[np.linspace(0, len(pool) - 1, POOL * count).round().astype(int)]
    if not len(pool) or not len(scene.cloud):
        return tuple(pool[:count].tolist())
    step = max(1, len(scene.cloud) // SAMPLE)
    cloud = scene.cloud[torch.arange(0, len(scene.cloud), step)]
    cloud = cloud.replace(scales=cloud.scales * float(np.sqrt(step)), sh=cloud.sh[:, :1].contiguous())
    seen = np.stack([(contributions(cloud, _small(capture.cameras[i])) > SEEN).numpy() for i in pool.tolist()])
    if seen.any(axis=0).mean() < MIN_SEEN:
        raise UserError(
            f"the photographs of {capture.path} do not show the scene: its cameras are in another frame, or belong to "
            "another scene; give the capture that the scene was fitted from"
        )
    worth, chosen = np.ones(len(cloud)), list[int]()
    left = np.ones(len(pool), bool)
    while len(chosen) < min(count, len(pool)):
        best = int(np.argmax(np.where(left, seen @ worth, -1)))
        chosen.append(int(pool[best]))
        left[best] = False
        worth[seen[best]] *= REPEAT
    return tuple(sorted(chosen))


def _small(camera: Camera) -> Camera:
    gain = SIZE / max(camera.width, camera.height)
    return camera.resized(max(1, round(camera.width * gain)), max(1, round(camera.height * gain)))

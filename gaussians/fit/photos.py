"""Photographs of a capture, made ready to learn from: read, straightened, shrunk, and one in eight held out.

Knows files and lenses. Refuses to know Gaussians. Everything that can be wrong with a capture is found here, before
any time is spent on training.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from ..errors import FileError, UserError
from ..files import colmap
from ..files.capture import Capture, read_capture
from ..lens import Lens, straightened
from .train import Shot

HELD_OUT = 8  # every eighth photograph, by name, as the field reports (Barron et al. 2022)
LONGEST = 512  # px of the longer side, up to which photographs are learnt from unless a scale is given
LEAST = 3  # photographs to learn from
SEEN = 0.02  # of the surveyed points that a camera must see, in the middle of all cameras
Progress = Callable[[str, float], None]


@dataclass(frozen=True, eq=False)
class Photos:
    """A capture ready to learn from.

    Attributes:
        shots: to learn from.
        held: held out, to measure with.
        points: surveyed points, perhaps none.
        extent: radius of a ball that holds the cameras, scene units, a tenth larger.
    """

    shots: tuple[Shot, ...]
    held: tuple[Shot, ...]
    points: colmap.Points
    extent: float


def take_photos(path: Path, scale: float | None = None, progress: Progress = lambda stage, share: None) -> Photos:
    """The photographs of a capture.

    Args:
        path: a folder with `transforms.json` or a COLMAP model, or the former itself.
        scale: of the photographs' sides, in (0, 1]; None halves them until the longer side is at most `LONGEST`.

    Raises:
        FileError: the capture cannot be read, a photograph is missing or of another size than its camera, or the poses
            do not see the points that were surveyed with them.
        UserError: the scale is out of range.
    """
    if scale is not None and not 0 < scale <= 1:
        raise UserError(f"--scale must lie between 0 and 1, got {scale:g}")
    capture = read_capture(path)
    points = _points(path if path.is_dir() else path.parent)
    if missing := [p for p in capture.photos if not p.is_file()]:
        raise FileError(f"{missing[0]} is not there, and {len(missing) - 1} more photographs; put them back or "
                        f"take them out of {capture.path}")  # fmt: skip
    _check_poses(capture, points)
    shots = []
    for i, (camera, photo, lens) in enumerate(zip(capture.cameras, capture.photos, capture.lenses, strict=True)):
        shots.append(_shot(photo, camera, lens, scale))
        progress("reading photographs", (i + 1) / len(capture.photos))
    order = sorted(range(len(shots)), key=lambda i: capture.photos[i].name)
    held = [shots[i] for k, i in enumerate(order) if k % HELD_OUT == 0]
    learnt = [shots[i] for k, i in enumerate(order) if k % HELD_OUT]
    if len(learnt) < LEAST:
        raise FileError(f"{capture.path} has {len(shots)} photographs; at least {LEAST + 1} are needed")
    eyes = np.stack([c.position for c in capture.cameras])
    extent = 1.1 * float(np.linalg.norm(eyes - eyes.mean(axis=0), axis=1).max())
    return Photos(tuple(learnt), tuple(held), points, max(extent, 1e-6))


def _points(folder: Path) -> colmap.Points:
    sparse = colmap.find(folder)
    if sparse is None:
        return colmap.Points(np.zeros((0, 3)), np.zeros((0, 3)))
    return colmap.read_points(sparse)


def _check_poses(capture: Capture, points: colmap.Points) -> None:
    """Cameras that do not see what was surveyed with them stand in another frame, or look the other way."""
    if not len(points.means):
        return
    sample = points.means[:: max(1, len(points.means) // 5000)]
    seen = float(np.median([_seen(c, sample) for c in capture.cameras]))
    if seen >= SEEN:
        return
    turned = float(np.median([_seen(_about(c), sample) for c in capture.cameras]))
    told = f"{capture.path}: half of the cameras see less than {SEEN:.0%} of the surveyed points"
    if turned > max(SEEN, 2 * seen):
        raise FileError(f"{told}, but {turned:.0%} looking the other way: its poses are in OpenCV axes (y down, "
                        "z forward), not OpenGL's (y up, z back); negate their second and third column")  # fmt: skip
    raise FileError(f"{told}: poses and points are in different frames; export both from one reconstruction")


def _seen(camera: Camera, points: NDArray[np.float64]) -> float:
    pixels, depth = camera.project(points)
    inside = (depth > 0) & (pixels >= 0).all(axis=1) & (pixels < [camera.width, camera.height]).all(axis=1)
    return float(inside.mean())


def _about(camera: Camera) -> Camera:
    """The camera turned half about its own x: what reading OpenCV axes as OpenGL's does."""
    pose = np.diag([1.0, -1.0, -1.0, 1.0]) @ camera.world_to_camera
    return Camera(pose, camera.fx, camera.fy, camera.cx, camera.cy, camera.width, camera.height)


def _shot(path: Path, camera: Camera, lens: Lens, scale: float | None) -> Shot:
    from PIL import Image

    try:
        with Image.open(path) as file:
            photo = np.asarray(file.convert("RGB"))
    except (OSError, ValueError, Image.DecompressionBombError) as error:
        raise FileError(f"cannot read the photograph {path}: {error}") from error
    height, width = photo.shape[:2]
    if (width, height) != (camera.width, camera.height):
        if abs(width * camera.height - height * camera.width) > max(width, height, camera.width, camera.height):
            raise FileError(f"{path} is {width}x{height}, its camera says {camera.width}x{camera.height}; "
                            "correct the intrinsics (w, h and focal lengths in pixels of the photographs)")  # fmt: skip
        camera = camera.resized(width, height)
    photo = straightened(photo, camera, lens)
    factor = scale if scale is not None else _usual(max(width, height))
    small = max(1, int(width * factor)), max(1, int(height * factor))
    if small != (width, height):
        photo = np.asarray(Image.fromarray(photo).resize(small, Image.Resampling.BOX))
    return Shot(camera.resized(*small), photo)


def _usual(longest: int) -> float:
    factor = 1.0
    while longest * factor > LONGEST:
        factor /= 2
    return factor

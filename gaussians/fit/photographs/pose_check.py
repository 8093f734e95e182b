"""Check camera poses and intrinsics against the surveyed (SfM) points of a capture.

Structure from motion gives each point the mean colour of the pixels that observed it, so with correct poses and
intrinsics, points project onto pixels of their colour. Without points, nothing can be checked.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...camera import Camera
from ...errors import FileError
from ...files.captures.colmap import Points
from ..train import Shot

MIN_SEEN = 0.02  # median share of the points that a camera must see
MAX_POINTS = 5000  # points to check with
MAX_PHOTOS = 60  # photographs to check with
MIN_POINTS = 50  # points in an image; with fewer, their colours are not compared
MIN_STD = 0.02  # standard deviation of the points' brightness; below, colours are not compared
MIN_GAIN = 0.15  # in correlation that another focal length must gain: on real captures a factor of 2 costs 0.35
MIN_CORRELATION = 0.2  # below, a warning: it is 0.6 on real captures and 0 to 0.2 with wrong poses
FACTORS = (1 / 8, 1 / 4, 1 / 2, 2, 4, 8)  # of focal lengths, by which intrinsics of another resolution are wrong


def check_views(path: Path, cameras: Sequence[Camera], points: Points) -> None:
    """Check that cameras see the surveyed points: they do not if frames or axis conventions are mixed up.

    Raises:
        FileError: half of the cameras do not see enough points, or one sees none; the message says the likely cause.
    """
    if not len(points.means):
        return
    sample = points.means[:: max(1, len(points.means) // MAX_POINTS)]
    each = np.array([_share_seen(c, sample) for c in cameras])
    seen = float(np.median(each))
    if seen >= MIN_SEEN:
        few = [camera for camera, share in zip(cameras, each, strict=True) if share == 0]
        blind = [camera.name for camera in few if _share_seen(camera, points.means) == 0]
        if len(blind) > len(cameras) // 10:
            raise FileError(f"{path}: {len(blind)} of {len(cameras)} cameras see none of the surveyed points: poses "
                            "and points are in different frames; export both from one reconstruction")  # fmt: skip
        if blind:
            raise FileError(f"{path}: {', '.join(blind)} see none of the surveyed points; correct the poses of these "
                            "photographs or remove them, unless all poses are in another frame")  # fmt: skip
        return
    turned = float(np.median([_share_seen(_flipped(c), sample) for c in cameras]))
    problem = f"{path}: half of the cameras see less than {MIN_SEEN:.0%} of the surveyed points"
    if turned > max(MIN_SEEN, 2 * seen):
        raise FileError(f"{problem}, but {turned:.0%} looking the other way: its poses are in OpenCV axes (y down, "
                        "z forward), not OpenGL's (y up, z back); negate their second and third column")  # fmt: skip
    raise FileError(f"{problem}: poses and points are in different frames; export both from one reconstruction")


def check_colors(path: Path, shots: Sequence[Shot], points: Points) -> str | None:
    """Check that points project onto pixels of their colour; returns a warning for the user, or None.

    Raises:
        FileError: they do only with all focal lengths multiplied by a factor.
    """
    sample = slice(None, None, max(1, len(points.means) // MAX_POINTS))
    means, bright = points.means[sample], points.colors[sample].mean(axis=1)
    if len(means) < MIN_POINTS or bright.std() < MIN_STD:
        return None
    some = shots[:: max(1, len(shots) // MAX_PHOTOS)]

    def median(zoom: float) -> float:
        cameras = [replace(s.camera, fx=s.camera.fx * zoom, fy=s.camera.fy * zoom) for s in some]
        zoomed = [replace(s, camera=camera) for s, camera in zip(some, cameras, strict=True)]
        return float(np.median([_correlation(shot, means, bright) for shot in zoomed]))

    given = median(1.0)
    factor, best = max(((f, median(f)) for f in FACTORS), key=lambda found: found[1])
    if best > max(given, 0) + MIN_GAIN:
        raise FileError(f"{path}: surveyed points fall onto their colours only if focal lengths are {factor:g} times "
                        "as long; correct fl_x and fl_y (pixels of photographs of w x h)")  # fmt: skip
    if given < MIN_CORRELATION:
        return (f"surveyed points do not fall onto pixels of their colour (correlation {given:.2f}): poses, "
                "intrinsics or the order of the photographs may be wrong")  # fmt: skip
    return None


def _share_seen(camera: Camera, points: NDArray[np.float64]) -> float:
    return float(_inside(camera, points)[1].mean())


def _inside(camera: Camera, points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Pixels `[M, 2]` of points, and which of them are in the image."""
    with np.errstate(over="ignore", invalid="ignore"):  # points may have extreme coordinates
        pixels, depth = camera.project(points)
        return pixels, camera.contains(pixels, depth)


def _correlation(shot: Shot, means: NDArray[np.float64], bright: NDArray[np.float64]) -> float:
    """Correlation of the points' brightness and that of the pixels they project onto; 0 if it is undefined."""
    pixels, inside = _inside(shot.camera, means)
    columns, rows = pixels[inside].astype(np.int64).T
    seen, wanted = shot.photo[rows, columns].mean(axis=1), bright[inside]
    if len(seen) < MIN_POINTS or seen.std() == 0 or wanted.std() == 0:
        return 0.0
    return float(np.corrcoef(seen, wanted)[0, 1])


def _flipped(camera: Camera) -> Camera:
    """The camera rotated by 180 degrees about its own x, which is the effect of reading OpenCV axes as OpenGL's."""
    return replace(camera, world_to_camera=np.diag([1.0, -1.0, -1.0, 1.0]) @ camera.world_to_camera)

"""Whether photographs were taken from where a capture says: held against the points that were surveyed with them.

A survey gives each point the mean colour of the pixels that saw it, so where poses and intrinsics are right, points
fall onto pixels of their colour. Knows cameras, points and pixels. Refuses to know files, and cannot tell anything
where no points were surveyed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...camera import Camera
from ...errors import FileError
from ...files.captures.colmap import Points
from ..train import Shot

SEEN = 0.02  # of the surveyed points that a camera must see, in the middle of all cameras
LOOKED_AT = 5000  # points, and
LOOKED_FROM = 60  # photographs that are enough to judge by
ENOUGH = 50  # points in a picture, below which their colours say nothing
PLAIN = 0.02  # spread of the points' brightness, below which their colours say nothing
BETTER = 0.15  # of correlation that another focal length must gain: on real captures a factor of 2 costs 0.35
UNLIKE = 0.2  # correlation below which points do not show up: 0.6 on real captures, 0 to 0.2 with wrong poses
FACTORS = (1 / 8, 1 / 4, 1 / 2, 2, 4, 8)  # what intrinsics of another resolution are off by


def check_views(path: Path, cameras: Sequence[Camera], points: Points) -> None:
    """Cameras that do not see what was surveyed with them stand in another frame, or look the other way.

    Raises:
        FileError: half of them do not, or one of them sees not a single point; the message says what is likely.
    """
    if not len(points.means):
        return
    sample = points.means[:: max(1, len(points.means) // LOOKED_AT)]
    each = np.array([_seen(c, sample) for c in cameras])
    seen = float(np.median(each))
    if seen >= SEEN:
        few = [camera for camera, share in zip(cameras, each, strict=True) if share == 0]
        blind = [camera.name for camera in few if _seen(camera, points.means) == 0]
        if len(blind) > len(cameras) // 10:
            raise FileError(f"{path}: {len(blind)} of {len(cameras)} cameras see none of the surveyed points: poses "
                            "and points are in different frames; export both from one reconstruction")  # fmt: skip
        if blind:
            raise FileError(f"{path}: {', '.join(blind)} see none of the surveyed points; correct the poses of these "
                            "photographs or take them out, unless all poses are of another frame")  # fmt: skip
        return
    turned = float(np.median([_seen(_about(c), sample) for c in cameras]))
    told = f"{path}: half of the cameras see less than {SEEN:.0%} of the surveyed points"
    if turned > max(SEEN, 2 * seen):
        raise FileError(f"{told}, but {turned:.0%} looking the other way: its poses are in OpenCV axes (y down, "
                        "z forward), not OpenGL's (y up, z back); negate their second and third column")  # fmt: skip
    raise FileError(f"{told}: poses and points are in different frames; export both from one reconstruction")


def check_colors(path: Path, shots: Sequence[Shot], points: Points) -> str | None:
    """What is odd about where points fall in the photographs, for the user to judge; None if nothing is.

    Raises:
        FileError: they fall onto their colours if all focal lengths are some times as long.
    """
    sample = slice(None, None, max(1, len(points.means) // LOOKED_AT))
    means, bright = points.means[sample], points.colors[sample].mean(axis=1)
    if len(means) < ENOUGH or bright.std() < PLAIN:
        return None
    some = shots[:: max(1, len(shots) // LOOKED_FROM)]

    def alike(change: Callable[[Camera], Camera]) -> float:
        return float(np.median([_alike(replace(s, camera=change(s.camera)), means, bright) for s in some]))

    as_told = alike(lambda camera: camera)
    factor, best = max(((f, alike(_zoomed(f))) for f in FACTORS), key=lambda found: found[1])
    if best > max(as_told, 0) + BETTER:
        raise FileError(f"{path}: surveyed points fall onto their colours only if focal lengths are {factor:g} times "
                        "as long; correct fl_x and fl_y (pixels of photographs of w x h)")  # fmt: skip
    if as_told < UNLIKE:
        return (f"surveyed points do not fall onto pixels of their colour ({as_told:.2f} correlated): poses, "
                "intrinsics or the order of the photographs may be wrong")  # fmt: skip
    return None


def _seen(camera: Camera, points: NDArray[np.float64]) -> float:
    return float(_inside(camera, points)[1].mean())


def _inside(camera: Camera, points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Pixels `[M, 2]` of points, and which of them are in the picture."""
    with np.errstate(over="ignore", invalid="ignore"):  # a point may lie anywhere
        pixels, depth = camera.project(points)
        return pixels, camera.shows(pixels, depth)


def _alike(shot: Shot, means: NDArray[np.float64], bright: NDArray[np.float64]) -> float:
    """Correlation of the points' brightness and that of the pixels they fall onto; 0 where that says nothing."""
    pixels, inside = _inside(shot.camera, means)
    columns, rows = pixels[inside].astype(np.int64).T
    seen, wanted = shot.photo[rows, columns].mean(axis=1), bright[inside]
    if len(seen) < ENOUGH or seen.std() == 0 or wanted.std() == 0:
        return 0.0
    return float(np.corrcoef(seen, wanted)[0, 1])


def _zoomed(factor: float) -> Callable[[Camera], Camera]:
    return lambda camera: replace(camera, fx=camera.fx * factor, fy=camera.fy * factor)


def _about(camera: Camera) -> Camera:
    """The camera turned half about its own x: what reading OpenCV axes as OpenGL's does."""
    return replace(camera, world_to_camera=np.diag([1.0, -1.0, -1.0, 1.0]) @ camera.world_to_camera)

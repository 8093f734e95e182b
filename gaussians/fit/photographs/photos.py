"""Photographs of a capture, made ready to learn from: read, straightened, shrunk, and one in eight held out.

Knows files and lenses. Refuses to know Gaussians. Everything that can be wrong with a capture is found here, before
any time is spent on training.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...camera import Camera
from ...errors import FileError, UserError
from ...files.captures import colmap
from ...files.captures.capture import Capture, is_file, photographs_alone, read_capture
from ...lens import Lens, straightened
from ..train import Shot
from .image_file import SMALLEST, read_photo
from .pose_check import check_colors, check_views

HELD_OUT = 8  # every eighth photograph, by name, as the field reports (Barron et al. 2022)
LONGEST = 512  # px of the longer side, up to which photographs are learnt from unless a scale is given
LEAST = 3  # photographs to learn from
PLAIN = 0.5  # grey levels of 255 that a photograph must vary by at least
STILL = 1e-6  # of the cameras' coordinates, within which they stand in one place
Progress = Callable[[str, float], None]


@dataclass(frozen=True, eq=False)
class Photos:
    """A capture ready to learn from.

    Attributes:
        shots: to learn from.
        held: held out, to measure with.
        points: surveyed points, perhaps none.
        extent: radius of a ball that holds the cameras, scene units, a tenth larger.
        odd: what a user should look at before the work, if anything.
        surveyed: the folder that keeps poses which had to be estimated; None where they were given.
        unplaced: names of photographs left out because no pose was found for them.
    """

    shots: tuple[Shot, ...]
    held: tuple[Shot, ...]
    points: colmap.Points
    extent: float
    odd: str | None = None
    surveyed: Path | None = None
    unplaced: tuple[str, ...] = ()


def take_photos(
    path: Path,
    scale: float | None = None,
    progress: Progress = lambda stage, share: None,
    poses: Path | None = None,
) -> Photos:
    """The photographs of a capture.

    Args:
        path: a folder with `transforms.json` or a COLMAP model, or the former itself; or one with photographs alone,
            in `images` or itself.
        scale: of the photographs' sides, in (0, 1]; None halves them until the longer side is at most `LONGEST`.
        poses: a folder to keep poses in that have to be estimated, and to find them in the next time; without one,
            photographs alone are refused.

    Raises:
        FileError: the capture cannot be read, a photograph is missing, broken or of another shape than its camera, the
            poses do not see the points that were surveyed with them, or there is nothing to learn from.
        UserError: the scale is out of range, or something else stands at `poses`.
        BackendError: poses have to be estimated, and pycolmap is not installed or failed.
    """
    if scale is not None and not 0 < scale <= 1:
        raise UserError(f"--scale must lie between 0 and 1, got {scale:g}")
    surveyed: Path | None = None
    unplaced: tuple[str, ...] = ()
    if poses is not None and (alone := photographs_alone(path)):
        from .survey import survey

        unplaced = survey(alone, poses, progress)
        path = surveyed = poses
    capture = read_capture(path)
    points = _points(path if path.is_dir() else path.parent)
    _check_present(capture)
    extent = _extent(capture)
    check_views(capture.path, capture.cameras, points)
    shots = []
    for i, (camera, photo, lens) in enumerate(zip(capture.cameras, capture.photos, capture.lenses, strict=True)):
        shots.append(_shot(photo, camera, lens, scale))
        progress("reading photographs", (i + 1) / len(capture.photos))
    if all(shot.photo.std(axis=(0, 1)).max() < PLAIN for shot in shots):
        raise FileError(f"every photograph of {capture.path} is of one plain colour; there is nothing to learn from")
    odd = check_colors(capture.path, shots, points)
    order = sorted(range(len(shots)), key=lambda i: capture.photos[i].name)
    held = [shots[i] for k, i in enumerate(order) if k % HELD_OUT == 0]
    learnt = [shots[i] for k, i in enumerate(order) if k % HELD_OUT]
    if len(learnt) < LEAST:
        raise FileError(f"{capture.path} has {len(shots)} photographs; at least {LEAST + 1} are needed")
    return Photos(tuple(learnt), tuple(held), points, extent, odd, surveyed, unplaced)


def _extent(capture: Capture) -> float:
    eyes = np.stack([c.position for c in capture.cameras])
    apart = float(np.linalg.norm(eyes - eyes.mean(axis=0), axis=1).max())
    if len(eyes) > 1 and not apart > STILL * np.abs(eyes).max():
        raise FileError(f"{capture.path}: all cameras stand in one place, from where nothing tells how far things are; "
                        "take photographs from several places")  # fmt: skip
    return 1.1 * apart


def _check_present(capture: Capture) -> None:
    if missing := [p for p in capture.photos if not is_file(p)]:
        more = f", nor are {len(missing) - 1} more photographs" if len(missing) > 1 else ""
        raise FileError(f"the photograph {missing[0]} is not there{more}; put it back or take it out of {capture.path}")


def _points(folder: Path) -> colmap.Points:
    sparse = colmap.find(folder)
    if sparse is None:
        return colmap.Points(np.zeros((0, 3)), np.zeros((0, 3)))
    return colmap.read_points(sparse)


def _shot(path: Path, camera: Camera, lens: Lens, scale: float | None) -> Shot:
    from PIL import Image

    photo = read_photo(path, (camera.width, camera.height))
    height, width = photo.shape[:2]
    camera = camera.resized(width, height)
    photo = straightened(photo, camera, lens)
    factor = scale if scale is not None else _usual(max(width, height))
    small = int(width * factor), int(height * factor)
    if min(small) < SMALLEST:
        raise UserError(f"--scale {factor:g} leaves {width}x{height} pixels too few to learn from; give a larger one")
    if small != (width, height):
        photo = np.asarray(Image.fromarray(photo).resize(small, Image.Resampling.BOX))
    return Shot(camera.resized(*small), photo)


def _usual(longest: int) -> float:
    factor = 1.0
    while longest * factor > LONGEST:
        factor /= 2
    return factor

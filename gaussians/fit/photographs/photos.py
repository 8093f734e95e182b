"""Load a capture for training: read, undistort and downscale its photographs, and hold out every eighth, or those that
its makers hold out.

All errors of a capture are raised here, before training starts.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ...camera import Camera
from ...errors import FileError, UserError
from ...files.captures import colmap
from ...files.captures.capture import TRAIN, Capture, is_file, read_capture, read_held_out, unposed_photos
from ...files.captures.image_file import MIN_SIDE, read_photo
from ...lens import Lens, undistort
from ..train import Shot
from .frames import similarity
from .pose_check import check_colors, check_views

TEST_EVERY = 8  # every eighth photograph by name is held out, the convention of the field (Barron et al. 2022)
MAX_SIDE = 512  # px of the longer side; larger photographs are halved until they fit, unless a scale is given
MIN_PHOTOS = 3  # photographs to train on
MIN_STD = 0.5  # smallest standard deviation of a photograph's channels that counts as content, of 255
SAME_PLACE = 1e-6  # of the cameras' coordinates; cameras within this distance stand in one place
Progress = Callable[[str, float], None]


@dataclass(frozen=True, eq=False)
class Photos:
    """A capture ready for training.

    Attributes:
        shots: training photographs.
        held_out: photographs for evaluation only.
        points: surveyed (SfM) points, possibly none.
        extent: 1.1 times the radius of the camera positions around their mean, scene units.
        warning: a suspected defect that the user should check, if any.
        poses_folder: folder with the estimated poses; None if the capture has poses.
        unplaced: names of photographs left out because no pose was found for them.
        missing: names of photographs left out because they are listed, but not there.
        notes: sentences on how the capture was read: points that were moved into the frame of the poses, photographs
            that its makers hold out, what its times are taken for.
    """

    shots: tuple[Shot, ...]
    held_out: tuple[Shot, ...]
    points: colmap.Points
    extent: float
    warning: str | None = None
    poses_folder: Path | None = None
    unplaced: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def film(self) -> bool:
        """Whether the photographs are frames of a film: their times differ."""
        return _is_film(self.shots)


def _is_film(shots: Sequence[Shot]) -> bool:
    return len({shot.time for shot in shots}) > 1


def load_photos(
    path: Path,
    scale: float | None = None,
    progress: Progress = lambda stage, share: None,
    poses: Path | None = None,
    *,
    strict: bool = True,
) -> Photos:
    """Load the photographs of a capture.

    Args:
        path: a `transforms.json`, or a folder with one, with a `transforms_train.json` and one for testing, or with a
            COLMAP model; or a folder with photographs without poses, in `images` or directly.
        scale: of the photographs' sides, in (0, 1]; None halves them until the longer side is at most `MAX_SIDE`.
        poses: a folder that stores estimated poses and is reused the next time; without it, photographs without poses
            are refused.
        strict: refuse a capture that lists photographs which are not there, instead of leaving them out.

    Raises:
        FileError: the capture cannot be read, a photograph is missing (with `strict`), broken or of another aspect
            ratio than its camera, the cameras do not see the surveyed points, or there are too few photographs.
        UserError: the scale is out of range, or `poses` is occupied by something else.
        BackendError: poses have to be estimated, and pycolmap is not installed or failed.
    """
    if scale is not None and not 0 < scale <= 1:
        raise UserError(f"--scale must lie between 0 and 1, got {scale:g}")
    poses_folder: Path | None = None
    unplaced: tuple[str, ...] = ()
    if poses is not None and (unposed := unposed_photos(path)):
        from .pose_estimation import estimate_poses

        unplaced = estimate_poses(unposed, poses, progress)
        path = poses_folder = poses
    capture, tested = read_capture(path), read_held_out(path)
    points, moved = _points(path if path.is_dir() else path.parent, capture)
    if strict:
        _check_present(capture)
    capture, missing = _present(capture)
    extent = _extent(capture)
    check_views(capture.path, capture.cameras, points)
    shots = _shots(capture, scale, progress)
    if all(shot.photo.std(axis=(0, 1)).max() < MIN_STD for shot in shots):
        raise FileError(f"every photograph of {capture.path} is of one plain colour; there is nothing to train on")
    warning = check_colors(capture.path, shots, points)
    divided: tuple[str, ...] = ()
    if tested is None:
        train, held_out = _eighth_apart(capture, shots)
    else:
        if strict:
            _check_present(tested)
        tested, also_missing = _present(tested)
        missing += also_missing
        train, held_out = shots, _named_apart(_shots(tested, scale, progress), shots, tested.path)
        divided = (f"training on the photographs of {capture.path.name}; held out are those of {tested.path.name}",)
    if len(train) < MIN_PHOTOS:
        raise FileError(f"{capture.path} has {len(shots)} photographs; at least {MIN_PHOTOS + 1} are needed")
    notes = (*moved, *divided, *_seconds_note(capture, train))
    return Photos(tuple(train), tuple(held_out), points, extent, warning, poses_folder, unplaced, missing, notes)


def _shots(capture: Capture, scale: float | None, progress: Progress) -> list[Shot]:
    """The photographs of a capture, undistorted and scaled."""
    shots = []
    for i, (camera, photo, lens) in enumerate(zip(capture.cameras, capture.photos, capture.lenses, strict=True)):
        time = None if capture.times is None else capture.times[i]
        shots.append(replace(_shot(photo, camera, lens, scale), time=time))
        progress("reading photographs", (i + 1) / len(capture.photos))
    return shots


def _eighth_apart(capture: Capture, shots: Sequence[Shot]) -> tuple[list[Shot], list[Shot]]:
    """The photographs to train on, and every eighth by name, which is held out."""
    order = sorted(range(len(shots)), key=lambda i: capture.photos[i].name)
    if _is_film(shots):  # the first frame of every camera shows the start, which all later ones are compared with
        first = min(shot.time for shot in shots if shot.time is not None)
        order = [*(i for i in order if shots[i].time != first), *(i for i in order if shots[i].time == first)]
        apart = {i for k, i in enumerate(order) if k % TEST_EVERY == TEST_EVERY // 2 and shots[i].time != first}
    else:
        apart = {i for k, i in enumerate(order) if k % TEST_EVERY == 0}
    return [shots[i] for i in order if i not in apart], [shots[i] for i in order if i in apart]


def _named_apart(held_out: Sequence[Shot], train: Sequence[Shot], file: Path) -> list[Shot]:
    """The photographs of a file for testing; those called as one for training get the name of the file before."""
    taken = {shot.camera.name for shot in train}
    prefix = file.stem.rpartition("_")[2]  # transforms_test: both number their photographs from r_000 on
    return [
        replace(shot, camera=replace(shot.camera, name=f"{prefix}-{shot.camera.name}"))
        if shot.camera.name in taken
        else shot
        for shot in held_out
    ]


def _seconds_note(capture: Capture, shots: Sequence[Shot]) -> tuple[str, ...]:
    """A note that the times of a D-NeRF capture, which are shares of a film of unknown length, are taken as seconds."""
    times = [shot.time for shot in shots if shot.time is not None]
    if capture.path.name != TRAIN or not _is_film(shots) or not 0 <= min(times) <= max(times) <= 1:
        return ()
    return ("times run from 0 to 1: taken as seconds",)


def _extent(capture: Capture) -> float:
    eyes = np.stack([c.position for c in capture.cameras])
    radius = float(np.linalg.norm(eyes - eyes.mean(axis=0), axis=1).max())
    if len(eyes) > 1 and not radius > SAME_PLACE * np.abs(eyes).max():
        raise FileError(f"{capture.path}: all cameras stand in one place, so depth cannot be recovered; "
                        "take photographs from several places")  # fmt: skip
    return 1.1 * radius


def _check_present(capture: Capture) -> None:
    if missing := [p for p in capture.photos if not is_file(p)]:
        more = f", and so are {len(missing) - 1} more photographs" if len(missing) > 1 else ""
        raise FileError(f"the photograph {missing[0]} is missing{more}; restore it or remove it from {capture.path}")


def _present(capture: Capture) -> tuple[Capture, tuple[str, ...]]:
    """The capture with those photographs that are there, and the names of the others.

    Raises:
        FileError: none of them is there.
    """
    there = [i for i, photo in enumerate(capture.photos) if is_file(photo)]
    if not there:
        first = str(capture.photos[0])[:200]
        raise FileError(
            f"none of the {len(capture.photos)} photographs of {capture.path} is there; the first is {first}"
        )
    if len(there) == len(capture.photos):
        return capture, ()
    missing = tuple(p.name for i, p in enumerate(capture.photos) if i not in set(there))
    cameras, photos = tuple(capture.cameras[i] for i in there), tuple(capture.photos[i] for i in there)
    times = None if capture.times is None else tuple(capture.times[i] for i in there)
    return Capture(capture.path, cameras, photos, tuple(capture.lenses[i] for i in there), times), missing


def _points(folder: Path, capture: Capture) -> tuple[colmap.Points, tuple[str, ...]]:
    """The surveyed points in the frame of the capture's cameras, and a sentence if they had to be moved into it."""
    sparse = colmap.find(folder)
    if sparse is None:
        return colmap.Points(np.zeros((0, 3)), np.zeros((0, 3))), ()
    points = colmap.read_points(sparse)
    if capture.path == sparse or not len(points.means):
        return points, ()
    found = similarity(
        _views(sparse), {photo.name: c for photo, c in zip(capture.photos, capture.cameras, strict=True)}
    )
    if found is None or found.is_identity():
        return points, ()
    return colmap.Points(found.apply(points.means), points.colors), (
        f"{capture.path.name} and {sparse.name or sparse} are in different frames; the surveyed points were moved: "
        f"{found.describe()}",
    )


def _views(sparse: Path) -> dict[str, Camera]:
    """The cameras of a COLMAP model by file name; none if its cameras or photographs cannot be read, as only its points
    are needed."""
    try:
        return {Path(view.name).name: view.camera for view in colmap.read_views(sparse)}
    except FileError:
        return {}


def _shot(path: Path, camera: Camera, lens: Lens, scale: float | None) -> Shot:
    from PIL import Image

    photo = read_photo(path, (camera.width, camera.height))
    height, width = photo.shape[:2]
    camera = camera.resized(width, height)
    photo = undistort(photo, camera, lens)
    factor = scale if scale is not None else _default_scale(max(width, height))
    small = int(width * factor), int(height * factor)
    if min(small) < MIN_SIDE:
        raise UserError(f"--scale {factor:g} leaves too few of {width}x{height} pixels to train on; give a larger one")
    if small != (width, height):
        photo = np.asarray(Image.fromarray(photo).resize(small, Image.Resampling.BOX))
    return Shot(camera.resized(*small), photo)


def _default_scale(longest: int) -> float:
    factor = 1.0
    while longest * factor > MAX_SIDE:
        factor /= 2
    return factor

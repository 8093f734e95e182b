"""The cameras of a film: on a ring around the scene, those of a capture, or along a path; and its frame rate."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from ...gaussians.errors import UserError
from .named_cameras import framed
from .times import times_within

if TYPE_CHECKING:
    from ...gaussians.camera import Camera
    from ...gaussians.scene import Scene

MAX_PICTURES = 10_000
RATE = 25.0  # pictures a second, by default; GIF delays are in hundredths of a second, so 25 is exact
_MIN_TURN = 6.0  # seconds, least duration of an orbit by default: a faster one is hard to watch
RATES = (0.1, 240.0)  # pictures a second, least and greatest

Size = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Shots:
    """The pictures of a film in order.

    Attributes:
        cameras: one for each picture.
        names: one for each picture, distinct and valid as file names, without suffix.
        fps: pictures a second.
        times: of the scene, seconds, one for each picture; empty where it is shown as it is.
    """

    cameras: tuple[Camera, ...]
    names: tuple[str, ...]
    fps: float
    times: tuple[float, ...] = ()

    @property
    def seconds(self) -> float:
        return len(self.cameras) / self.fps


def orbit_shots(
    scene: Scene, capture: Path | None, count: int, size: Size, seconds: float | None, fps: float | None
) -> Shots:
    """`count` pictures once around the scene, on the ring that the cameras of `capture`, or many own ones, stood on.

    Raises:
        UserError: the number of pictures or the rate is out of range.
        FileError: the capture cannot be read.
    """
    from ...gaussians.viewpoints.orbit import MIN_CAMERAS, choose_ring

    if not 2 <= count <= MAX_PICTURES:
        raise UserError(f"an orbit has 2 to {MAX_PICTURES} pictures, not {count}; write for example --orbit 75")
    turn = seconds if seconds is not None or fps is not None else max(_MIN_TURN, count / RATE)
    rate = _rate(count, turn, fps)
    cameras = scene.cameras if len(scene.cameras) >= MIN_CAMERAS else ()
    if capture is not None:
        cameras = cameras_of(capture)
    ring = choose_ring(framed(scene.replace(cameras=cameras or scene.cameras)), cameras)
    return _numbered(ring.cameras(count, *size), rate)


def capture_shots(source: Path, size: Size | None, seconds: float | None, fps: float | None) -> Shots:
    """A picture for every camera of a capture or scene, named as its photograph; of its own size if `size` is None.

    Raises:
        UserError: the rate is out of range, or there are no cameras or too many.
        FileError: the source cannot be read.
    """
    from ...gaussians.viewpoints.coverage import fit_camera

    cameras = cameras_of(source)
    if not 1 <= len(cameras) <= MAX_PICTURES:
        raise UserError(f"{source} has {len(cameras)} cameras; it must have 1 to {MAX_PICTURES}")
    names = _file_names([camera.name for camera in cameras])
    if size is not None:
        cameras = tuple(fit_camera(camera, *size) for camera in cameras)
    return Shots(cameras, names, _rate(len(cameras), seconds, fps))


def path_shots(
    scene: Scene, path: Path, size: Size | None, default: Size, seconds: float | None, fps: float | None
) -> Shots:
    """Pictures along the camera path in a file, from its first keyframe to its last; `seconds` stretches it.

    Raises:
        UserError: the rate or the length is out of range, or there would be too many pictures.
        FileError: the file is not a camera path.
    """
    from ...gaussians.files.captures.camera_path import read_camera_path

    way = read_camera_path(path, framed(scene).frame.up)
    rate = _checked_rate(fps or way.fps or RATE)
    length = way.seconds if seconds is None else _checked_seconds(seconds)
    if length * rate > MAX_PICTURES - 1:
        raise UserError(
            f"{length:g} seconds at {rate:g} pictures a second are too many; at most {MAX_PICTURES} are drawn"
        )
    count = round(length * rate) + 1
    times = [way.seconds * i / max(count - 1, 1) for i in range(count)]
    return _numbered(way.cameras(times, *(size or way.size or default)), rate)


def timed_shots(camera: Camera, span: tuple[float, float], seconds: float | None, fps: float | None) -> Shots:
    """Pictures from one camera while time goes on from the start of a span to its stop; `seconds` stretches it.

    Raises:
        UserError: the rate or the length is out of range, or there would be too many pictures.
    """
    rate = _checked_rate(RATE if fps is None else fps)
    times = times_within(span, rate, None if seconds is None else _checked_seconds(seconds))
    return replace(_numbered([camera] * len(times), rate), times=times)


def cameras_of(source: Path) -> tuple[Camera, ...]:
    """The cameras of a capture (a transforms.json, its folder or a COLMAP folder) or of a scene."""
    from ...gaussians.files import load
    from ...gaussians.files.captures.capture import is_capture, read_capture

    if is_capture(source) or source.suffix.lower() == ".json":
        return read_capture(source).cameras
    return load(source).cameras


def _rate(count: int, seconds: float | None, fps: float | None) -> float:
    """Pictures a second of a film of `count` pictures."""
    if seconds is not None and fps is not None:
        raise UserError(
            f"{count} pictures at --fps {fps:g} last {count / max(fps, 1e-9):g} s: leave out --seconds or --fps"
        )
    return _checked_rate(count / _checked_seconds(seconds) if seconds is not None else RATE if fps is None else fps)


def _checked_rate(fps: float) -> float:
    if not RATES[0] <= fps <= RATES[1]:
        raise UserError(f"{fps:g} pictures a second are not supported; give {RATES[0]:g} to {RATES[1]:g}")
    return fps


def _checked_seconds(seconds: float) -> float:
    if not 0 < seconds < math.inf:
        raise UserError(f"--seconds must be a number above zero, not {seconds:g}")
    return seconds


def _numbered(cameras: Sequence[Camera], fps: float) -> Shots:
    digits = max(4, len(str(len(cameras) - 1)))
    return Shots(tuple(cameras), tuple(f"{i:0{digits}d}" for i in range(len(cameras))), fps)


def _file_names(names: Sequence[str]) -> tuple[str, ...]:
    """File names for one folder: without separators, not hidden, not empty, distinct regardless of case."""
    found: list[str] = []
    taken: set[str] = set()
    for i, name in enumerate(names):
        plain = re.sub(r"[^\w .-]", "_", name).strip(" .")[:100] or f"{i:04d}"
        unique, more = plain, 2
        while unique.lower() in taken:
            unique, more = f"{plain}-{more}", more + 1
        taken.add(unique.lower())
        found.append(unique)
    return tuple(found)

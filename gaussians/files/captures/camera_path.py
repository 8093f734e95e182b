"""Reads camera paths from JSON: our own keyframes, and the `camera_path.json` that nerfstudio's viewer saves.

Our format: `{"keyframes": [...]}` with optional `fps`, `size` `[width, height]`, and defaults for `fov` and `up`. A
keyframe has `time` in seconds, and either `position`, `target` and optional `up`, or `world_to_camera` (4x4, OpenCV
axes); `fov` is vertical, in degrees.

nerfstudio's format: a list `camera_path` with one entry per picture, each with `camera_to_world` (16 numbers, row by
row, OpenGL axes) and `fov` (vertical, degrees), and common `fps`, `render_width`, `render_height`, `camera_type`
(nerfstudio/cameras/camera_paths.py, get_path_from_json). Its `keyframes` belong to the viewer and are not read.

`viewpoints.keyframes` interpolates between keyframes.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...camera import Camera, Vec3
from ...errors import FileError, UserError
from ...viewpoints.keyframes import CameraPath, Keyframe
from ..foreign import read_json
from .capture import from_opengl

MAX_KEYFRAMES = 20_000
_SPACING = 2.0  # seconds between keyframes, if none of them has a time
_FOV = 55.0  # degrees, the default
_SIDE = 1000  # pixels; the size of a keyframe's camera has no meaning beyond its field of view
_MAX_NUMBER = 1e9  # magnitude of any number; float32 cannot represent scenes beyond it
_MAX_SIDE = 8192  # pixels, as for all rendered pictures


def read_camera_path(path: Path, up: Vec3) -> CameraPath:
    """The camera path in a file; `up` is the scene's, for keyframes that name none.

    Raises:
        FileError: the file is missing, not JSON, or not a camera path; the message names the keyframe.
    """
    data = read_json(path)
    if not isinstance(data, dict) or not ("camera_path" in data or "keyframes" in data):
        raise FileError(f'{path} is not a camera path; it needs a list "keyframes" (or nerfstudio\'s "camera_path")')
    try:
        return _nerfstudio(data) if "camera_path" in data else _ours(data, up)
    except (KeyError, TypeError, ValueError, ArithmeticError, UserError) as error:
        reason = f"{error.args[0]!r} is missing" if isinstance(error, KeyError) else str(error)
        raise FileError(f"{path}: {reason}") from error


def _ours(data: Mapping[str, Any], up: Vec3) -> CameraPath:
    shared = {"fov": data.get("fov", _FOV), "up": data.get("up", up)}
    size = None if "size" not in data else _size(data["size"])
    entries = _entries(data, "keyframes")
    timed = [isinstance(entry, dict) and "time" in entry for entry in entries]
    if any(timed) and not all(timed):
        raise ValueError(f"keyframe {timed.index(False)} has no time; give one to all keyframes or to none")
    found = []
    for i, entry in enumerate(entries):
        with _error_context("keyframe", i):
            found.append(_keyframe({**shared, "time": _SPACING * i, **_object(entry)}))
    return CameraPath(tuple(found), size, _fps(data))


def _keyframe(data: Mapping[str, Any]) -> Keyframe:
    time, fov, up = _number(data["time"], "time"), _number(data["fov"], "fov"), _vector(data["up"], "up")
    if not any(up):
        raise ValueError("up must be a direction, not 0, 0, 0")
    if "world_to_camera" in data:
        if "position" in data or "target" in data:
            raise ValueError("give position and target, or world_to_camera, not both")
        return Keyframe(time, _camera(_matrix(data["world_to_camera"], "world_to_camera"), fov), None, up)
    eye, target = _vector(data["position"], "position"), _vector(data["target"], "target")
    return Keyframe(time, Camera.look_at(eye, target, up, _SIDE, _SIDE, fov), target, up)


def _nerfstudio(data: Mapping[str, Any]) -> CameraPath:
    kind = data.get("camera_type", "perspective")
    if kind != "perspective":
        raise ValueError(f"camera_type {kind!r} cannot be drawn; only perspective can")
    fps = _fps(data)
    size = _size([data["render_width"], data["render_height"]]) if "render_width" in data else None
    found = []
    for i, listed in enumerate(_entries(data, "camera_path")):
        with _error_context("picture", i):
            entry = _object(listed)
            world = from_opengl(_matrix(entry["camera_to_world"], "camera_to_world"))
            found.append(Keyframe(i / (fps or 24.0), _camera(world, _number(entry["fov"], "fov"))))
    return CameraPath(tuple(found), size, fps)


@contextlib.contextmanager
def _error_context(what: str, number: int) -> Iterator[None]:
    """Prefix errors raised in the block with the entry's number."""
    try:
        yield
    except KeyError as error:
        raise ValueError(f"{what} {number} has no {error.args[0]}") from error
    except (TypeError, ValueError, ArithmeticError, UserError) as error:
        raise ValueError(f"{what} {number}: {error}") from error


def _entries(data: Mapping[str, Any], key: str) -> list[Any]:
    entries = data[key]
    if not isinstance(entries, list) or not 1 <= len(entries) <= MAX_KEYFRAMES:
        raise ValueError(f'"{key}" must be a list of 1 to {MAX_KEYFRAMES} entries')
    return entries


def _object(entry: Any) -> dict[str, Any]:
    if not isinstance(entry, dict):
        raise ValueError("is not a JSON object")
    return entry


def _number(value: Any, name: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= _MAX_NUMBER:
        raise ValueError(f"{name} must be a number up to {_MAX_NUMBER:g}")
    return float(value)


def _vector(value: Any, name: str) -> Vec3:
    if not isinstance(value, list | tuple) or len(value) != 3:
        raise ValueError(f"{name} must be three numbers")
    x, y, z = (_number(c, name) for c in value)
    return (x, y, z)


def _matrix(value: Any, name: str) -> NDArray[np.float64]:
    """`[4, 4]`, from a flat list of 16 numbers or a list of rows; the last row may be missing."""
    rows = value if isinstance(value, list) else []
    flat = [c for row in rows for c in row] if rows and all(isinstance(row, list) for row in rows) else rows
    if len(flat) not in (12, 16):
        raise ValueError(f"{name} must be a 4x4 matrix")
    numbers = [_number(c, name) for c in flat]
    return np.array([*numbers, 0.0, 0.0, 0.0, 1.0][:16]).reshape(4, 4)


def _camera(world_to_camera: NDArray[np.float64], fov: float) -> Camera:
    if not 0 < fov < 180:
        raise ValueError(f"the field of view must lie between 0 and 180 degrees, not {fov:g}")
    focal = 0.5 * _SIDE / math.tan(math.radians(fov) / 2)
    return Camera(world_to_camera, focal, focal, _SIDE / 2, _SIDE / 2, _SIDE, _SIDE)


def _size(value: Any) -> tuple[int, int]:
    sides = [_number(side, "size") for side in value] if isinstance(value, list) else []
    if len(sides) != 2 or not all(side == int(side) and 1 <= side <= _MAX_SIDE for side in sides):
        raise ValueError(f"the size must be two whole numbers from 1 to {_MAX_SIDE}")
    return int(sides[0]), int(sides[1])


def _fps(data: Mapping[str, Any]) -> float | None:
    fps = None if data.get("fps") is None else _number(data["fps"], "fps")
    if fps is not None and not 0.1 <= fps <= 240:
        raise ValueError(f"fps must lie between 0.1 and 240, not {fps:g}")
    return fps

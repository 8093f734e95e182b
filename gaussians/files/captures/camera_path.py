"""Camera paths in JSON: our own keyframes, and the `camera_path.json` that nerfstudio's viewer saves.

Ours: `{"keyframes": [...]}` with perhaps `fps`, `size` `[width, height]`, and `fov` and `up` for keyframes that have
none. A keyframe has `time` in seconds, and either `position`, `target` and perhaps `up`, or `world_to_camera` (4x4,
OpenCV axes); `fov` is vertical, in degrees.

nerfstudio's: a list `camera_path` of one entry a picture, each with `camera_to_world` (16 numbers by rows, OpenGL axes)
and `fov` (vertical, degrees), and `fps`, `render_width`, `render_height`, `camera_type` for all
(nerfstudio/cameras/camera_paths.py, get_path_from_json). Its `keyframes` are the viewer's own and are not read.

Knows both files. Refuses to know how the way between keyframes is found.
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

MOST = 20_000  # keyframes
_APART = 2.0  # seconds between keyframes of which none has a time
_FOV = 55.0  # degrees
_SIDE = 1000  # pixels of keyframes' cameras, whose size says nothing
_FARTHEST = 1e9  # of any number: beyond it single precision knows no scene
_LONGEST = 8192  # pixels of a picture's side, as everywhere


def read_camera_path(path: Path, up: Vec3) -> CameraPath:
    """The camera path in a file; `up` is the scene's, for keyframes that name none.

    Raises:
        FileError: it is missing, no JSON, or no camera path; the message names the keyframe.
    """
    told = read_json(path)
    if not isinstance(told, dict) or not ("camera_path" in told or "keyframes" in told):
        raise FileError(f'{path} is no camera path; it needs a list "keyframes" (or nerfstudio\'s "camera_path")')
    try:
        return _nerfstudio(told) if "camera_path" in told else _ours(told, up)
    except (KeyError, TypeError, ValueError, ArithmeticError, UserError) as error:
        said = f"{error.args[0]!r} is missing" if isinstance(error, KeyError) else str(error)
        raise FileError(f"{path}: {said}") from error


def _ours(told: Mapping[str, Any], up: Vec3) -> CameraPath:
    shared = {"fov": told.get("fov", _FOV), "up": told.get("up", up)}
    size = None if "size" not in told else _size(told["size"])
    entries = _entries(told, "keyframes")
    timed = [isinstance(entry, dict) and "time" in entry for entry in entries]
    if any(timed) and not all(timed):
        raise ValueError(f"keyframe {timed.index(False)} has no time; give one to all keyframes or to none")
    found = []
    for i, entry in enumerate(entries):
        with _naming("keyframe", i):
            found.append(_keyframe({**shared, "time": _APART * i, **_object(entry)}))
    return CameraPath(tuple(found), size, _fps(told))


def _keyframe(told: Mapping[str, Any]) -> Keyframe:
    time, fov, up = _number(told["time"], "time"), _number(told["fov"], "fov"), _vector(told["up"], "up")
    if not any(up):
        raise ValueError("up must point somewhere, not 0, 0, 0")
    if "world_to_camera" in told:
        if "position" in told or "target" in told:
            raise ValueError("give position and target, or world_to_camera, not both")
        return Keyframe(time, _posed(_matrix(told["world_to_camera"], "world_to_camera"), fov), None, up)
    eye, target = _vector(told["position"], "position"), _vector(told["target"], "target")
    return Keyframe(time, Camera.look_at(eye, target, up, _SIDE, _SIDE, fov), target, up)


def _nerfstudio(told: Mapping[str, Any]) -> CameraPath:
    kind = told.get("camera_type", "perspective")
    if kind != "perspective":
        raise ValueError(f"camera_type {kind!r} cannot be drawn; only perspective can")
    fps = _fps(told)
    size = _size([told["render_width"], told["render_height"]]) if "render_width" in told else None
    found = []
    for i, entry in enumerate(_entries(told, "camera_path")):
        with _naming("picture", i):
            there = _object(entry)
            pose = _matrix(there["camera_to_world"], "camera_to_world")
            turn = pose[:3, :3] * [1, -1, -1]  # OpenGL to OpenCV axes
            world = np.eye(4)
            world[:3, :3], world[:3, 3] = turn.T, -turn.T @ pose[:3, 3]
            found.append(Keyframe(i / (fps or 24.0), _posed(world, _number(there["fov"], "fov"))))
    return CameraPath(tuple(found), size, fps)


@contextlib.contextmanager
def _naming(what: str, number: int) -> Iterator[None]:
    """Puts the entry's number before what is wrong with it."""
    try:
        yield
    except KeyError as error:
        raise ValueError(f"{what} {number} has no {error.args[0]}") from error
    except (TypeError, ValueError, ArithmeticError, UserError) as error:
        raise ValueError(f"{what} {number}: {error}") from error


def _entries(told: Mapping[str, Any], key: str) -> list[Any]:
    entries = told[key]
    if not isinstance(entries, list) or not 1 <= len(entries) <= MOST:
        raise ValueError(f'"{key}" must be a list of 1 to {MOST} entries')
    return entries


def _object(entry: Any) -> dict[str, Any]:
    if not isinstance(entry, dict):
        raise ValueError("is no object")
    return entry


def _number(told: Any, name: str) -> float:
    if isinstance(told, bool) or not isinstance(told, int | float) or not abs(told) <= _FARTHEST:
        raise ValueError(f"{name} must be a number up to {_FARTHEST:g}")
    return float(told)


def _vector(told: Any, name: str) -> Vec3:
    if not isinstance(told, list | tuple) or len(told) != 3:
        raise ValueError(f"{name} must be three numbers")
    x, y, z = (_number(c, name) for c in told)
    return (x, y, z)


def _matrix(told: Any, name: str) -> NDArray[np.float64]:
    """`[4, 4]`, from 16 numbers by rows or from rows, of which the last may be missing."""
    rows = told if isinstance(told, list) else []
    flat = [c for row in rows for c in row] if rows and all(isinstance(row, list) for row in rows) else rows
    if len(flat) not in (12, 16):
        raise ValueError(f"{name} must be a 4x4 matrix")
    numbers = [_number(c, name) for c in flat]
    return np.array([*numbers, 0.0, 0.0, 0.0, 1.0][:16]).reshape(4, 4)


def _posed(world_to_camera: NDArray[np.float64], fov: float) -> Camera:
    if not 0 < fov < 180:
        raise ValueError(f"the field of view must lie between 0 and 180 degrees, not {fov:g}")
    focal = 0.5 * _SIDE / math.tan(math.radians(fov) / 2)
    return Camera(world_to_camera, focal, focal, _SIDE / 2, _SIDE / 2, _SIDE, _SIDE)


def _size(told: Any) -> tuple[int, int]:
    sides = [_number(side, "size") for side in told] if isinstance(told, list) else []
    if len(sides) != 2 or not all(side == int(side) and 1 <= side <= _LONGEST for side in sides):
        raise ValueError(f"the size must be two whole numbers from 1 to {_LONGEST}")
    return int(sides[0]), int(sides[1])


def _fps(told: Mapping[str, Any]) -> float | None:
    fps = None if told.get("fps") is None else _number(told["fps"], "fps")
    if fps is not None and not 0.1 <= fps <= 240:
        raise ValueError(f"fps must lie between 0.1 and 240, not {fps:g}")
    return fps

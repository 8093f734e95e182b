"""Photographs and where they were taken from: `transforms.json`, as nerfstudio and instant-ngp write it, or COLMAP.

Poses in `transforms.json` are camera-to-world in OpenGL axes (+x right, +y up, +z backward), intrinsics in pixels, once
for all frames or for each (https://docs.nerf.studio/quickstart/data_conventions.html); ours are world-to-camera in
OpenCV axes. Knows the file, and when to leave it to `colmap`. Refuses to know what is done with the photographs.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from ..errors import FileError, UserError
from ..lens import Lens
from . import colmap
from .foreign import read_json

TRANSFORMS = "transforms.json"
_MODELS = ("OPENCV", "PINHOLE", "SIMPLE_PINHOLE", "RADIAL", "SIMPLE_RADIAL", "PERSPECTIVE")
LONGEST = 1 << 16  # pixels of a side: no photograph is longer, and masks as large as one must fit into memory


@dataclass(frozen=True)
class Capture:
    """A set of photographs with poses.

    Attributes:
        path: the file that says so.
        cameras: one a photograph, of its full size, named by its file name without suffix.
        photos: the photographs' paths, which need not exist.
        lenses: what each camera's lens does, which the cameras themselves leave out.
    """

    path: Path
    cameras: tuple[Camera, ...]
    photos: tuple[Path, ...]
    lenses: tuple[Lens, ...]

    def camera(self, name: str) -> Camera | None:
        """The camera of the photograph `name` (with or without folder and suffix), or None."""
        stem = Path(name).stem.lower()
        return next((c for c in self.cameras if c.name.lower() == stem), None)


def read_capture(path: Path) -> Capture:
    """The capture in a `transforms.json`, or in a folder that holds one or a COLMAP model (with photographs in
    `images`).

    Raises:
        FileError: it is not there, or is no such file.
    """
    file = path / TRANSFORMS if path.is_dir() else path
    if path.is_dir() and not file.exists() and (sparse := colmap.find(path)) is not None:
        views = colmap.read_views(sparse)
        taken = [path / "images" / view.name for view in views]
        return _capture(sparse, [v.camera for v in views], taken, [v.lens for v in views])
    try:
        told = read_json(file)
    except FileError as error:
        raise FileError(f"{error}; give a transforms.json with --capture") from error
    frames = told.get("frames") if isinstance(told, dict) else None
    if not isinstance(frames, list) or not frames:
        raise FileError(f"{file} lists no frames; give a transforms.json as nerfstudio writes it")
    cameras: list[Camera] = []
    photos: list[Path] = []
    lenses: list[Lens] = []
    for i, frame in enumerate(frames):
        try:
            photo = file.parent / _text(frame["file_path"])
            cameras.append(_camera({**told, **frame}, photo.stem))
            lenses.append(_lens({**told, **frame}))
        except (KeyError, TypeError, ValueError, ArithmeticError, UserError) as error:
            missing = f"has no {error}" if isinstance(error, KeyError) else f"is broken: {error}"
            raise FileError(f"{file}: frame {i} {missing}") from error
        photos.append(photo)
    return _capture(file, cameras, photos, lenses)


def _capture(file: Path, cameras: list[Camera], photos: list[Path], lenses: list[Lens]) -> Capture:
    twice = sorted(name for name, times in Counter(c.name for c in cameras).items() if times > 1)
    if twice:
        raise FileError(f"{file}: two frames are called {twice[0]}; photographs need different names")
    return Capture(file, tuple(cameras), tuple(photos), tuple(lenses))


def _text(told: Any) -> str:
    if not isinstance(told, str) or not told:
        raise ValueError(f"file_path must be a name, not {told!r}")
    return told


def _camera(told: Mapping[str, Any], name: str) -> Camera:
    """One frame's camera; `told` holds its own entries over those of the whole file.

    Raises:
        KeyError, TypeError, ValueError, ArithmeticError, UserError: an entry is missing, is no number or no possible
            one, or the pose is not rigid.
    """
    pose: NDArray[np.float64] = np.array(told["transform_matrix"], dtype=np.float64)
    if pose.shape == (3, 4):
        pose = np.vstack([pose, [0, 0, 0, 1]])
    if pose.shape != (4, 4) or not np.isfinite(pose).all():
        raise ValueError("transform_matrix is not 4x4 finite numbers")
    world = np.eye(4)
    turn = pose[:3, :3] * [1, -1, -1]  # OpenGL to OpenCV axes
    world[:3, :3], world[:3, 3] = turn.T, -turn.T @ pose[:3, 3]
    width, height = int(told["w"]), int(told["h"])
    if max(width, height) > LONGEST:
        raise ValueError(f"a photograph of {width}x{height} pixels is none")
    fx = float(told["fl_x"]) if "fl_x" in told else 0.5 * width / math.tan(0.5 * float(told["camera_angle_x"]))
    fy, cx, cy = (float(told.get(key, usual)) for key, usual in (("fl_y", fx), ("cx", width / 2), ("cy", height / 2)))
    return Camera(world, fx, fy, cx, cy, width, height, name)


def _lens(told: Mapping[str, Any]) -> Lens:
    """One frame's lens.

    Raises:
        TypeError, ValueError: its distortion is not finite numbers, or another one than a polynomial's.
    """
    model = told.get("camera_model", "OPENCV")
    if model not in _MODELS:
        raise ValueError(f"camera_model {model!r} is not one of {', '.join(_MODELS)}; undistort the photographs first")
    values = [float(told.get(key, 0.0)) for key in ("k1", "k2", "k3", "p1", "p2")]
    if not all(map(math.isfinite, values)):
        raise ValueError("its lens distortion is not finite")
    return Lens(*values)

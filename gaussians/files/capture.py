"""Photographs and where they were taken from: `transforms.json`, as nerfstudio and instant-ngp write it.

Poses there are camera-to-world in OpenGL axes (+x right, +y up, +z backward), intrinsics in pixels, once for all frames
or for each (https://docs.nerf.studio/quickstart/data_conventions.html); ours are world-to-camera in OpenCV axes.
Knows the file. Refuses to know what is done with the photographs; lens distortion is not undone.
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
from .foreign import read_json

TRANSFORMS = "transforms.json"
LONGEST = 1 << 16  # pixels of a side: no photograph is longer, and masks as large as one must fit into memory


@dataclass(frozen=True)
class Capture:
    """A set of photographs with poses.

    Attributes:
        path: the file that says so.
        cameras: one a photograph, of its full size, named by its file name without suffix.
        photos: the photographs' paths, which need not exist.
    """

    path: Path
    cameras: tuple[Camera, ...]
    photos: tuple[Path, ...]

    def camera(self, name: str) -> Camera | None:
        """The camera of the photograph `name` (with or without folder and suffix), or None."""
        stem = Path(name).stem.lower()
        return next((c for c in self.cameras if c.name.lower() == stem), None)


def read_capture(path: Path) -> Capture:
    """The capture in a `transforms.json`, or in a folder that holds one.

    Raises:
        FileError: it is not there, or is no such file.
    """
    file = path / TRANSFORMS if path.is_dir() else path
    try:
        told = read_json(file)
    except FileError as error:
        raise FileError(f"{error}; give a transforms.json with --capture") from error
    frames = told.get("frames") if isinstance(told, dict) else None
    if not isinstance(frames, list) or not frames:
        raise FileError(f"{file} lists no frames; give a transforms.json as nerfstudio writes it")
    cameras, photos = [], []
    for i, frame in enumerate(frames):
        try:
            photo = file.parent / _text(frame["file_path"])
            cameras.append(_camera({**told, **frame}, photo.stem))
        except (KeyError, TypeError, ValueError, ArithmeticError, UserError) as error:
            missing = f"has no {error}" if isinstance(error, KeyError) else f"is broken: {error}"
            raise FileError(f"{file}: frame {i} {missing}") from error
        photos.append(photo)
    twice = sorted(name for name, times in Counter(c.name for c in cameras).items() if times > 1)
    if twice:
        raise FileError(f"{file}: two frames are called {twice[0]}; photographs need different names")
    return Capture(file, tuple(cameras), tuple(photos))


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

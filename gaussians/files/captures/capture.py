"""Photographs and where they were taken from: `transforms.json`, as nerfstudio and instant-ngp write it, or COLMAP.

Poses in `transforms.json` are camera-to-world in OpenGL axes (+x right, +y up, +z backward), intrinsics in pixels, once
for all frames or for each (https://docs.nerf.studio/quickstart/data_conventions.html); ours are world-to-camera in
OpenCV axes. Knows the file, when to leave it to `colmap`, and when a folder has photographs alone.
Refuses to know what is done with the photographs.
"""

from __future__ import annotations

import math
import os
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...camera import Camera
from ...errors import FileError, UserError
from ...lens import Lens, check_lens
from ..foreign import read_json
from . import colmap

TRANSFORMS = "transforms.json"
_MODELS = ("OPENCV", "PINHOLE", "SIMPLE_PINHOLE", "RADIAL", "SIMPLE_RADIAL", "PERSPECTIVE")
_SUFFIXES = (".png", ".jpg", ".jpeg", ".PNG", ".JPG", ".JPEG", ".webp")
PICTURES = (".jpg", ".jpeg", ".png")
LONGEST = 1 << 16  # pixels of a side: no photograph is longer, and masks as large as one must fit into memory
FARTHEST = 1e15  # scene units: squares of it are still float32
ROUNDED = 5e-3  # by which a rotation written with few digits may be off, and
EXACT = 1e-5  # by which it is left as it is


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
        FileError: it is not there, or is no such file, or is a folder of photographs without poses.
    """
    file = path / TRANSFORMS if path.is_dir() else path
    if found := photographs_alone(path):
        raise FileError(
            f"{path} has {len(found)} photographs but no poses; `scenewright fit {path} -o SCENE.ply` estimates them "
            "and keeps them in SCENE.ply.poses, which is a capture"
        )
    if path.is_dir() and not file.exists() and (sparse := colmap.find(path)) is not None:
        views = colmap.read_views(sparse)
        taken = [path / "images" / view.name for view in views]
        return _capture(sparse, [v.camera for v in views], taken, [v.lens for v in views])
    try:
        told = read_json(file)
    except FileError as error:
        raise FileError(f"{error}; a capture is a transforms.json, or a folder with one, with COLMAP's sparse/0, or, "
                        f"for fit alone, with photographs ({', '.join(PICTURES)})") from error  # fmt: skip
    frames = told.get("frames") if isinstance(told, dict) else None
    if not isinstance(frames, list) or not frames:
        raise FileError(f"{file} lists no frames; give a transforms.json as nerfstudio writes it")
    cameras: list[Camera] = []
    photos: list[Path] = []
    lenses: list[Lens] = []
    for i, frame in enumerate(frames):
        try:
            if not isinstance(frame, dict):
                raise ValueError("it is no object with file_path and transform_matrix")
            photo = _photo(file.parent, frame["file_path"])
            cameras.append(_camera({**told, **frame}, photo))
            lenses.append(_lens({**told, **frame}))
            check_lens(cameras[-1], lenses[-1])
        except (KeyError, TypeError, ValueError, ArithmeticError, UserError) as error:
            missing = f"has no {error}" if isinstance(error, KeyError) else f"is broken: {error}"
            raise FileError(f"{file}: frame {i} {missing}") from error
        photos.append(photo)
    return _capture(file, cameras, photos, lenses)


def photographs_alone(path: Path) -> list[Path]:
    """The photographs of a folder that says nothing of poses, by name: those in `images`, or else in the folder itself.
    Empty where there are poses, or no photographs.

    Raises:
        FileError: the folder cannot be looked into.
    """
    if not path.is_dir() or (path / TRANSFORMS).exists() or colmap.find(path) is not None:
        return []
    for folder in (path / "images", path):
        try:
            listed = list(folder.iterdir()) if folder.is_dir() else []
        except OSError as error:
            raise FileError(f"cannot look into {folder}: {error.strerror or error}") from error
        files = [p for p in listed if p.suffix.lower() in PICTURES and not p.name.startswith(".") and p.is_file()]
        if files:
            return sorted(files, key=lambda p: p.name)
    return []


def described(cameras: Sequence[Camera], lenses: Sequence[Lens], paths: Sequence[str]) -> dict[str, Any]:
    """What a `transforms.json` says of photographs at `paths`, which are relative to its folder: the reverse of
    `read_capture`."""
    frames = []
    for camera, lens, path in zip(cameras, lenses, paths, strict=True):
        pose = np.linalg.inv(camera.world_to_camera) * [1, -1, -1, 1]  # OpenCV to OpenGL axes
        told = {"fl_x": camera.fx, "fl_y": camera.fy, "cx": camera.cx, "cy": camera.cy}
        size = {"w": camera.width, "h": camera.height}
        frames.append({"file_path": path, "transform_matrix": pose.tolist(), **told, **size, **asdict(lens)})
    return {"camera_model": "OPENCV", "frames": frames}


def _capture(file: Path, cameras: list[Camera], photos: list[Path], lenses: list[Lens]) -> Capture:
    whole = [os.path.abspath(photo) for photo in photos]
    if twice := [path for path, times in Counter(whole).items() if times > 1]:
        raise FileError(f"{file}: two frames are of the photograph {twice[0]}; take one of them out")
    return Capture(file, tuple(_told_apart(file, cameras, whole)), tuple(photos), tuple(lenses))


def _told_apart(file: Path, cameras: list[Camera], whole: list[str]) -> list[Camera]:
    """Cameras of one name are called by their folders too: rigs number the photographs of each of their cameras."""
    times = Counter(c.name for c in cameras)
    if max(times.values()) == 1:
        return cameras
    above = os.path.commonpath([os.path.dirname(path) for path in whole])
    longer = ["-".join(Path(path).relative_to(above).with_suffix("").parts) for path in whole]
    named = [replace(c, name=name) if times[c.name] > 1 else c for c, name in zip(cameras, longer, strict=True)]
    if twice := [name for name, times in Counter(c.name for c in named).items() if times > 1]:
        raise FileError(f"{file}: two frames are called {twice[0]}; photographs need different names")
    return named


def is_file(path: Path) -> bool:
    """Whether there is a file; a name that the system cannot even look up (too long) is none."""
    try:
        return path.is_file()
    except OSError:
        return False


def _photo(folder: Path, name: Any) -> Path:
    """The path of a photograph: instant-ngp and Blender leave its suffix out, Windows writes backslashes."""
    if not isinstance(name, str) or not name:
        raise ValueError(f"file_path must be a name, not {name!r:.40}")
    found = (folder / (way + suffix) for way in (name, name.replace("\\", "/")) for suffix in ("", *_SUFFIXES))
    return next(filter(is_file, found), folder / name)


def _number(told: Mapping[str, Any], key: str) -> float:
    """An entry that must be a number; KeyError if it is not there."""
    value = told[key]
    try:
        if isinstance(value, bool):
            raise TypeError
        return float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"{key} must be a number, not {value!r:.40}") from error


def _camera(told: Mapping[str, Any], photo: Path) -> Camera:
    """One frame's camera; `told` holds its own entries over those of the whole file.

    Raises:
        KeyError, ValueError, ArithmeticError, UserError: an entry is missing, is no number or no possible one, or the
            pose is not rigid.
    """
    pose = _pose(told["transform_matrix"])
    world = np.eye(4)
    turn = pose[:3, :3] * [1, -1, -1]  # OpenGL to OpenCV axes
    world[:3, :3], world[:3, 3] = turn.T, -turn.T @ pose[:3, 3]
    width, height = _size(told, photo)
    fx = _number(told, "fl_x") if "fl_x" in told else _focal(told, width)
    usual = {"fl_y": fx, "cx": width / 2, "cy": height / 2}
    fy, cx, cy = (_number({**usual, **told}, key) for key in usual)
    return Camera(world, fx, fy, cx, cy, width, height, photo.stem)


def _pose(told: Any) -> NDArray[np.float64]:
    """`[4, 4]`, camera to world, OpenGL axes; its rotation is one even where the file rounds."""
    try:
        pose: NDArray[np.float64] = np.array(told, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError("transform_matrix is not 4x4 finite numbers") from error
    if pose.shape == (3, 4):
        pose = np.vstack([pose, [0, 0, 0, 1]])
    if pose.shape != (4, 4) or not np.abs(pose).max() <= FARTHEST:
        raise ValueError("transform_matrix is not 4x4 finite numbers")
    if not np.allclose(pose[3], (0, 0, 0, 1), atol=1e-6):
        row = " ".join(f"{n:g}" for n in pose[3])
        raise ValueError(f"the last row of its transform_matrix is {row}, not 0 0 0 1; it may be transposed")
    u, stretch, v = np.linalg.svd(pose[:3, :3])
    if not stretch[2] > 0 or stretch[0] / stretch[2] > 1 + ROUNDED:
        raise ValueError("the first three columns of its transform_matrix are no rotation (skewed, or all but flat)")
    if abs(stretch[0] - 1) > ROUNDED:
        raise ValueError(f"its transform_matrix scales by {stretch[0]:.4g}; divide its first three columns by that")
    if np.linalg.det(pose[:3, :3]) < 0:
        raise ValueError("its transform_matrix mirrors; export right-handed axes (x right, y up, z back)")
    if np.abs(stretch - 1).max() > EXACT:
        pose[:3, :3] = u @ v
    return pose


def _size(told: Mapping[str, Any], photo: Path) -> tuple[int, int]:
    """Width and height of a photograph, its own where the file says nothing (Blender's)."""
    if "w" not in told and "h" not in told and is_file(photo):
        from PIL import Image

        try:
            with Image.open(photo) as file:
                return file.size
        except (OSError, ValueError, SyntaxError, EOFError, Image.DecompressionBombError) as error:
            raise ValueError(f"it has no w and h, and {photo} is no photograph to take them from") from error
    width, height = _number(told, "w"), _number(told, "h")
    if not 1 <= min(width, height) <= max(width, height) <= LONGEST:
        raise ValueError(f"a photograph of {width:g}x{height:g} pixels is none")
    return int(width), int(height)


def _focal(told: Mapping[str, Any], width: int) -> float:
    if "camera_angle_x" not in told:
        raise ValueError("it has neither fl_x nor camera_angle_x")
    angle = _number(told, "camera_angle_x")
    if not 0 < angle < math.pi:
        raise ValueError(f"camera_angle_x must lie between 0 and pi (radians), got {angle:g}")
    return 0.5 * width / math.tan(0.5 * angle)


def _lens(told: Mapping[str, Any]) -> Lens:
    """One frame's lens.

    Raises:
        ValueError: its distortion is not finite numbers, or another one than a polynomial's.
    """
    model = told.get("camera_model", "OPENCV")
    if model not in _MODELS or told.get("is_fisheye"):
        model = "of a fisheye" if told.get("is_fisheye") else repr(model)
        raise ValueError(f"camera_model {model} is not one of {', '.join(_MODELS)}; undistort the photographs first")
    values = {key: _number({key: 0.0, **told}, key) for key in ("k1", "k2", "k3", "k4", "p1", "p2")}
    if not all(map(math.isfinite, values.values())):
        raise ValueError("its lens distortion is not finite")
    if values.pop("k4"):
        raise ValueError("only fisheyes and rational models have a k4; undistort the photographs first")
    return Lens(**values)

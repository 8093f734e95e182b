"""Reads captures: photographs with camera poses, from a `transforms.json` (nerfstudio, instant-ngp), from files for
training and for testing (`transforms_train.json` and others: Blender's scenes of NeRF, D-NeRF), or from a COLMAP model.

Poses in `transforms.json` are camera-to-world in OpenGL axes (+x right, +y up, +z backward), intrinsics are in pixels,
given once for all frames or for each (https://docs.nerf.studio/quickstart/data_conventions.html); ours are
world-to-camera in OpenCV axes. COLMAP models are read by `colmap`.
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
TRAIN = "transforms_train.json"  # of a capture that is divided by its makers
TESTS = ("transforms_test.json", "transforms_val.json")  # what is held out of it: the first that is there
_MODELS = ("OPENCV", "PINHOLE", "SIMPLE_PINHOLE", "RADIAL", "SIMPLE_RADIAL", "PERSPECTIVE")
_SUFFIXES = (".png", ".jpg", ".jpeg", ".PNG", ".JPG", ".JPEG", ".webp")
PHOTO_SUFFIXES = (".jpg", ".jpeg", ".png")
MAX_SIDE = 1 << 16  # pixels: no photograph is larger, and masks of its size must fit into memory
MAX_COORDINATE = 1e15  # scene units: its square still fits float32
ROTATION_TOLERANCE = 5e-3  # largest error of a rotation that was written with few digits
EXACT_TOLERANCE = 1e-5  # largest error of a rotation that is used without orthogonalising it


@dataclass(frozen=True)
class Capture:
    """A set of photographs with poses.

    Attributes:
        path: the file that holds the poses.
        cameras: one per photograph, of its full size, named by its file name without suffix.
        photos: the photographs' paths, which need not exist.
        lenses: the lens distortion of each camera, which `Camera` does not hold.
        times: seconds, of each frame of a film; None where frames have no `time`.
    """

    path: Path
    cameras: tuple[Camera, ...]
    photos: tuple[Path, ...]
    lenses: tuple[Lens, ...]
    times: tuple[float, ...] | None = None

    def camera(self, name: str) -> Camera | None:
        """The camera of the photograph `name` (with or without folder and suffix), or None."""
        stem = Path(name).stem.lower()
        return next((c for c in self.cameras if c.name.lower() == stem), None)


def read_capture(path: Path) -> Capture:
    """The capture in a `transforms.json`, or in a folder with one, with a `transforms_train.json`, or with a COLMAP
    model (photographs in `images`).

    Raises:
        FileError: the path is missing, is not such a file, or is a folder of photographs without poses.
    """
    file = _transforms(path) if path.is_dir() else path
    if found := unposed_photos(path):
        raise FileError(
            f"{path} has {len(found)} photographs but no poses; `scenewright fit {path} -o SCENE.ply` estimates them "
            "and keeps them in SCENE.ply.poses, which is a capture"
        )
    if path.is_dir() and not file.exists() and (sparse := colmap.find(path)) is not None:
        views = colmap.read_views(sparse)
        taken = [path / "images" / view.name for view in views]
        return _capture(sparse, [v.camera for v in views], taken, [v.lens for v in views])
    try:
        data = read_json(file)
    except FileError as error:
        raise FileError(
            f"{error}; a capture is a transforms.json, or a folder with one, with {TRAIN}, with COLMAP's sparse/0, or, "
            f"for fit only, with photographs ({', '.join(PHOTO_SUFFIXES)})"
        ) from error
    frames = data.get("frames") if isinstance(data, dict) else None
    if not isinstance(frames, list) or not frames:
        raise FileError(f"{file} lists no frames; give a transforms.json as nerfstudio writes it")
    cameras: list[Camera] = []
    photos: list[Path] = []
    lenses: list[Lens] = []
    for i, frame in enumerate(frames):
        try:
            if not isinstance(frame, dict):
                raise ValueError("it is not an object with file_path and transform_matrix")
            photo = _photo(file.parent, frame["file_path"])
            cameras.append(_camera(_with_size({**data, **frame}, photo, file.parent, frames), photo))
            lenses.append(_lens({**data, **frame}))
            check_lens(cameras[-1], lenses[-1])
        except (KeyError, TypeError, ValueError, ArithmeticError, UserError) as error:
            reason = f"has no {error}" if isinstance(error, KeyError) else f"is invalid: {error}"
            raise FileError(f"{file}: frame {i} {reason}") from error
        photos.append(photo)
    return replace(_capture(file, cameras, photos, lenses), times=_times(file, frames))


def read_held_out(path: Path) -> Capture | None:
    """The photographs that the makers of a capture hold out of its training: those of a `transforms_test.json`, or else
    of a `transforms_val.json`, of which some are there. None if the folder is not divided so.

    Raises:
        FileError: such a file is damaged.
    """
    if not path.is_dir() or _transforms(path).name != TRAIN or not (path / TRAIN).exists():
        return None
    found = (path / name for name in TESTS if (path / name).is_file())
    return next((read_capture(file) for file in found if _some_there(file)), None)


def _some_there(file: Path) -> bool:
    """Whether a file names photographs of which some are there; also if it is damaged, which `read_capture` tells."""
    data = read_json(file)
    frames = data.get("frames") if isinstance(data, dict) else None
    return not isinstance(frames, list) or _first_there(file.parent, frames) is not None


def _first_there(folder: Path, frames: Sequence[Any]) -> Path | None:
    """The first photograph of some frames that is there."""
    names = (frame.get("file_path") for frame in frames if isinstance(frame, dict))
    photos = (_photo(folder, name) for name in names if isinstance(name, str) and name)
    return next(filter(is_file, photos), None)


def _with_size(data: dict[str, Any], photo: Path, folder: Path, frames: Sequence[Any]) -> dict[str, Any]:
    """What is told of a frame whose photograph is not there, with the size of another one if none is told.

    Raises:
        ValueError: none is there.
    """
    if "w" in data or "h" in data or is_file(photo):
        return data
    other = _first_there(folder, frames)
    if other is None:
        raise ValueError(f"it has no w and h, and no photograph is there that has them; the first is {photo}")
    width, height = _size(data, other)
    return {**data, "w": width, "h": height}


def is_capture(folder: Path) -> bool:
    """Whether a folder holds poses of photographs, in a file or as COLMAP writes them."""
    return folder.is_dir() and (_transforms(folder).exists() or colmap.find(folder) is not None)


def _transforms(folder: Path) -> Path:
    """The file in a folder that holds its poses, if they are not COLMAP's; it need not exist."""
    divided = not (folder / TRANSFORMS).exists() and (folder / TRAIN).is_file()
    return folder / (TRAIN if divided else TRANSFORMS)


def _times(file: Path, frames: Sequence[Mapping[str, Any]]) -> tuple[float, ...] | None:
    """The `time` of each frame; None if no frame has one.

    Raises:
        FileError: some frames have one and others do not, or one is not a finite number.
    """
    without = [i for i, frame in enumerate(frames) if frame.get("time") is None]
    if len(without) == len(frames):
        return None
    if without:
        raise FileError(
            f"{file}: frame {without[0]} has no time, and {len(frames) - len(without)} other frames have one; give "
            "every frame its time in seconds, or none"
        )
    found = []
    for i, frame in enumerate(frames):
        try:
            found.append(_number(frame, "time"))
        except ValueError as error:
            raise FileError(f"{file}: frame {i} is invalid: {error}") from error
        if not math.isfinite(found[-1]):
            raise FileError(f"{file}: frame {i} has the time {found[-1]}; give a finite number of seconds")
    return tuple(found)


def unposed_photos(path: Path) -> list[Path]:
    """The photographs of a folder without poses, sorted by name: those in `images`, or else in the folder itself.

    Empty if there are poses or no photographs.

    Raises:
        FileError: the folder cannot be read.
    """
    if not path.is_dir() or is_capture(path):
        return []
    for folder in (path / "images", path):
        try:
            listed = list(folder.iterdir()) if folder.is_dir() else []
        except OSError as error:
            raise FileError(f"cannot read {folder}: {error.strerror or error}") from error
        files = [p for p in listed if p.suffix.lower() in PHOTO_SUFFIXES and not p.name.startswith(".") and p.is_file()]
        if files:
            return sorted(files, key=lambda p: p.name)
    return []


def to_transforms(cameras: Sequence[Camera], lenses: Sequence[Lens], paths: Sequence[str]) -> dict[str, Any]:
    """A `transforms.json` for photographs at `paths`, relative to its folder; inverse of `read_capture`."""
    frames = []
    for camera, lens, path in zip(cameras, lenses, paths, strict=True):
        pose = np.linalg.inv(camera.world_to_camera) * [1, -1, -1, 1]  # OpenCV to OpenGL axes
        intrinsics = {"fl_x": camera.fx, "fl_y": camera.fy, "cx": camera.cx, "cy": camera.cy}
        size = {"w": camera.width, "h": camera.height}
        frames.append({"file_path": path, "transform_matrix": pose.tolist(), **intrinsics, **size, **asdict(lens)})
    return {"camera_model": "OPENCV", "frames": frames}


def _capture(file: Path, cameras: list[Camera], photos: list[Path], lenses: list[Lens]) -> Capture:
    paths = [os.path.abspath(photo) for photo in photos]
    if repeated := [path for path, count in Counter(paths).items() if count > 1]:
        raise FileError(f"{file}: two frames are of the photograph {repeated[0]}; remove one of them")
    return Capture(file, tuple(_unique_names(file, cameras, paths)), tuple(photos), tuple(lenses))


def _unique_names(file: Path, cameras: list[Camera], paths: list[str]) -> list[Camera]:
    """Prefix equal camera names with their folders: in a rig, each camera numbers its own photographs."""
    count = Counter(c.name for c in cameras)
    if max(count.values()) == 1:
        return cameras
    common = os.path.commonpath([os.path.dirname(path) for path in paths])
    longer = ["-".join(Path(path).relative_to(common).with_suffix("").parts) for path in paths]
    named = [replace(c, name=name) if count[c.name] > 1 else c for c, name in zip(cameras, longer, strict=True)]
    if repeated := [name for name, count in Counter(c.name for c in named).items() if count > 1]:
        raise FileError(f"{file}: two frames are called {repeated[0]}; photographs need different names")
    return named


def is_file(path: Path) -> bool:
    """Whether the path is a file; False for a name that the system cannot look up (too long)."""
    try:
        return path.is_file()
    except OSError:
        return False


def _photo(folder: Path, name: Any) -> Path:
    """The path of a photograph. Its suffix may be missing (instant-ngp, Blender), its slashes may be Windows'."""
    if not isinstance(name, str) or not name:
        raise ValueError(f"file_path must be a name, not {name!r:.40}")
    found = (folder / (path + suffix) for path in (name, name.replace("\\", "/")) for suffix in ("", *_SUFFIXES))
    return next(filter(is_file, found), folder / name)


def _number(data: Mapping[str, Any], key: str) -> float:
    """An entry that must be a number; KeyError if it is missing."""
    value = data[key]
    try:
        if isinstance(value, bool):
            raise TypeError
        return float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"{key} must be a number, not {value!r:.40}") from error


def _camera(data: Mapping[str, Any], photo: Path) -> Camera:
    """The camera of one frame; `data` holds the file's entries, overridden by those of the frame.

    Raises:
        KeyError, ValueError, ArithmeticError, UserError: an entry is missing, not a number or out of range, or the
            pose is not rigid.
    """
    world = from_opengl(_pose(data["transform_matrix"]))
    width, height = _size(data, photo)
    fx = _number(data, "fl_x") if "fl_x" in data else _focal(data, width)
    defaults = {"fl_y": fx, "cx": width / 2, "cy": height / 2}
    fy, cx, cy = (_number({**defaults, **data}, key) for key in defaults)
    return Camera(world, fx, fy, cx, cy, width, height, photo.stem)


def from_opengl(pose: NDArray[np.float64]) -> NDArray[np.float64]:
    """World to camera in OpenCV axes, of a pose camera to world in OpenGL axes; both `[4, 4]` and rigid."""
    world = np.eye(4)
    rotation = pose[:3, :3] * [1, -1, -1]
    world[:3, :3], world[:3, 3] = rotation.T, -rotation.T @ pose[:3, 3]
    return world


def _pose(matrix: Any) -> NDArray[np.float64]:
    """`[4, 4]`, camera to world, OpenGL axes; a rotation with rounding errors is orthogonalised."""
    try:
        pose: NDArray[np.float64] = np.array(matrix, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError("transform_matrix is not 4x4 finite numbers") from error
    if pose.shape == (3, 4):
        pose = np.vstack([pose, [0, 0, 0, 1]])
    if pose.shape != (4, 4) or not np.abs(pose).max() <= MAX_COORDINATE:
        raise ValueError("transform_matrix is not 4x4 finite numbers")
    if not np.allclose(pose[3], (0, 0, 0, 1), atol=1e-6):
        row = " ".join(f"{n:g}" for n in pose[3])
        raise ValueError(f"the last row of its transform_matrix is {row}, not 0 0 0 1; it may be transposed")
    u, stretch, v = np.linalg.svd(pose[:3, :3])
    if not stretch[2] > 0 or stretch[0] / stretch[2] > 1 + ROTATION_TOLERANCE:
        raise ValueError("the first three columns of its transform_matrix are not a rotation (skewed or degenerate)")
    if abs(stretch[0] - 1) > ROTATION_TOLERANCE:
        raise ValueError(f"its transform_matrix scales by {stretch[0]:.4g}; divide its first three columns by that")
    if np.linalg.det(pose[:3, :3]) < 0:
        raise ValueError("its transform_matrix mirrors; export right-handed axes (x right, y up, z back)")
    if np.abs(stretch - 1).max() > EXACT_TOLERANCE:
        pose[:3, :3] = u @ v
    return pose


def _size(data: Mapping[str, Any], photo: Path) -> tuple[int, int]:
    """Width and height of a photograph: from the file, or from the photograph if the file has none (Blender's)."""
    if "w" not in data and "h" not in data and is_file(photo):
        from PIL import Image

        try:
            with Image.open(photo) as file:
                return file.size
        except (OSError, ValueError, SyntaxError, EOFError, Image.DecompressionBombError) as error:
            raise ValueError(f"it has no w and h, and {photo} is not a photograph that has them") from error
    width, height = _number(data, "w"), _number(data, "h")
    if not 1 <= min(width, height) <= max(width, height) <= MAX_SIDE:
        raise ValueError(f"the size {width:g}x{height:g} must lie between 1 and {MAX_SIDE} pixels a side")
    return int(width), int(height)


def _focal(data: Mapping[str, Any], width: int) -> float:
    if "camera_angle_x" not in data:
        raise ValueError("it has neither fl_x nor camera_angle_x")
    angle = _number(data, "camera_angle_x")
    if not 0 < angle < math.pi:
        raise ValueError(f"camera_angle_x must lie between 0 and pi (radians), got {angle:g}")
    return 0.5 * width / math.tan(0.5 * angle)


def _lens(data: Mapping[str, Any]) -> Lens:
    """The lens of one frame.

    Raises:
        ValueError: its distortion is not finite or not of the polynomial model.
    """
    model = data.get("camera_model", "OPENCV")
    if model not in _MODELS or data.get("is_fisheye"):
        model = "of a fisheye" if data.get("is_fisheye") else repr(model)
        raise ValueError(f"camera_model {model} is not one of {', '.join(_MODELS)}; undistort the photographs first")
    values = {key: _number({key: 0.0, **data}, key) for key in ("k1", "k2", "k3", "k4", "p1", "p2")}
    if not all(map(math.isfinite, values.values())):
        raise ValueError("its lens distortion is not finite")
    if values.pop("k4"):
        raise ValueError("only fisheye and rational models have a k4; undistort the photographs first")
    return Lens(**values)

"""Reads COLMAP models: `cameras`, `images` and `points3D`, as `.bin` or `.txt` (https://colmap.github.io/format.html).

Poses in these files are world-to-camera with wxyz quaternions and OpenCV axes, as ours are. A record count in a binary
file is checked against the file's size before records are read.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from ... import rotations
from ...camera import Camera
from ...errors import FileError, UserError
from ...lens import Lens, check_lens

# Name and parameter names of each camera model, by its number.
_MODELS: dict[int, tuple[str, tuple[str, ...]]] = {
    0: ("SIMPLE_PINHOLE", ("f", "cx", "cy")),
    1: ("PINHOLE", ("fx", "fy", "cx", "cy")),
    2: ("SIMPLE_RADIAL", ("f", "cx", "cy", "k1")),
    3: ("RADIAL", ("f", "cx", "cy", "k1", "k2")),
    4: ("OPENCV", ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2")),
}
_BY_NAME = {name: parameters for name, parameters in _MODELS.values()}
_MAX_SIDE = 1 << 16  # pixels


@dataclass(frozen=True)
class View:
    """A photograph's file name, its camera and its lens."""

    name: str
    camera: Camera
    lens: Lens


@dataclass(frozen=True, eq=False)
class Points:
    """Sparse reconstructed points: `means [N, 3]` float64, world, and `colors [N, 3]` in [0, 1]."""

    means: NDArray[np.float64]
    colors: NDArray[np.float64]


def find(folder: Path) -> Path | None:
    """The folder of a capture's COLMAP model: `sparse/0`, `sparse` or the folder itself; None if there is none."""
    places = (folder / "sparse" / "0", folder / "sparse", folder)
    return next((p for p in places if any((p / f"cameras.{kind}").is_file() for kind in ("bin", "txt"))), None)


def read_views(folder: Path) -> list[View]:
    """The photographs of a reconstruction, sorted by name.

    Raises:
        FileError: a file is missing, cut short or inconsistent, or a camera model is not one of the five known ones.
    """
    path = _one_of(folder, "cameras")
    cameras = dict(_binary_cameras(path) if path.suffix == ".bin" else _text_cameras(path))
    if not cameras:
        raise FileError(f"{path} lists no cameras; it may be cut short")
    path = _one_of(folder, "images")
    found = []
    for name, number, quat, offset in _binary_images(path) if path.suffix == ".bin" else _text_images(path):
        if number not in cameras:
            raise FileError(f"{path}: {name} was taken by camera {number}, which is not listed")
        found.append(_view(path, name, cameras[number], quat, offset))
    if not found:
        raise FileError(f"{path} lists no photographs")
    return sorted(found, key=lambda view: view.name)


def read_points(folder: Path) -> Points:
    """The finite points of a reconstruction; there may be none.

    Raises:
        FileError: the file is missing, cut short or inconsistent.
    """
    path = _one_of(folder, "points3D")
    rows = list(_binary_points(path) if path.suffix == ".bin" else _text_points(path))
    table = np.array(rows, np.float64).reshape(-1, 6)
    table = table[np.isfinite(table).all(axis=1)]
    return Points(table[:, :3], np.clip(table[:, 3:] / 255, 0, 1))


def _one_of(folder: Path, name: str) -> Path:
    for kind in ("bin", "txt"):
        if (folder / f"{name}.{kind}").is_file():
            return folder / f"{name}.{kind}"
    raise FileError(f"{folder} has no {name}.bin or {name}.txt; give the folder with the whole COLMAP model")


def _view(path: Path, name: str, camera_data: tuple[int, int, Mapping[str, float]], quat: Any, offset: Any) -> View:
    width, height, values = camera_data
    try:
        if not np.linalg.norm(quat) > 0:
            raise ValueError("its rotation is a zero quaternion")
        pose = np.eye(4)
        unit = torch.nn.functional.normalize(torch.tensor([quat], dtype=torch.float64), dim=1)
        pose[:3, :3] = rotations.to_matrix(unit)[0].numpy()
        pose[:3, 3] = offset
        if not 0 < max(width, height) <= _MAX_SIDE:
            raise ValueError(f"the size {width}x{height} must lie between 1 and {_MAX_SIDE} pixels a side")
        fx, fy = values.get("fx", values.get("f", 0.0)), values.get("fy", values.get("f", 0.0))
        camera = Camera(pose, fx, fy, values["cx"], values["cy"], width, height, Path(name).stem)
        lens = Lens(*(float(values.get(key, 0.0)) for key in ("k1", "k2", "k3", "p1", "p2")))
        if not np.isfinite([lens.k1, lens.k2, lens.p1, lens.p2]).all():
            raise ValueError("its lens distortion is not finite")
        check_lens(camera, lens)
    except (UserError, ValueError) as error:
        raise FileError(f"{path}: {name} is invalid: {error}") from error
    return View(name, camera, lens)


def _unknown(path: Path, model: object) -> FileError:
    known = ", ".join(_BY_NAME)
    return FileError(f"{path}: camera model {model} is not known ({known}); run colmap image_undistorter first")


# -- binary ----------------------------------------------------------------------------------------------------------


class _Bytes:
    """Sequential reader of a binary file; reading beyond its end raises `FileError`."""

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            self.data = path.read_bytes()
        except OSError as error:
            raise FileError(f"cannot read {path}: {error.strerror or error}") from error
        self.at = 0

    def take(self, form: str) -> tuple[Any, ...]:
        size = struct.calcsize(form)
        self.need(size)
        fields = struct.unpack_from(form, self.data, self.at)
        self.at += size
        return fields

    def count(self, min_bytes: int) -> int:
        """The next record count, where a record takes at least `min_bytes`; checked against the bytes left."""
        (count,) = self.take("<Q")
        self.need(count * min_bytes)
        return int(count)

    def need(self, size: int) -> None:
        if size > len(self.data) - self.at:
            raise FileError(f"{self.path} is cut short: {size} more bytes should follow after byte {self.at}")

    def skip(self, size: int) -> None:
        self.need(size)
        self.at += size

    def text(self) -> str:
        end = self.data.find(b"\0", self.at)
        if end < 0:
            raise FileError(f"{self.path} is cut short in a name")
        name = self.data[self.at : end].decode("utf-8", errors="replace")
        self.at = end + 1
        return name


def _binary_cameras(path: Path) -> Iterator[tuple[int, tuple[int, int, Mapping[str, float]]]]:
    file = _Bytes(path)
    for _ in range(file.count(24)):
        number, model, width, height = file.take("<IiQQ")
        if model not in _MODELS:
            raise _unknown(path, model)
        names = _MODELS[model][1]
        yield number, (width, height, dict(zip(names, file.take(f"<{len(names)}d"), strict=True)))


def _binary_images(path: Path) -> Iterator[tuple[str, int, Any, Any]]:
    file = _Bytes(path)
    for _ in range(file.count(73)):
        _, *pose, camera = file.take("<I7dI")
        name = file.text()
        file.skip(24 * file.count(24))
        yield name, camera, pose[:4], pose[4:]


def _binary_points(path: Path) -> Iterator[tuple[float, ...]]:
    file = _Bytes(path)
    for _ in range(file.count(51)):
        _, x, y, z, red, green, blue, _ = file.take("<Q3d3Bd")
        file.skip(8 * file.count(8))
        yield x, y, z, red, green, blue


# -- text ------------------------------------------------------------------------------------------------------------


def _lines(path: Path) -> Iterator[list[str]]:
    """The words of each line that is not a comment; [] for an empty line (an image without points)."""
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror or error}") from error
    return (line.split() for line in text.splitlines() if not line.startswith("#"))


def _numbers(path: Path, words: list[str]) -> list[float]:
    try:
        return [float(word) for word in words]
    except ValueError as error:
        raise FileError(f"{path}: {error}") from error


def _text_cameras(path: Path) -> Iterator[tuple[int, tuple[int, int, Mapping[str, float]]]]:
    for words in filter(None, _lines(path)):
        if len(words) < 4 or words[1] not in _BY_NAME:
            raise _unknown(path, words[1] if len(words) > 1 else "")
        names = _BY_NAME[words[1]]
        number, width, height, *values = _numbers(path, [words[0], *words[2:]])
        if len(values) != len(names):
            raise FileError(f"{path}: camera {words[0]} has {len(values)} parameters, {words[1]} has {len(names)}")
        if not np.isfinite([number, width, height]).all():
            raise FileError(f"{path}: the number or size of camera {words[0]} ({words[2]}x{words[3]}) is not finite")
        yield int(number), (int(width), int(height), dict(zip(names, values, strict=True)))


def _text_images(path: Path) -> Iterator[tuple[str, int, Any, Any]]:
    lines = _lines(path)
    for words in lines:
        if not words:
            continue
        if len(words) < 10:
            raise FileError(f"{path}: a photograph has {len(words)} entries, 10 are needed")
        numbers = _numbers(path, words[1:9])
        if not np.isfinite(numbers).all():
            raise FileError(f"{path}: the pose of {words[9]} is not finite")
        yield " ".join(words[9:]), int(numbers[7]), numbers[:4], numbers[4:7]
        if not _is_point_list(next(lines, [])):
            raise FileError(f"{path}: the line after {words[9]} is not a list of points; every photograph takes two "
                            "lines, the second of which may be empty")  # fmt: skip


def _is_point_list(words: list[str]) -> bool:
    """Whether a line repeats pixel x, pixel y and point number, as the second line of a photograph does."""
    try:
        return len(words) % 3 == 0 and all(int(number) >= -1 for number in words[2:12:3])
    except ValueError:
        return False


def _text_points(path: Path) -> Iterator[tuple[float, ...]]:
    for words in filter(None, _lines(path)):
        if len(words) < 7:
            raise FileError(f"{path}: a point has {len(words)} entries, 7 are needed")
        yield tuple(_numbers(path, words[1:7]))

"""Save and load a motion beside its scene: one safetensors file with a table as JSON in its header, no pickle.

`room.ply.motion.safetensors` is bound to the content of `room.ply`: its header holds `fingerprint(scene file)`, and a
motion whose scene file has changed is not loaded. Ids in it are row numbers of the file. A static scene has no such
file.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
import torch
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from torch import Tensor

from ..errors import FileError, UserError
from ..motion.motion import Kind, Look, Motion, Residual, Track, renumbered
from ..scene import Scene
from .atomic import writing
from .fingerprint import fingerprint
from .formats.streamed_sog import scene_folder

SUFFIX = ".motion.safetensors"
VERSION: Final = 1
_ENTRY = "scenewright.motion"
_MOST = 1 << 16  # tracks, looks or residuals of a file
_MOST_HEADER = 1 << 26  # bytes


class _Data(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class _Track(_Data):
    kind: Kind
    smooth: bool
    name: str = Field(max_length=1000)


class _Look(_Data):
    start: float | None  # None: from the beginning, or for ever; JSON has no infinite numbers
    stop: float | None


class _Table(_Data):
    version: Literal[1]
    scene: str = Field(max_length=64)
    start: float
    stop: float
    tracks: tuple[_Track, ...] = Field(max_length=_MOST)
    looks: tuple[_Look, ...] = Field(max_length=_MOST)
    residuals: int = Field(ge=0, le=_MOST)


def motion_path(scene_path: Path) -> Path:
    """Path of the motion beside a scene file or folder."""
    scene_path = scene_folder(scene_path)
    return scene_path.with_name(scene_path.name + SUFFIX)


def save_motion(scene: Scene, scene_path: Path) -> Path | None:
    """Write the motion of a scene whose cloud equals that of the file `scene_path` row for row; returns its path.

    Ids that are not in the cloud are left out. A motion of an earlier version of the file is replaced, and removed if
    nothing changes with time (None).

    Raises:
        FileError: it cannot be written.
    """
    target = motion_path(scene_path)
    names = scene.cloud.ids.cpu().numpy()
    motion = renumbered(scene.motion, names, np.arange(len(names), dtype=np.int64))
    if motion is None:
        try:
            target.unlink(missing_ok=True)
        except OSError as error:
            raise FileError(f"cannot remove {target}: {error.strerror or error}") from error
        return None
    from safetensors.torch import save

    table = _Table(
        version=VERSION,
        scene=fingerprint(scene_path),
        start=motion.start,
        stop=motion.stop,
        tracks=tuple(_Track(kind=t.kind, smooth=t.smooth, name=t.name[:1000]) for t in motion.tracks),
        looks=tuple(_Look(start=_finite(look.start), stop=_finite(look.stop)) for look in motion.looks),
        residuals=len(motion.residuals),
    )
    with writing(target, force=True) as stream:
        stream.write(save(_tensors(motion), {_ENTRY: table.model_dump_json()}))
    return target


def _finite(seconds: float) -> float | None:
    return seconds if math.isfinite(seconds) else None


def _tensors(motion: Motion) -> dict[str, Tensor]:
    """The arrays of a motion by name; `_motion` is the inverse. Rotations that follow from an axis are left out."""
    arrays: dict[str, Any] = {}
    for i, track in enumerate(motion.tracks):
        on_axis = track.axis is not None
        arrays |= {f"track.{i}.{name}": getattr(track, name) for name in ("runs", "times", "pivot")}
        arrays |= {f"track.{i}.{name}": getattr(track, name) for name in _poses(on_axis)}
        arrays[f"track.{i}.frame"] = track.frame
    for i, look in enumerate(motion.looks):
        arrays |= {f"look.{i}.{name}": getattr(look, name) for name in ("ids", "sh", "opacities")}
    for i, residual in enumerate(motion.residuals):
        arrays |= {f"residual.{i}.{name}": getattr(residual, name) for name in ("ids", "times", "basis", "weights")}
    # Copies: tracks that were one share their keys, and safetensors refuses memory that is shared.
    return {
        name: value.cpu().clone().contiguous() if isinstance(value, Tensor) else torch.from_numpy(np.array(value))
        for name, value in arrays.items()
        if value is not None
    }


def _poses(on_axis: bool) -> tuple[str, str]:
    return ("axis", "angles") if on_axis else ("quats", "offsets")


def load_motion(scene: Scene, scene_path: Path) -> tuple[Scene, tuple[str, ...]]:
    """`scene`, just loaded from `scene_path`, with its saved motion, and notes: why a motion beside it is left out.

    Raises:
        FileError: the motion of this very scene file is damaged.
    """
    source = motion_path(scene_path)
    if not source.is_file():
        return scene, ()
    from safetensors import SafetensorError, safe_open

    try:
        with safe_open(source, framework="pt") as stream:
            text = (stream.metadata() or {}).get(_ENTRY, "")
            if len(text) > _MOST_HEADER:
                raise ValueError("its table is too large")
            data = json.loads(text)
            if not isinstance(data, dict):
                raise ValueError("it has no table")
            if data.get("version") != VERSION:
                return scene, (f"its motion was written by another version of scenewright: {source.name} is left out",)
            if data.get("scene") != fingerprint(scene_path):
                return scene, (f"its motion is of another version of this file: {source.name} is left out",)
            table = _Table.model_validate_json(text)
            tensors = {name: stream.get_tensor(name) for name in stream.keys()}  # noqa: SIM118
        motion = _motion(table, tensors, len(scene.cloud))
    except (SafetensorError, OSError, ValidationError, ValueError, TypeError, KeyError, RecursionError) as error:
        raise _damaged(source, error) from error
    except UserError as error:
        raise _damaged(source, error) from error
    return scene.replace(motion=motion or None), ()


def _damaged(source: Path, error: Exception) -> FileError:
    said = str(error).splitlines()[0] if str(error) else type(error).__name__
    return FileError(f"{source} is damaged ({said}); delete it to load the scene without its motion")


def _motion(table: _Table, tensors: dict[str, Tensor], count: int) -> Motion:
    """The motion of a scene of `count` rows.

    Raises:
        KeyError, ValueError, UserError: the arrays do not fit the table, or name rows that the scene does not have.
    """
    tracks, looks, residuals = [], [], []
    for i, track in enumerate(table.tracks):
        runs = _whole(tensors, f"track.{i}.runs", 2)
        if len(runs) and int(runs.max()) > count:
            raise ValueError(f"it moves Gaussians that the scene of {count:,} does not have")
        made: dict[str, Any] = {name: _numbers(tensors, f"track.{i}.{name}") for name in ("times", "pivot")}
        on_axis = track.kind != "rigid"
        made |= {name: _numbers(tensors, f"track.{i}.{name}") for name in _poses(on_axis)}
        made |= {"quats": np.zeros(0), "offsets": np.zeros(0)} if on_axis else {}
        made["frame"] = _numbers(tensors, f"track.{i}.frame") if f"track.{i}.frame" in tensors else None
        tracks.append(Track(runs, kind=track.kind, smooth=track.smooth, name=track.name, **made))
    for i, look in enumerate(table.looks):
        start, stop = (-math.inf if look.start is None else look.start), (math.inf if look.stop is None else look.stop)
        shown = [_shown(tensors.get(f"look.{i}.{name}")) for name in ("sh", "opacities")]
        looks.append(Look(_rows(tensors, f"look.{i}.ids", count), start, stop, *shown))
    for i in range(table.residuals):
        arrays = [_numbers(tensors, f"residual.{i}.{name}") for name in ("times", "basis", "weights")]
        residuals.append(Residual(_rows(tensors, f"residual.{i}.ids", count), *arrays))
    return Motion(tuple(tracks), tuple(looks), tuple(residuals), table.start, table.stop)


def _whole(tensors: dict[str, Tensor], name: str, dimensions: int) -> Any:
    found = tensors[name]
    if found.dtype != torch.int64 or found.ndim != dimensions:
        raise ValueError(f"{name} is no table of rows")
    return found.numpy()


def _rows(tensors: dict[str, Tensor], name: str, count: int) -> Any:
    rows = _whole(tensors, name, 1)
    if len(rows) and not 0 <= int(rows.min()) <= int(rows.max()) < count:
        raise ValueError(f"it names Gaussians that the scene of {count:,} does not have")
    return rows


def _numbers(tensors: dict[str, Tensor], name: str) -> Any:
    found = tensors[name]
    if found.dtype not in (torch.float32, torch.float64):
        raise ValueError(f"{name} holds no numbers")
    return found.numpy()


def _shown(values: Tensor | None) -> Tensor | None:
    if values is not None and values.dtype != torch.float32:
        raise ValueError("a look holds no numbers")
    return values

"""Stores the frame and cameras of a scene in header comments of a .ply and reads them back.

One line each, `scenewright <what> <JSON>`; other programs ignore them.

    scenewright frame {"up": [0, 0, 1], "floor": 0, "metres_per_unit": 1, "up_source": "file", "scale_source": "file"}
    scenewright camera {"name": "door", "size": [640, 480], "focal": [500, 500], "center": [320, 240],
                        "world_to_camera": [16 numbers, row by row]}   (on one line)

A frame whose source is "given" (by the user) is stored with the source "file".
"""

from __future__ import annotations

import json
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from ...camera import Camera
from ...errors import UserError
from ...scene import Frame, Scene

_PREFIX = "scenewright"
Finite = Annotated[float, Field(allow_inf_nan=False)]
Pair = tuple[Finite, Finite]
Source = Literal["given", "file", "estimated", "unknown"]


class _Stored(BaseModel):
    model_config = ConfigDict(frozen=True, extra="ignore")  # later versions may add fields


class _Frame(_Stored):
    """The stored form of `Frame`."""

    up: tuple[Finite, Finite, Finite]
    floor: Finite | None = None
    metres_per_unit: Finite | None = None
    up_source: Source = "file"
    scale_source: Source = "file"


class _Camera(_Stored):
    """The stored form of `Camera`. Sides above 2^20 pixels are refused: they would exhaust a renderer's memory."""

    name: Annotated[str, Field(max_length=500)] = ""
    size: tuple[Annotated[int, Field(ge=1, le=1 << 20)], Annotated[int, Field(ge=1, le=1 << 20)]]
    focal: Pair
    center: Pair
    world_to_camera: Annotated[tuple[Finite, ...], Field(min_length=16, max_length=16)]


def describe(scene: Scene) -> tuple[str, ...]:
    """The comment lines of a scene: one for its frame unless it is unknown, one per camera."""
    frame = _describe_frame(scene.frame)
    return (*([frame] if scene.frame != Frame() else []), *(_describe_camera(camera) for camera in scene.cameras))


def _describe_frame(frame: Frame) -> str:
    stored = {
        "up": [float(c) for c in frame.up],
        "floor": None if frame.floor is None else float(frame.floor),
        "metres_per_unit": None if frame.metres_per_unit is None else float(frame.metres_per_unit),
        "up_source": "file" if frame.up_source == "given" else frame.up_source,
        "scale_source": "file" if frame.scale_source == "given" else frame.scale_source,
    }
    return _line("frame", stored)


def _describe_camera(camera: Camera) -> str:
    stored = {
        "name": camera.name[:500],
        "size": [int(camera.width), int(camera.height)],
        "focal": [float(camera.fx), float(camera.fy)],
        "center": [float(camera.cx), float(camera.cy)],
        "world_to_camera": camera.world_to_camera.ravel().tolist(),
    }
    return _line("camera", stored)


def parse(comments: tuple[str, ...]) -> tuple[Frame, tuple[Camera, ...], tuple[str, ...]]:
    """Frame, cameras, and a note for each unusable comment of ours; comments of other programs are ignored."""
    frame, cameras, notes = Frame(), [], []
    for comment in comments:
        prefix, _, rest = comment.partition(" ")
        what, _, text = rest.partition(" ")
        if prefix != _PREFIX:
            continue
        try:
            if what == "frame":
                frame = Frame(**_Frame.model_validate_json(text).model_dump())
            elif what == "camera":
                cameras.append(_camera(_Camera.model_validate_json(text)))
        except (ValidationError, UserError) as error:
            reason = str(error).splitlines()[0]
            notes.append(f"the {what} in the file's header was ignored: {reason}")
    return frame, tuple(cameras), tuple(notes)


def _camera(stored: _Camera) -> Camera:
    pose = np.array(stored.world_to_camera).reshape(4, 4)
    return Camera(pose, *stored.focal, *stored.center, *stored.size, stored.name)


def _line(what: str, stored: dict[str, Any]) -> str:
    """A comment line: JSON escapes names to ASCII without line breaks, and writes numbers that read back exactly."""
    return f"{_PREFIX} {what} {json.dumps(stored)}"

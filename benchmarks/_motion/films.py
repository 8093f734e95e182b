"""Films of the moving rooms, and what is true in them: masks of what moves, and its path.

`write` makes a capture of a film: `transforms.json` with `time` (seconds) at every frame, as D-NeRF and nerfstudio
write it, and the pictures; `transforms_test.json` with the held-out frames, and `truth/` with masks and paths.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.assets.furnishing.furnish import furnish
from ...gaussians.camera import Camera, Vec3
from ...gaussians.files.captures.capture import TRANSFORMS, to_transforms
from ...gaussians.lens import Lens
from ...gaussians.motion import keys
from ...gaussians.motion.at import at
from ...gaussians.motion.motion import Motion, Track, poses
from ...gaussians.render import render
from ...gaussians.scene import Scene
from . import soft
from .rooms import moving_room

F64 = NDArray[np.float64]
Rig = Literal["12", "4", "1"]  # cameras: twelve or four that stand, one that moves

SIZE = (160, 120)
FPS = {"books": 20.0, "door": 5.0, "drawer": 5.0}  # others: 10
ENDS = {"books": 3.0}  # seconds; nothing happens after it. Others are filmed to the end of the room
FOV = 62.0  # degrees, vertical


@dataclass(frozen=True)
class Stage:
    """Where cameras stand in a room.

    Attributes:
        aim: what they look at.
        heights: between which they stand, metres.
        width, depth: of the room, metres.
        outside: how far in front of the middle of the room cameras at the south may stand, of its depth; the south side
            of most rooms is open.
    """

    aim: Vec3
    heights: tuple[float, float]
    width: float
    depth: float
    outside: float = 0.75


STAGES = {
    "ball": Stage((0.2, -0.6, 0.2), (1.0, 2.1), 5.0, 4.0),
    "door": Stage((0.2, 0.6, 0.9), (1.0, 2.1), 4.0, 3.0),
    "drawer": Stage((0.5, 0.8, 0.6), (1.2, 2.2), 4.0, 4.0),
    "fan": Stage((0.0, 0.2, 1.7), (0.9, 1.9), 4.0, 4.0),
    "books": Stage((0.0, 0.9, 0.8), (0.8, 2.1), 4.0, 3.6),
    "toy": Stage((-0.3, -0.1, 0.2), (0.8, 2.0), 4.0, 3.4),
    "towel": Stage((0.0, 0.2, 1.1), (1.0, 2.1), 4.0, 3.4),
    "plant": Stage((0.0, 0.2, 0.8), (1.0, 2.1), 4.0, 3.4),
    "jelly": Stage((0.0, -0.2, 0.4), (0.9, 2.0), 4.0, 3.4),
}
_TESTS = (-1.95, -1.25)  # radians: where the two held-out cameras stand, seen from the middle; -pi/2 is the south


@dataclass(frozen=True, eq=False)
class Frame:
    """A picture of a film.

    Attributes:
        camera, time: of the picture; seconds.
        photo: `[H, W, 3]` uint8.
        mask: `[H, W]` bool, where something that moves is seen (whether or not it moves just then).
    """

    camera: Camera
    time: float
    photo: NDArray[np.uint8]
    mask: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Film:
    """A room on film.

    Attributes:
        scene: the truth.
        frames: to fit.
        held_out: from two other cameras, at times of `frames` and in the middle between two of them.
    """

    scene: Scene
    frames: tuple[Frame, ...]
    held_out: tuple[Frame, ...]

    @property
    def times(self) -> F64:
        """Times of the frames, ascending."""
        return np.unique([frame.time for frame in self.frames])


def film(name: str, rig: Rig, size: tuple[int, int] = SIZE, fps: float | None = None, detail: float = 1.0) -> Film:
    """A film of a moving room, or of a soft one; the same arguments give the same bytes.

    Args:
        size: width and height of the pictures.
        fps: pictures a second of each camera; None: those of `FPS`.
        detail: of the room.
    """
    scene = soft.soft_room(name, detail) if name in soft.names() else moving_room(name, detail)
    assert scene.motion is not None
    return _filmed(scene, STAGES[name], rig, size, fps or FPS.get(name, 10.0), ENDS.get(name, scene.motion.stop))


def unseen(seed: int, rig: Rig, size: tuple[int, int] = SIZE, fps: float = 10.0, detail: float = 1.0) -> Film:
    """A film of a room furnished from a seed, of which two things move: no setting was chosen by it.

    One thing is carried away and turned meanwhile, another swings about its edge and halfway back.
    """
    scene, stage = carried(seed, detail)
    assert scene.motion is not None
    return _filmed(scene, stage, rig, size, fps, scene.motion.stop)


def carried(seed: int, detail: float = 1.0) -> tuple[Scene, Stage]:
    """The room of `unseen`, and where its cameras stand."""
    room = furnish(seed, detail=detail)
    rng, objects = np.random.default_rng([seed, 7]), room.truth.objects
    bearers = {o.support for o in objects}
    free = [o for o in objects if o.id not in bearers and o.support not in ("wall", "ceiling")]
    free = [o for o in free if min(o.size) > 0.12 and max(o.size) < 1.2]
    free.sort(key=lambda o: (math.hypot(o.position[0], o.position[1]), o.id))
    tracks = []
    for which, thing in enumerate(free[:2]):
        ids = room.scene.cloud.ids[room.truth.ids == thing.id].numpy()
        middle = np.array(thing.position)
        if which:
            edge = middle + np.array([thing.size[0] / 2, 0.0, 0.0])
            turn = np.radians([0, 40, 75, 75, 30]) * rng.choice([-1, 1])
            tracks.append(Track.hinge(ids, [0.8, 1.3, 2.0, 2.6, 3.4], turn, (0, 0, 1), edge, name=thing.kind))
            continue
        away = -math.copysign(rng.uniform(0.5, 0.9), middle[0]), -math.copysign(rng.uniform(0.3, 0.6), middle[1])
        path = np.array([[0, 0, 0], [0, 0, 0.3], [*away, 0.5], [*away, rng.uniform(0.1, 0.3)]])
        quats = keys.about(np.array([0.0, 0.0, 1.0]), np.array([0, 0.2, 1.2, 1.5]) * rng.uniform(0.6, 1.2))
        tracks.append(Track.rigid(ids, [0.4, 1.0, 2.4, 3.2], quats, path, middle, name=thing.kind))
    scene = room.scene.replace(motion=Motion(tuple(tracks), (), (), 0.0, 4.0))
    aim = np.mean([o.position for o in free[:2]], axis=0)
    stage = Stage((float(aim[0]), float(aim[1]), float(aim[2])), (1.1, 2.1), room.size[0], room.size[1], 0.47)
    return scene, stage


def _filmed(scene: Scene, stage: Stage, rig: Rig, size: tuple[int, int], rate: float, stop: float) -> Film:
    """The film of a room until a time."""
    assert scene.motion is not None
    times = np.round(np.arange(0.0, stop + 0.5 / rate, 1 / rate), 6)
    between = times[:-1] + 0.5 / rate
    some = slice(None, None, max(1, len(times) // 12))
    clouds = Clouds(scene)
    frames = [clouds.frame(_moving(stage, t / stop, size), t) for t in times] if rig == "1" else [
        clouds.frame(camera, t) for t in times for camera in standing(stage, int(rig), size)
    ]  # fmt: skip
    tests = [(camera, t) for camera in _tests(stage, size) for t in (*times[some], *between[some])]
    return Film(scene, tuple(frames), tuple(clouds.frame(camera, t) for camera, t in tests))


class Clouds:
    """The room at times, drawn with masks of what moves."""

    def __init__(self, scene: Scene) -> None:
        assert scene.motion is not None
        moving = torch.zeros(len(scene.cloud), dtype=torch.int32)
        for ids in moving_things(scene.motion):
            moving[torch.isin(scene.cloud.ids, torch.from_numpy(ids))] = 1
        self._scene = scene.replace(cloud=scene.cloud.replace(group=moving), language=None)
        self._at: tuple[float, Scene] | None = None

    def frame(self, camera: Camera, time: float) -> Frame:
        """The picture of a camera at a time."""
        if self._at is None or self._at[0] != time:
            self._at = (time, at(self._scene, time))
        picture = render(self._at[1].cloud, camera)
        return Frame(camera, float(time), picture.to_uint8(), picture.group.numpy() == 1)


def standing(stage: Stage, count: int, size: tuple[int, int]) -> tuple[Camera, ...]:
    """Cameras that stand around a room; of few, all look in from the south."""
    spread = math.radians(250 if count > 6 else 110)
    angles = [-math.pi / 2 + spread * ((k + 0.5) / count - 0.5) for k in range(count)]
    return tuple(_camera(stage, angle, 0.2 + 0.6 * (k % 2), size, f"cam{k:02d}") for k, angle in enumerate(angles))


def _moving(stage: Stage, share: float, size: tuple[int, int]) -> Camera:
    """A camera that is carried along an arc at the south of a room, there and halfway back."""
    angle = -math.pi / 2 + math.radians(50) * math.sin(1.5 * math.pi * share - 0.25 * math.pi)
    return _camera(stage, angle, 0.5 + 0.3 * math.sin(5 * share), size, "cam")


def _tests(stage: Stage, size: tuple[int, int]) -> tuple[Camera, ...]:
    return tuple(_camera(stage, angle, 0.5, size, f"test{k}") for k, angle in enumerate(_TESTS))


def _camera(stage: Stage, angle: float, level: float, size: tuple[int, int], called: str) -> Camera:
    """A camera in a direction from what is aimed at: within the walls, or some steps outside the open south side."""
    (x, y, z), (low, high) = stage.aim, stage.heights
    width, depth = stage.width, stage.depth
    c, s = math.cos(angle), math.sin(angle)
    reach = 0.47 * width / max(abs(c), 1e-6), ((0.47 if s > 0 else stage.outside) * depth) / max(abs(s), 1e-6)
    away = min(reach)
    inside = s > -0.6  # beside the walls, where furniture stands: from above it
    eye = (0.3 * x + away * c, 0.3 * y + away * s, high if inside else low + level * (high - low))
    eye = (float(np.clip(eye[0], -0.47 * width, 0.47 * width)), min(eye[1], 0.47 * depth), eye[2])
    return Camera.look_at(eye, (x, y, z), (0, 0, 1), *size, FOV, called)


def moving_things(motion: Motion) -> tuple[NDArray[np.int64], ...]:
    """Ids of each thing that moves: on a track, or with displacements alone."""
    tracks = tuple(track.ids for track in motion.tracks)
    free = (np.setdiff1d(residual.ids, np.concatenate([*tracks, []])) for residual in motion.residuals)
    return (*tracks, *(ids for ids in free if len(ids)))


def middles(scene: Scene, times: Sequence[float] | F64) -> F64:
    """`[tracks, T, 3]` where the middle of each thing on a track is."""
    assert scene.motion is not None
    found = []
    for track in scene.motion.tracks:
        rows = torch.isin(scene.cloud.ids, torch.from_numpy(track.ids))
        middle = scene.cloud.means[rows].double().mean(dim=0).numpy()
        turns, shifts = poses(track, np.asarray(times))
        found.append(turns @ middle + shifts)
    return np.array(found)


def write(made: Film, folder: Path) -> None:
    """Write a film as a capture with its truth."""
    from PIL import Image

    for name, frames in ((TRANSFORMS, made.frames), ("transforms_test.json", made.held_out)):
        data = to_transforms([f.camera for f in frames], [Lens()] * len(frames), [_path(f) for f in frames])
        for entry, frame in zip(data["frames"], frames, strict=True):
            entry["time"] = frame.time
            for sub, picture in (("", frame.photo), ("truth", (frame.mask * 255).astype(np.uint8))):
                path = folder / sub / _path(frame)
                path.parent.mkdir(parents=True, exist_ok=True)
                Image.fromarray(picture).save(path)
        (folder / name).write_text(json.dumps(data))
    assert made.scene.motion is not None
    told = {"times": made.times.tolist(), "paths": middles(made.scene, made.times).tolist()}
    (folder / "truth" / "paths.json").write_text(json.dumps(told))


def _path(frame: Frame) -> str:
    return f"images/{frame.camera.name}_{round(1000 * frame.time):06d}.png"

"""The real scenes that instructions are carried out on: embedded as `scenewright embed` does, with the views that the
instructions were written from."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ....gaussians.camera import Camera, Vec3
from ....gaussians.files import load, save
from ....gaussians.files.captures.capture import read_capture
from ....gaussians.language import encoders, masks
from ....gaussians.language.field.embed import embed
from ....gaussians.language.field.store import load_field, save_field
from ....gaussians.scene import Scene
from ....gaussians.user_cache import user_cache
from ..._data import folder
from ..._select.real.fitted import scene_of

WIDTH = 480  # pixels of a view
_UP: Vec3 = (0.0, -1.0, 0.0)  # of the two scenes without photographs
_FOV = 45.0


@dataclass(frozen=True)
class Setting:
    """One way to embed a scene.

    Attributes:
        name: as in the table.
        scene: as in the instructions.
        file: in the folder of scenes; "" for a capture that is fitted first.
        capture: the name of its photographs; "" if it has none.
        detector: whether the masks of the capture's detector are given too.
        eyes, target: where views are taken from where there are no photographs; the first is the viewer's.
    """

    name: str
    scene: str
    file: str = ""
    capture: str = ""
    detector: bool = False
    eyes: tuple[Vec3, ...] = ()
    target: Vec3 = (0.0, 0.0, 0.0)


SETTINGS = (
    Setting("bonsai_room", "bonsai_room", "bonsai_room.ply", "bonsai_room"),
    Setting("bonsai_room with masks", "bonsai_room", "bonsai_room.ply", "bonsai_room", detector=True),
    Setting("guitar", "guitar", "guitar.compressed.ply",
            eyes=((5.9, -3.4, 0.2), (-5.7, -3.4, 0.2), (0.1, -3.4, 6.0)), target=(0.1, -2.1, 0.2)),
    Setting("playbot", "playbot", "playbot/2_0",
            eyes=((0.0, -1.5, -3.2), (2.7, -1.5, -1.4), (-2.7, -1.5, 1.4)), target=(0.0, -0.5, 0.0)),
    Setting("diorama_table", "diorama_table", capture="diorama_table"),
    Setting("desk_laptop", "desk_laptop", capture="desk_laptop"),
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Place:
    """An embedded scene and its views; the first is the viewer's."""

    setting: Setting
    scene: Scene
    views: tuple[Camera, ...]


def prepared(
    setting: Setting, keep: Path | None = None, progress: Callable[[str, float], None] = lambda stage, share: None
) -> Place | None:
    """The embedded scene of a setting; None if its data are not here.

    Args:
        keep: a folder of embedded scenes, which are read if they are there and written if not; None embeds anew.
    """
    path = None if keep is None else keep / f"{setting.name.replace(' ', '_')}.ply"
    captures = folder("captures")
    capture = None if captures is None or not setting.capture else captures / setting.capture
    if setting.capture and (capture is None or not capture.is_dir()):
        return None
    source = _source(setting, capture)
    if source is None:
        return None
    scene = source
    if path is not None and path.is_file():
        kept = load_field(load(path).replace(cameras=source.cameras), path)
        scene = source if kept is None else kept
    if scene.language is None:
        if path is not None:
            path.parent.mkdir(parents=True, exist_ok=True)
            save(source, path, force=True)
            scene = load(path).replace(cameras=source.cameras)
        scene = _embedded(scene, setting, capture, progress)
        if path is not None:
            save_field(scene, path)
    return Place(setting, scene, _views(setting, source))


def _source(setting: Setting, capture: Path | None) -> Scene | None:
    """The scene with the cameras of its photographs, not embedded."""
    scenes = folder("scenes")
    if setting.file:
        path = None if scenes is None else scenes / setting.file
        if path is None or not path.exists():
            return None
        scene = load(path)
    else:
        assert capture is not None
        scene = scene_of(capture)
    return scene if capture is None else scene.replace(cameras=read_capture(capture).cameras)


def _embedded(scene: Scene, setting: Setting, capture: Path | None, progress: Callable[[str, float], None]) -> Scene:
    """What `scenewright embed --capture` makes of it, with the detector's masks if the setting says so."""
    given = f"folder:{capture / 'masks'}" if setting.detector and capture is not None else None
    sources = masks.load_all(given, capture)[0]
    taken = None if capture is None else read_capture(capture)
    return embed(scene, encoders.load("auto"), progress=progress, masks=sources, capture=taken)


def _views(setting: Setting, scene: Scene) -> tuple[Camera, ...]:
    """Four photographs from first to last, or views from the eyes of the setting."""
    if setting.eyes:
        height = WIDTH * 3 // 4
        return tuple(Camera.look_at(eye, setting.target, _UP, WIDTH, height, _FOV) for eye in setting.eyes)
    chosen = [scene.cameras[int(i)] for i in np.linspace(0, len(scene.cameras) - 1, 4)]
    return tuple(c.resized(WIDTH, round(WIDTH * c.height / c.width)) for c in chosen)


def results_folder() -> Path:
    """Where pictures go: `SCENEWRIGHT_BENCH_EDITS`, or a folder of the user's cache."""
    given = os.environ.get("SCENEWRIGHT_BENCH_EDITS")
    return Path(given) if given else user_cache("bench", "edits")

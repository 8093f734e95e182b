"""Levels of detail: what each level takes and keeps, against leaving out the least visible, and drawing with levels."""

from __future__ import annotations

import statistics
import tempfile
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ...gaussians.assets.furnishing.furnish import furnish
from ...gaussians.camera import Camera
from ...gaussians.cloud import GaussianCloud
from ...gaussians.files import load
from ...gaussians.files.captures.capture import read_capture
from ...gaussians.files.formats import streamed_sog_writing
from ...gaussians.files.formats.streamed_sog import Streamed
from ...gaussians.levels.choosing import choose
from ...gaussians.levels.making import described, make
from ...gaussians.reduce import prune, psnr
from ...gaussians.render import render
from ...gaussians.scene import Scene
from ...gaussians.slim.views import choose_views, estimated_frame
from ...gaussians.viewpoints.coverage import candidates, fit_camera
from .._data import folder, missing

LEVELS = 4
HELD_OUT = 8  # views of each kind
PICTURE = (960, 640)  # pixels of a picture drawn with levels, as `render` makes them
FAR = 2.5  # times the distance from which a view around the scene shows all of it
REPEATS = 3


def measure(quick: bool) -> tuple[list[dict[str, Any]], list[str]]:
    """A row for each level (`scene`, `level`, `gaussians`, `bytes`, `draw` in ms, `psnr` in dB, and `dropped`, the PSNR
    with as many Gaussians after leaving out the least visible), and for near and far views drawn with levels (`scene`,
    `view`, `share` of the Gaussians, `draw`, `draw_finest`, `psnr`, `psnr_least`); and notes."""
    made = furnish(3, detail=0.3 if quick else 1.0).scene
    scenes: dict[str, tuple[Scene, Sequence[Camera]]] = {"room": (made, ())}
    notes: list[str] = []
    real, captures = folder("scenes"), folder("captures")
    if not quick and (real is None or captures is None):
        notes.append(missing("scenes" if real is None else "captures"))
    elif not quick and real is not None and captures is not None:
        bonsai = load(real / "bonsai_room.ply"), read_capture(captures / "bonsai_room").cameras
        scenes = {"bonsai": bonsai, "playbot": (load(real / "playbot" / "2_0"), ())}
    rows = []
    for name, (scene, cameras) in scenes.items():
        with tempfile.TemporaryDirectory() as place:
            rows += [{"scene": name} | row for row in _rows(scene, cameras, Path(place) / "a.lod")]
    return rows, notes


def _rows(scene: Scene, cameras: Sequence[Camera], path: Path) -> list[dict[str, Any]]:
    views = choose_views(scene, cameras)
    held_out = [view.camera for view in views.held_out[:: -(-len(views.held_out) // HELD_OUT)]]
    ranking = [view.camera for view in views.ranking]
    streamed_sog_writing.save(make(scene, LEVELS, views.ranking), path)
    streamed, rows = Streamed.open(path), list[dict[str, Any]]()
    for level, told in enumerate(described(streamed)):
        cloud = streamed.level(level)[0]
        fewer = prune(scene, len(cloud), ranking).cloud
        row = {"level": level, "gaussians": told.gaussians, "bytes": told.bytes, "draw": _milliseconds(cloud, held_out)}
        row["psnr"], row["dropped"] = (statistics.fmean(psnr(scene.cloud, c, held_out)) for c in (cloud, fewer))
        rows.append(row)
    around = [c for c in candidates(scene.cloud, estimated_frame(scene, cameras), 512) if c.name.startswith("around")]
    far = [_away(scene.cloud, camera) for camera in around[:: -(-len(around) // HELD_OUT)]]
    for name, found in (("near", held_out), ("far", far)):
        rows.append({"view": name} | _drawn(streamed, [fit_camera(camera, *PICTURE) for camera in found]))
    return rows


def _drawn(streamed: Streamed, cameras: Sequence[Camera]) -> dict[str, float]:
    """Pictures with levels as `render --lod` chooses them, against the finest level."""
    finest = streamed.level(0)[0]
    clouds = [streamed.chosen(choose(streamed, camera)) for camera in cameras]
    kept = [psnr(finest, cloud, [camera])[0] for cloud, camera in zip(clouds, cameras, strict=True)]
    spent = [_milliseconds(cloud, [camera]) for cloud, camera in zip(clouds, cameras, strict=True)]
    return {
        "share": statistics.fmean(len(cloud) / len(finest) for cloud in clouds),
        "draw": statistics.median(spent),
        "draw_finest": _milliseconds(finest, cameras),
        "psnr": statistics.median(kept),
        "psnr_least": min(kept),
    }


def _milliseconds(cloud: GaussianCloud, cameras: Sequence[Camera]) -> float:
    """Processor time of a picture: the median over cameras of the least of some repeats."""

    def once(camera: Camera) -> float:
        began = time.process_time()
        render(cloud, camera)
        return time.process_time() - began

    return 1000 * statistics.median(min(once(camera) for _ in range(REPEATS)) for camera in cameras)


def _away(cloud: GaussianCloud, camera: Camera) -> Camera:
    """The camera, `FAR` times as far from what it shows."""
    seen = render(cloud, camera)
    depth = float(seen.depth[seen.alpha > 0.5].median())
    pose = camera.world_to_camera.copy()
    pose[2, 3] += (FAR - 1) * depth
    return replace(camera, world_to_camera=pose)

"""Deletions in captures of real places, against photographs: filled, optimised against photographs, and inpainted.

The bench of `bench_box` was photographed with a box and without it. Of the bonsai room, every fourth photograph that
sees behind what is deleted is kept apart and is the truth there.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from ...agent.session.session import Session
from ...gaussians.errors import ScenewrightError
from ...gaussians.files.captures.capture import Capture, read_capture
from ...gaussians.files.captures.image_file import read_photo
from ...gaussians.language import encoders, masks
from ...gaussians.language.field.embed import embed
from ...gaussians.render import render
from ...gaussians.rows import mask_of_ids
from ...gaussians.scene import Scene
from ...tools.lifting.behind import Photographs, seen_behind
from ...tools.lifting.inpainters import Shot
from ...tools.lifting.target import psnr
from .._data import folder, missing
from .._select.real.settings import Setting, bare_scene
from ..harness import Metric
from .measure import Scores, View, scored, telea

BOX, ROOM = "bench_box", "bonsai_room"
WITHOUT = "transforms_without_box.json"
GOAL_OVER_BARE = GOAL_OVER_TELEA = 3.0  # dB
EVERY = 4  # photographs that see behind, of which one is the truth
DELETED = ("the bicycle", "the plant", "the chair on the left", "the purple cloth")
_SHOWN = 0.5  # blending weight of what is deleted from which it hid a pixel
F32 = NDArray[np.float32]


@dataclass(frozen=True)
class Telea:
    """Fills pictures by Telea's method, for comparison: an `Inpainter`."""

    name: str = "telea"
    grow: int = 3

    def prepare(self, shots: Sequence[Shot]) -> None:
        """Nothing to prepare."""

    def fill(self, shot: Shot, seed: int = 0) -> F32:
        """See `Inpainter`."""
        return telea(shot.rgb.astype(np.float64), shot.mask).astype(np.float32)


def capture_metrics(quick: bool) -> tuple[list[Metric], tuple[str, ...]]:
    """What deletions in the captures gain, and notes; nothing if the data are not here or little time is allowed."""
    if quick:
        return [], ()
    found, notes = list[Metric](), list[str]()
    for name, measure in ((BOX, box_metrics), (ROOM, room_metrics)):
        capture = folder(f"captures/{name}")
        if capture is None:
            notes.append(missing(f"captures/{name}"))
        else:
            found += measure(capture)
    return found, tuple(notes)


def box_metrics(capture: Path, views: int = 40) -> list[Metric]:
    """The box deleted by words, against photographs of the place without it, in the pixels that it hid.

    Args:
        views: of these photographs that are compared.
    """
    scene = embedded(capture, box_masks(capture))
    bare = _deleted(scene, "delete the box", infill=False)[0]
    gone = ~mask_of_ids(scene.cloud.ids, bare.cloud.ids)
    seen = hidden_views(scene, bare, gone, read_capture(capture / WITHOUT), views)
    found = dict[str, tuple[Scores, float]]()
    methods: dict[str, dict[str, object]] = {
        "bare": {"infill": False}, "filled": {}, "photographs": {"capture": capture}, "telea": {"infill": Telea()},
    }  # fmt: skip
    for name, how in methods.items():
        filled, seconds = _deleted(scene, "delete the box", **how)
        shots = [render(filled.cloud, v.camera) for v in seen]
        pictures = [np.clip(s.rgb.numpy().astype(np.float64), 0, 1) for s in shots]
        found[name] = scored(seen, pictures, [s.alpha.numpy().astype(np.float64) for s in shots]), seconds
    best = max(found["filled"][0].psnr, found["photographs"][0].psnr)
    metrics = [Metric(f"{BOX}.views", len(seen), "count")]
    for name, (score, seconds) in found.items():
        metrics.append(Metric(f"{BOX}.psnr.{name}", score.psnr, "dB", "higher", 0.02))
        metrics.append(Metric(f"{BOX}.ssim.{name}", score.ssim, "1", "higher", 0.05))
        metrics.append(Metric(f"{BOX}.open.{name}", score.open, "1", "lower", 0.1))
        metrics.append(Metric(f"{BOX}.seconds.{name}", seconds, "s", "lower", 0.5))
    over = best - found["bare"][0].psnr, best - found["telea"][0].psnr
    metrics.append(Metric(f"{BOX}.psnr.over_bare", over[0], "dB", "higher", 0.1, GOAL_OVER_BARE))
    metrics.append(Metric(f"{BOX}.psnr.over_telea", over[1], "dB", "higher", 0.1, GOAL_OVER_TELEA))
    return metrics


def room_metrics(capture: Path, deleted: Sequence[str] = DELETED) -> list[Metric]:
    """Things of the bonsai room deleted by words, against photographs that see behind them and were kept apart."""
    scene = embedded(capture, capture / "masks")
    taken = read_capture(capture)
    metrics = list[Metric]()
    for what in deleted:
        try:
            plain, _ = _deleted(scene, f"delete {what}")
        except ScenewrightError:
            continue
        name = f"{ROOM}.{what.removeprefix('the ').replace(' ', '_')}"
        new = plain.cloud.ids[~mask_of_ids(plain.cloud.ids, scene.cloud.ids)]
        if not len(new):
            metrics.append(Metric(f"{name}.made", 0, "Gaussians"))
            continue
        behind = seen_behind(Photographs(taken, scene.cloud), plain.cloud, new)
        metrics += [
            Metric(f"{name}.made", len(new), "Gaussians"),
            Metric(f"{name}.views", len(behind.targets), "count"),
        ]
        truth = behind.targets[EVERY // 2 :: EVERY]
        if not truth:
            continue
        apart = {t.camera.name for t in truth}
        lifted, seconds = _deleted(scene, f"delete {what}", capture=without(taken, apart))
        bare = plain.cloud[mask_of_ids(plain.cloud.ids, scene.cloud.ids)]
        for how, cloud in (("bare", bare), ("filled", plain.cloud), ("photographs", lifted.cloud)):
            metrics.append(Metric(f"{name}.psnr.{how}", psnr(cloud, truth), "dB", "higher", 0.02))
        metrics.append(Metric(f"{name}.seconds", seconds, "s", "lower", 0.5))
    return metrics


def embedded(capture: Path, labels: Path) -> Scene:
    """The fitted scene of a capture, embedded with masks in a folder."""
    scene = bare_scene(capture.parent, capture.name, Setting("masks", masks="folder"))
    sources, _ = masks.load_all(f"folder:{labels}", capture)
    return embed(scene, encoders.load("auto"), masks=sources)


def box_masks(capture: Path) -> Path:
    """The capture's masks of the box, in a new folder as `embed --masks folder:` reads them."""
    from PIL import Image

    place = Path(tempfile.mkdtemp())
    index = dict[str, list[dict[str, object]]]()
    for path in sorted((capture / "object_masks").glob("*.png")):
        mask = np.asarray(Image.open(path).convert("L")) > 127
        Image.fromarray(mask.astype(np.uint8)).save(place / path.name)
        index[f"{path.stem}.jpg"] = [{"id": 1, "label": "box", "score": 0.95}]
    (place / "masks.json").write_text(json.dumps(index), encoding="utf-8")
    return place


def hidden_views(scene: Scene, bare: Scene, gone: torch.Tensor, truth: Capture, count: int) -> list[View]:
    """Photographs of the place without what is gone, with the pixels that it hid."""
    thing, found = scene.cloud[gone], list[View]()
    marked = scene.cloud.replace(group=gone.to(scene.cloud.group.dtype))
    for i in np.unique(np.linspace(0, len(truth.cameras) - 1, count).round().astype(int)):
        camera = truth.cameras[i]
        photo = read_photo(truth.photos[i], (camera.width, camera.height))
        camera = camera.resized(photo.shape[1], photo.shape[0])
        hidden = (render(thing, camera).alpha.numpy() > _SHOWN) & (render(marked, camera).group.numpy() == 1)
        shot = render(bare.cloud, camera)
        rgb = np.clip(shot.rgb.numpy().astype(np.float64), 0, 1)
        found.append(View(camera, photo / 255, rgb, shot.alpha.numpy().astype(np.float64), hidden))
    return found


def without(capture: Capture, names: set[str]) -> Capture:
    """A capture without some photographs."""
    kept = [i for i, camera in enumerate(capture.cameras) if camera.name not in names]
    cameras, photos = tuple(capture.cameras[i] for i in kept), tuple(capture.photos[i] for i in kept)
    return replace(capture, cameras=cameras, photos=photos, lenses=tuple(capture.lenses[i] for i in kept))


def _deleted(scene: Scene, words: str, **how: object) -> tuple[Scene, float]:
    """The scene after an instruction, and the seconds that filling and lifting took."""
    session = Session(scene, planner="grammar", accept_unconfirmed=True, **how)  # type: ignore[arg-type]
    result = session.do(words)
    spent = [r.seconds.get(stage, 0.0) for r in result.receipts for stage in ("fill", "inpaint", "lift")]
    return session.scene, sum(spent)

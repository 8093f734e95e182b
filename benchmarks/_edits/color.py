"""Colour edits on real scenes: do greys stay grey, and is a new colour the one that was asked, in the scene's light?

Things are taken by boxes, so that no selection by words is measured with them, and looked at from a photograph's
camera.

- Shift of greys: of the pixels that show the thing and were grey (Lab chroma below 10, lightness above 15), nine in ten
  shift less in a and b of CIELAB, beyond what more or less light does to the little tint that they have.
- Distance from what was asked: CIEDE2000 of the mean pixel of the painted surface to the asked pigment times the
  scene's light times its shading. The shading is measured in the same pixels before: their mean luma relative to that
  of the lit faces. A lighter pigment has less contrast than a dark one showed (noise and gloss are not shading), so the
  nearest colour between that shading and full light counts; `strict` takes the shading as it was.

Run `python -m scenewright.benchmarks._edits.color` to print the tables.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean
from typing import Any, NamedTuple

import numpy as np
import torch
from torch import Tensor

from ...gaussians.camera import Camera, Vec3
from ...gaussians.color import ciede2000, rgb_to_lab, shade_of
from ...gaussians.errors import CheckFailedError
from ...gaussians.files import load
from ...gaussians.files.captures.capture import read_capture
from ...gaussians.harmonics import color_to_dc
from ...gaussians.language.field.measure import Sample
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.selection import Selection
from ...gaussians.language.segmentation.group_renders import cameras_around
from ...gaussians.render import render
from ...gaussians.scene import Frame, Scene
from ...tools.color_map import LUMA
from ...tools.coloring.greys import grey_shift
from ...tools.coloring.scene_light import scene_light
from ...tools.coloring.seen import lit_color, seen_colors
from ...tools.execute import Done, carry_out
from ...tools.operation import Context
from ...tools.registry import parse
from .._data import folder
from .._select.real.fitted import scene_of
from ..harness import Metric

GREY_GOAL, COLOR_GOAL = 2.0, 6.0
COLORS = ("teal", "dark purple", "dark blue", "red", "gray", "white", "gold")
SHADES = (("darker", 0.25), ("darker", 0.5), ("darker", 0.8), ("lighter", 0.25), ("lighter", 0.5))
PIXELS = 240  # width of a picture
_CAMERAS = 12  # photographs of which the best is taken
_LEVELS = 17  # of light between the shading before and full light
_UPS: tuple[Vec3, ...] = ((0.0, 0.0, 1.0), (0.0, -1.0, 0.0), (0.0, 1.0, 0.0))  # where a file does not say it
_SHOWN = 0.9  # share of a pixel's light that comes from the thing
_FEWEST = 60  # pixels that show it

Box = tuple[Vec3, Vec3]
# Things by the lower and upper corner of a box in the scene's frame.
THINGS: dict[str, dict[str, Box]] = {
    "bonsai_room": {
        "cloth and stand": ((-0.9, 1.63, 0.7), (1.2, 3.1, 2.5)),
        "flowers": ((-0.45, 1.2, 0.2), (0.75, 1.95, 1.2)),
    },
    "guitar": {"guitar": ((-1.0, -5.0, -1.0), (1.0, 0.5, 1.0))},
    "playbot": {"robot": ((-0.6, -1.3, -0.4), (0.6, -0.3, 0.4)), "ground": ((-1.0, -0.1, -1.0), (1.0, 0.05, 1.0))},
    "diorama_table": {
        "book": ((-0.35, -0.18, -0.51), (-0.13, 0.07, -0.46)),
        "laptop": ((-0.16, -0.23, -0.515), (0.17, 0.07, -0.31)),
        "cup": ((0.19, -0.21, -0.51), (0.35, -0.08, -0.44)),
        "flower in a pot": ((0.14, -0.09, -0.51), (0.29, 0.05, -0.29)),
    },
    "desk_laptop": {
        "penguin": ((7.7, -1.6, 15.8), (10.9, 2.2, 17.4)),
        "kettle": ((-2.7, -0.4, 16.6), (-1.1, 2.1, 17.9)),
        "red bag": ((-4.7, -0.8, 15.8), (-3.2, 2.2, 17.8)),
    },
}
_FILES = {"bonsai_room": "bonsai_room.ply", "guitar": "guitar.compressed.ply", "playbot": "playbot/2_0"}


class Edit(NamedTuple):
    """One measured edit.

    Attributes:
        scene, thing, asked: of what and to what.
        value: what was measured, ΔE; NaN where the edit was refused by its own checks.
        strict: of a new colour, the distance to it in exactly the shading before.
    """

    scene: str
    thing: str
    asked: str
    value: float
    strict: float = 0.0


@dataclass(frozen=True, eq=False)
class _Thing:
    """A thing of a scene before an edit, as a camera shows it."""

    scene: Scene
    rows: Tensor
    camera: Camera

    def recolored(self, **fields: Any) -> Done:
        selection = Selection(Query(last=True), "found", self.scene.cloud.ids[self.rows].sort().values)
        op = parse({"op": "recolor", "target": {"last": True}, **fields})
        return carry_out(self.scene, op, Context(self.camera), selection)


def measure(names: Sequence[str] = tuple(THINGS)) -> tuple[list[Edit], list[Edit]]:
    """Shifts of greys under darker and lighter, and distances of new colours, of the scenes whose data are here."""
    greys: list[Edit] = []
    colors: list[Edit] = []
    for scene, thing, seen in _things(names):
        greys += [Edit(scene, thing, f"{way} by {amount}", _grey(seen, way, amount)) for way, amount in SHADES]
        colors += [Edit(scene, thing, color, *_color(seen, color)) for color in COLORS]
    return greys, colors


def metrics(greys: Sequence[Edit], colors: Sequence[Edit]) -> tuple[Metric, ...]:
    """The rows of `bench edits`: means over the edits, the worst shift, and the share of colours within the goal."""
    done = [e.value for e in colors if e.value == e.value]
    shifts = [e.value for e in greys if e.value == e.value]
    refused = len(colors) + len(greys) - len(done) - len(shifts)
    if not done or not shifts:
        return ()
    return (
        Metric("color.grey_shift.worst", max(shifts), "ΔE", "lower", 0.1, GREY_GOAL),
        Metric("color.distance.mean", fmean(done), "ΔE00", "lower", 0.1, COLOR_GOAL),
        Metric("color.distance.strict", fmean(e.strict for e in colors if e.strict == e.strict), "ΔE00", "lower", 0.1),
        Metric("color.distance.within_goal", fmean(v <= COLOR_GOAL for v in done), "share", "higher", 0.05),
        Metric("color.refused", refused, "count", "lower"),
    )


def _things(names: Sequence[str]) -> Iterator[tuple[str, str, _Thing]]:
    for name in names:
        scene = scene_named(name)
        for thing, box in THINGS[name].items() if scene is not None else ():
            assert scene is not None
            rows = rows_within(scene, box)
            camera = best_camera(scene, rows)
            if camera is not None:
                yield name, thing, _Thing(scene, rows, camera)


def rows_within(scene: Scene, box: Box) -> Tensor:
    """Rows `[M]` of the Gaussians whose centres lie in a box of `THINGS`."""
    means, (low, high) = scene.cloud.means, box
    return ((means >= torch.tensor(low)) & (means <= torch.tensor(high))).all(dim=1).nonzero().squeeze(1)


def scene_named(name: str, file: Path | None = None) -> Scene | None:
    """A scene of `THINGS` with the photographs' cameras, from a file if one is given; None if its data are missing."""
    captures, scenes = folder("captures"), folder("scenes")
    if file is not None:
        scene: Scene | None = load(file)
    elif name in _FILES:
        path = None if scenes is None else scenes / _FILES[name]
        scene = load(path) if path is not None and path.exists() else None
    else:
        scene = None if captures is None else scene_of(captures / name)
    capture = None if captures is None else captures / name
    if scene is not None and capture is not None and Path(capture).is_dir():
        scene = scene.replace(cameras=read_capture(capture).cameras)
    return scene


def best_camera(scene: Scene, rows: Tensor) -> Camera | None:
    """The camera that shows most of a thing; None if none shows enough."""
    if scene.cameras:
        step = max(1, len(scene.cameras) // _CAMERAS)
        cameras = [c.resized(PIXELS, PIXELS * c.height // c.width) for c in scene.cameras[::step]]
    else:
        points = scene.cloud.means[rows].double().numpy()
        frames = [Frame(up) for up in _UPS]
        cameras = [c for frame in frames for c in cameras_around(points, frame, np.zeros(3), PIXELS, 3)]
    counts = [int(_shows(scene, rows, c).sum()) for c in cameras]
    best = int(np.argmax(counts))
    return cameras[best] if counts[best] >= _FEWEST else None


def _shows(scene: Scene, rows: Tensor, camera: Camera) -> Tensor:
    """`[H, W]` bool: pixels that show some rows of the cloud."""
    paint = color_to_dc(torch.zeros(len(scene.cloud), 1, 3))
    paint[rows] = color_to_dc(torch.ones(1, 3))
    return render(scene.cloud.replace(sh=paint), camera).rgb[..., 0] > _SHOWN


def _even(rgb: Tensor) -> Sample:
    return Sample(rgb.double().clamp(0, 1), torch.full((len(rgb),), 1 / max(len(rgb), 1), dtype=torch.float64))


def _grey(thing: _Thing, way: str, amount: float) -> float:
    try:
        after = thing.recolored(adjust=way, amount=amount).scene
    except CheckFailedError:
        return float("nan")
    shown = _shows(thing.scene, thing.rows, thing.camera)
    was, now = (_even(render(s.cloud, thing.camera).rgb[shown]) for s in (thing.scene, after))
    return grey_shift(was, now)


def _color(thing: _Thing, color: str) -> tuple[float, float]:
    """The distance from a colour as `value` and `strict` of an `Edit`."""
    try:
        after = thing.recolored(color=color).scene
    except CheckFailedError:
        return float("nan"), float("nan")
    painted = (after.cloud.sh != thing.scene.cloud.sh).flatten(1).any(dim=1).nonzero().squeeze(1)
    shown = _shows(thing.scene, painted, thing.camera)
    if int(shown.sum()) < _FEWEST // 3:
        return float("nan"), float("nan")
    was, now = (render(s.cloud, thing.camera).rgb[shown].double().clamp(0, 1) for s in (thing.scene, after))
    weights = torch.tensor(LUMA, dtype=torch.float64)
    lit = float(lit_color(seen_colors(thing.scene, painted)) @ weights)
    shading = min(float((was @ weights).mean()) / max(lit, 1e-3), 1.0)
    asked = scene_light(thing.scene.cloud).on(torch.tensor(shade_of(color), dtype=torch.float64)).clamp(0, 1)
    levels = torch.linspace(shading, 1, _LEVELS, dtype=torch.float64)[:, None]
    far = ciede2000(rgb_to_lab(now.mean(dim=0)).expand(_LEVELS, 3), rgb_to_lab(levels * asked))
    return float(far.min()), float(far[0])


def table(edits: Sequence[Edit]) -> str:
    """A Markdown table: things in rows, edits in columns."""
    asked = list(dict.fromkeys(e.asked for e in edits))
    lines = ["| scene | thing | " + " | ".join(asked) + " |", "| --- | --- |" + " ---: |" * len(asked)]
    for scene, thing in dict.fromkeys((e.scene, e.thing) for e in edits):
        row = {e.asked: e.value for e in edits if (e.scene, e.thing) == (scene, thing)}
        lines.append(f"| {scene} | {thing} | " + " | ".join(f"{row[a]:.1f}" for a in asked) + " |")
    return "\n".join(lines)


def main(names: Sequence[str]) -> None:
    """Print the tables and the figures of some scenes, or of all."""
    greys, colors = measure(names or tuple(THINGS))
    print(table(greys), "", table(colors), "", sep="\n")
    for metric in metrics(greys, colors):
        print(f"{metric.key}: {metric.value:.2f} {metric.unit}")


if __name__ == "__main__":
    main(sys.argv[1:])

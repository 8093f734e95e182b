"""bench relight: other light on scenes: seconds on a large cloud, how far the luminance of pictures is from what was
asked, and the colour temperature that a grey wall shows.

Luminance is that of decoded pixels, as a light meter sees them, from every camera of furnished rooms. Temperatures are
read from the chromaticity of a picture by McCamy's formula (1992), which shares no code with `relight`.
"""

from __future__ import annotations

import statistics
from collections.abc import Mapping
from typing import Any

import torch
from torch import Tensor

from ..gaussians.assets.furnishing.furnish import furnish
from ..gaussians.camera import Camera
from ..gaussians.language.query.query import Query
from ..gaussians.language.query.selection import Selection
from ..gaussians.render import render
from ..gaussians.scene import Scene
from ..tools.execute import Done, carry_out
from ..tools.operation import Context
from ..tools.registry import parse
from .edit import GAUSSIANS, QUICK_GAUSSIANS, best_of, crowded
from .harness import Metric, Result
from .restyle import wall

GOAL_SECONDS, GOAL_LUMINANCE, GOAL_WHITE = 0.5, 0.05, 0.05
SEEDS, QUICK_SEEDS = (8301, 8302, 8303), (8301,)
EXPOSURES = (0.5, 0.8, 1.2, 1.333)
KELVINS = (2700.0, 3500.0, 5000.0, 8000.0, 10000.0)
EVERYTHING = Query(text="everything", pick="all")
VIEWER = Camera.look_at([3.2, -6, 3], [3.2, 3, 0.5], [0, 0, 1], 512, 384)
_PICTURE = (192, 144)
# What is timed: a name and the fields of the operation.
_TIMED = (
    ("a third brighter", {"exposure": 1.333}),
    ("half as bright", {"exposure": 0.5}),
    ("2700 K", {"kelvin": 2700}),
    ("evening", {"mood": "evening"}),
    ("from the left", {"side": "left"}),
    ("softer", {"contrast": 0.8}),
)
_TO_XYZ = torch.tensor(  # linear sRGB, IEC 61966-2-1
    [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]], dtype=torch.float64
)


def run(quick: bool) -> Result:
    """Measure all of it; of times the fastest of two runs counts."""
    rooms = [furnish(seed, detail=0.3).scene for seed in (QUICK_SEEDS if quick else SEEDS)]
    scene = crowded(QUICK_GAUSSIANS if quick else GAUSSIANS)
    metrics = []
    for name, fields in _TIMED:
        seconds, _ = best_of(lambda: _relit(scene, fields, VIEWER), 1 if quick else 2)  # noqa: B023 (called at once)
        metrics.append(Metric(f"seconds.{name.replace(' ', '_')}", seconds, "s", "lower", 0.3, GOAL_SECONDS))
    for factor in EXPOSURES:
        off = max(abs(_gained(room, factor) / factor - 1) for room in rooms)
        metrics.append(Metric(f"luminance.{factor:g}", off, "1", "lower", 0.1, GOAL_LUMINANCE))
    off_white = [abs(_temperature(_grey(kelvin)) / kelvin - 1) for kelvin in KELVINS]
    metrics.append(Metric("white.worst", max(off_white), "1", "lower", 0.1, GOAL_WHITE))
    metrics.append(Metric("white.mean", statistics.fmean(off_white), "1", "lower", 0.1))
    return Result(
        title=f"other light; {len(scene.cloud):,} Gaussians of degree 3",
        accuracy="",
        metrics=tuple(metrics),
        points=(),
        notes=(
            "luminance.F: how far the mean luminance of all pictures is from F times that before, the worst room.",
            f"white: the temperature of a grey wall lit at {KELVINS[0]:g} to {KELVINS[-1]:g} K, by McCamy's formula, "
            "which is within 2 % of the locus there.",
        ),
        seeds=SEEDS,
    )


def _relit(scene: Scene, fields: Mapping[str, Any], viewer: Camera) -> Done:
    """The scene under another light, all of it, with the checks of an edit."""
    op = parse({"op": "relight", "target": EVERYTHING.model_dump(exclude_defaults=True), **fields})
    return carry_out(scene, op, Context(viewer), Selection(EVERYTHING, "found", scene.cloud.ids.sort().values))


def _gained(room: Scene, factor: float) -> float:
    """How many times brighter the pictures of a room are after its light was made `factor` times as bright."""
    after = _relit(room, {"exposure": factor}, room.cameras[0]).scene
    was, now = (torch.cat([_linear(s, c).flatten(0, 1) for c in room.cameras]) @ _TO_XYZ[1] for s in (room, after))
    return float(now.mean() / was.mean())


def _grey(kelvin: float) -> Tensor:
    """`[3]` linear colour of the middle of a grey wall in a light."""
    scene = wall()
    camera = Camera.look_at([1.6, -3, 1.2], [1.6, 0, 1.2], [0, 0, 1], *_PICTURE)
    after = _relit(scene, {"kelvin": kelvin}, camera).scene
    height, width = _PICTURE[1], _PICTURE[0]
    middle = _linear(after, camera)[height // 3 : -height // 3, width // 3 : -width // 3]
    return middle.flatten(0, 1).mean(dim=0)


def _linear(scene: Scene, camera: Camera) -> Tensor:
    """`[H, W, 3]` float64 linear colours of a small picture."""
    rgb = render(scene.cloud, camera.resized(*_PICTURE)).rgb.double().clamp(0, 1)
    return torch.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


def _temperature(linear: Tensor) -> float:
    """Correlated colour temperature of a linear sRGB colour `[3]`, kelvins (McCamy 1992)."""
    x, y, z = (float(v) for v in _TO_XYZ @ linear)
    n = (x / (x + y + z) - 0.3320) / (0.1858 - y / (x + y + z))
    return 449.0 * n**3 + 3525.0 * n**2 + 6823.3 * n + 5520.33

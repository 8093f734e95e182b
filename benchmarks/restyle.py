"""bench restyle: new materials on things: seconds on a large cloud, the length of what repeats as pictures show it,
whether things are found by their names afterwards, and whether anything else changed.

The period is measured in pictures of a wall, not in the texture: in rows of pixels, by the frequency whose
harmonics are strongest. Things are those of rooms furnished from a seed, found by the built-in resolver
before and after.
"""

from __future__ import annotations

import statistics
from collections.abc import Iterator

import numpy as np
import torch

from ..gaussians.assets.furnishing.furnish import furnish
from ..gaussians.camera import Camera
from ..gaussians.cloud import GaussianCloud
from ..gaussians.errors import ScenewrightError
from ..gaussians.harmonics import color_to_dc
from ..gaussians.language import encoders
from ..gaussians.language.field.embed import embed
from ..gaussians.language.field.language_field import Group, LanguageField
from ..gaussians.language.query.query import Query
from ..gaussians.render import render
from ..gaussians.scene import Frame, Scene
from ..gaussians.world.box import Box
from ..tools.execute import carry_out
from ..tools.operation import Context
from ..tools.registry import parse
from .edit import GAUSSIANS, QUICK_GAUSSIANS, best_of, crowded
from .harness import Metric, Point, Result

GOAL_SECONDS, GOAL_PERIOD, GOAL_FOUND = 5.0, 0.05, 1.0
MATERIALS = ("wood", "marble", "brick", "tiles", "leather", "fabric", "concrete", "metal", "stripes", "dots")
PERIODS = (("brick", 0.225), ("brick", 0.4), ("tiles", 0.15), ("tiles", 0.5), ("stripes", 0.2), ("checks", 0.3))
SEEDS, QUICK_SEEDS = (8101, 8102, 8103), (8101,)
_WIDE, _TALL = 3.2, 2.4  # metres of the wall
_STEP = 0.04  # metres between its Gaussians
_PIXELS = 1280
_HARMONICS = 6
_AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def run(quick: bool) -> Result:
    """Measure all materials; the fastest of two runs counts."""
    metrics, points = [], []
    scene = crowded(QUICK_GAUSSIANS if quick else GAUSSIANS)
    context = Context(Camera.look_at([3.2, -6, 3], [3.2, 3, 0.5], [0, 0, 1], 512, 384))
    for material in MATERIALS[:2] if quick else MATERIALS:
        op = parse({"op": "restyle", "target": {"groups": [7]}, "material": material})
        seconds, done = best_of(lambda: carry_out(scene, op, context), 1 if quick else 2)  # noqa: B023 (called at once)
        checks = len(done.receipt.checks)
        points.append(Point("restyle", material, seconds, checks, scene.cloud.nbytes, material == "marble"))
        metrics.append(Metric(f"{material}.seconds", seconds, "s", "lower", 0.3, GOAL_SECONDS))
        metrics.append(Metric(f"{material}.added", done.receipt.added, "Gaussians"))
    off = [abs(_shown(material, unit, context) / unit - 1) for material, unit in (PERIODS[:2] if quick else PERIODS)]
    metrics.append(Metric("period.worst_error", max(off), "1", "lower", 0.02, GOAL_PERIOD))
    found = [again for seed in (QUICK_SEEDS if quick else SEEDS) for again in _found_again(seed, quick)]
    metrics.append(Metric("found_by_name_as_before", statistics.fmean(found), "1", "higher", 0.02, GOAL_FOUND))
    metrics.append(Metric("found_by_name.things", len(found), "count"))
    return Result(
        title=f"new materials; {len(scene.cloud):,} Gaussians of degree 3, one twentieth selected",
        accuracy="post-conditions checked",
        metrics=tuple(metrics),
        points=tuple(points),
        notes=("Every run checks that nothing outside the target changed in any bit; a failure ends the benchmark.",),
        seeds=SEEDS,
    )


def wall() -> Scene:
    """A plain wall of overlapping Gaussians that faces -y, with a field of one thing."""
    across, up = np.meshgrid(np.arange(0, _WIDE, _STEP), np.arange(0, _TALL, _STEP))
    n = across.size
    means = torch.tensor(np.stack([across.ravel(), np.zeros(n), up.ravel()], axis=1), dtype=torch.float32)
    quats = torch.tensor([[1.0, 0, 0, 0]]).expand(n, 4).contiguous()
    scales = torch.tensor([[0.7 * _STEP, 0.003, 0.7 * _STEP]]).expand(n, 3).contiguous()
    sh = color_to_dc(torch.full((n, 1, 3), 0.7))
    cloud = GaussianCloud.create(means, quats, scales, torch.full((n,), 0.97), sh, torch.zeros(n, dtype=torch.int32))
    box = Box((_WIDE / 2, 0.0, _TALL / 2), _AXES, (_WIDE, 0.02, _TALL))
    field = LanguageField(
        (Group(0, "structure", -1, "wall", 0.9, box, (70.0, 0.0, 0.0), n, 8, 1.0),),
        np.zeros((1, 8), np.float32),
        "none",
    )
    return Scene(cloud, Frame(floor=0.0, metres_per_unit=1.0), (), field)


def _shown(material: str, unit: float, context: Context) -> float:
    """The period of a material along the wall in a picture that shows all of its width, metres."""
    length = {"value": unit, "unit": "m"}
    op = parse({"op": "restyle", "target": {"groups": [0]}, "material": material, "unit": length})
    done = carry_out(wall(), op, context)
    far = 40.0  # metres: nearly no perspective
    middle = (_WIDE / 2, 0.0, _TALL / 2)
    camera = Camera.look_at(
        (middle[0], -far, middle[2]), middle, (0, 0, 1), _PIXELS, _PIXELS * 3 // 4,
        float(np.degrees(2 * np.arctan(_TALL / 2 / far))),
    )  # fmt: skip
    luma = render(done.scene.cloud, camera).rgb.mean(dim=2).double().numpy()
    rows = luma[luma.shape[0] // 6 : -luma.shape[0] // 6, 40:-40]
    rows = rows - rows.mean(axis=1, keepdims=True)
    size = 1 << 17  # padded, so that frequencies are told finely
    strength = np.sqrt((np.abs(np.fft.rfft(rows * np.hanning(rows.shape[1]), size)) ** 2).mean(axis=0))
    per_metre = size * _WIDE / _PIXELS  # bins for one period a metre
    tried = np.linspace(0.6 / unit, 1.6 / unit, 2000)
    # Joints are narrow: they have harmonics, which the shades of single bricks do not have.
    comb = sum(strength[np.rint(k * tried * per_metre).astype(int)] for k in range(1, _HARMONICS + 1))
    return float(1 / tried[np.argmax(comb)])


def _found_again(seed: int, quick: bool) -> Iterator[bool]:
    """For each thing of a furnished room that is found by its name: whether it is after a restyle."""
    room = furnish(seed)
    encoder = encoders.load("auto")
    scene = embed(room.scene, encoder)
    context = Context(scene.cameras[0], encoder=encoder)
    names = sorted({thing.kind for thing in room.truth.objects})[: 3 if quick else None]
    for i, name in enumerate(names):
        query = Query(text=name)
        before = context.resolve(scene, query)
        if before.verdict != "found":
            continue
        material = MATERIALS[i % len(MATERIALS)]
        try:
            done = carry_out(scene, parse({"op": "restyle", "target": {"text": name}, "material": material}), context)
            after = context.resolve(done.scene, query)
        except ScenewrightError:
            yield False
            continue
        yield after.verdict == "found" and after.groups == before.groups

"""bench restyle: new materials on things: seconds on a large cloud, the length of what repeats as pictures show it,
whether things are found by their names afterwards, and whether anything else changed.

The period is measured in pictures of a wall, not in the texture: in rows of pixels, by the frequency whose
harmonics are strongest. Things are those of rooms furnished from a seed, found by the built-in resolver
before and after.
"""

from __future__ import annotations

import dataclasses
import statistics
import time
from collections.abc import Iterator

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..gaussians.assets.furnishing.furnish import furnish
from ..gaussians.camera import Camera
from ..gaussians.cloud import GaussianCloud, concat
from ..gaussians.color import ciede2000, rgb_to_lab
from ..gaussians.errors import ScenewrightError
from ..gaussians.harmonics import color_to_dc, dc_to_color
from ..gaussians.language import encoders
from ..gaussians.language.field.embed import embed
from ..gaussians.language.field.language_field import Group, LanguageField
from ..gaussians.language.query.query import Query
from ..gaussians.render import render
from ..gaussians.scene import Frame, Scene
from ..gaussians.world.box import Box
from ..gaussians.world.finishes import FINISHES, described
from ..planners.compose.compose import compose
from ..planners.rooms.build import construct
from ..tools.execute import carry_out
from ..tools.finishing.design import Choice, of_finish
from ..tools.finishing.finish import mean_pigment
from ..tools.operation import Context
from ..tools.registry import parse
from .edit import GAUSSIANS, QUICK_GAUSSIANS, best_of, crowded
from .harness import Metric, Point, Result

GOAL_SECONDS, GOAL_PERIOD, GOAL_FOUND = 5.0, 0.05, 1.0
MATERIALS = ("wood", "marble", "brick", "tiles", "leather", "fabric", "concrete", "metal", "stripes", "dots")
PERIODS = (("brick", 0.225), ("brick", 0.4), ("tiles", 0.15), ("tiles", 0.5), ("stripes", 0.2), ("checks", 0.3))
SEEDS, QUICK_SEEDS = (8101, 8102, 8103), (8101,)
# What is on a wall whose pattern another wall gets: material, and the length of what repeats.
TRANSFERRED = (("stripes", 0.2), ("checks", 0.3), ("brick", 0.4), ("tiles", 0.5), ("ornament", 0.4))
GOAL_HUE, GOAL_ROOM_SECONDS = 6.0, 1.0
# Descriptions of rooms, and the materials of floor and walls that they name.
ROOMS = (
    ("a living room with exposed brick walls and an oak floor", "planks", "brick"),
    ("a bedroom with striped wallpaper, grey carpet on the floor", "carpet", "stripes"),
    ("a bathroom with blue tiles on the walls and a slate floor", "slate", "tiles"),
    ("a concrete loft", "concrete", "concrete"),
    ("a rustic kitchen", "planks", "plaster"),
    ("an office, terrazzo on the ground, panelled walls in dark blue", "terrazzo", "planks"),
)
_WIDE, _TALL = 3.2, 2.4  # metres of the wall
_STEP = 0.04  # metres between its Gaussians
_PIXELS = 1280
_HARMONICS = 6
ROW_STEP = 4  # every such row of a picture is measured: neighbours show the same joints
_SHADED = 0.4  # metres around a thing within which its shadow falls
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
    off_hue, off_period = zip(
        *(_transferred(m, unit, context) for m, unit in TRANSFERRED[: 2 if quick else None]), strict=True
    )
    metrics.append(Metric("transfer.period.worst_error", max(off_period), "1", "lower", 0.02, GOAL_PERIOD))
    metrics.append(Metric("transfer.hue.worst", max(off_hue), "ΔE2000", "lower", 0.5, GOAL_HUE))
    shown, room_seconds = zip(*(_room(*room) for room in ROOMS[: 2 if quick else None]), strict=True)
    metrics.append(Metric("composed.materials", statistics.fmean(shown), "1", "higher", 0.02, GOAL_FOUND))
    metrics.append(Metric("composed.materials.seconds", max(room_seconds), "s", "lower", 0.3, GOAL_ROOM_SECONDS))
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


def _transferred(material: str, unit: float, context: Context) -> tuple[float, float]:
    """How far the mean colour (CIEDE2000) and the period of a wall are from those of the wall whose pattern it got."""
    length = {"value": unit, "unit": "m"}
    one = wall()
    op = {"op": "restyle", "target": {"groups": [0]}, "material": material, "unit": length}
    if material == "ornament":
        op |= {"color": "teal", "second": "white"}
    patterned = carry_out(one, parse(op), context).scene
    beside = one.cloud.replace(
        means=one.cloud.means + torch.tensor([0.0, 30.0, 0.0]),
        group=torch.ones_like(one.cloud.group),
        ids=one.cloud.ids + int(patterned.cloud.ids.max()) + 1,
    )
    field = patterned.language
    assert field is not None
    source = field.groups[0]
    box = Box((_WIDE / 2, 30.0, _TALL / 2), _AXES, source.box.size)
    second = dataclasses.replace(source, id=1, label="other wall", box=box, count=len(beside), names=())
    both = patterned.replace(
        cloud=concat([patterned.cloud, beside]),
        language=dataclasses.replace(
            field, groups=(source, second), embeddings=np.zeros((2, field.embeddings.shape[1]), np.float32)
        ),
    )
    like = parse({"op": "restyle", "target": {"groups": [1]}, "like": {"groups": [0]}})
    done = carry_out(both, like, context).scene.cloud
    was, now = (_picture(done[done.group == g], 30.0 * g) for g in (0, 1))
    hues = [rgb_to_lab(picture[100:-100, 100:-100].reshape(-1, 3).mean(dim=0).double()) for picture in (was, now)]
    periods = [_period(picture.mean(dim=2).double().numpy(), unit) for picture in (was, now)]
    return float(ciede2000(hues[0], hues[1])), abs(periods[1] / periods[0] - 1)


def _room(text: str, floor: str, walls: str) -> tuple[float, float]:
    """The share of floor and walls of a composed room that have the named material and show its colour, where no thing
    is near to shade them, and the processor seconds that this took."""
    room = compose(text, seed=1).layout.graph
    room = room.model_copy(update={"room": room.room.model_copy(update={"light": ""})})  # materials are measured
    bare = room.model_copy(update={
        "room": room.room.model_copy(update={"floor": "", "walls": "", "ceiling": ""}),
        "nodes": tuple(node.model_copy(update={"material": ""}) for node in room.nodes),
    })  # fmt: skip
    seconds = []
    for graph in (bare, room):
        start = time.process_time()
        scene = construct(graph, seed=1).scene
        seconds.append(time.process_time() - start)
    right = 0
    for label, said, asked in (("floor", room.room.floor, floor), ("wall", room.room.walls, walls)):
        found = described(said)
        if found is None or found.finish is None:
            continue
        named = "planks" if found.finish == "wood" else found.finish
        assert scene.language is not None
        groups = [g.id for g in scene.language.groups if g.level == "structure" and g.label == label]
        rows = torch.isin(scene.cloud.group, torch.tensor(groups, dtype=torch.int32)) & ~_near_things(scene)
        seen = rgb_to_lab(dc_to_color(scene.cloud.sh[rows, 0]).clamp(0, 1).double().mean(dim=0))
        pattern = of_finish(FINISHES[asked], Choice(found.color, found.second), (0.8, 0.8, 0.8)).pattern  # type: ignore[index]
        right += named == asked and float(ciede2000(seen, rgb_to_lab(mean_pigment(pattern)))) < 12
    return right / 2, max(0.0, seconds[1] - seconds[0])


def _near_things(scene: Scene) -> Tensor:
    """`[N]` bool: Gaussians within `_SHADED` metres of a thing's box."""
    assert scene.language is not None
    near = torch.zeros(len(scene.cloud), dtype=torch.bool)
    for group in scene.language.objects():
        local = torch.from_numpy(group.box.local(scene.cloud.means.numpy()))
        near |= (local.abs() <= torch.tensor(group.box.size) / 2 + _SHADED).all(dim=1)
    return near


def _picture(cloud: GaussianCloud, behind: float) -> Tensor:
    """A picture `[H, W, 3]` that shows all of the width of a wall so far behind the first, nearly in parallel."""
    far = 40.0  # metres
    middle = (_WIDE / 2, behind, _TALL / 2)
    camera = Camera.look_at(
        (middle[0], behind - far, middle[2]), middle, (0, 0, 1), _PIXELS, _PIXELS * 3 // 4,
        float(np.degrees(2 * np.arctan(_TALL / 2 / far))),
    )  # fmt: skip
    return render(cloud, camera).rgb


def _shown(material: str, unit: float, context: Context) -> float:
    """The period of a material along the wall in a picture that shows all of its width, metres."""
    length = {"value": unit, "unit": "m"}
    op = parse({"op": "restyle", "target": {"groups": [0]}, "material": material, "unit": length})
    done = carry_out(wall(), op, context)
    return _period(_picture(done.scene.cloud, 0.0).mean(dim=2).double().numpy(), unit)


def _period(luma: NDArray[np.float64], unit: float) -> float:
    """The period along the rows of a picture of a wall, near a length in metres, by the frequency whose harmonics are
    strongest."""
    rows = luma[luma.shape[0] // 6 : -luma.shape[0] // 6 : ROW_STEP, 40:-40]
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

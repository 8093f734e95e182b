"""`furnish`: a whole room as one scene, and the truth about it kept beside.

Knows how a layout becomes Gaussians: walls, floor, contact shadows, cameras, object ids. The scene it returns holds no
groups; who wants to measure looks into `Room.truth`.
"""

from __future__ import annotations

import itertools
import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..camera import Camera, Vec3
from ..cloud import GaussianCloud, concat
from ..errors import UserError
from ..scene import Frame, Scene
from . import light, recipes, surface
from .forge import flat_gaussians
from .layout import Box, Layout, Placed
from .materials import WOODS, Material, Tone
from .registry import KINDS, find
from .shapes import Piece, box, boxes, quad

Array = NDArray[np.float64]
STRUCTURE = -1  # truth id of floor, walls and ceiling
SOFT, SHADE = 0.75, 0.4  # contact shadows are kept pale: they stay on the floor when the thing that cast them is gone
WALLS = ("north", "west", "east", "south")


@dataclass(frozen=True)
class TruthObject:
    """One object as it was placed.

    Attributes:
        id: its number in `Truth.ids`.
        kind: canonical kind name.
        color: basic name of its main colour.
        size: (w, d, h) of its oriented box, metres.
        position: centre of that box, world, metres.
        yaw: degrees counter-clockwise from facing -y.
        support: id of what it stands on, or "floor", "wall", "ceiling".
        parts: part names.
    """

    id: int
    kind: str
    color: str
    size: Vec3
    position: Vec3
    yaw: float
    support: int | str
    parts: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Truth:
    """Ground truth beside a scene: `ids [N]` int32 object per Gaussian (-1: floor and walls), and the objects."""

    ids: Tensor
    objects: tuple[TruthObject, ...]


@dataclass(frozen=True, eq=False)
class Room:
    """A furnished room: the scene to work on, the truth to measure with, its kind and inner size (w, d, h)."""

    scene: Scene
    truth: Truth
    kind: str
    size: Vec3


def room_kinds() -> tuple[str, ...]:
    """What `furnish` can furnish."""
    return tuple(recipes.RECIPES)


def furnish(
    seed: int,
    kind: str = "any",
    objects: int | None = None,
    detail: float = 1.0,
    *,
    include: Sequence[str] = (),
    ceiling: bool = False,
) -> Room:
    """A furnished room; the same arguments give the same bytes.

    Args:
        seed: chooses everything.
        kind: one of `room_kinds()`, or "any".
        objects: the least number of objects to aim for (3 to 40); the recipe's own number if None, 12 at least.
        detail: factor on the number of Gaussians (1: about 80,000 to 150,000 in all).
        include: kinds that are added to what the recipe brings, where they fit.
        ceiling: whether to close the room above.

    Raises:
        UserError: for an unknown kind of room or object, or a number out of range.
    """
    if kind != "any" and kind not in recipes.RECIPES:
        raise UserError(f"unknown kind of room {kind!r}; known: any, {', '.join(recipes.RECIPES)}")
    if objects is not None and not 3 <= objects <= 40:
        raise UserError(f"objects must be between 3 and 40, got {objects}")
    rng = np.random.default_rng([zlib.crc32(b"room"), seed & 0xFFFFFFFF])
    names = tuple(recipes.RECIPES)
    drawn = names[int(rng.integers(len(names)))]
    name = drawn if kind == "any" else kind
    recipe, widths, depths = recipes.RECIPES[name]
    layout = Layout(
        float(rng.uniform(*widths)), float(rng.uniform(*depths)), float(rng.uniform(2.5, 2.8)), _walls(rng), rng
    )
    get = recipes.Supplier(rng, detail)
    recipes.openings(layout, get)
    for extra in include:
        _add(layout, get, find(extra).name)
    recipe(layout, get)
    recipes.fill_up(layout, get, objects or int(rng.integers(12, 18)))
    return assemble(layout, name, rng, detail, ceiling)


def _walls(rng: np.random.Generator) -> tuple[str, ...]:
    """Two to four walls; the south is left open most often, for looking in."""
    draw = rng.random()
    if draw < 0.6:
        return WALLS[:3]
    if draw < 0.8:
        return ("north", "west" if rng.random() < 0.5 else "east")
    return WALLS


def _add(layout: Layout, get: recipes.Supplier, name: str) -> None:
    """Put something asked for where its kind lives."""
    thing, known = get(name), KINDS[name]
    if known.support == "wall":
        for wall in layout.walls * 4:
            length = layout.w if wall in ("north", "south") else layout.d
            if (
                layout.hang(
                    thing, wall, float(layout.rng.uniform(-0.4, 0.4) * length), 1.2 if thing.size[2] < 1.2 else 0.0
                )
                is not None
            ):
                return
    elif known.support == "surface":
        stand = layout.against(get("cabinet"))
        if stand is None or layout.on_top(thing, stand) is None:
            layout.anywhere(thing, 0.1)
    elif known.against_wall:
        layout.against(thing)
    else:
        layout.anywhere(thing, 0.15, edge=False)


# --- structure -------------------------------------------------------------------------------------------------------


def _shell(layout: Layout, rng: np.random.Generator, ceiling: bool) -> list[Piece]:
    """Floor, walls with skirting boards, perhaps a ceiling."""
    tone = Tone(rng, "light")
    w, d, h = layout.w, layout.d, layout.h
    style = str(rng.choice(["planks", "planks", "tiles", "carpet", "plain"]))
    wood = tone.plain(WOODS[int(rng.integers(len(WOODS) - 1))])
    floor = {
        "planks": Material(wood.color, "planks", scale=float(rng.uniform(0.12, 0.2)), seed=tone.seed),
        "tiles": Material(
            *_pair(rng, (("#e8e4da", "#c9c2b4"), ("#d9dcdd", "#9aa3a8"), ("#efe9df", "#b98d6c"))),
            scale=float(rng.uniform(0.3, 0.5)),
            seed=tone.seed,
        ),
        "carpet": tone.plain(str(rng.choice(["#a99f90", "#8d939b", "#b3a58c", "#7f8a86"])), "weave"),
        "plain": tone.plain(str(rng.choice(["#b9b4aa", "#a7a29b", "#cfc7b8"])), "flat"),
    }[style]
    paint = tone.plain(
        str(rng.choice(["#ece7dc", "#dfe4e6", "#e6dccb", "#d5dfd6", "#e9dcd7", "#cfd8e2", "#f0ece4", "#d9cdbb"])),
        "flat",
    )
    if rng.random() < 0.2:
        other = tuple(c * 0.93 for c in paint.color)
        paint = Material(paint.color, "stripes", (other[0], other[1], other[2]), 0.3, 0)
    out = _floor(layout, floor)
    skirt = tone.plain("#f1efea", "flat")
    for name in layout.walls:
        length = w if name in ("north", "south") else d
        x, y, yaw = layout.spot(name, 0.0, 0.0)
        side = paint if yaw in (0.0, 180.0) else Material(paint.color, paint.pattern, paint.second, paint.scale, 1)
        plate = quad([(length / 2, 0, 0), (-length / 2, 0, 0), (length / 2, 0, h), (-length / 2, 0, h)])
        out.append(plate.turned("z", yaw).moved(x, y).named(f"{name} wall", side))
        rail = box(length, 0.015, 0.08, (0, -0.0075, 0), 0.0)
        out.append(rail.turned("z", yaw).moved(x, y).named("skirting", skirt, 1.2))
    if ceiling:
        lid = boxes([(w, d, 0.02, 0, 0, h)], 0.0)
        out.append(lid.named("ceiling", tone.plain("#f4f2ee", "flat")))
    return out


def _floor(layout: Layout, material: Material) -> list[Piece]:
    """The floor in rectangles, finer under rugs: large cells just below a thin sheet would show through it."""
    xs, ys = [-layout.w / 2, layout.w / 2], [-layout.d / 2, layout.d / 2]
    covers = []
    for t in (layout.things[i] for i in layout.rugs()):
        low, high = t.box.corners().min(axis=0), t.box.corners().max(axis=0)
        covers.append((low, high))
        xs += [float(np.clip(v, xs[0], xs[1])) for v in (low[0], high[0])]
        ys += [float(np.clip(v, ys[0], ys[1])) for v in (low[1], high[1])]
    out = []
    for x0, x1 in itertools.pairwise(sorted(set(xs))):
        for y0, y1 in itertools.pairwise(sorted(set(ys))):
            x, y = (x0 + x1) / 2, (y0 + y1) / 2
            under = any(a[0] < x < b[0] and a[1] < y < b[1] for a, b in covers)
            patch = quad([(x0, y0, 0), (x0, y1, 0), (x1, y0, 0), (x1, y1, 0)])
            out.append(patch.named("floor", material, 2.8 if under else 1.5))
    return out


def _pair(rng: np.random.Generator, table: tuple[tuple[str, str], ...]) -> tuple[Vec3, str, Vec3]:
    from .. import color

    a, b = table[int(rng.integers(len(table)))]
    return color.parse(a), "tiles", color.parse(b)


def _cut_openings(samples: surface.Samples, layout: Layout) -> surface.Samples:
    """Take the wall away behind windows and doors."""
    keep = np.ones(len(samples.xyz), dtype=bool)
    for t in layout.things:
        if t.asset.kind in ("window", "door"):
            low = t.box.z if t.asset.kind == "door" else t.box.z + 0.06
            local = (samples.xyz[:, :2] - np.array([t.box.x, t.box.y])) @ t.box.axes.T
            inside = (np.abs(local[:, 0]) < t.box.w / 2 - 0.06) & (np.abs(local[:, 1]) < t.box.d / 2 + 0.03)
            keep &= ~(inside & (samples.xyz[:, 2] > low) & (samples.xyz[:, 2] < t.box.z + t.box.h - 0.03))
    return samples[keep]


# --- assembly --------------------------------------------------------------------------------------------------------


def assemble(layout: Layout, name: str, rng: np.random.Generator, detail: float, ceiling: bool) -> Room:
    """Everything as one cloud, lit together."""
    azimuth = float(rng.uniform(0, 2 * math.pi))
    sun = np.array([0.6 * math.cos(azimuth), 0.6 * math.sin(azimuth), 0.8])
    shell = _shell(layout, rng, ceiling)
    samples = _cut_openings(surface.sample(shell, 0.062 / math.sqrt(detail)), layout)
    placed = [_stand(t, sun) for t in layout.things]
    solid = np.concatenate([samples.xyz, *(c.means.numpy().astype(np.float64) for c in placed)])
    space = light.occupancy(solid, step=0.06)
    bright = light.bake(samples.xyz, samples.normal, space, sun)
    bright = np.where(bright < SOFT, SOFT - SHADE * (SOFT - bright), bright)
    bright = np.where(samples.normal[:, 2] > 0.9, 0.84 * bright, 0.86 + 0.3 * (bright - 0.85))
    structure = flat_gaussians(samples, surface.albedo(shell, samples) * bright[:, None])
    clouds, ids, start = [structure], [torch.full((len(structure),), STRUCTURE, dtype=torch.int32)], len(structure)
    for i, cloud in enumerate(placed):
        clouds.append(cloud.replace(ids=torch.arange(start, start + len(cloud))))
        ids.append(torch.full((len(cloud),), i, dtype=torch.int32))
        start += len(cloud)
    truth = Truth(torch.cat(ids), tuple(_describe(i, t) for i, t in enumerate(layout.things)))
    frame = Frame((0.0, 0.0, 1.0), 0.0, 1.0, "given", "given")
    scene = Scene(concat(clouds), frame, _cameras(layout))
    return Room(scene, truth, name, (layout.w, layout.d, layout.h))


def _stand(thing: Placed, sun: Array) -> GaussianCloud:
    """The asset under the room's lamp, turned and moved to its place."""
    a, b = thing.asset, thing.box
    c, s = math.cos(math.radians(b.yaw)), math.sin(math.radians(b.yaw))
    local = (float(c * sun[0] + s * sun[1]), float(-s * sun[0] + c * sun[1]), float(sun[2]))
    cloud = a.relit(local)
    turn = torch.tensor([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]], dtype=torch.float32)
    means = cloud.means @ turn.T + torch.tensor([b.x, b.y, b.z])
    half = math.radians(b.yaw) / 2
    qw, qz = math.cos(half), math.sin(half)
    w, x, y, z = cloud.quats.unbind(1)
    quats = torch.stack([qw * w - qz * z, qw * x - qz * y, qw * y + qz * x, qw * z + qz * w], dim=1)
    return cloud.replace(means=means, quats=quats)


def _describe(index: int, thing: Placed) -> TruthObject:
    b = thing.box
    return TruthObject(
        id=index,
        kind=thing.asset.kind,
        color=thing.asset.color,
        size=(b.w, b.d, b.h),
        position=(b.x, b.y, b.z + b.h / 2),
        yaw=(b.yaw + 180) % 360 - 180,
        support=thing.support,
        parts=thing.asset.parts.names,
    )


def _cameras(layout: Layout) -> tuple[Camera, ...]:
    """An overview first (from beyond the open side where there is one), then the clearest eye-height views."""
    w, d, h = layout.w, layout.d, layout.h
    ring = [(math.cos(a), math.sin(a)) for a in np.linspace(-math.pi / 2, 1.5 * math.pi, 17)[:-1]]
    spots = []
    for cx, cy in ring:
        reach = min(0.5 * w / max(abs(cx), 1e-6), 0.5 * d / max(abs(cy), 1e-6)) - 0.35
        eye = (cx * reach, cy * reach, 1.55)
        spots.append((_clear(layout, eye), eye))
    spots.sort(key=lambda s: -s[0])
    eyes = [spots[0][1]]
    for _, eye in spots[1:]:  # clear ones, apart from each other
        if len(eyes) < 5 and all(math.dist(eye, e) > 0.3 * w for e in eyes):
            eyes.append(eye)
    views = [
        Camera.look_at(e, (-0.4 * e[0], -0.4 * e[1], 0.7), (0, 0, 1), 960, 640, 62.0, f"view {k + 1}")
        for k, e in enumerate(eyes)
    ]
    side = (
        1.0
        if _clear(layout, (0.42 * w, -0.45 * d, h - 0.3)) >= _clear(layout, (-0.42 * w, -0.45 * d, h - 0.3))
        else -1.0
    )
    if "south" in layout.walls:
        eye, target, fov = (side * 0.46 * w, -0.47 * d, h - 0.12), (-side * 0.12 * w, 0.15 * d, 0.4), 70.0
    else:
        eye, target, fov = (side * 0.28 * w, -0.5 * d - 2.1, h + 0.25), (-side * 0.03 * w, 0.02 * d, 0.75), 52.0
    return (Camera.look_at(eye, target, (0, 0, 1), 960, 640, fov, "overview"), *views)


def _clear(layout: Layout, eye: Vec3) -> float:
    """How far one sees from an eye towards the middle, metres, averaged over a fan of rays; -1 inside something."""
    tall = [t.box for t in layout.things if t.support != "wall"]
    if any(_inside(b.grown(0.15), eye) for b in tall):
        return -1.0
    ahead = math.atan2(-eye[1], -eye[0])
    total = 0.0
    for turn in np.radians([-30, -20, -10, 0, 10, 20, 30]):
        for slope in (-0.05, -0.25):
            step, reach = np.array([math.cos(ahead + turn), math.sin(ahead + turn), slope]), 0.1
            while reach < 3.0 and not any(_inside(b, tuple(np.array(eye) + reach * step)) for b in tall):
                reach += 0.2
            total += reach
    return total / 14


def _inside(b: Box, p: Vec3) -> bool:
    local = b.axes @ np.array([p[0] - b.x, p[1] - b.y])
    return bool(abs(local[0]) < b.w / 2 and abs(local[1]) < b.d / 2 and b.z < p[2] < b.z + b.h)

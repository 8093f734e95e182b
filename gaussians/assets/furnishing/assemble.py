"""Assemble a layout into one lit cloud: add floor, walls and ceiling, cut openings, bake light and contact shadows.

Layouts come from `furnish` or from a scene graph.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...camera import Vec3
from ...cloud import GaussianCloud, concat
from ..modeling import light, sampling
from ..modeling.make import COVER, flat_gaussians
from ..modeling.materials import WOODS, Material, Tone
from ..modeling.shapes import Piece, box, boxes, quad
from .layout import Layout, Placed

Array = NDArray[np.float64]
STRUCTURE = -1  # owner of floor, walls and ceiling
SOFT, SHADE = 0.75, 0.4  # contact shadows are weakened: they stay on the floor when the thing that cast them is removed


@dataclass(frozen=True)
class Look:
    """How floor and walls look; fields that are None are drawn at random.

    Attributes:
        floor: "planks", "tiles", "carpet", "plain" or "grass".
        walls: colour of the paint, as `color.parse` takes it.
        cover: standard deviation of their Gaussians over the length of a cell: more closes gaps and blurs texture.
    """

    floor: str | None = None
    walls: str | None = None
    cover: float = COVER


@dataclass(frozen=True, eq=False)
class Raised:
    """A room as Gaussians.

    Attributes:
        cloud: `N` Gaussians, floor, walls and ceiling first, then thing after thing.
        owner: `[N]` int32, index of the thing that each Gaussian belongs to, or `STRUCTURE`.
        faces: name of the face ("floor", "north wall", "ceiling") of each of the structure's Gaussians.
    """

    cloud: GaussianCloud
    owner: Tensor
    faces: NDArray[np.str_]


def raised(layout: Layout, rng: np.random.Generator, detail: float, ceiling: bool, look: Look = Look()) -> Raised:
    """The layout as one cloud, lit together; `rng` chooses the light and the surfaces that `look` leaves open."""
    azimuth = float(rng.uniform(0, 2 * math.pi))
    sun = np.array([0.6 * math.cos(azimuth), 0.6 * math.sin(azimuth), 0.8])
    shell = _shell(layout, rng, ceiling, look)
    samples = _cut_openings(sampling.sample(shell, 0.062 / math.sqrt(detail)), layout)
    placed = [_placed_cloud(t, sun) for t in layout.things]
    solid = np.concatenate([samples.xyz, *(c.means.numpy().astype(np.float64) for c in placed)])
    space = light.occupancy(solid, step=0.06)
    bright = light.bake(samples.xyz, samples.normal, space, sun)
    bright = np.where(bright < SOFT, SOFT - SHADE * (SOFT - bright), bright)
    bright = np.where(samples.normal[:, 2] > 0.9, 0.84 * bright, 0.86 + 0.3 * (bright - 0.85))
    structure = flat_gaussians(samples, sampling.albedo(shell, samples) * bright[:, None], look.cover)
    clouds, ids, start = [structure], [torch.full((len(structure),), STRUCTURE, dtype=torch.int32)], len(structure)
    for i, cloud in enumerate(placed):
        clouds.append(cloud.replace(ids=torch.arange(start, start + len(cloud))))
        ids.append(torch.full((len(cloud),), i, dtype=torch.int32))
        start += len(cloud)
    return Raised(concat(clouds), torch.cat(ids), np.array(_faces(shell))[samples.piece])


def _faces(shell: list[Piece]) -> list[str]:
    """The face that each piece belongs to; a skirting board belongs to the wall before it in the list."""
    faces: list[str] = []
    for piece in shell:
        faces.append(faces[-1] if piece.part == "skirting" else piece.part)
    return faces


def _placed_cloud(thing: Placed, sun: Array) -> GaussianCloud:
    """The asset under the light of the room, turned and moved to its place."""
    a, b = thing.asset, thing.box
    c, s = math.cos(math.radians(b.yaw)), math.sin(math.radians(b.yaw))
    local = (float(c * sun[0] + s * sun[1]), float(-s * sun[0] + c * sun[1]), float(sun[2]))
    cloud = a.relit(local)
    turn = torch.tensor([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]], dtype=torch.float32)
    means = cloud.means @ turn.T + torch.tensor([b.x, b.y, b.low])
    half = math.radians(b.yaw) / 2
    qw, qz = math.cos(half), math.sin(half)
    w, x, y, z = cloud.quats.unbind(1)
    quats = torch.stack([qw * w - qz * z, qw * x - qz * y, qw * y + qz * x, qw * z + qz * w], dim=1)
    return cloud.replace(means=means, quats=quats)


def _shell(layout: Layout, rng: np.random.Generator, ceiling: bool, look: Look) -> list[Piece]:
    """Floor, walls with skirting boards, and a ceiling if there is to be one."""
    tone = Tone(rng, "light")
    w, d, h = layout.w, layout.d, layout.h
    drawn = str(rng.choice(["planks", "planks", "tiles", "carpet", "plain"]))
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
        "grass": Material((0.36, 0.5, 0.24), "weave", scale=0.3),
    }[look.floor or drawn]
    paint = tone.plain(
        str(rng.choice(["#ece7dc", "#dfe4e6", "#e6dccb", "#d5dfd6", "#e9dcd7", "#cfd8e2", "#f0ece4", "#d9cdbb"])),
        "flat",
    )
    striped = rng.random() < 0.2
    if look.walls is not None:
        paint = tone.plain(look.walls, "flat")
    elif striped:
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
    """The floor in rectangles, finer under rugs, as large Gaussians just below a thin sheet show through it."""
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
    from ... import color

    a, b = table[int(rng.integers(len(table)))]
    return color.parse(a), "tiles", color.parse(b)


def _cut_openings(samples: sampling.Samples, layout: Layout) -> sampling.Samples:
    """Remove the samples of walls behind windows and doors."""
    keep = np.ones(len(samples.xyz), dtype=bool)
    for t in layout.things:
        if t.asset.kind in ("window", "door"):
            low = t.box.low if t.asset.kind == "door" else t.box.low + 0.06
            local = (samples.xyz[:, :2] - np.array([t.box.x, t.box.y])) @ t.box.axes.T
            inside = (np.abs(local[:, 0]) < t.box.w / 2 - 0.06) & (np.abs(local[:, 1]) < t.box.d / 2 + 0.03)
            keep &= ~(inside & (samples.xyz[:, 2] > low) & (samples.xyz[:, 2] < t.box.high - 0.03))
    return samples[keep]

"""Render the training images: procedural assets, intact and damaged, each alone from several sides, as crops.

The crop is the one that embedding uses. A set is a function of its seeds and is cached in a folder outside the
repository.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from ..gaussians import assets
from ..gaussians.camera import Camera
from ..gaussians.cloud import GaussianCloud
from ..gaussians.language.encoders.framing import square_rgba
from ..gaussians.language.segmentation import group_renders
from ..gaussians.render import render
from ..gaussians.world import kinds as world
from . import damage, restyle
from .captions import FLOOR, PART, SEVERAL, WALL

CROP = 80  # px, side of the stored crops: a quarter more than the encoder's input, room for augmentation
CANVAS = 112  # px, side of the renders that crops are cut from
VIEWS = 4  # per object
STRETCH = 0.15  # standard deviation of the logarithm of the stretch of an axis
VERSION = 4  # of the settings in this file; part of the cache key

DRAWN_AS_ANOTHER = ("wall shelf",)  # no builder of its own, but other artists' objects that show it
Report = Callable[[str], None]
WHOLE, DAMAGED, NONE = "whole", "damaged", "not an object"
# A piece of these looks like a whole one, so it is no example of an incomplete object.
SELF_SIMILAR = frozenset(
    {
        *("rug", "painting", "mirror", "window", "curtain", "door", "plate", "bowl", "candle", "ball", "box"),
        *("book", "books", "pillow", "cushion", "blanket"),
    }
)


@dataclass(frozen=True)
class Thing:
    """An object to render: its cloud, label, state (`WHOLE`, `DAMAGED` or `NONE`), seed and support."""

    cloud: GaussianCloud
    label: str
    state: str
    seed: int
    against_wall: bool = False
    support: str = "floor"


@dataclass(frozen=True, eq=False)
class Crops:
    """`M` objects seen from `V` sides.

    Attributes:
        pixels: `[M, V, S, S, 4]` uint8, premultiplied RGB and alpha.
        labels: `[M]` kind or non-object.
        states: `[M]` whole, damaged or not an object.
        seeds: `[M]` of the asset.
        sizes: `[M, 3]` float32, extents w, d, h in metres.
    """

    pixels: NDArray[np.uint8]
    labels: NDArray[np.str_]
    states: NDArray[np.str_]
    seeds: NDArray[np.int64]
    sizes: NDArray[np.float32]

    def __len__(self) -> int:
        return len(self.labels)


def cached(name: str, key: str, things: Callable[[], Iterator[Thing]], cache: Path, report: Report) -> Crops:
    """The pictures of some things, read from the cache or rendered and stored there.

    Args:
        key: of everything that the things depend on.
        things: makes them, if they are not in the cache.
    """
    stamp = hashlib.sha256(json.dumps([VERSION, CROP, VIEWS, key]).encode()).hexdigest()[:16]
    folder = cache / f"crops-{name}-{stamp}"
    if not (folder / "labels.npz").is_file():
        render_set(things(), folder, report)
    with np.load(folder / "labels.npz") as file:
        columns = {k: file[k] for k in ("labels", "states", "seeds", "sizes")}
    shape = (len(columns["labels"]), VIEWS, CROP, CROP, 4)
    return Crops(np.memmap(folder / "pixels.raw", dtype=np.uint8, mode="r", shape=shape), **columns)


def render_set(things: Iterator[Thing], folder: Path, report: Report = lambda line: None) -> None:
    """Render every thing; `pixels.raw` and `labels.npz` are written to `folder`, the latter last."""
    folder.mkdir(parents=True, exist_ok=True)
    kept: list[Thing] = []
    sizes: list[NDArray[np.float64]] = []
    with (folder / "pixels.raw").open("wb") as file:
        for thing in things:
            seen = pictures(thing, np.random.default_rng([thing.seed, len(kept)]))
            if seen is None:
                continue
            low, high = damage.extent(thing.cloud)
            seen.tofile(file)
            sizes.append(high - low)
            kept.append(replace(thing, cloud=GaussianCloud.empty()))
            if len(kept) % 500 == 0:
                report(f"rendered {len(kept)} things")
    columns: dict[str, Any] = {
        "labels": np.array([t.label for t in kept]),
        "states": np.array([t.state for t in kept]),
        "seeds": np.array([t.seed for t in kept], dtype=np.int64),
        "sizes": np.array(sizes, dtype=np.float32),
    }
    np.savez(folder / "labels.npz", **columns)


def joined(parts: Sequence[Crops]) -> Crops:
    """Several sets as one, in memory."""
    names = ("pixels", "labels", "states", "seeds", "sizes")
    return Crops(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def digest(kinds: tuple[str, ...], seeds: range) -> str:
    """Changes with the kinds, the seeds, and the design of any kind."""
    key = hashlib.sha256(json.dumps([list(kinds), list(seeds)]).encode())
    for kind in kinds:
        key.update(assets.make(kind, seeds[0]).cloud.digest().encode())
    return key.hexdigest()


def shown_kinds() -> tuple[str, ...]:
    """The kinds of the world table that are rendered and trained under their own names, sorted."""
    return tuple(sorted({*DRAWN_AS_ANOTHER, *(k.name for k in world.table().kinds.values() if k.shown)}))


def drawn_kinds() -> tuple[str, ...]:
    """What is rendered for them: those kinds, and kinds that are drawn of their own and pass for one of them."""
    shown = shown_kinds()
    alike = (k for k in assets.kinds() if k not in shown and set(world.table().kinds[k].alike) & set(shown))
    return (*shown, *alike)


def label_of(kind: str) -> str:
    """The label of a drawn kind: its own name, or that of the kind it passes for."""
    entry = world.table().kinds[kind]
    return kind if kind in shown_kinds() else next(k for k in entry.alike if world.table().kinds[k].shown)


def things_of_seeds(kinds: tuple[str, ...], seeds: range, varied: float) -> Iterator[Thing]:
    """`things_of_seed` for every seed."""
    for seed in seeds:
        yield from things_of_seed(kinds, seed, varied)


def things_of_seed(kinds: tuple[str, ...], seed: int, varied: float = 0.0) -> Iterator[Thing]:
    """One object of each kind, whole and damaged, pieces and heaps of objects, and patches of wall and floor.

    Args:
        varied: share of the objects with other colours, patterns, light and forms than our assets have.
    """
    rng = np.random.default_rng([seed, 7])
    made = {kind: _design(kind, seed, rng, varied) for kind in kinds}
    for kind in kinds:
        asset, entry = made[kind], world.table().kinds[kind]
        hang = (entry.backed or entry.support == "wall", str(entry.support))
        label = label_of(kind)
        yield Thing(asset.cloud, label, WHOLE, seed, *hang)
        yield Thing(damaged(asset.cloud, made[kinds[rng.integers(len(kinds))]].cloud, rng), label, DAMAGED, seed, *hang)
        if rng.random() < 0.4 and (piece := fragment(asset, rng)) is not None:
            yield Thing(piece, PART, NONE, seed)
        if rng.random() < 0.35:
            others = [made[kinds[i]].cloud for i in rng.integers(len(kinds), size=rng.choice([1, 1, 2]))]
            yield Thing(damage.several([asset.cloud, *others], rng), SEVERAL, NONE, seed)
    for upright in (True, True, False, False):
        width, height = rng.uniform(0.3, 3.0, size=2)
        patch = damage.slab(rng, width, height, upright)
        yield Thing(patch, WALL if upright else FLOOR, NONE, seed, upright, "wall" if upright else "floor")


def _design(kind: str, seed: int, rng: np.random.Generator, varied: float) -> assets.Asset:
    """One design; half of them are stretched along each axis, since real proportions vary more than ours."""
    detail = float(rng.choice([0.4, 0.7, 1.0]))
    stretch = np.exp(rng.normal(size=3) * STRETCH)
    asset = assets.make(kind, seed, detail=detail)
    if rng.random() < varied:
        return restyle.with_cloud(asset, restyle.restyled(restyle.of_asset(asset), rng))
    if rng.random() < 0.5:
        return asset
    w, d, h = (max(0.006, s * f) for s, f in zip(asset.size, stretch.tolist(), strict=True))
    return assets.make(kind, seed, size=(w, d, h), detail=detail)


def damaged(cloud: GaussianCloud, neighbour: GaussianCloud, rng: np.random.Generator) -> GaussianCloud:
    """Apply one to three kinds of damage that leave the object recognisable."""
    result = cloud
    for damage_kind in rng.permutation(7)[: rng.choice([1, 2, 3], p=[0.4, 0.4, 0.2])]:
        if damage_kind == 0:  # cut by a plane from any side
            result = damage.cut(result, rng, rng.uniform(0.68, 0.92))
        elif damage_kind == 1:  # the back was never seen: it faces +y
            back = damage.direction(rng, level=True)
            result = damage.cut(result, rng, rng.uniform(0.6, 0.9), np.array([back[0], abs(back[1]), 0.0]))
        elif damage_kind == 2:  # the underside was taken for floor
            result = damage.cut(result, rng, rng.uniform(0.75, 0.95), np.array([0.0, 0.0, -1.0]))
        elif damage_kind == 3:
            result = damage.thinned(result, rng, rng.uniform(0.0, 0.85))
        elif damage_kind == 4:
            result = damage.with_residue(result, rng)
        elif damage_kind == 5:
            result = restyle.as_fitted(result, rng)
        else:
            result = damage.with_fragment(result, neighbour, rng)
    return result


def fragment(asset: assets.Asset, rng: np.random.Generator) -> GaussianCloud | None:
    """A piece that is clearly incomplete: a small part, or the rest after two cuts; None for simple objects."""
    cloud = asset.cloud
    part = asset.parts.labels.numpy()
    small = [p for p in np.unique(part) if 30 < (part == p).sum() < 0.35 * len(part)]
    if small and rng.random() < 0.6:
        return cloud[torch.from_numpy(part == small[rng.integers(len(small))])]
    if asset.kind in SELF_SIMILAR:
        return None
    keep = rng.uniform(0.12, 0.35)
    first = rng.uniform(keep, 1.0) if rng.random() < 0.5 else 1.0
    piece = damage.cut(cloud, rng, first) if first < 1 else cloud
    piece = damage.cut(piece, rng, keep / first)
    return piece if len(piece) > 30 else None


def pictures(thing: Thing, rng: np.random.Generator) -> NDArray[np.uint8] | None:
    """`[V, S, S, 4]` uint8 crops from `VIEWS` cameras around the object; None if one of them is empty."""
    views = []
    for camera in cameras(thing, rng):
        seen = render(thing.cloud, camera)
        rgba = square_rgba(seen.rgb, seen.alpha, CROP)
        if rgba is None:
            return None
        views.append((rgba.movedim(0, -1) * 255 + 0.5).to(torch.uint8).numpy())
    return np.stack(views)


def cameras(thing: Thing, rng: np.random.Generator) -> list[Camera]:
    """Cameras around the object: for half of the objects as in the embedding of a scene, for the others at random."""
    low, high = damage.extent(thing.cloud)
    middle, size = (low + high) / 2, high - low
    radius = float(np.linalg.norm(size)) / 2
    result = []
    for azimuth, elevation, fov in (
        _embedding_views(thing, rng) if rng.random() < 0.5 else _free_views(thing, rng, size)
    ):
        distance = radius / math.sin(fov / 2) * rng.uniform(0.85, 1.3)
        ground = math.cos(elevation)
        eye = middle + distance * np.array(
            [ground * math.sin(azimuth), -ground * math.cos(azimuth), math.sin(elevation)]
        )
        up = np.array([rng.normal() * 0.04, rng.normal() * 0.04, 1.0])
        result.append(Camera.look_at(eye, middle, up, CANVAS, CANVAS, math.degrees(fov)))
    return result


def _embedding_views(thing: Thing, rng: np.random.Generator) -> list[tuple[float, float, float]]:
    """Azimuth from the front (-y), elevation and field of view, radians, close to those of `group_renders`:
    the front of objects against a wall and any side of the others."""
    front = rng.normal() * 0.35 if thing.against_wall else rng.uniform(0, 2 * math.pi)
    jitter = rng.normal(size=(VIEWS, 2)) * 0.12
    angles = itertools.islice(itertools.cycle(group_renders.VIEW_ANGLES), VIEWS)
    return [
        (front + math.radians(a) + da, math.radians(e) + de, math.radians(group_renders.FOV))
        for (a, e), (da, de) in zip(angles, jitter, strict=True)
    ]


def _free_views(thing: Thing, rng: np.random.Generator, size: NDArray[np.float64]) -> list[tuple[float, float, float]]:
    """The same three numbers at random, within 75 degrees of the front for most objects against a wall."""
    flat = bool(size[2] < 0.15 * max(size[0], size[1]))
    start, step = rng.uniform(0, 2 * math.pi), math.radians(rng.uniform(25, 90))
    result = []
    for i in range(VIEWS):
        azimuth = start + i * step + rng.normal() * 0.15
        if thing.against_wall and rng.random() < 0.92:
            azimuth = math.radians(rng.uniform(-75, 75))
        elevation = math.radians(_elevation(rng, thing.support, flat))
        result.append((azimuth, elevation, math.radians(rng.uniform(25, 60))))
    return result


def _elevation(rng: np.random.Generator, support: str, flat: bool) -> float:
    """Degrees above the horizon from which such an object is usually seen."""
    if flat and support != "wall":
        return float(rng.uniform(14, 70))
    if support == "ceiling":
        return float(rng.uniform(-45, 15))
    if support == "wall":
        return float(np.clip(rng.normal(3, 12), -25, 35))
    return float(np.clip(rng.normal(20, 15), -10, 65))


def cache_folder() -> Path:
    """Where rendered sets are kept: `$XDG_CACHE_HOME/scenewright`, by default `~/.cache/scenewright`."""
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "scenewright" / "encoder"

"""Make the training pictures in shards and keep them in a folder outside of the repository; read them back as arrays.

A shard is a function of its seed, so any number of processes may make them.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, fields
from functools import cache
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from . import shading, solids, splats, textures, worlds
from .shading import HEIGHT, WIDTH, Shot

SHARD = 32  # pictures
VIEWS = 4  # pictures of one world, each with its own materials and light
SPLAT_SHARE = 0.1  # of the shards: rooms of Gaussians, drawn by the renderer that users have
_SOURCES = ("raster", "textures", "solids", "materials", "worlds", "shading", "splats", "dataset")


@dataclass(frozen=True, eq=False)
class Pictures:
    """`N` pictures.

    Attributes:
        picture: `[N, H, W, 3]` uint8.
        things: `[N, H, W]` uint8, number of the thing that a pixel shows, 0 the void; see `worlds`.
        inverse: `[N, H, W]` float16, inverse depth, 1/m, 0 where unknown.
        focal: `[N]` float32, pixels.
    """

    picture: NDArray[np.uint8]
    things: NDArray[np.uint8]
    inverse: NDArray[np.float16]
    focal: NDArray[np.float32]

    def __len__(self) -> int:
        return len(self.picture)


def stacked(shots: Sequence[Shot]) -> Pictures:
    """Shots as arrays."""
    return Pictures(
        np.stack([s.picture for s in shots]),
        np.stack([s.things for s in shots]),
        np.stack([s.inverse for s in shots]),
        np.array([s.focal for s in shots], np.float32),
    )


def joined(parts: Sequence[Pictures]) -> Pictures:
    """One set of several."""
    return Pictures(*(np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Pictures)))


@cache
def _pool(meshes: Path | None, held_out: bool) -> tuple[tuple[solids.Solid, ...], NDArray[np.float32]]:
    """Objects to place and prints to put on them. Every tenth foreign object is kept for measurement."""
    rng = np.random.default_rng(99 if held_out else 1)
    foreign = solids.foreign(meshes) if meshes is not None else []
    chosen = [s for i, s in enumerate(foreign) if (i % 10 == 0) == held_out]
    return worlds.pool_of(chosen, rng), textures.random_prints(rng)


def make_shard(seed: int, number: int, meshes: Path | None, held_out: bool = False) -> Pictures:
    """`SHARD` pictures; the same arguments give the same bytes."""
    rng = np.random.default_rng([seed, number, int(held_out)])
    shots: list[Shot] = []
    if rng.random() < SPLAT_SHARE:
        while len(shots) < SHARD:
            shots += splats.shots(rng, VIEWS * 2)
        return stacked(shots[:SHARD])
    pool, prints = _pool(meshes, held_out)
    while len(shots) < SHARD:
        _, world = worlds.make(rng, pool)
        views = SHARD - len(shots) if len(shots) + VIEWS > SHARD and shots else VIEWS
        tries = (shading.photograph(world, rng, prints) for _ in range(2 * views))
        found = [s for s in tries if s is not None]
        shots += found[:views]
    return stacked(shots)


def _write(path: Path, seed: int, number: int, meshes: Path | None, held_out: bool) -> Path:
    shard = make_shard(seed, number, meshes, held_out)
    partial = path.with_name(f".{path.name}.{os.getpid()}.npz")
    np.savez(partial, **vars(shard))
    partial.replace(path)
    return path


def folder(cache_folder: Path, seed: int, held_out: bool) -> Path:
    """Where the shards of a seed are kept: its name holds a digest of the sources that they depend on."""
    digest = hashlib.sha256()
    for name in _SOURCES:
        digest.update((Path(__file__).parent / f"{name}.py").read_bytes())
    name = "held-out" if held_out else "train"
    return cache_folder / f"contours-{name}-{seed}-{WIDTH}x{HEIGHT}-{digest.hexdigest()[:12]}"


def cached(
    count: int, seed: int, meshes: Path | None, where: Path, workers: int, report: Callable[[str], None]
) -> list[Path]:
    """Files of the first `count` shards in the folder `where`; those that are missing are made."""
    held_out = "held-out" in where.name
    where.mkdir(parents=True, exist_ok=True)
    paths = [where / f"shard-{number:05d}.npz" for number in range(count)]
    missing = [(n, p) for n, p in enumerate(paths) if not p.is_file()]
    if missing:
        with ProcessPoolExecutor(max(1, workers), mp_context=get_context("spawn")) as pool:
            jobs = [pool.submit(_write, p, seed, n, meshes, held_out) for n, p in missing]
            for done, job in enumerate(as_completed(jobs)):
                job.result()
                if done % 5 == 4 or done + 1 == len(jobs):
                    report(f"made {done + 1} of {len(jobs)} shards of {SHARD} pictures")
    return paths


def read(paths: Sequence[Path]) -> Pictures:
    """All pictures of some shards."""
    parts = []
    for path in paths:
        with np.load(path) as file:
            parts.append(Pictures(**{f.name: file[f.name] for f in fields(Pictures)}))
    return joined(parts)

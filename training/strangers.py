"""Objects by other artists for training: meshes with their names, and variants of them as Gaussians.

A folder of such objects holds GLB files and `index.json`, which names each file's object, artist, pack, licence and
longest side. `strangers.json` says which label each name trains, and which packs are held out: a pack is learnt from,
calibrates, or measures, never two of them.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..gaussians.assets.modeling import imported
from ..gaussians.assets.modeling.sampling import Samples
from ..gaussians.cloud import GaussianCloud
from ..gaussians.world import kinds
from . import damage, restyle
from .captions import PART, SEVERAL
from .renders import DAMAGED, NONE, WHOLE, Thing, damaged

Array = NDArray[np.float64]
Use = Literal["train", "calibrate", "measure"]
UNNAMED = "unnamed"  # label of objects that no name of the vocabulary fits; they are not trained on
_COVER = 0.75  # standard deviation of a Gaussian over the distance of samples, which fall at random


@dataclass(frozen=True)
class Table:
    """What `strangers.json` holds.

    Attributes:
        kinds: label to the names of the objects that show it.
        also: further words for labels that are no kinds of the world table.
        calibrate, measure: packs that are held out for the calibration and for the measurement.
    """

    kinds: dict[str, list[str]]
    also: dict[str, list[str]]
    calibrate: list[str]
    measure: list[str]

    def label(self, name: str) -> str:
        """The label of an object's name, `UNNAMED` if it has none."""
        return next((label for label, names in self.kinds.items() if name in names), UNNAMED)


@dataclass(frozen=True)
class Stranger:
    """One object: its file, name, label, pack, artist, licence, and longest side in metres."""

    path: Path
    name: str
    label: str
    pack: str
    artist: str
    licence: str
    size: float


@cache
def table() -> Table:
    """The table of labels and packs."""
    return Table(**json.loads(Path(__file__).with_name("strangers.json").read_text(encoding="utf-8")))


def listed(folder: Path, use: Use | None = None) -> list[Stranger]:
    """The objects of a folder, all or those of one use, in the order of its index.

    Raises:
        OSError: the folder has no index.
    """
    found = [
        Stranger(
            folder / e["file"], e["name"], table().label(e["name"]), e["pack"], e["artist"], e["licence"], e["size_m"]
        )
        for e in json.loads((folder / "index.json").read_text(encoding="utf-8"))
    ]
    return [s for s in found if use is None or use_of(s) == use]


def trained(folder: Path) -> int:
    """The number of objects of a folder that are trained on."""
    return sum(s.label != UNNAMED for s in listed(folder, "train"))


def use_of(stranger: Stranger) -> Use:
    """What an object is used for, by its pack."""
    if stranger.pack in table().calibrate:
        return "calibrate"
    return "measure" if stranger.pack in table().measure else "train"


def surface(stranger: Stranger, share: float = 1.0) -> restyle.Surface:
    """The object's surface with its textures, z up, front -y, standing on z = 0, in metres.

    Args:
        share: of the samples that are kept.
    """
    xyz, normal, rgb, area = _read(stranger.path)
    keep = slice(None, max(200, round(share * len(xyz))))  # samples of one mesh fall at random within the mesh
    xyz, normal, rgb = (column[_shuffled(len(xyz))][keep] for column in (xyz, normal, rgb))
    low, high = xyz.min(axis=0), xyz.max(axis=0)
    gain = stranger.size / max(1e-9, float((high - low).max()))
    xyz = (xyz - np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])) * gain
    side = np.full((len(xyz), 2), np.sqrt(area * gain**2 / len(xyz)))
    nothing = np.zeros(len(xyz), dtype=np.int64)
    samples = Samples(xyz, imported.frames(normal), side, np.zeros((len(xyz), 2)), nothing)
    _, part = np.unique(np.round(rgb * 7).astype(np.int64) @ (64, 8, 1), return_inverse=True)
    return restyle.Surface(samples, rgb, part.reshape(-1).astype(np.int64), np.ones(len(xyz), dtype=np.bool_))


@cache
def _read(path: Path) -> tuple[Array, Array, Array, float]:
    """Samples, unit normals and colours of a mesh, z up, and its area."""
    xyz, normal, rgb, area = imported.surface(path)
    turn = imported.FROM_Y_UP
    normal = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    return xyz @ turn.T, normal @ turn.T, rgb, area


@cache
def _shuffled(count: int) -> NDArray[np.int64]:
    return np.random.default_rng(count).permutation(count)


def plain(stranger: Stranger) -> GaussianCloud:
    """The object as it is, lit as our assets are."""
    found = surface(stranger)
    bright = restyle.baked(found.samples, found.two_sided)
    return restyle.flat(found, bright, _COVER)


def things(strangers: list[Stranger], variants: int, seed: int, unchanged: bool = False) -> Iterator[Thing]:
    """Variants of each object, whole and damaged, and some pieces and heaps of them.

    Args:
        unchanged: whether the objects keep their forms and colours.
    """
    clouds: list[GaussianCloud] = []
    for number in range(variants):
        for index, stranger in enumerate(strangers):
            rng = np.random.default_rng([seed, number, index, 11])
            cloud = plain(stranger) if unchanged else _variant(stranger, rng)
            kind = kinds.table().kinds.get(stranger.label)
            hang = (kind is not None and (kind.backed or kind.support == "wall"), kind.support if kind else "floor")
            yield Thing(cloud, stranger.label, WHOLE, seed + number, *hang)
            clouds = [*clouds[-40:], cloud]
            other = clouds[rng.integers(len(clouds))]
            if rng.random() < 0.8:
                yield Thing(damaged(cloud, other, rng), stranger.label, DAMAGED, seed + number, *hang)
            if rng.random() < 0.12:
                piece = damage.cut(damage.cut(cloud, rng, rng.uniform(0.4, 0.7)), rng, rng.uniform(0.3, 0.6))
                yield Thing(piece, PART, NONE, seed + number)
            if rng.random() < 0.15:
                yield Thing(damage.several([cloud, other], rng), SEVERAL, NONE, seed + number)


def seen(stranger: Stranger, rng: np.random.Generator) -> GaussianCloud:
    """The object as it is or, for half of the draws, a variant of it."""
    return plain(stranger) if rng.random() < 0.5 else _variant(stranger, rng)


def _variant(stranger: Stranger, rng: np.random.Generator) -> GaussianCloud:
    """The object with fewer samples, another form, colours and light, for a third of the draws with its own."""
    found = surface(stranger, float(rng.choice([0.2, 0.45, 1.0])))
    cover = _COVER * rng.uniform(0.75, 1.25)
    if rng.random() < 0.25:
        return restyle.flat(found, restyle.shading(found.samples, found.two_sided, rng), cover)
    return restyle.restyled(found, rng, cover)


def credits(folder: Path) -> list[dict[str, Any]]:
    """For each pack its artist, licence, use, number of objects and their names, in the order of the index."""
    rows: dict[str, dict[str, Any]] = {}
    for s in listed(folder):
        start = {"pack": s.pack, "artist": s.artist, "licence": s.licence, "use": use_of(s), "count": 0, "names": []}
        row = rows.setdefault(s.pack, start)
        row["count"] += 1
        if s.name not in row["names"]:
            row["names"].append(s.name)
    return list(rows.values())

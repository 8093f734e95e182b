"""Selection by name of 33 meshes of the Kenney furniture kit: the embedded encoder on shapes that it never saw.

The sizes of the meshes are read as metres, as their maker seems to have meant them (a chair is 1 m high, a bed 2.4 m
long).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians import assets
from ...gaussians.assets import Asset, Parts
from ...gaussians.assets.furnishing.layout import Layout
from ...gaussians.assets.modeling.make import Unlit
from ...gaussians.assets.modeling.sampling import Samples
from ...gaussians.cloud import GaussianCloud
from ...gaussians.language.encoders import Encoder
from ...gaussians.language.encoders.probability import probability
from ...training import foreign_meshes
from .._iou import iou
from ..harness import Metric
from . import staged
from .cases import Case, Part, ask

ABSENT = 20  # names of kinds of ours that are not in a room, asked of each
ROOMS = 6
WIDER = 1.5  # on the splats of a mesh, whose samples fall at random: a trained surface has no holes
# The accepted names of each mesh, the plainest first; the query uses the first that the encoder knows.
NAMES: dict[str, tuple[str, ...]] = {
    "bathroomCabinetDrawer": ("cabinet", "sink", "dresser"), "bathroomSink": ("sink",), "bear": ("bear", "teddy bear"),
    "bedSingle": ("bed",), "benchCushionLow": ("bench", "ottoman"), "bookcaseOpenLow": ("bookcase", "bookshelf"),
    "cabinetBedDrawerTable": ("nightstand", "side table", "cabinet", "dresser"), "chair": ("chair",),
    "chairModernCushion": ("chair",), "chairRounded": ("chair",), "desk": ("desk",),
    "dryer": ("dryer", "washing machine"), "kitchenBlender": ("blender",), "kitchenCabinetCornerInner": ("cabinet",),
    "kitchenFridge": ("fridge",), "kitchenMicrowave": ("microwave",), "kitchenStove": ("stove",),
    "lampRoundTable": ("table lamp", "lamp"), "lampSquareTable": ("table lamp", "lamp"),
    "loungeChair": ("lounge chair", "armchair"), "loungeDesignSofaCorner": ("sofa",), "loungeSofaCorner": ("sofa",),
    "plant": ("plant", "potted plant"), "radio": ("radio",), "rugRound": ("rug",), "rugSquare": ("rug",),
    "speaker": ("speaker",), "stoolBar": ("stool",), "table": ("table", "dining table", "desk"),
    "tableCoffeeGlassSquare": ("coffee table", "side table", "table"), "televisionModern": ("television", "monitor"),
    "toaster": ("toaster",), "trashcan": ("trashcan", "bin"),
}  # fmt: skip
SMALL = frozenset({"kitchenBlender", "kitchenMicrowave", "lampRoundTable", "lampSquareTable", "radio", "toaster"})


@dataclass(frozen=True, eq=False)
class _AsRead(Unlit):
    """A mesh whose light was baked when it was read, and is not that of the room."""

    lit: GaussianCloud

    def cloud(self, sun: NDArray[np.float64]) -> GaussianCloud:
        return self.lit


def read(path: Path) -> Asset:
    """A mesh as an asset that can be placed; its kind is its file's name."""
    cloud = foreign_meshes.read(path)
    cloud = cloud.replace(scales=cloud.scales * torch.tensor([WIDER, WIDER, 1.0]))
    low, high = cloud.means.amin(dim=0), cloud.means.amax(dim=0)
    w, d, h = (float(v) for v in high - low)
    nothing = Samples(np.zeros((0, 3)), np.zeros((0, 3, 3)), np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0, np.int64))
    count = len(cloud)
    parts = Parts(torch.zeros(count, dtype=torch.int32), ("whole",))
    unlit = _AsRead(nothing, np.zeros((0, 3)), np.zeros(0, bool), cloud)
    return Asset(cloud, path.stem, (w, d, h), "gray", parts, torch.ones(count, dtype=torch.bool), 0, unlit)


def rooms(folder: Path, seed: int) -> list[Case]:
    """All meshes in a few rooms, none with two that share a name; small things stand on what carries them."""
    things = [read(path) for path in sorted(folder.glob("*.glb")) if path.stem in NAMES]
    layouts = [staged.bare("meshes", seed + i) for i in range(ROOMS)]
    order = sorted(things, key=lambda t: (t.kind in SMALL, -t.size[0] * t.size[1], t.kind))
    for thing in order:
        free = [room for room in layouts if not _shares_a_name(room, thing.kind)]
        for room in sorted(free, key=lambda r: len(r.things)):
            if _put(room, thing):
                break
    return [staged.built(room, seed + i) for i, room in enumerate(layouts) if room.things]


def _shares_a_name(room: Layout, stem: str) -> bool:
    return any(set(NAMES[t.asset.kind]) & set(NAMES[stem]) for t in room.things)


def _put(room: Layout, thing: Asset) -> bool:
    carriers = [i for i, t in enumerate(room.things) if 0.4 < t.asset.size[2] < 1.1] if thing.kind in SMALL else []
    if any(room.on_top(thing, i) is not None for i in carriers):
        return True
    return room.anywhere(thing, staged.APART, edge=False) is not None


def spoken(encoder: Encoder, stem: str) -> str | None:
    """The name a mesh is asked by; None if the encoder has the words for none of its names."""
    return next((name for name in NAMES[stem] if encoder.knows(name)), None)


def _vectors(known: Case) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """Vector and size in metres of the best group for each object; `[M, D]`, `[M, 3]`."""
    field = known.scene.language
    assert field is not None
    masks, rows = known.groups(), field.objects()
    best = [rows[int(np.argmax([iou(m, known.truth(o)) for m in masks]))] for o in known.objects]
    return field.embeddings[[g.id for g in best]], np.array([g.box.size for g in best])


def _top(
    encoder: Encoder, stems: Sequence[str], vectors: NDArray[np.float32], sizes: NDArray[np.float64] | None
) -> list[bool]:
    """Whether the likeliest of all the meshes' names is one of a thing's own, for each."""
    names = sorted({name for stem in NAMES if (name := spoken(encoder, stem)) is not None})
    chance = np.stack([probability(encoder, name, vectors, sizes) for name in names], axis=1)
    return [names[int(row.argmax())] in NAMES[stem] for stem, row in zip(stems, chance, strict=True)]


def measure(folder: Path, seed: int, encoder: Encoder, grouped: Callable[[Case], Case], most: int = ROOMS) -> Part:
    """Top-1 over the names, and what asking for each selects, in the first `most` rooms."""
    found: dict[str, float] = {}
    top: list[bool] = []
    sized: list[bool] = []
    refused: list[bool] = []
    for room in rooms(folder, seed)[:most]:
        known = grouped(room)
        vectors, sizes = _vectors(known)
        stems = [o.kind for o in known.objects]
        top += _top(encoder, stems, vectors, None)
        sized += _top(encoder, stems, vectors, sizes)
        for thing in known.objects:
            name = spoken(encoder, thing.kind)
            found[thing.kind] = iou(known.truth(thing), ask(known, name, encoder).mask) if name else 0.0
        there = {name for stem in stems for name in NAMES[stem]}
        covered = {kind for name in there for kind in encoder.vocabulary.covered(name, loose=True)}
        missing = [k for k in assets.kinds(shown=True) if k not in covered]
        asked = np.random.default_rng(room.seed).choice(missing, ABSENT, replace=False)
        refused += [ask(known, str(k), encoder).verdict == "absent" for k in asked]
    unknown = sorted(stem for stem in NAMES if spoken(encoder, stem) is None)
    metrics = (
        Metric("meshes.top1", fmean(top), "share", "higher", 0.1, 0.6),
        Metric("meshes.top1_sized", fmean(sized), "share", "higher", 0.1),
        Metric("meshes.miou", fmean(found.values()), "IoU", "higher", 0.1, 0.6),
        Metric("meshes.asked", len(found), "count"),
        Metric("meshes.absent.refused", fmean(refused), "share", "higher", 0.1),
    )
    lost = ", ".join(f"{stem} {value:.2f}" for stem, value in sorted(found.items()) if value < 0.5)
    notes = (
        f"meshes: {len(found)} of {len(NAMES)} low-poly objects by others in {most} rooms. top1 is over all their "
        "names, by the vector and the measured size of the best group; every mesh counts. Without a name in the "
        f"vocabulary: {', '.join(unknown) or 'none'}. IoU below 0.5: {lost or 'none'}",
    )
    return Part(metrics, notes=notes)

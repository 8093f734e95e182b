"""Vectors of the groups of whole rooms, embedded as a user embeds a scene, with the names of what they show.

Pictures of single things are cleaner than those of groups in rooms: there, things hide each other, stand on others, and
lose or gain pieces by the segmentation. The vectors of labels are therefore fitted on such groups too (`join.py`). The
rooms are furnished ones, half of them with things in other colours, composed ones, fitted ones (`fitted_rooms.py`), and
empty ones in which objects by other artists stand.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from ..gaussians.assets import furnish
from ..gaussians.camera import Vec3
from ..gaussians.cloud import GaussianCloud, concat
from ..gaussians.harmonics import color_to_dc, dc_to_color
from ..gaussians.language.encoders import Encoder
from ..gaussians.language.field.embed import embed
from ..gaussians.language.field.language_field import LanguageField
from ..gaussians.language.segmentation.affinity import merge_tree
from ..gaussians.language.segmentation.group_renders import mean_vectors
from ..gaussians.language.segmentation.segment import (
    VIEWS_PER_CANDIDATE,
    graph_of,
    rendered_nodes,
    rows_of_nodes,
    superpoints_and_structure,
)
from ..gaussians.language.segmentation.settle import settled
from ..gaussians.language.segmentation.superpoints import links_of
from ..gaussians.language.segmentation.surface import surface_of
from ..gaussians.scene import Scene
from ..planners.compose.knowledge import rooms as room_kinds
from . import fitted_rooms, strangers
from .captions import PART, SEVERAL
from .composed_rooms import named_room
from .restyle import color
from .strangers import Stranger

SEEDS = 40_000  # of the first room; no other use has seeds from here on
FURNISHED, COMPOSED = 60, 2  # furnished rooms, and composed rooms of each kind
PURE, WHOLE = 0.8, 0.7  # shares of a group that is one thing, and of the thing that is in the group
MIXED, PIECE = 0.6, 0.4  # below them a group is several things, or part of one
FEW = 30  # Gaussians of the smallest group
STANDING, APART, TRIES = 10, 0.15, 60  # objects by others in a room, metres between them, spots tried for each
LARGEST = 2.6  # metres, longest side of an object by others in a room; larger ones are shrunk
KnownRoom = tuple[Scene, NDArray[np.int32], tuple[str, ...]]
"""A scene without a field, the object of each Gaussian `[N]` or -1 for structure, and the name of each object."""


@dataclass(frozen=True, eq=False)
class RoomGroups:
    """Vectors `[M, F]` of groups and their labels `[M]`: names of the vocabulary, or what is not an object."""

    vectors: NDArray[np.float32]
    labels: tuple[str, ...]


def joined(parts: Sequence[RoomGroups]) -> RoomGroups:
    """All groups of several."""
    return RoomGroups(np.concatenate([p.vectors for p in parts]), tuple(name for p in parts for name in p.labels))


def collect(encoder: Encoder, rooms: Iterable[KnownRoom]) -> RoomGroups:
    """The groups of rooms whose label is in the vocabulary."""
    names = {*encoder.vocabulary.names, *encoder.vocabulary.negatives}
    vectors, labels = [], []
    for scene, objects, kinds_of in rooms:
        field = embed(scene, encoder)
        assert field.language is not None
        for row, label in _labelled(field, field.language, objects, kinds_of):
            if label in names:
                vectors.append(field.language.embeddings[row])
                labels.append(label)
    return RoomGroups(np.array(vectors, np.float32), tuple(labels))


def collect_nodes(encoder: Encoder, rooms: Iterable[KnownRoom]) -> RoomGroups:
    """The regions of rooms that the segmentation has to judge: whole objects, pieces of one, and several together."""
    names = {*encoder.vocabulary.names, *encoder.vocabulary.negatives}
    vectors, labels = [], []
    for scene, objects, kinds_of in rooms:
        clouds, told = _nodes(scene, objects, kinds_of, names)
        middle = scene.cloud.means.median(dim=0).values.double().numpy()
        vectors += list(mean_vectors(encoder, clouds, scene.frame, middle, VIEWS_PER_CANDIDATE))
        labels += told
    return RoomGroups(np.array(vectors, np.float32), tuple(labels))


def _nodes(
    scene: Scene, objects: NDArray[np.int32], kinds_of: tuple[str, ...], names: Collection[str]
) -> tuple[list[GaussianCloud], list[str]]:
    """The Gaussians of each region of a room that is rendered and has a clear label, and that label."""
    surface = settled(surface_of(scene.cloud), scene.cloud, scene.frame)
    links = links_of(surface)
    labels, codes = superpoints_and_structure(surface, links, scene.frame)
    nodes = merge_tree(graph_of(scene.cloud, surface, links, labels, codes, scene.frame), None)
    size = np.bincount(labels, minlength=len(codes))
    points = np.array([sum(int(size[s]) for s in n.members) for n in nodes], dtype=np.int64)
    asked = sorted(set(rendered_nodes(nodes, points).values()))
    total = np.bincount(objects[surface.rows][objects[surface.rows] >= 0], minlength=len(kinds_of))
    clouds, told = [], []
    for rows in rows_of_nodes(surface, labels, [nodes[i] for i in asked]):
        label = _label(objects[rows], total, kinds_of)
        if label in names:
            clouds.append(scene.cloud[torch.from_numpy(rows)])
            told.append(label)
    return clouds, told


def own_rooms(fits: Path | None) -> Iterator[KnownRoom]:
    """Rooms of our own assets.

    Args:
        fits: folder of the fitted rooms; None leaves them out.
    """
    for seed in range(SEEDS, SEEDS + FURNISHED):
        room = furnish(seed)
        objects = room.truth.ids.numpy()
        scene = _colored(room.scene, objects, seed) if seed % 2 else room.scene
        yield scene, objects, tuple(o.kind for o in room.truth.objects)
    for number, name in enumerate(name for name in room_kinds() if name != "room"):
        for seed in range(SEEDS + COMPOSED * number, SEEDS + COMPOSED * (number + 1)):
            yield named_room(name, seed)
    for recipe in fitted_rooms.ROOMS if fits is not None else ():
        assert fits is not None
        yield (*fitted_rooms.fitted_room(recipe, fits), fitted_rooms.names(recipe))


def rooms_of_others(objects: Path) -> Iterator[KnownRoom]:
    """Empty rooms in which every object that is trained on stands once, as it is or with another look."""
    rng = np.random.default_rng(SEEDS)
    named = [s for s in strangers.listed(objects, "train") if s.label != strangers.UNNAMED]
    waiting = [named[i] for i in rng.permutation(len(named))]
    seed = SEEDS
    while waiting:
        room = furnish(seed)
        shell = room.scene.cloud[torch.from_numpy(np.flatnonzero(room.truth.ids.numpy() < 0))]
        held = _stood(waiting, shell, room.size, rng)
        placed = {thing.path for thing, _ in held} or {waiting[0].path}  # the first is too large for any room
        waiting, seed = [s for s in waiting if s.path not in placed], seed + 1
        if held:
            clouds = [shell, *(cloud for _, cloud in held)]
            objects_of = np.concatenate([np.full(len(c), i - 1, np.int32) for i, c in enumerate(clouds)])
            starts = np.cumsum([0, *(len(c) for c in clouds)])
            clouds = [
                c.replace(ids=torch.arange(int(i), int(i) + len(c))) for c, i in zip(clouds, starts, strict=False)
            ]
            yield replace(room.scene, cloud=concat(clouds)), objects_of, tuple(thing.label for thing, _ in held)


def _stood(
    waiting: Sequence[Stranger], shell: GaussianCloud, size: Vec3, rng: np.random.Generator
) -> list[tuple[Stranger, GaussianCloud]]:
    """The next objects that find a free spot on the floor of a room, at most `STANDING`."""
    middle = shell.means.mean(dim=0).numpy()
    taken: list[tuple[float, float, float]] = []
    held = []
    for stranger in waiting[: 2 * STANDING]:
        cloud = strangers.seen(replace(stranger, size=min(stranger.size, LARGEST)), rng)
        reach = float(np.linalg.norm((cloud.means.amax(dim=0) - cloud.means.amin(dim=0))[:2].numpy()) / 2)
        for _ in range(TRIES):
            x, y = (rng.uniform(-1, 1) * max(side / 2 - reach, 0) for side in size[:2])
            if all(np.hypot(x - a, y - b) > reach + r + APART for a, b, r in taken):
                taken.append((x, y, reach))
                offset = torch.tensor([middle[0] + x, middle[1] + y, 0.0], dtype=cloud.means.dtype)
                held.append((stranger, cloud.replace(means=cloud.means + offset)))
                break
        if len(held) == STANDING:
            break
    return held


def _colored(scene: Scene, objects: NDArray[np.int32], seed: int) -> Scene:
    """The room with each thing in one random colour; its brightness varies as before."""
    rng, sh = np.random.default_rng(seed), scene.cloud.sh.clone()
    for thing in range(int(objects.max()) + 1):
        rows = torch.from_numpy(np.flatnonzero(objects == thing))
        old = dc_to_color(sh[rows, 0]).clamp(0, 1)
        bright = old.mean(dim=1, keepdim=True) / old.mean().clamp(min=0.05)
        new = torch.from_numpy(color(rng)).to(old) * bright
        sh[rows, 0] = color_to_dc(new.clamp(0, 1))
    return replace(scene, cloud=scene.cloud.replace(sh=sh))


def _labelled(
    scene: Scene, field: LanguageField, objects: NDArray[np.int32], names: tuple[str, ...]
) -> Iterator[tuple[int, str]]:
    """Rows of the table with the label of each group that is clearly one thing, a piece, or several things."""
    group = scene.cloud.group.numpy()
    total = np.bincount(objects[objects >= 0], minlength=len(names))
    for one in field.objects():
        own = objects[np.isin(group, field.leaves(one.id))]
        if len(own) >= FEW and (label := _label(own, total, names)):
            yield one.id, label


def _label(own: NDArray[np.int32], total: NDArray[np.int64], names: Sequence[str]) -> str:
    """What some Gaussians are by the objects `own [K]` that they belong to; "" if that is not clear.

    Args:
        total: number of Gaussians of each object.
    """
    count = np.bincount(own[own >= 0], minlength=len(names))
    if not count.any():
        return ""
    best = int(count.argmax())
    pure, whole = count[best] / len(own), count[best] / total[best]
    if pure >= PURE:
        return names[best] if whole >= WHOLE else PART if whole < PIECE else ""
    return SEVERAL if pure < MIXED and (count >= PIECE * np.maximum(total, 1)).sum() > 1 else ""

"""From the skin of a cloud to the things it is made of:

superpoints -> floor and walls -> merge tree -> portraits of its nodes -> the best cut into objects -> parts by colour.

Knows the pieces of this room that find borders. Refuses to know queries, and Gaussians off the skin.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ..scene import Frame, Scene
from . import grouping, structure
from .adjacency import build_graph
from .borders import redrawn
from .calibration import wholeness
from .encoders import Encoder
from .field import Level
from .portraits import mean_vectors
from .regions import Graph, Node, merge_tree
from .superpoints import Links, links_of, superpoints, touching
from .surface import Surface

Progress = Callable[[str, float], None]
F64 = NDArray[np.float64]

MIN_OBJECT = 40  # surface points; smaller things are not asked about and not offered
MOST_ASKED = 700  # nodes whose portraits are taken: bounds the time of a messy scene
ASK_VIEWS = 3
MOST_OF_IT = 0.75  # of the surface: a connected body this large, with nothing around it, is likely one scanned thing
ALONE = 4.0  # nats by which it is


@dataclass(frozen=True, eq=False)
class Thing:
    """One group before it becomes a row: which superpoints, under which name, in which object; and its vector where
    something better than pictures of it says what it is."""

    members: tuple[int, ...]
    level: Level
    parent: int = -1
    label: str = ""
    vector: NDArray[np.float32] | None = None


def segment(
    scene: Scene,
    surface: Surface,
    encoder: Encoder,
    progress: Progress = lambda stage, share: None,
    portraits: int = ASK_VIEWS,
) -> tuple[NDArray[np.int32], list[Thing]]:
    """Superpoint of each surface point, and what they make up: structure first, then objects, then their parts."""
    links = links_of(surface)
    labels, kind_of = superpoints_and_structure(surface, links, scene.frame)
    count = len(kind_of)
    nodes = merge_tree(graph_of(surface, links, labels, kind_of, scene.frame))
    size = np.bincount(labels, minlength=count)
    points = np.array([sum(int(size[s]) for s in n.members) for n in nodes], dtype=np.int64)
    evidence = _evidence(scene, surface, labels, nodes, points, encoder, portraits, progress)
    if nodes and not kind_of.any() and points.max() >= MOST_OF_IT * len(surface):
        alone = int(np.flatnonzero(points == points.max())[-1])  # the root: no node above it holds more
        evidence[alone] = evidence.get(alone, 0.0) + ALONE
    objects = [nodes[i].members for i in grouping.best_cut(nodes, points, evidence)]
    total = np.stack([np.bincount(labels, weights=surface.lab[:, c], minlength=count) for c in range(3)], axis=1)
    lab: F64 = total / np.maximum(size, 1)[:, None]
    things = _things(objects, kind_of, lab, size, touching(labels, links))
    return redrawn(surface, labels, _owners(things, count), kind_of != structure.NONE), things


def _owners(things: Sequence[Thing], count: int) -> NDArray[np.int32]:
    """Object or structure `[S]` that each superpoint belongs to, -1 for none."""
    owner = np.full(count, -1, np.int32)
    for i, thing in enumerate(things):
        owner[list(thing.members)] = thing.parent if thing.level == "part" else i
    return owner


def superpoints_and_structure(
    surface: Surface, links: Links, frame: Frame
) -> tuple[NDArray[np.int32], NDArray[np.int8]]:
    """Superpoint of each surface point `[M]`, and what structure each superpoint is `[S]`.

    Superpoints that straddle structure and object become two.
    """
    labels = superpoints(surface, links)
    kinds = structure.structures(surface, labels, frame)
    labels = np.unique(labels.astype(np.int64) * 8 + kinds, return_inverse=True)[1].astype(np.int32)
    kind_of = np.zeros(int(labels.max(initial=-1)) + 1, np.int8)
    kind_of[labels] = kinds
    return labels, kind_of


def graph_of(
    surface: Surface, links: Links, labels: NDArray[np.int32], kind_of: NDArray[np.int8], frame: Frame
) -> Graph:
    """The graph of the superpoints that are no structure, in the level frame."""
    flat = structure.level(surface, frame)
    lab = surface.lab.astype(np.float64)
    return build_graph(labels, flat.points, lab, flat.normals, links, kind_of, surface.spacing)


def _evidence(
    scene: Scene, surface: Surface, labels: NDArray[np.int32], nodes: list[Node], points: NDArray[np.int64],
    encoder: Encoder, portraits: int, progress: Progress,
) -> dict[int, float]:  # fmt: skip
    """Log-odds that a node is one whole thing, by its portraits, for the larger nodes."""
    wanted = [i for i in range(len(nodes)) if points[i] >= MIN_OBJECT]
    same = grouping.alike(nodes, points)
    asked = sorted({int(same[i]) for i in wanted}, key=lambda i: (-points[i], i))[:MOST_ASKED]
    if not asked:
        return {}
    rows = _rows_by_superpoint(surface, labels, int(labels.max(initial=-1)) + 1)
    owned = [np.sort(np.concatenate([rows[s] for s in nodes[i].members])) for i in asked]
    clouds = [scene.cloud[torch.from_numpy(own)] for own in owned]
    middle = np.median(surface.points, axis=0).astype(np.float64)
    vectors = mean_vectors(encoder, clouds, scene.frame, middle, portraits, lambda share: progress("portraits", share))
    whole = np.clip(wholeness(encoder, vectors), 0.001, 0.999)
    odds = {i: float(np.log(w / (1 - w))) for i, w in zip(asked, whole, strict=True)}
    return {i: odds[int(same[i])] for i in wanted if int(same[i]) in odds}


def _rows_by_superpoint(surface: Surface, labels: NDArray[np.int32], count: int) -> list[NDArray[np.int64]]:
    order = np.argsort(labels, kind="stable")
    return np.split(surface.rows[order], np.cumsum(np.bincount(labels, minlength=count))[:-1])


def _things(
    objects: list[tuple[int, ...]], kind_of: NDArray[np.int8], lab: F64, size: NDArray[np.int64],
    near: dict[int, set[int]],
) -> list[Thing]:  # fmt: skip
    things = [
        Thing(tuple(np.flatnonzero(kind_of == kind).tolist()), "structure", label=name)
        for kind, name in structure.NAMES.items()
        if (kind_of == kind).any()
    ]
    large = [m for m in objects if sum(int(size[s]) for s in m) >= MIN_OBJECT]
    for members in sorted(large, key=lambda m: (-sum(int(size[s]) for s in m), m)):
        clusters = grouping.parts_of(members, near, lab, size)
        own = len(things)
        things.append(Thing(members if len(clusters) == 1 else (), "object"))
        if len(clusters) > 1:
            things.extend(Thing(tuple(c), "part", parent=own) for c in clusters)
    return things

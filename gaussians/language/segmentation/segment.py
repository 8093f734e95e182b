"""From the skin of a cloud to the things it is made of:

superpoints -> floor and walls -> merge tree -> portraits of its nodes -> the best cut into objects -> parts by colour.

Knows the pieces of this room that find borders. Refuses to know queries, and Gaussians off the skin.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ...scene import Frame, Scene
from ..encoders import Encoder
from ..encoders.probability import wholeness
from ..field.language_field import Level
from . import grouping, planes, structure
from .adjacency import build_graph
from .affinity import merge_tree
from .borders import redrawn
from .group_renders import mean_vectors
from .regions import Graph, Node
from .superpoints import Links, links_of, superpoints, touching
from .surface import Surface

Progress = Callable[[str, float], None]
F64 = NDArray[np.float64]

MIN_OBJECT = 40  # surface points; smaller things are not asked about and not offered
MOST_ASKED = 700  # nodes whose portraits are taken: bounds the time of a messy scene
ASK_VIEWS = 3
MOST_OF_IT = 0.75  # of the surface: a body this large, with neither floor nor wall around it, is one scanned thing


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
    labels, codes = superpoints_and_structure(surface, links, scene.frame)
    count = len(codes)
    nodes = merge_tree(graph_of(surface, links, labels, codes, scene.frame))
    size = np.bincount(labels, minlength=count)
    points = np.array([sum(int(size[s]) for s in n.members) for n in nodes], dtype=np.int64)
    evidence = _evidence(scene, surface, labels, nodes, points, encoder, portraits, progress)
    alone = None
    if nodes and not codes.any() and points.max() >= MOST_OF_IT * len(surface):
        alone = int(np.flatnonzero(points == points.max())[-1])  # the root: no node above it holds more
    objects = [nodes[i].members for i in grouping.best_cut(nodes, points, evidence, alone)]
    owner = np.where(codes > 0, -1 - codes.astype(np.int32), -1)  # structure below -1, none -1, then the objects
    for number, members in enumerate(objects):
        owner[list(members)] = number
    labels = redrawn(surface, labels, owner, codes > 0)
    owner = _without_crumbs(owner, labels, links)
    return labels, _things(surface, labels, owner, touching(labels, links))


def _without_crumbs(owner: NDArray[np.int32], labels: NDArray[np.int32], links: Links) -> NDArray[np.int32]:
    """Owners `[S]` after pieces of objects too small to be offered went to what they touch most."""
    size = np.bincount(labels, minlength=len(owner))
    held = np.bincount(np.maximum(owner, -1) + 1, weights=size)[1:]
    small = (owner >= 0) & (held[np.maximum(owner, 0)] < MIN_OBJECT) if len(held) else np.zeros(len(owner), bool)
    ends = labels[links.pairs]
    ends = np.concatenate([ends, ends[:, ::-1]])
    ends = ends[small[ends[:, 0]] & ~small[ends[:, 1]] & (owner[ends[:, 1]] != -1)]
    owner = owner.copy()
    beside, before = owner[ends[:, 1]], owner.copy()
    owner[small] = -1
    for crumb in np.unique(before[ends[:, 0]]).tolist():
        things, links_to = np.unique(beside[before[ends[:, 0]] == crumb], return_counts=True)
        owner[before == crumb] = things[int(np.argmax(links_to))]
    return owner


def superpoints_and_structure(
    surface: Surface, links: Links, frame: Frame
) -> tuple[NDArray[np.int32], NDArray[np.int8]]:
    """Superpoint of each surface point `[M]`, and each superpoint's code of structure `[S]`.

    Superpoints that straddle structure and object become two.
    """
    labels = superpoints(surface, links)
    found = structure.structures(surface, labels, frame)
    labels = np.unique(labels.astype(np.int64) * 128 + found, return_inverse=True)[1].astype(np.int32)
    codes = np.zeros(int(labels.max(initial=-1)) + 1, np.int8)
    codes[labels] = found
    return labels, codes


def graph_of(surface: Surface, links: Links, labels: NDArray[np.int32], codes: NDArray[np.int8], frame: Frame) -> Graph:
    """The graph of the superpoints that are no structure, in the level frame."""
    flat = planes.level(surface, frame)
    lab = surface.lab.astype(np.float64)
    kinds = structure.kind_of(codes)
    return build_graph(labels, flat.points, lab, flat.normals, links, kinds, surface.spacing)


def _evidence(
    scene: Scene, surface: Surface, labels: NDArray[np.int32], nodes: list[Node], points: NDArray[np.int64],
    encoder: Encoder, portraits: int, progress: Progress,
) -> dict[int, float]:  # fmt: skip
    """Log-odds that a node is one whole thing, by its portraits, for the larger nodes that geometry leaves open."""
    wanted = [i for i in grouping.in_question(nodes, points) if points[i] >= MIN_OBJECT]
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
    surface: Surface, labels: NDArray[np.int32], owner: NDArray[np.int32], near: dict[int, set[int]]
) -> list[Thing]:
    """Floor, each wall, ceiling; then the objects, largest first, each followed by its parts."""
    count = len(owner)
    size = np.bincount(labels, minlength=count)
    total = np.stack([np.bincount(labels, weights=surface.lab[:, c], minlength=count) for c in range(3)], axis=1)
    lab: F64 = total / np.maximum(size, 1)[:, None]
    codes = sorted({-1 - int(o) for o in owner if o < -1}, key=lambda c: (c % structure.KINDS, c))
    things = [
        Thing(tuple(np.flatnonzero(owner == -1 - c).tolist()), "structure", label=structure.NAMES[c % structure.KINDS])
        for c in codes
    ]
    objects = [tuple(np.flatnonzero(owner == o).tolist()) for o in np.unique(owner[owner >= 0])]
    for members in sorted(objects, key=lambda m: (-sum(int(size[s]) for s in m), m)):
        clusters = grouping.parts_of(members, near, lab, size)
        own = len(things)
        things.append(Thing(members if len(clusters) == 1 else (), "object"))
        if len(clusters) > 1:
            things.extend(Thing(tuple(c), "part", parent=own) for c in clusters)
    return things

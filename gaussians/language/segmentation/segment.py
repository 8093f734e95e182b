"""Segment the surface points of a scene into structure, objects and parts:

superpoints -> floor and walls -> merge tree -> renders of its nodes -> best cut into objects -> refined borders ->
parts by colour.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray

from ...cloud import GaussianCloud
from ...scene import Frame, Scene
from ..encoders import Encoder
from ..encoders.probability import wholeness
from ..field.language_field import Level
from ..masks.lifting import Lifted
from . import grouping, planes, structure
from .adjacency import build_graph
from .affinity import merge_tree
from .borders import refine_borders
from .group_renders import mean_vectors
from .haze import haze_of
from .mask_cuts import dividing, ledger_of, pieces_of, revised_by_masks
from .regions import Graph, Node
from .superpoints import Links, links_of, superpoints, touching
from .surface import Surface

Progress = Callable[[str, float], None]
F64 = NDArray[np.float64]

MIN_OBJECT = 40  # surface points; smaller regions are neither rendered nor kept as objects
MAX_RENDERED = 700  # nodes that are rendered: bounds the time of a cluttered scene
VIEWS_PER_CANDIDATE = 3
SINGLE_OBJECT = 0.75  # of the surface: a region this large in a scene without floor and walls is one scanned object


@dataclass(frozen=True, eq=False)
class Segment:
    """One group before it is measured: structure, an object, or a part of one.

    Attributes:
        members: its superpoints; () for an object that consists of parts.
        level: "structure", "object" or "part".
        parent: index of the object that a part belongs to, -1 for none.
        label: its name, "" if the encoder is to name it.
        vector: `[D]` its embedding where masks give one; None to take that of its renders.
        votes: what detectors called it, see `Group.votes`.
    """

    members: tuple[int, ...]
    level: Level
    parent: int = -1
    label: str = ""
    vector: NDArray[np.float32] | None = None
    votes: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True, eq=False)
class Segmentation:
    """What a surface consists of.

    Attributes:
        labels: `[M]` superpoint of each surface point.
        segments: structure first, then each object and its parts.
        agreement: for each source of masks, how far its views agree with each other, see `reliability.agreement_of`.
    """

    labels: NDArray[np.int32]
    segments: list[Segment]
    agreement: tuple[float, ...] = ()


def segment(
    scene: Scene,
    surface: Surface,
    encoder: Encoder,
    progress: Progress = lambda stage, share: None,
    views_per_candidate: int = VIEWS_PER_CANDIDATE,
    sources: Sequence[Lifted] = (),
) -> Segmentation:
    """The structure, objects and parts that the surface points belong to.

    Args:
        sources: masks of each source, lifted to the surface points.
    """
    links = links_of(surface)
    labels, codes = superpoints_and_structure(surface, links, scene.frame)
    graph = graph_of(scene.cloud, surface, links, labels, codes, scene.frame)
    ledger = None
    if sources:
        labels, codes = revised_by_masks(surface, links, labels, codes, graph, sources)
        graph = graph_of(scene.cloud, surface, links, labels, codes, scene.frame)
        ledger = ledger_of(surface, graph, labels, sources)
    count = len(codes)
    nodes = merge_tree(graph, ledger)
    size = np.bincount(labels, minlength=count)
    points = np.array([sum(int(size[s]) for s in n.members) for n in nodes], dtype=np.int64)
    evidence = _evidence(scene, surface, labels, nodes, points, encoder, views_per_candidate, progress)
    single = None
    if nodes and not codes.any() and points.max() >= SINGLE_OBJECT * len(surface):
        single = int(np.flatnonzero(points == points.max())[-1])  # the root: no node above it holds more
    objects = [nodes[i].members for i in grouping.best_cut(nodes, points, evidence, single)]
    owner = np.where(codes > 0, -1 - codes.astype(np.int32), -1)  # structure: below -1, none: -1, objects: from 0
    for number, members in enumerate(objects):
        owner[list(members)] = number
    labels = refine_borders(surface, labels, owner, codes > 0)
    owner = _absorb_small(owner, labels, links)
    if not sources:
        return Segmentation(labels, _segments(surface, labels, owner, touching(labels, links)))
    labels, whole = pieces_of(surface, links, labels)
    near, divided = touching(labels, links), dividing(labels, links, sources)
    agreement = tuple(w.reliability.agreement for w in ledger.known) if ledger is not None else ()
    return Segmentation(labels, _segments(surface, labels, owner[whole], near, divided), agreement)


def _absorb_small(owner: NDArray[np.int32], labels: NDArray[np.int32], links: Links) -> NDArray[np.int32]:
    """Owners `[S]` after objects of fewer than MIN_OBJECT points were joined to the segment they touch most."""
    size = np.bincount(labels, minlength=len(owner))
    held = np.bincount(np.maximum(owner, -1) + 1, weights=size)[1:]
    small = (owner >= 0) & (held[np.maximum(owner, 0)] < MIN_OBJECT) if len(held) else np.zeros(len(owner), bool)
    ends = labels[links.pairs]
    ends = np.concatenate([ends, ends[:, ::-1]])
    ends = ends[small[ends[:, 0]] & ~small[ends[:, 1]] & (owner[ends[:, 1]] != -1)]
    owner = owner.copy()
    beside, before = owner[ends[:, 1]], owner.copy()
    owner[small] = -1
    for tiny in np.unique(before[ends[:, 0]]).tolist():
        candidates, links_to = np.unique(beside[before[ends[:, 0]] == tiny], return_counts=True)
        owner[before == tiny] = candidates[int(np.argmax(links_to))]
    return owner


def superpoints_and_structure(
    surface: Surface, links: Links, frame: Frame
) -> tuple[NDArray[np.int32], NDArray[np.int8]]:
    """Superpoint of each surface point `[M]`, and the structure code of each superpoint `[S]`.

    Superpoints that lie partly in the structure are split in two.
    """
    labels = superpoints(surface, links)
    found = structure.structures(surface, labels, frame)
    labels = np.unique(labels.astype(np.int64) * 128 + found, return_inverse=True)[1].astype(np.int32)
    codes = np.zeros(int(labels.max(initial=-1)) + 1, np.int8)
    codes[labels] = found
    return labels, codes


def graph_of(
    cloud: GaussianCloud, surface: Surface, links: Links, labels: NDArray[np.int32], codes: NDArray[np.int8],
    frame: Frame,
) -> Graph:  # fmt: skip
    """The adjacency graph of the superpoints that are not structure, in the level frame."""
    flat = planes.level(surface, frame)
    lab, kinds = surface.lab.astype(np.float64), structure.kind_of(codes)
    haze = haze_of(cloud, surface.rows)
    return build_graph(labels, flat.points, lab, flat.normals, links, kinds, surface.spacing, haze)


def _evidence(
    scene: Scene, surface: Surface, labels: NDArray[np.int32], nodes: list[Node], points: NDArray[np.int64],
    encoder: Encoder, views_per_candidate: int, progress: Progress,
) -> dict[int, float]:  # fmt: skip
    """Log-odds that a node is one whole object, from its renders, for large nodes that geometry leaves undecided."""
    stand_in = rendered_nodes(nodes, points)
    asked = sorted(set(stand_in.values()))
    if not asked:
        return {}
    owned = rows_of_nodes(surface, labels, [nodes[i] for i in asked])
    clouds = [scene.cloud[torch.from_numpy(own)] for own in owned]
    middle = np.median(surface.points, axis=0).astype(np.float64)
    vectors = mean_vectors(
        encoder, clouds, scene.frame, middle, views_per_candidate, lambda share: progress("renders", share)
    )
    whole = np.clip(wholeness(encoder, vectors), 0.001, 0.999)
    odds = {i: float(np.log(w / (1 - w))) for i, w in zip(asked, whole, strict=True)}
    return {i: odds[other] for i, other in stand_in.items()}


def rendered_nodes(nodes: list[Node], points: NDArray[np.int64]) -> dict[int, int]:
    """The node that is rendered for each large node that geometry leaves undecided: itself, or one nearly the same.

    Args:
        points: `[K]` number of surface points of each node.
    """
    wanted = [i for i in grouping.undecided_nodes(nodes, points) if points[i] >= MIN_OBJECT]
    same = grouping.nearly_same_ancestor(nodes, points)
    asked = set(sorted({int(same[i]) for i in wanted}, key=lambda i: (-points[i], i))[:MAX_RENDERED])
    return {i: int(same[i]) for i in wanted if int(same[i]) in asked}


def rows_of_nodes(surface: Surface, labels: NDArray[np.int32], nodes: Sequence[Node]) -> list[NDArray[np.int64]]:
    """The Gaussians of each node, ascending."""
    rows = _rows_by_superpoint(surface, labels, int(labels.max(initial=-1)) + 1)
    return [np.sort(np.concatenate([rows[s] for s in node.members])) for node in nodes]


def _rows_by_superpoint(surface: Surface, labels: NDArray[np.int32], count: int) -> list[NDArray[np.int64]]:
    order = np.argsort(labels, kind="stable")
    return np.split(surface.rows[order], np.cumsum(np.bincount(labels, minlength=count))[:-1])


def _segments(
    surface: Surface, labels: NDArray[np.int32], owner: NDArray[np.int32], near: dict[int, set[int]],
    divided: grouping.Divided | None = None,
) -> list[Segment]:  # fmt: skip
    """Segments in order: floor, each wall, ceiling; then the objects, largest first, each followed by its parts.

    Args:
        divided: how surely masks divide touching superpoints, None without masks. With it floor, walls and ceiling have
            parts as well: what hangs at a wall may be no object by its shape.
    """
    count = len(owner)
    size = np.bincount(labels, minlength=count)
    total = np.stack([np.bincount(labels, weights=surface.lab[:, c], minlength=count) for c in range(3)], axis=1)
    lab: F64 = total / np.maximum(size, 1)[:, None]
    codes = sorted({-1 - int(o) for o in owner if o < -1}, key=lambda c: (c % planes.KINDS, c))
    segments: list[Segment] = []
    for c in codes:
        members = tuple(np.flatnonzero(owner == -1 - c).tolist())
        clusters = [members] if divided is None else grouping.parts_of(members, near, lab, size, divided)
        segments += _with_parts(
            Segment(members, "structure", label=structure.NAMES[c % planes.KINDS]), clusters, len(segments)
        )
    objects = [tuple(np.flatnonzero(owner == o).tolist()) for o in np.unique(owner[owner >= 0])]
    for members in sorted(objects, key=lambda m: (-sum(int(size[s]) for s in m), m)):
        clusters = grouping.parts_of(members, near, lab, size, divided or grouping.NOT_DIVIDED)
        segments += _with_parts(Segment(members, "object"), clusters, len(segments))
    return segments


def _with_parts(whole: Segment, clusters: Sequence[Sequence[int]], index: int) -> list[Segment]:
    """A segment and its parts, if it has more than one; `index` is its own place in the list of segments."""
    if len(clusters) == 1:
        return [whole]
    return [replace(whole, members=()), *(Segment(tuple(c), "part", parent=index) for c in clusters)]

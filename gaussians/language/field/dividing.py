"""Divides one group of a language field into several, along the weakest borders of its merge tree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree

from ...cloud import GaussianCloud
from ...errors import InstructionError, UserError
from ...scene import Frame, Scene
from ..encoders import Encoder
from ..encoders.probability import probability
from ..segmentation.affinity import merge_tree
from ..segmentation.regions import Node
from ..segmentation.segment import graph_of
from ..segmentation.superpoints import links_of, superpoints
from ..segmentation.surface import surface_of
from .group_index import index_groups
from .group_table import named, vectors_of
from .language_field import LanguageField
from .measure import box_of, lab_of_cloud

I32 = NDArray[np.int32]

LEAST_POINTS = 20  # surface points of a piece
LEAST_SHARE = 0.03  # of the surface points of the thing: a smaller region is no piece of its own
APART = 1e-3  # probability that regions without any border between them are one


def divided(
    scene: Scene, group: int, into: int, names: Sequence[str] = (), encoder: Encoder | None = None
) -> tuple[Scene, list[int]]:
    """The scene in which one group is several, and their ids, the largest first.

    Only the column of groups changes. The old group stays in the table without Gaussians.

    Args:
        into: number of pieces, at least 2.
        names: of some pieces, in any order; each goes to the piece that is most probably called so.
        encoder: gives the pieces vectors and names if it is that of the field and has an image tower; otherwise the
            pieces keep the vector and the name of the group.

    Raises:
        UserError: the scene has no language field, or no such group.
        InstructionError: no border divides the thing into that many pieces of some size.
    """
    field = scene.language
    if field is None:
        raise UserError("the scene has no language field yet; run `scenewright embed` on it first")
    if not 0 <= group < len(field.groups) or not field.groups[group].count:
        raise UserError(f"group {group} is not in this scene")
    rows = index_groups(scene.cloud).rows(sorted(field.leaves(group)))
    part = scene.cloud[torch.from_numpy(rows)]
    piece = pieces_of(part, scene.frame, into)
    column = scene.cloud.group.clone()
    new = len(field.groups) + np.arange(into, dtype=np.int32)
    column[torch.from_numpy(rows)] = torch.from_numpy(new[piece])
    after = scene.replace(cloud=scene.cloud.replace(group=column))
    clouds = [part[torch.from_numpy(np.flatnonzero(piece == k))] for k in range(into)]
    table = _with_pieces(after, field, group, clouds, encoder)
    table = table if not names else _named(table, new.tolist(), names, encoder)
    return after.replace(language=table), new.tolist()


def pieces_of(cloud: GaussianCloud, frame: Frame, into: int) -> I32:
    """The piece `[N]` of each Gaussian of one thing, numbered from 0, the largest first.

    Raises:
        InstructionError: as `divided`.
    """
    too_few = InstructionError(f"no border of shape or colour divides it into {into} pieces; say fewer")
    surface = surface_of(cloud)
    if len(surface) < into * LEAST_POINTS:
        raise too_few
    links = links_of(surface)
    leaf = np.unique(cloud.group.numpy()[surface.rows], return_inverse=True)[1].astype(np.int64)
    labels = superpoints(surface, links)
    labels = np.unique(labels * (int(leaf.max()) + 1) + leaf, return_inverse=True)[1].astype(np.int32)
    size = np.bincount(labels)
    nodes = _rooted(merge_tree(graph_of(cloud, surface, links, labels, np.zeros(len(size), np.int8), frame)), size)
    cut = _cut(nodes, np.array([int(size[list(n.members)].sum()) for n in nodes]), into)
    if cut is None:
        raise too_few
    owner = np.full(len(size), -1, np.int32)
    for number, node in enumerate(sorted(cut, key=lambda i: (-int(size[list(nodes[i].members)].sum()), i))):
        owner[list(nodes[node].members)] = number
    of_point = owner[labels]
    sure = np.flatnonzero(of_point >= 0)
    _, nearest = cKDTree(surface.points[sure]).query(cloud.means.numpy())
    result = of_point[sure][nearest].astype(np.int32)
    result[surface.rows[sure]] = of_point[sure]
    return result


def _rooted(nodes: list[Node], size: NDArray[np.int64]) -> list[Node]:
    """The nodes with further ones above that join the roots of the forest, the largest first; the last is the root."""
    children = {c for node in nodes for c in node.children}
    roots = [i for i in range(len(nodes)) if i not in children]
    roots.sort(key=lambda i: (-int(size[list(nodes[i].members)].sum()), i))
    nodes, top = list(nodes), roots[0]
    for root in roots[1:]:
        nodes.append(Node((*nodes[top].members, *nodes[root].members), (top, root), APART))
        top = len(nodes) - 1
    return nodes


def _cut(nodes: Sequence[Node], points: NDArray[np.int64], into: int) -> list[int] | None:
    """`into` disjoint nodes below the last one, divided at the least probable merges; None if there are too few.

    A child of fewer points than a piece has is left out; its points join the nearest piece later.
    """
    least = max(LEAST_POINTS, LEAST_SHARE * int(points[-1]))
    pieces = {len(nodes) - 1: _division(nodes, points, len(nodes) - 1, least)}
    while len(pieces) < into:
        open_ = [(found[0], node, found[1]) for node, found in pieces.items() if found is not None]
        if not open_:
            return None
        _, node, halves = min(open_)
        del pieces[node]
        pieces |= {half: _division(nodes, points, half, least) for half in halves}
    return list(pieces)


def _division(
    nodes: Sequence[Node], points: NDArray[np.int64], node: int, least: float
) -> tuple[float, tuple[int, int]] | None:
    """Probability and children of the topmost merge of two regions of enough points inside a node; None without one."""
    while nodes[node].children:
        small, large = sorted(nodes[node].children, key=lambda i: (int(points[i]), i))
        if points[small] >= least:
            return nodes[node].affinity, (large, small)
        node = large
    return None


def _with_pieces(
    scene: Scene, field: LanguageField, group: int, clouds: Sequence[GaussianCloud], encoder: Encoder | None
) -> LanguageField:
    """The table with the pieces as new objects; the old group and its parts hold nothing."""
    old = field.groups[group]
    seeing = encoder is not None and encoder.fingerprint == field.encoder and encoder.image_size > 0
    vectors = np.repeat(field.embeddings[[group]], len(clouds), axis=0)
    if seeing:
        assert encoder is not None
        vectors = vectors_of(encoder, clouds, scene.frame, scene.cloud)
    first = len(field.groups)
    made = tuple(
        replace(
            old, id=first + k, level="object", parent=-1, box=box_of(c, scene.frame), lab=lab_of_cloud(c), count=len(c),
            named_by="", votes=(),
        )
        for k, c in enumerate(clouds)
    )  # fmt: skip
    gone = set(field.leaves(group))
    rows = tuple(replace(g, count=0) if g.id in gone else g for g in field.groups)
    embeddings = np.concatenate([field.embeddings, vectors]).astype(np.float32)
    table = replace(field, groups=(*rows, *made), embeddings=embeddings)
    if not seeing:
        return table
    assert encoder is not None
    return replace(table, groups=(*rows, *named(table, encoder, scene.frame).groups[first:]))


def _named(table: LanguageField, pieces: list[int], names: Sequence[str], encoder: Encoder | None) -> LanguageField:
    """The table with each name on the piece that is most probably called so.

    A name that the encoder does not know goes to the piece that is left over, if there is one of each.
    """
    likely = np.zeros((len(pieces), len(names)))
    if encoder is not None and encoder.fingerprint == table.encoder:
        for column, name in enumerate(names):
            likely[:, column] = probability(encoder, name, table.embeddings[pieces])
    pairs = [(int(i), int(j)) for i, j in zip(*linear_sum_assignment(-likely), strict=True)]
    doubtful = [(i, j) for i, j in pairs if likely[i, j] <= 0]
    certain = len(doubtful) <= 1 and len(names) == len(pieces)
    rows = list(table.groups)
    for i, j in pairs:
        if certain or likely[i, j] > 0:
            rows[pieces[i]] = replace(rows[pieces[i]], label=names[j], label_score=1.0, named_by="user")
    return replace(table, groups=tuple(rows))

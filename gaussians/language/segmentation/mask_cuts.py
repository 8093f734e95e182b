"""Superpoints and structure revised by masks: what masks divide is cut, what they take out of floor and walls is freed.

Superpoints follow colour and shape, so that one may hold a cup and the part of the table before it. Small pieces of a
superpoint are compared, and it falls apart where the sources of masks outweigh that geometry found it to be one thing.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..masks.evidence import Ledger, Witness, divided, witnesses
from ..masks.lifting import Lifted
from ..masks.reliability import chooses_objects, estimate
from ..masks.statements import cover
from .affinity import border_odds
from .regions import Graph
from .superpoints import Links, superpoints
from .surface import Surface

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]

PIECE_SCALE, PIECE_POINTS = 0.5, 12  # of the pieces that superpoints are cut into, see `superpoints`
SURE = 5.0  # bound of geometry's log-odds in a clean scene
CLEAN = 5.0  # median Lab difference of neighbouring points up to which a scene is clean
HALF_SURE = 0.5  # views at which what they say of a border inside an object counts for half
WITHIN_SUPERPOINT = 2.0  # geometry's log-odds that two pieces of one superpoint are one object
WITHIN_STRUCTURE = 2.0  # likewise that a superpoint found in a floor or wall belongs to it


def revised_by_masks(
    surface: Surface, links: Links, labels: I32, codes: NDArray[np.int8], graph: Graph, sources: Sequence[Lifted]
) -> tuple[I32, NDArray[np.int8]]:
    """Superpoint of each point `[P]` and structure code of each superpoint, revised by masks.

    Args:
        labels, codes: superpoints and structure by geometry.
        graph: of these superpoints; it tells what geometry thinks of their borders.
        sources: masks lifted to the surface points.
    """
    first, second, prior = border_odds(graph)
    worth = estimate([cover(s, labels, len(codes)) for s in sources], first, second, prior)

    def about(regions: I32) -> list[Witness]:
        return witnesses(sources, regions, int(regions.max(initial=-1)) + 1, worth)

    pieces = pieces_of(surface, links, labels)[0]
    within = links.pairs[labels[links.pairs[:, 0]] == labels[links.pairs[:, 1]]]
    ends = np.unique(np.sort(pieces[within], axis=1), axis=0).astype(np.int64)
    cut = cut_superpoints(labels, pieces, ends[ends[:, 0] != ends[:, 1]], about(pieces))
    found = np.zeros(int(cut.max()) + 1, np.int8)
    found[cut] = codes[labels]
    return cut, freed_from_structure(found, np.bincount(cut).astype(np.float64), about(cut))


def geometry_bound(surface: Surface) -> float:
    """Bound of geometry's log-odds where masks speak.

    Its rule was fitted on clean scenes. In a noisy capture, regions of one colour run over the borders of objects.
    """
    first = np.repeat(np.arange(len(surface)), surface.neighbours.shape[1])
    difference = surface.raw_lab[first] - surface.raw_lab[surface.neighbours.ravel()]
    noise = float(np.median(np.linalg.norm(difference, axis=1))) if len(difference) else 0.0
    return SURE * float(np.clip(CLEAN / max(noise, 1e-9), 0.4, 1))


def pieces_of(surface: Surface, links: Links, labels: I32) -> tuple[I32, I64]:
    """Smaller pieces of superpoints: the piece of each point `[P]`, and the superpoint of each piece."""
    fine = superpoints(surface, links, PIECE_SCALE, PIECE_POINTS)
    code = labels.astype(np.int64) * (int(fine.max(initial=0)) + 1) + fine
    _, first, pieces = np.unique(code, return_index=True, return_inverse=True)
    return pieces.astype(np.int32), labels[first].astype(np.int64)


def dividing(labels: I32, links: Links, sources: Sequence[Lifted]) -> dict[tuple[int, int], float]:
    """How surely masks divide touching superpoints, in [0, 1]: 1 where all views of all sources do.

    Args:
        labels: `[P]` superpoint of each surface point.
        sources: masks lifted to the surface points.
    """
    ends = np.unique(np.sort(labels[links.pairs], axis=1), axis=0).astype(np.int64)
    ends = ends[ends[:, 0] != ends[:, 1]]
    total = np.zeros(len(ends))
    for one in sources:
        about = cover(one, labels, int(labels.max(initial=-1)) + 1)
        said = about.between(ends[:, 0], ends[:, 1])
        # of a source that chooses objects, a mask inside a mask is a part, though half of the masks contain both
        nested = 1 + chooses_objects(about)
        apart = np.minimum(nested * (1 - said.common / np.maximum(said.either, 1e-9)), 1)
        total = np.maximum(total, apart * said.views / (said.views + HALF_SURE))
    return {(a, b): float(d) for (a, b), d in zip(ends.tolist(), total, strict=True) if d > 0}


def ledger_of(surface: Surface, graph: Graph, labels: I32, sources: Sequence[Lifted]) -> Ledger:
    """What masks say about the regions of a graph.

    Args:
        labels: `[P]` superpoint of each surface point.
        sources: masks lifted to the surface points.
    """
    size = np.bincount(labels).astype(np.float64)
    chosen = np.array([members[0] for _, members in sorted(graph.members.items())], np.int64)
    covers = [cover(s, labels, len(size)) for s in sources]
    worth = estimate(covers, *border_odds(graph))
    known = [Witness(c, r) for c, r in zip(covers, worth, strict=True)]
    return Ledger(known, chosen, size[chosen], geometry_bound(surface))


def cut_superpoints(labels: I32, pieces: I32, pairs: I64, known: Sequence[Witness]) -> I32:
    """Superpoints `[P]` cut where masks say so; labels keep their order.

    Args:
        labels: `[P]` superpoint of each point.
        pieces: `[P]` smaller pieces, each within one superpoint.
        pairs: `[E, 2]` touching pieces of one superpoint.
        known: the sources as witnesses about the pieces.
    """
    count = int(pieces.max(initial=-1)) + 1
    size = np.bincount(pieces, minlength=count).astype(np.float64)
    odds = _odds(pairs[:, 0], pairs[:, 1], known)
    owner = np.zeros(count, np.int64)
    owner[pieces] = labels
    doubtful = np.unique(owner[pairs[odds < 0, 0]])
    part = np.zeros(count, np.int64)
    for superpoint in doubtful.tolist():
        own = np.flatnonzero(owner == superpoint)
        part[own] = _agglomerate(own, size[own], known)
    key = owner * (int(part.max(initial=0)) + 1) + part
    return np.unique(key[pieces], return_inverse=True)[1].astype(np.int32)


def _odds(first: I64, second: I64, known: Sequence[Witness]) -> F64:
    """Log-odds `[E]` that pairs of pieces of a superpoint stay together; those that masks divide do not."""
    total = WITHIN_SUPERPOINT + sum((w.between(first, second) for w in known), np.zeros(len(first)))
    return np.where(divided(known, first, second), np.minimum(total, -1.0), total)


def _agglomerate(own: I64, size: F64, known: Sequence[Witness]) -> I64:
    """Clusters `[K]` of some pieces by mean linkage: the most probable two are joined, until none is probable."""
    first, second = np.triu_indices(len(own), 1)
    odds = np.zeros((len(own), len(own)))
    odds[first, second] = _odds(own[first], own[second], known)
    odds = (odds + odds.T) * np.outer(size, size)
    total = size.copy()
    cluster = np.arange(len(own))
    while True:
        mean = odds / np.outer(total, total)
        np.fill_diagonal(mean, -np.inf)
        a, b = np.unravel_index(int(mean.argmax()), mean.shape)
        if mean[a, b] < 0:
            return np.unique(cluster, return_inverse=True)[1]
        odds[a] += odds[b]
        odds[:, a] = odds[a]
        odds[b] = odds[:, b] = -np.inf
        total[a] += total[b]
        cluster[cluster == b] = a
        if len(np.unique(cluster)) == 1:
            return np.zeros(len(own), np.int64)


def freed_from_structure(codes: NDArray[np.int8], size: F64, known: Sequence[Witness]) -> NDArray[np.int8]:
    """Structure codes `[S]` of superpoints, 0 for those that masks take out of their floor or wall.

    Args:
        size: `[S]` number of points of each superpoint.
    """
    odds = WITHIN_STRUCTURE + sum((w.within_structure(codes, size) for w in known), np.zeros(len(codes)))
    return np.where(odds < 0, 0, codes).astype(np.int8)

"""Assign surface points to tracks of masks and revise the segmentation accordingly.

Masks find whole objects but have coarse borders; superpoints have sharp borders but do not show what belongs together.
So the votes of the masks decide, and where the points of a superpoint mostly agree the superpoint is assigned as a
whole. What belongs to no track keeps its segment.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from ..segmentation import grouping, structure
from ..segmentation.segment import MIN_OBJECT, Segment
from ..segmentation.superpoints import Links, links_of, superpoints, touching
from ..segmentation.surface import Surface
from .association import CONTAINED, INSIDE, Tracks

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

FINE_SCALE = 1.0  # of the superpoints that pool votes: a third of the segmentation's, so that few cross a border
HALF_TRUST = 1.0  # pixels of blending weight over all views at which a Gaussian's own share counts for half
UNASSIGNED, UNSEEN = -1, -2


def assign_points(surface: Surface, links: Links, tracks: Tracks) -> tuple[I32, I32]:
    """The track of each surface point and the part of that track, `[P]` each; -1 for none.

    Of several tracks that contain a point the one with most votes gets it, unless a smaller track lies within that one.
    """
    segment = superpoints(surface, links, FINE_SCALE)
    share = csc_matrix(tracks.share[surface.rows])
    votes = csc_matrix(tracks.votes[surface.rows])
    seen = tracks.seen[surface.rows]
    trust = seen / (seen + HALF_TRUST)
    size = np.asarray((share > INSIDE).sum(axis=0)).ravel()
    owner, part = np.full(len(surface), UNASSIGNED, np.int32), np.full(len(surface), UNASSIGNED, np.int32)
    best = {UNASSIGNED: np.zeros(len(surface))}
    held: dict[int, NDArray[np.bool_]] = {}
    for k in sorted(range(len(tracks.tracks)), key=lambda k: (-size[k], k)):  # larger tracks before those inside them
        column = np.asarray(share[:, [k]].todense()).ravel()
        held[k] = pool_shares(column, segment, trust) > INSIDE
        said = np.where(held[k], np.asarray(votes[:, [k]].todense()).ravel() + 1e-6, 0)
        parent = tracks.tracks[k].parent
        if parent == UNASSIGNED:
            inside = _mostly_in(held, k)
            taken = held[k] & ((said > best[UNASSIGNED]) | np.isin(owner, inside))
            owner[taken], best[UNASSIGNED][taken] = k, said[taken]
            part[taken] = UNASSIGNED
        else:
            others = best.setdefault(parent, np.zeros(len(surface)))
            taken = held[k] & (said > others)
            part[taken], others[taken] = k, said[taken]
    belongs = np.array([t.parent for t in tracks.tracks] + [UNASSIGNED], np.int32)[part]
    return owner, np.where((belongs == owner) & (owner >= 0), part, UNASSIGNED).astype(np.int32)


def pool_shares(share: NDArray[np.floating], segment: I32, trust: NDArray[np.floating]) -> F64:
    """Shares `[P]` moved towards the mean of their segment.

    They move the more, the more the points of the segment agree and the lower the trust in a point. Agreement is one
    minus the ratio of the standard deviation of the shares to its maximum for their mean, which shares of 0 and 1 have:
    a segment that the border of a mask divides keeps the shares of its points.

    Args:
        share: `[P]` in [0, 1].
        segment: `[P]` superpoint of each point.
        trust: `[P]` in [0, 1], 0 for a point that no view shows.
    """
    count = np.maximum(np.bincount(segment, weights=trust), 1e-9)
    mean = np.bincount(segment, weights=trust * share) / count
    variance = np.maximum(np.bincount(segment, weights=trust * np.square(share)) / count - mean**2, 0)
    split = np.sqrt(variance / np.maximum(mean * (1 - mean), 1e-9)).clip(0, 1)
    result: F64 = mean[segment] + trust * split[segment] * (share - mean[segment])
    return result


def _mostly_in(held: dict[int, NDArray[np.bool_]], k: int) -> list[int]:
    """The larger tracks that contain most of track k."""
    own = held[k].sum()
    return [j for j, other in held.items() if j != k and (other & held[k]).sum() >= CONTAINED * max(int(own), 1)]


def apply_tracks(
    surface: Surface, labels: I32, segments: Sequence[Segment], tracks: Tracks, vectors: Sequence[F32 | None]
) -> tuple[I32, list[Segment], I32]:
    """Revise a segmentation by tracks of masks.

    Each track becomes an object with the track's vector. What remains of other objects is kept if it is large enough.

    Args:
        labels: `[P]` superpoint of each surface point; `segments` refer to these numbers.
        vectors: one `[D]` per track, None for tracks without a vector.

    Returns:
        The superpoint of each surface point `[P]` after division along the borders of the tracks, the segments in the
        order of `segment`, and the track of each surface point `[P]`, -1 for none.
    """
    links = links_of(surface)
    owner, part = assign_points(surface, links, tracks)
    owner = np.where(_structure_only(owner, labels, segments, tracks), UNASSIGNED, owner).astype(np.int32)
    owner = _complete_objects(owner, labels, segments, tracks.seen[surface.rows] > HALF_TRUST, tracks)
    code = (labels.astype(np.int64) * (len(tracks.tracks) + 1) + owner + 1) * (len(tracks.tracks) + 1) + part + 1
    _, first, cut = np.unique(code, return_index=True, return_inverse=True)
    cut = cut.astype(np.int32)
    size = np.bincount(cut, minlength=len(first)).astype(np.int64)
    of, parts, old = owner[first], part[first], labels[first]
    total = np.stack([np.bincount(cut, weights=surface.lab[:, c], minlength=len(first)) for c in range(3)], axis=1)
    lab: F64 = total / np.maximum(size, 1)[:, None]
    near = touching(cut, links)
    made = [
        replace(t, members=members)
        for t in segments
        if t.level == "structure" and (members := _unassigned(t.members, old, of))
    ]
    objects = [(np.flatnonzero(of == k), k) for k in range(len(tracks.tracks)) if (of == k).any()]
    for own, k in sorted(objects, key=lambda o: (-int(size[o[0]].sum()), o[1])):
        if size[own].sum() >= MIN_OBJECT:
            pieces = _object(own, vectors[k], parts, len(made), near, lab, size)
            made += [replace(pieces[0], votes=tracks.tracks[k].heard), *pieces[1:]]
    for whole in _whole_objects(segments):
        left = np.array(_unassigned(whole, old, of), dtype=np.int64)
        if size[left].sum() >= MIN_OBJECT:
            made += _object(left, None, parts, len(made), near, lab, size)
    return cut, made, owner


def track_by_votes(tracks: Tracks) -> I32:
    """The track with most votes of each Gaussian `[N]`; UNASSIGNED for none, UNSEEN where too little of it is seen."""
    owner = np.full(len(tracks.seen), UNASSIGNED, np.int32)
    best = np.zeros(len(owner))
    for k, track in enumerate(tracks.tracks):
        if track.parent == UNASSIGNED:
            held = np.asarray(tracks.share[:, [k]].todense()).ravel() > INSIDE
            votes = np.where(held, np.asarray(tracks.votes[:, [k]].todense()).ravel() + 1e-6, 0)
            owner = np.where(votes > best, k, owner)
            best = np.maximum(best, votes)
    return np.where(tracks.seen > HALF_TRUST, owner, UNSEEN).astype(np.int32)


def _structure_only(owner: I32, labels: I32, segments: Sequence[Segment], tracks: Tracks) -> NDArray[np.bool_]:
    """Whether each point `[P]` belongs to a track that lies mostly in the structure and has no label of an object.

    The segmentation finds floor and walls more precisely than masks. Tracks with another label, such as a book that
    lies flat on the floor, are kept.
    """
    within = np.isin(labels, [s for t in segments if t.level == "structure" for s in t.members])
    count = np.bincount(owner + 1)
    share = np.bincount(owner + 1, weights=within) / np.maximum(count, 1)
    called = np.array([False, *(t.label not in ("", *structure.NAMES.values()) for t in tracks.tracks)])[: len(share)]
    result: NDArray[np.bool_] = ((share > INSIDE) & ~called)[owner + 1] & (owner >= 0)
    return result


def _complete_objects(
    owner: I32, labels: I32, segments: Sequence[Segment], seen: NDArray[np.bool_], tracks: Tracks
) -> I32:
    """Owners `[P]` in which objects that belong mostly to one track are completed by points without a track.

    Points that no view shows join the track, such as the underside of a chair. Seen points join it if the track has a
    label and contains nearly all of the object: detectors often leave out parts, such as the pot of a plant.
    """
    owner = owner.copy()
    for members in _whole_objects(segments):
        inside = np.isin(labels, members)
        names, counts = np.unique(owner[inside & seen], return_counts=True)
        if not len(names) or names[counts.argmax()] == UNASSIGNED or counts.max() <= INSIDE * counts.sum():
            continue
        most = int(names[counts.argmax()])
        nearly = bool(tracks.tracks[most].label) and counts.max() >= CONTAINED * counts.sum()
        owner[inside & (owner == UNASSIGNED) & (~seen | nearly)] = most
    return owner


def _unassigned(members: Sequence[int], old: I32, of: I32) -> tuple[int, ...]:
    """The new superpoints of some old ones that belong to no track."""
    return tuple(np.flatnonzero(np.isin(old, list(members)) & (of < 0)).tolist())


def _whole_objects(segments: Sequence[Segment]) -> list[tuple[int, ...]]:
    """Superpoints of each object, including those of its parts, in the order of the segments."""
    return [
        t.members + tuple(s for p in segments if p.parent == i for s in p.members)
        for i, t in enumerate(segments)
        if t.level == "object"
    ]


def _object(
    members: NDArray[np.integer], vector: F32 | None, parts: I32, own: int, near: dict[int, set[int]], lab: F64,
    size: NDArray[np.int64]
) -> list[Segment]:  # fmt: skip
    """One object as segment `own`, followed by its parts: those of masks, then patches of one colour of the rest."""
    shown = sorted(set(parts[members].tolist()) - {UNASSIGNED})
    clusters = [members[parts[members] == p].tolist() for p in shown]
    rest = members[parts[members] == UNASSIGNED].tolist()
    clusters += grouping.parts_of(rest, near, lab, size) if rest else []
    if len(clusters) == 1:
        return [Segment(tuple(clusters[0]), "object", vector=vector)]
    return [Segment((), "object", vector=vector), *(Segment(tuple(c), "part", parent=own) for c in clusters)]

"""What tracks of masks change about the things that segmentation found: who owns each surface point, and what is left.

Masks are coarse and right in the main; segments have sharp borders and cannot know what belongs together. So votes
decide, and where the points of a segment mostly agree they decide for the segment as a whole. What no track claims
stays as segmentation had it, so nothing is lost.

Knows tracks, superpoints and things. Refuses to know views and encoders.
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
from .association import HELD, NESTED, Tracks

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

FINE = 1.0  # scale of the superpoints that votes are pooled in: a third of that of segmentation, so that few straddle
ENOUGH = 1.0  # pixels of blending weight, over all views, from which a Gaussian's own share counts for half
NOBODY, UNTOLD = -1, -2


def owners(surface: Surface, links: Links, tracks: Tracks) -> tuple[I32, I32]:
    """The track each surface point belongs to, and the part of it, `[P]` each; -1 for none.

    Of several tracks that hold a point the one with most votes has it, unless a smaller one lies within it.
    """
    segment = superpoints(surface, links, FINE)
    share = csc_matrix(tracks.share[surface.rows])
    votes = csc_matrix(tracks.votes[surface.rows])
    seen = tracks.seen[surface.rows]
    trust = seen / (seen + ENOUGH)
    size = np.asarray((share > HELD).sum(axis=0)).ravel()
    owner, part = np.full(len(surface), NOBODY, np.int32), np.full(len(surface), NOBODY, np.int32)
    best = {NOBODY: np.zeros(len(surface))}
    held: dict[int, NDArray[np.bool_]] = {}
    for k in sorted(range(len(tracks.tracks)), key=lambda k: (-size[k], k)):  # containers before their contents
        column = np.asarray(share[:, [k]].todense()).ravel()
        held[k] = pooled(column, segment, trust) > HELD
        said = np.where(held[k], np.asarray(votes[:, [k]].todense()).ravel() + 1e-6, 0)
        parent = tracks.tracks[k].parent
        if parent == NOBODY:
            inside = _mostly_in(held, k)
            taken = held[k] & ((said > best[NOBODY]) | np.isin(owner, inside))
            owner[taken], best[NOBODY][taken] = k, said[taken]
            part[taken] = NOBODY
        else:
            others = best.setdefault(parent, np.zeros(len(surface)))
            taken = held[k] & (said > others)
            part[taken], others[taken] = k, said[taken]
    belongs = np.array([t.parent for t in tracks.tracks] + [NOBODY], np.int32)[part]
    return owner, np.where((belongs == owner) & (owner >= 0), part, NOBODY).astype(np.int32)


def pooled(share: NDArray[np.floating], segment: I32, trust: NDArray[np.floating]) -> F64:
    """Shares `[P]` drawn to the mean of their segment, the more the segment's points agree and the less each is to be
    trusted, in [0, 1]: 0 for a point that no view shows.

    Agreement is one minus the ratio of the shares' deviation to the largest that such a mean allows, that of all or
    nothing: a segment that one half of the masks' border cuts keeps its points' own shares.
    """
    count = np.maximum(np.bincount(segment, weights=trust), 1e-9)
    mean = np.bincount(segment, weights=trust * share) / count
    variance = np.maximum(np.bincount(segment, weights=trust * np.square(share)) / count - mean**2, 0)
    split = np.sqrt(variance / np.maximum(mean * (1 - mean), 1e-9)).clip(0, 1)
    result: F64 = mean[segment] + trust * split[segment] * (share - mean[segment])
    return result


def _mostly_in(held: dict[int, NDArray[np.bool_]], k: int) -> list[int]:
    """Larger tracks that track k mostly lies in."""
    own = held[k].sum()
    return [j for j, other in held.items() if j != k and (other & held[k]).sum() >= NESTED * max(int(own), 1)]


def claimed(
    surface: Surface,
    labels: I32,
    things: Sequence[Segment],
    tracks: Tracks,
    vectors: Sequence[F32 | None],
) -> tuple[I32, list[Segment], I32]:
    """Superpoints cut along the tracks' borders, the things they make up, as `segment` gives them, and the track of
    each surface point.

    Things that tracks claim carry the tracks' vectors. Of the others what is left stays a thing if it is large enough.

    Args:
        labels: `[P]` superpoint of each surface point, whose numbers are the `members` of `things`.
        vectors: one `[D]` a track, None for those that say nothing.
    """
    links = links_of(surface)
    owner, part = owners(surface, links, tracks)
    owner = np.where(_structure_only(owner, labels, things, tracks), NOBODY, owner).astype(np.int32)
    owner = _with_rest(owner, labels, things, tracks.seen[surface.rows] > ENOUGH, tracks)
    code = (labels.astype(np.int64) * (len(tracks.tracks) + 1) + owner + 1) * (len(tracks.tracks) + 1) + part + 1
    _, first, cut = np.unique(code, return_index=True, return_inverse=True)
    cut = cut.astype(np.int32)
    size = np.bincount(cut, minlength=len(first)).astype(np.int64)
    of, parts, old = owner[first], part[first], labels[first]
    total = np.stack([np.bincount(cut, weights=surface.lab[:, c], minlength=len(first)) for c in range(3)], axis=1)
    lab: F64 = total / np.maximum(size, 1)[:, None]
    near = touching(cut, links)
    made = [
        replace(t, members=members) for t in things if t.level == "structure" and (members := _left(t.members, old, of))
    ]
    objects = [(np.flatnonzero(of == k), k) for k in range(len(tracks.tracks)) if (of == k).any()]
    for own, k in sorted(objects, key=lambda o: (-int(size[o[0]].sum()), o[1])):
        if size[own].sum() >= MIN_OBJECT:
            made += _object(own, vectors[k], parts, len(made), near, lab, size)
    for whole in _whole_objects(things):
        left = np.array(_left(whole, old, of), dtype=np.int64)
        if size[left].sum() >= MIN_OBJECT:
            made += _object(left, None, parts, len(made), near, lab, size)
    return cut, made, owner


def by_votes(tracks: Tracks) -> I32:
    """The track that each Gaussian's own votes give it to, `[N]`; -1 for none, -2 where too little is seen to tell."""
    owner = np.full(len(tracks.seen), NOBODY, np.int32)
    best = np.zeros(len(owner))
    for k, track in enumerate(tracks.tracks):
        if track.parent == NOBODY:
            held = np.asarray(tracks.share[:, [k]].todense()).ravel() > HELD
            votes = np.where(held, np.asarray(tracks.votes[:, [k]].todense()).ravel() + 1e-6, 0)
            owner = np.where(votes > best, k, owner)
            best = np.maximum(best, votes)
    return np.where(tracks.seen > ENOUGH, owner, UNTOLD).astype(np.int32)


def _structure_only(owner: I32, labels: I32, things: Sequence[Segment], tracks: Tracks) -> NDArray[np.bool_]:
    """`[P]`: points of tracks that are mostly floor or wall, which are measured better than they are masked; but not of
    what views call something else, as a book that lies flat on the floor.
    """
    within = np.isin(labels, [s for t in things if t.level == "structure" for s in t.members])
    count = np.bincount(owner + 1)
    share = np.bincount(owner + 1, weights=within) / np.maximum(count, 1)
    called = np.array([False, *(t.label not in ("", *structure.NAMES.values()) for t in tracks.tracks)])[: len(share)]
    result: NDArray[np.bool_] = ((share > HELD) & ~called)[owner + 1] & (owner >= 0)
    return result


def _with_rest(owner: I32, labels: I32, things: Sequence[Segment], seen: NDArray[np.bool_], tracks: Tracks) -> I32:
    """Owners, with what masks leave out of the objects that one track has most of.

    Points that no view shows go with the track: the underside of a chair is the chair's. So does the rest of an object
    that a track with a name has nearly all of: detectors draw what is telling of a thing, a crown and not its pot.
    """
    owner = owner.copy()
    for members in _whole_objects(things):
        inside = np.isin(labels, members)
        names, counts = np.unique(owner[inside & seen], return_counts=True)
        if not len(names) or names[counts.argmax()] == NOBODY or counts.max() <= HELD * counts.sum():
            continue
        most = int(names[counts.argmax()])
        nearly = bool(tracks.tracks[most].label) and counts.max() >= NESTED * counts.sum()
        owner[inside & (owner == NOBODY) & (~seen | nearly)] = most
    return owner


def _left(members: Sequence[int], old: I32, of: I32) -> tuple[int, ...]:
    """The cut superpoints of some old ones that no track claims."""
    return tuple(np.flatnonzero(np.isin(old, list(members)) & (of < 0)).tolist())


def _whole_objects(things: Sequence[Segment]) -> list[tuple[int, ...]]:
    """Members of each object, its parts' included, in the order of the things."""
    return [
        t.members + tuple(s for p in things if p.parent == i for s in p.members)
        for i, t in enumerate(things)
        if t.level == "object"
    ]


def _object(
    members: NDArray[np.integer], vector: F32 | None, parts: I32, own: int, near: dict[int, set[int]], lab: F64,
    size: NDArray[np.int64],
) -> list[Segment]:  # fmt: skip
    """One object as row `own` with its parts: those that masks show, the rest of it in patches of one colour."""
    shown = sorted(set(parts[members].tolist()) - {NOBODY})
    clusters = [members[parts[members] == p].tolist() for p in shown]
    rest = members[parts[members] == NOBODY].tolist()
    clusters += grouping.parts_of(rest, near, lab, size) if rest else []
    if len(clusters) == 1:
        return [Segment(tuple(clusters[0]), "object", vector=vector)]
    return [Segment((), "object", vector=vector), *(Segment(tuple(c), "part", parent=own) for c in clusters)]

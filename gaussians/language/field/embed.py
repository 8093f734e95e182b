"""From a cloud to a language field, in a straight line:

up and floor -> skin -> views -> things (`segment`) -> what masks say of them -> every Gaussian's group -> the table.

Knows the order of this room's pieces. Refuses to know queries.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...cloud import NO_GROUP, GaussianCloud
from ...errors import UserError
from ...scene import Scene
from ...viewpoints.coverage import choose_views
from .. import encoders
from ..encoders import Encoder
from ..masks import Masker
from ..masks.association import Track, Tracks, associate
from ..masks.lifting import lift
from ..masks.mask_assignment import UNSEEN, apply_tracks, track_by_votes
from ..segmentation.group_renders import one_thread
from ..segmentation.orient import estimate_frame
from ..segmentation.segment import VIEWS_PER_CANDIDATE, Progress, Segment, segment
from ..segmentation.surface import MIN_OPACITY, Surface, surface_of
from .group_table import with_table

REACH = 6.0  # spacings within which an unassigned Gaussian joins the surface point it is nearest to
NEAR = 2.0  # likewise for an opaque one, which would be skin if it were not a floater


def embed(
    scene: Scene,
    encoder: Encoder,
    progress: Progress = lambda stage, share: None,
    views_per_candidate: int = VIEWS_PER_CANDIDATE,
    masks: Masker | None = None,
) -> Scene:
    """The scene with `cloud.group` filled and a language field over it; nothing else of the cloud changes.

    Args:
        scene: any cloud; `frame.up` is estimated if its source is "unknown", the floor if it is None.
        encoder: makes the vectors that names are compared with.
        progress: called with a stage's name and the share of it that is done.
        views_per_candidate: renders of each candidate object, 1 to 4; see `scenewright bench select`.
        masks: a source of masks of some views (`masks.load`), whose things and names go before those found without.

    Raises:
        UserError: the scene has no Gaussians, or the masks' vectors are not of the encoder's width.
        FileError, BackendError: the masks cannot be had.
    """
    if not len(scene.cloud):
        raise UserError("the scene has no Gaussians, so there is nothing to embed")
    progress("surface", 0.0)
    surface = surface_of(scene.cloud)
    frame = estimate_frame(surface, scene.cameras, scene.frame)
    scene = scene.replace(frame=frame)
    progress("views", 0.0)
    seen = choose_views(scene)
    tracks = None if masks is None else associate(lift(scene.cloud, masks.masks(scene, progress)))
    progress("segments", 0.0)
    with one_thread():
        eyes = encoder if _knows_pieces(encoder) else encoders.load()
        labels, things = segment(scene, surface, eyes, progress, views_per_candidate)
        owner = None
        if tracks is not None:
            vectors = [_vector(t, encoder) for t in tracks.tracks]
            labels, things, owner = apply_tracks(surface, labels, things, tracks, vectors)
        group = _thing_of_superpoint(things, int(labels.max(initial=-1)) + 1)[labels]
        column = _assign(scene.cloud, surface, group)
        if tracks is not None and owner is not None:
            column = _by_own_votes(scene.cloud, surface, group, column, owner, track_by_votes(tracks))
        progress("table", 0.0)
        on_skin = np.zeros(len(scene.cloud), bool)
        on_skin[surface.rows] = True
        embedded = with_table(scene, things, column, on_skin, seen, encoder)
    return embedded if tracks is None else _noted(embedded, tracks)


def _knows_pieces(encoder: Encoder) -> bool:
    """Whether an encoder learnt what is no whole thing, as ours do on pictures of pieces; one of photographs did not,
    takes a hundred times longer to look, and is asked only for the names of what was found."""
    return bool(encoder.image_size) and not encoders.looks_at_background(encoder)


def _vector(track: Track, encoder: Encoder) -> NDArray[np.float32] | None:
    """What a track is, as a vector of the encoder: of its masks, or of the names they give if it has a name.

    Raises:
        UserError: the masks' vectors are not of the encoder's width.
    """
    if track.vector is not None:
        if len(track.vector) != encoder.dim:
            raise UserError(
                f"the masks' vectors have {len(track.vector)} numbers and the encoder's {encoder.dim}; "
                "name the encoder that made them with --encoder"
            )
        return track.vector
    known = [(name, weight) for name, weight in track.votes if encoder.knows(name)] if track.label else []
    if not known:
        return None
    total = np.array([w for _, w in known]) @ encoder.encode_text([name for name, _ in known]).astype(np.float64)
    norm = float(np.linalg.norm(total))
    return (total / norm).astype(np.float32) if norm > 1e-8 else None


def _by_own_votes(
    cloud: GaussianCloud, surface: Surface, group: NDArray[np.int32], column: NDArray[np.int32],
    owner: NDArray[np.int32], voted: NDArray[np.int32],
) -> NDArray[np.int32]:  # fmt: skip
    """`column` with Gaussians off the skin moved to the nearest surface point of the track that their own votes give
    them to: they are few and large, and much of a distant thing is drawn by them. Views that agree on one tell it from
    a floater better than its distance from the skin does.

    Args:
        group, owner: `[P]` group and track of each surface point.
        voted: `[N]` track of each Gaussian by its own votes, see `mask_assignment.track_by_votes`.
    """
    column, off = column.copy(), (voted >= 0) | ((voted != UNSEEN) & (column != NO_GROUP))
    off[surface.rows] = False
    for k in np.unique(voted[off]).tolist():
        points, rows = np.flatnonzero(owner == k), np.flatnonzero(off & (voted == k))
        if len(points):
            nearest = cKDTree(surface.points[points]).query(cloud.means[torch.from_numpy(rows)].numpy())[1]
            column[rows] = group[points[nearest]]
    return column


def _noted(scene: Scene, tracks: Tracks) -> Scene:
    """The scene with a note of what became of the masks."""
    assert scene.language is not None
    said = f"{len(tracks.tracks)} things were found by masks"
    said += f", {tracks.discarded} that too few views confirm were left out" if tracks.discarded else ""
    return scene.replace(language=replace(scene.language, notes=(*scene.language.notes, said)))


def _thing_of_superpoint(things: Sequence[Segment], count: int) -> NDArray[np.int32]:
    owner = np.full(count, NO_GROUP, np.int32)
    for i, thing in enumerate(things):
        owner[list(thing.members)] = i
    return owner


def _assign(cloud: GaussianCloud, surface: Surface, group: NDArray[np.int32]) -> NDArray[np.int32]:
    """Group of every Gaussian `[N]`: its own, or for those off the skin the nearest surface point's within reach."""
    column = np.full(len(cloud), NO_GROUP, np.int32)
    column[surface.rows] = group
    rest = np.ones(len(cloud), bool)
    rest[surface.rows] = False
    rows = np.flatnonzero(rest)
    if len(rows) and len(surface):
        distance, nearest = cKDTree(surface.points).query(cloud.means[rows].numpy(), workers=-1)
        spread = cloud.scales[rows].amax(dim=1).numpy()
        local = surface.gaps.mean(axis=1)[nearest]
        reach = np.where((cloud.opacities[rows] > MIN_OPACITY).numpy(), NEAR, REACH)
        near = distance < reach * np.maximum(local, surface.spacing) + 0.5 * np.minimum(spread, 4 * surface.spacing)
        column[rows[near]] = group[nearest[near]]
    return column

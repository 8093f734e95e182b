"""`embed`: build the language field of a scene.

surface points -> up and floor -> views -> segments -> revision by masks -> group of every Gaussian -> table of groups
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
from ...rotations import to_matrix
from ...scene import Scene
from ...viewpoints.coverage import choose_views
from .. import encoders
from ..encoders import Encoder
from ..masks import Masker, joined
from ..masks.association import Track, Tracks, associate
from ..masks.lifting import lift
from ..masks.mask_assignment import UNSEEN, apply_tracks, track_by_votes
from ..masks.tally import Tally
from ..segmentation.group_renders import one_thread
from ..segmentation.orient import estimate_frame
from ..segmentation.segment import VIEWS_PER_CANDIDATE, Progress, Segment, segment
from ..segmentation.settle import settled
from ..segmentation.surface import MIN_OPACITY, Surface, least_opacity, surface_of
from .group_table import vector_of_votes, with_table
from .making import MaskSource

MAX_DISTANCE = 6.0  # spacings within which a Gaussian off the surface joins the group of the nearest surface point
MAX_DISTANCE_OPAQUE = 2.0  # likewise for an opaque one, which is a floater: otherwise it would be a surface point
COVERS = 1.0  # own standard deviations within which a Gaussian off the surface joins the nearest surface point
COVERS_HAZY = 4.0  # likewise where surfaces consist of faint Gaussians, most of which are not surface points


def embed(
    scene: Scene,
    encoder: Encoder,
    progress: Progress = lambda stage, share: None,
    views_per_candidate: int = VIEWS_PER_CANDIDATE,
    masks: Masker | Sequence[Masker] | None = None,
) -> Scene:
    """The scene with `cloud.group` filled and a language field; nothing else of the cloud changes.

    Args:
        scene: any cloud; `frame.up` is estimated if its source is "unknown", the floor if it is None.
        encoder: makes the image vectors that labels and queries are compared with.
        progress: called with the name of a stage and its completed share.
        views_per_candidate: renders of each candidate object, 1 to 4; see `scenewright bench select`.
        masks: a source of masks of some views (`masks.load`), or several; their objects and labels take precedence.

    Raises:
        UserError: the scene has no Gaussians, or the vectors of the masks have another width than the encoder's.
        FileError, BackendError: the masks cannot be loaded or made.
    """
    if not len(scene.cloud):
        raise UserError("the scene has no Gaussians, so there is nothing to embed")
    progress("surface", 0.0)
    surface = surface_of(scene.cloud)
    frame = estimate_frame(surface, scene.cameras, scene.frame)
    surface = settled(surface, scene.cloud, frame)
    scene = scene.replace(frame=frame)
    progress("views", 0.0)
    seen = choose_views(scene)
    given = () if masks is None else tuple(masks) if isinstance(masks, Sequence) else (masks,)
    tallies = [Tally(one) for one in given]
    views = joined([tally.counting(one.masks(scene, progress)) for tally, one in zip(tallies, given, strict=True)])
    tracks = associate(lift(scene.cloud, views)) if given else None
    progress("segments", 0.0)
    with one_thread():
        # Ours is trained on renders of both whole objects and fragments, and so can tell one from the other. An encoder
        # trained on photographs cannot, and takes a hundred times longer; it only names the groups found.
        judge = encoder if encoder.image_size and not encoders.uses_background(encoder) else encoders.load()
        labels, segments = segment(scene, surface, judge, progress, views_per_candidate)
        owner = None
        if tracks is not None:
            vectors = [_vector(t, encoder) for t in tracks.tracks]
            labels, segments, owner = apply_tracks(surface, labels, segments, tracks, vectors)
        group = _segment_of_superpoint(segments, int(labels.max(initial=-1)) + 1)[labels]
        column = _assign(scene.cloud, surface, group)
        if tracks is not None and owner is not None:
            column = _with_voted_tracks(scene.cloud, surface, group, column, owner, track_by_votes(tracks))
        progress("table", 0.0)
        on_surface = np.zeros(len(scene.cloud), bool)
        on_surface[surface.rows] = True
        embedded = with_table(scene, segments, column, on_surface, seen, encoder)
    return embedded if tracks is None else _with_mask_note(embedded, tracks, [tally.source() for tally in tallies])


def _vector(track: Track, encoder: Encoder) -> NDArray[np.float32] | None:
    """The vector of a track: that of its masks; for an encoder without an image tower else the weighted mean of its
    labels' text vectors, if it has a label.

    Raises:
        UserError: the vectors of the masks have another width than the encoder's.
    """
    if track.vector is not None:
        if len(track.vector) != encoder.dim:
            raise UserError(
                f"the masks' vectors have {len(track.vector)} numbers and the encoder's {encoder.dim}; "
                "name the encoder that made them with --encoder"
            )
        return track.vector
    return vector_of_votes(encoder, track.votes) if track.label and not encoder.image_size else None


def _with_voted_tracks(
    cloud: GaussianCloud, surface: Surface, group: NDArray[np.int32], column: NDArray[np.int32],
    owner: NDArray[np.int32], voted: NDArray[np.int32],
) -> NDArray[np.int32]:  # fmt: skip
    """`column` with Gaussians off the surface moved to the group of the nearest surface point of their voted track.

    Such Gaussians are few but large and make up much of distant objects. Agreement of views distinguishes them from
    floaters better than their distance from the surface does.

    Args:
        group, owner: `[P]` group and track of each surface point.
        voted: `[N]` track of each Gaussian, see `mask_assignment.track_by_votes`.
    """
    column, off = column.copy(), (voted >= 0) | ((voted != UNSEEN) & (column != NO_GROUP))
    off[surface.rows] = False
    for k in np.unique(voted[off]).tolist():
        points, rows = np.flatnonzero(owner == k), np.flatnonzero(off & (voted == k))
        if len(points):
            nearest = cKDTree(surface.points[points]).query(cloud.means[torch.from_numpy(rows)].numpy())[1]
            column[rows] = group[points[nearest]]
    return column


def _with_mask_note(scene: Scene, tracks: Tracks, sources: Sequence[MaskSource]) -> Scene:
    """The scene with the sources of its masks, and a note of how many tracks of them were used and discarded."""
    assert scene.language is not None and scene.language.making is not None
    making = replace(scene.language.making, masks=tuple(sources))
    note = f"{len(tracks.tracks)} things were found by masks"
    note += f", {tracks.discarded} that too few views confirm were discarded" if tracks.discarded else ""
    return scene.replace(language=replace(scene.language, notes=(*scene.language.notes, note), making=making))


def _segment_of_superpoint(segments: Sequence[Segment], count: int) -> NDArray[np.int32]:
    owner = np.full(count, NO_GROUP, np.int32)
    for i, one in enumerate(segments):
        owner[list(one.members)] = i
    return owner


def _assign(cloud: GaussianCloud, surface: Surface, group: NDArray[np.int32]) -> NDArray[np.int32]:
    """Group of every Gaussian `[N]`: its own, or off the surface that of the nearest surface point if it is close to
    that or covers it."""
    column = np.full(len(cloud), NO_GROUP, np.int32)
    column[surface.rows] = group
    rest = np.ones(len(cloud), bool)
    rest[surface.rows] = False
    rows = np.flatnonzero(rest)
    if len(rows) and len(surface):
        part = cloud[torch.from_numpy(rows)]
        distance, nearest = cKDTree(surface.points).query(part.means.numpy(), workers=-1)
        spread = part.scales.amax(dim=1).numpy()
        local = surface.gaps.mean(axis=1)[nearest]
        least = least_opacity(cloud)
        reach = np.where((part.opacities > least).numpy(), MAX_DISTANCE_OPAQUE, MAX_DISTANCE)
        near = distance < reach * np.maximum(local, surface.spacing) + 0.5 * np.minimum(spread, 4 * surface.spacing)
        near |= _deviations(part, surface.points[nearest]) < (COVERS_HAZY if least < MIN_OPACITY else COVERS)
        column[rows[near]] = group[nearest[near]]
    return column


def _deviations(cloud: GaussianCloud, points: NDArray[np.float32]) -> NDArray[np.float32]:
    """Distance of each Gaussian `[N]` from a point of its own `[N, 3]`, in its standard deviations that way."""
    offset = torch.from_numpy(points) - cloud.means
    along = torch.einsum("nij,ni->nj", to_matrix(cloud.quats), offset)
    thick = torch.maximum(cloud.scales, 0.2 * cloud.scales.amax(dim=1, keepdim=True))
    deviations: NDArray[np.float32] = torch.linalg.vector_norm(along / thick, dim=1).numpy()
    return deviations

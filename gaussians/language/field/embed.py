"""`embed`: build the language field of a scene.

surface points -> up and floor -> views -> masks -> segments -> group of every Gaussian -> table of groups
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...cloud import NO_GROUP, GaussianCloud
from ...effort import Dial, Effort
from ...errors import UserError
from ...files.captures.capture import Capture
from ...rotations import to_matrix
from ...scene import Scene
from ...viewpoints.coverage import choose_views
from ...viewpoints.pictures import present
from .. import encoders
from ..encoders import Encoder
from ..masks import Masker
from ..masks.lifting import Lifted, lift
from ..masks.object_masks import Matches, Said, match, said_of, voted_objects
from ..masks.tally import Tally
from ..segmentation.group_renders import one_thread
from ..segmentation.orient import estimate_frame
from ..segmentation.segment import VIEWS_PER_CANDIDATE, Progress, Segment, segment
from ..segmentation.settle import settled
from ..segmentation.surface import MAX_POINTS, MIN_OPACITY, Surface, least_opacity, surface_of
from .exposure import exposed, gain_of
from .group_table import vector_of_votes, with_table
from .making import MaskSource
from .photograph_crops import crops_of

MAX_DISTANCE = 6.0  # spacings within which a Gaussian off the surface joins the group of the nearest surface point
MAX_DISTANCE_OPAQUE = 2.0  # likewise for an opaque one, which is a floater: otherwise it would be a surface point
FITTED = 0.9  # median opacity below which a scene was fitted to photographs: modelled surfaces are opaque
COVERS = 1.0  # own standard deviations within which a Gaussian off the surface joins the nearest surface point
COVERS_HAZY = 4.0  # likewise where surfaces consist of faint Gaussians, most of which are not surface points


def embed(
    scene: Scene,
    encoder: Encoder,
    progress: Progress = lambda stage, share: None,
    views_per_candidate: int = VIEWS_PER_CANDIDATE,
    masks: Masker | Sequence[Masker] | None = None,
    capture: Capture | None = None,
    *,
    effort: Effort | Dial | None = None,
    reserve: float = 0.0,
) -> Scene:
    """The scene with `cloud.group` filled and a language field; nothing else of the cloud changes.

    Args:
        scene: any cloud; `frame.up` is estimated if its source is "unknown", the floor if it is None.
        encoder: makes the image vectors that labels and queries are compared with.
        progress: called with the name of a stage and its completed share.
        views_per_candidate: renders of each candidate object, 1 to 4; see `scenewright bench select`.
        masks: sources of masks of some views (`masks.load`). Each is believed as far as its views agree with each other
            and with geometry; what no mask shows follows geometry.
        capture: the photographs that the scene was fitted from. An encoder that was trained on photographs is shown
            crops of them; the embedded one is shown renders, which it was trained on.
        effort: "fast", "balanced", "accurate", or seconds: the pictures that masks are made of are chosen from measured
            points; `masks` of the caller win. None: no masks but those given.
        reserve: of the seconds of `effort`, those that are needed afterwards.

    Raises:
        UserError: the scene has no Gaussians, the vectors of the masks have another width than the encoder's, or the
            photographs do not show the scene.
        FileError, BackendError: the masks cannot be loaded or made, or a photograph cannot be read.
    """
    if not len(scene.cloud):
        raise UserError("the scene has no Gaussians, so there is nothing to embed")
    if effort is not None:
        masks = _dialled(scene, effort if isinstance(effort, Dial) else Dial(effort), masks, capture, reserve)
    progress("surface", 0.0)
    lit = exposed(scene.cloud, gain_of(scene.cloud))
    surface = surface_of(lit)
    frame = estimate_frame(surface, scene.cameras, scene.frame)
    surface = settled(surface, lit, frame)
    scene = scene.replace(frame=frame)
    progress("views", 0.0)
    seen = choose_views(scene)
    tallies = [Tally(one) for one in _maskers(masks)]
    read = [lift(scene.cloud, t.counting(t.masker.masks(scene, progress))) for t in tallies]
    sources = [one for one in read if one.labels]  # a source without masks says nothing
    progress("segments", 0.0)
    with one_thread():
        # Ours is trained on renders of both whole objects and fragments, and so can tell one from the other. An encoder
        # trained on photographs cannot, and takes a hundred times longer; it only names the groups found.
        judge = encoder if encoder.image_size and not encoders.uses_background(encoder) else encoders.load()
        about = [one.at(surface.rows) for one in sources]
        found = segment(scene.replace(cloud=lit), surface, judge, progress, views_per_candidate, about)
        labels, segments = found.labels, found.segments
        group = _segment_of_superpoint(segments, int(labels.max(initial=-1)) + 1)[labels]
        column = _assign(scene.cloud, surface, group)
        if sources:
            owner = _object_of(segments, group)
            matches = [match(one, owner, len(segments)) for one in about]
            segments = _with_what_masks_say(segments, sources, matches, encoder)
            voted = voted_objects(sources, matches, len(segments))
            column = _with_voted_objects(scene.cloud, surface, group, column, owner, voted)
        shots = 0
        if capture is not None and encoders.uses_background(encoder):
            segments, shots = _with_photographs(scene, segments, column, capture, encoder, progress)
        progress("table", 0.0)
        on_surface = np.zeros(len(scene.cloud), bool)
        on_surface[surface.rows] = True
        embedded = with_table(scene, segments, column, on_surface, seen, encoder)
        embedded = _with_making(embedded, photographs=shots)
    believed = iter(found.agreement)
    made = [t.source(next(believed) if one.labels else None) for t, one in zip(tallies, read, strict=True)]
    return _with_mask_note(embedded, made) if made else embedded


def _dialled(
    scene: Scene, dial: Dial, masks: Masker | Sequence[Masker] | None, capture: Capture | None, reserve: float
) -> Masker | Sequence[Masker] | None:
    """The sources of masks that an effort means; those of the caller if there are any."""
    if masks:
        dial.overrule("masks")
        return masks
    from ..masks.sources import pictures

    photographs = capture is not None and bool(present(capture))
    fitted = float(scene.cloud.opacities.median()) < FITTED
    name = "embed with photographs" if photographs else "embed a fit" if fitted else "embed"
    chosen = dial.choose(name, min(len(scene.cloud), MAX_POINTS), reserve)
    count = int(chosen.settings["pictures"])
    return replace(pictures.load(), capture=capture if photographs else None, count=count) if count else None


def _maskers(masks: Masker | Sequence[Masker] | None) -> list[Masker]:
    return [] if masks is None else list(masks) if isinstance(masks, Sequence) else [masks]


def _with_what_masks_say(
    segments: Sequence[Segment], sources: Sequence[Lifted], matches: Sequence[Matches], encoder: Encoder
) -> list[Segment]:
    """The segments with the votes and the vectors of the masks that show them."""
    made = list(segments)
    for i, one in enumerate(segments):
        if one.level == "object":
            said = said_of(sources, matches, i)
            made[i] = replace(one, votes=said.votes, vector=_vector(said, encoder))
    return made


def _with_photographs(
    scene: Scene, segments: Sequence[Segment], column: NDArray[np.int32], capture: Capture, encoder: Encoder,
    progress: Progress,
) -> tuple[list[Segment], int]:  # fmt: skip
    """The segments with the vectors of their crops in photographs, where masks give them none and a photograph shows
    them well; and the number of photographs.

    Args:
        column: `[N]` group of each Gaussian.
    """
    if not present(capture):
        return list(segments), 0
    owner = _object_of(segments, column)
    crops = crops_of(scene, owner, capture, encoder, lambda share: progress("photographs", share))
    made = list(segments)
    for i, vector in enumerate(crops.vectors):
        if made[i].vector is None and vector.any():
            made[i] = replace(made[i], vector=vector)
    return made, crops.photographs


def _vector(said: Said, encoder: Encoder) -> NDArray[np.float32] | None:
    """The vector of an object: that of its masks; for an encoder without an image tower else the weighted mean of its
    labels' text vectors, if enough views give a label.

    Raises:
        UserError: the vectors of the masks have another width than the encoder's.
    """
    if said.vector is not None:
        if len(said.vector) != encoder.dim:
            raise UserError(
                f"the masks' vectors have {len(said.vector)} numbers and the encoder's {encoder.dim}; "
                "name the encoder that made them with --encoder"
            )
        return said.vector
    return vector_of_votes(encoder, said.votes) if said.label and not encoder.image_size else None


def _with_voted_objects(
    cloud: GaussianCloud, surface: Surface, group: NDArray[np.int32], column: NDArray[np.int32],
    owner: NDArray[np.int32], voted: NDArray[np.int32],
) -> NDArray[np.int32]:  # fmt: skip
    """`column` with Gaussians off the surface moved to the group of the nearest surface point of their voted object.

    Such Gaussians are few but large and make up much of distant objects. Agreement of views distinguishes them from
    floaters better than their distance from the surface does.

    Args:
        group, owner: `[P]` group and object of each surface point.
        voted: `[N]` object of each Gaussian, see `object_masks.voted_objects`.
    """
    column, off = column.copy(), voted >= 0
    off[surface.rows] = False
    for k in np.unique(voted[off]).tolist():
        points, rows = np.flatnonzero(owner == k), np.flatnonzero(off & (voted == k))
        nearest = cKDTree(surface.points[points]).query(cloud.means[torch.from_numpy(rows)].numpy())[1]
        column[rows] = group[points[nearest]]
    return column


def _object_of(segments: Sequence[Segment], group: NDArray[np.int32]) -> NDArray[np.int32]:
    """The object of each point `[P]` by its group, -1 for structure and for no group."""
    above = [t.parent if t.parent >= 0 else i for i, t in enumerate(segments)]
    whole = [i if segments[i].level == "object" else -1 for i in above]
    found: NDArray[np.int32] = np.array([*whole, -1], np.int32)[group]
    return found


def _with_mask_note(scene: Scene, sources: Sequence[MaskSource]) -> Scene:
    """The scene with the sources of its masks, and a note of how many objects they show."""
    scene = _with_making(scene, masks=tuple(sources))
    assert scene.language is not None
    shown = sum(bool(g.votes) for g in scene.language.objects())
    note = f"masks of {sum(s.views for s in sources)} images were used"
    note += f"; they name {shown} things" if shown else ""
    return scene.replace(language=replace(scene.language, notes=(*scene.language.notes, note)))


def _with_making(scene: Scene, **told: Any) -> Scene:
    """The scene with some fields of its making replaced."""
    assert scene.language is not None and scene.language.making is not None
    making = replace(scene.language.making, **told)
    return scene.replace(language=replace(scene.language, making=making))


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

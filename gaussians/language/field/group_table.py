"""Fill the table of a language field: measure, render and name every group; name the same groups by another encoder."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import torch
from numpy.typing import NDArray

from ...cloud import NO_GROUP, GaussianCloud
from ...errors import UserError
from ...scene import Frame, Scene
from ...viewpoints.coverage import Views
from ..encoders import Encoder
from ..segmentation.group_renders import mean_vectors, one_thread
from ..segmentation.segment import Segment
from ..specs import spec_of
from .exposure import exposed, gain_of
from .group_index import index_groups
from .language_field import Group, LanguageField, Names
from .making import Making, package_version, rules_digest
from .measure import box_of, lab_of_cloud
from .posterior import Belief
from .resting import with_rests
from .scale import NOTE, estimate_scale

NAMELESS = "the encoder sees no pictures, and no masks name the things here: nothing has a name"


def with_table(
    scene: Scene,
    segments: Sequence[Segment],
    column: NDArray[np.int32],
    on_surface: NDArray[np.bool_],
    seen: Views,
    encoder: Encoder,
) -> Scene:
    """The scene with its language field: every group measured, embedded from its renders, and named."""
    cloud = scene.cloud.replace(group=torch.from_numpy(column))
    members = index_groups(cloud)
    whole = [members.rows([i, *(j for j, t in enumerate(segments) if t.parent == i)]) for i in range(len(segments))]
    clouds = [cloud[torch.from_numpy(rows)] for rows in whole]
    boxes = [box_of(c, scene.frame) for c in clouds]
    pictured = [c if t.level == "object" and t.vector is None else c[:0] for c, t in zip(clouds, segments, strict=True)]
    vectors = vectors_of(encoder, pictured, scene.frame, cloud)
    for row, segment in zip(vectors, segments, strict=True):
        if segment.vector is not None:
            row[:] = segment.vector
    rows = tuple(
        Group(
            id=i, level=t.level, parent=t.parent, label=t.label, label_score=1.0 if t.label else 0.0,
            box=box, lab=lab_of_cloud(c), count=len(c), views=seen.count_of(own),
            confidence=float(on_surface[own].mean()) if len(own) else 0.0, votes=t.votes,
        )
        for i, (t, c, box, own) in enumerate(zip(segments, clouds, boxes, whole, strict=True))
    )  # fmt: skip
    made = Making(spec_of(encoder), (), len(seen.cameras), 0, package_version(), rules_digest())
    field = LanguageField(rows, vectors, encoder.fingerprint, _notes(scene, column, seen), made)
    return replace(scene, cloud=cloud, language=named(field, encoder, scene.frame))


def renamed(scene: Scene, encoder: Encoder) -> Scene:
    """The scene with the same groups, embedded and named by another encoder.

    Votes of detectors stay, and so do names that were given: to things that were inserted, by sight, by caption or by
    the user. Vectors of masks and of
    photographs are of the other encoder's space; renders of the groups replace them, or for an encoder without an image
    tower the text vectors of the votes.

    Raises:
        UserError: the scene has no language field.
    """
    field = scene.language
    if field is None:
        raise UserError("the scene has no language field yet; run `scenewright embed` on it first")
    members = index_groups(scene.cloud)
    pictured = [g.level == "object" and g.count > 0 and not g.inserted for g in field.groups]
    clouds = [
        scene.cloud[torch.from_numpy(members.rows(field.leaves(g.id) if wanted else []))]
        for g, wanted in zip(field.groups, pictured, strict=True)
    ]
    with one_thread():
        vectors = vectors_of(encoder, clouds, scene.frame, scene.cloud)
    for row, group in zip(vectors, field.groups, strict=True):
        said = ((group.label, 1.0),) if group.inserted else () if encoder.image_size else group.votes
        if (vector := vector_of_votes(encoder, said)) is not None:
            row[:] = vector
    making = None if field.making is None else replace(field.making, encoder=spec_of(encoder), photographs=0)
    notes = tuple(note for note in field.notes if note != NAMELESS)
    if not encoder.image_size and any(pictured) and not vectors.any():
        notes = (*notes, NAMELESS)
    made = replace(field, notes=notes, embeddings=vectors, encoder=encoder.fingerprint, making=making)
    return replace(scene, language=named(made, encoder, scene.frame))


def named(field: LanguageField, encoder: Encoder, frame: Frame, rests_known: bool = False) -> LanguageField:
    """The field with the names of its objects from all sources; structure and names given by others stay.

    Args:
        rests_known: the groups tell already what they rest on.
    """
    if not field.groups:
        return field
    if not rests_known:
        field = replace(field, groups=with_rests(field, frame.up_vector, frame.floor))
    if field.making is not None:
        field = replace(field, making=replace(field.making, trust=None, scale=None))
    first = _named(field, encoder, frame.metres_per_unit)
    scale = estimate_scale(first.groups) if frame.metres_per_unit is None and first.making is not None else None
    notes = tuple(note for note in first.notes if not note.startswith(NOTE))
    if scale is None or first.making is None:
        return replace(first, notes=notes)
    making = replace(first.making, scale=scale.metres)
    return _named(replace(first, notes=(*notes, scale.note()), making=making), encoder, None)


def _named(field: LanguageField, encoder: Encoder, metres: float | None) -> LanguageField:
    """The field with the names by its evidence, and with the trust in pictures that they were given by."""
    belief = Belief(field, encoder, metres)
    groups = tuple(_with_names(g, own) for g, own in zip(field.groups, belief.named(), strict=True))
    making = None if field.making is None else replace(field.making, trust=round(belief.trust, 4))
    return replace(field, groups=groups, making=making)


def _with_names(group: Group, names: Names) -> Group:
    if group.level == "structure" or group.named_by or group.inserted:
        return group
    label, score = names[0] if names else ("", 0.0)
    return replace(group, label=label, label_score=score, names=names)


def vector_of_votes(encoder: Encoder, votes: Names) -> NDArray[np.float32] | None:
    """The unit mean `[D]` of the text vectors of some labels, weighted by their votes; None if the encoder knows
    none."""
    known = [(name, weight) for name, weight in votes if name and weight > 0 and encoder.knows(name)]
    if not known:
        return None
    total = np.array([w for _, w in known]) @ encoder.encode_text([name for name, _ in known]).astype(np.float64)
    norm = float(np.linalg.norm(total))
    return (total / norm).astype(np.float32) if norm > 1e-8 else None


def vectors_of(
    encoder: Encoder, clouds: Sequence[GaussianCloud], frame: Frame, whole: GaussianCloud
) -> NDArray[np.float32]:
    """Mean image vector `[G, D]` of each cloud, seen from the middle of the whole one; zero for an empty one.

    A dim scene is shown brighter, see `exposure`.
    """
    middle = whole.means[:: max(1, len(whole) // 50_000)].median(dim=0).values.double().numpy()
    gain = gain_of(whole)
    lit = [exposed(cloud, gain) for cloud in clouds]
    vectors: NDArray[np.float32] = mean_vectors(encoder, lit, frame, middle, around=exposed(whole, gain))
    return vectors


def _notes(scene: Scene, column: NDArray[np.int32], seen: Views) -> tuple[str, ...]:
    notes = []
    if scene.frame.up_source == "estimated":
        notes.append("up was estimated from the scene; say --up if it is wrong")
    if seen.unseen > 0.01:
        notes.append(f"{seen.unseen:.0%} of the Gaussians are seen from no view")
    loose = float((column == NO_GROUP).mean())
    if loose > 0.01:
        notes.append(f"{loose:.0%} of the Gaussians belong to no group (floaters and residue)")
    return tuple(notes)

"""Fill the table of a language field: measure, render and label every group."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import torch
from numpy.typing import NDArray

from ...cloud import NO_GROUP
from ...scene import Scene
from ...viewpoints.coverage import Views
from ..encoders import Encoder
from ..encoders.probability import labels as name_things
from ..segmentation.group_renders import mean_vectors
from ..segmentation.segment import Segment
from .group_index import index_groups
from .language_field import Group, LanguageField
from .measure import box_of, lab_of_cloud


def with_table(
    scene: Scene,
    segments: Sequence[Segment],
    column: NDArray[np.int32],
    on_surface: NDArray[np.bool_],
    seen: Views,
    encoder: Encoder,
) -> Scene:
    """The scene with its language field: every group measured, embedded from its renders, and labelled."""
    cloud = scene.cloud.replace(group=torch.from_numpy(column))
    members = index_groups(cloud)
    whole = [members.rows([i, *(j for j, t in enumerate(segments) if t.parent == i)]) for i in range(len(segments))]
    clouds = [cloud[torch.from_numpy(rows)] for rows in whole]
    boxes = [box_of(c, scene.frame) for c in clouds]
    middle = cloud.means[:: max(1, len(cloud) // 50_000)].median(dim=0).values.double().numpy()
    pictured = [c if t.level == "object" and t.vector is None else c[:0] for c, t in zip(clouds, segments, strict=True)]
    vectors = mean_vectors(encoder, pictured, scene.frame, middle, around=scene.cloud)
    for row, segment in zip(vectors, segments, strict=True):
        if segment.vector is not None:
            row[:] = segment.vector
    metres = scene.frame.metres_per_unit
    sizes = np.array([b.size for b in boxes]).reshape(-1, 3) * (metres if metres is not None else np.nan)
    named = name_things(encoder, vectors, sizes) if segments else []
    rows = tuple(
        Group(
            id=i, level=t.level, parent=t.parent, label=t.label or name, label_score=1.0 if t.label else float(sure),
            box=box, lab=lab_of_cloud(c), count=len(c), views=seen.count_of(own),
            confidence=float(on_surface[own].mean()) if len(own) else 0.0,
        )
        for i, (t, c, box, own, (name, sure)) in enumerate(zip(segments, clouds, boxes, whole, named, strict=True))
    )  # fmt: skip
    field = LanguageField(rows, vectors, encoder.fingerprint, _notes(scene, column, seen))
    return replace(scene, cloud=cloud, language=field)


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

"""What finer vectors gain: names asked by the vector of a Gaussian's object, of its part, or of both together.

Language-embedded scenes elsewhere hold a vector for each Gaussian, which can differ within a thing. Its parts, the
finest pieces that the segmentation finds, get vectors from pictures of their own, as objects do.
"""

from __future__ import annotations

from collections.abc import Sequence
from statistics import fmean

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.language.encoders import Encoder
from ...gaussians.language.encoders.probability import probability
from ...gaussians.language.field.group_index import index_groups
from ...gaussians.language.field.group_table import vectors_of
from .._iou import iou
from ..harness import Metric
from .cases import Case, Part

F32 = NDArray[np.float32]


def measure(known: Sequence[Case], encoder: Encoder) -> Part:
    """Mean IoU of kinds that occur once in embedded rooms, and the number of vectors."""
    found: dict[str, list[float]] = {}
    counts: dict[str, list[int]] = {}
    for case in known:
        field = case.scene.language
        assert field is not None
        owner = np.array([g.parent if g.parent >= 0 else g.id for g in field.groups])
        objects, parts = field.embeddings[owner], _of_parts(case, owner, encoder)
        column = case.scene.cloud.group.numpy()
        for kind, truth in ((o.kind, case.truth(o)) for o in case.alone()):
            sure = {
                "of its object": probability(encoder, kind, objects),
                "of its part": probability(encoder, kind, parts),
                "mean of both": probability(encoder, kind, _unit(objects + parts)),
            }
            sure["the likelier of both"] = np.maximum(sure["of its object"], sure["of its part"])
            for name, chance in sure.items():
                chosen = np.append(chance >= encoder.calibration.threshold, False)[column]
                found.setdefault(name, []).append(iou(truth, chosen))
        counts.setdefault("objects", []).append(int(field.embeddings.any(axis=1).sum()))
        counts.setdefault("parts", []).append(int(parts.any(axis=1).sum()))
    metrics = [Metric(f"finer.{name}.miou", fmean(ious), "IoU", "higher", 0.02) for name, ious in found.items()]
    metrics += [Metric(f"finer.vectors.{name}", fmean(each), "a room") for name, each in counts.items()]
    best = max(found, key=lambda name: fmean(found[name]))
    note = f"finer vectors: names are found best by the vector {best}"
    return Part(metrics=tuple(metrics), notes=(note,))


def _of_parts(case: Case, owner: NDArray[np.int64], encoder: Encoder) -> F32:
    """`[G, D]` unit vectors of pictures of each leaf of an object; zero for other groups."""
    scene = case.scene
    assert scene.language is not None
    members, groups = index_groups(scene.cloud), scene.language.groups
    leaves = [g.id if groups[owner[g.id]].level == "object" else -1 for g in groups]
    clouds = [scene.cloud[torch.from_numpy(members.rows([k] if k >= 0 else []))] for k in leaves]
    vectors: F32 = vectors_of(encoder, clouds, scene.frame, scene.cloud)
    return vectors


def _unit(vectors: F32) -> F32:
    """Rows of unit length; rows of zeros stay."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0)

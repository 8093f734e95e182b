"""Evaluate the encoder in furnished rooms with ground-truth segmentation, with the group renders that embedding uses.

This is the upper bound that the encoder sets; any further loss in practice is due to the segmentation.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray

from ..gaussians import assets
from ..gaussians.language.encoders import Encoder
from ..gaussians.language.encoders.probability import labels, probability
from ..gaussians.language.field.embed import embed
from ..gaussians.language.field.posterior import Belief
from ..gaussians.language.segmentation.group_renders import mean_vectors

ABSENT = 6  # absent kinds queried in each room


def judge(encoder: Encoder, seeds: range) -> dict[str, float]:
    """Rates over the rooms of these seeds. Every present kind is queried once, and `ABSENT` absent ones.

    A present kind counts as correct if the most probable object over the threshold is of that kind. An absent kind
    counts as refused if no object is over the threshold.
    """
    plain, sized, right, refused, things = [], [], [], [], 0
    rng = np.random.default_rng(seeds.start)
    for seed in seeds:
        truth, vectors, sizes = _room(encoder, seed)
        things += len(truth)
        plain += [name == t for (name, _), t in zip(labels(encoder, vectors), truth, strict=True)]
        sized += [name == t for (name, _), t in zip(labels(encoder, vectors, sizes), truth, strict=True)]
        away = sorted(set(encoder.vocabulary.names) - set(truth))
        for name in sorted(set(truth)):
            score = probability(encoder, name, vectors, sizes)
            right.append(score.max() >= encoder.calibration.threshold and truth[int(score.argmax())] == name)
        for name in rng.choice(away, size=ABSENT, replace=False).tolist():
            refused.append(probability(encoder, name, vectors, sizes).max() < encoder.calibration.threshold)
    return {
        "rooms": float(len(seeds)),
        "things": float(things),
        "top1": round(float(np.mean(plain)), 4),
        "top1_with_size": round(float(np.mean(sized)), 4),
        "present_right": round(float(np.mean(right)), 4),
        "absent_refused": round(float(np.mean(refused)), 4),
    }


def confidence(encoder: Encoder, seeds: range) -> float:
    """`Calibration.confidence`: mean over the rooms of these seeds, embedded as a user would."""
    scenes = (embed(assets.furnish(seed).scene, encoder) for seed in seeds)
    fields = (scene.language for scene in scenes)
    return round(float(np.mean([Belief(f, encoder, None).confidence for f in fields if f is not None])), 2)


def _room(encoder: Encoder, seed: int) -> tuple[list[str], NDArray[np.float32], NDArray[np.float64]]:
    """Kinds `[G]`, mean vectors `[G, D]` and extents `[G, 3]` in metres of the objects of one room."""
    room = assets.furnish(seed)
    ids = room.truth.ids
    objects = [o for o in room.truth.objects if int((ids == o.id).sum()) > 0]
    clouds = [room.scene.cloud[ids == o.id] for o in objects]
    points = torch.stack([c.means.mean(dim=0) for c in clouds]).double().numpy()
    vectors = mean_vectors(encoder, clouds, room.scene.frame, points.mean(axis=0))
    return [o.kind for o in objects], vectors, np.array([o.size for o in objects], dtype=np.float64)

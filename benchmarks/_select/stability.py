"""Robustness of selection against other thresholds and against floaters in the scene."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from statistics import fmean

import numpy as np
import torch

from ...gaussians.cloud import GaussianCloud, concat
from ...gaussians.language.encoders import Encoder
from .._iou import iou
from ..harness import Metric
from .cases import Case, Part, ask
from .variants import forgetful, with_threshold

THRESHOLDS = (0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8)
FLOATERS = (0.02, 0.1)  # of the Gaussians of the scene, added
LEAST, MOST = 0.01, 0.12  # metres, standard deviation of a floater
FAINT, DENSE = 0.03, 0.4  # opacity of a floater


def names_miou(case: Case, encoder: Encoder) -> list[float]:
    """Intersection over union of every kind that is there once, asked by its bare name."""
    return [iou(case.truth(o), ask(case, o.kind, encoder).mask) for o in case.alone()]


def thresholds(known: Sequence[Case], encoder: Encoder) -> Part:
    """One frozen rule against the best threshold of the other rooms (leave one out), and IoU along the thresholds.

    A room is judged by the mean IoU over its names together with as many absent ones, 1 for a refusal: otherwise the
    lowest threshold would always win.
    """
    frozen = encoder.calibration.threshold
    grid = sorted({*THRESHOLDS, frozen})
    table = np.array([[_both(case, with_threshold(encoder, t)) for t in grid] for case in known])  # [R, T, 2]
    score = table.mean(axis=2)
    own = score[:, grid.index(frozen)]
    others = [score[np.arange(len(known)) != i].mean(axis=0) for i in range(len(known))]
    left_out = [score[i, int(np.argmax(mean))] for i, mean in enumerate(others)]
    metrics = [
        Metric("threshold.frozen", float(own.mean()), "score", "higher", 0.03),
        Metric("threshold.leave_one_out", float(np.mean(left_out)), "score"),
        Metric("threshold.best_of_each_room", float(score.max(axis=1).mean()), "score"),
    ]
    along = ", ".join(f"{t:g}: {a:.2f}/{b:.2f}" for t, (a, b) in zip(grid, table.mean(axis=0), strict=True))
    note = f"threshold ({frozen:g} is frozen), mIoU of names / share of absent names refused: {along}"
    return Part(tuple(metrics), notes=(note,))


def _both(case: Case, encoder: Encoder) -> tuple[float, float]:
    case = forgetful(case)
    kinds = [k for k in encoder.vocabulary.names if k not in case.present]
    absent = np.random.default_rng(case.seed).choice(kinds, len(case.alone()), replace=False)
    refused = fmean(ask(case, str(k), encoder).verdict == "absent" for k in absent)
    return fmean(names_miou(case, encoder)), refused


def floaters(
    rooms: Sequence[Case], encoder: Encoder, grouped: Callable[[Case], Case], shares: Sequence[float] = FLOATERS
) -> Part:
    """Floaters added to rooms before embedding: the mIoU of names, and the share of floaters that join an object."""
    metrics = []
    for share in shares:
        found: list[float] = []
        joined: list[float] = []
        for room in rooms:
            hazy = with_floaters(room, share)
            known = grouped(hazy)
            found += names_miou(known, encoder)
            strays = np.arange(len(hazy.ids)) >= len(room.ids)
            things = [mask for mask in known.groups() if 2 * strays[mask].sum() < mask.sum()]
            joined.append(float(np.logical_or.reduce(things)[strays].mean()))
        metrics.append(Metric(f"floaters.{share:.0%}.miou", fmean(found), "IoU", "higher", 0.03))
        metrics.append(Metric(f"floaters.{share:.0%}.joined", fmean(joined), "share", "lower", 0.2))
    note = (
        f"floaters: faint splats ({FAINT:g} to {DENSE:g} opaque) of {LEAST:g} to {MOST:g} m at random places of the "
        "room; joined: share of them that becomes part of a group of other Gaussians"
    )
    return Part(tuple(metrics), notes=(note,))


def with_floaters(case: Case, share: float) -> Case:
    """The case with `share` as many Gaussians more, strewn through the room's box; the truth knows them as nothing."""
    cloud, g = case.scene.cloud, torch.Generator().manual_seed(case.seed)
    count = round(share * len(cloud))
    low, high = cloud.means.amin(dim=0), cloud.means.amax(dim=0)
    quats = torch.nn.functional.normalize(torch.randn(count, 4, generator=g), dim=1)
    strays = GaussianCloud.create(
        low + torch.rand(count, 3, generator=g) * (high - low),
        quats,
        LEAST * (MOST / LEAST) ** torch.rand(count, 3, generator=g),
        FAINT + (DENSE - FAINT) * torch.rand(count, generator=g),
        torch.randn(count, 1, 3, generator=g) * 0.8,
        ids=torch.arange(count) + int(cloud.ids.max()) + 1,
    )
    ids = np.concatenate([case.ids, np.full(count, -1, np.int32)])
    return replace(case, scene=case.scene.replace(cloud=concat([cloud, strays])), ids=ids)

"""IoU of the floor and of low things on it against the noise of the floor's Gaussians."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from statistics import fmean

import numpy as np
import torch

from ...gaussians import assets
from .._iou import Mask, iou
from ..harness import Metric
from .cases import Case, Part, case_of

NOISES = (0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0)  # centimetres, standard deviation along up
LOW = 0.45  # metres: height of a thing up to which it counts as low
ADDED = ("rug", "books", "shoe", "plate", "box")  # kinds that are put into each room where they fit
FLOOR_LEVEL = 0.02  # metres: structure below it is floor


def measure(seeds: tuple[int, ...], grouped: Callable[[Case], Case]) -> Part:
    """The curve over rooms of some seeds, and the largest fall between neighbouring noises."""
    rooms = [case_of(assets.furnish(seed, include=ADDED), seed) for seed in seeds]
    floors: list[float] = []
    things: list[float] = []
    for noise in NOISES:
        found = [agreement(grouped(with_noise(room, noise / 100)), room) for room in rooms]
        floors.append(fmean(f for f, _ in found))
        things.append(fmean(t for _, each in found for t in each))
    metrics = [
        Metric(f"floor_noise.{noise:g}cm.{name}", value, "IoU", "higher", 0.05)
        for noise, *values in zip(NOISES, floors, things, strict=True)
        for name, value in zip(("floor", "low_things"), values, strict=True)
    ]
    for name, curve in (("floor", floors), ("low_things", things)):
        fall = max(a - b for a, b in pairwise(curve))
        metrics.append(Metric(f"floor_noise.largest_fall.{name}", fall, "IoU", "lower", 0.5, 0.1))
    note = (
        f"floor noise: heights of the floor's Gaussians with Gaussian noise; low things: the best group for each "
        f"thing on the floor up to {LOW:g} m high, in {len(rooms)} rooms"
    )
    return Part(tuple(metrics), notes=(note,))


def with_noise(case: Case, noise: float) -> Case:
    """The case with noise of some metres, standard deviation, in the heights of its floor's Gaussians."""
    if noise == 0:
        return case
    rows = torch.from_numpy(np.flatnonzero(_floor(case)))
    means = case.scene.cloud.means.clone()
    means[rows, 2] += torch.from_numpy(np.random.default_rng(case.seed).normal(0, noise, len(rows))).float()
    return replace(case, scene=case.scene.replace(cloud=case.scene.cloud.replace(means=means)))


def _floor(case: Case) -> Mask:
    """`[N]` the Gaussians of a clean room's floor."""
    result: Mask = (case.ids < 0) & (case.points[:, 2] < FLOOR_LEVEL)
    return result


def agreement(case: Case, clean: Case) -> tuple[float, list[float]]:
    """IoU of the group called floor with the floor of the clean case, and of the best group of each low thing on it."""
    assert case.scene.language is not None
    floor = _floor(clean)
    named = [g.id for g in case.scene.language.groups if g.level == "structure" and g.label == "floor"]
    groups = case.groups()
    low = [o for o in case.objects if o.support == "floor" and o.size[2] < LOW]
    return iou(np.isin(case.scene.cloud.group.numpy(), named), floor), [
        max(iou(mask, case.truth(o)) for mask in groups) for o in low
    ]

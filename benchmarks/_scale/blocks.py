"""Flats of furnished rooms embedded by blocks against embedded whole: what is found by name, what is cut, seconds and
memory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import fmean

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.assets import TruthObject
from ...gaussians.cloud import GaussianCloud, concat
from ...gaussians.files import save
from ...gaussians.language import encoders
from ...gaussians.language.encoders import Encoder
from ...gaussians.language.field.loading import load
from ...gaussians.tiles.making import make
from .._iou import iou
from .._select.cases import Case, ask, furnished
from ..harness import Metric
from .measured import Run, command

SEEDS = (7421, 7431, 7441)  # of the first room of each flat; nothing was fitted on them
ROOMS = 4  # of a flat, two by two
PITCH = 6.0  # metres from one to the next: rooms nearly touch
MEMORY = "3GB"
HELD = 0.8  # share of a thing that its best group holds, below which it is cut


@dataclass(frozen=True)
class _Found:
    """What an embedding of one room found.

    Attributes:
        named: for each thing whose kind is there once, whether it is found by its name.
        best: for each thing, IoU of the best group.
        held: for each thing, the share of it that the best group holds.
        taken: what embedding took.
    """

    named: tuple[bool, ...]
    best: tuple[float, ...]
    held: tuple[float, ...]
    taken: Run


def measured(place: Path, seeds: Sequence[int] = SEEDS) -> list[Metric]:
    """The figures of some rooms; their files are written to `place`."""
    encoder = encoders.load()
    whole, blocks, counts = [], [], []
    for seed in seeds:
        case = _flat(seed)
        source, folder = place / f"{seed}.ply", place / f"{seed}.tiles"
        save(case.scene, source)
        counts.append(len(make([source], folder, most=len(case.ids) // 2).state.tiles))
        whole.append(_found(case, source, command("embed", source), encoder))
        blocks.append(_found(case, folder, command("embed", folder, "--memory", MEMORY), encoder))
    pairs = [pair for w, b in zip(whole, blocks, strict=True) for pair in zip(w.held, b.held, strict=True)]
    cut = [one >= HELD > other for one, other in pairs]
    mended = [other >= HELD > one for one, other in pairs]
    return [
        Metric("embed.flats", len(seeds), "count"),
        Metric("embed.tiles of a flat", fmean(counts), "count"),
        Metric("embed.things", len(pairs), "count"),
        Metric("embed.things that only blocks cut", sum(cut), "count", "lower"),
        Metric("embed.things that only the whole cuts", sum(mended), "count"),
        *_figures("embed.whole", whole),
        *_figures("embed.blocks", blocks),
    ]


def _flat(seed: int) -> Case:
    """Furnished rooms side by side, not embedded; a kind that is in two of them is there twice."""
    first = furnished(seed)
    clouds, ids, objects = list[GaussianCloud](), list[NDArray[np.int32]](), list[TruthObject]()
    for number in range(ROOMS):
        room = furnished(seed + number) if number else first
        step = torch.tensor([PITCH * (number % 2), PITCH * (number // 2), 0.0])
        clouds.append(room.scene.cloud.replace(means=room.scene.cloud.means + step))
        ids.append(np.where(room.ids >= 0, room.ids + len(objects), -1).astype(np.int32))
        objects += [replace(thing, id=thing.id + len(objects)) for thing in room.objects]
    ends = np.cumsum([len(cloud) for cloud in clouds])
    cloud = concat([c.replace(ids=torch.arange(e - len(c), e)) for c, e in zip(clouds, ends, strict=True)])
    return replace(first, scene=first.scene.replace(cloud=cloud), ids=np.concatenate(ids), objects=tuple(objects))


def _found(case: Case, path: Path, taken: Run, encoder: Encoder) -> _Found:
    made = replace(case, scene=load(path))
    named = tuple(ask(made, thing.kind, encoder).means(made.truth(thing)) for thing in made.alone())
    groups, best, held = made.groups(), [], []
    for thing in made.objects:
        truth = made.truth(thing)
        best.append(max((iou(mask, truth) for mask in groups), default=0.0))
        held.append(max((float(np.mean(mask[truth])) for mask in groups), default=0.0))
    return _Found(named, tuple(best), tuple(held), taken)


def _figures(key: str, found: Sequence[_Found]) -> list[Metric]:
    named = [ok for one in found for ok in one.named]
    best = [value for one in found for value in one.best]
    return [
        Metric(f"{key}.found by name", fmean(named), "1", "higher", 0.05),
        Metric(f"{key}.best group", fmean(best), "IoU", "higher", 0.05),
        Metric(f"{key}.processor", fmean(one.taken.processor for one in found), "s", "lower", 0.2),
        Metric(f"{key}.memory", max(one.taken.bytes for one in found) / 2**30, "GiB", "lower", 0.1),
    ]

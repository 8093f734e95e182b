"""Furnished rooms embedded by blocks against embedded whole: what is found by name, what is cut, seconds and memory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import fmean

import numpy as np

from ...gaussians.files import save
from ...gaussians.language import encoders
from ...gaussians.language.encoders import Encoder
from ...gaussians.language.field.loading import load
from ...gaussians.tiles.making import make
from .._iou import iou
from .._select.cases import Case, ask, furnished
from ..harness import Metric
from .measured import Run, command

SEEDS = (7401, 7402, 7403, 7404, 7405, 7406)  # of rooms that nothing was fitted on
TILES = 8  # about so many of each room
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
        case = furnished(seed)
        source, folder = place / f"{seed}.ply", place / f"{seed}.tiles"
        save(case.scene, source)
        counts.append(len(make([source], folder, most=len(case.ids) // (TILES * 4 // 5)).state.tiles))
        whole.append(_found(case, source, command("embed", source), encoder))
        blocks.append(_found(case, folder, command("embed", folder, "--memory", MEMORY), encoder))
    pairs = [pair for w, b in zip(whole, blocks, strict=True) for pair in zip(w.held, b.held, strict=True)]
    cut = [one >= HELD > other for one, other in pairs]
    mended = [other >= HELD > one for one, other in pairs]
    return [
        Metric("embed.rooms", len(seeds), "count"),
        Metric("embed.blocks a room", fmean(counts), "count"),
        Metric("embed.things", len(pairs), "count"),
        Metric("embed.things that only blocks cut", sum(cut), "count", "lower"),
        Metric("embed.things that only the whole cuts", sum(mended), "count"),
        *_figures("embed.whole", whole),
        *_figures("embed.blocks", blocks),
    ]


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

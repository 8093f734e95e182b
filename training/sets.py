"""The sets of pictures for training, calibration and measurement, each rendered once and kept in the cache.

Our own assets are told apart by seeds: training uses seeds from 0, calibration from 10,000, measurement from 20,000.
Objects by other artists are told apart by packs (`strangers.use_of`).
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
import torch

from ..gaussians.language.encoders.vocabulary import Vocabulary
from . import captions, renders, strangers
from .renders import NONE, Crops, Report

CALIBRATION_SEEDS, MEASURING_SEEDS = 10_000, 20_000
HELD_OUT = 8  # seeds of each kind for calibration, and as many for measurement
SHARD = 8  # seeds of each kind that are rendered into one file
VARIED = {"train": 0.65, "calibrate": 0.5, "measure": 0.0}  # share of our assets with another look
VARIANTS = {"train": 10, "calibrate": 3, "measure": 2}  # of each object by others


@dataclass(frozen=True)
class Places:
    """Where the objects by others lie (None: none are used), and where rendered pictures are kept."""

    objects: Path | None
    cache: Path


def vocabulary(objects: bool) -> Vocabulary:
    """The names that are trained: the shown kinds of the world table and, with `objects`, names beyond it."""
    table, kinds = strangers.table(), renders.shown_kinds()
    further = {
        label: (*(n for n in names if n != label), *table.also.get(label, ()))
        for label, names in table.kinds.items()
        if label not in kinds
    }
    return captions.vocabulary(kinds, further if objects else {})


def own(use: strangers.Use, seeds: range, places: Places, report: Report) -> Crops:
    """Our own assets of these seeds."""
    kinds, varied = renders.drawn_kinds(), VARIED[use]
    parts = []
    for first in range(seeds.start, seeds.stop, SHARD):
        some = range(first, min(first + SHARD, seeds.stop))
        key = f"{renders.digest(kinds, some)} {varied}"
        things = partial(renders.things_of_seeds, kinds, some, varied)
        parts.append(renders.cached(use, key, things, places.cache, report))
    return renders.joined(parts)


def by_others(use: strangers.Use, places: Places, report: Report) -> Crops | None:
    """The objects of other artists, by pack; None without them."""
    if places.objects is None:
        return None
    found = [s for s in strangers.listed(places.objects, use) if use != "train" or s.label != strangers.UNNAMED]
    seed = {"train": 0, "calibrate": CALIBRATION_SEEDS, "measure": MEASURING_SEEDS}[use]
    key = " ".join(f"{s.path.name}:{s.label}:{s.path.stat().st_size}" for s in found) + f" {VARIANTS[use]}"
    things = partial(strangers.things, found, VARIANTS[use], seed, unchanged=use == "measure")
    crops = renders.cached(f"others-{use}", key, things, places.cache, report)
    unnamed = crops.labels == strangers.UNNAMED
    return replace(crops, states=np.where(unnamed, NONE, crops.states))


def training(designs: int, places: Places, report: Report) -> list[Crops]:
    """All pictures that the encoder is trained on: `designs` of each kind, and the objects by others."""
    return _both(own("train", range(designs), places, report), by_others("train", places, report))


def held_out(use: strangers.Use, places: Places, report: Report) -> list[Crops]:
    """Unseen designs of our own, and unseen packs of others."""
    first = CALIBRATION_SEEDS if use == "calibrate" else MEASURING_SEEDS
    return _both(own(use, range(first, first + HELD_OUT), places, report), by_others(use, places, report))


def _both(ours: Crops, others: Crops | None) -> list[Crops]:
    return [ours] if others is None else [ours, others]


def main(argv: list[str] | None = None) -> int:
    """Render some of the sets ahead of the training, so that several processes can share the work."""
    parser = argparse.ArgumentParser(prog="python -m scenewright.training.sets", description=main.__doc__)
    parser.add_argument("--objects", type=Path)
    parser.add_argument("--cache", type=Path, default=renders.cache_folder())
    parser.add_argument("--seeds", type=int, nargs=2, help="first and last + 1 seed of our own assets for training")
    parser.add_argument("--others", action="store_true", help="the objects by others, of all uses")
    parser.add_argument("--held-out", action="store_true", help="our own assets for calibration and measurement")
    options = parser.parse_args(argv)
    torch.set_num_threads(1)
    places, start = Places(options.objects, options.cache), time.monotonic()

    def report(line: str) -> None:
        print(f"{time.monotonic() - start:7.1f} s  {line}", file=sys.stderr, flush=True)

    if options.others:
        uses: tuple[strangers.Use, ...] = ("train", "calibrate", "measure")
        for use in uses:
            found = by_others(use, places, report)
            report(f"{use}: {0 if found is None else int((found.states != NONE).sum())} objects by others")
    if options.held_out:
        held_out("calibrate", places, report)
        held_out("measure", places, report)
    if options.seeds:
        for first in range(options.seeds[0], options.seeds[1], SHARD):
            own("train", range(first, min(first + SHARD, options.seeds[1])), places, report)
            report(f"seeds to {first + SHARD}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())

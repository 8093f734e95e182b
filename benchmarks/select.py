"""bench select: names to Gaussians in furnished rooms that were never trained on, and how long embedding takes.

Direct 3D: the selected Gaussians are compared with the object's own, never pixels. The truth lies beside the room and
is read only here. Every score stands beside its ceiling, the best group there is (the oracle).
"""

from __future__ import annotations

import time
from collections import Counter
from dataclasses import dataclass
from statistics import fmean

import numpy as np
from numpy.typing import NDArray

from ..gaussians import assets
from ..gaussians.language import encoders
from ..gaussians.language.embed import embed
from ..gaussians.language.encoders import Encoder
from ..gaussians.language.query import Query
from ..gaussians.language.resolve import resolve
from ..gaussians.language.segment import ASK_VIEWS
from ..gaussians.scene import Scene
from .harness import Metric, Point, Result

FIRST_SEED = 7001  # the merge rule was fitted on rooms from 9000 on, the encoder on single objects
ABSENT = 20  # names of things that are not in the room, asked of each room
RIGHT = 0.5  # intersection over union from which an answer counts as right


@dataclass(frozen=True)
class Room:
    """What one room showed.

    Attributes:
        found: intersection over union of each query for a kind that the room holds once; 0 where it was refused.
        oracle: of the best group for each object of the room.
        refused: whether each absent name was refused.
        ambiguous: queries for one thing that were answered by a question.
        seconds: of embedding.
        bytes: of the field: its column and its table.
    """

    found: list[float]
    oracle: list[float]
    refused: list[bool]
    ambiguous: int
    seconds: float
    bytes: int


def run(quick: bool) -> Result:
    """Embed furnished rooms and ask for what is there once, and for what is not there."""
    seeds = tuple(range(FIRST_SEED, FIRST_SEED + (2 if quick else 10)))
    encoder = encoders.load("auto")
    embed(assets.furnish(seeds[0], detail=0.3).scene, encoder)  # compile and load outside the clock
    settings = [ASK_VIEWS] if quick else sorted({1, 2, ASK_VIEWS, 4})
    measured = {n: [measure(assets.furnish(seed), encoder, n, seed) for seed in seeds] for n in settings}
    points = tuple(
        Point("embedded encoder", f"{n} portraits", fmean(r.seconds for r in rooms), _right(rooms),
              int(fmean(r.bytes for r in rooms)), n == ASK_VIEWS)
        for n, rooms in measured.items()
    )  # fmt: skip
    notes = (
        f"{len(seeds)} rooms of 14 to 28 objects; kinds that a room holds once are asked for by name",
        f"right: IoU of Gaussians at least {RIGHT}; {ABSENT} absent kinds asked of each room",
    )
    title = "Selection by name in furnished rooms from unseen seeds"
    return Result(title, "share of names right", metrics(measured[ASK_VIEWS]), points, notes, seeds)


def measure(room: assets.Room, encoder: Encoder, portraits: int, seed: int) -> Room:
    """Embed one room and ask."""
    start = time.perf_counter()
    scene = embed(room.scene, encoder, portraits=portraits)
    seconds = time.perf_counter() - start
    assert scene.language is not None
    truth = room.truth.ids.numpy()
    group = scene.cloud.group.numpy()
    masks = [np.isin(group, scene.language.leaves(g.id)) for g in scene.language.objects()]
    present = Counter(o.kind for o in room.truth.objects)
    oracle = [max(_iou(m, truth == o.id) for m in masks) for o in room.truth.objects]
    found, ambiguous = [], 0
    for o in room.truth.objects:
        if present[o.kind] == 1:
            mask, verdict = _ask(scene, o.kind, encoder)
            found.append(_iou(mask, truth == o.id))
            ambiguous += verdict == "ambiguous"
    missing = [k for k in assets.kinds() if k not in present]
    asked = np.random.default_rng(seed).choice(missing, ABSENT, replace=False)
    refused = [_ask(scene, str(k), encoder)[1] == "absent" for k in asked]
    size = group.nbytes + scene.language.embeddings.nbytes
    return Room(found, oracle, refused, ambiguous, seconds, size)


def metrics(rooms: list[Room]) -> tuple[Metric, ...]:
    """The figures of the default setting."""
    found = [v for r in rooms for v in r.found]
    oracle = [v for r in rooms for v in r.oracle]
    refused = [v for r in rooms for v in r.refused]
    return (
        Metric("name.right", _right(rooms), "share", "higher", 0.03),
        Metric("name.miou", fmean(found), "IoU", "higher", 0.03),
        Metric("name.ambiguous", sum(r.ambiguous for r in rooms) / len(found), "share", "lower", 0.5),
        Metric("name.asked", len(found), "count"),
        Metric("oracle.miou", fmean(oracle), "IoU", "higher", 0.03),
        Metric("oracle.right", fmean(v >= RIGHT for v in oracle), "share", "higher", 0.03),
        Metric("absent.refused", fmean(refused), "share", "higher", 0.03),
        Metric("absent.asked", len(refused), "count"),
        Metric("embed.seconds", fmean(r.seconds for r in rooms), "s", "lower", 0.3),
    )


def _ask(scene: Scene, name: str, encoder: Encoder) -> tuple[NDArray[np.bool_], str]:
    """Which Gaussians a bare name selects, and the verdict."""
    selection = resolve(scene, Query(text=name), scene.cameras[0], encoder)
    mask: NDArray[np.bool_] = selection.mask(scene.cloud).numpy()
    return mask, selection.verdict


def _iou(a: NDArray[np.bool_], b: NDArray[np.bool_]) -> float:
    return float((a & b).sum()) / max(float((a | b).sum()), 1.0)


def _right(rooms: list[Room]) -> float:
    return fmean(v >= RIGHT for r in rooms for v in r.found)

"""Seconds and bytes: embedding and lifting 150 thousand Gaussians, asking a million, and what the field takes up."""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import fields, is_dataclass, replace
from functools import cached_property
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.language.calibration import Calibration
from ...gaussians.language.encoders import Encoder
from ...gaussians.language.encoders.vocabulary import Vocabulary
from ...gaussians.language.lifting import lift
from ...gaussians.language.masks import ViewMasks
from ...gaussians.language.query import Query
from ...gaussians.language.resolve import resolve
from ...gaussians.language.store import save_field
from ..harness import Metric
from .cases import Case, Part

EMBEDDED, ASKED = 150_000, 1_000_000  # Gaussians
REPEATS = 7


class Remembering:
    """An encoder that encodes a phrase once: what a query costs "after the text is encoded"."""

    def __init__(self, encoder: Encoder) -> None:
        self._encoder = encoder
        self._known: dict[str, NDArray[np.float32]] = {}

    @cached_property
    def fingerprint(self) -> str:
        return self._encoder.fingerprint

    @cached_property
    def dim(self) -> int:
        return self._encoder.dim

    @cached_property
    def image_size(self) -> int:
        return self._encoder.image_size

    @cached_property
    def vocabulary(self) -> Vocabulary:
        return self._encoder.vocabulary

    @cached_property
    def calibration(self) -> Calibration:
        return self._encoder.calibration

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        new = [t for t in texts if t not in self._known]
        if new:
            self._known.update(zip(new, self._encoder.encode_text(new), strict=True))
        return np.stack([self._known[t] for t in texts])

    def encode_images(self, images: NDArray[np.uint8]) -> NDArray[np.float32]:
        return self._encoder.encode_images(images)

    def unknown_words(self, text: str) -> tuple[str, ...]:
        return self._encoder.unknown_words(text)

    def knows(self, text: str) -> bool:
        return self._encoder.knows(text)


def resized(case: Case, count: int) -> Case:
    """The case at exactly `count` Gaussians: rows dropped evenly, or laid beside themselves within their footprints."""
    cloud, have = case.scene.cloud, len(case.scene.cloud)
    rows = torch.linspace(0, have - 1, count).round().long() if count < have else torch.arange(count) % have
    taken = cloud[rows]
    g = torch.Generator().manual_seed(case.seed)
    along = torch.randn(count, 3, generator=g) * taken.scales * (torch.arange(count) >= have)[:, None]
    w, xyz = taken.quats[:, :1], taken.quats[:, 1:]
    turned = along + 2 * torch.linalg.cross(xyz, torch.linalg.cross(xyz, along) + w * along)
    taken = taken.replace(means=taken.means + turned, ids=torch.arange(count))
    return replace(case, scene=case.scene.replace(cloud=taken), ids=case.ids[rows.numpy()])


def queries(case: Case) -> dict[str, Query]:
    """One of each kind of query that this room has an answer to."""
    kinds = [o.kind for o in case.alone()]
    one, two, three = kinds[0], kinds[1], kinds[2]
    anchor = [{"text": two}]
    written: dict[str, dict[str, Any]] = {
        "name": {"text": one},
        "absent name": {"text": "piano"},
        "name and colour": {"text": one, "colors": ["red"]},
        "relation": {"text": one, "relations": [{"name": "left_of", "anchors": anchor}]},
        "nearest": {"text": "", "relations": [{"name": "nearest_to", "anchors": anchor}]},
        "between": {"text": "", "pick": "any",
                    "relations": [{"name": "between", "anchors": [{"text": two}, {"text": three}]}]},
        "largest": {"text": "", "pick": "largest"},
        "union": {"text": one, "also": [{"text": two}]},
        "everything but": {"text": one, "pick": "rest"},
        "colour of parts": {"text": "part", "colors": ["red"], "pick": "all"},
    }  # fmt: skip
    return {name: Query.model_validate(query) for name, query in written.items()}


def measure(room: Case, encoder: Encoder, grouped: Callable[[Case], Case], views: Sequence[ViewMasks]) -> Part:
    """All costs, on one furnished room; `views` are the masks that are lifted, drawn of this very room at 150k."""
    known = grouped(resized(room, EMBEDDED))
    assert known.scene.language is not None
    lifting = _least(lambda: lift(known.scene.cloud, views), 2)
    metrics = [
        Metric("embed.150k.seconds", known.seconds, "s", "lower", 0.3),
        Metric("lift.150k.seconds", lifting, "s", "lower", 0.3),
        Metric("lift.150k.views", len(views), "count"),
    ]
    metrics += _queries(resized(known, ASKED), encoder)
    metrics += _memory(known)
    note = (
        f"costs: one furnished room brought to {EMBEDDED:,} Gaussians, with its field to {ASKED:,}; a query is timed "
        "after its text is encoded, to the ids of the Gaussians; the column of groups is int32, saved as it is held"
    )
    return Part(tuple(metrics), notes=(note,))


def _queries(known: Case, encoder: Encoder) -> list[Metric]:
    remembering = Remembering(encoder)
    seconds = {}
    for name, query in queries(known).items():

        def once(query: Query = query) -> None:
            resolve(known.scene, query, known.scene.cameras[0], remembering)

        once()
        seconds[name] = _least(once, REPEATS)
    each = [Metric(f"query.1m.{n.replace(' ', '_')}", s * 1e3, "ms", "lower", 0.3) for n, s in seconds.items()]
    return [Metric("query.1m.median", median(seconds.values()) * 1e3, "ms", "lower", 0.3), *each]


def _memory(known: Case) -> list[Metric]:
    """A column's bytes a Gaussian and the rest's bytes a group, as held and as saved."""
    field = known.scene.language
    assert field is not None
    column = known.scene.cloud.group
    held = field.embeddings.nbytes + sum(_size(g) for g in field.groups)
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "scene"
        place.write_bytes(b"scene")
        saved = save_field(known.scene, place).stat().st_size
    count, groups = len(column), len(field.groups)
    return [
        Metric("memory.bytes_per_gaussian", column.element_size(), "B", "lower"),
        Metric("memory.bytes_per_group", held / groups, "B", "lower", 0.2),
        Metric("memory.saved.bytes_per_gaussian", column.element_size(), "B", "lower"),
        Metric("memory.saved.bytes_per_group", (saved - column.element_size() * count) / groups, "B", "lower", 0.2),
        Metric("memory.groups", groups, "count"),
    ]


def _size(value: Any) -> int:
    """Bytes of a row of the table with all that it holds."""
    size = sys.getsizeof(value)
    if is_dataclass(value):
        return size + sys.getsizeof(vars(value)) + sum(_size(getattr(value, f.name)) for f in fields(value))
    return size + (sum(_size(v) for v in value) if isinstance(value, tuple) else 0)


def _least(work: Callable[[], object], repeats: int) -> float:
    best = float("inf")
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - start)
    return best

"""Costs: seconds for embedding and lifting 150,000 Gaussians and querying a million, and the memory of the field."""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from statistics import median
from typing import Any

import torch

from ...gaussians.language.encoders import Encoder
from ...gaussians.language.field.store import save_field
from ...gaussians.language.masks.lifting import lift
from ...gaussians.language.query.query import Query
from ...gaussians.language.query.resolve import resolve
from ..harness import Metric
from . import pictures
from .cases import Case, Part
from .variants import remembering

EMBEDDED, ASKED = 150_000, 1_000_000  # Gaussians
VIEWS, QUICK_VIEWS, SIZE = 24, 8, 256  # pictures that are lifted, and their pixels a side
REPEATS, QUICK_REPEATS = 7, 2


def resized(case: Case, count: int) -> Case:
    """The case with exactly `count` Gaussians: rows dropped evenly, or duplicated with offsets within their extent."""
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
        "colour alone": {"text": "gizmo", "colors": ["brown"]},
        "every colour": {"text": "gizmo", "colors": ["gray"], "pick": "all"},
    }  # fmt: skip
    return {name: Query.model_validate(query) for name, query in written.items()}


def measure(room: Case, encoder: Encoder, grouped: Callable[[Case], Case], quick: bool) -> Part:
    """All costs, on one furnished room."""
    sized = resized(room, EMBEDDED)
    eyes = pictures.eyes(sized.scene, QUICK_VIEWS if quick else VIEWS, SIZE)
    views = [pictures.true_masks(sized, eye, pictures.Crops(encoder), i).masks for i, eye in enumerate(eyes)]
    known = grouped(sized)
    assert known.scene.language is not None
    lifting = _least(lambda: lift(known.scene.cloud, views), 2)
    metrics = [
        Metric("embed.150k.seconds", known.seconds, "s", "lower", 0.3, 20.0),
        Metric("lift.150k.seconds", lifting, "s", "lower", 0.3, 5.0),
        Metric("lift.150k.views", len(views), "count"),
    ]
    metrics += _queries(resized(known, ASKED), encoder, QUICK_REPEATS if quick else REPEATS)
    metrics += _whole_calls(resized(known, ASKED), encoder, QUICK_REPEATS if quick else REPEATS)
    metrics += _memory(known)
    note = (
        f"costs: one furnished room resampled to {EMBEDDED:,} Gaussians, for queries with its field to {ASKED:,}. The "
        "time of a query runs from the encoded text to the ids of the Gaussians; that of a whole call is "
        "`Session.select`, the median of calls after the first, which makes what is kept for the cloud. The column of "
        "groups is int32, in memory and in the file"
    )
    return Part(tuple(metrics), notes=(note,))


def _queries(known: Case, encoder: Encoder, repeats: int) -> list[Metric]:
    known_words = remembering(encoder)
    seconds = {}
    for name, query in queries(known).items():

        def once(query: Query = query) -> None:
            resolve(known.scene, query, known.scene.cameras[0], known_words)

        once()
        seconds[name] = _least(once, repeats)
    each = [Metric(f"query.1m.{n.replace(' ', '_')}", s * 1e3, "ms", "lower", 0.3) for n, s in seconds.items()]
    return [Metric("query.1m.median", median(seconds.values()) * 1e3, "ms", "lower", 0.3, 5.0), *each]


def _whole_calls(known: Case, encoder: Encoder, repeats: int) -> list[Metric]:
    """`Session.select` of each kind of query: the first call of a session that asks nothing else, and later ones."""
    from ...agent.session.session import Session

    each, first = [], []
    session = Session(known.scene, "grammar", encoder, viewer=known.scene.cameras[0], vlm=None)
    for name, query in queries(known).items():
        seconds = []
        for _ in range(repeats + 1):
            start = time.perf_counter()
            session.select(query)
            seconds.append(time.perf_counter() - start)
        first.append(seconds[0])
        each.append(Metric(f"call.1m.{name.replace(' ', '_')}", median(seconds[1:]) * 1e3, "ms", "lower", 0.3, 10.0))
    return [
        Metric("call.1m.median", median(m.value for m in each), "ms", "lower", 0.3, 10.0),
        Metric("call.1m.slowest_first", max(first) * 1e3, "ms", "lower", 0.3),
        *each,
    ]


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
        Metric("memory.bytes_per_gaussian", column.element_size(), "B", "lower", 0.0, 4.0),
        Metric("memory.bytes_per_group", held / groups, "B", "lower", 0.2, 4096.0),
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

"""bench stability: what disturbances do to selection, edits, words and files, and the level at which each breaks.

Rooms of a few seeds are spoiled in one respect at rising levels; what breaks first stands on top. Everything is
compared with the same rooms, edits or words undisturbed. Laws, such as hashes after an undo, may lose nothing at all.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

from ..gaussians.language import encoders
from ._rows import BREAKS, Row
from ._stability import edits, fits, masked, models, queries, scenes, staged_things, stored, threads, words
from ._stability.ground import Ground
from .harness import Metric, Result

GOAL_ROWS = 40
_PARTS: tuple[Callable[[Ground], Iterator[Row]], ...] = (
    scenes.rows, queries.rows, staged_things.rows, masked.rows, fits.rows, edits.rows, stored.rows, threads.rows,
    words.rows, models.rows,
)  # fmt: skip


def run(quick: bool) -> Result:
    """Every row. Quick: one room, and the few rows and levels of each theme that cost least."""
    started = time.process_time()
    ground = Ground(encoders.load("auto"), quick)
    rows = tuple(row for part in _PARTS for row in part(ground))
    broken = [row for row in rows if row.breaks_at is not None]
    metrics = (
        Metric("rows", len(rows), "count", "higher", 0.0, None if quick else GOAL_ROWS),
        Metric("rows.broken", len(broken), "count", "lower", 0.1),
        Metric("laws.broken", sum(row.law for row in broken), "count", "lower", 0.0, 0),
        Metric("cpu", time.process_time() - started, "s", "lower", 0.5),
        *(row.metric() for row in rows),
    )
    notes = (
        f"A row breaks at the first level that loses more than {BREAKS:.0%} of its baseline; a law, at any loss. The "
        "worst level is that with the least figure, not always the last.",
        f"Rooms: furnished from {len(ground.seeds)} seed(s), detail {ground.detail:g}, each disturbed before it is "
        "embedded; IoU is the mean over every kind that a room holds once, asked by its bare name. Embedding is a "
        "sequence of decisions, so that figures above the baseline are as likely as small losses.",
        "query.*: rooms embedded once. words.*: a written room; the share of texts that do, or answer, what the plain "
        "text does. edit.*: things of the first room. Processor seconds are of this process alone.",
    )
    return Result("what breaks first", "share of the baseline", metrics, (), notes, ground.seeds, rows=rows)

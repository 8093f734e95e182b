"""Runs a batch: each job that has no receipt yet, by an engine, its results and its receipt into a place."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from ...gaussians.files.remote import is_url
from ..urls import urls
from .engines import Engine
from .jobs import Job
from .places import Folder, Place, Receipt
from .store import Store
from .working import Outcome

INTERRUPTED = 130  # exit code of a command line that Ctrl-C ended
_CHANGED = "what it reads changed while it ran; run the batch again when that is complete"


@dataclass
class Totals:
    """How far a batch is.

    Attributes:
        jobs: all of them.
        kept: that were done before, or are the same as another.
        done, failed: in this run.
        seconds: by the clock, of this run.
        receipts: of all jobs, in their order.
    """

    jobs: int
    kept: int = 0
    done: int = 0
    failed: int = 0
    seconds: float = 0.0
    receipts: list[Receipt] = field(default_factory=list)

    @property
    def left(self) -> float:
        """Estimated seconds until all are done."""
        ended = self.done + self.failed
        return self.seconds / ended * (self.jobs - self.kept - ended) if ended else float("nan")


def place_of(out: str | Path) -> Place:
    """The place of a batch: a folder, or a URL of a store."""
    return Store(out) if isinstance(out, str) and is_url(out) else Folder(Path(out))


def run_batch(
    jobs: Sequence[Job], out: str | Path, engine: Engine, *, again: bool = False,
    on_receipt: Callable[[Receipt, Totals], None] = lambda receipt, totals: None,
) -> Totals:  # fmt: skip
    """Do what is not done yet.

    Args:
        out: folder or URL of the batch; the same one goes on where it stopped.
        again: also do what failed before once more.
        on_receipt: called for each job that ends in this run.

    Raises:
        FileError: the place cannot be written.
        UserError: another batch works in it, or a job asks for what no worker has.
    """
    place = place_of(out)
    with place.locked():
        started = time.perf_counter()
        keys = {job.id: job.key() for job in jobs}
        known = place.known(jobs, keys.values())
        if again:
            known = {key: receipt for key, receipt in known.items() if receipt["code"] == 0}
        first = dict[str, Job]()
        for job in jobs:
            if keys[job.id] not in known:
                first.setdefault(keys[job.id], job)
        totals = Totals(len(jobs), len(jobs) - len(first))
        tasks = {key: place.task(job) for key, job in first.items()}
        for key, outcome in engine.outcomes(tasks):
            if outcome["code"] == INTERRUPTED:  # not its failure: it is done next time
                raise KeyboardInterrupt
            receipt = place.settle(first[key], key, tasks[key], _of_what_was_read(first[key], key, outcome))
            known[key] = receipt
            totals.done += receipt["code"] == 0
            totals.failed += receipt["code"] != 0
            totals.seconds = time.perf_counter() - started
            on_receipt(receipt, totals)
        totals.seconds = time.perf_counter() - started
        totals.receipts = [{**known[keys[job.id]], "id": job.id, **_same(known[keys[job.id]], job)} for job in jobs]
        place.finish(totals.receipts)
    return totals


def _of_what_was_read(job: Job, key: str, outcome: Outcome) -> Outcome:
    """The outcome, unless a URL that the job reads has other content now: then it is not known what was read."""
    if outcome["code"] or not urls(job.run) or job.key() == key:
        return outcome
    return Outcome(code=4, result=None, messages=_CHANGED, seconds=outcome["seconds"])


def _same(receipt: Receipt, job: Job) -> Receipt:
    """Says so where a job is the same as another, which was done."""
    return {} if receipt["id"] == job.id else {"same_as": receipt["id"]}

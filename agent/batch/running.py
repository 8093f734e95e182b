"""Runs a batch: each job that has no receipt yet, into a folder of its own that appears when the job is done.

    OUT/receipts/KEY.json   a job that is done, or failed
    OUT/ID/                 its results
    OUT/.work/              what is under way; nothing in it counts

A job counts as done when its receipt is there. Its results are renamed into place before, so that a stop at any moment,
a kill included, loses what was under way and nothing else.
"""

from __future__ import annotations

import fcntl
import json
import os
import secrets
import shutil
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ...gaussians.errors import FileError, UserError
from ...gaussians.files import writing
from .engines import Engine
from .jobs import Job, arguments
from .working import Outcome, Task

Receipt = dict[str, Any]
MARK = ".job"  # in a folder of results: the key of the job
_STRANGE = "{place} is there and no batch wrote it; give the batch another folder, or the job another id"
INTERRUPTED = 130  # exit code of a command line that Ctrl-C ended


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


def run_batch(
    jobs: Sequence[Job], out: Path, engine: Engine, *, again: bool = False,
    on_receipt: Callable[[Receipt, Totals], None] = lambda receipt, totals: None,
) -> Totals:  # fmt: skip
    """Do what is not done yet.

    Args:
        out: folder of the batch; the same one goes on where it stopped.
        again: also do what failed before once more.
        on_receipt: called for each job that ends in this run.

    Raises:
        FileError: the folder cannot be written, or another batch works in it.
    """
    with _locked(out):
        started, work = time.perf_counter(), out / ".work"
        shutil.rmtree(work, ignore_errors=True)
        keys = {job.id: job.key() for job in jobs}
        known = {key: receipt for key in set(keys.values()) if (receipt := _read(out, key)) is not None}
        strange = [out / job.id for job in jobs if (out / job.id).exists() and _of(out / job.id) is None]
        if strange:
            raise UserError(_STRANGE.format(place=strange[0]))
        if again:
            known = {key: receipt for key, receipt in known.items() if receipt["code"] == 0}
        first = dict[str, Job]()
        for job in jobs:
            if keys[job.id] not in known:
                first.setdefault(keys[job.id], job)
        totals = Totals(len(jobs), len(jobs) - len(first))
        tasks = {key: _task(job, work) for key, job in first.items()}
        for key, outcome in engine.outcomes(tasks):
            if outcome["code"] == INTERRUPTED:  # not its failure: it is done next time
                raise KeyboardInterrupt
            receipt = _settled(out, first[key], key, Path(tasks[key].folder), outcome)
            known[key] = receipt
            totals.done += receipt["code"] == 0
            totals.failed += receipt["code"] != 0
            totals.seconds = time.perf_counter() - started
            on_receipt(receipt, totals)
        totals.seconds = time.perf_counter() - started
        totals.receipts = [{**known[keys[job.id]], "id": job.id, **_same(known[keys[job.id]], job)} for job in jobs]
        with writing(out / "receipts.jsonl", force=True) as file:
            file.write("".join(json.dumps(r, ensure_ascii=False) + "\n" for r in totals.receipts).encode())
        shutil.rmtree(work, ignore_errors=True)
    return totals


def _task(job: Job, work: Path) -> Task:
    """A job in a new folder, of which only this run knows."""
    folder = str((work / f"{job.id}-{secrets.token_hex(4)}").absolute())
    return Task(arguments(job.run, folder), folder)


def _same(receipt: Receipt, job: Job) -> Receipt:
    """Says so where a job is the same as another, which was done."""
    return {} if receipt["id"] == job.id else {"same_as": receipt["id"]}


def _settled(out: Path, job: Job, key: str, folder: Path, outcome: Outcome) -> Receipt:
    """Move the results of a job into place, then write its receipt."""
    place = out / job.id
    if place.exists() and not (place / MARK).is_file():  # another program wrote it since the batch began
        raise UserError(_STRANGE.format(place=place))
    empty = not folder.is_dir() or not any(folder.iterdir())
    shutil.rmtree(place, ignore_errors=True)  # of an earlier run that was stopped before its receipt, or of other words
    if not empty and outcome["code"] == 0:
        (folder / MARK).write_text(key, encoding="utf-8")
        os.replace(folder, place)
        outcome = _renamed(outcome, str(folder), str(place))
    receipt: Receipt = {
        "id": job.id, "key": key, "run": list(job.run), **outcome,
        "folder": job.id if not empty and outcome["code"] == 0 else None,
    }  # fmt: skip
    with writing(_receipt(out, key), force=True) as file:
        file.write(json.dumps(receipt, ensure_ascii=False).encode())
    return receipt


def _renamed(outcome: Outcome, old: str, new: str) -> Outcome:
    """What a job printed, with the folder in which its results are now."""
    told = json.dumps([outcome["result"], outcome["messages"]]).replace(json.dumps(old)[1:-1], json.dumps(new)[1:-1])
    result, messages = json.loads(told)
    return Outcome(code=outcome["code"], result=result, messages=messages, seconds=outcome["seconds"])


def _receipt(out: Path, key: str) -> Path:
    return out / "receipts" / f"{key}.json"


def _read(out: Path, key: str) -> Receipt | None:
    """A receipt, if its job is done and its results are there."""
    try:
        receipt: Receipt = json.loads(_receipt(out, key).read_text(encoding="utf-8"))
        folder = receipt["folder"]
        whole = isinstance(receipt["code"], int) and receipt["key"] == key
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return receipt if whole and (folder is None or _of(out / str(folder)) == key) else None


def _of(folder: Path) -> str | None:
    """The key of the job whose results a folder holds; None if it holds those of none."""
    try:
        return (folder / MARK).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return None


@contextmanager
def _locked(out: Path) -> Iterator[None]:
    """The batch's folder, for this process alone."""
    with ExitStack() as stack:
        try:
            (out / "receipts").mkdir(parents=True, exist_ok=True)
            lock = stack.enter_context(open(out / ".lock", "w", encoding="utf-8"))
        except OSError as error:
            raise FileError(f"cannot write into {out}: {error.strerror or error}; choose another folder") from error
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise UserError(f"another batch works in {out}; wait for it, or choose another folder") from error
        yield

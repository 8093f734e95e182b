"""Where the results and receipts of a batch are: a folder of this machine, see `Folder`, or a URL, see `store.Store`.

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
from collections.abc import Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from pathlib import Path
from typing import Any, Protocol

from ...gaussians.errors import FileError, UserError
from ...gaussians.files import writing
from .jobs import Job, arguments
from .working import Outcome, Task, renamed

Receipt = dict[str, Any]
MARK = ".job"  # in a folder of results: the key of the job
BUSY = "another batch works in {place}; wait for it, or choose another folder"
_STRANGE = "{place} is there and no batch wrote it; give the batch another folder, or the job another id"


class Place(Protocol):
    """Keeps results and receipts."""

    def locked(self) -> AbstractContextManager[None]:
        """The place, for this batch alone. Raises UserError if another batch works in it."""
        ...

    def known(self, jobs: Sequence[Job], keys: Iterable[str]) -> dict[str, Receipt]:
        """The receipts of jobs whose results are there, by key. Raises UserError for results that no batch wrote."""
        ...

    def task(self, job: Job) -> Task:
        """What a worker is told; a place for its results that only this run knows."""
        ...

    def settle(self, job: Job, key: str, task: Task, outcome: Outcome) -> Receipt:
        """Make results count: put them into place, then write the receipt."""
        ...

    def finish(self, receipts: Sequence[Receipt]) -> None:
        """Write all receipts as one file, and remove what does not count."""
        ...


def receipt_of(job: Job, key: str, outcome: Outcome, folder: str | None) -> Receipt:
    """The receipt of a job: what it is, what came of it, and where its results are in the batch's folder."""
    asked = {"resources": job.resources.asked()} if job.resources.asked() else {}
    return {"id": job.id, "key": key, "run": list(job.run), **asked, **outcome, "folder": folder}


def lines(receipts: Sequence[Receipt]) -> bytes:
    """Receipts as JSON Lines."""
    return "".join(json.dumps(receipt, ensure_ascii=False) + "\n" for receipt in receipts).encode()


def parsed(text: str | bytes, key: str) -> Receipt | None:
    """A receipt of a job; None of what is torn or of another job."""
    try:
        receipt: Receipt = json.loads(text)
        whole = isinstance(receipt["code"], int) and receipt["key"] == key and "folder" in receipt
    except (ValueError, KeyError, TypeError):
        return None
    return receipt if whole else None


class Folder:
    """A folder of this machine, or one that machines share."""

    def __init__(self, out: Path) -> None:
        self._out, self._work = out, out / ".work"

    @contextmanager
    def locked(self) -> Iterator[None]:
        """See `Place`."""
        with ExitStack() as stack:
            try:
                (self._out / "receipts").mkdir(parents=True, exist_ok=True)
                lock = stack.enter_context(open(self._out / ".lock", "w", encoding="utf-8"))
            except OSError as error:
                told = error.strerror or error
                raise FileError(f"cannot write into {self._out}: {told}; choose another folder") from error
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                raise UserError(BUSY.format(place=self._out)) from error
            shutil.rmtree(self._work, ignore_errors=True)
            yield

    def known(self, jobs: Sequence[Job], keys: Iterable[str]) -> dict[str, Receipt]:
        """See `Place`."""
        found = {key: receipt for key in set(keys) if (receipt := self._read(key)) is not None}
        strange = [folder for job in jobs if (folder := self._out / job.id).exists() and _of(folder) is None]
        if strange:
            raise UserError(_STRANGE.format(place=strange[0]))
        return found

    def task(self, job: Job) -> Task:
        """See `Place`."""
        folder = str((self._work / f"{job.id}-{secrets.token_hex(4)}").absolute())
        return Task(arguments(job.run, folder), folder, resources=job.resources)

    def settle(self, job: Job, key: str, task: Task, outcome: Outcome) -> Receipt:
        """See `Place`."""
        place, folder = self._out / job.id, Path(task.folder)
        if place.exists() and not (place / MARK).is_file():  # another program wrote it since the batch began
            raise UserError(_STRANGE.format(place=place))
        empty = not folder.is_dir() or not any(folder.iterdir())
        shutil.rmtree(place, ignore_errors=True)  # of a run that was stopped before its receipt, or of other words
        if not empty and outcome["code"] == 0:
            (folder / MARK).write_text(key, encoding="utf-8")
            os.replace(folder, place)
            outcome = renamed(outcome, str(folder), str(place))
        receipt = receipt_of(job, key, outcome, job.id if not empty and outcome["code"] == 0 else None)
        with writing(self._receipt(key), force=True) as file:
            file.write(json.dumps(receipt, ensure_ascii=False).encode())
        return receipt

    def finish(self, receipts: Sequence[Receipt]) -> None:
        """See `Place`."""
        with writing(self._out / "receipts.jsonl", force=True) as file:
            file.write(lines(receipts))
        shutil.rmtree(self._work, ignore_errors=True)

    def _receipt(self, key: str) -> Path:
        return self._out / "receipts" / f"{key}.json"

    def _read(self, key: str) -> Receipt | None:
        """A receipt, if its job is done and its results are there."""
        try:
            receipt = parsed(self._receipt(key).read_bytes(), key)
        except OSError:
            return None
        folder = None if receipt is None else receipt["folder"]
        return receipt if folder is None or _of(self._out / str(folder)) == key else None


def _of(folder: Path) -> str | None:
    """The key of the job whose results a folder holds; None if it holds those of none."""
    try:
        return (folder / MARK).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return None

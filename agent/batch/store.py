"""A batch in a store that is reached by URL, such as an object store: nothing can be renamed there.

    OUT/receipts/KEY.json   a job that is done, or failed; it names its results with their sizes, and is written last
    OUT/ID/ATTEMPT/         results, in a folder of each attempt; only that which a receipt names counts
    OUT/lock.json           the batch that works here, which says so again all the time

A worker writes its results itself. An attempt never writes where another one does, so that a worker that was given up
and still writes harms nothing. A receipt is made only where there is none.
"""

from __future__ import annotations

import json
import os
import secrets
import socket
import threading
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from ...gaussians.errors import FileError, UserError
from ...gaussians.files.remote import cleaned, opened, reaching
from .jobs import Job
from .places import BUSY, Receipt, lines, parsed, receipt_of
from .working import Outcome, Task

BEAT = 10.0  # seconds between signs of life
LEASE = 45.0  # seconds without one after which a batch of another machine counts as dead
_LOOK = 1.0
_LOST = "another batch took over {place} while this one was not heard of; results that have receipts are kept"
_NOT_THERE = "the results of the job did not arrive in {place}; is it a store that all workers reach?"


class Store:
    """A place by URL."""

    def __init__(self, url: str) -> None:
        self._url, self.shown = url.rstrip("/"), cleaned(url.rstrip("/"))
        self._fs, root = opened(self._url)
        self._root = root.rstrip("/")
        self._torn = set[str]()  # keys whose receipts are there and do not count
        self._lock: _Lock | None = None

    @contextmanager
    def locked(self) -> Iterator[None]:
        """See `Place`."""
        with suppress(Exception):  # object stores have no folders; those that have and refuse say so below
            self._fs.makedirs(f"{self._root}/receipts", exist_ok=True)
        self._lock = _Lock(self._fs, f"{self._root}/lock.json", self._url)
        self._lock.take()
        try:
            yield
        finally:
            self._lock.release()

    def known(self, jobs: Sequence[Job], keys: Iterable[str]) -> dict[str, Receipt]:
        """See `Place`."""
        with reaching(self._url):
            sizes = self._sizes(self._root)
            paths = {f"{self._root}/receipts/{key}.json": key for key in set(keys)}
            there = [path for path in paths if path in sizes]
            texts = self._fs.cat(there) if there else {}
            texts = texts if isinstance(texts, dict) else {there[0]: texts}
        found = {paths[path]: parsed(texts[path], paths[path]) for path in there}
        whole = {key: one for key, one in found.items() if one is not None and self._complete(one, sizes)}
        self._torn = set(found) - set(whole)
        return whole

    def task(self, job: Job) -> Task:
        """See `Place`."""
        run = [*job.run] if "--json" in job.run else [*job.run, "--json"]
        return Task(run, f"scenewright-batch-{secrets.token_hex(8)}", f"{self._url}/{job.id}", job.resources)

    def settle(self, job: Job, key: str, task: Task, outcome: Outcome) -> Receipt:
        """See `Place`."""
        written = outcome.get("written") if outcome["code"] == 0 else None
        folder = f"{job.id}/{written}" if written else None
        receipt = receipt_of(job, key, outcome, folder)
        if folder is not None:
            with reaching(self._url):
                sizes = self._sizes(f"{self._root}/{folder}")
            if not self._complete(receipt, sizes):
                said = _NOT_THERE.format(place=self.shown)
                receipt = receipt_of(job, key, Outcome(code=4, result=None, messages=said, seconds=0.0), None)
        assert self._lock is not None
        self._lock.check()
        path = f"{self._root}/receipts/{key}.json"
        text = json.dumps(cleaned_in(receipt), ensure_ascii=False).encode()
        with reaching(self._url, "write into"):
            if key in self._torn or not created(self._fs, path, text):
                other = None if key in self._torn else parsed(self._fs.cat_file(path), key)
                if other is not None and other["code"] == 0:
                    return other  # a batch that took over was first
                self._fs.pipe_file(path, text)
        made = parsed(text, key)
        assert made is not None
        return made

    def finish(self, receipts: Sequence[Receipt]) -> None:
        """See `Place`."""
        assert self._lock is not None
        self._lock.check()
        with reaching(self._url, "write into"):
            self._fs.pipe_file(f"{self._root}/receipts.jsonl", lines(receipts))
            counted = {receipt["folder"] for receipt in receipts}
            for job in {receipt["id"] for receipt in receipts}:
                folders = {path[len(self._root) + 1 :].split("/")[1] for path in self._sizes(f"{self._root}/{job}")}
                for attempt in folders:
                    if _is_attempt(attempt) and f"{job}/{attempt}" not in counted:
                        self._fs.rm(f"{self._root}/{job}/{attempt}", recursive=True)

    def _sizes(self, root: str) -> dict[str, int]:
        """Bytes of each file below a path."""
        self._fs.invalidate_cache()
        with suppress(FileNotFoundError):
            return {str(path): int(info["size"]) for path, info in self._fs.find(root, detail=True).items()}
        return {}

    def _complete(self, receipt: Receipt, sizes: dict[str, int]) -> bool:
        """Whether all files that a receipt names are there."""
        files: dict[str, int] = receipt.get("files") or {}
        return all(sizes.get(f"{self._root}/{receipt['folder']}/{name}") == size for name, size in files.items())


def created(fs: Any, path: str, data: bytes) -> bool:
    """Write a file that is not there; False if it is. Where a store cannot decide that itself, it is asked before."""
    try:
        if getattr(fs, "async_impl", False):
            fs.pipe_file(path, data, mode="create")
        else:
            with fs.open(path, "xb") as file:
                file.write(data)
        return True
    except FileExistsError:
        return False
    except (NotImplementedError, TypeError, ValueError):
        fs.invalidate_cache()
        if fs.exists(path):
            return False
        fs.pipe_file(path, data)
        return True


def cleaned_in(value: Any) -> Any:
    """A value as JSON has it, whose texts tell no secrets of URLs."""
    if isinstance(value, str):
        return cleaned(value)
    if isinstance(value, dict):
        return {key: cleaned_in(inner) for key, inner in value.items()}
    return [cleaned_in(inner) for inner in value] if isinstance(value, list) else value


def _is_attempt(name: str) -> bool:
    return len(name) == 32 and not set(name) - set("0123456789abcdef")


class _Lock:
    """A file that says which batch works in a store, written again all the time.

    The batch of a process that is gone from this machine is not waited for; one of another machine is watched: what
    says nothing new for `LEASE` seconds, by the clock here, is gone.
    """

    def __init__(self, fs: Any, path: str, url: str) -> None:
        self._fs, self._path, self._url = fs, path, url
        self._mine = {"token": secrets.token_hex(8), "host": _host(), "process": os.getpid(), "since": _born()}
        self._beats, self._taken, self._ended = 0, False, threading.Event()
        self._thread = threading.Thread(target=self._beat, daemon=True)

    def take(self) -> None:
        """Raises UserError if another batch works here."""
        with reaching(self._url, "write into"):
            seen, since = b"", time.monotonic()
            while not created(self._fs, self._path, self._said()):
                said = self._read()
                if said is None:
                    continue
                if (seen and said != seen) or _alive(said) is True:
                    raise UserError(BUSY.format(place=cleaned(self._url)))
                if _alive(said) is False or time.monotonic() - since > LEASE:
                    with suppress(FileNotFoundError):
                        self._fs.rm_file(self._path)
                    continue
                seen = said
                time.sleep(_LOOK)
            if not self._is_mine(self._read()):  # two found the same dead one
                raise UserError(BUSY.format(place=cleaned(self._url)))
        self._thread.start()

    def check(self) -> None:
        """Raises FileError if another batch took over."""
        if self._taken:
            raise FileError(_LOST.format(place=cleaned(self._url)))

    def release(self) -> None:
        """Let others work here."""
        self._ended.set()
        self._thread.join()
        if not self._taken:
            with suppress(Exception):  # it runs out by itself
                self._fs.rm_file(self._path)

    def _said(self) -> bytes:
        return json.dumps({**self._mine, "beat": self._beats}).encode()

    def _is_mine(self, said: bytes | None) -> bool:
        return said is not None and f'"{self._mine["token"]}"'.encode() in said

    def _read(self) -> bytes | None:
        self._fs.invalidate_cache()
        try:
            return bytes(self._fs.cat_file(self._path))
        except FileNotFoundError:
            return None

    def _beat(self) -> None:
        while not self._ended.wait(BEAT):
            with suppress(Exception):  # a store that fails for a moment; others wait for LEASE
                found = self._read()
                if found is not None and not self._is_mine(found):
                    self._taken = True
                    return
                self._beats += 1
                self._fs.pipe_file(self._path, self._said())


def _alive(said: bytes) -> bool | None:
    """Whether the process that wrote a lock is there; None if that cannot be told here."""
    try:
        other = json.loads(said)
        if other["host"] != _host() or not other["since"]:
            return None
        return _born(int(other["process"])) == other["since"]
    except (ValueError, KeyError, TypeError):  # torn
        return None


def _host() -> str:
    """This machine since it was started."""
    with suppress(OSError):
        boot = Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip()
        return f"{socket.gethostname()} {boot}"
    return socket.gethostname()


def _born(process: int | str = "self") -> str:
    """When a process was started, as the system counts; empty if there is none, or the system does not tell."""
    try:
        return Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[19]
    except (OSError, IndexError):
        return ""

"""Who does the jobs: worker processes of this machine, or Ray. Both give each job again to another worker if one dies.

An engine takes tasks by name and yields outcomes as they come; it keeps no books.
"""

from __future__ import annotations

import contextlib
import json
import os
import queue
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping
from typing import Any, Protocol

from ...gaussians.errors import BackendError
from .working import Outcome, Task, work

TRIES = 4  # workers that may die with the same job
_THREADS = ("OMP_NUM_THREADS", "NUMBA_NUM_THREADS", "OPENBLAS_NUM_THREADS")
_QUIET = {"log_to_driver": False, "logging_level": "ERROR"}  # settings of Ray
_DIED = "the worker died {times} times while it ran this job; run it alone with --debug"


class Engine(Protocol):
    """Does tasks."""

    def outcomes(self, tasks: Mapping[str, Task]) -> Iterator[tuple[str, Outcome]]:
        """Each task by its name, with its outcome, as they end."""
        ...


def died(times: int) -> Outcome:
    """The outcome of a job with which workers die."""
    return Outcome(code=4, result=None, messages=_DIED.format(times=times), seconds=0.0)


class Here:
    """In this process, one after the other: the plain loop that the others are compared with."""

    def outcomes(self, tasks: Mapping[str, Task]) -> Iterator[tuple[str, Outcome]]:
        """See `Engine`."""
        for name, task in tasks.items():
            yield name, work(task)


class Processes:
    """Worker processes of this machine, each with its share of the cores."""

    def __init__(self, workers: int) -> None:
        self._workers = max(1, workers)

    def outcomes(self, tasks: Mapping[str, Task]) -> Iterator[tuple[str, Outcome]]:
        """See `Engine`."""
        waiting: queue.SimpleQueue[str] = queue.SimpleQueue()
        done: queue.SimpleQueue[tuple[str, Outcome] | BaseException] = queue.SimpleQueue()
        for name in tasks:
            waiting.put(name)
        count = min(self._workers, len(tasks))
        hands = [_Hand(tasks, waiting, done, _threads(self._workers)) for _ in range(count)]
        try:
            for _ in range(len(tasks)):
                outcome = done.get()
                if isinstance(outcome, BaseException):
                    raise outcome
                yield outcome
        finally:
            for hand in hands:
                hand.end()


class _Hand(threading.Thread):
    """Feeds one worker process, and starts another when it dies."""

    def __init__(
        self, tasks: Mapping[str, Task], waiting: queue.SimpleQueue[str],
        done: queue.SimpleQueue[tuple[str, Outcome] | BaseException], threads: int,
    ) -> None:  # fmt: skip
        super().__init__(daemon=True)
        self._tasks, self._waiting, self._done = tasks, waiting, done
        self._threads, self._ended = threads, False
        self._process: subprocess.Popen[str] | None = None
        self._lock = threading.Lock()
        self.start()

    def run(self) -> None:
        try:
            while not self._ended:
                try:
                    name = self._waiting.get_nowait()
                except queue.Empty:
                    return
                self._done.put((name, self._outcome(self._tasks[name])))
        except BaseException as error:  # told to the loop that waits
            self._done.put(error)

    def _outcome(self, task: Task) -> Outcome:
        for _ in range(TRIES):
            process = self._running()
            try:
                assert process.stdin is not None and process.stdout is not None
                process.stdin.write(json.dumps(task) + "\n")
                process.stdin.flush()
                reply = process.stdout.readline()
                if reply.endswith("\n"):
                    found: Outcome = json.loads(reply)
                    return found
            except (OSError, ValueError):
                pass
            if self._ended:
                break
            self._stop()
        return died(TRIES)

    def _running(self) -> subprocess.Popen[str]:
        with self._lock:
            if self._process is None:
                threads = dict.fromkeys(_THREADS, str(self._threads))
                try:
                    self._process = subprocess.Popen(
                        [sys.executable, "-m", f"{__package__}.worker"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                        stderr=subprocess.DEVNULL, text=True, encoding="utf-8", env={**threads, **os.environ},
                        start_new_session=True,  # Ctrl-C is for the batch: it ends its workers
                    )  # fmt: skip
                except OSError as error:
                    raise BackendError(f"cannot start a worker: {error.strerror or error}") from error
            return self._process

    def _stop(self) -> None:
        with self._lock:
            if self._process is not None:
                self._process.kill()
                self._process.wait()
                for pipe in (self._process.stdin, self._process.stdout):
                    with contextlib.suppress(OSError):
                        if pipe is not None:
                            pipe.close()
                self._process = None

    def end(self) -> None:
        """Stop the worker, whatever it does."""
        self._ended = True
        self._stop()


class OnRay:
    """Tasks of a Ray cluster, or of one that is started here; `address` "local" or the cluster's."""

    def __init__(self, address: str, workers: int) -> None:
        if address == "local":  # read when ray is imported: without clusters it listens on the loopback address
            os.environ.setdefault("RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER", "0")
        try:
            import ray
        except ImportError as error:
            raise BackendError("--ray needs the package ray; run: pip install 'scenewright[ray]'") from error
        self._ray: Any = ray
        self._workers, self._started = max(1, workers), not ray.is_initialized()
        if self._started:
            try:
                if address == "local":
                    ray.init(num_cpus=self._workers, include_dashboard=False, **_QUIET)
                else:
                    ray.init(address=address, **_QUIET)
            except Exception as error:  # Ray raises whatever its parts raise
                raise BackendError(f"cannot reach Ray at {address!r}: {error}") from error

    def outcomes(self, tasks: Mapping[str, Task]) -> Iterator[tuple[str, Outcome]]:
        """See `Engine`. Paths go through the wire, no scenes: workers need the same files at the same places."""
        with contextlib.redirect_stdout(sys.stderr):  # where Ray's own thread prints what befell its workers
            try:
                yield from self._outcomes(tasks)
            finally:
                if self._started:
                    self._ray.shutdown()

    def _outcomes(self, tasks: Mapping[str, Task]) -> Iterator[tuple[str, Outcome]]:
        ray, here = self._ray, os.getcwd()
        remote = ray.remote(max_retries=TRIES - 1)(_work_in)
        waiting = {remote.remote(here, task): name for name, task in tasks.items()}
        while waiting:
            ready, _ = ray.wait(list(waiting), num_returns=1)
            for one in ready:
                name = waiting.pop(one)
                try:
                    yield name, ray.get(one)
                except ray.exceptions.WorkerCrashedError:
                    yield name, died(TRIES)
                except Exception as error:  # a lost node, a full store: the job failed, the others go on
                    yield name, Outcome(code=4, result=None, messages=str(error)[:1000], seconds=0.0)


def _work_in(folder: str, task: Task) -> Outcome:
    os.chdir(folder)
    return work(task)


def _threads(workers: int) -> int:
    return max(1, (os.cpu_count() or 1) // workers)

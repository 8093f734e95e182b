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
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Protocol

from ...gaussians.errors import BackendError, UserError
from .resources import of_this_machine
from .working import Outcome, Task, work

TRIES = 4  # workers that may die with the same job
_THREADS = ("OMP_NUM_THREADS", "NUMBA_NUM_THREADS", "OPENBLAS_NUM_THREADS")
_QUIET = {"log_to_driver": False, "logging_level": "ERROR"}  # settings of Ray
_GONE = 2.0  # seconds that a worker whose pipe has closed gets to be gone
_DIED = "the worker died {times} times while it ran this job; run it alone with --debug"


_LACKS = "a job ({job}) asks for {what} on {where}; ask for less, or run the batch where they are"
_PATIENCE = 60.0  # seconds without an outcome after which what waits is compared with what is there


class Engine(Protocol):
    """Does tasks."""

    def outcomes(self, tasks: Mapping[str, Task]) -> Iterator[tuple[str, Outcome]]:
        """Each task by its name, with its outcome, as they end. Raises UserError if one asks for what is not there."""
        ...


def died(retries: Sequence[str]) -> Outcome:
    """The outcome of a job with which workers die, by the reason of each."""
    messages = _DIED.format(times=len(retries))
    return Outcome(code=4, result=None, messages=messages, seconds=0.0, retries=list(retries))


def _told(outcome: Outcome, retries: Sequence[str]) -> Outcome:
    """The outcome, with the reasons why earlier workers did not get to the end of the job."""
    return Outcome({**outcome, "retries": list(retries)}) if retries else outcome


def _refuse(tasks: Mapping[str, Task], machines: Sequence[Mapping[str, float]], where: str) -> None:
    """Raises UserError for a task that no machine has the resources for."""
    for task in tasks.values():
        lacks = [task.resources.lacking(machine) for machine in machines]
        if None not in lacks:
            what = lacks[0] if lacks else "a machine, and there is none"
            raise UserError(_LACKS.format(job=" ".join(task.command[:2]), what=what, where=where))


def _check_here(tasks: Mapping[str, Task]) -> dict[str, float]:
    """What this machine has. Raises UserError if a task asks for more."""
    there = of_this_machine(gpus=any(task.resources.num_gpus for task in tasks.values()))
    _refuse(tasks, [there], "this machine")
    return there


class _Stock:
    """What this machine has left; jobs wait until what they need is free."""

    def __init__(self, there: Mapping[str, float]) -> None:
        self._left, self._changed = dict(there), threading.Condition()

    @contextlib.contextmanager
    def taken(self, task: Task) -> Iterator[None]:
        """What a task needs, while it is done."""
        amounts = task.resources.amounts()
        with self._changed:
            self._changed.wait_for(lambda: all(self._left[name] >= value for name, value in amounts.items()))
            self._add(amounts, -1)
        try:
            yield
        finally:
            with self._changed:
                self._add(amounts, 1)
                self._changed.notify_all()

    def _add(self, amounts: Mapping[str, float], sign: int) -> None:
        for name, value in amounts.items():
            self._left[name] += sign * value


class Here:
    """In this process, one after the other: the plain loop that the others are compared with."""

    def outcomes(self, tasks: Mapping[str, Task]) -> Iterator[tuple[str, Outcome]]:
        """See `Engine`."""
        _check_here(tasks)
        for name, task in tasks.items():
            yield name, work(task)


class Processes:
    """Worker processes of this machine, each with its share of the cores."""

    def __init__(self, workers: int) -> None:
        self._workers = max(1, workers)

    def outcomes(self, tasks: Mapping[str, Task]) -> Iterator[tuple[str, Outcome]]:
        """See `Engine`."""
        stock = _Stock(_check_here(tasks))
        waiting: queue.SimpleQueue[str] = queue.SimpleQueue()
        done: queue.SimpleQueue[tuple[str, Outcome] | BaseException] = queue.SimpleQueue()
        for name in tasks:
            waiting.put(name)
        count = min(self._workers, len(tasks))
        retries: dict[str, list[str]] = {name: [] for name in tasks}
        hands = [_Hand(tasks, waiting, done, retries, stock, _threads(self._workers)) for _ in range(count)]
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
    """Feeds one worker process, and starts another when it dies.

    The job waits behind all others then: what ended the worker may have passed, and others are done meanwhile.
    """

    def __init__(
        self, tasks: Mapping[str, Task], waiting: queue.SimpleQueue[str],
        done: queue.SimpleQueue[tuple[str, Outcome] | BaseException], retries: Mapping[str, list[str]], stock: _Stock,
        threads: int,
    ) -> None:  # fmt: skip
        super().__init__(daemon=True)
        self._stock, self._retries = stock, retries
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
                with self._stock.taken(self._tasks[name]):
                    outcome = self._outcome(name)
                if outcome is None:
                    self._waiting.put(name)
                else:
                    self._done.put((name, outcome))
        except BaseException as error:  # told to the loop that waits
            self._done.put(error)

    def _outcome(self, name: str) -> Outcome | None:
        """The outcome of a job, None if the worker died and another may try."""
        task, retries, process = self._tasks[name], self._retries[name], self._running()
        try:
            assert process.stdin is not None and process.stdout is not None
            process.stdin.write(json.dumps([task.command, task.folder, task.store]) + "\n")
            process.stdin.flush()
            reply = process.stdout.readline()
            if reply.endswith("\n"):
                return _told(json.loads(reply), retries)
        except (OSError, ValueError):
            pass
        if not self._ended:
            retries.append(self._stop())
        return died(retries) if self._ended or len(retries) >= TRIES else None

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

    def _stop(self) -> str:
        """End the worker; how it ended by itself, if it did."""
        ended = "it was not running"
        with self._lock:
            if self._process is not None:
                with contextlib.suppress(subprocess.TimeoutExpired):  # its pipe closes before it is gone
                    self._process.wait(_GONE)
                ended = _end_of(self._process.poll())
                self._process.kill()
                self._process.wait()
                for pipe in (self._process.stdin, self._process.stdout):
                    with contextlib.suppress(OSError):
                        if pipe is not None:
                            pipe.close()
                self._process = None
        return ended

    def end(self) -> None:
        """Stop the worker, whatever it does."""
        self._ended = True
        with self._lock:
            if self._process is not None:
                self._process.kill()
        self._stop()


def _end_of(code: int | None) -> str:
    """How a worker ended, by its exit code."""
    if code is None:
        return "the worker gave no answer"
    return f"the worker was ended by signal {-code}" if code < 0 else f"the worker ended with {code}"


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
                    self._ray.init(num_cpus=self._workers, include_dashboard=False, **_QUIET)
                else:
                    self._ray.init(address=address, **_QUIET)
            except Exception as error:  # Ray raises whatever its parts raise
                raise BackendError(f"cannot reach Ray at {address!r}: {error}") from error

    def outcomes(self, tasks: Mapping[str, Task]) -> Iterator[tuple[str, Outcome]]:
        """See `Engine`. Paths and URLs go through the wire, no scenes: workers need the same files at the same places,
        or read and write by URL."""
        with contextlib.redirect_stdout(sys.stderr):  # where Ray's own thread prints what befell its workers
            try:
                yield from self._outcomes(tasks)
            finally:
                if self._started:
                    self._ray.shutdown()

    def _outcomes(self, tasks: Mapping[str, Task]) -> Iterator[tuple[str, Outcome]]:
        ray, retries = self._ray, dict[str, list[str]]()
        _refuse(tasks, self._machines(), "Ray")
        waiting = {self._given(task): name for name, task in tasks.items()}
        while waiting:
            ready, _ = ray.wait(list(waiting), num_returns=1, timeout=_PATIENCE)
            if not ready:  # a machine may have gone
                _refuse({name: tasks[name] for name in waiting.values()}, self._machines(), "Ray")
            for one in ready:
                name = waiting.pop(one)
                said = retries.setdefault(name, [])
                try:
                    yield name, _told(ray.get(one), said)
                except ray.exceptions.RayTaskError as error:  # what `work` itself raised: our own mistake
                    yield name, Outcome(code=4, result=None, messages=str(error)[:1000], seconds=0.0)
                except ray.exceptions.RayError as error:  # a lost worker or node, no memory
                    said.append(f"{type(error).__name__}: {' '.join(str(error).split())[:200]}")
                    if len(said) < TRIES:
                        waiting[self._given(tasks[name])] = name
                    else:
                        yield name, died(said)

    def _given(self, task: Task) -> Any:
        """A task, given to the cluster; who dies with it is counted here and not by Ray, which tells no reasons."""
        remote = self._ray.remote(max_retries=0, **_for_ray(task))(_work_in)
        return remote.remote(os.getcwd(), task)

    def _machines(self) -> list[dict[str, float]]:
        """What each machine of the cluster has."""
        names = {"CPU": "num_cpus", "GPU": "num_gpus", "memory": "memory"}
        found = [node["Resources"] for node in self._ray.nodes() if node["Alive"]]
        return [{names[name]: float(there[name]) for name in names if name in there} for there in found]


def _for_ray(task: Task) -> dict[str, float]:
    amounts = task.resources.amounts()
    return {name: int(value) if name == "memory" else value for name, value in amounts.items()}


def _work_in(folder: str, task: Task) -> Outcome:
    if not task.store or os.path.isdir(folder):  # another machine may lack it: what goes by URL does not need it
        os.chdir(folder)
    return work(task)


def _threads(workers: int) -> int:
    return max(1, (os.cpu_count() or 1) // workers)

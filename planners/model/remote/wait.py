"""Run a coroutine with a time limit in its own thread, for callers whose thread may already run an event loop."""

from __future__ import annotations

import asyncio
import queue
import threading
import time
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

T = TypeVar("T")
Emit = Callable[[str], None]

_GRACE = 1.0  # seconds to stop after cancellation; then the thread is abandoned, since a DNS look-up cannot be stopped


@dataclass(frozen=True)
class Failed:
    """The work ended with an error; TimeoutError if the time was up."""

    error: BaseException


@dataclass(frozen=True)
class _Done(Generic[T]):
    result: T


class _Worker(Generic[T]):
    """A thread with its own event loop that runs one coroutine."""

    def __init__(self, work: Callable[[Emit], Coroutine[Any, Any, T]], seconds: float) -> None:
        self.said: queue.SimpleQueue[str | Failed | _Done[T]] = queue.SimpleQueue()
        self._work = work
        self._seconds = seconds
        self._running: tuple[asyncio.AbstractEventLoop, asyncio.Task[Any]] | None = None
        self._given_up = False
        threading.Thread(target=self._run, name="scenewright-model", daemon=True).start()

    def _run(self) -> None:
        try:
            result = asyncio.run(self._bounded())
        except BaseException as error:  # passed to the caller's thread, whatever its type
            self.said.put(Failed(error))
        else:
            self.said.put(_Done(result))

    async def _bounded(self) -> T:
        task = asyncio.current_task()
        assert task is not None
        self._running = (asyncio.get_running_loop(), task)
        async with asyncio.timeout(self._seconds if not self._given_up else 0):
            return await self._work(self.said.put)

    def stop(self) -> None:
        """Cancel the work; does nothing if it has ended."""
        self._given_up = True
        if self._running is not None and not self._running[0].is_closed():
            loop, task = self._running
            try:
                loop.call_soon_threadsafe(task.cancel)
            except RuntimeError:
                return  # closed meanwhile


def wait(
    work: Callable[[Emit], Coroutine[Any, Any, T]], seconds: float, on_text: Callable[[str], None] | None = None
) -> T | Failed:
    """The result of `work`, which runs in its own thread; `on_text` gets what it emits, in the caller's thread.

    An exception of `on_text` or an interrupt of the user stops the work and is raised here.

    Args:
        work: takes a function that emits text.
        seconds: time limit, after which the work is cancelled.
    """
    worker = _Worker(work, seconds)
    deadline = time.monotonic() + seconds + _GRACE
    try:
        while True:
            try:
                item = worker.said.get(timeout=max(deadline - time.monotonic(), 0.0))
            except queue.Empty:
                return Failed(TimeoutError())
            if not isinstance(item, str):
                return item if isinstance(item, Failed) else item.result
            if on_text is not None:
                on_text(item)
            if time.monotonic() > deadline:
                return Failed(TimeoutError())
    finally:
        worker.stop()

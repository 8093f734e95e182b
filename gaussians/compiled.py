"""Compiles kernels with numba, caches their machine code on disk and runs them on plain threads.

numba's own threading layers are not used: its portable layer is not safe to enter from two threads, and its OpenMP
layer spins against torch's OpenMP between kernels. Kernels release the interpreter lock, so plain threads avoid both
problems and compile faster.
"""

from __future__ import annotations

import hashlib
import logging
import os
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import torch
from llvmlite import ir
from numba import extending, njit, types
from numpy.typing import NDArray

log = logging.getLogger(__name__)

# fastmath without "nnan" and "ninf": degenerate rows must compare as IEEE 754 says; tests are written to fail on NaN.
# _nrt off: kernels allocate nothing, so they need no reference counts. Counting at every call of a helper that takes an
# array cost more time than the helpers themselves.
_OPTIONS: dict[str, Any] = {
    "nogil": True, "error_model": "numpy", "boundscheck": False, "_nrt": False,
    "fastmath": {"contract", "reassoc", "arcp", "nsz", "afn"},
}  # fmt: skip
LINE = 64  # bytes of a cache line
KEPT = 1 << 26  # bytes of memory at most that are kept for the next caller


@cache
def fingerprint(folder: Path) -> str:
    """Digest of every source file that the machine code of a folder depends on.

    numba checks only the file of the cached function. It would keep code that inlined a helper or constant of another
    file after that file has changed.
    """
    digest = hashlib.sha256()
    for path in [*sorted(folder.glob("*.py")), *sorted(folder.parent.glob("convention.py")), Path(__file__)]:
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def kernel(function: Callable[..., Any], **options: Any) -> Any:
    """Decorate a function that `run` calls: compiled on first use for this CPU and cached on disk."""
    # numba names the cached file after the function.
    function.__qualname__ += f"_{fingerprint(Path(function.__code__.co_filename).parent)}"
    try:
        return njit(**{**_OPTIONS, **options}, cache=True)(function)
    except RuntimeError:  # neither the package's folder nor the user's cache folder can be written
        return njit(**{**_OPTIONS, **options})(function)


def exact(function: Callable[..., Any]) -> Any:
    """As `kernel`, without fastmath: for loops whose order of additions must not depend on LLVM's choice of code."""
    return kernel(function, fastmath=False)


def helper(function: Callable[..., Any]) -> Any:
    """Decorate a function that kernels call. It is always inlined: an out-of-line call passes 12 words per array."""
    return njit(**_OPTIONS, forceinline=True)(function)


def exact_helper(function: Callable[..., Any]) -> Any:
    """As `helper`, without fastmath, for `exact` kernels."""
    return njit(**{**_OPTIONS, "fastmath": False}, forceinline=True)(function)


def intrinsic(function: Callable[..., Any]) -> Any:
    """Decorate a function that emits LLVM code; kernels call it without the typing context it is declared with."""
    return extending.intrinsic(function)


def workers() -> int:
    """Number of threads that kernels run on: torch's, so that one setting controls both."""
    return max(1, torch.get_num_threads())


def make_lines(count: int, size: int, kind: Any) -> NDArray[Any]:
    """Allocate `[count, size or more]`, each row on cache lines of its own.

    A vector that crosses a line takes two reads, and workers that write to one line wait for each other.
    """
    item = np.dtype(kind).itemsize
    wide = -(-size * item // LINE) * LINE
    return _on_lines(count * wide).view(kind).reshape(count, wide // item)


def _on_lines(size: int) -> NDArray[np.uint8]:
    """Allocate bytes from the beginning of a cache line on: numpy aligns arrays to 16 bytes."""
    room = np.empty(size + LINE, np.uint8)
    start = -room.ctypes.data % LINE
    return room[start : start + size]


_kept: list[NDArray[np.uint8]] = []


def take_room(size: int) -> NDArray[np.uint8]:
    """At least `size` bytes, on cache lines, with anything in them: what was given back last if that is large enough.

    Memory that is freed with every frame goes back to the system, which clears it before it lends it again.
    """
    try:
        room = _kept.pop()
    except IndexError:  # none is kept, or another thread took it
        room = _on_lines(0)
    return room if len(room) >= size else _on_lines(size)


def give_room(room: NDArray[np.uint8]) -> None:
    """Keep memory from `take_room`, which nothing reads or writes any more, for the next caller."""
    if len(room) <= KEPT:
        _kept.append(room)
        del _kept[1:]


def run(kernel: Any, count: int, *arguments: Any) -> None:
    """Call `kernel(worker, count, *arguments)` for every worker number below `count` at once; wait for all."""
    start = time.perf_counter()
    new = not kernel.overloads
    if new:
        _announce(kernel)
    others = [_pool(os.getpid(), count).submit(kernel, worker, count, *arguments) for worker in range(1, count)]
    try:
        kernel(0, count, *arguments)
    finally:
        wait(others)  # whatever happens here: what they write to may be lent to the next caller
    for other in others:
        other.result()
    if new:
        _note_first_call(kernel, start)
    _record_time(kernel, start)


def run_alone(kernel: Any, *arguments: Any) -> Any:
    """Call `kernel(*arguments)` on this thread, for work that cannot be divided; returns its result."""
    start = time.perf_counter()
    new = not kernel.overloads
    value = kernel(*arguments)
    if new:
        _note_first_call(kernel, start)
    _record_time(kernel, start)
    return value


@dataclass(frozen=True)
class FirstCall:
    """The first call of a kernel in this process.

    Attributes:
        kernel: its name.
        compiled: whether it was compiled; else its machine code was read from the cache.
        seconds: of compiling or reading, and of the call itself.
    """

    kernel: str
    compiled: bool
    seconds: float


first_calls: list[FirstCall] = []


def _note_first_call(kernel: Any, start: float) -> None:
    """Add a kernel's first call, which began at `start`."""
    compiled = bool(kernel.stats.cache_misses) or not kernel.stats.cache_hits
    first_calls.append(FirstCall(kernel.__name__, compiled, time.perf_counter() - start))


_times: ContextVar[dict[str, float] | None] = ContextVar("times", default=None)


@contextmanager
def stage_times() -> Iterator[dict[str, float]]:
    """Collect the seconds spent in each kernel, by name, while the block runs (in this thread's renders)."""
    times: dict[str, float] = {}
    token = _times.set(times)
    try:
        yield times
    finally:
        _times.reset(token)


def _record_time(kernel: Any, start: float) -> None:
    """Add the time since `start` to the kernel's."""
    times = _times.get()
    if times is not None:
        times[kernel.__name__] = times.get(kernel.__name__, 0.0) + time.perf_counter() - start


_announced: set[Path] = set()  # cache folders whose compilation was logged


def _announce(kernel: Any) -> None:
    """Log once per cache folder that kernels are being compiled, unless the cache holds them."""
    folder = Path(kernel.stats.cache_path or os.devnull)
    if folder in _announced:
        return
    _announced.add(folder)
    try:
        cached = any(folder.glob(f"*{kernel.py_func.__qualname__.rpartition('_')[2]}*.nbi"))
    except OSError:
        cached = False
    if not cached:
        log.info("compiling for this CPU: about 5 seconds, once")


@cache
def _pool(process: int, count: int) -> ThreadPoolExecutor:
    """The thread pool of this process: threads do not survive a fork, so a child process makes its own."""
    del process  # only part of the cache key
    return ThreadPoolExecutor(max(1, count - 1), thread_name_prefix="scenewright-render")


@intrinsic
def fetch_add(typing_context: Any, counter: Any, amount: Any) -> Any:
    """Atomically add `amount` to `counter[0]` (int64 array); returns the previous value."""

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        return builder.atomic_rmw("add", array.data, arguments[1], "monotonic")

    return types.int64(counter, types.int64), generate

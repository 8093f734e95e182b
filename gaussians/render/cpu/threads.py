"""Workers for compiled kernels: plain threads, since the kernels release the interpreter lock.

Knows how to run one kernel on several cores and how to count work between them. Refuses to know what the work is.
numba's own threading layers are not used: its portable one is not safe to enter from two threads, and its OpenMP one
spins against torch's OpenMP between kernels. Plain threads have neither fault and compile faster.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any

import torch
from llvmlite import ir
from numba import types
from numba.extending import intrinsic


def workers() -> int:
    """How many threads kernels run on: as many as torch uses, so one setting rules both."""
    return max(1, torch.get_num_threads())


def run(kernel: Callable[..., Any], *arguments: Any) -> None:
    """Call `kernel(worker, workers(), *arguments)` for every worker number at the same time; wait for all."""
    count = workers()
    others = [_pool(os.getpid(), count).submit(kernel, worker, count, *arguments) for worker in range(1, count)]
    kernel(0, count, *arguments)
    for other in others:
        other.result()


@cache
def _pool(process: int, count: int) -> ThreadPoolExecutor:
    """A pool for this process: threads do not survive a fork, so a child makes its own."""
    del process  # only part of the cache's key
    return ThreadPoolExecutor(max(1, count - 1), thread_name_prefix="scenewright-render")


@intrinsic
def fetch_add(typing_context: Any, counter: Any, amount: Any) -> Any:
    """Add `amount` to `counter[0]` (int64 array) as one step no other thread can split; returns the value before."""

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Any) -> Any:
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        return builder.atomic_rmw("add", array.data, arguments[1], "monotonic")

    return types.int64(counter, types.int64), generate

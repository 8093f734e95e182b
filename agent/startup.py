"""The start and the end of a command: no garbage is collected while modules load, the process ends without taking
everything apart, and `--debug` tells what loading took."""

from __future__ import annotations

import atexit
import gc
import os
import sys
import time
from collections.abc import Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType

# Packages that take more than 0.05 s to import.
HEAVY = (
    "torch", "numba", "scipy", "numpy", "onnxruntime", "pydantic", "lark", "trimesh", "PIL", "rich", "prompt_toolkit",
    "transformers", "open_clip", "matplotlib", "pydantic_ai", "pycolmap",
)  # fmt: skip

_collects = False


def begin() -> None:
    """Stop the collection of garbage. Modules, models and tables are made to stay: collecting them time and again took
    a tenth of a command."""
    global _collects
    _collects = gc.isenabled()
    gc.disable()


def end() -> None:
    """Collect garbage again, but not among what the first command loaded: each search through that took 0.14 s. Nothing
    if the collection is not stopped."""
    global _collects
    if _collects:
        if not gc.get_freeze_count():
            gc.freeze()
        gc.enable()
        _collects = False


_began: float | None = None


def own_process() -> None:
    """Remember that this process was started for one command, and when: reading Python's own modules and ours has kept
    its one thread busy since."""
    global _began
    _began = time.perf_counter() - time.process_time()


def began(started: float) -> float:
    """`time.perf_counter()` at which the process of a command began, if it has one of its own, else `started`."""
    return started if _began is None else min(_began, started)


_exit_code: int | None = None


def leave_with(code: int) -> None:
    """Let this process end with an exit code as soon as threads have ended, `atexit` functions have run and output is
    written. Freeing the modules of torch one by one took another 0.7 s."""
    global _exit_code
    _exit_code = code


@atexit.register  # the first to be registered runs last
def _leave() -> None:
    if _exit_code is None:
        return
    try:
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
    except (OSError, ValueError):  # the reader has gone, or the stream is closed: Python reports it
        return
    os._exit(_exit_code)


class _Watch(MetaPathFinder):
    """Finds modules as Python would, and adds the time that each takes to run to that of its package.

    Time is counted where it is spent: what numpy takes when scipy imports it is numpy's.
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._running: list[str] = []
        self._since = 0.0

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        for finder in sys.meta_path:
            if isinstance(finder, _Watch) or not hasattr(finder, "find_spec"):
                continue
            found = finder.find_spec(fullname, path, target)
            if found is not None:
                if found.loader is not None and hasattr(found.loader, "exec_module"):
                    self._watch(fullname.partition(".")[0], found.loader)
                return found
        return None

    def _watch(self, package: str, loader: Loader) -> None:
        run = loader.exec_module

        def timed(module: ModuleType) -> None:
            self._switch()
            self._running.append(package)
            try:
                run(module)
            finally:
                self._switch()
                self._running.pop()

        try:
            loader.exec_module = timed  # type: ignore[method-assign]
        except AttributeError:  # a loader of C modules; its time is that of the importing package
            return

    def _switch(self) -> None:
        """Add the time since the last switch to the package that is running."""
        now = time.process_time()
        if self._running:
            package = self._running[-1]
            self.seconds[package] = self.seconds.get(package, 0.0) + now - self._since
        self._since = now


_watch: _Watch | None = None


def watch_imports() -> None:
    """Measure the imports from now on, once per process."""
    global _watch
    if _watch is None:
        _watch = _Watch()
        sys.meta_path.insert(0, _watch)


def told() -> list[str]:
    """What was imported and compiled, and the processor seconds that each took, the most first; for `--debug`."""
    if _watch is None:
        return []
    spent = sorted(_watch.seconds.items(), key=lambda item: -item[1])
    imported = [f"{name} {s:.2f} s" for name, s in spent if name in HEAVY or s >= 0.05]
    lines = [
        f"debug: {time.process_time():.2f} s of processor time; imports {sum(_watch.seconds.values()):.2f} s: "
        + (", ".join(imported) or "nothing that takes long")
    ]
    compiled = sys.modules.get(f"{__package__.rpartition('.')[0]}.gaussians.compiled")
    calls = compiled.first_calls if compiled is not None else []
    for how, chosen in (
        ("compiled", [c for c in calls if c.compiled]),
        ("read from the cache", [c for c in calls if not c.compiled]),
    ):
        if chosen:
            names = ", ".join(c.kernel for c in sorted(chosen, key=lambda c: -c.seconds))
            lines.append(
                f"debug: {len(chosen)} kernels {how}, first calls {sum(c.seconds for c in chosen):.2f} s: {names}"
            )
    if not calls:
        lines.append("debug: no kernel was compiled or read from the cache")
    return lines

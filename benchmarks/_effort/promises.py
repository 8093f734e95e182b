"""Runs commands with `--effort SECONDS` as a person does, cold, and reads what their receipts promised and took."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass

from ...gaussians.effort.dial import KEPT
from ...gaussians.errors import BackendError

DONE = (0, 3)  # exit codes: done, or told that nothing of that name is there
CHOSEN = re.compile(r"^effort: (?!nothing)([^,;]+: [^,]+), (.*)$", re.MULTILINE)
PREDICTED = re.compile(r"([\d.e+-]+) s predicted$")
NO_FIT = re.compile(r"^effort: nothing that was measured of .+ fits", re.MULTILINE)


@dataclass(frozen=True)
class Promise:
    """A command with a promise.

    Attributes:
        method: the verb.
        asked: seconds.
        chosen: settings of the points that the receipt names.
        predicted: seconds of these points, without imports and files; None if none was named.
        fits: whether the receipt does not say that nothing fits.
        clock: seconds from the start of the process to its end.
        processor: seconds of all processors in the meantime.
    """

    method: str
    asked: float
    chosen: tuple[str, ...]
    predicted: float | None
    fits: bool
    clock: float
    processor: float

    @property
    def kept(self) -> bool:
        """Whether it took at most 15 % more than asked by the clock."""
        return self.clock <= (1 + KEPT) * self.asked

    @property
    def verdict(self) -> str:
        """In words; a promise that was told as not fitting misleads nobody."""
        if self.kept:
            return "kept"
        if not self.fits:
            return "told as not fitting"
        if self.processor <= (1 + KEPT) * self.asked:
            return "kept in processor time alone"
        return "missed"

    def sentence(self) -> str:
        """One row of the page."""
        predicted = "nothing" if self.predicted is None else f"{self.predicted:.3g} s"
        chosen = "; ".join(self.chosen) or "nothing to choose"
        return (
            f"{self.method}, {self.asked:g} s asked: {predicted} predicted, {self.clock:.2f} s taken by the clock, "
            f"{self.processor:.2f} s of processors, {self.verdict} ({chosen})"
        )


def promised(method: str, arguments: Sequence[str], asked: float) -> Promise:
    """Run `scenewright METHOD ARGUMENTS --effort ASKED`.

    Raises:
        BackendError: the command failed.
    """
    command = [sys.executable, "-m", "scenewright", method, *arguments, "--effort", f"{asked:g}"]
    before, started = os.times(), time.perf_counter()
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    clock, after = time.perf_counter() - started, os.times()
    if done.returncode not in DONE:
        raise BackendError(f"`scenewright {method}` failed: {done.stderr.strip().splitlines()[-1:]}")
    processor = after.children_user + after.children_system - before.children_user - before.children_system
    return read(method, asked, done.stderr, clock, processor)


def read(method: str, asked: float, receipt: str, clock: float, processor: float) -> Promise:
    """What a receipt on stderr says of a promise, with the seconds that the command took."""
    chosen = CHOSEN.findall(receipt)
    told = [float(found[1]) for _, rest in chosen if (found := PREDICTED.search(rest))]
    fits = NO_FIT.search(receipt) is None
    return Promise(
        method, asked, tuple(one for one, _ in chosen), sum(told) if told else None, fits, clock, processor
    )  # fmt: skip

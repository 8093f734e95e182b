"""`Dial`: the effort of one job. It chooses a measured point for each method that the job uses, and reports them.

Seconds are promised from `started` on. What the job has spent when a method begins is measured, what remains is
predicted, so that only the prediction of the method itself can be wrong.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from ..errors import UserError
from . import user_file
from .points import WORDS, Method, Point, machine, method

Effort = str | float
KEPT = 0.15  # share of promised seconds that a job may be over
LEAST_CLOCK = 1.0  # seconds that a method with a clock gets where none are left


def parse(effort: Effort) -> Effort:
    """One of `WORDS`, or seconds as a float.

    Raises:
        UserError: it is another word, or seconds that are not finite and above 0.
    """
    forms = f"{', '.join(WORDS)} or a number of seconds above 0, as in 30"
    if isinstance(effort, str):
        word = effort.strip().lower()
        if word in WORDS:
            return word
        try:
            effort = float(word.removesuffix("s"))
        except ValueError:
            raise UserError(f"there is no effort {effort!r}; it is {forms}") from None
    if isinstance(effort, bool) or not isinstance(effort, int | float):
        raise UserError(f"there is no effort {effort!r}; it is {forms}")
    if not math.isfinite(effort) or effort <= 0:
        raise UserError(f"an effort of {effort:g} seconds cannot be kept; it is {forms}")
    return float(effort)


@dataclass(frozen=True)
class Choice:
    """The point that a method is run with.

    Attributes:
        method, point: which.
        size: of the job, in what `method.sized_by` counts.
        factor: this machine's times as multiples of the reference machine's.
        predicted: seconds on this machine, of this method alone.
        clock: seconds that a method with a clock is given; 0 for others.
        fits: whether it fits the seconds that were left; True for words.
        below: whether the clock is shorter than any that was measured.
    """

    method: Method
    point: Point
    size: float
    factor: float
    predicted: float
    clock: float = 0.0
    fits: bool = True
    below: bool = False

    @property
    def settings(self) -> dict[str, Any]:
        """As the method takes them."""
        return dict(self.point.settings)

    def sentence(self) -> str:
        """What was chosen and what was measured of it."""
        told, point = self.method, self.point
        chosen = f"{told.name}: {point.setting}"
        if self.below:
            return f"{chosen}, given {self.clock:.0f} s, less than was ever measured; no accuracy is known"
        least = "at least " if self.clock > point.clock * self.factor * 1.01 else ""
        measured = f"{least}{point.accuracy:.4g} {told.unit} measured on {told.scene}"
        return f"{chosen}, {measured}; {self.predicted:.3g} s predicted"

    def data(self) -> dict[str, Any]:
        """The same as JSON."""
        return {
            "method": self.method.name,
            "setting": self.point.setting,
            "settings": self.settings,
            "accuracy": None if self.below else self.point.accuracy,
            "unit": self.method.unit,
            "measured_on": self.method.scene,
            "revision": self.method.revision,
            "size": self.size,
            "predicted_seconds": round(self.predicted, 3),
            "clock": round(self.clock, 3) or None,
            "fits": self.fits,
        }


@dataclass(eq=False)
class Dial:
    """The effort of one job.

    Attributes:
        effort: a word or seconds, see `parse`.
        started: `time.perf_counter()` from which seconds count.
        choices: what was chosen, in order.
        overruled: options that the user gave and that win over the dial.
        reserve: seconds kept for what the job does at its end.
        notes: what is wrong with the calibration.
    """

    effort: Effort
    started: float = field(default_factory=time.perf_counter)
    choices: list[Choice] = field(default_factory=list)
    overruled: list[str] = field(default_factory=list)
    reserve: float = 0.0

    def __post_init__(self) -> None:
        self.effort = parse(self.effort)
        calibration, trouble = user_file.read()
        self._factors = calibration.factors if calibration is not None else {}
        self.times = machine()
        if calibration is not None:
            self.times = f"this machine, measured on {calibration.measured}"
        self.notes = (trouble,) if trouble else ()

    @property
    def left(self) -> float | None:
        """Seconds left, at least 0; None if a word was given."""
        if isinstance(self.effort, str):
            return None
        return max(0.0, self.started + self.effort - self.reserve - time.perf_counter())

    @property
    def until(self) -> float | None:
        """Value of `time.perf_counter()` at which the promised seconds are over; None if a word was given."""
        return None if isinstance(self.effort, str) else self.started + self.effort - self.reserve

    def begin(self) -> None:
        """Begin another job of the same effort, unless nothing was chosen yet."""
        if self.choices:
            self.started, self.choices, self.overruled = time.perf_counter(), [], []

    def fastest(self, name: str, size: float) -> float:
        """Predicted seconds of the fastest point of a method on this machine."""
        return min(p.seconds(size) for p in method(name).points) * self._factors.get(name, 1.0)

    def choose(self, name: str, size: float, reserve: float = 0.0) -> Choice:
        """Choose the point of a method, and remember it for the report.

        Args:
            name: of the method.
            size: of the job.
            reserve: seconds that are needed after it.

        Raises:
            UserError: nothing was measured of this method.
        """
        known, factor = method(name), self._factors.get(name, 1.0)
        left = self.left
        if left is None:
            chosen = _named(known, str(self.effort), size, factor)
        else:
            chosen = _fitting(known, left - reserve, size, factor)
        self.choices.append(chosen)
        return chosen

    def overrule(self, *options: str) -> None:
        """Remember options of the user that win over the dial."""
        self.overruled += [o for o in dict.fromkeys(options) if o not in self.overruled]

    def data(self, seconds: float | None = None) -> dict[str, Any]:
        """The report as JSON; `seconds`: what the job took, by default until now."""
        took = time.perf_counter() - self.started if seconds is None else seconds
        promised = None if isinstance(self.effort, str) else self.effort
        return {
            "effort": self.effort,
            "promised_seconds": promised,
            "seconds": round(took, 3),
            "kept": None if promised is None else took <= (1 + KEPT) * promised,
            "points": [c.data() for c in self.choices],
            "overruled": list(self.overruled),
            "times": self.times,
        }

    def lines(self, seconds: float | None = None) -> list[str]:
        """The report as sentences."""
        data = self.data(seconds)
        asked = self.effort if isinstance(self.effort, str) else f"{self.effort:g} s"
        if data["promised_seconds"] is None:
            total = sum(c.predicted for c in self.choices)
            spent = f"{data['seconds']:.2f} s in all, {total:.3g} s predicted for {_names(self.choices)}"
            spent = spent if self.choices else f"{data['seconds']:.2f} s"
        else:
            kept = "kept" if data["kept"] else "not kept"
            spent = f"{data['seconds']:.2f} s of {self.effort:g} s promised, {kept}"
        lines = [f"effort {asked}: {spent} (times of {self.times})"]
        lines += [f"effort: {c.sentence()}" for c in self.choices]
        if not self.choices:
            lines.append("effort: nothing that was done has more than one measured setting")
        for c in self.choices:
            if not c.fits:
                lines.append(
                    f"effort: nothing that was measured of {c.method.name} fits; the fastest was taken"
                    f"{', as short as it gets' if c.clock else ''}, {c.predicted:.3g} s predicted"
                )
        if self.overruled:
            lines.append(f"effort: {', '.join(self.overruled)} as given, not by the dial")
        return [*lines, *(f"note: {note}" for note in self.notes)]


def _names(choices: Sequence[Choice]) -> str:
    return " and ".join(dict.fromkeys(c.method.name for c in choices))


def _named(known: Method, word: str, size: float, factor: float) -> Choice:
    """The point that a word means; on this machine its clock is as long as the same work takes.

    Raises:
        UserError: nothing was measured that the word could mean.
    """
    point = known.by_name.get(word)
    if point is None:
        raise UserError(f"nothing {word} was measured of {known.name}; say {' or '.join(known.by_name)}, or seconds")
    return Choice(known, point, size, factor, factor * point.seconds(size), factor * point.clock)


def _fitting(known: Method, seconds: float, size: float, factor: float) -> Choice:
    """The most accurate point that fits in `seconds`, of equally accurate ones the fastest; else the fastest of all.

    A method with a clock gets all that is left, also where that is less than was measured, and at least `LEAST_CLOCK`.
    """
    fitting = [p for p in known.points if factor * p.seconds(size) <= seconds]
    best = min(fitting, key=lambda p: (-p.accuracy, p.seconds(size)), default=None)
    quickest = min(known.points, key=lambda p: p.seconds(size))
    if best is not None:
        clock = seconds - factor * best.overhead(size) if best.clock else 0.0
        return Choice(known, best, size, factor, factor * best.overhead(size) + clock, clock)
    clock = seconds - factor * quickest.overhead(size)
    if quickest.clock and clock > 0:
        return Choice(known, quickest, size, factor, seconds, clock, below=True)
    clock = LEAST_CLOCK if quickest.clock else 0.0
    predicted = factor * quickest.overhead(size) + clock
    return Choice(known, quickest, size, factor, predicted, clock, fits=False, below=clock > 0)

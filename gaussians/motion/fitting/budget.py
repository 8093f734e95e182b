"""The time of a fit of a film (`Budget`): each phase ends when its share is gone, so that the whole keeps to it.

A fit that is measured in steps has no limits, so that it gives the same bytes every time.
"""

from __future__ import annotations

import time
from collections.abc import Callable

LASTING_UNTIL = 0.2  # share of the time after which what is there for most of the time is trained (one moving camera)
START_UNTIL = 0.3  # the same of the scene at its start (cameras that stand)
ENDS_UNTIL = 0.4  # after which no more is trained at the ends of a film
SEEDS_UNTIL = 0.6  # after which no other seed is tracked
SEARCH_UNTIL = 0.7  # after which no path is improved before all is trained together
LEAST = 0.05  # share of the time that a training has at least, however long the phases before it took


class OutOfTime(Exception):
    """The share of a phase is gone."""


class Budget:
    """The seconds of a fit.

    Args:
        seconds: for the whole; None: a fit that is measured in steps.
        now: the clock, seconds.
    """

    def __init__(self, seconds: float | None, now: Callable[[], float] = time.perf_counter) -> None:
        self.seconds, self._now, self._started = seconds, now, now()

    @property
    def gone(self) -> float:
        """Seconds since the start."""
        return self._now() - self._started

    def check(self, until: float) -> None:
        """Do nothing while less than a share of the time is gone.

        Raises:
            OutOfTime: more is gone.
        """
        if self.seconds is not None and self.gone > until * self.seconds:
            raise OutOfTime

    def left(self, until: float = 1.0, least: float = LEAST) -> float | None:
        """Seconds until a share of the time is gone, and at least a share of the whole; None: no limit."""
        return None if self.seconds is None else max(least * self.seconds, until * self.seconds - self.gone)

"""Progress of a call: stages of a session, each from 0 to 1, as one number that only rises."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

Report = Callable[[float, str], None]  # progress, and the stage in words

_STEP = 0.01  # smaller steps are not reported


class Progress:
    """Passes the progress of a session on to whoever waits for the present call.

    It is given to a session as its `progress`; `listen` is called for each call. The reported number is the count of
    finished stages plus the share of the present one, so that it strictly increases.
    """

    def __init__(self) -> None:
        self._report: Report | None = None
        self._held: list[BaseException] | None = None
        self._stage, self._finished, self._last = "", 0, 0.0

    def listen(self, report: Report | None) -> None:
        """From now on report to `report`, from 0 on; None reports to nobody."""
        self._report = report
        self._stage, self._finished, self._last = "", 0, 0.0

    def __call__(self, stage: str, fraction: float) -> None:
        """The share done, in [0, 1], of a stage."""
        if self._report is None:
            return
        share = min(max(fraction, 0.0), 1.0)
        if stage != self._stage:
            self._finished = int(self._last) + 1 if self._stage else 0
            self._stage = stage
        value = self._finished + share
        if value >= self._last + _STEP:
            self._last = value
            self._tell(value, stage)

    @contextmanager
    def uninterrupted(self) -> Iterator[None]:
        """A context for work that is worth finishing: what `report` raises in it is raised at its end."""
        self._held = []
        try:
            yield
            if self._held:
                raise self._held[0]
        finally:
            self._held = None

    def _tell(self, value: float, stage: str) -> None:
        assert self._report is not None
        try:
            self._report(value, stage)
        except BaseException as interruption:
            if self._held is None:
                raise
            self._held.append(interruption)
            self._report = None

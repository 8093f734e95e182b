"""`--effort` of commands: the dial of a command, and its report."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .. import startup
from .output import terminal

if TYPE_CHECKING:
    from ...gaussians.effort import Dial


def dialled(effort: str | None, started: float) -> Dial | None:
    """The dial of a command that began at `started` (`time.perf_counter()`), or with its process; None without
    --effort.

    Raises:
        UserError: it is no effort.
    """
    if effort is None:
        return None
    from ...gaussians.effort import Dial

    return Dial(effort, startup.began(started))


def reported(dial: Dial | None) -> dict[str, Any]:
    """What the JSON of a result says of the dial: which points were used, what they promised and what was kept."""
    return {} if dial is None else {"effort": dial.data()}


def tell(dial: Dial | None, always: bool = False) -> None:
    """Say the same on stderr, unless the result is JSON and tells it."""
    if dial is not None and (always or not terminal.as_json):
        for line in dial.lines():
            terminal.say(line)

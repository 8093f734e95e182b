"""Times of a scene as people write them on a command line: `2.5`, `0:5`, or `:` for all of its motion."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ...gaussians.errors import UserError
from ..terminal.output import terminal

if TYPE_CHECKING:
    from ...gaussians.motion.motion import Motion

MAX_TIMES = 10_000


def time_span(text: str, motion: Motion | None, what: str) -> tuple[float, float]:
    """The start and the stop that a text means, seconds; both alike for one time. An open end is that of the motion.

    Args:
        what: the scene, for the message.

    Raises:
        UserError: the text is no time, or nothing changes with time in the scene.
    """
    check_times(text)
    if motion is None:
        raise UserError(f"nothing moves in {what}; leave out --time")
    start, colon, stop = text.partition(":")
    first = _seconds(start, motion.start, text)
    last = _seconds(stop, motion.stop, text) if colon else first
    if last < first:
        raise UserError(f"--time {text} ends before it begins; write the earlier time first")
    if first < motion.start or last > motion.stop:
        lasts = f"{what} lasts from {motion.start:g} to {motion.stop:g} s"
        spins = last > motion.stop and any(track.kind == "spin" for track in motion.tracks)
        stays = "before and after, it stays as it is" + (", but what spins goes on" if spins else "")
        terminal.say(f"note: {lasts}; {stays}")
    return first, last


def check_times(text: str) -> None:
    """Check that a text is a time or a span of times, of whatever scene. Raises UserError if it is not."""
    start, colon, stop = text.partition(":")
    for word in (start, stop):
        _seconds(word, 0.0, text)
    if not colon and not start.strip():
        raise UserError("--time takes seconds as in 2.5 or 0:5")


def one_time(text: str, motion: Motion | None, what: str) -> float:
    """The time that a text means, seconds; see `time_span`.

    Raises:
        UserError: the text is no single time, or nothing changes with time in the scene.
    """
    start, stop = time_span(text, motion, what)
    if stop > start:
        raise UserError(f"--time {text} is many times; give one, as in --time {start:g}")
    return start


def times_within(span: tuple[float, float], rate: float, stretched: float | None = None) -> tuple[float, ...]:
    """Times from the start of a span to its stop, both included, at `rate` pictures a second.

    Args:
        stretched: how long the pictures are to last, seconds; None: as long as the span.

    Raises:
        UserError: there would be too many.
    """
    start, stop = span
    lasting = stop - start if stretched is None else stretched
    if lasting * rate > MAX_TIMES - 1:
        raise UserError(f"{lasting:g} seconds at {rate:g} pictures a second are too many; at most {MAX_TIMES} are made")
    return spread(span, round(lasting * rate) + 1)


def spread(span: tuple[float, float], count: int) -> tuple[float, ...]:
    """`count` times evenly from the start of a span to its stop; the start if there is one."""
    start, stop = span
    return tuple(start + (stop - start) * i / max(count - 1, 1) for i in range(count))


def _seconds(word: str, default: float, text: str) -> float:
    if not word.strip():
        return default
    try:
        found = float(word.strip().removesuffix("s"))
    except ValueError:
        found = math.nan
    if not math.isfinite(found):
        raise UserError(f"--time takes seconds as in 2.5 or 0:5, not {text!r}")
    return found

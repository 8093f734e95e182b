"""Whether a change of a motion does what the marks of an instruction tell: something changes, and begins or ends at the
seconds that they tell."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from operator import sub

from ....plan import Movement
from ...learned.marks import Span
from ..manner import Thing
from ..moments import Moment
from .times import TIMES, TRIM
from .when import time_of

_NEAR = 0.12  # seconds: what is told may differ so much from what is
_SAME = 0.02  # seconds, degrees and metres: what differs less has not changed
_TIMED = ("stop", "begin", "later", "speed", "turn")  # changes that are none if something moves as before
_LIKEWISE = ("reverse", "mirror", "turn", "repeat", "back_and_forth")  # changes of what happens in the same time


def moments_of(words: Sequence[str], spans: Sequence[Span], thing: Thing, kind: str) -> Iterator[tuple[str, Moment]]:
    """The tags of marks with the times that they tell in numbers."""

    def text(span: Span) -> str:
        return " ".join(words[span[1] : span[2]]).strip(TRIM)

    for span in spans:
        if span[0] in TIMES and (told := time_of(words, (span,), text, thing, kind)) is not None and told[1] is None:
            yield span[0], told[0]


def is_borne_out(change: str, before: Movement, after: Movement | None, moments: Iterable[tuple[str, Moment]]) -> bool:
    """Whether a thing moves as it is told to.

    Args:
        change: of its motion, as `Pace` has them.
        before, after: how it moves now, and would then; None if that cannot be told.
        moments: tags and times in numbers.
    """
    if after is None:
        return True
    if change in _TIMED and _is_same(before, after):
        return False
    if change in _LIKEWISE:
        return True
    begins, ends = [begin for begin, _ in after.spells], [end for _, end in after.spells]
    film = max(before.end, *ends, 0.0)
    if change == "stop":  # from then on it rests
        begins, ends = [*ends, *begins], [*begins, *ends]
    elif change == "begin":  # or it rests until then
        ends += begins
    elif change == "return":  # until then it is back
        ends = ends[-1:]
    for _, moment in moments:
        for told, some in ((moment.start, begins), (moment.stop, ends)):
            if isinstance(told, float) and told > 0 and not any(abs(told - t) < _NEAR for t in (*some, 0.0, film)):
                return False
    return True


def _is_same(before: Movement, after: Movement) -> bool:
    """Whether something moves as before."""
    if len(before.spells) != len(after.spells):
        return False
    edges, others = (list(chain(*one.spells)) for one in (before, after))
    return (
        max(*map(abs, map(sub, edges, others)), abs(before.degrees - after.degrees), abs(before.metres - after.metres))
        < _SAME
    )

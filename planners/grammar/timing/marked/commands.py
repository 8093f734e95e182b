"""The commands that each kind of wish makes of what the marks of an instruction hold."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

from .....gaussians import late_re as re
from .far import goes_as_far
from .guards import ASKED_AS_NOT, NO_MORE
from .moves import NOT, hide, move, recolor, remove
from .openings import opening, order, together
from .pacing import begin, duration, longer, speed
from .rests import halt, pause, stay, still
from .slots import Slots
from .turns import go_back, repeat, reverse, spin
from .wanted import Wanted

_NO_WISH = re.compile(r"\b(?:unless|except|instead of|if (?:the|it|he|she|they)|or)\b")

_WHICH_ONE = re.compile(r"\| (?:that(?! way\b)|which|who|whose)\b")  # "the book that falls first"


def commands(kind: str, slots: Slots) -> Iterator[Wanted]:
    """The commands of a kind that hold all that the marks do, the likeliest first."""
    made = _KINDS.get(kind)
    if made is None or not slots.names or _NO_WISH.search(slots.rest):
        return
    if kind != "order" and _WHICH_ONE.search(slots.rest):
        return
    if kind not in _NEGATIVE and NOT.search(NO_MORE.sub(" ", ASKED_AS_NOT.sub(" ", slots.rest))):
        return
    for wanted in made(slots):
        if not slots.unused():
            yield wanted
        slots.used.clear()
        slots.repeated.clear()


_NEGATIVE = ("hide", "remove", "still", "stay", "halt", "longer", "amount", "begin", "pause", "duration")

_KINDS: dict[str, Callable[[Slots], Iterator[Wanted]]] = {
    "recolor": recolor, "hide": hide, "remove": remove, "move": move, "spin": spin, "begin": begin,
    "speed": speed, "duration": duration, "pause": pause, "halt": halt, "still": still, "reverse": reverse,
    "stay": stay, "amount": goes_as_far, "open": partial(opening, verb="open"),
    "close": partial(opening, verb="close"),
    "order": order, "together": together, "repeat": repeat, "return": go_back, "longer": longer,
}  # fmt: skip

"""Which form an answer has to have, as the kind of a question tells it: yes or no, a moment, a number, a name."""

from __future__ import annotations

from typing import Literal

from .....grammar.tagging.words import bag
from .kinds import kinds_of, words_of
from .likely import likeliest

Form = Literal["yesno", "moment", "duration", "number", "name"]

_NUMBERS = bag("how_many often turns far far_opens far_turns far_falls fast fast_most apart")
_DURATIONS = bag("gap film_long")
_EITHER = bag("turn_way none far fast fast_most first last")  # kinds that are asked for yes or no, too


def chance_of(text: str, form: Form) -> float:
    """The probability that a question asks for an answer of a form; kinds that may ask for several forms are none of
    another one."""
    words = words_of(text)
    kind, chance = likeliest(words)
    told = sum(own for other, own in kinds_of(words) if other in _EITHER or form_of(other) == form)
    return told if kind in _EITHER or form_of(kind) == form else min(told, 1.0 - chance)


def form_of(kind: str) -> Form:
    """The form of an answer to a question of a kind."""
    if kind.startswith("if_"):
        return "yesno"
    if kind in _DURATIONS or kind.startswith("long_"):
        return "duration"
    if kind.startswith("when_"):
        return "moment"
    return "number" if kind in _NUMBERS else "name"

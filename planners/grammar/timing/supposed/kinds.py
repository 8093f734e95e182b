"""The kind of wish that an instruction is of, and which of its words name what.

`training/timed_words.py` learns both from written sentences.
"""

from __future__ import annotations

from collections.abc import Sequence

from ...learned.marks import Span
from ...learned.network import network, told
from ...tagging.spelling import is_common, is_word
from ...tagging.words import split
from ...vocabulary.nouns import is_known
from ..verbs import SENSES, has_form

TASK = "wishes"
NO_WISH = "none"  # the kind of questions, remarks, and wishes that are about neither time nor motion
COURSES = (  # kinds that are about how what is there moves by itself
    "begin", "speed", "duration", "pause", "halt", "still", "reverse", "stay", "order", "together", "repeat", "return",
    "longer",
)  # fmt: skip
_DONE_BY = {  # the operations by which a wish of a kind is done; the other kinds are about how something moves
    "recolor": ("recolor", "restyle"), "hide": ("opacity", "delete"), "remove": ("delete", "opacity"),
    "move": ("move", "follow", "orbit", "rotate", "pace", "order", "delete"),
    "spin": ("spin", "orbit", "rotate", "pace"),
    "amount": ("articulate", "pace", "move"), "open": ("articulate", "pace"), "close": ("articulate", "pace"),
}  # fmt: skip
_COURSED_BY = ("pace", "articulate", "order", "spin", "move", "follow")
_CHANGED_BY = {  # changes of a motion by which a wish of a kind is done
    "begin": ("begin", "later", "stop"), "speed": ("speed", "begin"), "duration": ("begin", "speed"),
    "pause": ("stop",), "halt": ("stop", "part"), "still": ("stop",), "reverse": ("reverse", "mirror", "return"),
    "repeat": ("repeat", "back_and_forth"), "return": ("return", "reverse", "back_and_forth"),
    "longer": ("go_on", "repeat", "begin", "speed"), "stay": ("stop",), "amount": ("part", "stop"),
    "together": ("begin", "later"), "order": ("begin", "later"),
}  # fmt: skip
LEAST = 0.08  # probability of a kind that is tried
MOST = 4  # kinds that are tried


def likely(said: str, still: bool = False) -> list[tuple[str, float]]:
    """The kinds of wish that an instruction may be of, with probabilities, the likeliest first; none if it is likelier
    no such wish.

    Args:
        still: whether what it is about does not move by itself: it then asks for no other course of a motion.
    """
    known = list(told(TASK, tuple(word.text for word in split(said))).kinds)
    if still:
        rest = 1.0 - sum(chance for kind, chance in known if kind in COURSES)
        known = [(kind, chance / rest) for kind, chance in known if kind not in COURSES and chance >= LEAST]
    found = [(kind, chance) for kind, chance in known[:MOST] if chance >= LEAST]
    return [] if found and found[0][0] == NO_WISH else found


def is_done_by(kind: str, op: str) -> bool:
    """Whether an operation may be what a wish of a kind asks for."""
    return op in _DONE_BY.get(kind, _COURSED_BY)


def is_changed_by(kind: str, change: str) -> bool:
    """Whether a change of a motion may be what a wish of a kind asks for."""
    return change in _CHANGED_BY.get(kind, (change,))


def marked(words: Sequence[str]) -> tuple[Span, ...]:
    """Which words of an instruction name a thing (`x`), where that goes (`y`), from when, until when, while and for
    how long something is to be (`from`, `to`, `in`, `for`), by how much (`by`), as which colour (`as`), what is not
    wanted (`not`), and what asks for nothing (`off`)."""
    return told(TASK, tuple(words)).spans


def is_any_word(word: str) -> bool:
    """Whether a word stands in any of the vocabularies, or in the sentences that kinds were learned from."""
    return (
        is_word(word)
        or is_known(word)
        or is_common(word)
        or word in network().places
        or has_form(word, tuple(SENSES), "plain", "s", "ing", "past")
    )

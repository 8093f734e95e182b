"""Reads where the person who asks says to be: "if I sat on the sofa facing the window, ..."."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ....gaussians.language.query.query import Query
from . import noun_phrase
from .phrase_templates import Words


@dataclass(frozen=True)
class Situation:
    """A stated place and direction of gaze.

    Attributes:
        words: as said, for the answer's frame: "sitting on the sofa facing the window".
        at: what the person is on, in or at.
        facing: what the person looks at; None: away from the back of what the person sits on, or not said.
    """

    words: str
    at: Query
    facing: Query | None = None


_LEADING = re.compile(
    r"^(?:if|when|while|suppose|supposing|say|imagine|imagining|assuming|assume|with me|pretend)?(?: that)? ?"
    r"(?:(?:i|we|you|someone|somebody|one) )?(?:am |are |is |was |were |would be )?"
    r"(?P<pose>sat|sit|sits|sitting|seated|stood|stand|stands|standing|lie|lay|lying|lies)(?: down)? "
    r"(?:on|in|at|by|beside|next to|near|in front of) (?P<rest>.+)$"
)
_GAZE = re.compile(
    r" (?:and |while )?(?:facing|looking(?: at| to| toward| towards| out of)?|turned to|face|look at|looked at) "
)


def read_situation(words: Words) -> tuple[Situation | None, Words]:
    """The situation at the start of a question, and the words behind it; None and all words if there is none."""
    if "," not in words:
        return None, words
    comma = words.index(",")
    said, rest = " ".join(words[:comma]), words[comma + 1 :]
    found = _LEADING.match(said)
    if found is None or not rest:
        return None, words
    place, _, gaze = _GAZE.sub(" | ", f"{found['rest']} ").strip().partition(" | ")
    at = noun_phrase.thing(tuple(place.split()))
    facing = noun_phrase.thing(tuple(gaze.split())) if gaze else None
    if at is None or (gaze and facing is None):
        return None, words
    return Situation(said, at, facing), rest

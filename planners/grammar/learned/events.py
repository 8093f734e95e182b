"""What happens at a time that is told by it: "once the fan has given up" is when the fan stops.

`training/timed_words.py` learns it from written phrases.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..tagging.words import clean, split
from .network import told

TASK = "events"
NO_EVENT = "none"  # the kind of phrases that tell a time in numbers, or none
LEAST = 0.5  # probability of a kind that is believed

_ALONE = {"reaches": "stops", "leaves": "starts"}  # where no other thing is named
_PRONOUNS = {"it", "he", "she", "they", "him", "her", "them"}
_WHOSE = {"its": "it", "his": "he", "her": "she", "their": "they"}


@dataclass(frozen=True)
class Event:
    """What happens.

    Attributes:
        kind: what is done: "starts", "open", "lands", ...; or what is so: "moves", "is_open", "on", ...
        x, y: the words for the thing that does it, and for the other thing; "" if none are said.
        chance: the probability of the kind.
    """

    kind: str
    x: str
    y: str
    chance: float


def event_of(phrase: str) -> Event | None:
    """What happens at the time that a phrase tells; None if that is not likely enough, or nothing happens."""
    words = tuple(word.text for word in split(clean(phrase.replace(" 's ", "'s "))))
    found = told(TASK, words)
    kind, chance = next(iter(found.kinds), (NO_EVENT, 0.0))
    if kind == NO_EVENT or chance < LEAST:
        return None
    named = [(tag, " ".join(words[a:b]).removesuffix(" 's")) for tag, a, b in found.spans]
    named = [(tag, _WHOSE.get(name, name)) for tag, name in named]
    said = {tag: {name for own, name in named if own == tag} for tag in ("x", "y")}
    if len(said["x"] | said["y"]) > 1:  # "leaving with the robot, arriving with him"
        said = {tag: names - _PRONOUNS if len(names) > 1 or tag == "y" else names for tag, names in said.items()}
    if any(len(names) > 1 for names in said.values()):
        return None
    x, y = ("".join(said[tag]) for tag in ("x", "y"))
    return Event(kind if y else _ALONE.get(kind, kind), x, y, chance)

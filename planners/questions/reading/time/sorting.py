"""Events that are to be put in order: "sort these by time: leaves the rug, comes to rest, starts rolling"."""

from __future__ import annotations

from .....gaussians import late_re as re
from .....gaussians.world.words import singular
from ....grammar.tagging.words import clean, split
from .supposed.times import asked_when

_SORTS = re.compile(
    r"\b(?:sort|order|rank|arrange|put|sequence|line up|chronolog\w+|rearrange|place|number)\b(?!.*\bthings\b)"
)
_LEAST, _MOST = 3, 8  # events
_INTRODUCED = re.compile(r"^(?P<before>[^:]+): ?(?P<events>.+?)[.?!]*$")
_BEHIND = re.compile(r"^(?P<events>[^:]+): ?(?P<before>.+?)[.?!]*$")  # "..., ..., ...: sort these"
_JOINTS = re.compile(r" ?(?:[,;/]|\bthen\b|\band\b(?= ))(?: and| or)? ?")


def sorted_events(text: str, names: frozenset[str]) -> tuple[tuple[str, str], ...]:
    """The events that a text wants in order, each as said and as the question when it happens; none if it wants none,
    or if one of them is not understood.

    Args:
        names: words of the names of the things of the scene.
    """
    said = clean(text).strip()
    found = next((m for m in (_INTRODUCED.match(said), _BEHIND.match(said)) if m and _SORTS.search(m["before"])), None)
    if found is None:
        return ()
    events = [event.strip(" .\"'") for event in _JOINTS.split(found["events"]) if event.strip(" .\"'")]
    if not _LEAST <= len(events) <= _MOST:
        return ()
    who = _whose(found["before"], names) or next(filter(None, (_whose(event, names) for event in events)), "")
    asked = [(event, asked_when(event, who)) for event in events]
    return tuple((event, question) for event, question in asked if question) if all(q for _, q in asked) else ()


def _whose(said: str, names: frozenset[str]) -> str:
    """The last thing of the scene that words name."""
    words = [word.text.removesuffix("'s") for word in split(said)]
    return next((f"the {word}" for word in reversed(words) if word in names or singular(word) in names), "")

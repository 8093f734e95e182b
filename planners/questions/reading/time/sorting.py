"""Events that are to be put in order: "sort these by time: leaves the rug, comes to rest, starts rolling"."""

from __future__ import annotations

from .....gaussians import late_re as re
from .....gaussians.world.words import singular
from ....grammar.learned.events import event_of
from ....grammar.tagging.words import bag, clean, split
from .supposed.plainly import question_of

_SORTS = re.compile(
    r"\b(?:sort|order|rank|arrange|put|sequence|line up|chronolog\w+|rearrange|place|number)\b(?!.*\bthings\b)"
)
_LEAST, _MOST = 3, 8  # events
_SURELY = 0.55  # probability of what happens that is asked for alone
_ASKED = {  # the kind of question that asks when something happens
    "starts": "when_starts", "moves": "when_starts", "stops": "when_stops", "still": "when_stops",
    "opens": "when_opens", "opening": "when_opens", "open": "when_open", "is_open": "when_open", "half": "when_open",
    "closes": "when_closes", "closing": "when_closes", "shut": "when_shut", "is_shut": "when_shut",
    "falls": "when_falls", "falling": "when_falls", "lands": "when_lands", "turns": "when_turns",
    "turning": "when_turns", "reaches": "when_reaches", "on": "when_reaches", "leaves": "when_leaves",
}  # fmt: skip
_OF_ANOTHER = ("reaches", "on", "leaves")  # kinds that name another thing
_PRONOUNS = bag("it he she they")
_ENTERS = re.compile(r"\b(?:enters?|entering|gets? on(?:to)?|rolls? on(?:to)?|comes? on(?:to)?)\b")
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
    asked = [(event, _asked_when(event, who)) for event in events]
    return tuple((event, question) for event, question in asked if question) if all(q for _, q in asked) else ()


def _whose(said: str, names: frozenset[str]) -> str:
    """The last thing of the scene that words name."""
    words = [word.text.removesuffix("'s") for word in split(said)]
    return next((f"the {word}" for word in reversed(words) if word in names or singular(word) in names), "")


def _asked_when(phrase: str, who: str) -> str | None:
    """The question when that happens which a phrase tells: "leaves rug" of the ball; None if it tells nothing.

    Args:
        who: of whom it is told where the phrase does not say; "" for nobody.
    """
    named = not who or who.split()[-1] in phrase.split()
    told = map(event_of, dict.fromkeys((f"when {phrase}" if named else f"when {who} {phrase}", f"when {phrase}")))
    event = next((own for own in told if own is not None and own.kind in _ASKED and own.chance >= _SURELY), None)
    if event is None:
        return None
    if _ENTERS.search(phrase) and event.y:
        return question_of("when_reaches", event.x or who, event.y)
    x = event.x if event.x and event.x not in _PRONOUNS else who
    y = event.y if event.kind in _OF_ANOTHER else ""
    return question_of(_ASKED[event.kind], x, y, event.kind) if x else None

"""The time of a question in plain words, where it is told by what happens: "having made its turn" is "after it has
turned"."""

from __future__ import annotations

from collections.abc import Sequence

from ......gaussians import late_re as re
from .....grammar.learned.events import Event, event_of

_LEADS = (  # how a phrase begins, and the conjunction that says the same
    (re.compile(r"^(?:right |just |only )*(?:until|till|til|up to)\b"), "until"),
    (re.compile(r"^(?:right |just |only )*(?:before|prior to)\b"), "before"),
    (re.compile(r"^by\b"), "by the time"),
    (re.compile(r"^(?:right |just |only |directly |straight )*(?:after|following|having|past|post|since)\b"), "after"),
)
_MOMENTS = {  # what happens, as a predicate
    "starts": "starts to move", "stops": "stops", "opens": "starts to open", "open": "is fully open",
    "closes": "starts to close", "shut": "is closed", "half": "is half open", "falls": "falls", "lands": "lands",
    "turns": "starts to turn", "turned": "has turned", "reaches": "reaches {y}", "leaves": "leaves {y}",
    "first_of": "falls first", "last_of": "falls last",
}  # fmt: skip
_SPANS = {  # what is so for a while
    "moves": "is moving", "still": "stands still", "opening": "is opening", "is_open": "is open",
    "closing": "is closing", "is_shut": "is closed", "falling": "is falling", "turning": "is turning",
    "on": "is on {y}", "in_step": "is moving",
}  # fmt: skip

_LEFT = re.compile(
    r"\b(?:how (?:much|long|many)|what)\b.*\b(?:left|remain\w*|still to (?:come|go)|before (?:it|the \w+) "
    r"(?:ends|runs out|is over|finishes)|(?:to|until|till) the (?:last frame|(?:very )?end))\b|"
    r"\b(?:to|until|till) the (?:last frame|(?:very )?end)\b.*\bhow (?:much|long|many)\b"
)
_TO_THE_END = re.compile(r"(?: ,)? (?:\w+ )?(?:to|until|till) the (?:last frame|(?:very )?end)\b.*$")
_SHOWN = re.compile(
    r"\b(?:film|clip|video|movie|picture|footage|recording|shot|frames?|seconds?|air|screen|time|show|scene|end)\b"
)
_PRONOUNS = ("it", "he", "she", "they")


def plain_time(phrase: str) -> str | None:
    """A time that is told by what happens, as a clause with a plain verb; "" for all of the film, None for another."""
    event = event_of(phrase)
    if event is None:
        return None
    lead = next((word for pattern, word in _LEADS if pattern.match(phrase)), "")
    if event.kind == "film_end" and lead:
        return ""  # before it ends
    if event.kind in ("film_start", "film_end"):
        return "at the start" if event.kind == "film_start" else "at the end"
    who = event.x or "it"
    if who not in _PRONOUNS:
        who = with_article(who)
    if event.kind == "first_leg":
        return f"before {who} turns"
    if event.kind == "last_leg":
        return f"after {who} has turned"
    said = (_MOMENTS | _SPANS)[event.kind].format(y=with_article(event.y))
    return f"{lead or _conjunction(event)} {who} {said}"


def with_article(name: str) -> str:
    """A name with an article."""
    return name if re.match(r"^(?:the|a|an|my|our|this|that|all|both)\b", name) else f"the {name}"


def _conjunction(event: Event) -> str:
    if event.kind == "turned":
        return "after"
    return "while" if event.kind in _SPANS else "when"


def time_left(words: Sequence[str], times: Sequence[str]) -> str | None:
    """The plain question of how much of the film is left when something happens: "once the fan gives up, how much of
    the picture have we left"; None of others.

    Args:
        words: those of the question.
        times: those of its times.
    """
    said = " ".join(words)
    if not times or _LEFT.search(said) is None or _SHOWN.search(said) is None:
        return None
    event = event_of(_TO_THE_END.sub("", times[0]))
    if event is None or not event.x or event.x in _PRONOUNS or event.kind not in _MOMENTS:
        return None
    happens = _MOMENTS[event.kind].format(y=with_article(event.y))
    return f"how long is it from when {with_article(event.x)} {happens} to the end of the film"

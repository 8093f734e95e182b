"""Reads a phrase that asks for a view ("the guitar from behind", "what one sees sitting on the sofa") into its parts.

The things in it stay words; the session resolves them as it resolves every noun phrase.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from ...gaussians import late_re as re
from ...gaussians.errors import UserError

Side = Literal["front", "behind", "left", "right", "above", "below"]
Distance = Literal["close", "far"]

LONGEST = 400  # characters


@dataclass(frozen=True)
class ViewRequest:
    """What view is asked for.

    Attributes:
        things: noun phrase of what is to be seen; "" asks for the whole scene, or for what is seen from `stand`.
        side: from which side; None leaves it open.
        stand: noun phrase of the thing that one looks from; "" if none.
        distance: "close", "far", or None.
        eye_level: from the height of a standing person's eyes.
    """

    things: str = ""
    side: Side | None = None
    stand: str = ""
    distance: Distance | None = None
    eye_level: bool = False


_SIDES: tuple[tuple[Side, str], ...] = (
    ("front", r"front|ahead|in front(?: of (?:it|them))?"),
    ("behind", r"behind(?: (?:it|them))?|back|rear"),
    ("left", r"left"),
    ("right", r"right"),
    ("above", r"above(?: (?:it|them))?|top|overhead|over (?:it|them)|high up|a bird'?s[- ]eye view"),
    ("below", r"below(?: (?:it|them))?|under(?:neath)?(?: (?:it|them))?|bottom"),
)
_CLOSE = r"close(?:[- ]?up)?|up close|near(?:by)?|nearer|closer|a short distance|close range"
_FAR = r"far(?: (?:away|off))?|afar|a distance|further away|farther away|a long way off"
_EYE_LEVEL = r"(?:standing )?eye[- ](?:level|height)|(?:a person's|standing) height"
_OWN = r"(?:(?:the|its|their|his|her) )?"

_SIDE_TAILS: tuple[tuple[Side, re.Pattern[str]], ...] = tuple(
    (side, re.compile(rf"(?:seen |viewed |looking )?from {_OWN}(?:{words})(?: side| hand side)?$"))
    for side, words in _SIDES
)
_HEADS: tuple[tuple[Side, str], ...] = (
    ("front", "front"), ("behind", "rear|back"), ("left", "left"), ("right", "right"),
    ("above", "top|aerial|bird'?s[- ]eye"),
)  # fmt: skip
_SIDE_HEADS: tuple[tuple[Side, re.Pattern[str]], ...] = tuple(
    (side, re.compile(rf"^(?:(?:a|the) )?(?:{words})(?: side)?[- ]view (?:of|at) ")) for side, words in _HEADS
)
_CLOSE_TAIL = re.compile(rf"(?:seen )?(?:from )?(?:very )?(?:{_CLOSE})$")
_CLOSE_HEAD = re.compile(r"^(?:(?:a|the) )?close[- ]?up(?: view| picture)? of ")
_FAR_TAIL = re.compile(rf"(?:seen )?(?:from )?(?:very )?(?:{_FAR})$")
_EYE_TAIL = re.compile(rf"(?:seen )?(?:from|at) (?:{_EYE_LEVEL})$")

_ASKING = re.compile(
    r"^(?:please )?(?:(?:show|give|find|draw|render)(?: me| us)? |look at |let me see |i want to see )?"
    r"(?:(?:a|the) )?(?:(?:view|picture|image|photo|shot) of )?"
)
_WHO = r"(?:one|you|we|i|someone|somebody|a person|people)"
_SEEN = (
    rf"(?:(?:the|a|my) view|view|what (?:(?:{_WHO}(?: would| can| could)? sees?)|(?:would|can|could|do|does) {_WHO} see"
    r"|is (?:seen|visible)|can be seen)|looking|seen)"
)
_POSTURE = (
    r"(?:when |while |if (?:one|you|i|we|someone)(?: is| are| am| was| were)? )?"
    r"(?:from|(?:(?:sitting|seated|sit|sat|lying|lie|standing|stand|stood|being) )"
    r"(?:on top of|on|in|at|by|next to|before|near|inside))"
)
_TOWARD = r"(?:,? ?(?:looking |facing |turned |and looking )?(?:to|towards?|at|into|onto)|,? ?(?:and )?facing)"
_FROM_THING = re.compile(rf"^(?:{_SEEN} )?{_POSTURE} (?P<stand>.+?)(?:{_TOWARD} (?P<things>.+))?$")
_WITH_VIEW = re.compile(rf"^{_SEEN} (?P<things>of .+?|)\s*{_POSTURE} (?P<stand>.+?)$")
_THING_TAIL = re.compile(rf"^(?P<things>.+?),? (?:(?:as )?seen |viewed )?{_POSTURE} (?P<stand>.+?)$")
_WHOLE = re.compile(
    r"(?:(?:the|this|an) )?(?:whole |entire )?(?:scene|room|place|house|floor ?plan|plan|everything|overview)|all"
)
_PLAN = re.compile(r"(?:(?:the|a) )?(?:floor ?plan|plan|plan view|top view|map|layout)(?: of (?:the )?(?:room|scene))?")


def read_view(phrase: str) -> ViewRequest:
    """The parts of a phrase that asks for a view.

    Raises:
        UserError: the phrase is empty or too long.
    """
    if len(phrase) > LONGEST:
        raise UserError(f"a view is described in at most {LONGEST} characters; say for example 'the chair from behind'")
    words = re.sub(r"\s+", " ", phrase.replace("’", "'")).strip(" .!?\"'").lower()
    if not words:
        raise UserError("say what to look at, for example 'the chair from behind' or 'the view from the sofa'")
    if _PLAN.fullmatch(words):
        return ViewRequest(side="above")
    rest, found = _modifiers(words, ViewRequest())
    seen = _seen_from(rest)
    if seen is not None:
        stand, things = seen
        return replace(found, stand=_thing(stand), things=_thing(things))
    rest, found = _heads(_ASKING.sub("", rest, count=1) or rest, found)
    rest = rest.removeprefix("of ")
    tail = _THING_TAIL.fullmatch(rest)
    if tail is not None:
        return replace(found, stand=_thing(tail["stand"]), things=_thing(tail["things"]))
    return replace(found, things=_thing(rest))


def _seen_from(words: str) -> tuple[str, str] | None:
    """The thing that one looks from and what one looks at, of "what one sees from the sofa"; None for other phrases."""
    match = _FROM_THING.fullmatch(words) or _WITH_VIEW.fullmatch(words)
    return (match["stand"], (match["things"] or "").removeprefix("of ")) if match else None


def _modifiers(words: str, found: ViewRequest) -> tuple[str, ViewRequest]:
    """Take "from behind", "close up", "at eye level" off the end, as long as there are any."""
    while True:
        before = words
        for side, pattern in _SIDE_TAILS:
            if found.side is None and (match := pattern.search(words)):
                words, found = words[: match.start()], replace(found, side=side)
        if found.distance is None and (match := _CLOSE_TAIL.search(words)):
            words, found = words[: match.start()], replace(found, distance="close")
        if found.distance is None and (match := _FAR_TAIL.search(words)):
            words, found = words[: match.start()], replace(found, distance="far")
        if not found.eye_level and (match := _EYE_TAIL.search(words)):
            words, found = words[: match.start()], replace(found, eye_level=True)
        words = re.sub(r"(?: and|,)$", "", words.rstrip(" ,")).rstrip()
        if words == before:
            return words, found


def _heads(words: str, found: ViewRequest) -> tuple[str, ViewRequest]:
    """Take "a close-up of", "a rear view of" off the beginning."""
    for side, pattern in _SIDE_HEADS:
        if found.side is None and (match := pattern.match(words)):
            words, found = words[match.end() :], replace(found, side=side)
    if found.distance is None and (match := _CLOSE_HEAD.match(words)):
        words, found = words[match.end() :], replace(found, distance="close")
    return words, found


def _thing(words: str) -> str:
    """A noun phrase; "" where it means the whole scene."""
    words = words.strip(" ,")
    return "" if not words or _WHOLE.fullmatch(words) else words

"""Reads directions from a person: "on my left", "behind me", "at my two o'clock", "straight ahead"."""

from __future__ import annotations

from dataclasses import dataclass

from ....gaussians import late_re as re
from .phrase_templates import Words

SIDES = {"in front": 0.0, "right": 90.0, "behind": 180.0, "left": -90.0}


@dataclass(frozen=True)
class Side:
    """A direction from a person or thing.

    Attributes:
        words: for messages: "on the left", "at two o'clock".
        at: degrees clockwise from straight ahead, in (-180, 180].
        reach: largest degrees off that direction that still count.
        personal: whether it is said of a person ("my left"), not of the room or a picture ("the left").
    """

    words: str
    at: float
    reach: float = 60.0
    personal: bool = True


_HOURS = "one two three four five six seven eight nine ten eleven twelve".split()  # noqa: SIM905
_CLOCK = re.compile(
    rf"(?:(?:in|at|on|to|towards|toward) )?(?:(?:my|the|your|the viewer 's) )?(?P<hour>\d+|{'|'.join(_HOURS)}) "
    r"?o ?'? ?clock(?: (?:direction|position))?(?: (?:from|of) me)?"
)
_NEAR = r"(?:immediate |immediately |direct |directly |far |close |closest |near |own |very |straight |just |right )?"
_WAY = (
    r"(?:(?:over |off |out |just |directly |immediately |straight |right |somewhere )?(?:to|on|at|towards|"
    r"toward|by|in|from) )?"
)
_MINE = re.compile(
    rf"{_WAY}(?:my|our|your|the viewer 's|his|her|their|its) {_NEAR}(?P<side>left|right)(?: hand)?(?: side| foot| "
    rf"shoulder)?"
)
_OF_ME = re.compile(
    rf"(?:{_WAY}the )?{_NEAR}(?P<side>left|right)(?: hand)?(?: side)? (?:of|from) (?:me|us|myself|the viewer|you|them)"
)
_THE = re.compile(rf"{_WAY}the {_NEAR}(?P<side>left|right)(?: hand)?(?: side)?")
_BEHIND = re.compile(
    rf"{_NEAR}(?:behind|in back of|to the (?:back|rear) of|at) "
    r"(?:me|us|my back|your back|you|the viewer|them|him|her)|behind|(?:at|to|on) (?:my|your) (?:back|rear)"
)
_FRONT = re.compile(
    rf"{_NEAR}(?:in front of|before|ahead of|opposite|across from|in the front of) (?:me|us|the viewer|you|them|"
    rf"him|her)|"
    r"(?:straight |right |directly |dead )?ahead(?: of me)?|(?:to|at|on|in) (?:my|the) front|"
    r"(?:more or less )?(?:straight|directly|right) (?:ahead|in front)(?: of me)?|in front|forward|forwards"
)
_DIAGONAL = (
    ("in front on the left", -45.0, ("front left", "left front", "forward left")),
    ("in front on the right", 45.0, ("front right", "right front", "forward right")),
    ("behind on the left", -135.0, ("back left", "left back", "rear left", "behind left")),
    ("behind on the right", 135.0, ("back right", "right back", "rear right", "behind right")),
)
_JOINED = re.compile(r"^(.+?)(?: and| ,| but)? (?=(?:to|on|at|behind|in|slightly) )(.+)$")


def side(words: Words) -> Side | None:
    """The direction that all the words say, None if they say none."""
    said = " ".join(w for w in words if w != ",").replace("oclock", "o'clock")
    if not said or len(words) > 10:
        return None
    single = _single(said)
    if single is not None:
        return single
    for name, at, forms in _DIAGONAL:
        if any(re.fullmatch(rf"(?:{_WAY})(?:my|our|the) {form}(?: side)?(?: of me)?", said) for form in forms):
            return Side(name, at, 45.0)
    joined = _JOINED.match(said)
    if joined is None:
        return None
    one, other = _single(joined[1]), _single(joined[2])
    if one is None or other is None or {one.at, other.at} - {0.0, 90.0, 180.0, -90.0} or one.at == other.at:
        return None
    return _between(one, other)


def either(words: Words) -> Side | None:
    """The second of two directions, which may be a bare word: "on my left or right"."""
    said = " ".join(words)
    bare = {"left": "left", "right": "right", "the left": "left", "the right": "right", "behind": "behind",
            "its left": "left", "its right": "right", "in front": "in front", "front": "in front",
            "back": "behind"}  # fmt: skip
    return Side(bare[said], SIDES[bare[said]]) if said in bare else side(words)


def _between(one: Side, other: Side) -> Side | None:
    if one.at in (90.0, -90.0):
        one, other = other, one
    if one.at in (90.0, -90.0) or other.at not in (90.0, -90.0):
        return None
    found = next(d for d in _DIAGONAL if d[1] == other.at * (0.5 if one.at == 0.0 else 1.5))
    return Side(found[0], found[1], 45.0)


def _single(said: str) -> Side | None:
    clock = _CLOCK.fullmatch(said)
    if clock:
        hour = int(clock["hour"]) if clock["hour"].isdigit() else _HOURS.index(clock["hour"]) + 1
        return Side(f"at {hour} o'clock", _wrapped(30.0 * hour), 22.5) if 1 <= hour <= 12 else None
    for pattern in (_MINE, _OF_ME):
        if found := pattern.fullmatch(said):
            return Side(f"on the {found['side']}", SIDES[found["side"]])
    if found := _THE.fullmatch(said):
        return Side(f"on the {found['side']}", SIDES[found["side"]], personal=False)
    if _BEHIND.fullmatch(said):
        return Side("behind", 180.0, personal=said != "behind")
    if _FRONT.fullmatch(said):
        return Side("in front", 0.0)
    return None


def _wrapped(degrees: float) -> float:
    turn = degrees % 360.0
    return turn - 360.0 if turn > 180.0 else turn


_WAYS = {"left": "left_of", "right": "right_of", "front": "in_front_of", "back": "behind", "rear": "behind"}


def way(words: Words) -> str | None:
    """The relation of one side word of a thing: "left", "right", "front" or "back"."""
    return _WAYS.get(words[0]) if len(words) == 1 else None

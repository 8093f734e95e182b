"""Reads places of the room: "the far left corner", "the back wall", "the viewer's end of the room", "the ceiling"."""

from __future__ import annotations

from ....gaussians import late_re as re
from .phrase_templates import Words

_WAY = (
    r"(?:(?:far|back|rear|front|near|nearest|closest|left|right|left hand|right hand|opposite|viewer 's|other|"
    r"leftmost|rightmost|"
    r"farthest|very)(?: and)? )"
)
_OF_ROOM = r"(?: (?:of|in) (?:the|this) room)?"
_OF_ME = (
    r"(?: (?:nearest|closest|near|closer|farthest)(?: to)?(?: (?:me|us|the viewer))?| farthest from (?:me|the viewer))?"
)
_HAND = r"(?: ,? ?(?:on|to|at) the (?:left|right)(?: hand)?(?: side)?)?"
_CORNER = rf"(?:the|a|one|any|some) {_WAY}{{0,3}}(?:hand )?corners?{_OF_ROOM}{_OF_ME}{_HAND}"
_WALL = rf"(?:the|a|any) {_WAY}{{0,2}}(?:hand |side )?walls?{_OF_ROOM}{_OF_ME}{_HAND}"
_WALL_THERE = rf"the {_WAY}{{1,2}}(?:hand |side )?wall{_OF_ROOM}{_OF_ME}{_HAND}"
_SIDE = (
    rf"(?:the|my) {_WAY}{{1,2}}(?:hand )?(?:side|half|end|part|area){_OF_ROOM}|"
    r"the (?:back|front|rear|left|right|far end|near end)(?: side)? of (?:the|this) room|"
    r"(?:the )?(?:back|front|rear) of (?:the|this) room"
)
_MIDDLE = r"(?:the|this) (?:very )?(?:middle|center|centre)(?: of (?:the|this) room| of the floor)?"
WITHIN = re.compile(
    r" (?:in|at|on|by|near|against|along|next to|towards|toward|up against) "
    rf"({_CORNER}|{_WALL_THERE}|{_SIDE})(?! of )(?= |$)"
)
_ZONE = re.compile(rf"{_CORNER}|{_WALL}|{_SIDE}|{_MIDDLE}")
_SHELL = re.compile(rf"{_WALL}|the walls|the (?:floor|ceiling|ground)|(?:the )?ceiling|floor")


_SAID = {
    "back": "back far rear opposite farthest", "front": "front near nearest nearer closest viewer's close viewer",
    "left": "left leftmost", "right": "right rightmost",
}  # fmt: skip
_WORDS = {word: name for name, words in _SAID.items() for word in words.split()}
_PARTS = re.compile("corner|wall|side|back|front|left|right")


def named_in(said: str) -> tuple[str, ...]:
    """The walls that words name as the viewer sees them, "far left" being back and left; back or front comes first."""
    words = re.findall(
        r"[a-z']+", said.lower().replace(" 's", "'s").replace("right-hand", "right").replace("left-hand", "left")
    )
    names = tuple(_WORDS[w] for w in words if w in _WORDS)
    return tuple(n for n in ("back", "front", "left", "right") if n in names)


def kind_of(said: str) -> str:
    """What a place of the room is: "corner", "wall" or "side"."""
    return "corner" if "corner" in said else "wall" if "wall" in said else "side"


def told(joined: str) -> str:
    """A place as the words of a query, from its kind and names without spaces: "back left corner"."""
    kind, *names = _PARTS.findall(joined)
    return " ".join([*names, kind])


def is_place(text: str) -> bool:
    """Whether a text of a query is such a place."""
    words = text.split()
    return (
        bool(words)
        and words[-1] in ("corner", "wall", "side")
        and (words == ["corner"] or len(words) > 1)
        and set(words[:-1]) <= {"back", "front", "left", "right"}
    )


def zone(words: Words) -> str | None:
    """A place of the room, as said; None if the words name none."""
    said = " ".join(w for w in words if w != ",")
    return said if _ZONE.fullmatch(said) else None


def shell(words: Words) -> str | None:
    """Walls, floor or ceiling, as said."""
    said = " ".join(words)
    return said if _SHELL.fullmatch(said) else None

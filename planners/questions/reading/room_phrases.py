"""Reads places of the room: "the far left corner", "the back wall", "the viewer's end of the room", "the ceiling"."""

from __future__ import annotations

import re

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
_SIDE = (
    rf"(?:the|my) {_WAY}{{1,2}}(?:hand )?(?:side|half|end|part|area){_OF_ROOM}|"
    r"the (?:back|front|rear|left|right|far end|near end)(?: side)? of (?:the|this) room|"
    r"(?:the )?(?:back|front|rear) of (?:the|this) room"
)
_MIDDLE = r"(?:the|this) (?:very )?(?:middle|center|centre)(?: of (?:the|this) room| of the floor)?"
_ZONE = re.compile(rf"{_CORNER}|{_WALL}|{_SIDE}|{_MIDDLE}")
_NEARER = re.compile(r"\b(?:nearest|closest|closer)\b")
_FAR = re.compile(r"\bfarthest\b")
_SHELL = re.compile(rf"{_WALL}|the walls|the (?:floor|ceiling|ground)|(?:the )?ceiling|floor")


def zone(words: Words) -> str | None:
    """A place of the room, as said; None if the words name none."""
    said = " ".join(w for w in words if w != ",")
    return said if _ZONE.fullmatch(said) else None


def shell(words: Words) -> str | None:
    """Walls, floor or ceiling, as said."""
    said = " ".join(words)
    return said if _SHELL.fullmatch(said) else None

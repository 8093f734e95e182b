"""Reads one end of a distance: a thing, its middle or edge, the person who asks, or the middle of the room."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from . import noun_phrase
from .phrase_templates import Words

_ME = re.compile(
    r"(?:me|myself|us|(?:the |this )?viewer|the (?:camera|observer|onlooker)|here|where (?:i am|i stand|we are|you are)"
    r"(?: (?:standing|sitting|now))?|my (?:position|spot|place|standpoint|seat|eyes?)|you|the viewer 's "
    r"(?:position|spot))"
)
_ROOM = re.compile(
    r"(?:the )?(?:middle|centre|center) of (?:the|this) (?:room|floor)|the room 's (?:middle|centre|center)"
)
_PART = re.compile(
    r"^(?:the )?(?P<part>middle|centre|center|centers|centres|middles|edges|sides|facing sides|surfaces|ends|"
    r"central point|midpoint|edge|closest edge|nearest edge|near edge|nearest "
    r"point|closest point|side|end|foot|surface|front edge|front) of "
)


@dataclass(frozen=True)
class Spot:
    """One end of a distance.

    Attributes:
        query: the thing; None for a person or the room.
        who: "me": the person who asks; "room": the middle of the room; "": a thing.
        part: "centre" or "edge" of the thing, "" if not said.
    """

    query: Query | None = None
    who: Literal["", "me", "room"] = ""
    part: Literal["", "centre", "edge"] = ""


def spot(words: Words) -> Spot | None:
    """The place that all the words name, None if they name none."""
    said = " ".join(words)
    if _ME.fullmatch(said):
        return Spot(who="me")
    if _ROOM.fullmatch(said):
        return Spot(who="room")
    part = _PART.match(said)
    rest = tuple((said[part.end() :] if part else said).split())
    if not rest or rest[-1] in ("and", "or", "to", "than", "from"):
        return None
    found = noun_phrase.thing(rest)
    if found is None:
        return None
    centre = part is not None and part["part"].startswith(("mid", "cent"))
    return Spot(found, part="" if part is None else "centre" if centre else "edge")

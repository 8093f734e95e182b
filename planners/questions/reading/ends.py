"""Reads where a way begins or ends, and who or what goes there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from ....gaussians.world.lengths import IN_METRES, UNITS
from ....gaussians.world.person import SHOULDERS
from . import noun_phrase
from .item import read_item
from .phrase_templates import Words

_HERE = re.compile(
    r"^(?:here|me|my (?:position|place|spot|viewpoint)|where (?:i|we) (?:am|are|stand|sit)(?: standing| sitting| now)?|"
    r"the (?:viewer|camera|viewpoint|front of the room|entrance of the picture)|this (?:spot|point|side))$"
)
_MIDDLE = re.compile(r"^the (?:middle|center)(?: of the room)?$")
# Widths in metres, from data sheets: of a wheelchair with hands on its wheels, of a twin pram, a rollator, a robot.
WIDTHS = {
    "wheelchair": 0.8, "wheel chair": 0.8, "rollator": 0.65, "walker": 0.65,
    "zimmer frame": 0.65, "walking frame": 0.65,
    "pram": 0.6, "stroller": 0.6, "buggy": 0.6, "pushchair": 0.6, "baby carriage": 0.6,
    "vacuum robot": 0.35, "robot vacuum": 0.35, "robot": 0.35, "roomba": 0.35, "cleaning robot": 0.35,
    "robot vacuum cleaner": 0.35, "person": SHOULDERS, "man": SHOULDERS, "woman": SHOULDERS, "adult": SHOULDERS,
    "human": SHOULDERS, "visitor": SHOULDERS, "guest": SHOULDERS, "child": 0.35, "kid": 0.35, "toddler": 0.3,
    "dog": 0.3,
    "cat": 0.2,
}  # fmt: skip
_PEOPLE = frozenset("i we you one someone somebody anyone anybody people guests visitors they he she".split())  # noqa: SIM905
_USER = re.compile(
    r"^(?:someone|somebody|anyone|a person|people|i|a (?:man|woman|visitor|guest|user)|guests|one)"
    r"(?: who (?:is|uses|sits|needs))? (?:in|with|using|pushing|on|sitting in) (?:a|an|my|their|his|her) (.+)$"
)
_WITH_WIDTH = re.compile(
    r"^(?:a |an |my |the )?(?:standard |normal |regular |average |manual |electric )?(.+?)(?: users?)?$"
)


@dataclass(frozen=True)
class Place:
    """An end of a way: a thing, or a place of the person who asks.

    Attributes:
        query: the thing; None for a place without one.
        spot: "here" or "middle" where there is no thing.
    """

    query: Query | None = None
    spot: Literal["here", "middle", ""] = ""


@dataclass(frozen=True)
class Walker:
    """Who goes: its width in metres and its name, "" for a person."""

    width: float = SHOULDERS
    name: str = ""


def end(words: Words) -> Place | None:
    """An end of a way: "the desk", "here", "the middle of the room"."""
    said = " ".join(words)
    if _HERE.match(said):
        return Place(spot="here")
    if _MIDDLE.match(said):
        return Place(spot="middle")
    if words[-1] in UNITS or words[-1] in IN_METRES:
        return None
    query = noun_phrase.thing(words)
    return Place(query) if query is not None and not noun_phrase.is_anything(query) else None


def walker(words: Words) -> Walker | None:
    """Who or what goes: "one", "a wheelchair", "somebody in a 75 cm wide wheelchair"."""
    said = " ".join(w for w in words if w != ",")
    if said in _PEOPLE:
        return Walker()
    if user := _USER.match(said):
        said = user[1]
    found = _WITH_WIDTH.match(said)
    name = found[1] if found else said
    if name in WIDTHS:
        return Walker(WIDTHS[name], "" if WIDTHS[name] == SHOULDERS else name)
    item = read_item(tuple(said.split()))
    if item is not None and item.stated and item.width is not None:
        return Walker(min(item.width, item.depth or item.width), item.name)
    return None

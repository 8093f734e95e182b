"""Reads where something is to go: "between the bed and the wall", "against the back wall, under the window"."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from . import noun_phrase
from .phrase_templates import Words

Relation = Literal[
    "room", "middle", "corner", "wall", "between", "next_to", "in_front", "behind", "left", "right", "opposite", "near",
    "under", "on", "inside", "around", "at", "above", "through",
]  # fmt: skip

_SIDE_WORDS = {
    "left": "left", "left hand": "left", "leftmost": "left", "right": "right", "right hand": "right",
    "rightmost": "right", "back": "back", "far": "back", "rear": "back", "farthest": "back", "front": "front",
    "near": "front", "nearest": "front", "closest": "front",
}  # fmt: skip
_SIDE = rf"(?:{'|'.join(sorted(_SIDE_WORDS, key=len, reverse=True))})"
_SIDES = rf"(?P<sides>(?:{_SIDE}(?: and)? )*)(?:hand )?"
_ROOM = re.compile(
    r"(?:flat )?(?:anywhere|somewhere|anywhere else|somewhere else|at any place|in any place)?(?: at all)? ?"
    r"(?:in (?:the|this|our|my) (?:room|space|place)|in here|here|on the floor|in there|on the (?:free |open )?floor|"
    r"in the room|into the room|into (?:the|this) (?:room|space)|inside the room|on the ground|in (?:the )?free space)?"
)
_MIDDLE = re.compile(r"(?:right |exactly )?(?:in|into|at|on) the (?:middle|center)(?: of (?:the|this) (?:room|floor))?")
_CORNER = re.compile(rf"(?:right )?(?:in|into|at) (?:the|a|any|one|that|this|some|either) {_SIDES}corners?"
                     r"(?: of (?:the|this) room)?")  # fmt: skip
_WALL = re.compile(
    rf"(?:up |right |flush |flat )?(?:against|along|at|on|alongside|by|to|in front of|next to|beside|near) "
    rf"(?:the|a|any|one|that|this|some|either) {_SIDES}(?:side )?(?P<what>walls?|edge|end|side)"
    r"(?P<of> of (?:the|this) room)?"
)
_A_WALL = re.compile(rf"(?:the|a|any|that|this) {_SIDES}(?:side )?wall(?: of (?:the|this) room)?")
_BETWEEN = re.compile(r"(?:in |into |in the (?:gap|space|room) |into the (?:gap|space) )?between")
# Longest first: the words before a thing, and what they mean.
_BEFORE: tuple[tuple[str, Relation], ...] = tuple(sorted((
    *((p, "next_to") for p in ("next to", "beside", "alongside", "adjacent to", "at the side of", "right beside",
                                "right next to", "directly next to", "on either side of", "on one side of",
                                "by the side of",
                                "to the side of", "immediately next to")),
    *((p, "in_front") for p in ("in front of", "right in front of", "directly in front of", "at the foot of",
                                 "at the end of", "before", "on the floor in front of")),
    *((p, "behind") for p in ("behind", "in back of", "right behind", "directly behind", "at the back of")),
    *((p, "left") for p in ("left of", "to the left of", "on the left of", "on the left side of", "to the left side of",
                             "on the left hand side of")),
    *((p, "right") for p in ("right of", "to the right of", "on the right of", "on the right side of",
                              "to the right side of", "on the right hand side of")),
    *((p, "opposite") for p in ("opposite", "across from", "facing", "opposite to")),
    *((p, "near") for p in ("near", "close to", "by", "in the vicinity of", "nearby")),
    *((p, "under") for p in ("under", "below", "beneath", "underneath", "directly under", "right under")),
    *((p, "on") for p in ("on", "on top of", "onto", "atop", "upon", "on the top of")),
    *((p, "above") for p in ("above", "over", "on the wall above", "on the wall over")),
    *((p, "inside") for p in ("in", "inside", "into", "within")),
    *((p, "around") for p in ("around",)),
    *((p, "at") for p in ("at", "to")),
    *((p, "through") for p in ("through", "thru", "in through", "out through", "out of")),
), key=lambda p: -len(p[0].split())))  # fmt: skip


@dataclass(frozen=True)
class Wall:
    """Walls by the viewer's sides; any wall if there are none."""

    sides: tuple[str, ...] = ()


Anchor = Query | Wall


@dataclass(frozen=True)
class Where:
    """One condition on a place.

    Attributes:
        relation: how it lies to the anchors.
        anchors: things or walls; two for "between".
        sides: of a wall or a corner, as the viewer sees it: "left", "back"; none for any.
    """

    relation: Relation
    anchors: tuple[Anchor, ...] = ()
    sides: tuple[str, ...] = ()


@lru_cache(maxsize=4096)
def where_to(words: Words) -> tuple[Where, ...] | None:
    """The conditions on a place, None if not all of the words are understood."""
    said = tuple(w for w in words if w != ",")
    if not said or len(said) > 24:
        return None
    return next(_parsed(said), None)


def _parsed(words: Words) -> Iterator[tuple[Where, ...]]:
    """Every reading of the words, those of the fewest conditions first."""
    if not words:
        yield ()
        return
    if (
        words[0] in ("and", "just", "right", "somewhere", "anywhere", "directly", "immediately", "exactly")
        and words[1:]
    ):
        yield from _parsed(words[1:])
    for end in range(len(words), 0, -1):
        found = _one(words[:end])
        if found is not None:
            for rest in _parsed(words[end:]):
                yield (found, *rest)


def _one(words: Words) -> Where | None:
    """One condition that takes all of the words."""
    said = " ".join(words)
    if _ROOM.fullmatch(said):
        return Where("room")
    if _MIDDLE.fullmatch(said):
        return Where("middle")
    if corner := _CORNER.fullmatch(said):
        return Where("corner", sides=_sides(corner["sides"]))
    wall = _WALL.fullmatch(said)
    if wall and (wall["what"].startswith("wall") or (wall["of"] and wall["sides"])):
        return Where("wall", sides=_sides(wall["sides"]))
    if between := _BETWEEN.match(said):
        return _between(tuple(said[between.end() :].split()))
    for phrase, relation in _BEFORE:
        if said.startswith(f"{phrase} "):
            anchor = _anchor(words[len(phrase.split()) :])
            if anchor is not None and not (isinstance(anchor, Wall) and relation not in ("opposite",)):
                return Where(relation, (anchor,))
    return None


def _between(words: Words) -> Where | None:
    for cut, word in enumerate(words):
        if word != "and" or not 0 < cut < len(words) - 1:
            continue
        first, second = _anchor(words[:cut]), _anchor(words[cut + 1 :])
        if first is not None and second is not None and not (isinstance(first, Wall) and isinstance(second, Wall)):
            return Where("between", (first, second))
    every = _anchor(words)
    if isinstance(every, Query) and (every.count == 2 or every.pick == "all"):
        return Where("between", (every, every))
    return None


def _anchor(words: Words) -> Anchor | None:
    if not words:
        return None
    said = " ".join(words)
    if wall := _A_WALL.fullmatch(said):
        return Wall(_sides(wall["sides"]))
    if said in ("it in", "here", "there") or words[0] in ("of", "front", "top", "between"):
        return None
    query = noun_phrase.thing(words)
    if query is None or noun_phrase.is_anything(query) or query.text in ("room", "corner", "middle", "floor"):
        return None
    return query


def _sides(said: str) -> tuple[str, ...]:
    found = re.findall(_SIDE, said)
    return tuple(dict.fromkeys(_SIDE_WORDS[f] for f in found))

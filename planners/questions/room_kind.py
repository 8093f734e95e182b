"""What kind of room it is, from the kinds of things in it and the table of rooms that the composer uses."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache

from ...gaussians.world import kinds
from ..compose.knowledge import RoomKind, rooms
from .survey import Survey

LEAST = 3  # different named kinds of things, fewer tell nothing
_MUST, _USUAL, _RARE, _STRANGE = 0.85, 0.5, 0.12, 0.02  # probabilities that a room holds a thing, by its habit
_MOST = 0.9  # probability of the likeliest kind at most: the table does not know every room
_OWN = 0.75  # share of the things on the floor that a kind of room usually holds; below, it is less likely that kind
_SOFTEN = 0.6  # exponent on the odds, since things of a room are not independent


@dataclass(frozen=True)
class RoomGuess:
    """A kind of room with its probability, and the things that speak for it, the strongest first."""

    name: str
    probability: float
    signs: tuple[str, ...]


def room_kinds(survey: Survey) -> tuple[RoomGuess, ...]:
    """The kinds of rooms that fit what is there, the likeliest first; none where too few things are named."""
    found = {k.name: k for t in survey.things if t.label and (k := kinds.of(t.label)) is not None and not k.opening}
    held = {k.name for k in found.values()} | {k.role for k in found.values()}
    if len(found) < LEAST:
        return ()
    named = (room for room in rooms().values() if room.name != "room")  # that entry furnishes a room of no kind
    scores = {room.name: _SOFTEN * _fit(room, found.values(), held) for room in named}
    best = max(scores.values())
    standing = [k for k in found.values() if k.support == "floor"]
    total = sum(math.exp(s - best) for s in scores.values())
    order = sorted(scores, key=lambda name: (-scores[name], name))
    return tuple(
        RoomGuess(
            name,
            _MOST * math.exp(scores[name] - best) / total * min(1.0, _own_share(name, standing) / _OWN),
            _signs(rooms()[name], found.values()),
        )
        for name in order[:4]
    )


def _fit(room: RoomKind, found: Iterable[kinds.Kind], held: set[str]) -> float:
    """Logarithm of the probability of what is there and of what must be there and is not."""
    expected = _expected(room.name)
    score = sum(math.log(max(expected.get(k.name, _STRANGE), expected.get(k.role, _STRANGE))) for k in found)
    return score + sum(math.log(1 - _MUST) for h in room.must if h.thing not in held)


@cache
def _expected(name: str) -> dict[str, float]:
    """Probability that a kind of room holds each of its usual things: the likeliest come first in the table."""
    room = rooms()[name]
    share = {
        h.thing: _USUAL + (_RARE - _USUAL) * i / max(len(room.usual) - 1, 1)
        for i, h in reversed([*enumerate(room.usual)])
    }
    return share | {h.thing: _MUST for h in room.must}


def _own_share(name: str, standing: Sequence[kinds.Kind]) -> float:
    """Share of the kinds of things on the floor that a kind of room usually holds."""
    expected = _expected(name)
    return sum(k.name in expected or k.role in expected for k in standing) / max(len(standing), 1)


def _signs(room: RoomKind, found: Iterable[kinds.Kind]) -> tuple[str, ...]:
    """What is there of the room's own things, those first that few other kinds of rooms have."""
    own = _expected(room.name)
    shared = {k.name: sum(k.name in _expected(r) or k.role in _expected(r) for r in rooms()) for k in found}
    return tuple(sorted((k.name for k in found if k.name in own or k.role in own), key=lambda n: (shared[n], n)))[:4]

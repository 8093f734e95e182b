"""Tags parts of space: "above 1 m", "more than 50 cm left of the table", "within 2 m of the plant".

A phrase becomes one token: HEIGHT says all ("above 1 m"), REGION needs the thing that follows it ("within 2 m of").
"""

from __future__ import annotations

from typing import Any

from ..vocabulary import lexicon, quantities
from .lookahead import match
from .tags import TaggerState
from .words import phrases

# With these verbs a length behind a noun says how far it goes, not what is meant.
_MOVING = frozenset(
    {"MOVE", "PUT", "ADD", "COPY", "RAISE", "WANT", "TAKE", "ROTATE", "TURN", "SCALE", "GROW", "STRETCH"}
)
_SIDES = ("above", "below", "left_of", "right_of", "in_front_of", "behind")
_MORE = phrases("more than, at least, over, further than, farther than, everything over, greater than")
_UPPER = phrases("above, higher than, over, higher up than, taller than, more than")
_LOWER = phrases("below, under, lower than, beneath, underneath, less than")
_NEAR = phrases("of, from, to, around, away from, round")
_AROUND = phrases(
    "within, inside, in a radius of, within a radius of, at most, less than, closer than, nearer than, up to"
)
_BEYOND = phrases(
    "outside, outside of, beyond, more than, farther than, further than, farther away than, further away than, "
    "at least, over"
)
_OF_FLOOR = phrases(
    "above the floor, above the ground, over the floor, over the ground, from the floor, from the ground, "
    "off the floor, off the ground, above floor level, above ground, up, high, in height"
)


def tag_region(state: TaggerState, i: int) -> int | None:
    """Tag the part of space whose words begin at `i`; None if there is none."""
    if state.clause.verb in _MOVING or not state.clause.tags:
        return None
    for reader in (_height, _side, _distance):
        if (found := reader(state, i)) is not None:
            return found
    return None


def _length(state: TaggerState, i: int) -> tuple[dict[str, Any], int] | None:
    """The length at `i` as fields of a region, and the position behind it."""
    found = quantities.read(state.texts[i:]) if i < len(state.texts) else None
    if found is None or found.kind != "LENGTH" or found.value < 0:
        return None
    return {"distance": found.value, "unit": found.unit}, i + found.taken


def _height(state: TaggerState, i: int) -> int | None:
    """ "above 1 m", "higher than 2 m", "below 30 cm", "lower than 1 m above the floor"."""
    for name, table in (("above", _UPPER), ("below", _LOWER)):
        lead = match(table, state.texts, i)
        at = _length(state, i + lead[1]) if lead else None
        if lead is None or at is None:
            continue
        fields, end = at
        floor = match(_OF_FLOOR, state.texts, end)
        behind = state.texts[end : end + 1]
        if not floor and (behind in (("of",), ("from",), ("away",), ("around",)) or _side_at(state, end)):
            continue
        if lead[0] in (("more", "than"), ("less", "than")) and not floor:
            continue
        return state.emit("HEIGHT", {"name": name, **fields}, i, end + (floor[1] if floor else 0) - i)
    return None


def _side(state: TaggerState, i: int) -> int | None:
    """ "1 m above the table", "more than 20 cm left of the sofa"."""
    lead = match(_MORE, state.texts, i)
    at = _length(state, i + (lead[1] if lead else 0))
    if at is None:
        return None
    fields, end = at
    side = _side_at(state, end)
    if side is None or not state.ahead.object_follows(end + side[1]):
        return None
    floor = match(_OF_FLOOR, state.texts, end)
    if floor and side[0] == "above":
        return state.emit("HEIGHT", {"name": "above", **fields}, i, end + floor[1] - i)
    return state.emit("REGION", {"name": side[0], **fields}, i, end + side[1] - i)


def _side_at(state: TaggerState, i: int) -> tuple[str, int] | None:
    """The relation of a side whose words are at `i`, and how many they are."""
    found = match(lexicon.CLOSED_PHRASES, state.texts, i) if i < len(state.texts) else None
    if found is None or found[0][0] != "PREP" or found[0][1] not in _SIDES:
        return None
    return found[0][1], found[1]


def _distance(state: TaggerState, i: int) -> int | None:
    """ "within 2 m of the plant", "more than 1 m away from the table", "2 m around the plant"."""
    for table, outside in ((_AROUND, False), (_BEYOND, True), (None, False)):
        lead = match(table, state.texts, i) if table else None
        if table and lead is None:
            continue
        at = _length(state, i + (lead[1] if lead else 0))
        if at is None:
            continue
        fields, end = at
        near = match(_NEAR, state.texts, end)
        if near is None or (table is None and near[0] not in (("around",), ("round",))):
            continue
        if not state.ahead.object_follows(end + near[1]):
            continue
        value = {"name": "within", **fields, **({"outside": True} if outside else {})}
        return state.emit("REGION", value, i, end + near[1] - i)
    return None

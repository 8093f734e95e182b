"""Questions about what is on, under, next to, between and inside things."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ....gaussians.world import kinds
from .. import sentences as say
from ..naming import Made, Room, asked, named, yes_no
from ..truth import FLAT, Thing, plan_gap, shared

NEXT_TO, NOT_NEXT_TO = 0.15, 1.6  # metres of gap
UNDER = 0.75  # share of the smaller footprint
ON_LINE = 0.12  # share of the way between two things, aside of it, up to which a thing is between them
OFF_LINE = 0.8  # from which it is not


def _inside(inner: Thing, outer: Thing) -> bool:
    return shared(inner, outer) > 0.99 and inner.low >= outer.low - 0.01 and inner.high <= outer.high + 0.01


def _tops(room: Room) -> Iterator[tuple[Thing, list[Thing], bool]]:
    """Things that carry others or could, with what is on them, and whether all of that is on their top."""
    for thing in room.named:
        kind = kinds.of(thing.label)
        held = list(room.table.carried_by(thing))
        on_top = all(t.low >= thing.high - 0.05 for t in held)
        if (
            thing.size[2] > FLAT
            and (held or (kind is not None and kind.top))
            and not any(room.table.carried_by(t) for t in held)
        ):
            yield thing, held, on_top


def on(room: Room) -> Made:
    """What stands on a thing."""
    for thing, held, on_top in _tops(room):
        if held and (on_top or thing.label in ("sofa", "bed", "armchair", "bookshelf")):
            ids = (thing.id, *(t.id for t in held))
            text = room.word(say.ON, a=thing)
            yield asked(room, "on", "list", text, tuple(t.label for t in held), about=ids, names=(thing.id,))


def on_is(room: Room) -> Made:
    """Yes or no: whether something, or anything, stands on a thing; what something stands on."""
    tops = list(_tops(room))
    for thing, held, on_top in tops:
        small = [t for t in room.named if isinstance(t.support, int) or t.size[2] < 0.3]
        for other in held:
            if other.id in room.names:
                yield asked(
                    room, "on_is", "yesno", room.word(say.ON_IS, a=other, b=thing), "yes", **named(thing, other)
                )
                if on_top:
                    yield asked(room, "on_is", "label", room.word(say.CARRIER, a=other), thing.label,
                             about=(other.id, thing.id), names=(other.id,))  # fmt: skip
        for other in small:
            alone = not any(t.label == other.label for t in held)
            if alone and other.id != thing.id and plan_gap(other, thing) > 0.3:
                yield asked(room, "on_is", "yesno", room.word(say.ON_IS, a=other, b=thing), "no", **named(thing, other))
                break
        near = [
            t for t in room.table.things if t.id != thing.id and plan_gap(t, thing) < 0.02 and t.low > thing.high - 0.1
        ]
        if len(near) == len(held) and on_top:
            text = room.word(say.ANY_ON, a=thing)
            holds = bool(held) != ("empty" in text)
            yield asked(room, "on_is", "yesno", text, yes_no(holds), about=(thing.id, *(t.id for t in held)),
                     names=(thing.id,))  # fmt: skip


def under_is(room: Room) -> Made:
    """Yes or no: whether one thing is under another."""
    for a, b in room.pairs():
        kind = kinds.of(b.label)
        roomy = kind is not None and (kind.top or kind.seats > 0 or "bed" in b.label)
        if a.support != "floor" or not roomy or b.size[2] < 0.3 or a.size[2] > 0.5 * b.size[2]:
            continue
        over = max(shared(a, b), shared(b, a))
        if over >= UNDER and a.high <= b.low + 0.1 * b.size[2] + 0.02:
            yield asked(room, "under_is", "yesno", room.word(say.UNDER_IS, a=a, b=b), "yes", **named(b, a))
        elif plan_gap(a, b) > 0.4:
            yield asked(room, "under_is", "yesno", room.word(say.UNDER_IS, a=a, b=b), "no", **named(b, a))


def next_is(room: Room) -> Made:
    """Yes or no: whether two things on the floor stand next to each other."""
    standing = room.standing
    for a, b in room.pairs(standing):
        near = plan_gap(a, b)
        if 0 < near <= NEXT_TO:
            yield asked(room, "next_is", "yesno", room.word(say.NEXT_IS, a=a, b=b), "yes", **named(a, b))
        elif near >= NOT_NEXT_TO + 0.3 * (max(a.size[:2]) + max(b.size[:2])) and room.rng.random() < 0.15:
            yield asked(room, "next_is", "yesno", room.word(say.NEXT_IS, a=a, b=b), "no", **named(a, b))


def between_is(room: Room) -> Made:
    """Yes or no: whether one thing stands between two others."""
    for a, b, c in room.triples(room.standing):
        way = c.xy - b.xy
        length = float(np.linalg.norm(way))
        if length < 1.0:
            continue
        t = float((a.xy - b.xy) @ way) / length**2
        aside = float(np.linalg.norm(a.xy - b.xy - t * way)) / length
        apart = min(plan_gap(x, y) for x, y in ((a, b), (a, c), (b, c))) > 0.05
        if apart and 0.25 < t < 0.75 and aside < ON_LINE:
            yield asked(room, "between_is", "yesno", room.word(say.BETWEEN_IS, a=a, b=b, c=c), "yes", **named(a, b, c))
        elif (t < -0.2 or t > 1.2 or aside > OFF_LINE) and room.rng.random() < 0.1:
            yield asked(room, "between_is", "yesno", room.word(say.BETWEEN_IS, a=a, b=b, c=c), "no", **named(a, b, c))


def inside(room: Room) -> Made:
    """What is inside a thing that things are kept in."""
    for thing in room.named:
        kind = kinds.of(thing.label)
        if kind is None or not (kind.stores or kind.holds):
            continue
        held = [t for t in room.table.things if t.id != thing.id and _inside(t, thing)]
        touching = [t for t in room.table.carried_by(thing) if t not in held]
        if held and not touching:
            text = room.word(say.INSIDE, a=thing)
            ids = (thing.id, *(t.id for t in held))
            yield asked(room, "inside", "list", text, tuple(t.label for t in held), about=ids, names=(thing.id,))
            for other in held:
                if other.id in room.names:
                    text = room.word(say.INSIDE_IS, a=other, b=thing)
                    yield asked(room, "inside", "yesno", text, "yes", **named(thing, other))
        small = [t for t in room.named if plan_gap(t, thing) > 0.4 and t.volume < 0.2 * thing.volume]
        small = [t for t in small if t.support not in ("wall", "ceiling")]
        if small and thing.label not in {t.label for t in held}:
            other = small[0]
            if not any(t.label == other.label for t in held):
                text = room.word(say.INSIDE_IS, a=other, b=thing)
                yield asked(room, "inside", "yesno", text, "no", **named(thing, other))

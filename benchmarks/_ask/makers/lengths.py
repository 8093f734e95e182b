"""Questions about sizes and distances: lengths, comparisons, the nearest and the farthest."""

from __future__ import annotations

from ....gaussians.world import kinds
from .. import sentences as say
from ..naming import Made, Room, asked, named, yes_no
from ..truth import Thing, centers_apart, gap

TALLER = 0.15  # relative and in metres: by which the taller of two is taller
BIGGER = 1.6  # factor of volume; neither height nor footprint may say the reverse
LEAST = 0.25  # metres: the smallest side or distance that is asked for
CLEAR_OF = 0.3  # metres, and as a share: by which the nearest is nearer than the next, by gap and by centre


def size(room: Room) -> Made:
    """Height, length, and of things with a front their width."""
    for thing in room.named:
        width, depth, height = thing.size
        if height >= LEAST:
            yield asked(room, "size", "metres", room.word(say.HEIGHT, a=thing), height, **named(thing))
        longer, shorter = max(width, depth), min(width, depth)
        if longer >= 1.0 and longer > 1.4 * shorter and thing.support != "wall" and height < longer:
            yield asked(room, "size", "metres", room.word(say.LENGTH, a=thing), longer, **named(thing))
        kind = kinds.of(thing.label)
        if kind is not None and kind.front and width >= 2 * LEAST:
            yield asked(room, "size", "metres", room.word(say.WIDTH, a=thing), width, **named(thing))


def compare(room: Room) -> Made:
    """Which of two is taller or bigger."""
    for a, b in room.pairs():
        if (taller := _taller(a, b)) is not None:
            yield asked(room, "compare", "label", room.word(say.TALLER, a=a, b=b), taller.label, **named(a, b))
        if (bigger := _bigger(a, b)) is not None:
            yield asked(room, "compare", "label", room.word(say.BIGGER, a=a, b=b), bigger.label, **named(a, b))


def compare_is(room: Room) -> Made:
    """Yes or no: whether one is taller, bigger or smaller than the other."""
    for a, b in room.pairs():
        if (taller := _taller(a, b)) is not None:
            yield asked(
                room, "compare_is", "yesno", room.word(say.TALLER_IS, a=a, b=b), yes_no(taller is a), **named(a, b)
            )
        if (bigger := _bigger(a, b)) is not None:
            text = room.word(say.BIGGER_IS, a=a, b=b)
            yield asked(room, "compare_is", "yesno", text, yes_no((bigger is a) != ("smaller" in text)), **named(a, b))


def _taller(a: Thing, b: Thing) -> Thing | None:
    if a.label == b.label:
        return None
    low, high = sorted((a, b), key=lambda t: t.size[2])
    clear = high.size[2] > (1 + TALLER) * low.size[2] and high.size[2] > low.size[2] + TALLER
    return high if clear else None


def _bigger(a: Thing, b: Thing) -> Thing | None:
    if a.label == b.label:
        return None
    small, big = sorted((a, b), key=lambda t: t.volume)
    areas = [t.size[0] * t.size[1] for t in (small, big)]
    clear = big.volume > BIGGER * small.volume and big.size[2] > 0.9 * small.size[2] and areas[1] > 0.9 * areas[0]
    return big if clear else None


def distance(room: Room) -> Made:
    """Centre to centre, from surface to surface, or unsaid, where both are right."""
    for a, b in room.pairs():
        far, free = centers_apart(a, b), gap(a, b)
        if far < 2 * LEAST:
            continue
        yield asked(room, "distance", "metres", room.word(say.CENTERS, a=a, b=b), far, **named(a, b))
        if free >= LEAST:
            yield asked(room, "distance", "metres", room.word(say.GAP, a=a, b=b), free, **named(a, b))
            yield asked(room, "distance", "metres", room.word(say.APART, a=a, b=b), far, free, **named(a, b))


def distance_is(room: Room) -> Made:
    """Yes or no: whether two things are farther apart than a length; clear for both distances."""
    for a, b in room.pairs(room.standing):
        far, free = centers_apart(a, b), gap(a, b)
        if free < LEAST:
            continue
        for said, yes in ((round(0.6 * free, 1), True), (round(1.6 * far, 1), False)):
            if said >= 0.3 and room.rng.random() < 0.5:
                text = room.word(say.FARTHER_THAN, a=a, b=b, d=f"{said:g}")
                yield asked(room, "distance_is", "yesno", text, yes_no(yes), **named(a, b))


def _order(room: Room, thing: Thing) -> tuple[Thing | None, Thing | None]:
    """The nearest and the farthest other thing, None where it is not clear by gap and by centre alike."""
    others = [t for t in room.table.things if t.id != thing.id]
    if len(others) < 3:
        return None, None
    found: list[Thing | None] = []
    for sign in (1, -1):
        best = []
        for measure in (centers_apart, gap):
            ranked = sorted(others, key=lambda t: sign * measure(thing, t))
            first, second = (measure(thing, t) for t in ranked[:2])
            clear = abs(second - first) >= CLEAR_OF * (1.0 if sign < 0 else max(min(first, 1.0), 0.5))
            best.append(ranked[0] if clear else None)
        found.append(best[0] if best[0] is best[1] else None)
    return found[0], found[1]


def nearest(room: Room) -> Made:
    """What is nearest to a thing, and farthest from it.

    The nearest to what carries something, or is carried, is a matter of taste.
    """
    for thing in room.named:
        near, far = _order(room, thing)
        alone = not isinstance(thing.support, int) and not room.table.carried_by(thing)
        if near is not None and alone and near.label != thing.label:
            yield asked(room, "nearest", "label", room.word(say.NEAREST, a=thing), near.label,
                     about=(thing.id, near.id), names=(thing.id,))  # fmt: skip
        if far is not None and far.label != thing.label:
            yield asked(room, "farthest", "label", room.word(say.FARTHEST, a=thing), far.label,
                     about=(thing.id, far.id), names=(thing.id,))  # fmt: skip


def nearer(room: Room) -> Made:
    """Which of two is nearer to a third, by gap and by centre."""
    for a, b, c in room.triples(room.named):
        first = [m(a, c) - m(b, c) for m in (centers_apart, gap)]
        if a.label == b.label or min(map(abs, first)) < 1.5 * CLEAR_OF or first[0] * first[1] < 0:
            continue
        near = a if first[0] < 0 else b
        if room.rng.random() < 0.5:
            yield asked(room, "nearer", "label", room.word(say.NEARER, a=a, b=b, c=c), near.label, **named(a, b, c))
        else:
            yield asked(
                room, "nearer", "yesno", room.word(say.NEARER_IS, a=a, b=b, c=c), yes_no(near is a), **named(a, b, c)
            )

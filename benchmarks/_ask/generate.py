"""Generates questions about a room from its true table, with exact answers and only where the answer is clear.

Every kind of question has a function that yields all questions of its kind with a clear margin; `questions` draws
among them so that all kinds have their share. Margins stand at the top.
"""

from __future__ import annotations

import itertools
import zlib
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from ...gaussians.color import BASIC
from ...gaussians.world import kinds
from ...gaussians.world.words import is_plural, plural
from . import sentences as say
from .question import Question
from .truth import (
    FLAT,
    Table,
    Thing,
    along_way,
    bearing,
    centers_apart,
    connected,
    fits_turned,
    gap,
    largest_fit,
    outside,
    plan_gap,
    regions,
    shared,
)

TALLER = 0.15  # relative and in metres: by which the taller of two is taller
BIGGER = 1.6  # factor of volume; neither height nor footprint may say the reverse
LEAST = 0.25  # metres: the smallest side or distance that is asked for
CLEAR_OF = 0.3  # metres, and as a share: by which the nearest is nearer than the next, by gap and by centre
ASIDE = 0.5  # metres to a side, at least
TILT = 1.5  # and as a multiple of the offset along the other axis
NEXT_TO, NOT_NEXT_TO = 0.15, 1.6  # metres of gap
UNDER = 0.75  # share of the smaller footprint
ON_LINE = 0.12  # share of the way between two things, aside of it, up to which a thing is between them
OFF_LINE = 0.8  # from which it is not
FIT = 0.15  # metres by which something fits, or does not, on each of its sides
BODY = (0.2, 0.35)  # metres, radius: no way for the first, a way for the second
LOW = 0.4  # metres: what one trips over is no higher
ALONG = 0.9  # cosine from which a viewer looks along a wall
HEADROOM = 2.0  # metres: what begins above it is in nobody's way
PER_KIND = 12  # questions of a kind that are drawn from in one room
_NUMBERS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve")
_UNSEEN_FRONT = frozenset(("rug", "curtain"))
_SEATS = ("sofa", "armchair", "chair", "office chair", "loveseat", "rocking chair", "rattan chair", "gaming chair")


@dataclass
class Room:
    """A table with the names of its things and a source of chance.

    Attributes:
        table: the truth.
        vocabulary: names of kinds from which absent ones are drawn.
        rng: the only source of chance.
    """

    table: Table
    vocabulary: Sequence[str]
    rng: np.random.Generator
    names: dict[int, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for thing in self.table.things:
            if name := self._name(thing):
                self.names[thing.id] = name

    def _name(self, thing: Thing) -> str:
        """A phrase that means this thing and no other: its label, or its colour and label; "" if neither does.

        Labels without a singular ("books") are left out, as the wordings are for one thing.
        """
        if is_many(thing.label):
            return ""
        rivals = [t for t in self.table.things if t.id != thing.id and t.label in covered(thing.label)]
        if not rivals:
            return thing.label
        alike = all(t.label == thing.label for t in rivals)
        if thing.color and alike and not any(thing.color in t.shades for t in rivals):
            return f"{thing.color} {thing.label}"
        return ""

    @property
    def named(self) -> list[Thing]:
        """The things that a phrase means, in random order."""
        things = [t for t in self.table.things if t.id in self.names]
        return [things[i] for i in self.rng.permutation(len(things))]

    @property
    def standing(self) -> list[Thing]:
        """Of these the ones that stand on the floor and are no rugs."""
        return [t for t in self.named if self.table.on_floor(t) and t.size[2] > FLAT]

    def pairs(self, things: Sequence[Thing] | None = None) -> Iterator[tuple[Thing, Thing]]:
        """Pairs of different things in random order, both ways round at random."""
        things = self.named if things is None else things
        pairs = list(itertools.permutations(things, 2))
        for i in self.rng.permutation(len(pairs)):
            yield pairs[int(i)]

    def triples(self, things: Sequence[Thing]) -> Iterator[tuple[Thing, Thing, Thing]]:
        """Some triples of different things."""
        if len(things) < 3:
            return
        for _ in range(300):
            a, b, c = (things[int(i)] for i in self.rng.choice(len(things), 3, replace=False))
            yield a, b, c

    def word(self, wordings: Sequence[str], **values: object) -> str:
        """One of the wordings, filled: things as "the sofa", `A` at the start of a sentence, `a_one` as "a sofa"."""
        text = wordings[int(self.rng.integers(len(wordings)))]
        filled: dict[str, object] = {}
        for key, value in values.items():
            if isinstance(value, Thing):
                name = self.names[value.id]
                filled |= {key: f"the {name}", f"{key}_bare": name, f"{key}_one": one(name), key.upper(): f"The {name}"}
            else:
                filled[key] = value
        return text.format(**filled)


@cache
def covered(label: str) -> frozenset[str]:
    """The kinds that a label may be used for: its own, kinds that go by its name, members of its family, and kinds
    whose name ends with it."""
    table = kinds.table()
    own = table.kinds.get(label)
    found = {label, *table.families.get(label, ())}
    for kind in table.kinds.values():
        ends = kind.name.split()[-1] == label
        if ends or label in kind.alike or kind.like == label or label in kind.names:
            found.add(kind.name)
    if own is not None:
        found |= {*own.alike, *([own.like] if own.like else [])}
    return frozenset(found)


def one(name: str) -> str:
    """A noun with "a" or "an"; of plurals "any"."""
    if is_many(name):
        return f"any {name}"
    return f"{'an' if name[0] in 'aeiou' else 'a'} {name}"


def is_many(name: str) -> bool:
    """Whether a label is a plural or a mass noun, so that it is not counted."""
    return plural(name) == name or is_plural(name)


Made = Iterator[Question]


def _q(room: Room, kind: str, type: str, text: str, *truth: object, **more: object) -> Question:
    return Question(room.table.name, kind, text, type, tuple(truth), **more)  # type: ignore[arg-type]


def _ids(*things: Thing) -> dict[str, object]:
    ids = tuple(t.id for t in things)
    return {"about": ids, "names": ids}


# -- what there is --------------------------------------------------------------------------------------------------


def existence(room: Room) -> Made:
    """Kinds that are there, asked with "is there"."""
    labels = sorted({t.label for t in room.table.things})
    for label in (labels[i] for i in room.rng.permutation(len(labels))):
        ids = tuple(t.id for t in room.table.things if t.label == label)
        many = label if is_many(label) else plural(label)
        text = room.word(say.EXISTENCE, one=one(label), many=many)
        yield _q(room, "existence", "yesno", text, "yes", about=ids, names=ids)


def absences(room: Room) -> Iterator[str]:
    """Kinds that are not there, nor anything that one may call so, nor anything with the same head noun."""
    labels = {t.label for t in room.table.things}
    heads = {label.split()[-1] for label in labels}
    for i in room.rng.permutation(len(room.vocabulary)):
        name = room.vocabulary[int(i)]
        rivals = covered(name) & labels or any(name in covered(label) for label in labels)
        if not (is_many(name) or rivals or name.split()[-1] in heads):
            yield name


def absent(room: Room) -> Made:
    """Questions about what is not there, of all kinds."""
    things = room.named
    if not things:
        return
    for name, thing in zip(absences(room), itertools.cycle(things), strict=False):
        text = room.word(say.ABSENT, absent=name, absent_one=one(name), absent_many=plural(name), a=thing)
        yield _q(room, "absent", "none", text, name, expect="absent", names=(thing.id,))


def undecidable(room: Room) -> Made:
    """Questions that nothing in the scene answers."""
    things = room.named
    order = room.rng.permutation(len(say.UNDECIDABLE))
    for i, thing in zip(order, itertools.cycle(things), strict=False):
        yield _q(room, "undecidable", "none", room.word((say.UNDECIDABLE[int(i)],), a=thing), expect="undecidable")


def several(room: Room) -> Made:
    """Questions about one of several alike things, without saying which."""
    number = Counter(t.label for t in room.table.things)
    for label, count in number.items():
        alike = [t for t in room.table.things if t.label == label]
        shades = {t.color for t in alike}
        heights = [t.size[2] for t in alike]
        others = [t for t in room.named if t.label not in covered(label)]
        if count < 2 or is_many(label) or not others:
            continue
        wordings = [say.SEVERAL[0]] if len(shades) > 1 and "" not in shades else []
        ways = [centers_apart(t, others[0]) for t in alike]
        wordings += [say.SEVERAL[1]] if max(ways) - min(ways) > 4 * CLEAR_OF else []
        wordings += [say.SEVERAL[2]] if max(heights) > (1 + 2 * TALLER) * min(heights) else []
        if not wordings:
            continue
        text = room.word(wordings, bare=label, a=others[0])
        yield _q(room, "several", "none", text, expect="several", about=tuple(t.id for t in alike))


def countable(room: Room) -> Iterator[tuple[str, list[Thing]]]:
    """Labels that mean nothing else in the room, with their things, in random order."""
    labels = sorted({t.label for t in room.table.things})
    for label in (labels[i] for i in room.rng.permutation(len(labels))):
        if is_many(label) or any(t.label != label and t.label in covered(label) for t in room.table.things):
            continue
        yield label, [t for t in room.table.things if t.label == label]


def count(room: Room) -> Made:
    """How many of a kind; what is there more than once comes first."""
    found = sorted(countable(room), key=lambda pair: -min(len(pair[1]), 2))
    for label, things in found:
        ids = tuple(t.id for t in things)
        text = room.word(say.COUNT, many=plural(label))
        yield _q(room, "count", "number", text, float(len(things)), about=ids, names=ids)
        shades = {t.color for t in things}
        for color in sorted(shades):
            own = [t for t in things if t.color == color]
            if len(shades) < 2 or "" in shades or any(color in t.shades for t in things if t.color != color):
                continue
            text = room.word(say.COUNT_COLOUR, many=plural(label), colour=color)
            yield _q(room, "count", "number", text, float(len(own)), about=ids, names=ids)


def count_is(room: Room) -> Made:
    """Yes or no: whether there are so many."""
    for label, things in countable(room):
        have = len(things)
        ids = tuple(t.id for t in things)
        if have + 2 >= len(_NUMBERS) or (have < 2 and room.rng.random() < 0.6):
            continue
        said = max(2, have + int(room.rng.choice([-1, 0, 0, 1, 2])))
        wording = say.COUNT_IS[int(room.rng.integers(len(say.COUNT_IS)))]
        less = max(1, have + int(room.rng.choice([-1, 0, 1])))
        yes = have > less if "{less}" in wording else have == said
        if "exactly" not in wording and "{less}" not in wording and have > said:
            continue  # "are there two" where there are three is true to some
        text = wording.format(n=_NUMBERS[said], many=plural(label), less=_NUMBERS[less])
        yield _q(room, "count_is", "yesno", text, "yes" if yes else "no", about=ids, names=ids)


def colour(room: Room) -> Made:
    """The colour of a thing, where its paint is clear."""
    for thing in room.named:
        if thing.color and thing.color not in room.names[thing.id].split():
            yield _q(room, "colour", "label", room.word(say.COLOUR, a=thing), thing.color, **_ids(thing))


def colour_is(room: Room) -> Made:
    """Yes or no: whether it has a colour; wrong ones are far from all of its shades."""
    near = {"gray": ("black", "white", "beige"), "beige": ("white", "brown", "gray", "yellow", "orange")}
    for thing in room.named:
        if not thing.color or thing.color in room.names[thing.id].split():
            continue
        taken = {*thing.shades, *(n for s in thing.shades for n in near.get(s, ()))}
        taken |= {c for c, others in near.items() if thing.shades & set(others)}
        others = sorted(set(BASIC) - taken - {"teal", "pink", "orange"})
        if not others:
            continue
        yes = room.rng.random() < 0.5
        said = thing.color if yes else str(room.rng.choice(others))
        text = room.word(say.COLOUR_IS, a=thing, colour=said)
        yield _q(room, "colour_is", "yesno", text, "yes" if yes else "no", **_ids(thing))


# -- size and distance ----------------------------------------------------------------------------------------------


def size(room: Room) -> Made:
    """Height, length, and of things with a front their width."""
    for thing in room.named:
        width, depth, height = thing.size
        if height >= LEAST:
            yield _q(room, "size", "metres", room.word(say.HEIGHT, a=thing), height, **_ids(thing))
        longer, shorter = max(width, depth), min(width, depth)
        if longer >= 1.0 and longer > 1.4 * shorter and thing.support != "wall" and height < longer:
            yield _q(room, "size", "metres", room.word(say.LENGTH, a=thing), longer, **_ids(thing))
        kind = kinds.of(thing.label)
        if kind is not None and kind.front and width >= 2 * LEAST and thing.label not in _UNSEEN_FRONT:
            yield _q(room, "size", "metres", room.word(say.WIDTH, a=thing), width, **_ids(thing))


def compare(room: Room) -> Made:
    """Which of two is taller or bigger."""
    for a, b in room.pairs():
        if (taller := _taller(a, b)) is not None:
            yield _q(room, "compare", "label", room.word(say.TALLER, a=a, b=b), taller.label, **_ids(a, b))
        if (bigger := _bigger(a, b)) is not None:
            yield _q(room, "compare", "label", room.word(say.BIGGER, a=a, b=b), bigger.label, **_ids(a, b))


def compare_is(room: Room) -> Made:
    """Yes or no: whether one is taller, bigger or smaller than the other."""
    for a, b in room.pairs():
        if (taller := _taller(a, b)) is not None:
            yield _q(room, "compare_is", "yesno", room.word(say.TALLER_IS, a=a, b=b), _yes(taller is a), **_ids(a, b))
        if (bigger := _bigger(a, b)) is not None:
            text = room.word(say.BIGGER_IS, a=a, b=b)
            yield _q(room, "compare_is", "yesno", text, _yes((bigger is a) != ("smaller" in text)), **_ids(a, b))


def _yes(holds: bool) -> str:
    return "yes" if holds else "no"


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
        yield _q(room, "distance", "metres", room.word(say.CENTERS, a=a, b=b), far, **_ids(a, b))
        if free >= LEAST:
            yield _q(room, "distance", "metres", room.word(say.GAP, a=a, b=b), free, **_ids(a, b))
            yield _q(room, "distance", "metres", room.word(say.APART, a=a, b=b), far, free, **_ids(a, b))


def distance_is(room: Room) -> Made:
    """Yes or no: whether two things are farther apart than a length; clear for both distances."""
    for a, b in room.pairs(room.standing):
        far, free = centers_apart(a, b), gap(a, b)
        if free < LEAST:
            continue
        for said, yes in ((round(0.6 * free, 1), True), (round(1.6 * far, 1), False)):
            if said >= 0.3 and room.rng.random() < 0.5:
                text = room.word(say.FARTHER_THAN, a=a, b=b, d=f"{said:g}")
                yield _q(room, "distance_is", "yesno", text, _yes(yes), **_ids(a, b))


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
            yield _q(room, "nearest", "label", room.word(say.NEAREST, a=thing), near.label,
                     about=(thing.id, near.id), names=(thing.id,))  # fmt: skip
        if far is not None and far.label != thing.label:
            yield _q(room, "farthest", "label", room.word(say.FARTHEST, a=thing), far.label,
                     about=(thing.id, far.id), names=(thing.id,))  # fmt: skip


def nearer(room: Room) -> Made:
    """Which of two is nearer to a third, by gap and by centre."""
    for a, b, c in room.triples(room.named):
        first = [m(a, c) - m(b, c) for m in (centers_apart, gap)]
        if a.label == b.label or min(map(abs, first)) < 1.5 * CLEAR_OF or first[0] * first[1] < 0:
            continue
        near = a if first[0] < 0 else b
        if room.rng.random() < 0.5:
            yield _q(room, "nearer", "label", room.word(say.NEARER, a=a, b=b, c=c), near.label, **_ids(a, b, c))
        else:
            yield _q(room, "nearer", "yesno", room.word(say.NEARER_IS, a=a, b=b, c=c), _yes(near is a), **_ids(a, b, c))


# -- sides ----------------------------------------------------------------------------------------------------------


def _sides(right: float, ahead: float) -> tuple[str, str]:
    """ "left" or "right", and "front" or "behind", of an offset; "" where it is not clear."""
    across = "right" if right > 0 else "left"
    along = "front" if ahead > 0 else "behind"
    return (
        across if abs(right) >= ASIDE and abs(right) >= TILT * abs(ahead) else "",
        along if abs(ahead) >= ASIDE and abs(ahead) >= TILT * abs(right) else "",
    )


def viewer_side(room: Room) -> Made:
    """Left, right, in front and behind of the viewer: clear in the levelled axes and as a line of sight."""
    eye, forward = np.array(room.table.eye), np.array(room.table.forward)
    for a, b in room.pairs():
        offset = a.xy - b.xy
        across, along = _sides(float(offset @ room.table.right), float(offset @ forward))
        sight = [bearing(t.xy, eye, forward) for t in (a, b)]
        if min(s[1] for s in sight) < 0.3:
            continue  # behind the viewer's back
        if across:
            angles = [np.degrees(np.arctan2(*s)) for s in sight]
            if (angles[0] > angles[1] + 3) != (across == "right") or abs(angles[0] - angles[1]) < 3:
                continue
            yield from _side_forms(room, "viewer_side", (say.SIDE, say.SIDE_IS), across, (a, b), ("left", "right"))
        if along:
            # Toward the viewer is in front.
            side = "behind" if along == "front" else "front"
            words = ("in front of", "behind")
            yield from _side_forms(room, "viewer_side", (say.DEPTH, say.DEPTH_IS), side, (a, b), words)


def _side_forms(
    room: Room, kind: str, wordings: tuple[Sequence[str], Sequence[str]], side: str, things: tuple[Thing, ...],
    words: tuple[str, str],
) -> Made:  # fmt: skip
    """One question of a side: which, or yes or no."""
    values = dict(zip("abc", things, strict=False))
    viewer = kind == "viewer_side"
    if room.rng.random() < 0.5:
        yield _q(room, kind, "label", room.word(wordings[0], **values), side, side=viewer, **_ids(*things))
        return
    said = words[int(room.rng.integers(2))]
    holds = said.split()[-1] == side or (said == "in front of" and side == "front")
    yield _q(
        room, kind, "yesno", room.word(wordings[1], **values, side=said), _yes(holds), side=viewer, **_ids(*things)
    )


def object_side(room: Room) -> Made:
    """Left and right, before and behind, in the frame of a thing with a front."""
    for b in room.named:
        kind = kinds.of(b.label)
        if kind is None or not kind.front or not room.table.on_floor(b):
            continue
        for a in room.named:
            if a.id == b.id:
                continue
            across, along = _sides(*bearing(a.xy, b.xy, b.front))
            if across and plan_gap(a, b) > 0.05:
                text = room.word(say.OWN_SIDE, a=a, b=b)
                yield _q(room, "object_side", "label", text, across, **_ids(b, a))
            if along and plan_gap(a, b) > 0.05:
                text = room.word(say.OWN_FRONT, a=a, b=b)
                yield _q(room, "object_side", "label", text, along, **_ids(b, a))


def seated(room: Room) -> Made:
    """Left and right of someone who sits on a seat and looks where it faces."""
    for b in room.named:
        if b.label not in _SEATS or not room.table.on_floor(b):
            continue
        for a in room.named:
            across, _ = _sides(*bearing(a.xy, b.xy, b.front))
            if a.id != b.id and across and plan_gap(a, b) > 0.05:
                yield from _side_forms(room, "seated", (say.SEATED, say.SEATED_IS), across, (a, b), ("left", "right"))


def facing(room: Room) -> Made:
    """Left, right and behind of someone who stands at one thing and faces another."""
    standing = room.standing
    for a, b, c in room.triples(standing):
        way = c.xy - b.xy
        far = float(np.linalg.norm(way))
        if far < 1.0:
            continue
        spots = (b.xy, outside(b, c))  # people stand at a thing on its near side, or where it is
        seen = {_sides(*bearing(a.xy, spot, way / far)) for spot in spots}
        if len(seen) > 1:
            continue
        across, along = next(iter(seen))
        if across:
            yield _q(room, "facing", "label", room.word(say.FACING, a=a, b=b, c=c), across, **_ids(b, c, a))
        elif along:
            text = room.word(say.FACING_BEHIND, a=a, b=b, c=c)
            yield _q(room, "facing", "yesno", text, _yes(along == "behind"), **_ids(b, c, a))


# -- on, under, beside ----------------------------------------------------------------------------------------------


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
            yield _q(room, "on", "list", text, tuple(t.label for t in held), about=ids, names=(thing.id,))


def on_is(room: Room) -> Made:
    """Yes or no: whether something, or anything, stands on a thing; what something stands on."""
    tops = list(_tops(room))
    for thing, held, on_top in tops:
        small = [t for t in room.named if isinstance(t.support, int) or t.size[2] < 0.3]
        for other in held:
            if other.id in room.names:
                yield _q(room, "on_is", "yesno", room.word(say.ON_IS, a=other, b=thing), "yes", **_ids(thing, other))
                if on_top:
                    yield _q(room, "on_is", "label", room.word(say.CARRIER, a=other), thing.label,
                             about=(other.id, thing.id), names=(other.id,))  # fmt: skip
        for other in small:
            alone = not any(t.label == other.label for t in held)
            if alone and other.id != thing.id and plan_gap(other, thing) > 0.3:
                yield _q(room, "on_is", "yesno", room.word(say.ON_IS, a=other, b=thing), "no", **_ids(thing, other))
                break
        near = [
            t for t in room.table.things if t.id != thing.id and plan_gap(t, thing) < 0.02 and t.low > thing.high - 0.1
        ]
        if len(near) == len(held) and on_top:
            text = room.word(say.ANY_ON, a=thing)
            holds = bool(held) != ("empty" in text)
            yield _q(room, "on_is", "yesno", text, _yes(holds), about=(thing.id, *(t.id for t in held)),
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
            yield _q(room, "under_is", "yesno", room.word(say.UNDER_IS, a=a, b=b), "yes", **_ids(b, a))
        elif plan_gap(a, b) > 0.4:
            yield _q(room, "under_is", "yesno", room.word(say.UNDER_IS, a=a, b=b), "no", **_ids(b, a))


def next_is(room: Room) -> Made:
    """Yes or no: whether two things on the floor stand next to each other."""
    standing = room.standing
    for a, b in room.pairs(standing):
        near = plan_gap(a, b)
        if 0 < near <= NEXT_TO:
            yield _q(room, "next_is", "yesno", room.word(say.NEXT_IS, a=a, b=b), "yes", **_ids(a, b))
        elif near >= NOT_NEXT_TO + 0.3 * (max(a.size[:2]) + max(b.size[:2])) and room.rng.random() < 0.15:
            yield _q(room, "next_is", "yesno", room.word(say.NEXT_IS, a=a, b=b), "no", **_ids(a, b))


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
            yield _q(room, "between_is", "yesno", room.word(say.BETWEEN_IS, a=a, b=b, c=c), "yes", **_ids(a, b, c))
        elif (t < -0.2 or t > 1.2 or aside > OFF_LINE) and room.rng.random() < 0.1:
            yield _q(room, "between_is", "yesno", room.word(say.BETWEEN_IS, a=a, b=b, c=c), "no", **_ids(a, b, c))


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
            yield _q(room, "inside", "list", text, tuple(t.label for t in held), about=ids, names=(thing.id,))
            for other in held:
                if other.id in room.names:
                    text = room.word(say.INSIDE_IS, a=other, b=thing)
                    yield _q(room, "inside", "yesno", text, "yes", **_ids(thing, other))
        small = [t for t in room.named if plan_gap(t, thing) > 0.4 and t.volume < 0.2 * thing.volume]
        small = [t for t in small if t.support not in ("wall", "ceiling")]
        if small and thing.label not in {t.label for t in held}:
            other = small[0]
            if not any(t.label == other.label for t in held):
                text = room.word(say.INSIDE_IS, a=other, b=thing)
                yield _q(room, "inside", "yesno", text, "no", **_ids(thing, other))


# -- lists and superlatives -----------------------------------------------------------------------------------------


def lists(room: Room) -> Made:
    """All things, those of a colour, and those on the walls."""
    things = room.table.things
    every = tuple(t.label for t in things)
    ids = tuple(t.id for t in things)
    bare = tuple(t.label for t in things if t.label not in ("door", "window"))
    yield _q(room, "list", "list", room.word(say.ALL), every, bare, about=ids)
    hung = [t for t in things if t.support == "wall"]
    loose = [t for t in hung if t.label not in ("door", "window", "radiator")]
    if loose:
        text = room.word(say.ON_WALL)
        no_cloth = tuple(t.label for t in loose if t.label != "curtain") or tuple(t.label for t in loose)
        truths = (tuple(t.label for t in hung), tuple(t.label for t in loose), no_cloth)
        yield _q(room, "list", "list", text, *truths, about=tuple(t.id for t in hung))
    for color in sorted({t.color for t in things if t.color}):
        own = [t for t in things if t.color == color]
        maybe = [t for t in things if color in t.shades and t.color != color]
        if not maybe and len(own) <= 6:
            text = room.word(say.OF_COLOUR, colour=color)
            yield _q(room, "list", "list", text, tuple(t.label for t in own), about=tuple(t.id for t in own))


def superlative(room: Room) -> Made:
    """The tallest thing on the floor, the bulkiest and the smallest thing."""
    floor = sorted((t for t in room.table.things if room.table.on_floor(t)), key=lambda t: -t.size[2])
    if len(floor) > 2 and floor[0].size[2] > 1.08 * floor[1].size[2]:
        # Some say that a door stands on the floor.
        walls = [t for t in room.table.things if t.support == "wall" and t.size[2] > 0.9 * floor[0].size[2]]
        if all(t.label in ("door", "window") for t in walls):
            text = room.word(say.TALLEST_BUT if walls else say.TALLEST)
            yield _q(room, "superlative", "label", text, floor[0].label, about=(floor[0].id, floor[1].id))
    solid = [t for t in room.table.things if t.support not in ("wall", "ceiling")]
    ranked = sorted(solid, key=lambda t: -t.volume)
    widest = max(room.table.things, key=lambda t: max(t.size))
    if len(ranked) > 2 and ranked[0].volume > 1.4 * ranked[1].volume and widest.volume <= ranked[0].volume:
        first = ranked[0]
        yield _q(room, "superlative", "label", room.word(say.BULKIEST), first.label, about=(first.id, ranked[1].id))
    every = sorted(room.table.things, key=lambda t: t.volume)
    if len(every) > 2 and every[1].volume > 1.6 * every[0].volume and max(every[0].size) < max(every[1].size):
        first = every[0]
        yield _q(room, "superlative", "label", room.word(say.SMALLEST), first.label, about=(first.id, every[1].id))


# -- the room, its floor and ways -----------------------------------------------------------------------------------


def room_size(room: Room) -> Made:
    """Height and floor area; width and depth where the viewer looks along one of the walls."""
    width, depth, height = room.table.size
    yield _q(room, "room_size", "metres", room.word(say.ROOM_HEIGHT), height)
    yield _q(room, "room_size", "number", room.word(say.ROOM_AREA), width * depth)
    along_x, along_y = np.abs(room.table.forward)
    if max(along_x, along_y) >= ALONG:
        across, ahead = (width, depth) if along_y > along_x else (depth, width)
        yield _q(room, "room_size", "metres", room.word(say.ROOM_WIDTH), across, side=True)
        yield _q(room, "room_size", "metres", room.word(say.ROOM_DEPTH), ahead, side=True)


def free_floor(room: Room) -> Made:
    """Square metres of floor under no thing that stands on it, with rugs taken as free or as covered."""
    standing = [t for t in room.table.things if room.table.on_floor(t)]
    cell = room.table.size[0] * room.table.size[1] / room.table.grid[..., 0].size
    free = [
        float((~room.table.taken(t for t in standing if rugs or t.size[2] > FLAT)).sum()) * cell
        for rugs in (False, True)
    ]
    if free[1] > 2.0:
        yield _q(room, "free_floor", "number", room.word(say.FREE), *free)


def fits(room: Room) -> Made:
    """Whether a rectangle fits on the free floor, or between two things."""
    low = [t for t in room.table.things if t.low < HEADROOM]
    floor = [t for t in room.table.things if room.table.on_floor(t) and t.size[2] > FLAT]
    before_doors = [_before(t) for t in room.table.things if kinds.is_door(t.label)]
    free = ~room.table.taken([*low, *before_doors])
    for _ in range(40):
        w, d = (round(float(v), 1) for v in room.rng.uniform(0.5, 3.2, 2))
        if max(w, d) > max(room.table.size[:2]) or w < d:
            continue
        text = room.word(say.FITS, w=f"{w:g}", d=f"{d:g}")
        if largest_fit(free, w + FIT, d + FIT):
            yield _q(room, "fits", "yesno", text, "yes")
        elif min(w, d) > 0.6 and not fits_turned(room.table, floor, w - FIT, d - FIT):
            yield _q(room, "fits", "yesno", text, "no")


def _before(door: Thing) -> Thing:
    """The floor that a door and those who come in need, as a thing."""
    reach = (door.size[0], door.size[2] / 2, 0.1)
    x, y = door.xy + door.front * door.size[0] / 2
    size = (reach[0], door.size[0] + 0.2, 0.1)
    return Thing(-1, "", "", frozenset(), size, (float(x), float(y), 0.05), door.yaw, "floor")


def fits_between(room: Room) -> Made:
    """Whether something of a width goes between two things that stand side by side."""
    for a, b in room.pairs(room.standing):
        free = plan_gap(a, b)
        others = [t for t in room.table.things if t.id not in (a.id, b.id) and t.low < HEADROOM and t.size[2] > FLAT]
        if not 0.4 <= free <= 2.5 or any(along_way(t, a.xy, b.xy, 0.4) for t in others):
            continue
        yes = room.rng.random() < 0.5
        said = round(100 * (free * 0.7 if yes else free * 1.4), -1)
        text = room.word(say.FITS_BETWEEN, a=a, b=b, w=f"{said:.0f}")
        yield _q(room, "fits_between", "yesno", text, _yes(yes), **_ids(a, b))


def hazards(room: Room) -> Made:
    """What low thing lies on the straight way between two others, and whether anything does."""
    ground = [t for t in room.table.things if room.table.on_floor(t)]
    for a, b in itertools.islice(room.pairs(room.standing), 50):
        start, end = outside(a, b), outside(b, a)
        if float(np.linalg.norm(end - start)) < 1.2:
            continue
        others = [t for t in ground if t.id not in (a.id, b.id)]
        hit = [t for t in others if along_way(t, start, end, 0.05) > 0.1]
        near = [t for t in others if along_way(t, start, end, 0.5) > 0]
        flat = [t for t in near if t.size[2] <= FLAT]
        solid_hit, solid_near = ([t for t in found if t.size[2] > FLAT] for found in (hit, near))
        if len(solid_hit) != len(solid_near):
            continue
        if len(solid_hit) == 1 and solid_hit[0].size[2] <= LOW:
            low = solid_hit[0]
            truths = [(low.label,), (low.label, *(t.label for t in flat))]
            about = (a.id, b.id, low.id)
            yield _q(room, "hazard", "list", room.word(say.TRIP, a=a, b=b), *truths, about=about, names=about[:2])
        if not flat and (solid_hit or room.rng.random() < 0.3):
            ids = (a.id, b.id, *[t.id for t in solid_hit])
            text = room.word(say.WAY_CLEAR, a=a, b=b)
            yield _q(room, "hazard", "yesno", text, _yes(bool(solid_hit)), about=ids, names=ids[:2])


def routes(room: Room) -> Made:
    """Whether one can walk from one thing to another; few rooms are blocked, and those come first."""
    low = [t for t in room.table.things if t.low < HEADROOM and t.high > FLAT and t.support != "ceiling"]
    tall = [t for t in low if room.table.on_floor(t) and t.size[2] > LOW]
    ends = [t for t in room.named if (room.table.on_floor(t) or kinds.is_door(t.label)) and t.size[2] > FLAT]
    wide = regions(room.table, low, BODY[1])
    found: list[Question] = []
    for a, b in itertools.islice(room.pairs(ends), 2 * PER_KIND):
        if plan_gap(a, b) < 1.0:
            continue
        text = room.word(say.ROUTE, a=a, b=b)
        if connected(room.table, wide, a, b, BODY[1] + 0.25):
            found.append(_q(room, "route", "yesno", text, "yes", **_ids(a, b)))
            continue
        narrow = regions(room.table, [t for t in tall if t.id not in (a.id, b.id)], BODY[0])
        if not connected(room.table, narrow, a, b, BODY[0] + 0.5):
            found.insert(0, _q(room, "route", "yesno", text, "no", **_ids(a, b)))
    yield from found


MAKERS: tuple[Callable[[Room], Made], ...] = (
    existence, count, count_is, colour, colour_is, size, compare, compare_is, distance, distance_is, nearest, nearer,
    viewer_side, object_side, seated, facing, on, on_is, under_is, next_is, between_is, inside, lists, superlative,
    room_size, free_floor, fits, fits_between, hazards, routes, absent, undecidable, several,
)  # fmt: skip
WEIGHTS = {"absent": 4, "undecidable": 4, "distance": 2, "count": 2, "viewer_side": 2, "colour": 2}  # others 1


def pool(table: Table, vocabulary: Sequence[str]) -> dict[str, list[Question]]:
    """Questions of every kind that the room has, at most `PER_KIND` of each; the same table gives the same ones."""
    room = Room(table, sorted(vocabulary), np.random.default_rng([zlib.crc32(b"ask"), table.seed]))
    found: dict[str, list[Question]] = {}
    for make in MAKERS:
        seen = set[str]()
        for question in itertools.islice(make(room), 3 * PER_KIND):
            if question.text not in seen and len(found.setdefault(question.kind, [])) < PER_KIND:
                seen.add(question.text)
                found[question.kind].append(question)
    return {kind: own for kind, own in found.items() if own}


def questions(tables: Sequence[Table], vocabulary: Iterable[str], count: int) -> list[Question]:
    """At most `count` questions over rooms: of each kind as many as its weight says, spread over the rooms evenly.

    A room gets at most `count` over the number of rooms, rounded up.
    """
    pools = [pool(t, tuple(vocabulary)) for t in tables]
    kinds_left = sorted({kind for p in pools for kind in p})
    taken = [list[Question]() for _ in tables]
    share = -(-count // len(tables))
    drawn = Counter[str]()
    while kinds_left and drawn.total() < count:
        kind = min(kinds_left, key=lambda k: (drawn[k] / WEIGHTS.get(k, 1), k))
        rows = [i for i, p in enumerate(pools) if p.get(kind) and len(taken[i]) < share]
        if not rows:
            kinds_left.remove(kind)
            continue
        row = min(rows, key=lambda i: (sum(q.kind == kind for q in taken[i]), len(taken[i]), i))
        taken[row].append(pools[row][kind].pop(0))
        drawn[kind] += 1
    return [q for own in taken for q in own]

"""Questions about what there is: existence, absence, numbers, colours, lists and superlatives."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterator

from ....gaussians.color import BASIC
from ....gaussians.world.words import plural
from .. import sentences as say
from ..naming import Made, Room, asked, covered, is_many, named, one
from ..truth import Thing, centers_apart
from .lengths import CLEAR_OF, TALLER

NUMBERS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve")


def existence(room: Room) -> Made:
    """Kinds that are there, asked with "is there"."""
    labels = sorted({t.label for t in room.table.things})
    for label in (labels[i] for i in room.rng.permutation(len(labels))):
        ids = tuple(t.id for t in room.table.things if t.label == label)
        many = label if is_many(label) else plural(label)
        text = room.word(say.EXISTENCE, one=one(label), many=many)
        yield asked(room, "existence", "yesno", text, "yes", about=ids, names=ids)


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
        yield asked(room, "absent", "none", text, name, expect="absent", names=(thing.id,))


def undecidable(room: Room) -> Made:
    """Questions that nothing in the scene answers."""
    things = room.named
    wordings = room.wordings(say.UNDECIDABLE)
    order = room.rng.permutation(len(wordings))
    for i, thing in zip(order, itertools.cycle(things), strict=False):
        yield asked(room, "undecidable", "none", room.word((wordings[int(i)],), a=thing), expect="undecidable")


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
        known = room.wordings(say.SEVERAL)
        wordings = [known[0]] if len(shades) > 1 and "" not in shades else []
        ways = [centers_apart(t, others[0]) for t in alike]
        wordings += [known[1]] if max(ways) - min(ways) > 4 * CLEAR_OF else []
        wordings += [known[2]] if max(heights) > (1 + 2 * TALLER) * min(heights) else []
        if not wordings:
            continue
        text = room.word(wordings, bare=label, a=others[0])
        yield asked(room, "several", "none", text, expect="several", about=tuple(t.id for t in alike))


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
        yield asked(room, "count", "number", text, float(len(things)), about=ids, names=ids)
        shades = {t.color for t in things}
        for color in sorted(shades):
            own = [t for t in things if t.color == color]
            if len(shades) < 2 or "" in shades or any(color in t.shades for t in things if t.color != color):
                continue
            text = room.word(say.COUNT_COLOUR, many=plural(label), colour=color)
            yield asked(room, "count", "number", text, float(len(own)), about=ids, names=ids)


def count_is(room: Room) -> Made:
    """Yes or no: whether there are so many."""
    for label, things in countable(room):
        have = len(things)
        ids = tuple(t.id for t in things)
        if have + 2 >= len(NUMBERS) or (have < 2 and room.rng.random() < 0.6):
            continue
        said = max(2, have + int(room.rng.choice([-1, 0, 0, 1, 2])))
        wordings = room.wordings(say.COUNT_IS)
        wording = wordings[int(room.rng.integers(len(wordings)))]
        less = max(1, have + int(room.rng.choice([-1, 0, 1])))
        yes = have > less if "{less}" in wording else have == said
        if "exactly" not in wording and "{less}" not in wording and have > said:
            continue  # "are there two" where there are three is true to some
        text = wording.format(n=NUMBERS[said], many=plural(label), less=NUMBERS[less])
        yield asked(room, "count_is", "yesno", text, "yes" if yes else "no", about=ids, names=ids)


def colour(room: Room) -> Made:
    """The colour of a thing, where its paint is clear."""
    for thing in room.named:
        if thing.color and thing.color not in room.names[thing.id].split():
            yield asked(room, "colour", "label", room.word(say.COLOUR, a=thing), thing.color, **named(thing))


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
        yield asked(room, "colour_is", "yesno", text, "yes" if yes else "no", **named(thing))


def lists(room: Room) -> Made:
    """All things, those of a colour, and those on the walls."""
    things = room.table.things
    every = tuple(t.label for t in things)
    ids = tuple(t.id for t in things)
    bare = tuple(t.label for t in things if t.label not in ("door", "window"))
    yield asked(room, "list", "list", room.word(say.ALL), every, bare, about=ids)
    hung = [t for t in things if t.support == "wall"]
    loose = [t for t in hung if t.label not in ("door", "window", "radiator")]
    if loose:
        text = room.word(say.ON_WALL)
        no_cloth = tuple(t.label for t in loose if t.label != "curtain") or tuple(t.label for t in loose)
        truths = (tuple(t.label for t in hung), tuple(t.label for t in loose), no_cloth)
        yield asked(room, "list", "list", text, *truths, about=tuple(t.id for t in hung))
    for color in sorted({t.color for t in things if t.color}):
        own = [t for t in things if t.color == color]
        maybe = [t for t in things if color in t.shades and t.color != color]
        if not maybe and len(own) <= 6:
            text = room.word(say.OF_COLOUR, colour=color)
            yield asked(room, "list", "list", text, tuple(t.label for t in own), about=tuple(t.id for t in own))


def superlative(room: Room) -> Made:
    """The tallest thing on the floor, the bulkiest and the smallest thing."""
    floor = sorted((t for t in room.table.things if room.table.on_floor(t)), key=lambda t: -t.size[2])
    if len(floor) > 2 and floor[0].size[2] > 1.08 * floor[1].size[2]:
        # Some say that a door stands on the floor.
        walls = [t for t in room.table.things if t.support == "wall" and t.size[2] > 0.9 * floor[0].size[2]]
        if all(t.label in ("door", "window") for t in walls):
            text = room.word(say.TALLEST_BUT if walls else say.TALLEST)
            yield asked(room, "superlative", "label", text, floor[0].label, about=(floor[0].id, floor[1].id))
    solid = [t for t in room.table.things if t.support not in ("wall", "ceiling")]
    ranked = sorted(solid, key=lambda t: -t.volume)
    widest = max(room.table.things, key=lambda t: max(t.size))
    if len(ranked) > 2 and ranked[0].volume > 1.4 * ranked[1].volume and widest.volume <= ranked[0].volume:
        first = ranked[0]
        yield asked(room, "superlative", "label", room.word(say.BULKIEST), first.label, about=(first.id, ranked[1].id))
    every = sorted(room.table.things, key=lambda t: t.volume)
    if len(every) > 2 and every[1].volume > 1.6 * every[0].volume and max(every[0].size) < max(every[1].size):
        first = every[0]
        yield asked(room, "superlative", "label", room.word(say.SMALLEST), first.label, about=(first.id, every[1].id))

"""Layout problems of twelve kinds of rooms, with wishes that are known to be possible together.

Hard relations are read from a witness: a random arrangement of the things without overlaps. The solver that is measured
has no part in it, so the problems do not favour it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ..planners.layout import Item, Problem, Stand, Wish

Clear = tuple[float, float, float, float]


class Thing(NamedTuple):
    """A kind of thing: width, depth and height in metres, what carries it, its habits, and the space its use takes."""

    size: tuple[float, float, float]
    support: str = "floor"
    backed: bool = False
    clear: Clear = (0.0, 0.0, 0.0, 0.0)
    habit: str = ""  # "relation label", "relation" alone for those of the room


THINGS = {
    "sofa": Thing((2.0, 0.9, 0.8), backed=True, clear=(0.4, 0, 0, 0), habit="facing tv stand"),
    "armchair": Thing((0.85, 0.85, 0.9), habit="facing coffee table"),
    "coffee table": Thing((1.1, 0.6, 0.42), habit="next_to sofa"),
    "tv stand": Thing((1.5, 0.4, 0.5), backed=True),
    "tv": Thing((1.1, 0.15, 0.65), "tv stand"),
    "bookcase": Thing((0.9, 0.3, 1.9), backed=True, clear=(0.6, 0, 0, 0)),
    "rug": Thing((2.0, 1.4, 0.02), habit="under coffee table"),
    "floor lamp": Thing((0.3, 0.3, 1.6), habit="in_corner"),
    "plant": Thing((0.4, 0.4, 1.0), habit="in_corner"),
    "picture": Thing((0.7, 0.03, 0.5), "wall"),
    "bed": Thing((1.6, 2.05, 0.6), backed=True, clear=(0, 0, 0.5, 0.5)),
    "single bed": Thing((0.95, 2.05, 0.6), backed=True, clear=(0, 0, 0, 0.5), habit="in_corner"),
    "nightstand": Thing((0.45, 0.4, 0.5), backed=True, habit="next_to bed"),
    "wardrobe": Thing((1.4, 0.6, 2.0), backed=True, clear=(0.7, 0, 0, 0)),
    "dresser": Thing((1.2, 0.5, 0.8), backed=True, clear=(0.6, 0, 0, 0)),
    "desk": Thing((1.4, 0.7, 0.75), backed=True, habit="at_window"),
    "office chair": Thing((0.6, 0.6, 1.0), habit="around desk"),
    "monitor": Thing((0.6, 0.2, 0.4), "desk"),
    "desk lamp": Thing((0.2, 0.2, 0.45), "desk"),
    "filing cabinet": Thing((0.45, 0.6, 0.7), backed=True, clear=(0.6, 0, 0, 0)),
    "dining table": Thing((1.8, 0.95, 0.75), habit="in_center"),
    "chair": Thing((0.45, 0.5, 0.9), clear=(0, 0.3, 0, 0), habit="around dining table"),
    "sideboard": Thing((1.5, 0.45, 0.85), backed=True, clear=(0.6, 0, 0, 0)),
    "vase": Thing((0.2, 0.2, 0.35), "dining table"),
    "chandelier": Thing((0.7, 0.7, 0.5), "ceiling", habit="above dining table"),
    "fridge": Thing((0.65, 0.65, 1.8), backed=True, clear=(0.7, 0, 0, 0)),
    "stove": Thing((0.6, 0.6, 0.9), backed=True, clear=(0.7, 0, 0, 0)),
    "sink cabinet": Thing((0.9, 0.6, 0.9), backed=True, clear=(0.7, 0, 0, 0), habit="next_to stove"),
    "counter": Thing((2.0, 0.6, 1.0), clear=(0.5, 0.7, 0, 0)),
    "cash register": Thing((0.35, 0.35, 0.3), "counter"),
    "cafe table": Thing((0.7, 0.7, 0.75)),
    "cafe chair": Thing((0.42, 0.45, 0.85), habit="around cafe table"),
    "display case": Thing((1.2, 0.6, 1.3), backed=True, clear=(0.6, 0, 0, 0), habit="next_to counter"),
    "pupil desk": Thing((1.2, 0.5, 0.72)),
    "pupil chair": Thing((0.4, 0.4, 0.8), habit="around pupil desk"),
    "teacher desk": Thing((1.5, 0.7, 0.75), habit="next_to whiteboard"),
    "whiteboard": Thing((2.0, 0.05, 1.2), "wall"),
    "meeting table": Thing((2.4, 1.1, 0.75), habit="in_center"),
    "meeting chair": Thing((0.55, 0.55, 0.95), habit="around meeting table"),
    "screen": Thing((1.4, 0.08, 0.8), "wall"),
    "bathtub": Thing((1.7, 0.75, 0.6), backed=True, clear=(0.6, 0, 0, 0)),
    "toilet": Thing((0.4, 0.65, 0.8), backed=True, clear=(0.5, 0, 0, 0)),
    "washbasin": Thing((0.6, 0.5, 0.85), backed=True, clear=(0.6, 0, 0, 0)),
    "mirror": Thing((0.6, 0.03, 0.8), "wall", habit="above washbasin"),
    "laundry basket": Thing((0.4, 0.4, 0.6)),
    "stool": Thing((0.35, 0.35, 0.45)),
    "treadmill": Thing((0.85, 1.9, 1.4), clear=(0.5, 0, 0, 0)),
    "weight bench": Thing((0.6, 1.3, 0.9), clear=(0.3, 0, 0.3, 0.3)),
    "dumbbell rack": Thing((1.2, 0.5, 0.9), backed=True, clear=(0.8, 0, 0, 0)),
    "mat": Thing((0.7, 1.8, 0.01)),
    "toy chest": Thing((0.8, 0.45, 0.5), backed=True, clear=(0.5, 0, 0, 0)),
    "small table": Thing((0.7, 0.7, 0.5)),
    "small chair": Thing((0.3, 0.3, 0.55), habit="around small table"),
    "play mat": Thing((1.4, 1.4, 0.01), habit="in_center"),
}
# Width and depth of the room from, to; then things with how many there are from, to.
KINDS: dict[str, tuple[tuple[float, float, float, float], dict[str, tuple[int, int]]]] = {
    "living room": (
        (4.5, 6, 4.5, 6),
        {"sofa": (1, 1), "tv stand": (1, 1), "tv": (1, 1), "coffee table": (1, 1), "armchair": (1, 2), "rug": (1, 1),
         "bookcase": (1, 3), "floor lamp": (1, 2), "plant": (1, 3), "picture": (1, 3)},
    ),
    "bedroom": (
        (3.8, 5.5, 4, 5.5),
        {"bed": (1, 1), "nightstand": (2, 2), "wardrobe": (1, 2), "dresser": (1, 1), "armchair": (0, 1),
         "plant": (1, 2), "picture": (2, 4), "floor lamp": (0, 1)},
    ),
    "home office": (
        (3.5, 5, 3.5, 5),
        {"desk": (1, 1), "office chair": (1, 1), "monitor": (1, 2), "desk lamp": (1, 1), "bookcase": (1, 3),
         "filing cabinet": (1, 2), "plant": (1, 2), "picture": (1, 3), "armchair": (0, 1)},
    ),
    "dining room": (
        (4.5, 6, 4.5, 6.5),
        {"dining table": (1, 1), "chair": (4, 6), "sideboard": (1, 2), "vase": (1, 2), "chandelier": (1, 1),
         "plant": (1, 2), "picture": (2, 4)},
    ),
    "kitchen": (
        (4, 5.5, 4, 5.5),
        {"fridge": (1, 1), "stove": (1, 1), "sink cabinet": (1, 1), "dining table": (1, 1), "chair": (2, 4),
         "sideboard": (0, 1), "plant": (1, 2), "picture": (1, 2)},
    ),
    "coffee shop": (
        (7, 9, 7, 9),
        {"counter": (1, 1), "cash register": (1, 1), "display case": (1, 1), "cafe table": (3, 5),
         "cafe chair": (8, 14), "plant": (2, 4), "picture": (1, 3)},
    ),
    "classroom": (
        (7.5, 9, 7.5, 9),
        {"whiteboard": (1, 1), "teacher desk": (1, 1), "pupil desk": (6, 9), "pupil chair": (8, 12),
         "bookcase": (1, 3), "plant": (1, 2)},
    ),
    "meeting room": (
        (5, 7, 5, 7),
        {"meeting table": (1, 1), "meeting chair": (6, 8), "screen": (1, 1), "sideboard": (1, 1), "plant": (1, 3),
         "picture": (1, 2)},
    ),
    "bathroom": (
        (3, 4, 3, 4),
        {"bathtub": (1, 1), "toilet": (1, 1), "washbasin": (1, 2), "mirror": (1, 2), "laundry basket": (1, 1),
         "stool": (1, 1), "plant": (1, 1), "picture": (0, 1)},
    ),
    "gym": (
        (7, 9, 6, 9),
        {"treadmill": (2, 4), "weight bench": (1, 3), "dumbbell rack": (1, 2), "mat": (2, 5), "mirror": (0, 2),
         "plant": (1, 3), "stool": (1, 2), "picture": (1, 2)},
    ),
    "children's room": (
        (4, 5, 4, 5.5),
        {"single bed": (1, 2), "toy chest": (1, 1), "bookcase": (1, 1), "small table": (1, 1), "small chair": (2, 4),
         "play mat": (1, 1), "wardrobe": (1, 1), "picture": (1, 3)},
    ),
    "library": (
        (7, 9, 7, 9),
        {"bookcase": (6, 10), "desk": (1, 1), "office chair": (1, 1), "desk lamp": (1, 1), "cafe table": (1, 3),
         "cafe chair": (4, 8), "armchair": (1, 3), "plant": (1, 3)},
    ),
}  # fmt: skip
_HEIGHT = 2.7
_TRIES = 300
_VIEWED = ("left_of", "right_of", "in_front_of", "behind")
_MIN_COSINE = 0.8  # cosine from which a relation is read from a witness; a relation holds from 0.5


def problem(kind: str, seed: int, stated: float = 0.5) -> Problem:
    """A room of a kind: things with habits, and `stated` hard relations a thing that hold in a witness."""
    rng = np.random.default_rng(seed)
    (w0, w1, d0, d1), things = KINDS[kind]
    size = (round(rng.uniform(w0, w1), 2), round(rng.uniform(d0, d1), 2), _HEIGHT)
    items = [*_openings(size, rng), *_things(things, rng)]
    return Problem(size=size, items=tuple(items), wishes=(*_habits(items), *_relations(size, items, rng, stated)))


def problems(count: int, seed: int) -> Iterator[tuple[str, Problem]]:
    """Kind and problem, the kinds in turn."""
    kinds = sorted(KINDS)
    for k in range(count):
        yield kinds[k % len(kinds)], problem(kinds[k % len(kinds)], seed + k)


def _openings(size: tuple[float, float, float], rng: np.random.Generator) -> list[Item]:
    """A door in the front wall and a window in the back wall."""
    width, depth, _ = size
    x = round(rng.uniform(-width / 2 + 0.6, width / 2 - 0.6), 2)
    door = Stand(position=(x, -depth / 2 + 0.04, 1.05), yaw=180.0)
    window = Stand(position=(round(rng.uniform(-0.5, 0.5), 2), depth / 2 - 0.04, 1.5), yaw=0.0)
    return [
        Item(id="door", label="door", size=(0.9, 0.08, 2.1), support="wall", stand=door),
        Item(id="window", label="window", size=(1.4, 0.08, 1.2), support="wall", stand=window),
    ]


def _things(wanted: dict[str, tuple[int, int]], rng: np.random.Generator) -> Iterator[Item]:
    for label, (least, most) in wanted.items():
        thing = THINGS[label]
        for k in range(int(rng.integers(least, most + 1))):
            width, depth, height = (round(s * rng.uniform(0.92, 1.08), 3) for s in thing.size)
            support = f"{thing.support} 1" if thing.support in THINGS else thing.support
            yield Item(
                id=f"{label} {k + 1}",
                label=label,
                size=(width, depth, height),
                support=support,
                backed=thing.backed,
                clear=thing.clear,
            )


def _habits(items: Sequence[Item]) -> Iterator[Wish]:
    """Soft wishes from the habits of things, distributed over their possible partners."""
    names = [i.id for i in items]
    for item in items:
        habit = THINGS[item.label].habit if item.label in THINGS else ""
        name, _, partner = habit.partition(" ")
        if habit and not partner:
            yield Wish.model_validate({"subject": item.id, "name": name, "hard": False})
        elif habit and (partners := [n for n in names if str(n).rpartition(" ")[0] == partner]):
            k = int(str(item.id).rpartition(" ")[2]) - 1
            partner_id = partners[k % len(partners)]
            yield Wish.model_validate({"subject": item.id, "name": name, "objects": (partner_id,), "hard": False})


def _relations(
    size: tuple[float, float, float], items: Sequence[Item], rng: np.random.Generator, stated: float
) -> Iterator[Wish]:
    """True relations between free things that stand on the floor."""
    free = [i for i in items if i.stand is None and i.support == "floor" and i.size[2] > 0.05]
    at = _witness(size, items, rng)
    pairs = [(a, b) for a in free for b in free if a.id != b.id and {a.id, b.id} <= at.keys()]
    fixed = {(i.id, THINGS[i.label].habit.partition(" ")[2]) for i in free}
    said = set[frozenset[int | str]]()
    for k in rng.permutation(len(pairs)):
        one, other = pairs[int(k)]
        together = {(one.id, other.label), (other.id, one.label)} & fixed
        pair = frozenset((one.id, other.id))
        if together or pair in said or len(said) >= stated * len(free):
            continue
        way = np.array(at[one.id]) - np.array(at[other.id])
        way /= np.linalg.norm(way)
        for name, aim in zip(_VIEWED, ((-1, 0), (1, 0), (0, -1), (0, 1)), strict=True):
            if float(way @ np.array(aim)) > _MIN_COSINE:
                said.add(pair)
                yield Wish(subject=one.id, name=name, objects=(other.id,))


def _witness(
    size: tuple[float, float, float], items: Sequence[Item], rng: np.random.Generator
) -> dict[int | str, tuple[float, float]]:
    """Random positions (x, y) of the things that stand on the floor, without overlaps, placed in order of size."""
    found: dict[int | str, tuple[float, float]] = {}
    taken = list[tuple[float, float, float, float]]()
    for item in sorted(items, key=lambda i: -i.size[0] * i.size[1]):
        if item.stand is not None or item.support != "floor" or item.size[2] <= 0.05:
            continue
        for _ in range(_TRIES):
            hx, hy = rng.permutation(item.size[:2]) / 2
            x, y = (float(rng.uniform(h - s / 2, s / 2 - h)) for h, s in ((hx, size[0]), (hy, size[1])))
            if all(abs(x - a) > hx + ha or abs(y - b) > hy + hb for a, b, ha, hb in taken):
                found[item.id] = (x, y)
                taken.append((x, y, float(hx), float(hy)))
                break
    return found

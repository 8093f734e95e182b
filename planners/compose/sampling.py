"""Draw random briefs of any kind of room, to measure layouts with."""

from __future__ import annotations

import numpy as np

from . import knowledge
from .brief import Brief, Relation, Thing
from .furnishing import Furnishing

_OPENINGS = 2  # a door and a window count as objects too


def sample_brief(kind: str, objects: int, seed: int) -> Brief:
    """A brief of a kind of room with a given number of objects, door and window included.

    Things that the kind of room must have come first, then usual things in an order drawn from `seed`. Relations
    "on" and a third of the others are hard, as if a user had stated them; the rest are soft.

    Args:
        kind: name of a kind of room.
        objects: how many; 8 to 30 are sensible. The brief has fewer where the kind of room has no more habits.
        seed: the same seed gives the same brief.
    """
    rng = np.random.default_rng([seed, objects])
    room = knowledge.room(kind)
    made = Furnishing(Brief(kind=room.name), rng)
    left = objects - _OPENINGS
    order = [*room.must, *(room.usual[int(i)] for i in _slightly_shuffled(len(room.usual), rng)), *room.usual]
    for habit in order:
        if left > 0 and made.add(habit, most=left):
            left -= made.groups[-1].count
    made.settle()
    things = [
        Thing(id="door", name="door"),
        Thing(id="window", name="window"),
        *(g.thing.model_copy(update={"optional": False}) for g in made.groups),
    ]
    known = {t.id for t in things}
    relations = [
        Relation(subject=g.key, name=b.name, objects=b.objects, hard=bool(b.name == "on" or rng.random() < 1 / 3))
        for g in made.groups
        for b in g.relations
        if set(b.objects) <= known
    ]
    return Brief(kind=room.name, things=tuple(things), relations=tuple(relations), habits=False)


def _slightly_shuffled(number: int, rng: np.random.Generator) -> list[int]:
    """The positions 0 to `number` - 1, slightly shuffled: each moves by a few places at most."""
    return [int(i) for i in np.argsort(np.arange(number) + rng.uniform(0, 4, number), kind="stable")]

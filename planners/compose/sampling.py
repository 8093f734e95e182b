"""Random briefs over all kinds of rooms, for measuring layouts."""

from __future__ import annotations

import numpy as np

from . import knowledge
from .brief import Brief, Relation, Thing
from .furnishing import Furnishing

_OPENINGS = 2  # a door and a window count as objects too


def sample_brief(kind: str, objects: int, seed: int) -> Brief:
    """A brief of a kind of room with just so many objects, its door and window among them.

    All that a room of the kind must have comes first, then what it usually has, in an order drawn by `seed`; a
    third of the habits are stated as if a user had said them, the others stay habits.

    Args:
        kind: name of a kind of room.
        objects: how many; 8 to 30 are sensible. Fewer than asked for come where the kind knows no more things.
        seed: the same seed gives the same brief.
    """
    rng = np.random.default_rng([seed, objects])
    room = knowledge.room(kind)
    made = Furnishing(Brief(kind=room.name), rng)
    left = objects - _OPENINGS
    order = [*room.must, *(room.usual[int(i)] for i in _nearly(len(room.usual), rng)), *room.usual]
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
        for b in g.bonds
        if set(b.objects) <= known
    ]
    return Brief(kind=room.name, things=tuple(things), relations=tuple(relations), habits=False)


def _nearly(number: int, rng: np.random.Generator) -> list[int]:
    """Positions in nearly their order: each moves by a few places at most."""
    return [int(i) for i in np.argsort(np.arange(number) + rng.uniform(0, 4, number), kind="stable")]

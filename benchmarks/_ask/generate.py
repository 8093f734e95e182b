"""Generates questions about rooms from their true tables, with exact answers and only where the answer is clear.

Every kind of question has a function in `makers` that yields all questions of its kind with a clear margin;
`questions` draws among them so that all kinds have their share. The margins stand at the top of each module.
"""

from __future__ import annotations

import itertools
import zlib
from collections import Counter
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from .makers import contact, floor, lengths, sides, what
from .naming import Made, Room
from .question import Question
from .truth import Table

PER_KIND = 12  # questions of a kind that are drawn from in one room
MAKERS: tuple[Callable[[Room], Made], ...] = (
    what.existence,
    what.count,
    what.count_is,
    what.colour,
    what.colour_is,
    lengths.size,
    lengths.compare,
    lengths.compare_is,
    lengths.distance,
    lengths.distance_is,
    lengths.nearest,
    lengths.nearer,
    sides.viewer_side,
    sides.object_side,
    sides.seated,
    sides.facing,
    contact.on,
    contact.on_is,
    contact.under_is,
    contact.next_is,
    contact.between_is,
    contact.inside,
    what.lists,
    what.superlative,
    floor.room_size,
    floor.free_floor,
    floor.fits,
    floor.fits_between,
    floor.hazards,
    floor.routes,
    what.absent,
    what.undecidable,
    what.several,
)
WEIGHTS = {"absent": 4, "undecidable": 4, "distance": 2, "count": 2, "viewer_side": 2, "colour": 2}  # others 1


def pool(table: Table, vocabulary: Sequence[str], held: bool = False) -> dict[str, list[Question]]:
    """Questions of every kind that the room has, at most `PER_KIND` of each; the same table gives the same ones."""
    room = Room(table, sorted(vocabulary), np.random.default_rng([zlib.crc32(b"ask"), table.seed]), held)
    found: dict[str, list[Question]] = {}
    for make in MAKERS:
        seen = set[str]()
        for question in itertools.islice(make(room), 3 * PER_KIND):
            if question.text not in seen and len(found.setdefault(question.kind, [])) < PER_KIND:
                seen.add(question.text)
                found[question.kind].append(question)
    return {kind: own for kind, own in found.items() if own}


def questions(tables: Sequence[Table], vocabulary: Iterable[str], count: int, held: bool = False) -> list[Question]:
    """At most `count` questions over rooms: of each kind as many as its weight says, spread over the rooms evenly.

    A room gets at most `count` over the number of rooms, rounded up. With `held`, the wordings are those held back.
    """
    pools = [pool(t, tuple(vocabulary), held) for t in tables]
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

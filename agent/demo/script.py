"""What to say to a room one has never seen: instructions derived from the things that stand in it.

Knows kinds, colours and how instructions are phrased. Refuses to know how anything is found or done: each role offers
several sentences and the demo says the first that can be carried out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

Outcome = Literal["edit", "undo", "ambiguous", "absent"]

TABLES = ("coffee table", "dining table", "table", "desk", "side table", "bedside table", "nightstand", "sideboard",
          "dresser", "cabinet", "bench", "stool")  # fmt: skip
PAINTS = ("teal", "dark red", "yellow", "navy", "orange", "dark green", "pink", "white")
KEEP = ("floor", "wall", "ceiling", "window", "door", "curtain", "rug", "mirror", "painting")  # not good to move


@dataclass(frozen=True)
class Thing:
    """Something in the room, as a visitor would describe it.

    Attributes:
        id: its number in the builder's own list, for checking the answers afterwards.
        kind: "armchair".
        color: "brown".
        pixels: how many pixels of the view it fills; 0 if it is hidden.
        across: where it is seen, from 0 at the picture's left edge to 1 at its right.
    """

    id: int
    kind: str
    color: str
    pixels: int
    across: float = 0.5


@dataclass(frozen=True)
class Turn:
    """One thing to say.

    Attributes:
        text: the instruction.
        outcome: what ought to come of it.
        answer: said when asked back.
        about: the things it speaks of, for checking.
    """

    text: str
    outcome: Outcome = "edit"
    answer: str = ""
    about: tuple[Thing, ...] = ()


Role = Callable[["Cast"], Iterator[Turn]]


@dataclass
class Cast:
    """The things that can still be spoken of.

    Attributes:
        things: visible ones, largest in the picture first.
        absent: names of kinds that are not in the room.
        used: ids of things that were spoken of; a new role prefers others.
        last: what was spoken of last.
    """

    things: Sequence[Thing]
    absent: Sequence[str]
    used: set[int]
    last: Thing | None = None

    def single(self, movable: bool = False) -> list[Thing]:
        """Things that are the only one of their kind, unused ones first."""
        kinds = [t.kind for t in self.things]
        lone = [t for t in self.things if kinds.count(t.kind) == 1 and not (movable and t.kind in KEEP)]
        return sorted(lone, key=lambda t: t.id in self.used)

    def several(self) -> list[list[Thing]]:
        """Kinds of which there is more than one, with their things; what can be carried comes first."""
        kinds = list(dict.fromkeys(t.kind for t in self.things))
        groups = [[t for t in self.things if t.kind == kind] for kind in kinds]
        return sorted((g for g in groups if len(g) > 1), key=lambda g: g[0].kind in KEEP)


def _select(cast: Cast) -> Iterator[Turn]:
    for t in cast.single(movable=True):
        yield Turn(f"select the {t.color} {t.kind}", about=(t,))
    for t in cast.single(movable=True):
        yield Turn(f"select the {t.kind}", about=(t,))


def _repaint(cast: Cast) -> Iterator[Turn]:
    color = cast.last.color if cast.last else ""
    yield from (Turn(f"make it {paint}") for paint in PAINTS if color not in paint or not color)


def _recolor(cast: Cast) -> Iterator[Turn]:
    for t in cast.single():
        paint = next(p for p in ("orange", "dark green") if t.color not in p)
        yield Turn(f"paint the {t.kind} {paint}", about=(t,))


def _delete(cast: Cast) -> Iterator[Turn]:
    fresh = [t for t in cast.single(movable=True) if t.id not in cast.used]
    spoken_of = [t for t in cast.single(movable=True) if t.id in cast.used]
    for t in (*reversed(fresh), *spoken_of):
        yield Turn(f"remove the {t.kind}", about=(t,))


def _move(cast: Cast) -> Iterator[Turn]:
    for distance in ("60 cm", "30 cm"):
        for t in cast.single(movable=True):
            inwards, outwards = ("right", "left") if t.across < 0.5 else ("left", "right")
            ways = (f"to the {inwards}", "backward", "forward", f"to the {outwards}")
            yield from (Turn(f"move the {t.kind} {distance} {way}", about=(t,)) for way in ways)


def _insert(cast: Cast) -> Iterator[Turn]:
    tops = sorted((t for t in cast.single() if t.kind in TABLES), key=lambda t: TABLES.index(t.kind))
    for asset in ("vase", "red ball", "bowl", "mug"):
        yield from (Turn(f"put a {asset} on the {t.kind}", about=()) for t in tops)
    yield Turn("put a red ball on the floor")


def _undo(cast: Cast) -> Iterator[Turn]:
    yield Turn("undo that", "undo")


def _absent(cast: Cast) -> Iterator[Turn]:
    yield from (Turn(f"remove the {kind}", "absent") for kind in cast.absent)


def _ambiguous(cast: Cast) -> Iterator[Turn]:
    for group in cast.several():
        yield Turn(f"paint the {group[0].kind} yellow", "ambiguous", "the left one")
    for t in cast.single(movable=True):
        yield Turn(f"duplicate the {t.kind} and paint the {t.kind} yellow", "ambiguous", "the left one")


def _compound(cast: Cast) -> Iterator[Turn]:
    lone = cast.single()
    for a in lone:
        for b in (t for t in cast.single(movable=True) if t.id != a.id):
            yield Turn(f"make the {a.kind} a bit darker and rotate the {b.kind} 30 degrees", about=(a, b))


SCRIPT: tuple[tuple[str, Role], ...] = (
    ("select", _select),
    ("recolour", _repaint),
    ("recolour by name", _recolor),
    ("insert", _insert),
    ("move", _move),
    ("undo", _undo),
    ("an absent thing", _absent),
    ("an ambiguous thing", _ambiguous),
    ("delete", _delete),
    ("two in one", _compound),
)

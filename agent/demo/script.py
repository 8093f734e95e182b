"""The script of the demo: instructions derived from the things in a room.

Each part of the script offers several instructions; the demo uses the first that has its expected outcome.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

Outcome = Literal["edit", "undo", "ambiguous", "absent"]

TABLES = ("coffee table", "dining table", "table", "desk", "side table", "bedside table", "nightstand", "sideboard",
          "dresser", "cabinet", "bench", "stool")  # fmt: skip
PAINTS = ("teal", "dark red", "yellow", "navy", "orange", "dark green", "pink", "white")
FIXED = ("floor", "wall", "ceiling", "window", "door", "curtain", "rug", "mirror", "painting")  # not to be moved


@dataclass(frozen=True)
class Thing:
    """A thing in the room, as a visitor would describe it.

    Attributes:
        id: its id in the builder's list, for checking results.
        kind: "armchair".
        color: "brown".
        pixels: how many pixels of the view it covers; 0 if it is hidden.
        across: its horizontal position in the picture, from 0 (left) to 1 (right).
    """

    id: int
    kind: str
    color: str
    pixels: int
    across: float = 0.5


@dataclass(frozen=True)
class Turn:
    """One instruction of the demo.

    Attributes:
        text: the instruction.
        outcome: the expected outcome.
        answer: the answer to the question if the instruction is ambiguous.
        about: the things that are meant, for checking.
    """

    text: str
    outcome: Outcome = "edit"
    answer: str = ""
    about: tuple[Thing, ...] = ()


ScriptPart = Callable[["Targets"], Iterator[Turn]]


@dataclass
class Targets:
    """The things that instructions can name.

    Attributes:
        things: visible things, largest in the picture first.
        absent: names of kinds that are not in the room.
        used: ids of things that were named before; later parts prefer others.
        last: the thing that was named last.
    """

    things: Sequence[Thing]
    absent: Sequence[str]
    used: set[int]
    last: Thing | None = None

    def single(self, movable: bool = False) -> list[Thing]:
        """Things that are the only one of their kind, unused ones first."""
        kinds = [t.kind for t in self.things]
        lone = [t for t in self.things if kinds.count(t.kind) == 1 and not (movable and t.kind in FIXED)]
        return sorted(lone, key=lambda t: t.id in self.used)

    def several(self) -> list[list[Thing]]:
        """The things of each kind that occurs more than once; movable kinds first."""
        kinds = list(dict.fromkeys(t.kind for t in self.things))
        groups = [[t for t in self.things if t.kind == kind] for kind in kinds]
        return sorted((g for g in groups if len(g) > 1), key=lambda g: g[0].kind in FIXED)


def _select(targets: Targets) -> Iterator[Turn]:
    for t in targets.single(movable=True):
        yield Turn(f"select the {t.color} {t.kind}", about=(t,))
    for t in targets.single(movable=True):
        yield Turn(f"select the {t.kind}", about=(t,))


def _repaint(targets: Targets) -> Iterator[Turn]:
    color = targets.last.color if targets.last else ""
    yield from (Turn(f"make it {paint}") for paint in PAINTS if color not in paint or not color)


def _recolor(targets: Targets) -> Iterator[Turn]:
    for t in targets.single():
        paint = next(p for p in ("orange", "dark green") if t.color not in p)
        yield Turn(f"paint the {t.kind} {paint}", about=(t,))


def _delete(targets: Targets) -> Iterator[Turn]:
    fresh = [t for t in targets.single(movable=True) if t.id not in targets.used]
    spoken_of = [t for t in targets.single(movable=True) if t.id in targets.used]
    for t in (*reversed(fresh), *spoken_of):
        yield Turn(f"remove the {t.kind}", about=(t,))


def _move(targets: Targets) -> Iterator[Turn]:
    for distance in ("60 cm", "30 cm"):
        for t in targets.single(movable=True):
            inwards, outwards = ("right", "left") if t.across < 0.5 else ("left", "right")
            ways = (f"to the {inwards}", "backward", "forward", f"to the {outwards}")
            yield from (Turn(f"move the {t.kind} {distance} {way}", about=(t,)) for way in ways)


def _insert(targets: Targets) -> Iterator[Turn]:
    tops = sorted((t for t in targets.single() if t.kind in TABLES), key=lambda t: TABLES.index(t.kind))
    for asset in ("vase", "red ball", "bowl", "mug"):
        yield from (Turn(f"put a {asset} on the {t.kind}", about=()) for t in tops)
    yield Turn("put a red ball on the floor")


def _ambiguous(targets: Targets) -> Iterator[Turn]:
    for group in targets.several():
        yield Turn(f"paint the {group[0].kind} yellow", "ambiguous", "the left one")
    for t in targets.single(movable=True):
        yield Turn(f"duplicate the {t.kind} and paint the {t.kind} yellow", "ambiguous", "the left one")


def _compound(targets: Targets) -> Iterator[Turn]:
    lone = targets.single()
    for a in lone:
        for b in (t for t in targets.single(movable=True) if t.id != a.id):
            yield Turn(f"make the {a.kind} a bit darker and rotate the {b.kind} 30 degrees", about=(a, b))


SCRIPT: tuple[tuple[str, ScriptPart], ...] = (
    ("select", _select),
    ("recolour", _repaint),
    ("recolour by name", _recolor),
    ("insert", _insert),
    ("move", _move),
    ("undo", lambda _: iter([Turn("undo that", "undo")])),
    ("an absent thing", lambda targets: (Turn(f"remove the {kind}", "absent") for kind in targets.absent)),
    ("an ambiguous thing", _ambiguous),
    ("delete", _delete),
    ("two in one", _compound),
)

"""What is wished of a room, as data: a floor to keep free, things at the walls, chairs in a circle.

Knows the kinds of goals and what each is about. Refuses to know which words say them and how they are reached.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ...gaussians.language.query.query import Query
from ...tools.operation import EditOp

Relation = Literal["center", "next_to", "in_front_of"]


@dataclass(frozen=True)
class Where:
    """A part of the floor: the middle of the room, or beside or before something."""

    relation: Relation = "center"
    anchor: Query | None = None


@dataclass(frozen=True)
class Clear:
    """Floor to be kept free; `width` metres across, None: as large as people need for what it is called."""

    where: Where = Where()
    width: float | None = None
    called: str = "free floor"


@dataclass(frozen=True)
class Walls:
    """Things to be pushed to the walls; None: all furniture."""

    things: Query | None = None


@dataclass(frozen=True)
class Formation:
    """Things in a figure; `around` or `facing` names what it is about, `rows` how many."""

    shape: Literal["circle", "arc", "row", "around"]
    things: Query
    about: Query | None = None
    where: Where | None = None
    rows: int = 1


@dataclass(frozen=True)
class Tidy:
    """Everything straight, furniture flush with walls, small things off the floor."""


@dataclass(frozen=True)
class Declutter:
    """What stands on something goes elsewhere."""

    surface: Query


@dataclass(frozen=True)
class SetTable:
    """A table laid for some people; None: for as many as sit at it."""

    table: Query
    people: int | None = None


@dataclass(frozen=True)
class See:
    """Seats turned to something, with nothing between."""

    things: Query | None
    goal: Query


@dataclass(frozen=True)
class Spread:
    """Things far from each other, all over the room."""

    things: Query


@dataclass(frozen=True)
class ReadingCorner:
    """A seat, a lamp and something to read in a corner, or at something."""

    where: Where | None = None


@dataclass(frozen=True)
class Symmetric:
    """Things of a kind mirrored to each other about the room's middle."""


@dataclass(frozen=True)
class Become:
    """A room of another kind."""

    kind: str


@dataclass(frozen=True)
class Party:
    """A room ready for a party: what that takes, unless it is said."""


@dataclass(frozen=True)
class Plain:
    """What the grammar understands by itself."""

    ops: tuple[EditOp, ...]


Goal = (
    Clear | Walls | Formation | Tidy | Declutter | SetTable | See | Spread | ReadingCorner | Symmetric | Become | Party
    | Plain
)  # fmt: skip

"""The goals of wishes as data types: floor to keep free, things along the walls, chairs in a circle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ...gaussians.language.query.query import Query
from ...tools.operation import EditOp

FloorRelation = Literal["center", "next_to", "in_front_of"]


@dataclass(frozen=True)
class Where:
    """A part of the floor: the middle of the room, or next to or in front of `anchor`."""

    relation: FloorRelation = "center"
    anchor: Query | None = None


@dataclass(frozen=True)
class Clear:
    """Keep floor free, `width` metres across; None: a width that fits the purpose `called`."""

    where: Where = Where()
    width: float | None = None
    called: str = "free floor"


@dataclass(frozen=True)
class Walls:
    """Push things to the walls; None: all furniture."""

    things: Query | None = None


@dataclass(frozen=True)
class Formation:
    """Arrange things in a figure, `about` something (around or facing it) or at `where`; `rows` is for rows."""

    shape: Literal["circle", "arc", "row", "around"]
    things: Query
    about: Query | None = None
    where: Where | None = None
    rows: int = 1


@dataclass(frozen=True)
class Tidy:
    """Straighten furniture, align it with the walls, and put small things from the floor onto furniture."""


@dataclass(frozen=True)
class Declutter:
    """Move what stands on a surface elsewhere."""

    surface: Query


@dataclass(frozen=True)
class SetTable:
    """Set a table for a number of people; None: for as many as there are seats at it."""

    table: Query
    people: int | None = None


@dataclass(frozen=True)
class See:
    """Turn seats to something; None: all seats."""

    things: Query | None
    goal: Query


@dataclass(frozen=True)
class Spread:
    """Spread things out over the room, far from each other."""

    things: Query


@dataclass(frozen=True)
class ReadingCorner:
    """A seat with a lamp and a side table in a corner, or next to something."""

    where: Where | None = None


@dataclass(frozen=True)
class Symmetric:
    """Mirror pairs of things of a kind about the axis of the largest thing."""


@dataclass(frozen=True)
class Become:
    """Turn the room into a room of another kind."""

    kind: str


@dataclass(frozen=True)
class Party:
    """Prepare the room for a party; what that includes, unless other goals say so, is in achieve.py."""


@dataclass(frozen=True)
class PlainEdit:
    """A clause that the grammar planned: plain edit operations."""

    ops: tuple[EditOp, ...]


Goal = (
    Clear | Walls | Formation | Tidy | Declutter | SetTable | See | Spread | ReadingCorner | Symmetric | Become | Party
    | PlainEdit
)  # fmt: skip

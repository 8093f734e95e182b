"""What a layout has to fulfil, as data: a room, things with sizes, and what is wished of them. And what came of it.

Knows boxes and wishes. Refuses to know how they are fulfilled (the solver), and where they come from (compose, wishes).
Frames are the scene graph's: z up, metres, degrees, the origin at the centre of the floor; a thing's front is its -y
side at yaw 0.
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from ...gaussians.world import relations
from ...gaussians.world.person import WALKWAY
from ...gaussians.world.support import SHELL
from ..rooms.graph import SceneGraph
from ..rooms.node import NodeId, Point, Size, Support

Metres = Annotated[float, Field(ge=0, le=1000, allow_inf_nan=False)]
Wall = Literal["north", "east", "south", "west"]


class Stand(BaseModel):
    """Where something is: the centre of its box, metres, and its yaw, degrees."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    position: Point
    yaw: Annotated[float, Field(gt=-360, le=360, allow_inf_nan=False)] = 0.0


class Item(BaseModel):
    """One thing to be placed.

    Attributes:
        id, label, color, size: as a node of a scene graph has them.
        support: what carries it: "floor", "wall", "ceiling" or the id of another item.
        stand: where it is and stays; None lets the solver choose. Doors and windows always have one.
        was: where it stands now, of what may move: of places that are as good, the nearest to that is taken.
        height: of its underside over the floor, for what hangs on a wall; None leaves it to the solver.
        clear: metres kept free before, behind, left and right of it for using it: a drawer, a chair, a way through.
        backed: its back belongs against a wall.
        aisle: metres between its back and that wall, where somebody works behind it: a counter.
        optional: may be left out where there is no room.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    id: NodeId
    label: Annotated[str, Field(max_length=80)]
    color: Annotated[str, Field(max_length=40)] = ""
    size: Size
    support: Support = "floor"
    stand: Stand | None = None
    was: Stand | None = None
    height: Metres | None = None
    clear: tuple[Metres, Metres, Metres, Metres] = (0.0, 0.0, 0.0, 0.0)
    backed: bool = False
    aisle: Metres = 0.0
    optional: bool = False


class Wish(BaseModel):
    """A relation that is wanted: "subject name objects". `hard` ones were said by the user; others are habits.

    Names shared with the scene graph's relations mean exactly what the checker means by them. "facing": the subject's
    front is turned to the object. "around": the subject stands at a free side of the object, turned to it.
    "aligned_with": in one line, turned the same way. "far_from": at least half the room's diagonal away.
    `wall` says which one "against_wall", "in_corner" or "at_window" means: north is at positive y, behind; east at
    positive x, on the right; a corner of two walls is two wishes. None leaves it open.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    subject: NodeId
    name: relations.WishName
    objects: Annotated[tuple[NodeId, ...], Field(max_length=2)] = ()
    hard: bool = True
    wall: Wall | None = None

    @model_validator(mode="after")
    def _complete(self) -> Self:
        kind = relations.named(self.name)
        if len(self.objects) != kind.anchors:
            raise ValueError(f"{self.name} takes {kind.anchors} objects, got {len(self.objects)}")
        if self.wall and not kind.at_wall:
            raise ValueError(f"{self.name} is about no wall, got {self.wall}")
        return self


class Keepout(BaseModel):
    """A disc of floor to be kept free: a dance floor, the space before a door. `center` None: the solver chooses."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: Annotated[str, Field(max_length=80)]
    radius: Annotated[float, Field(gt=0, le=1000, allow_inf_nan=False)]
    center: tuple[float, float] | None = None


class Problem(BaseModel):
    """A room and all that is wanted in it.

    Attributes:
        size: width (x), depth (y), height (z) of the room.
        items: things, those that stay where they are included.
        wishes: what is wanted of them.
        free: floor to be kept free.
        walkway: metres between things that a person passes, where there is a choice.
        open: walls that the room is looked at through: nothing hangs there or turns a tall back to them unless wished.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    size: Size
    items: Annotated[tuple[Item, ...], Field(max_length=512)]
    wishes: Annotated[tuple[Wish, ...], Field(max_length=4096)] = ()
    free: Annotated[tuple[Keepout, ...], Field(max_length=16)] = ()
    walkway: Metres = WALKWAY
    open: Annotated[tuple[Wall, ...], Field(max_length=4)] = ()

    @model_validator(mode="after")
    def _closed(self) -> Self:
        known = {i.id for i in self.items}
        if len(known) != len(self.items):
            raise ValueError("two items have the same id")
        for item in self.items:
            if item.support not in SHELL and (item.support not in known or item.support == item.id):
                raise ValueError(f"item {item.id} stands on {item.support}, which is no other item")
        for wish in self.wishes:
            if missing := {wish.subject, *wish.objects} - known:
                raise ValueError(f"a wish names {sorted(map(str, missing))}, which is not there")
        return self


class Conflict(BaseModel):
    """A smallest set of statements that cannot all hold: with any one of them taken away the others can.

    Attributes:
        statements: sentences for a person: "the bed (3) is against a wall", "the room is 1 m wide".
        subjects: ids of the items they are about.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    statements: tuple[str, ...]
    subjects: tuple[NodeId, ...] = ()


class Layout(BaseModel):
    """What the solver found.

    Attributes:
        graph: the placed things with every kept wish that a scene graph can state; always free of collisions, inside
            the room and supported, if need be with fewer things.
        kept, broken: the wishes.
        left_out: ids of items there was no room for.
        conflicts: why hard wishes are broken or things that are not optional left out; empty if neither is so.
        seconds: how long it took.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    graph: SceneGraph
    kept: tuple[Wish, ...] = ()
    broken: tuple[Wish, ...] = ()
    left_out: tuple[NodeId, ...] = ()
    conflicts: tuple[Conflict, ...] = ()
    seconds: float = 0.0

    @property
    def ok(self) -> bool:
        """Whether everything that was asked for holds; broken habits and optional things do not count."""
        return not self.conflicts

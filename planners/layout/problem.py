"""The solver's input and output as data: a `Problem` (room, things with sizes, wishes) and the `Layout` found for it.

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
    """The pose of a thing: the centre of its box, metres, and its yaw, degrees."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    position: Point
    yaw: Annotated[float, Field(gt=-360, le=360, allow_inf_nan=False)] = 0.0


class Item(BaseModel):
    """One thing to be placed.

    Attributes:
        id, label, color, size: as a node of a scene graph has them.
        support: what carries it: "floor", "wall", "ceiling" or the id of another item.
        stand: its fixed pose; None lets the solver choose. Doors and windows always have one.
        was: its present pose if it may move; the solver prefers positions near it.
        height: of its underside over the floor, for things that hang on a wall; None leaves it to the solver.
        clear: metres kept free before, behind, left and right of it for use: a drawer, a chair, a passage.
        backed: whether its back belongs against a wall.
        aisle: metres between its back and that wall, where somebody works behind it: a counter.
        optional: whether it may be left out if there is no room.
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
    """A wanted relation: "subject name objects". `hard` ones were stated by the user; the others are usual practice.

    Names shared with the scene graph's relations mean exactly what the checker means by them. "facing": the subject's
    front is turned to the object. "around": the subject stands at a free side of the object, turned to it.
    "aligned_with": in one line, turned the same way. "far_from": at least half the room's diagonal away.
    `wall` names the wall for "against_wall", "in_corner" or "at_window": north is at positive y, behind; east at
    positive x, on the right. A corner of two named walls is two wishes. None allows any wall. `distance`: metres
    between the two (or to the wall or window) that are wanted, seen from above; "far_from" is then that distance alone.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    subject: NodeId
    name: relations.WishName
    objects: Annotated[tuple[NodeId, ...], Field(max_length=2)] = ()
    hard: bool = True
    wall: Wall | None = None
    distance: Annotated[float, Field(ge=0, le=1000, allow_inf_nan=False)] | None = None

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


class Rigid(BaseModel):
    """Things on the floor that are placed as one: a row of stools, desks in rows, chairs in a circle.

    `members`: id, x, y (metres) and yaw (degrees) of each in the axes of the first, which is at 0, 0, 0.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    members: Annotated[tuple[tuple[NodeId, float, float, float], ...], Field(min_length=2, max_length=200)]


class Problem(BaseModel):
    """A room, its things and the wishes about them.

    Attributes:
        size: width (x), depth (y), height (z) of the room.
        items: all things, including those with a fixed pose.
        wishes: wanted relations.
        free: discs of floor to be kept free.
        walkway: preferred width of passages for a person, metres.
        open: walls through which the viewer looks into the room: unless wished, nothing hangs there and no tall thing
            turns its back to them.
        outdoor: whether it is a place without walls and ceiling.
        rigid: things that are placed as one where there is room for it, and singly otherwise.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    size: Size
    items: Annotated[tuple[Item, ...], Field(max_length=512)]
    wishes: Annotated[tuple[Wish, ...], Field(max_length=4096)] = ()
    free: Annotated[tuple[Keepout, ...], Field(max_length=16)] = ()
    walkway: Metres = WALKWAY
    open: Annotated[tuple[Wall, ...], Field(max_length=4)] = ()
    rigid: Annotated[tuple[Rigid, ...], Field(max_length=64)] = ()
    outdoor: bool = False

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
        for group in self.rigid:
            if missing := {m[0] for m in group.members} - known:
                raise ValueError(f"a rigid group names {sorted(map(str, missing))}, which is not there")
        return self


class Conflict(BaseModel):
    """A smallest set of statements that cannot all hold; without any one of them the others can.

    Attributes:
        statements: sentences for a person: "the bed (3) is against a wall", "the room is 1 m wide".
        subjects: ids of the items they are about.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    statements: tuple[str, ...]
    subjects: tuple[NodeId, ...] = ()


class Layout(BaseModel):
    """The result of the solver.

    Attributes:
        graph: the placed things with every kept wish that a scene graph can state. It is free of collisions, inside
            the room and supported; things that cannot be placed so are left out.
        kept, broken: the wishes that hold, and those that do not.
        left_out: ids of items without a place.
        conflicts: why hard wishes are broken or required things are left out; empty if neither is the case.
        seconds: wall time.
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
        """Whether all hard wishes hold and all required things are placed."""
        return not self.conflicts

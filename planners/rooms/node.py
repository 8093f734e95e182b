"""The parts of a scene graph: nodes with upright boxes, the room's shape and a viewer.

World frame: right-handed, z up, metres and degrees; the origin is the centre of the floor.
"""

from __future__ import annotations

from typing import Annotated, Literal, Protocol, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from ...gaussians.world.box import Box, YawBox, cos_sin
from ...gaussians.world.support import is_stepped_on

Coordinate = Annotated[float, Field(ge=-1e5, le=1e5, allow_inf_nan=False)]
Extent = Annotated[float, Field(ge=0, le=1e5, allow_inf_nan=False)]
Size = tuple[Extent, Extent, Extent]
Point = tuple[Coordinate, Coordinate, Coordinate]
# Graphs read from scenes have numbers; people who write a graph may name their nodes, and the names are kept.
NodeId = Annotated[int, Field(ge=0, le=10**9, strict=True)] | Annotated[str, Field(min_length=1, max_length=80)]
Support = Literal["floor", "wall", "ceiling"] | NodeId


class Node(BaseModel):
    """One object.

    Attributes:
        id: group id of the scene it was read from, or the author's own number or name.
        label: what it is, "" if nobody could tell.
        color: name of its main colour, "" if unknown.
        size: width, depth, height of its own upright box, metres.
        position: centre of that box.
        yaw: degrees counter-clockwise seen from above, of the box's width against world x, in (-180, 180].
        support: id of the node it stands on, or "floor", "wall", "ceiling".
        material: its surface in words ("oak", "red and white stripes"), "" for that of its design.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    id: NodeId
    label: Annotated[str, Field(max_length=80)]
    color: Annotated[str, Field(max_length=40)] = ""
    size: Size
    position: Point
    yaw: Annotated[float, Field(gt=-360, le=360, allow_inf_nan=False)] = 0.0
    support: Support = "floor"
    material: Annotated[str, Field(max_length=60)] = ""

    @property
    def yaw_box(self) -> YawBox:
        """Its upright box in the room."""
        return YawBox(self.position[0], self.position[1], self.bottom, *self.size, self.yaw)

    @property
    def box(self) -> Box:
        """Its upright box; sides of no length count as a tenth of a millimetre."""
        c, s = cos_sin(self.yaw)
        width, depth, height = (max(side, 1e-4) for side in self.size)
        return Box(self.position, ((c, s, 0.0), (-s, c, 0.0), (0.0, 0.0, 1.0)), (width, depth, height))

    @property
    def is_stepped_on(self) -> bool:
        """Whether people and furniture stand on it, as on a rug."""
        return is_stepped_on(self.support, self.size[2])

    @property
    def bottom(self) -> float:
        """Height of its underside, metres."""
        return self.position[2] - self.size[2] / 2

    @property
    def top(self) -> float:
        """Height of its top, metres."""
        return self.position[2] + self.size[2] / 2


class RoomShape(BaseModel):
    """The room: width (x), depth (y) and height (z) in metres, and where up is, which is always +z.

    `outdoor`: it has no ceiling, and walls only where something hangs on them; its height is that of what stands in it.
    `floor`, `walls` and `ceiling`: their surfaces in words ("oak planks", "exposed brick", "pale green"), "" for any.
    `light`: a mood that `relight` knows ("evening", "sunny"), "" for the light that it is built with.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    size: Size
    up: Point = (0.0, 0.0, 1.0)
    outdoor: bool = False
    floor: Annotated[str, Field(max_length=60)] = ""
    walls: Annotated[str, Field(max_length=60)] = ""
    ceiling: Annotated[str, Field(max_length=60)] = ""
    light: Annotated[str, Field(max_length=40)] = ""

    @model_validator(mode="after")
    def _upright(self) -> Self:
        if self.up != (0.0, 0.0, 1.0):
            raise ValueError(f"a graph's z axis points up, got up {list(self.up)}; turn the positions instead")
        return self


class Viewpoint(BaseModel):
    """Whose left, right, in front and behind are meant: an eye and a point that it looks at."""

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    position: Point
    target: Point


class Drawn(Protocol):
    """The part of a graph that building reads: the room, its nodes and the viewer."""

    @property
    def room(self) -> RoomShape: ...

    @property
    def nodes(self) -> tuple[Node, ...]: ...

    @property
    def viewer(self) -> Viewpoint | None: ...

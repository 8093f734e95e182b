"""The scene graph: what stands where, as strict JSON that people, models and solvers share.

Knows names, boxes and relations. Refuses to know Gaussians: it is read from a scene's language field, or written by
hand.
World frame: right-handed, z up, metres and degrees; the origin is the centre of the floor. The viewer stands at
negative y and looks along +y, so that left is -x and "in front" is toward -y, unless the graph has a `viewer`.
"""

from __future__ import annotations

import json
import math
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from ...gaussians.color import name_of
from ...gaussians.errors import FileError, UserError
from ...gaussians.world.box import Box
from .orienting import Orienter

if TYPE_CHECKING:
    from ...gaussians.camera import Camera
    from ...gaussians.language.field.language_field import Group
    from ...gaussians.scene import Scene

Coordinate = Annotated[float, Field(ge=-1e5, le=1e5, allow_inf_nan=False)]
Extent = Annotated[float, Field(ge=0, le=1e5, allow_inf_nan=False)]
Size = tuple[Extent, Extent, Extent]
Point = tuple[Coordinate, Coordinate, Coordinate]
# Numbers from us; people who write a graph by hand also name their nodes, and get the names back.
NodeId = Annotated[int, Field(ge=0, le=10**9, strict=True)] | Annotated[str, Field(min_length=1, max_length=80)]
Support = Literal["floor", "wall", "ceiling"] | NodeId
SHELL = ("floor", "wall", "ceiling")


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
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    id: NodeId
    label: Annotated[str, Field(max_length=80)]
    color: Annotated[str, Field(max_length=40)] = ""
    size: Size
    position: Point
    yaw: Annotated[float, Field(gt=-360, le=360, allow_inf_nan=False)] = 0.0
    support: Support = "floor"

    @property
    def box(self) -> Box:
        """Its upright box; sides of no length count as a tenth of a millimetre."""
        c, s = math.cos(math.radians(self.yaw)), math.sin(math.radians(self.yaw))
        width, depth, height = (max(side, 1e-4) for side in self.size)
        return Box(self.position, ((c, s, 0.0), (-s, c, 0.0), (0.0, 0.0, 1.0)), (width, depth, height))

    @property
    def bottom(self) -> float:
        """Height of its underside, metres."""
        return self.position[2] - self.size[2] / 2

    @property
    def top(self) -> float:
        """Height of its top, metres."""
        return self.position[2] + self.size[2] / 2


class RoomShape(BaseModel):
    """The room: width (x), depth (y) and height (z) in metres, and where up is, which is always +z."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    size: Size
    up: Point = (0.0, 0.0, 1.0)

    @model_validator(mode="after")
    def _upright(self) -> Self:
        if self.up != (0.0, 0.0, 1.0):
            raise ValueError(f"a graph's z axis points up, got up {list(self.up)}; turn the positions instead")
        return self


class Viewpoint(BaseModel):
    """Whose left, right, in front and behind are meant: an eye and a point that it looks at."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    position: Point
    target: Point


class SceneGraph(BaseModel):
    """A room, its objects, and relations `[id, name, id]` between them that were stated or measured.

    `viewer` is optional; without one the viewer stands before the room, at negative y, and looks along +y.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    room: RoomShape
    nodes: Annotated[tuple[Node, ...], Field(max_length=4096)] = ()
    relations: Annotated[
        tuple[tuple[NodeId, Annotated[str, Field(max_length=40)], NodeId], ...], Field(max_length=65536)
    ] = ()
    viewer: Viewpoint | None = None

    @model_validator(mode="after")
    def _closed(self) -> Self:
        known = {n.id for n in self.nodes}
        if len(known) != len(self.nodes):
            raise ValueError("two nodes have the same id")
        for node in self.nodes:
            if node.support not in SHELL and (node.support not in known or node.support == node.id):
                raise ValueError(f"node {node.id} stands on {node.support}, which is no other node")
        for a, name, b in self.relations:
            if a not in known or b not in known:
                raise ValueError(f"relation {[a, name, b]} names a node that is not there")
        return self

    def node(self, id: int | str) -> Node:
        """The node with this id.

        Raises:
            UserError: there is none.
        """
        for node in self.nodes:
            if node.id == id:
                return node
        raise UserError(f"the graph has no node {id}; its ids are {', '.join(str(n.id) for n in self.nodes)}")

    @classmethod
    def read(cls, path: Path) -> SceneGraph:
        """A graph from a JSON file; a room that is not given is as large as what stands in it.

        Raises:
            FileError: the file cannot be read or holds no graph; the message names the first thing that is wrong.
        """
        try:
            data = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            why = (error.strerror if isinstance(error, OSError) else None) or str(error)
            raise FileError(f"cannot read the scene graph {path}: {why}") from error
        if isinstance(data, dict) and "room" not in data:
            data = {**data, "room": {"size": _extent_of(data.get("nodes"))}}
        try:
            return cls.model_validate_json(json.dumps(data))
        except ValidationError as error:
            raise FileError(f"{path} is no scene graph: {_first_wrong(error)}") from error

    def build(self, *, seed: int = 0, assets: Path | None = None, detail: float = 1.0) -> Scene:
        """The scene that it describes, ready to be edited and asked (see `planners.building.construct`).

        Args:
            seed: chooses designs, light and paint; the same seed gives the same bytes.
            assets: a folder of .glb and .ply files to take things from.
            detail: factor on the number of Gaussians.

        Raises:
            UserError: the room is too small or too large to be built, or `assets` is no folder of assets.
        """
        from .build import build

        return build(self, seed=seed, assets=assets, detail=detail)

    @classmethod
    def from_scene(cls, scene: Scene, viewer: Camera | None = None) -> SceneGraph:
        """The graph of an embedded scene: its objects as nodes, "on" relations from contact.

        Lengths are metres where the scene knows its scale and scene units otherwise.

        Args:
            viewer: whose left and right are meant; None leaves it to the reader.

        Raises:
            UserError: the scene has no language field.
        """
        from .infer_support import support_of

        field = scene.language
        if field is None:
            raise UserError("the scene has no language field yet; run `scenewright embed` on it first")
        place = _Placer(scene)
        nodes = [place.node(g) for g in field.objects() if g.count]  # what was deleted leaves an empty row
        nodes = [n.model_copy(update={"support": support_of(n, nodes, place.room)}) for n in nodes]
        stands = tuple((n.id, "on", n.support) for n in nodes if n.support not in SHELL)
        seen = place.viewpoint(viewer) if viewer is not None else None
        return cls(room=RoomShape(size=place.room), nodes=tuple(nodes), relations=stands, viewer=seen)


def _extent_of(nodes: Any) -> list[float]:
    """Width, depth and height of a room about the origin that holds nodes as they were written, metres."""
    reach = [1.0, 1.0, 1.0]
    for node in nodes if isinstance(nodes, list) else []:
        for i in range(3):
            with suppress(TypeError, ValueError, LookupError, AttributeError):  # the model says what is wrong
                far = abs(float(node["position"][i])) + float(node["size"][i]) / 2
                reach[i] = max(reach[i], far if i == 2 else 2 * far)
    return reach


def _first_wrong(error: ValidationError) -> str:
    """The first complaint of a validation, with the place in the file."""
    first = error.errors()[0]
    where = ".".join(str(p) for p in first["loc"] if p not in ("function-after", "int", "str"))
    said = first["msg"].removeprefix("Value error, ")
    more = error.error_count() - 1
    return f"{where + ': ' if where else ''}{said}" + (f" (and {more} more)" if more else "")


class _Placer:
    """Maps world boxes into the graph's frame: z up, metres, origin at the centre of the floor."""

    def __init__(self, scene: Scene) -> None:
        assert scene.language is not None
        self.basis: NDArray[np.float64] = scene.frame.basis()
        self.scale = scene.frame.metres_per_unit or 1.0
        self.fronts = Orienter(scene)
        groups = [g for g in scene.language.groups if g.level in ("object", "structure") and g.count]
        corners = np.concatenate([g.box.corners() for g in groups]) @ self.basis.T if groups else np.zeros((1, 3))
        low, high = corners.min(axis=0), corners.max(axis=0)
        floor = scene.frame.floor if scene.frame.floor is not None else float(low[2])
        self.origin: NDArray[np.float64] = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, floor])
        width, depth = ((high - low)[:2] * self.scale).tolist()
        self.height = max(float(high[2] - floor), 0.0) * self.scale
        self.room: Size = (width, depth, self.height)

    def point(self, world: NDArray[np.float64]) -> Point:
        """A point of the scene `[3]` in the graph's frame, metres."""
        x, y, z = ((self.basis @ world - self.origin) * self.scale).tolist()
        return (x, y, z)

    def viewpoint(self, camera: Camera) -> Viewpoint:
        """Where a camera stands, and a point one unit before it."""
        eye = camera.position
        return Viewpoint(position=self.point(eye), target=self.point(eye + camera.forward))

    def node(self, group: Group) -> Node:
        run, *sides = self.fronts.sides(group)
        along = self.basis @ run
        width, depth, height = (float(s) * self.scale for s in (*sides, group.box.size[2]))
        return Node(
            id=group.id,
            label=group.label,
            color=name_of(group.lab),
            size=(width, depth, height),
            position=self.point(np.array(group.box.center)),
            yaw=math.degrees(math.atan2(along[1], along[0])),
        )

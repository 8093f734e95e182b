"""The scene graph: the objects of a room with boxes and relations, as strict JSON for people, models and solvers.

World frame: right-handed, z up, metres and degrees; the origin is the centre of the floor. The viewer stands at
negative y and looks along +y, so that left is -x and "in front" is toward -y, unless the graph has a `viewer`.
"""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from ...gaussians.errors import FileError, UserError
from ...gaussians.world.support import SHELL
from . import read_scene
from .node import Node, NodeId, RoomShape, Viewpoint

if TYPE_CHECKING:
    from ...gaussians.camera import Camera
    from ...gaussians.scene import Scene


_OUTDOOR_HEIGHT = 2.5  # metres, at least, of a room whose height is not given


class SceneGraph(BaseModel):
    """A room, its objects, and relations `[id, name, id]` between them that were stated or measured.

    `viewer` is optional; without one the viewer stands before the room, at negative y, and looks along +y. A room of
    two sides, or of no height, is outdoors.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    room: RoomShape
    nodes: Annotated[tuple[Node, ...], Field(max_length=4096)] = ()
    relations: Annotated[
        tuple[tuple[NodeId, Annotated[str, Field(max_length=40)], NodeId], ...], Field(max_length=65536)
    ] = ()
    viewer: Viewpoint | None = None

    @model_validator(mode="before")
    @classmethod
    def _with_height(cls, data: Any) -> Any:
        """A room without a height is outdoors, and as high as what stands in it."""
        room = data.get("room") if isinstance(data, dict) else None
        size = room.get("size") if isinstance(room, dict) else None
        if (
            not isinstance(room, dict)
            or not isinstance(size, list | tuple)
            or len(size) not in (2, 3)
            or (len(size) == 3 and size[2])
        ):
            return data
        height = max(_extent_of(data.get("nodes"))[2], _OUTDOOR_HEIGHT)
        return {**data, "room": {**room, "size": [*size[:2], height], "outdoor": room.get("outdoor", True)}}

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

    def build(self, *, seed: int = 0, assets: str | Path | None = None, detail: float = 1.0) -> Scene:
        """The scene that it describes, ready to be edited and asked (see `planners.rooms.build.construct`).

        Args:
            seed: chooses designs, light and paint; the same seed gives the same bytes.
            assets: a folder of .glb and .ply files to take things from, or "dream:..." (`own_assets.own_assets`).
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
        nodes, room = read_scene.nodes_of(scene)
        stands = tuple((n.id, "on", n.support) for n in nodes if n.support not in SHELL)
        seen = room.viewpoint(viewer) if viewer is not None else None
        return cls(room=RoomShape(size=room.size), nodes=nodes, relations=stands, viewer=seen)


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

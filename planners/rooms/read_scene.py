"""The nodes of an embedded scene: its objects' boxes in the room's frame, their fronts, and what they rest on."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...gaussians.camera import Camera
from ...gaussians.color import name_of
from ...gaussians.errors import UserError
from ...gaussians.language.field.group_index import index_groups
from ...gaussians.language.field.language_field import Group
from ...gaussians.scene import Scene
from ...gaussians.world import kinds
from ...gaussians.world.facing import facing_in
from ...gaussians.world.support import support_of
from .node import Node, Point, Size, Support, Viewpoint


def nodes_of(scene: Scene) -> tuple[tuple[Node, ...], RoomFrame]:
    """The objects of a scene as nodes, and the frame that they are in.

    Raises:
        UserError: the scene has no language field.
    """
    if scene.language is None:
        raise UserError("the scene has no language field yet; run `scenewright embed` on it first")
    room = RoomFrame(scene)
    nodes = [room.node(g) for g in scene.language.objects() if g.count]  # what was deleted leaves an empty row
    boxes = [n.yaw_box for n in nodes]

    def rests_on(i: int) -> Support:
        kind = kinds.of(nodes[i].label)
        fixture = kind is not None and kind.support == "wall"
        found = support_of(i, boxes, room.size, fixture)
        return nodes[found].id if isinstance(found, int) else found

    return tuple(n.model_copy(update={"support": rests_on(i)}) for i, n in enumerate(nodes)), room


class RoomFrame:
    """Maps world boxes into the graph's frame: z up, metres, origin at the centre of the floor."""

    def __init__(self, scene: Scene) -> None:
        assert scene.language is not None
        self.basis: NDArray[np.float64] = scene.frame.basis()
        self.scale = scene.frame.metres_per_unit or 1.0
        self.cloud, self.field = scene.cloud, scene.language
        self.members = index_groups(scene.cloud)
        groups = [g for g in scene.language.groups if g.level in ("object", "structure") and g.count]
        corners = np.concatenate([g.box.corners() for g in groups]) @ self.basis.T if groups else np.zeros((1, 3))
        low, high = corners.min(axis=0), corners.max(axis=0)
        floor = scene.frame.floor if scene.frame.floor is not None else float(low[2])
        self.origin: NDArray[np.float64] = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, floor])
        width, depth = ((high - low)[:2] * self.scale).tolist()
        self.height = max(float(high[2] - floor), 0.0) * self.scale
        self.size: Size = (width, depth, self.height)

    def point(self, world: NDArray[np.float64]) -> Point:
        """A point of the scene `[3]` in the graph's frame, metres."""
        x, y, z = ((self.basis @ world - self.origin) * self.scale).tolist()
        return (x, y, z)

    def world(self, point: Point) -> NDArray[np.float64]:
        """A point of the graph's frame in the scene, `[3]`, scene units: the inverse of `point`."""
        place: NDArray[np.float64] = (np.array(point) / self.scale + self.origin) @ self.basis
        return place

    def viewpoint(self, camera: Camera) -> Viewpoint:
        """Where a camera stands, and a point one unit before it."""
        eye = camera.position
        return Viewpoint(position=self.point(eye), target=self.point(eye + camera.forward))

    def node(self, group: Group) -> Node:
        run, *sides = self._sides(group)
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

    def _sides(self, group: Group) -> tuple[NDArray[np.float64], float, float]:
        """`[3]` the way a thing's width runs, world frame, its front being to the right of that, and width and depth.

        Seen from above with the width running to the right, the front is below: the -y side of a graph's box. What
        faces nowhere keeps the axes that it was embedded with.
        """
        first, second, up = (np.array(a) for a in group.box.axes)
        across, along, _ = group.box.size
        rows = self.members.rows(self.field.leaves(group.id))
        front = facing_in(self.field, self.cloud, rows, group).front
        if front is None:
            return first, across, along
        width = np.cross(up, front)
        turned = abs(float(width @ first)) < abs(float(width @ second))
        return width, *((along, across) if turned else (across, along))

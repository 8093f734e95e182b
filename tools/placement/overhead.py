"""Placement above an anchor, for things that hang: on the wall behind the anchor, or from the ceiling over it.

Things that stand are refused: a chair goes on something, not above it.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from ...gaussians.camera import Vec3
from ...gaussians.errors import InstructionError
from ...gaussians.rotations import axis_rotation
from ...gaussians.scene import Scene
from ...gaussians.world import kinds
from ...gaussians.world.box import Axes
from ...gaussians.world.person import HUNG_AT
from ..operation import Context, Placement
from .bodies import Array, Body, angle_between, as_vec, centimetre, front_of
from .place import Spot, anchors_of, hanging_spot
from .regions import Region, distance_to
from .surroundings import Surroundings, support_height

Mount = Literal["wall", "ceiling"]
_GAP_ABOVE = 15.0  # centimetres between an anchor and the thing that hangs on the wall above it, at least
_MAX_WALL_DISTANCE = 100.0  # centimetres from an anchor to the wall behind it, at most
_NEAR = 0.9  # of the room's height: the top of a thing that hangs from the ceiling is above that


def place_above(around: Surroundings, body: Body, place: Placement) -> tuple[Array, Spot]:
    """The rotation `[3, 3]` and the spot of a hanging body that goes above the anchor of a placement.

    Raises:
        InstructionError: the body does not hang, there is no wall, or there is no room.
        AbsentError, AmbiguousError: the anchor is not in the scene or not unique.
    """
    (anchor, *_), scene = anchors_of(around, place), around.scene
    mount = mount_of(scene, body, around.context)
    if mount == "ceiling":
        region, axes = region_above(around, body.box.size, anchor, mount)
        return np.eye(3), hanging_spot(around, body.box.size, place, region, axes)
    matrix, size = turned_to_wall(scene, body, wall_axes(around, anchor))
    region, axes = region_above(around, size, anchor, mount)
    return matrix, hanging_spot(around, size, place, region, axes)


def mount_of(scene: Scene, body: Body, context: Context) -> Mount:
    """Whether a body hangs on a wall or from the ceiling, decided by its kind, else by its position.

    Raises:
        InstructionError: it does neither.
    """
    kind = kinds.of(body.label)
    if kind is not None and kind.support in ("wall", "ceiling"):
        return "wall" if kind.support == "wall" else "ceiling"
    if support_height(scene, body, context) is not None:
        raise InstructionError(f"the {body.label or 'thing'} stands and does not hang: say on something, or next to it")
    rooms = Surroundings(scene, context)
    return "ceiling" if body.box.top(rooms.up) > rooms.floor + _NEAR * (rooms.ceiling - rooms.floor) else "wall"


def region_above(around: Surroundings, size: Vec3, anchor: Body, mount: Mount) -> tuple[Region, Axes]:
    """The region where a thing of `size` hangs above an anchor, and the axes of its box there, its back to the wall.

    Raises:
        InstructionError: no wall is behind the anchor, or there is no height left above it.
    """
    cm = centimetre(around.frame, max(anchor.box.size))
    bottom = anchor.box.top(around.up) + _GAP_ABOVE * cm
    if mount == "ceiling":
        axes = around.room_axes
        height = around.ceiling - size[2]
    else:
        axes = wall_axes(around, anchor)
        height = min(max(bottom, around.floor + 100 * HUNG_AT * cm - size[2] / 2), around.ceiling - size[2])
    if height < (anchor.box.top(around.up) if mount == "ceiling" else bottom - _GAP_ABOVE * cm / 2):
        raise InstructionError(f"there is no room between the {anchor.label or 'thing'} and the ceiling")
    plan = np.array(axes[:2])
    middle = plan @ anchor.center
    if mount == "ceiling":
        reach = np.array([anchor.box.extent(a) for a in plan]) / 2
        return Region(middle - reach, middle + reach, lambda p: distance_to(p, middle), height, None), axes
    low, high = around.bounds_for(size, plan)
    back = np.array(around.room_axes[:2]) @ plan[1]  # the room's axis that points into the wall, with its sign
    wanted = np.array([middle[0], float(np.where(back > 0, high, low) @ back)])
    aside = np.array([anchor.box.extent(plan[0]) / 2, 2 * cm])
    return Region(wanted - aside, wanted + aside, lambda p: distance_to(p, wanted), height, None), axes


def wall_axes(around: Surroundings, anchor: Body) -> Axes:
    """Axes of a thing on the wall nearest to the anchor; the second axis points into the wall.

    Raises:
        InstructionError: no wall is within a metre of the anchor.
    """
    most = _MAX_WALL_DISTANCE * centimetre(around.frame, max(anchor.box.size))
    plan = np.array(around.room_axes[:2])
    low, high = around.bounds_for(anchor.box.size, np.array(anchor.box.axes[:2]))
    at = plan @ anchor.center
    gaps: list[tuple[float, Array]] = []
    for i in range(2):
        gaps += [(float(at[i] - low[i]), -plan[i]), (float(high[i] - at[i]), plan[i])]
    gap, back = min(gaps, key=lambda g: g[0])
    if gap > most:
        raise InstructionError(f"no wall is behind the {anchor.label or 'thing'}: name something that stands at a wall")
    return as_vec(np.cross(back, around.up)), as_vec(back), as_vec(around.up)


def turned_to_wall(scene: Scene, body: Body, axes: Axes) -> tuple[Array, Vec3]:
    """The rotation `[3, 3]` that turns a body's back along the second of the axes, and its size along them then.

    A body whose front is unknown hangs with its thin side to the wall.
    """
    up, front = scene.frame.up_vector, front_of(scene, body)
    if front is None:
        front = np.array(body.box.axes[int(np.argmin(body.box.size[:2]))])
    matrix = axis_rotation(up, angle_between(front, -np.array(axes[1]), up))
    width, depth = (body.box.extent(matrix.T @ np.array(a)) for a in axes[:2])
    return matrix, (width, depth, body.box.size[2])

"""Over something: on the wall behind it, or from the ceiling above it, for things that hang.

Knows walls, the ceiling and what stands below. Refuses to hang what stands: a chair goes on something, not above it.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from ...gaussians.camera import Vec3
from ...gaussians.errors import InstructionError
from ...gaussians.scene import Scene
from ...gaussians.world import kinds
from ...gaussians.world.box import Axes
from ...gaussians.world.person import HUNG_AT
from ..operation import Context, Placement
from ..transform import axis_rotation
from .bodies import Array, Body, angle_between, as_vec, centimetre, front_of
from .place import Spot, anchors_of, spot_to_hang
from .regions import Region, far
from .surroundings import Surroundings, support_height

Hung = Literal["wall", "ceiling"]
GAP = 15.0  # centimetres between a thing and what hangs on the wall above it, at least
_BEHIND = 100.0  # centimetres from a thing to the wall behind it, at most
_NEAR = 0.9  # of the room's height: what hangs from the ceiling has its top above that


def hung_over(around: Surroundings, body: Body, place: Placement) -> tuple[Array, Spot]:
    """How a body that hangs turns, `[3, 3]`, and where it goes, to hang above the anchor of a placement.

    Raises:
        InstructionError: it does not hang, no wall is there, or no room.
        AbsentError, AmbiguousError: the anchor is not there or not unique.
    """
    (anchor, *_), scene = anchors_of(around, place), around.scene
    hung = how_it_hangs(scene, body, around.context)
    if hung == "ceiling":
        region, axes = over(around, body.box.size, anchor, hung)
        return np.eye(3), spot_to_hang(around, body.box.size, place, region, axes)
    matrix, size = turned_to(scene, body, wall_axes(around, anchor))
    region, axes = over(around, size, anchor, hung)
    return matrix, spot_to_hang(around, size, place, region, axes)


def how_it_hangs(scene: Scene, body: Body, context: Context) -> Hung:
    """Whether a body hangs on a wall or from the ceiling, by what it is or by where it is.

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


def over(around: Surroundings, size: Vec3, anchor: Body, hung: Hung) -> tuple[Region, Axes]:
    """Where a thing of `size` hangs above an anchor, and the axes of its box there, its back to the wall.

    Raises:
        InstructionError: no wall is behind the anchor, or there is no height left above it.
    """
    cm = centimetre(around.frame, max(anchor.box.size))
    bottom = anchor.box.top(around.up) + GAP * cm
    if hung == "ceiling":
        axes = around.room_axes
        height = around.ceiling - size[2]
    else:
        axes = wall_axes(around, anchor)
        height = min(max(bottom, around.floor + 100 * HUNG_AT * cm - size[2] / 2), around.ceiling - size[2])
    if height < (anchor.box.top(around.up) if hung == "ceiling" else bottom - GAP * cm / 2):
        raise InstructionError(f"there is no room between the {anchor.label or 'thing'} and the ceiling")
    plan = np.array(axes[:2])
    middle = plan @ anchor.center
    if hung == "ceiling":
        reach = np.array([anchor.box.extent(a) for a in plan]) / 2
        return Region(middle - reach, middle + reach, lambda p: far(p, middle), height, None), axes
    low, high = around.bounds_for(size, plan)
    back = np.array(around.room_axes[:2]) @ plan[1]  # the room's axis that points into the wall, with its sign
    wanted = np.array([middle[0], float(np.where(back > 0, high, low) @ back)])
    aside = np.array([anchor.box.extent(plan[0]) / 2, 2 * cm])
    return Region(wanted - aside, wanted + aside, lambda p: far(p, wanted), height, None), axes


def wall_axes(around: Surroundings, anchor: Body) -> Axes:
    """Axes of a thing on the wall that is nearest to the anchor's side, its second axis pointing into the wall.

    Raises:
        InstructionError: no wall is within a metre of it.
    """
    most = _BEHIND * centimetre(around.frame, max(anchor.box.size))
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


def turned_to(scene: Scene, body: Body, axes: Axes) -> tuple[Array, Vec3]:
    """`[3, 3]`, how a body turns so that its back is along the second of the axes, and its size along them then.

    What faces nowhere hangs with its thin side to the wall.
    """
    up, front = scene.frame.up_vector, front_of(scene, body)
    if front is None:
        front = np.array(body.box.axes[int(np.argmin(body.box.size[:2]))])
    matrix = axis_rotation(up, angle_between(front, -np.array(axes[1]), up))
    width, depth = (body.box.extent(matrix.T @ np.array(a)) for a in axes[:2])
    return matrix, (width, depth, body.box.size[2])

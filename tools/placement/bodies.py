"""Where things are and how they stand to each other: bodies, boxes, the viewer's directions, the room.

Knows geometry of a scene and its groups. Refuses to know where things ought to go (see place).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.camera import Camera, Vec3
from ...gaussians.errors import InstructionError
from ...gaussians.language.field.measure import as_axes, box_along, level_axes, reach, solid_points
from ...gaussians.language.query.selection import Selection
from ...gaussians.scene import Frame, Scene
from ...gaussians.world.box import Axes, Box
from ...gaussians.world.facing import facing_in
from ...gaussians.world.relation_geometry import viewer_stand
from ..cloud_diff import rows_of
from ..operation import Direction

Array = NDArray[np.float64]
_CALIPERS = 1500  # points the footprint's orientation is found on; more do not change it


@dataclass(frozen=True, eq=False)
class Body:
    """One thing that moves as a whole: the selected Gaussians of one object, or those of no object.

    Attributes:
        rows: `[M]` int64 rows of the scene's cloud.
        group: id of its object (or of a part selected alone), -1 if the Gaussians belong to none.
        box: upright oriented box of its solid Gaussians, scene units.
        label: what it is called, "" if unknown.
        riders: ids of the objects on it whose Gaussians are among `rows`; `box` leaves them out.
    """

    rows: Tensor
    group: int
    box: Box
    label: str = ""
    riders: tuple[int, ...] = ()

    @property
    def center(self) -> Array:
        return np.array(self.box.center)

    def foot(self, up: Array) -> Array:
        """`[3]`, centre of the underside of its box."""
        return self.center - up * (self.box.size[2] / 2)


def bodies_of(scene: Scene, selection: Selection) -> list[Body]:
    """The selection split into things, in order of group id; Gaussians outside any group form one body at the end."""
    return [_body(scene, rows, group) for group, rows in rows_by_thing(scene, selection)]


def rows_by_thing(scene: Scene, selection: Selection) -> list[tuple[int, Tensor]]:
    """The rows `[M]` of each selected thing with its group id, in the order of `bodies_of`."""
    rows = rows_of(scene.cloud, selection.ids)
    leaf = scene.cloud.group[rows]
    owner = _owners(scene, selection)
    table = torch.full((max([int(leaf.max()), *owner], default=0) + 2,) if len(rows) else (1,), -1, dtype=torch.int64)
    for part, whole in owner.items():
        table[part] = whole
    owners = table[torch.where(leaf < 0, len(table) - 1, leaf.to(torch.int64))]
    return [(group, rows[owners == group]) for group in _in_order(owners)]


def _in_order(owners: Tensor) -> list[int]:
    found = sorted(int(g) for g in torch.unique(owners))
    return [g for g in found if g >= 0] + [g for g in found if g < 0]


def _owners(scene: Scene, selection: Selection) -> dict[int, int]:
    """Which thing each leaf belongs to: the selected group that holds it, or its object."""
    if scene.language is None:
        return {}
    asked = set(selection.groups)
    owner = {}
    for group in scene.language.groups:
        whole = group.parent if group.parent >= 0 else group.id
        owner[group.id] = group.id if group.id in asked and group.parent not in asked else whole
    return owner


def _body(scene: Scene, rows: Tensor, group: int) -> Body:
    known = scene.language.groups[group] if scene.language is not None and group >= 0 else None
    points = solid_points(scene.cloud, rows)
    # The field's box was oriented with care when the scene was embedded; its axes are kept, its extents measured anew.
    axes = known.box.axes if known is not None else None
    return Body(rows, group, contact_box(points, scene.frame, axes), known.label if known is not None else "")


def groups_of(bodies: Sequence[Body]) -> set[int]:
    """Ids of the bodies' objects and of those on them."""
    return {g for body in bodies for g in (body.group, *body.riders)}


def mask_of_bodies(scene: Scene, bodies: Sequence[Body]) -> Tensor:
    """`[N]` bool: the Gaussians of the bodies."""
    mask = torch.zeros(len(scene.cloud), dtype=torch.bool, device=scene.cloud.device)
    for body in bodies:
        mask[body.rows] = True
    return mask


def contact_box(points: Array, frame: Frame, axes: Axes | None = None) -> Box:
    """Upright box around points `[M, 3]`, along `axes` or with the smallest footprint: where a thing meets others.

    The box of the language field leaves out a hundredth at each end, as stray splats would widen it; the foot of a
    chair is less than that, and it is what stands on the floor, so here almost every solid point counts.

    Raises:
        InstructionError: there are no points.
    """
    if not len(points):
        raise InstructionError("nothing is left of the target: it has no Gaussians")
    if axes is None:
        axes = level_axes(points[:: max(1, len(points) // _CALIPERS)], frame)
    low, high = np.array([reach(points @ a) for a in np.array(axes)]).T
    thin = np.maximum(1e-9 - (high - low), 0.0)
    return box_along(axes, low, high + thin)


def as_vec(values: Array) -> Vec3:
    """Three floats."""
    x, y, z = (float(v) for v in values)
    return (x, y, z)


def heading(viewer: Camera, frame: Frame, direction: Direction) -> Array:
    """`[3]` unit vector of a direction as the viewer says it, levelled to the ground; up and down are the scene's."""
    up = frame.up_vector
    stand = viewer_stand(viewer, up, 1.0)
    table = {"right": stand.right, "forward": stand.forward, "up": up}
    opposite: dict[Direction, str] = {"left": "right", "backward": "forward", "down": "up"}
    return -table[opposite[direction]] if direction in opposite else table[direction]


def turned_axes(axes: Axes, matrix: Array, frame: Frame) -> Axes:
    """Axes of an upright box after `x -> matrix @ x`: its first level axis, or the second if that now stands up."""
    first, second, up = *(np.array(axes)[:2] @ matrix.T), frame.up_vector
    level = first - up * (first @ up)
    if np.linalg.norm(level) < 1e-6:
        level = second - up * (second @ up)
    level = level / np.linalg.norm(level)
    return as_axes(np.stack([level, np.cross(up, level), up]))


def neighbours(scene: Scene, but: set[int]) -> list[tuple[str, Box]]:
    """Label and box of each object of the field that still has Gaussians, apart from some group ids."""
    if scene.language is None:
        return []
    return [(g.label, g.box) for g in scene.language.objects() if g.count and g.id not in but]


def centimetre(frame: Frame, extent: float) -> float:
    """One centimetre in scene units; where the scale is unknown, a hundredth of `extent`, a thing's own size."""
    return 0.01 / frame.metres_per_unit if frame.metres_per_unit is not None else extent / 100


def front_of(scene: Scene, body: Body) -> Array | None:
    """`[3]` level unit vector out of a body's front, None where neither its shape nor a wall tells."""
    field = scene.language
    if field is None or body.group < 0:
        return None
    rows = body.rows.cpu().numpy()
    if body.riders:  # what stands on it says nothing about its back
        riders = [leaf for g in body.riders for leaf in field.leaves(g)]
        rows = rows[~np.isin(scene.cloud.group.cpu().numpy()[rows], riders)]
    return facing_in(field, scene.cloud, rows, field.groups[body.group]).front


def turn_to_face(scene: Scene, body: Body, goal: Array) -> tuple[float, tuple[str, ...]]:
    """Degrees about up by which a body must turn so that its front points at `goal` `[3]`, and notes.

    Raises:
        InstructionError: the goal is right above or below it.
    """
    up = scene.frame.up_vector
    way = goal - body.center
    way = way - up * (way @ up)
    if float(np.linalg.norm(way)) < 1e-3 * max(body.box.size):
        raise InstructionError(f"the {body.label or 'thing'} stands where it should turn to: name something else")
    front = front_of(scene, body)
    notes: tuple[str, ...] = ()
    if front is None:
        front = -np.array(body.box.axes[1])
        notes = (f"which way the {body.label or 'thing'} faces cannot be told; the front of its box was turned there",)
    return angle_between(front, way, up), notes


def angle_between(start: Array, end: Array, up: Array) -> float:
    """Degrees counter-clockwise about `up` from one level vector `[3]` to another, in (-180, 180]."""
    return math.degrees(math.atan2(float(np.cross(start, end) @ up), float(start @ end)))

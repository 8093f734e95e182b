"""Where things are and how they stand to each other: bodies, boxes, the viewer's directions, the room.

Knows geometry of a scene and its groups. Refuses to know where things ought to go (see place).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..gaussians.camera import Camera, Vec3
from ..gaussians.errors import InstructionError
from ..gaussians.language.field import Box
from ..gaussians.language.relations import viewer_stand
from ..gaussians.language.selection import Selection
from ..gaussians.scene import Frame, Scene
from .base import Direction
from .measure import reach, solid_points
from .rows import rows_of

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
    """

    rows: Tensor
    group: int
    box: Box
    label: str = ""

    @property
    def center(self) -> Array:
        return np.array(self.box.center)

    def bottom(self, up: Array) -> float:
        """Height of its underside along up."""
        return float(self.center @ up) - self.box.size[2] / 2

    def top(self, up: Array) -> float:
        """Height of its top along up."""
        return float(self.center @ up) + self.box.size[2] / 2

    def foot(self, up: Array) -> Array:
        """`[3]`, centre of the underside of its box."""
        return self.center - up * (self.box.size[2] / 2)


def bodies_of(scene: Scene, selection: Selection) -> list[Body]:
    """The selection split into things, in order of group id; Gaussians outside any group form one body at the end."""
    rows = rows_of(scene.cloud, selection.ids)
    leaf = scene.cloud.group[rows]
    owner = _owners(scene, selection)
    table = torch.full((max([int(leaf.max()), *owner], default=0) + 2,) if len(rows) else (1,), -1, dtype=torch.int64)
    for part, whole in owner.items():
        table[part] = whole
    owners = table[torch.where(leaf < 0, len(table) - 1, leaf.to(torch.int64))]
    return [_body(scene, rows[owners == group], int(group)) for group in _in_order(owners)]


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
    return Body(rows, group, box_of(points, scene.frame, axes), known.label if known is not None else "")


def box_of(points: Array, frame: Frame, axes: tuple[Vec3, Vec3, Vec3] | None = None) -> Box:
    """Upright box around points `[M, 3]`, along `axes` or with the smallest footprint.

    Raises:
        InstructionError: there are no points.
    """
    if not len(points):
        raise InstructionError("nothing is left of the target: it has no Gaussians")
    if axes is None:
        axes = _level_axes(points, frame)
    basis = np.array(axes)
    spans = np.array([reach(points @ a) for a in basis])  # [3, 2]
    center = spans.mean(axis=1) @ basis
    size = np.maximum(spans[:, 1] - spans[:, 0], 1e-9)
    return Box(as_vec(center), axes, as_vec(size))


def _level_axes(points: Array, frame: Frame) -> tuple[Vec3, Vec3, Vec3]:
    """Axes of the smallest footprint rectangle, found to a degree; the level basis itself if it is nearly as small."""
    east, north, up = frame.basis()
    sample = points[:: max(1, len(points) // _CALIPERS)]
    plan = np.stack([sample @ east, sample @ north], axis=1)
    angles = np.radians(np.arange(90))
    x = plan @ np.stack([np.cos(angles), np.sin(angles)])  # [M, 90]
    y = plan @ np.stack([-np.sin(angles), np.cos(angles)])
    spans = [np.ptp(np.quantile(v, [0.005, 0.995], axis=0), axis=0) for v in (x, y)]
    area = spans[0] * spans[1]
    best = int(np.argmin(area))
    angle = angles[best] if area[best] < 0.9 * area[0] else 0.0
    first = np.cos(angle) * east + np.sin(angle) * north
    return as_vec(first), as_vec(np.cross(up, first)), as_vec(up)


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


def extent_along(box: Box, direction: Array) -> float:
    """Full extent of a box along a unit vector."""
    return float(np.abs(np.array(box.axes) @ direction) @ np.array(box.size))


def overlap(a: Box, b: Box) -> float:
    """How deep two upright boxes are in each other, scene units: the shortest way apart, 0 if they do not overlap."""
    gap_up = _penetration(a, b, np.array(a.axes[2]))
    axes = [np.array(v) for v in (*a.axes[:2], *b.axes[:2])]
    return max(0.0, min(gap_up, *(_penetration(a, b, axis) for axis in axes)))


def _penetration(a: Box, b: Box, axis: Array) -> float:
    distance = abs(float((np.array(a.center) - np.array(b.center)) @ axis))
    return (extent_along(a, axis) + extent_along(b, axis)) / 2 - distance


def moved_box(box: Box, matrix: Array, offset: Array, frame: Frame) -> Box:
    """The upright box around a box under `x -> matrix @ x + offset`; exact for turns about up and level stretches."""
    axes = np.array(box.axes) @ matrix.T
    up = frame.up_vector
    level = axes[0] - up * (axes[0] @ up)
    if np.linalg.norm(level) < 1e-6:
        level = axes[1] - up * (axes[1] @ up)
    first = level / np.linalg.norm(level)
    frame_axes = np.stack([first, np.cross(up, first), up])
    half = (axes * np.array(box.size)[:, None]) / 2  # rows: half edges in the world
    size = 2 * np.abs(half @ frame_axes.T).sum(axis=0)
    center = matrix @ np.array(box.center) + offset
    return Box(as_vec(center), (as_vec(first), as_vec(frame_axes[1]), as_vec(up)), as_vec(size))


def shifted_box(box: Box, offset: Array) -> Box:
    """The same box elsewhere."""
    return replace(box, center=as_vec(np.array(box.center) + offset))


def neighbours(scene: Scene, but: set[int]) -> list[tuple[str, Box]]:
    """Label and box of each object of the field that still has Gaussians, apart from some group ids."""
    if scene.language is None:
        return []
    return [(g.label, g.box) for g in scene.language.objects() if g.count and g.id not in but]


def centimetre(frame: Frame, extent: float) -> float:
    """One centimetre in scene units; where the scale is unknown, a hundredth of `extent`, a thing's own size."""
    return 0.01 / frame.metres_per_unit if frame.metres_per_unit is not None else extent / 100

"""Geometry of the selected things: their bodies and boxes, the viewer's directions, and which way a thing faces.

Where a thing goes is decided in place.py.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.camera import Camera, Vec3
from ...gaussians.errors import InstructionError
from ...gaussians.kept import Kept
from ...gaussians.language.field.measure import as_axes, box_along, level_axes, reach, solid_points
from ...gaussians.language.query.selection import Selection
from ...gaussians.language.query.telling import told
from ...gaussians.scene import Frame, Scene
from ...gaussians.world.box import Axes, Box
from ...gaussians.world.core import core_of
from ...gaussians.world.facing import facing_in
from ...gaussians.world.relation_geometry import viewer_stand
from ..cloud_diff import rows_of
from ..operation import Direction

Array = NDArray[np.float64]
_MOST = 0.5  # share of an object's Gaussians from which they stand for it
_CALIPERS = 1500  # points from which the footprint's orientation is found; more do not change it


@dataclass(frozen=True, eq=False)
class Body:
    """One thing that moves as a whole: the selected Gaussians of one object, or those of no object.

    Attributes:
        rows: `[M]` int64 rows of the scene's cloud.
        group: id of its object (or of a part selected alone), -1 if the Gaussians belong to none.
        box: upright oriented box of its solid Gaussians, scene units.
        label: its name, "" if unknown.
        carried: ids of the objects on it whose Gaussians are among `rows`; `box` leaves them out.
        strays: how many selected Gaussians were left out of `rows`, as they lie far from it (see `world.core`).
    """

    rows: Tensor
    group: int
    box: Box
    label: str = ""
    carried: tuple[int, ...] = ()
    strays: int = 0

    @property
    def center(self) -> Array:
        return np.array(self.box.center)

    def foot(self, up: Array) -> Array:
        """`[3]`, centre of the underside of its box."""
        return self.center - up * (self.box.size[2] / 2)


def bodies_of(scene: Scene, selection: Selection) -> list[Body]:
    """The selection split into things, in order of group id.

    Selected Gaussians of other things than those that are selected by their group are regions of colour, or parts: what
    was found as one is one body, whatever the groups are that it reaches over. They come last, with the Gaussians
    outside any group. What lies inside a thing is of the body that is nearest, and its box leaves it out. The last few
    are kept, as an operation and its checks ask for the same.
    """
    return list(_known.get((scene, selection), lambda: tuple(_bodies(scene, selection))))


_known: Kept[tuple[Body, ...]] = Kept(4)


def _bodies(scene: Scene, selection: Selection) -> list[Body]:
    """See `bodies_of`."""
    if selection.enclosed is not None:
        return _with_inside(scene, bodies_of(scene, _without_inside(selection)), selection.enclosed)
    bodies, loose = list[Body](), list[Tensor]()
    for group, rows in rows_by_thing(scene, selection):
        if group >= 0 and (group in selection.groups or _is_most_of(scene, group, rows)):
            bodies.append(body_of(scene, rows, group))
        else:
            loose.append(rows)
    if not loose:
        return bodies
    rows = torch.cat(loose).sort().values if len(loose) > 1 else loose[0]
    label = selection.query.text if scene.language is not None else ""
    return bodies + [body_of(scene, part, -1, label) for part in _regions(scene, selection, rows)]


def _without_inside(selection: Selection) -> Selection:
    assert selection.enclosed is not None
    outer = selection.ids[~torch.isin(selection.ids, selection.enclosed, assume_unique=True)]
    return replace(selection, ids=outer, enclosed=None)


def _with_inside(scene: Scene, bodies: list[Body], inside: Tensor) -> list[Body]:
    """The bodies with the enclosed Gaussians, each in the body whose box is nearest for its size."""
    rows = rows_of(scene.cloud, inside)
    points = scene.cloud.means[rows].to(torch.float64).cpu().numpy()
    reach_of = [np.abs(b.box.local(points)) / np.maximum(np.array(b.box.size), 1e-9) for b in bodies]
    nearest = torch.from_numpy(np.stack([r.max(axis=1) for r in reach_of]).argmin(axis=0)).to(rows.device)
    parts = (rows[nearest == i] for i in range(len(bodies)))
    return [replace(b, rows=torch.cat([b.rows, part]).sort().values) for b, part in zip(bodies, parts, strict=True)]


def _is_most_of(scene: Scene, group: int, rows: Tensor) -> bool:
    """Whether some Gaussians of an object are most of it, so that they stand for it."""
    assert scene.language is not None
    known = scene.language.groups[group]
    return known.level != "structure" and len(rows) >= _MOST * known.count


def _regions(scene: Scene, selection: Selection, rows: Tensor) -> list[Tensor]:
    """The rows of each region that was found, of those that have no group of their own: by the nearest of them."""
    found = [c for c in selection.candidates if c.group < 0 or c.group not in selection.groups]
    if selection.verdict not in ("found", "unconfirmed") or len(found) < 2:
        return [rows]
    means = scene.cloud.means[rows].to(torch.float64).cpu().numpy()
    gaps = np.stack([np.linalg.norm((means - np.array(c.center)) / max(*c.size, 1e-9), axis=1) for c in found])
    nearest = torch.from_numpy(gaps.argmin(axis=0)).to(rows.device)
    return [rows[nearest == i] for i in range(len(found)) if bool((nearest == i).any())]


def rows_by_thing(scene: Scene, selection: Selection) -> list[tuple[int, Tensor]]:
    """The rows `[M]` of each selected thing with its group id, in the order of `bodies_of`."""
    rows = rows_of(scene.cloud, selection.ids)
    leaf = scene.cloud.group[rows]
    owner = _owners(scene, selection)
    table = torch.full((max([int(leaf.max()), *owner], default=0) + 2,) if len(rows) else (1,), -1, dtype=torch.int64)
    for part, whole in owner.items():
        table[part] = whole
    owners = table[torch.where(leaf < 0, len(table) - 1, leaf.to(torch.int64))]
    order = owners.argsort(stable=True)
    groups, counts = torch.unique_consecutive(owners[order], return_counts=True)
    parts = dict(zip(groups.tolist(), torch.split(rows[order], counts.tolist()), strict=True))
    return [(group, parts[group]) for group in sorted(parts, key=lambda g: (g < 0, g))]


def _owners(scene: Scene, selection: Selection) -> dict[int, int]:
    """Group id of the thing that each leaf group belongs to: the selected group that holds it, or its object."""
    if scene.language is None:
        return {}
    asked = set(selection.groups)
    owner = {}
    for group in scene.language.groups:
        whole = group.parent if group.parent >= 0 else group.id
        owner[group.id] = group.id if group.id in asked and group.parent not in asked else whole
    return owner


def body_of(scene: Scene, rows: Tensor, group: int, label: str = "") -> Body:
    """One body of some rows `[M]` of a group (-1: none), without their strays; `label` is for those of no group."""
    known = scene.language.groups[group] if scene.language is not None and group >= 0 else None
    strays = 0
    if known is None or known.level != "structure":  # floors and walls are seen in pieces, between what hides them
        core = core_of(scene.cloud, rows)
        strays = core.strays
        rows = rows[torch.from_numpy(core.belongs).to(rows.device)] if strays else rows
    points = solid_points(scene.cloud, rows)
    # Embedding found good axes for the field's box: they are kept, and the extents are measured again.
    axes = known.box.axes if known is not None else None
    box = contact_box(points, scene.frame, axes)
    return Body(rows, group, box, known.label if known is not None else label, strays=strays)


def strays_note(bodies: Sequence[Body]) -> tuple[str, ...]:
    """A note with the number of selected Gaussians that stay where they are; empty if all of them go along."""
    count = sum(body.strays for body in bodies)
    return (f"{count:,} stray Gaussians far from it stayed where they are",) if count else ()


def groups_of(bodies: Sequence[Body]) -> set[int]:
    """Ids of the bodies' objects and of those on them."""
    return {g for body in bodies for g in (body.group, *body.carried)}


def mask_of_bodies(scene: Scene, bodies: Sequence[Body]) -> Tensor:
    """`[N]` bool: the Gaussians of the bodies."""
    mask = torch.zeros(len(scene.cloud), dtype=torch.bool, device=scene.cloud.device)
    for body in bodies:
        mask[body.rows] = True
    return mask


def contact_box(points: Array, frame: Frame, axes: Axes | None = None) -> Box:
    """Upright box around points `[M, 3]`, along `axes` or with the smallest footprint, for contact with other things.

    The box of the language field leaves out a hundredth of the points at each end, because stray Gaussians would widen
    it. The feet of a chair are less than that and yet touch the floor, so this box holds almost every solid point.

    Raises:
        InstructionError: there are no points.
    """
    if not len(points):
        raise InstructionError("nothing is left of the target: it has no Gaussians")
    if axes is None:
        axes = level_axes(points[:: max(1, len(points) // _CALIPERS)], frame)
    low, high = np.array([reach(points @ a) for a in np.array(axes)]).T
    return box_along(axes, low, high + np.maximum(1e-9 - (high - low), 0.0))


def as_vec(values: Array) -> Vec3:
    """Three floats."""
    x, y, z = (float(v) for v in values)
    return (x, y, z)


def heading(viewer: Camera, frame: Frame, direction: Direction) -> Array:
    """`[3]` unit vector of one of the viewer's directions, made horizontal; up and down are the scene's."""
    up = frame.up_vector
    stand = viewer_stand(viewer, up, 1.0)
    table = {"right": stand.right, "forward": stand.forward, "up": up}
    opposite: dict[Direction, str] = {"left": "right", "backward": "forward", "down": "up"}
    return -table[opposite[direction]] if direction in opposite else table[direction]


def turned_axes(axes: Axes, matrix: Array, frame: Frame) -> Axes:
    """Upright axes of a box after `x -> matrix @ x`, from its first horizontal axis, or the second if that is vertical
    now."""
    first, second, up = *(np.array(axes)[:2] @ matrix.T), frame.up_vector
    level = first - up * (first @ up)
    if np.linalg.norm(level) < 1e-6:
        level = second - up * (second @ up)
    level = level / np.linalg.norm(level)
    return as_axes(np.stack([level, np.cross(up, level), up]))


def neighbours(scene: Scene, but: set[int]) -> list[tuple[str, Box]]:
    """Name (see `told`) and box of each object of the field that still has Gaussians, without the group ids `but`."""
    if scene.language is None:
        return []
    field = scene.language
    return [(told(field, g) if g.label else "", g.box) for g in field.objects() if g.count and g.id not in but]


def centimetre(frame: Frame, extent: float) -> float:
    """One centimetre in scene units; where the scale is unknown, a hundredth of `extent`, a thing's own size."""
    return 0.01 / frame.metres_per_unit if frame.metres_per_unit is not None else extent / 100


def told_length(frame: Frame, length: float) -> str:
    """A length in scene units as a person is told: "0.4 m", or "0.4 units" where the scale is unknown."""
    scale = frame.metres_per_unit
    return f"{abs(length) * scale:.2g} m" if scale is not None else f"{abs(length):.2g} units"


def front_of(scene: Scene, body: Body) -> Array | None:
    """`[3]` horizontal unit vector out of a body's front; None where neither its shape nor a wall tells it."""
    field = scene.language
    if field is None or body.group < 0:
        return None
    rows = body.rows.cpu().numpy()
    if body.carried:  # objects on it say nothing about its front
        carried = [leaf for g in body.carried for leaf in field.leaves(g)]
        rows = rows[~np.isin(scene.cloud.group.cpu().numpy()[rows], carried)]
    return facing_in(field, scene.cloud, rows, field.groups[body.group]).front


def turn_to_face(scene: Scene, body: Body, goal: Array) -> tuple[float, tuple[str, ...]]:
    """Degrees about up by which a body must turn so that its front points at `goal` `[3]`, and notes.

    Raises:
        InstructionError: the goal is directly above or below the body.
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
    """Degrees counter-clockwise about `up` from one horizontal vector `[3]` to another, in (-180, 180]."""
    return math.degrees(math.atan2(float(np.cross(start, end) @ up), float(start @ end)))

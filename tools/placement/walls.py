"""Limits of a move by a distance: how far a thing can go before it meets a wall, and whether it leaves the room.

Walls and ceilings come from the language field. Floors are no obstacles: things touch them, and an instruction may
push a thing down through the floor.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.errors import InstructionError
from ...gaussians.rows import rows_where
from ...gaussians.scene import Scene
from ...gaussians.world.box import Box
from .bodies import Array, Body, centimetre
from .occupancy import obstacle_points

_FLOORS = frozenset({"floor", "ground"})
_MIN_POINTS = 8  # points in the way; fewer are floaters
_QUANTILE = 0.02  # share of the points in the way that may lie before the wall, because walls are rough
_SLACK = 0.25  # share of a thin side that may reach into the wall it hangs on, at each end


def require_clear_path(scene: Scene, bodies: list[Body], offsets: list[Array]) -> None:
    """Check that the bodies can move by `offsets` `[3]` each without meeting a wall or leaving the room.

    Raises:
        InstructionError: one cannot; the message says how far it can go.
    """
    barrier = _wall_points(scene)
    for body, offset in zip(bodies, offsets, strict=True):
        length = float(np.linalg.norm(offset))
        if length < 1e-9 or scene.language is None or _is_structure(scene, body):
            continue
        name = body.label or "thing"
        cm = centimetre(scene.frame, max(body.box.size))
        free = free_share(_shrunk(body.box, cm), barrier, offset)
        if free is not None and (1 - free) * length > cm:
            units = "m" if scene.frame.metres_per_unit is not None else "units"
            left = np.floor(100 * free * length * (scene.frame.metres_per_unit or 1.0)) / 100  # a distance that works
            raise InstructionError(f"the {name} would go through a wall: it can move {left:.2f} {units} that way")
        if _leaves_room(scene, body, offset):
            raise InstructionError(f"the {name} would leave the room: give a shorter distance")


def clear_length(scene: Scene, body: Body, offset: Array) -> float:
    """How far of an offset `[3]` a body can move before it meets a wall, scene units."""
    length = float(np.linalg.norm(offset))
    if length < 1e-9 or scene.language is None or _is_structure(scene, body):
        return length
    cm = centimetre(scene.frame, max(body.box.size))
    free = free_share(_shrunk(body.box, cm), _wall_points(scene), offset)
    return length if free is None else max(0.0, free * length - cm)


def free_share(box: Box, points: NDArray[np.float32], offset: Array) -> float | None:
    """Share of `offset` `[3]` by which a box can move before it meets the surface `points` `[M, 3]`; None if all of it.

    Points inside the box at the start are ignored. In the box's frame every other point moves along a straight line,
    and the slab method (Kay & Kajiya 1986) finds where that line enters the box.
    """
    if not len(points):
        return None
    start, step = box.local(points), -np.array(box.axes) @ offset  # the points' motion in the box's frame
    half = np.array(box.size) / 2
    safe = np.where(np.abs(step) < 1e-12, 1e-12, step)
    near, far = (-np.sign(safe) * half - start) / safe, (np.sign(safe) * half - start) / safe
    enter, leave = near.max(axis=1), far.min(axis=1)
    met = enter[(enter > 0) & (enter < 1) & (enter < leave)]
    return float(np.quantile(met, _QUANTILE)) if len(met) >= _MIN_POINTS else None


def _wall_points(scene: Scene) -> NDArray[np.float32]:
    """`[M, 3]` points of the walls and the ceiling."""
    field = scene.language
    walls = [] if field is None else [g for g in field.groups if g.level == "structure" and g.label not in _FLOORS]
    if field is None or not walls:
        return np.zeros((0, 3), dtype=np.float32)
    flags = torch.zeros(len(field.groups) + 1, dtype=torch.bool, device=scene.cloud.device)  # the last: no group
    flags[[leaf for g in walls for leaf in field.leaves(g.id)]] = True
    return obstacle_points(scene.cloud[rows_where(flags[scene.cloud.group])])


def _leaves_room(scene: Scene, body: Body, offset: Array) -> bool:
    """Whether the middle of a body leaves the plan of the floor and walls; False if no floor is known."""
    groups = () if scene.language is None else scene.language.groups
    found = [g for g in groups if g.level == "structure" and g.count]
    if not any(g.label in _FLOORS for g in found):
        return False
    level = scene.frame.basis()[:2]
    plan = np.concatenate([g.box.corners() for g in found]) @ level.T
    low, high = plan.min(axis=0), plan.max(axis=0)
    was, now = level @ body.center, level @ (body.center + offset)
    return bool(((was >= low) & (was <= high)).all() and ((now < low) | (now > high)).any())


def _is_structure(scene: Scene, body: Body) -> bool:
    assert scene.language is not None
    return body.group >= 0 and scene.language.groups[body.group].level == "structure"


def _shrunk(box: Box, centimetre: float) -> Box:
    """The box without the margin that may touch a wall: three centimetres, or a quarter of a thin side, at each end."""
    size = np.array(box.size)
    left = size - 2 * np.minimum(3 * centimetre, _SLACK * size)
    return Box(box.center, box.axes, (float(left[0]), float(left[1]), float(left[2])))

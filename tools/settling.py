"""Let things that lost what they stood on come down on what is below them, or on what was put in its place."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ..gaussians.language.field.measure import reach, solid_points
from ..gaussians.scene import Scene
from .carried_objects import MAX_NAMED, Stack
from .cloud_diff import Draft, rows_of
from .field_update import after_move
from .operation import Affine
from .placement.bodies import Array, centimetre, contact_box, told_length
from .placement.occupancy import column_of, obstacle_points
from .transform import shift

_FEET = 0.06  # of its height: the lowest part of a thing, on which it stands
_CELLS = 10  # along each side of the footprint of its feet, in which the surface below is measured
_FILLED = 0.15  # share of these cells that a surface must fill
_HIGHEST = 0.75  # quantile of the heights of the cells at which a thing comes to rest


def settle(scene: Scene, stacks: Sequence[Stack], rise: float = 0.0) -> tuple[Scene, tuple[Affine, ...], str]:
    """The scene with each stack on the surface under it; the map of each one that moved, and a note ("" if none did).

    Args:
        scene: without what the stacks stood on.
        stacks: lowest first; one that would come down by more than it may stays where it is.
        rise: how far a stack may also come up, onto something taller in the old place, scene units.
    """
    moved, told = list[Affine](), list[str]()
    for stack in stacks:
        rows = rows_of(scene.cloud, stack.ids)
        way = _way_down(scene, rows, rows_of(scene.cloud, stack.foot), rise)
        if way is None or -way[0] > stack.most:
            continue
        step, support = way
        offset = scene.frame.up_vector * step
        draft = Draft(scene.cloud)
        shift(draft, rows, offset)
        cloud = draft.done()
        foot = rows_of(scene.cloud, stack.foot)
        rest = rows[~torch.isin(rows, foot)]
        asked = [Affine(foot, np.eye(3), offset, foot, support)]  # what stands on it may reach lower than its feet
        asked += [Affine(rest, np.eye(3), offset, rest)] if len(rest) else []
        scene = scene.replace(cloud=cloud, language=after_move(scene, cloud, asked))
        moved += asked
        told.append(f"{stack.label or 'something'} ({told_length(scene.frame, step)} {'down' if step < 0 else 'up'})")
    more = f" and {len(told) - MAX_NAMED} more" if len(told) > MAX_NAMED else ""
    note = f"what stood on it now stands on what is below: {', '.join(told[:MAX_NAMED])}{more}" if told else ""
    return scene, tuple(moved), note


def _way_down(scene: Scene, rows: Tensor, foot: Tensor, rise: float) -> tuple[float, float] | None:
    """How far along up a stack moves until it stands, and the height of the surface there; None if it stands already,
    or nothing is below it."""
    up = scene.frame.up_vector
    points = solid_points(scene.cloud, foot)
    low, high = reach(points @ up)
    extent = max(float(np.ptp(points @ a)) for a in scene.frame.basis())
    slack = max(2 * centimetre(scene.frame, extent), 0.03 * (high - low))
    feet = points[points @ up <= low + max(_FEET * (high - low), slack)]
    box = contact_box(feet, scene.frame)
    own = torch.zeros(len(scene.cloud), dtype=torch.bool, device=scene.cloud.device)
    own[rows] = True
    others = obstacle_points(scene.cloud, own, column_of(scene.cloud, box))
    under = others[box.covers(others)]
    under = under[under @ up.astype(np.float32) <= low + slack + rise]
    support = surface_below(box.local(under)[:, :2] / np.maximum(np.array(box.size[:2]), 1e-9), under @ up)
    floor = scene.frame.floor
    if support is None or (floor is not None and support < floor):
        support = floor if floor is not None and floor <= low + slack + rise else support
    if support is None or abs(support - low) <= slack:
        return None
    return support - low, support


def surface_below(plan: Array, heights: NDArray[np.floating]) -> float | None:
    """Height at which a footprint comes to rest on points under it; None if they are too few to be a surface.

    Args:
        plan: `[M, 2]` where they lie in the footprint, from -0.5 to 0.5.
        heights: `[M]` along up.
    """
    if not len(heights):
        return None
    cells = np.clip(((plan + 0.5) * _CELLS).astype(np.intp), 0, _CELLS - 1)
    tops = np.full(_CELLS * _CELLS, -np.inf)
    np.maximum.at(tops, cells[:, 0] * _CELLS + cells[:, 1], heights)
    filled = tops[np.isfinite(tops)]
    if len(filled) < _FILLED * len(tops):
        return None
    return float(np.quantile(filled, _HIGHEST))

"""Checks of what stays on its spot: the pivot of a turn, the foot of a thing that is scaled, the place of a new one."""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor

from ...gaussians.language.field.measure import reach, solid_points
from ...gaussians.world.box import Box
from ...gaussians.world.core import core_of
from ..placement.bodies import Array, Body
from ..placement.occupancy import points_inside
from ..receipt import Check, at_most
from .case import Case
from .standing import other_points

_SPOT = 0.05  # of its size: how far a pivot or foot may move
_LEVEL = 0.03  # of its height, and at least 2 cm: by how much an underside may rise or sink
_SAMPLE = 20_000  # Gaussians from which a map is found
_OFF, _CROWDED = 0.6, 1.5  # half extents of old and new thing together between their middles; where others stand there
_BLOCKED = 0.01  # share of the points of a new thing that others may have where the old one stood


def pivot_kept(case: Case, body: Body, rotation: Array) -> tuple[Check, ...]:
    """A thing that turned did so about its middle, and is as high as before.

    The middle is that of its box or of its solid Gaussians, whichever moved less: regions are turned about the latter.
    """
    before = solid_points(case.before.cloud, body.rows)
    was, now = _means(case, body.rows)
    up, size = case.before.frame.up_vector, max(body.box.size)
    drifts = []
    for pivot in (body.center, before.mean(axis=0)):
        way = rotation @ (pivot - was.mean(axis=0)) + now.mean(axis=0) - pivot
        drifts.append(float(np.linalg.norm(way - up * (way @ up))))
    drift = min(drifts) / max(size, 1e-30)
    said = f"the middle about which it turned moved by {drift:.1%} of its size"
    return at_most("turned on the spot", drift, _SPOT, "1", said), underside_kept(case, body)


def underside_kept(case: Case, body: Body) -> Check:
    """The underside of a thing that was turned or scaled is where it was, measured on the same solid Gaussians."""
    up = case.before.frame.up_vector
    solid = body.rows[torch.from_numpy(core_of(case.before.cloud, body.rows).solid)]
    (low, high), (now_low, now_high) = (reach(points @ up) for points in _means(case, solid))
    height = max(high - low, now_high - now_low)
    bound = max(_LEVEL * height, 2 * case.cm(height))
    off = now_low - low
    return at_most(
        "as high as before", abs(off), bound, "units", f"its underside is {off:+.3g} units from where it was"
    )


def foot_kept(case: Case, body: Body) -> Check:
    """The middle of the underside of a thing that was scaled is where it was."""
    was, now = _means(case, body.rows)
    a, b = was - was.mean(axis=0), now - now.mean(axis=0)
    matrix = (np.linalg.pinv(a) @ b).T
    foot = body.foot(case.before.frame.up_vector)
    size = max(*body.box.size, *case.box_after(case.now(body.rows)).size)
    drift = float(np.linalg.norm(matrix @ (foot - was.mean(axis=0)) + now.mean(axis=0) - foot)) / max(size, 1e-30)
    return at_most("scaled on the spot", drift, _SPOT, "1", f"its foot moved by {drift:.1%} of its size")


def _means(case: Case, rows: Tensor) -> tuple[Array, Array]:
    """Centres `[M, 3]` before and after of a sample of the rows that are still there, scene units."""
    kept = rows[case.changes.row[rows] >= 0]
    kept = kept[:: max(1, len(kept) // _SAMPLE)]
    was, now = case.before.cloud.means[kept], case.after.cloud.means[case.changes.row[kept]]
    return was.to(torch.float64).cpu().numpy(), now.to(torch.float64).cpu().numpy()


def in_its_place(case: Case, rows: Tensor, box: Box) -> Check:
    """A new thing, rows of the cloud after, stands where the old one stood; a little aside if others reach in there."""
    up = case.before.frame.up_vector
    ways = [np.array(b.center) - np.array(box.center) for b in case.bodies]
    ways = [way - up * (way @ up) for way in ways]
    nearest = int(np.argmin([np.linalg.norm(w) for w in ways]))
    old = case.bodies[nearest].box
    off = float(np.linalg.norm(ways[nearest])) / max(0.5 * (max(box.size[:2]) + max(old.size[:2])), 1e-30)
    bound = _OFF
    if off > _OFF and _is_taken(case, rows, box, ways[nearest]):
        bound = _CROWDED
    told = f"it stands {float(np.linalg.norm(ways[nearest])):.3g} units from where the old one stood"
    return at_most("in its place", off, bound, "1", told)


def _is_taken(case: Case, rows: Tensor, box: Box, way: Array) -> bool:
    """Whether other things reach into a thing that is shifted by `way`."""
    points = solid_points(case.after.cloud, rows) + way
    clear = min(max(0.15 * box.size[2], 1e-9), 4 * case.cm(max(box.size)))
    there = box.shifted(way)
    inside = points_inside(points, other_points(case, rows, there.bounds()), there, clear)
    return inside > max(_BLOCKED * len(points), 3.0)

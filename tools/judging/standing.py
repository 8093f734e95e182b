"""Checks of where things are: on something, free of collisions, in the asked relation, moved as asked."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import scipy
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.language.field.language_field import Group
from ...gaussians.language.field.measure import solid_points
from ...gaussians.language.query.query import Query
from ...gaussians.rows import rows_where
from ...gaussians.world import kinds, relations
from ...gaussians.world.box import Box, distance
from ...gaussians.world.relation_geometry import HOLDS, Stand, object_stand, viewer_stand
from ..operation import Placement
from ..placement.bodies import Array, bodies_of, contact_box, front_of
from ..placement.occupancy import column_of, obstacle_points, points_inside
from ..placement.place import WALL_WORDS
from ..placement.surroundings import FLOOR_WORDS
from ..receipt import Check, at_least, at_most, report
from .case import Case

_FEET = 0.05  # of its height: the lowest part of a thing, on which it stands
_AIR = 4.0  # centimetres between a thing and what carries it: cushions are soft, and boxes miss thin feet
_CAPTURED = 0.1  # of its size: the same where the scale is unknown, as the surfaces of captures are thick
_THICK = 0.25  # of the height of what a thing stands on in a capture: error of the top of its box
_AT_WALL = 8.0  # centimetres between a thing that hangs and what it hangs on: brackets and frames
_SURFACE = 0.02  # share of the points under a thing that must be at its underside
_FEW = (2, 7)  # least and most number of such points that do not count: stray ones
_SPARSE = 12  # points under a thing below which two make a surface
_RELATED = 0.35 * HOLDS  # score from which an asked relation is accepted: boxes measured twice differ a little
_CROWDED = 0.3  # the same where there is little room, which the operation tells
_INSIDE = 0.01  # share of a thing's points that others may have within it


def stands(case: Case, rows: Tensor, label: str) -> Check:
    """Gap between a thing and what carries it: the surface below it, or whatever it touches if it hangs.

    Args:
        rows: of the cloud after.
        label: its kind; things for walls and ceilings need only touch something.
    """
    points, box = solid_points(case.after.cloud, rows), case.box_after(rows)
    known, reach = kinds.find(label) if label else None, max(box.size)
    hung = known.support if known is not None and known.support in ("wall", "ceiling") else ""
    if hung == "ceiling":
        others = other_points(case, rows, column_of(case.after.cloud, box))
        above = others[box.covers(others)]
        others = above[above @ case.after.frame.up_vector > box.top(case.after.frame.up_vector) - 0.1 * box.size[2]]
        if not len(others):
            return report("carried", 0.0, "units", "the scene shows no ceiling above it")
    elif hung:
        others = other_points(case, rows, _around(points))
    gap = _nearest(points, others) if hung else _gap_below(case, rows, points, box)
    captured = case.before.frame.metres_per_unit is None
    standing = _CAPTURED * max(reach, box.size[2]) if captured else max(_AIR * case.cm(reach), _FEET * box.size[2])
    bound = _AT_WALL * case.cm(reach) if hung else standing
    if captured and not hung and gap > bound:
        gap, bound = _over_anchor(case, box, gap, bound)
    if math.isinf(gap) or (captured and gap > bound and case.bodies):
        return _level(case, box, bound)
    return at_most("carried", gap, bound, "units", f"{gap:.3g} units lie between it and what carries it")


def _over_anchor(case: Case, box: Box, gap: float, bound: float) -> tuple[float, float]:
    """The gap and its bound by the box of what a thing of a capture was put on: a small thing may stand where no
    Gaussian of a large surface has its centre."""
    place, up = getattr(case.op, "place", None), case.before.frame.up_vector
    if not isinstance(place, Placement) or place.relation != "on":
        return gap, bound
    for anchor in _anchors(case, place):
        apart, thick = abs(box.bottom(up) - anchor.box.top(up)), _THICK * anchor.box.size[2]
        if bool(anchor.box.covers(np.array([box.center]))[0]) and apart <= max(bound, thick):
            return apart, max(bound, thick)
    return gap, bound


def _level(case: Case, box: Box, bound: float) -> Check:
    """Where the scene shows nothing that carries a new thing, it is as high as what it was copied from or replaces."""
    up = case.before.frame.up_vector
    if not case.bodies:
        return report("carried", 0.0, "units", "the scene shows nothing that could carry it")
    off = min(abs(box.bottom(up) - body.box.bottom(up)) for body in case.bodies)
    return at_most(
        "carried", off, bound, "units", f"nothing is seen below it; it is {off:.3g} units off the old height"
    )


def other_points(case: Case, rows: Tensor, within: tuple[Array, Array]) -> NDArray[np.float32]:
    """Solid points of everything that the edit left where it was, from one world corner to another."""
    own = torch.zeros(len(case.after.cloud), dtype=torch.bool, device=case.after.cloud.device)
    own[rows] = True
    own[case.now(rows_where(case.free & case.changes.any))] = True  # what stands on it went along
    return obstacle_points(case.after.cloud, own, within)


def _nearest(points: Array, others: NDArray[np.float32]) -> float:
    """Smallest distance of a thing's points to solid points near its box."""
    low, high = _around(points)
    near = others[((others > low) & (others < high)).all(axis=1)]
    if not len(near):
        return math.inf
    sample = points[:: max(1, len(points) // 2000)]
    distance = scipy.spatial.cKDTree(near).query(sample)[0]
    return float(np.quantile(distance, 0.01))


def _around(points: Array) -> tuple[Array, Array]:
    """Corners of the box around a thing's points, padded by half its largest side."""
    low, high = points.min(axis=0), points.max(axis=0)
    pad = 0.5 * float((high - low).max()) + 1e-9
    return low - pad, high + pad


def _gap_below(case: Case, rows: Tensor, points: Array, box: Box) -> float:
    """Distance between a thing's underside and the nearest surface under its footprint, above it or below."""
    up = case.after.frame.up_vector
    own = points @ up
    low = float(np.quantile(own, 0.002))
    # What carries it is under its feet, not under an arm that reaches out.
    feet = points[own < low + max(_FEET * box.size[2], 2 * case.cm(max(box.size)))]
    base = contact_box(feet, case.after.frame, box.axes)
    slack = max(0.25 * box.size[2], 0.02 * max(box.size))
    others = other_points(case, rows, column_of(case.after.cloud, base))
    gaps = _gaps(case, base, others, low, slack)
    # Several points make a surface: a single stray one carries nothing. A cushion is touched by a part of it only.
    enough = int(np.clip(_SURFACE * len(gaps), *_FEW)) if len(gaps) >= _SPARSE else 1
    gap = float(gaps[enough]) if len(gaps) > enough else math.inf
    floor = case.after.frame.floor
    return gap if floor is None else min(gap, abs(low - floor))


def _gaps(case: Case, base: Box, others: NDArray[np.float32], low: float, slack: float) -> Array:
    """`[K]` distances of the points over and under a footprint from the height `low`, ascending, without what is higher
    by more than `slack`."""
    heights = others[base.covers(others)] @ case.after.frame.up_vector.astype(np.float32)
    return np.sort(np.abs(heights[heights < low + slack] - low)).astype(np.float64)


def free_of_others(case: Case, rows: Tensor) -> Check:
    """Solid points of other things within a placed thing."""
    points = solid_points(case.after.cloud, rows)
    box = case.box_after(rows)
    clear = max(0.15 * box.size[2], 1e-9)
    if case.after.frame.metres_per_unit is not None:  # floors of captures are noisy
        clear = min(clear, 4 * case.cm(max(box.size)))
    inside = points_inside(points, other_points(case, rows, box.bounds()), box, clear)
    bound = max((_CROWDED if case.crowded else _INSIDE) * len(points), 3.0)
    return at_most("free of others", inside, bound, "Gaussians", f"{inside} points of other things are inside it")


def in_relation(case: Case, place: Placement, rows: Tensor) -> Check | None:
    """The asked relation holds between a thing's measured box and the things that the words name, asked anew.

    None for places that boxes alone do not decide: the room's middle and corners, walls.
    """
    kind = relations.named(place.relation)
    name = place.relation if kind.score is not None else (kind.query_as or "")
    words = {a.text.lower() for a in place.anchors}
    if not place.anchors or words & (FLOOR_WORDS | WALL_WORDS) or not name or relations.named(name).score is None:
        return None
    anchors = _anchors(case, place)
    if not anchors:
        return report("placed as asked", 0.0, "1", "what the place is related to was not found")
    box = case.box_after(rows)
    field = case.before.language
    assert field is not None
    stand = viewer_stand(case.context.viewer, case.before.frame.up_vector, field.typical_size, field.middle)
    score = 0.0
    for frame in (stand, *_own_frames(case, anchors[0], stand)):
        thing = replace(anchors[0], level="object", box=box)
        score = max(score, float(relations.score(name, thing, anchors, frame)))
    score = max(score, _beside(box, anchors[0].box, case) if name == "next_to" else 0.0)
    if name == "on":  # a box that is a little too high or too low does not count against it
        score = max(score, float(_rests_on(case, box, anchors)))
    if name == "above":  # on the wall behind it counts, as long as it hangs higher
        up = case.before.frame.up_vector
        score = max(score, float(box.bottom(up) > anchors[0].box.top(up) - _FEET * box.size[2]))
    return at_least("placed as asked", score, _RELATED, "1", f"{place.describe()} holds with a score of {score:.2f}")


def _rests_on(case: Case, box: Box, anchors: list[Group]) -> bool:
    """Whether the middle of a box lies over one of the anchors, and its underside in their upper half or above."""
    up = case.before.frame.up_vector
    foot = np.array(box.center) - up * (box.size[2] / 2)
    for anchor in anchors:
        x, y, z = anchor.box.local(foot[None])[0] / np.maximum(np.array(anchor.box.size), 1e-9)
        if max(abs(x), abs(y)) <= 0.5 and 0 <= z <= 1:
            return True
    return False


def _anchors(case: Case, place: Placement) -> list[Group]:
    """The groups that a placement names in the scene before, with their boxes as they are after the edit."""
    field = case.before.language
    found: list[Group] = []
    if field is None:
        return found
    for query in place.anchors:
        selection = case.context.resolve(case.before, query)
        found += [field.groups[g] for g in selection.groups] if selection.chosen else []
    return found


def _own_frames(case: Case, anchor: Group, stand: Stand) -> tuple[Stand, ...]:
    """The anchor's own frame, if it can be told which way it faces."""
    found = case.context.resolve(case.before, Query(groups=(anchor.id,)))
    body = next(iter(bodies_of(case.before, found)), None) if found.chosen else None
    front = None if body is None else front_of(case.before, body)
    return () if front is None else (object_stand(anchor, front, stand),)


def _beside(box: Box, anchor: Box, case: Case) -> float:
    """1 for things whose gap is at most half a metre, as beside a large table."""
    return 1.0 if distance(box, anchor) <= 50 * case.cm(max(box.size)) else 0.0


def rigid_motion(case: Case, rows: Tensor) -> tuple[Array, Array, float] | None:
    """Rotation `[3, 3]`, displacement `[3]` of the middle and the RMS residual of Gaussians that stayed (Kabsch 1976).

    None if fewer than four of them stayed.
    """
    return case.motions.get((rows,), lambda: _rigid_motion(case, rows))


def _rigid_motion(case: Case, rows: Tensor) -> tuple[Array, Array, float] | None:
    """See `rigid_motion`."""
    kept = rows[case.changes.row[rows] >= 0]
    if len(kept) < 4:
        return None
    was = case.before.cloud.means[kept].to(torch.float64).cpu().numpy()
    now = case.after.cloud.means[case.changes.row[kept]].to(torch.float64).cpu().numpy()
    a, b = was - was.mean(axis=0), now - now.mean(axis=0)
    u, _, vt = np.linalg.svd(a.T @ b)
    sign = np.diag([1.0, 1.0, float(np.sign(np.linalg.det(vt.T @ u.T)))])
    rotation = vt.T @ sign @ u.T
    residual = float(np.sqrt(((a @ rotation.T - b) ** 2).sum(axis=1).mean()))
    return rotation, now.mean(axis=0) - was.mean(axis=0), residual


def turned_by(rotation: Array, axis: Array) -> float:
    """Degrees counter-clockwise about a unit axis of a rotation, in (-180, 180]."""
    sine = np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]])
    return math.degrees(math.atan2(float(sine @ axis) / 2, (float(np.trace(rotation)) - 1) / 2))

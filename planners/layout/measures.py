"""Measures of wishes: whether each kind of wish holds between boxes, and its cost, at one position or many at once.

Relations that queries share are measured here with fewer operations than in `gaussians.world.relation_geometry`. The
tolerances are the same less a margin, because the checker of scene graphs decides in the end; a test compares the two.
A relation without a measure here is judged by that geometry itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ...gaussians.world import relations
from ...gaussians.world.box import Boxes, YawBox, plan_gap, plan_share, to_world
from ...gaussians.world.relation_geometry import CLOSE, ENDS, FACES, FOOTPRINT, HOLDS, Stand, Things

Measured = tuple[Any, Any]  # whether it holds; how far it is from ideal, about 0 to 4
# Margins to the limits at which a relation begins to hold for the checker.
_CONE = HOLDS + 0.03  # cosine
_MIN_SHARE = HOLDS + 0.12  # share of the smaller footprint; the checker counts points of it
_CLOSE = CLOSE - 0.01
_FACES = FACES - 2.0  # degrees
_ENDS, _BULGE = ENDS + 0.05, 0.35  # the latter of the way between two things; "between" ends at 0.42 of it
_INSIDE, _MIN_HEIGHT_SHARE = (
    0.98,
    0.75,
)  # shares of a thing's footprint and of its height that are in what it is inside of
_MAX_AIR = 0.02  # metres of air under a thing on another, as the checker allows for support
_MARGIN = 0.05  # added to the least score of relations without a measure here
NEAR_WALL = 0.1  # metres: largest gap of a thing "against" a wall
CORNER = 0.25  # metres: largest gap to either wall of a thing in their corner
IN_REACH = 0.6  # metres: largest gap of a thing "at" a window
AT_TABLE = 0.4  # metres: largest gap between a thing and the table it stands around
WALLS = ("west", "east", "south", "north")
_INWARD = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))  # direction from each wall into the room
OFF = 0.1  # metres, or share of the distance, that a stated distance may be off
IN_LINE = 0.05  # metres: largest offset between the middles of aligned things
_ROW = np.unique(FOOTPRINT[:, 0])  # one row of the points with which the checker samples footprints
# The viewer looks along +y.
_STAND = Stand(np.eye(3)[0], np.eye(3)[1], np.eye(3)[2], np.array([0.0, -100.0, 1.6]), 1.0)


def measure(
    name: str,
    size: Sequence[float],
    one: YawBox,
    others: Sequence[YawBox],
    windows: Sequence[YawBox],
    wall: str | None = None,
    distance: float | None = None,
) -> Measured:
    """Whether "one name others" holds in a room of `size`, and a cost that grows with the distance from ideal.

    Coordinates of each box may be numbers or arrays of one length. `wall`: the wall that the wish names, if any.
    `distance`: the gap that the wish names, metres.
    """
    if distance is not None:
        return _at_distance(name, size, one, others, windows, wall, distance)
    if wall is not None:
        row = WALLS.index(wall)
        kept, cost = measure(name, size, one, others, [w for w in windows if _wall_of(w, size) == row])
        gap = walls_gaps(one, size)[row]
        if name == "at_window":
            return kept, cost + gap
        turned = one.front[0] * _INWARD[row][0] + one.front[1] * _INWARD[row][1]
        return kept & (gap <= (CORNER if name == "in_corner" else NEAR_WALL)), cost + gap + 0.5 * (1.0 - turned)
    if aim := relations.named(name).aim:
        kept, cost = _in_direction(aim, one, others[0])
        return kept, cost + _off_front(one, others[0]) if name == "in_front_of" else cost
    if name in _PAIRS:
        return _PAIRS[name](one, others[0])
    if name in _ROOM:
        return _ROOM[name](one, size)
    if name == "between":
        return _between(one, *others)
    if name == "far_from":
        apart = np.hypot(one.x - others[0].x, one.y - others[0].y)
        wanted = float(np.hypot(size[0], size[1])) / 2
        return apart >= wanted, np.maximum(1.2 - apart / max(wanted, 1e-9), 0.0)
    if name == "at_window":
        if not windows:
            return np.zeros(np.shape(one.x), bool), 0.0
        gap = np.min([plan_gap(one, w) for w in windows], axis=0)
        return gap <= IN_REACH, gap
    return _scored(name, one, others)


def _at_distance(
    name: str,
    size: Sequence[float],
    one: YawBox,
    others: Sequence[YawBox],
    windows: Sequence[YawBox],
    wall: str | None,
    distance: float,
) -> Measured:
    """The measure of a wish with a stated gap; sides and fronts count as without one."""
    kept: Any = True
    cost: Any = 0.0
    if name == "at_window":
        gap = np.min([plan_gap(one, w) for w in windows], axis=0) if windows else np.inf
    elif not others:
        gaps = walls_gaps(one, size)
        gap = gaps[WALLS.index(wall)] if wall is not None else np.min(gaps, axis=0)
    else:
        gap = plan_gap(one, others[0])
        if relations.named(name).aim or name == "facing":
            kept, cost = measure(name, size, one, others, windows)
    off = np.abs(gap - distance)
    return kept & (off <= np.maximum(OFF, OFF * distance)), cost + 2.0 * off


def _scored(name: str, one: YawBox, others: Sequence[YawBox]) -> Measured:
    """The measure by the geometry of queries and the checker, for relations without a faster measure here."""
    score = relations.named(name).score
    if score is None:
        raise ValueError(f"nothing measures the wish {name}")
    count = max(np.size(v) for s in (one, *others) for v in (s.x, s.y))
    held = score(_things(one, count), [_things(o, count) for o in others], _STAND)
    held = held.reshape(np.broadcast_shapes(*(np.shape(v) for s in (one, *others) for v in (s.x, s.y))))
    return held >= HOLDS + _MARGIN, 4.0 * (1.0 - held)


def _things(spot: YawBox, count: int) -> Things:
    """A box at `count` places."""
    centers, axes = np.empty((count, 3)), np.eye(3)
    centers[:, 0], centers[:, 1], centers[:, 2] = np.ravel(spot.x), np.ravel(spot.y), spot.low + spot.h / 2
    axes[:2, :2] = spot.axes
    sizes = np.broadcast_to(np.array([spot.w, spot.d, spot.h]), (count, 3))
    axes = np.broadcast_to(axes, (count, 3, 3))
    return Things(Boxes(centers, axes, sizes), np.zeros(count, bool))


def _in_direction(aim: tuple[float, float], one: YawBox, other: YawBox) -> Measured:
    """Left, right, in front or behind for a viewer who looks along +y: a cone of 60 degrees to each side."""
    dx, dy = one.x - other.x, one.y - other.y
    reach = np.hypot(dx, dy)
    cosine = (dx * aim[0] + dy * aim[1]) / np.maximum(reach, 1e-9)
    return cosine >= _CONE, 1.0 - cosine + 0.12 * reach


def _off_front(one: YawBox, other: YawBox) -> Any:
    """How far one is from the direction of the other's own front (1 - cosine), added to the viewer's "in front"."""
    dx, dy = one.x - other.x, one.y - other.y
    fx, fy = other.front
    return 1.0 - (dx * fx + dy * fy) / np.maximum(np.hypot(dx, dy), 1e-9)


def _next_to(one: YawBox, other: YawBox) -> Measured:
    sizes = [max(s.w, s.d, s.h) for s in (one, other)]
    gap = np.hypot(plan_gap(one, other), max(one.low - other.high, other.low - one.high, 0.0))
    return gap <= _CLOSE * sum(sizes), 2.0 * gap


def _around(one: YawBox, other: YawBox) -> Measured:
    """One is close to a side of the other, turned to it, and within the length of that side."""
    u, v = other.local(one.x, one.y)
    beyond_u, beyond_v = np.abs(u) - other.w / 2, np.abs(v) - other.d / 2
    su, sv = np.where(beyond_u >= beyond_v, np.sign(u), 0.0), np.where(beyond_u >= beyond_v, 0.0, np.sign(v))
    fx, fy = one.front
    wx, wy = to_world(0.0, 0.0, other.yaw, -su, -sv)
    turned = fx * wx + fy * wy
    gap = plan_gap(one, other)
    aside = np.maximum(np.where(beyond_u >= beyond_v, np.abs(v) - other.d / 2, np.abs(u) - other.w / 2), -0.1) + 0.1
    return (gap <= AT_TABLE) & (turned > 0.85) & (aside <= 0.2), 3.0 * gap + 2.0 * (1.0 - turned) + aside


def is_turned(one: YawBox, other: YawBox, degrees: float) -> Any:
    """Whether the front of one points at the middle of another, within some degrees."""
    dx, dy = other.x - one.x, other.y - one.y
    fx, fy = one.front
    return dx * fx + dy * fy >= np.cos(np.radians(degrees)) * np.hypot(dx, dy) - 1e-9


def _facing(one: YawBox, other: YawBox) -> Measured:
    """The other's middle is within 45 degrees of the front; best straight ahead, facing back, and within 3 m."""
    dx, dy = other.x - one.x, other.y - one.y
    fx, fy = one.front
    reach = np.hypot(dx, dy)
    cosine = (dx * fx + dy * fy) / np.maximum(reach, 1e-9)
    bx, by = other.front
    back = -(dx * bx + dy * by) / np.maximum(reach, 1e-9)
    far = 0.3 * np.maximum(reach - 3.0, 0.0)
    return is_turned(one, other, _FACES), 3.0 * (1.0 - cosine) + 1.0 * (1.0 - back) + far


def _over(upper: YawBox, lower: YawBox) -> Measured:
    held = _overlaps(upper, lower) & (upper.low >= lower.high - 0.01)
    return held, 1.0 - plan_share(upper, lower) + 0.5 * np.hypot(upper.x - lower.x, upper.y - lower.y)


def _on(upper: YawBox, lower: YawBox) -> Measured:
    held, cost = _over(upper, lower)
    return held & (upper.low <= lower.high + _MAX_AIR) & (_covered(upper, lower) >= _MIN_SHARE), cost


def _inside(one: YawBox, other: YawBox) -> Measured:
    within = min(one.high, other.high) - max(one.low, other.low)
    held = (within >= _MIN_HEIGHT_SHARE * one.h) & (other.low <= one.low + one.h / 2 <= other.high)
    return (_covered(one, other) >= _INSIDE) & held, 1.0 - plan_share(one, other)


def _covered(one: YawBox, other: YawBox) -> Any:
    """Share of one's own footprint over another; both are taken as boxes along the axes."""
    (ow, od), (w, d) = one.half, other.half
    return plan_share(one, other) * min(1.0, w * d / max(ow * od, 1e-9))


def _overlaps(one: YawBox, other: YawBox) -> Any:
    """Whether two footprints overlap enough by area, and by sampled points as the checker counts them."""
    points = np.maximum(_point_share(one, other), _point_share(other, one))
    return (plan_share(one, other) >= _MIN_SHARE) & (points >= HOLDS)


def _point_share(of: YawBox, over: YawBox) -> Any:
    """Share of the sampled points of one footprint that lie over another; both are taken as boxes along the axes."""
    counted: Any = 1.0
    for offset, half, reach in zip((of.x - over.x, of.y - over.y), of.half, over.half, strict=True):
        counted = counted * (np.abs(np.asarray(offset)[..., None] + 2 * half * _ROW) <= reach + 1e-9).mean(axis=-1)
    return counted


def _under(one: YawBox, other: YawBox) -> Measured:
    lower = (one.low + one.high < other.low + other.high) & (one.low < other.high - 0.1)
    away = np.hypot(one.x - other.x, one.y - other.y)
    return _overlaps(one, other) & lower, 1.0 - plan_share(one, other) + 0.5 * away


def _aligned(one: YawBox, other: YawBox) -> Measured:
    """The middles are in one line along either of the other's axes, and the yaws are equal."""
    u, v = other.local(one.x, one.y)
    off = np.minimum(np.abs(u), np.abs(v))
    same = abs((one.yaw - other.yaw + 180.0) % 360.0 - 180.0) < 1.0
    return (off <= IN_LINE) & same, np.minimum(2.0 * off, 2.0) + (0.0 if same else 1.0)


def _between(one: YawBox, a: YawBox, b: YawBox) -> Measured:
    """One is in the middle part of the line from one thing to the other and close to it, seen from above."""
    sx, sy = b.x - a.x, b.y - a.y
    length = np.maximum(np.hypot(sx, sy), 1e-9)
    t = ((one.x - a.x) * sx + (one.y - a.y) * sy) / length**2
    aside = np.abs((one.x - a.x) * sy - (one.y - a.y) * sx) / length**2
    return (t > _ENDS) & (t < 1.0 - _ENDS) & (aside < _BULGE), 2.0 * np.abs(t - 0.5) + 2.0 * aside


def walls_gaps(one: YawBox, size: Sequence[float]) -> tuple[Any, Any, Any, Any]:
    """Metres from a footprint to the walls at left, right, front and back of the room."""
    hx, hy = one.half
    return (one.x - hx + size[0] / 2, size[0] / 2 - one.x - hx, one.y - hy + size[1] / 2, size[1] / 2 - one.y - hy)


def _wall_of(one: YawBox, size: Sequence[float]) -> int:
    """The wall nearest to a thing, as a row of `WALLS`."""
    return int(np.argmin([float(g) for g in walls_gaps(one, size)]))


def behind_gap(one: YawBox, size: Sequence[float]) -> Any:
    """Metres from a thing's back to the wall behind it; infinite if its back is not parallel to a wall."""
    fx, fy = one.front
    left, right, front, back = walls_gaps(one, size)
    for along, gap in ((fx, left), (-fx, right), (fy, front), (-fy, back)):
        if along > 0.999:
            return gap
    return np.inf


def _against_wall(one: YawBox, size: Sequence[float]) -> Measured:
    gap = np.min(walls_gaps(one, size), axis=0)
    return gap <= NEAR_WALL, gap + 0.5 * np.minimum(behind_gap(one, size), 1.0)


def _in_corner(one: YawBox, size: Sequence[float]) -> Measured:
    left, right, front, back = walls_gaps(one, size)
    aside, away = np.minimum(left, right), np.minimum(front, back)
    return (aside <= CORNER) & (away <= CORNER), aside + away


def _in_center(one: YawBox, size: Sequence[float]) -> Measured:
    """The middle is within a sixth of the room's width and depth of the room's middle."""
    return (np.abs(one.x) <= size[0] / 6) & (np.abs(one.y) <= size[1] / 6), 1.5 * np.hypot(one.x, one.y)


_PAIRS: dict[str, Callable[[YawBox, YawBox], Measured]] = {
    "next_to": _next_to,
    "around": _around,
    "facing": _facing,
    "above": _over,
    "on": _on,
    "under": _under,
    "below": _under,
    "inside": _inside,
    "aligned_with": _aligned,
}
_ROOM: dict[str, Callable[[YawBox, Sequence[float]], Measured]] = {
    "against_wall": _against_wall,
    "in_corner": _in_corner,
    "in_center": _in_center,
}

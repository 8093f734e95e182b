"""How well each kind of wish is fulfilled by boxes, at one place or at many places at once.

What queries know too is measured here by fewer operations than in `gaussians.world.relation_geometry`, with the same
tolerances less a margin, because the checker of scene graphs has the last word; a test holds the two together. A
relation without such a measure is judged by that geometry itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ...gaussians.world import relations
from ...gaussians.world.box import Boxes, YawBox, plan_gap, plan_share, to_world
from ...gaussians.world.relation_geometry import CLOSE, ENDS, FACES, FOOTPRINT, HOLDS, Stand, Things

Measured = tuple[Any, Any]  # whether it holds; how far it is from ideal, about 0 to 4
# What the solver keeps away from where a relation begins to hold for the checker.
_CONE = HOLDS + 0.03  # cosine
_OVER = HOLDS + 0.12  # share of the smaller footprint; the checker counts points of it
_CLOSE = CLOSE - 0.01
_FACES = FACES - 2.0  # degrees
_ENDS, _BULGE = ENDS + 0.05, 0.35  # the latter of the way between two things; "between" ends at 0.42 of it
_INSIDE, _SUNK = 0.98, 0.75  # shares of a thing's footprint and of its height that are in what it is inside of
_RESTS = 0.02  # metres of air under what is on a thing, as much as the checker allows under what stands
_SPARE = 0.05  # of the score of what has no measure of its own here
NEAR_WALL = 0.1  # metres between a thing and the wall it is against
CORNER = 0.25  # metres to either wall of the corner that a thing is in
IN_REACH = 0.6  # metres from a window: what is at it
AT_TABLE = 0.4  # metres between a thing and what it stands around
WALLS = ("west", "east", "south", "north")
_INWARD = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))  # from each of them
IN_LINE = 0.05  # metres between the middles of aligned things
_ROW = np.unique(FOOTPRINT[:, 0])  # one row of the points by which the checker counts footprints
# A room is looked at along +y; one box is one thing of usual size.
_STAND = Stand(np.eye(3)[0], np.eye(3)[1], np.eye(3)[2], np.array([0.0, -100.0, 1.6]), 1.0)


def measure(
    name: str,
    size: Sequence[float],
    one: YawBox,
    others: Sequence[YawBox],
    windows: Sequence[YawBox],
    wall: str | None = None,
) -> Measured:
    """Whether "one name others" holds in a room of `size`, and a cost that grows with the distance from ideal.

    Coordinates of each box may be numbers or arrays of one length. `wall`: the one that is meant, if one is.
    """
    if wall is not None:
        row = WALLS.index(wall)
        kept, cost = measure(name, size, one, others, [w for w in windows if _wall_of(w, size) == row])
        gap = walls_gaps(one, size)[row]
        if name == "at_window":
            return kept, cost + gap
        turned = one.front[0] * _INWARD[row][0] + one.front[1] * _INWARD[row][1]
        return kept & (gap <= (CORNER if name == "in_corner" else NEAR_WALL)), cost + gap + 0.5 * (1.0 - turned)
    if aim := relations.named(name).aim:
        kept, cost = _beside(aim, one, others[0])
        return kept, cost + _before(one, others[0]) if name == "in_front_of" else cost
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


def _scored(name: str, one: YawBox, others: Sequence[YawBox]) -> Measured:
    """By the geometry that queries and the checker use, for relations without a faster measure here."""
    score = relations.named(name).score
    if score is None:
        raise ValueError(f"nothing measures the wish {name}")
    count = max(np.size(v) for s in (one, *others) for v in (s.x, s.y))
    held = score(_things(one, count), [_things(o, count) for o in others], _STAND)
    held = held.reshape(np.broadcast_shapes(*(np.shape(v) for s in (one, *others) for v in (s.x, s.y))))
    return held >= HOLDS + _SPARE, 4.0 * (1.0 - held)


def _things(spot: YawBox, count: int) -> Things:
    """A box at `count` places."""
    centers, axes = np.empty((count, 3)), np.eye(3)
    centers[:, 0], centers[:, 1], centers[:, 2] = np.ravel(spot.x), np.ravel(spot.y), spot.low + spot.h / 2
    axes[:2, :2] = spot.axes
    sizes = np.broadcast_to(np.array([spot.w, spot.d, spot.h]), (count, 3))
    axes = np.broadcast_to(axes, (count, 3, 3))
    return Things(Boxes(centers, axes, sizes), np.zeros(count, bool))


def _beside(aim: tuple[float, float], one: YawBox, other: YawBox) -> Measured:
    """As the viewer sees it, who looks along +y: a cone of 60 degrees to each side."""
    dx, dy = one.x - other.x, one.y - other.y
    reach = np.hypot(dx, dy)
    cosine = (dx * aim[0] + dy * aim[1]) / np.maximum(reach, 1e-9)
    return cosine >= _CONE, 1.0 - cosine + 0.12 * reach


def _before(one: YawBox, other: YawBox) -> Any:
    """How far one is from being before the other's own front too: best is what both viewer and thing call in front."""
    dx, dy = one.x - other.x, one.y - other.y
    fx, fy = other.front
    return 1.0 - (dx * fx + dy * fy) / np.maximum(np.hypot(dx, dy), 1e-9)


def _next_to(one: YawBox, other: YawBox) -> Measured:
    sizes = [max(s.w, s.d, s.h) for s in (one, other)]
    gap = np.hypot(plan_gap(one, other), max(one.low - other.high, other.low - one.high, 0.0))
    return gap <= _CLOSE * sum(sizes), 2.0 * gap


def _around(one: YawBox, other: YawBox) -> Measured:
    """At a free side, close, turned to it, and square before that side."""
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
    """Whether the front of one looks at the middle of another, within some degrees."""
    dx, dy = other.x - one.x, other.y - one.y
    fx, fy = one.front
    return dx * fx + dy * fy >= np.cos(np.radians(degrees)) * np.hypot(dx, dy) - 1e-9


def _facing(one: YawBox, other: YawBox) -> Measured:
    """The middle within 45 degrees of the front; best straight ahead, looked back at, and not across a hall."""
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
    return held & (upper.low <= lower.high + _RESTS) & (_covered(upper, lower) >= _OVER), cost


def _inside(one: YawBox, other: YawBox) -> Measured:
    within = min(one.high, other.high) - max(one.low, other.low)
    held = (within >= _SUNK * one.h) & (other.low <= one.low + one.h / 2 <= other.high)
    return (_covered(one, other) >= _INSIDE) & held, 1.0 - plan_share(one, other)


def _covered(one: YawBox, other: YawBox) -> Any:
    """Share of one's own footprint over another; both are taken along the axes."""
    (ow, od), (w, d) = one.half, other.half
    return plan_share(one, other) * min(1.0, w * d / max(ow * od, 1e-9))


def _overlaps(one: YawBox, other: YawBox) -> Any:
    """Whether two footprints have enough in common by area, and by points as the checker counts them."""
    points = np.maximum(_points(one, other), _points(other, one))
    return (plan_share(one, other) >= _OVER) & (points >= HOLDS)


def _points(of: YawBox, over: YawBox) -> Any:
    """Share of the points of one footprint that lie over another; both are taken along the axes."""
    counted: Any = 1.0
    for offset, half, reach in zip((of.x - over.x, of.y - over.y), of.half, over.half, strict=True):
        counted = counted * (np.abs(np.asarray(offset)[..., None] + 2 * half * _ROW) <= reach + 1e-9).mean(axis=-1)
    return counted


def _under(one: YawBox, other: YawBox) -> Measured:
    lower = (one.low + one.high < other.low + other.high) & (one.low < other.high - 0.1)
    away = np.hypot(one.x - other.x, one.y - other.y)
    return _overlaps(one, other) & lower, 1.0 - plan_share(one, other) + 0.5 * away


def _aligned(one: YawBox, other: YawBox) -> Measured:
    """In one line, along either of the other's axes, and turned the same way."""
    u, v = other.local(one.x, one.y)
    off = np.minimum(np.abs(u), np.abs(v))
    same = abs((one.yaw - other.yaw + 180.0) % 360.0 - 180.0) < 1.0
    return (off <= IN_LINE) & same, np.minimum(2.0 * off, 2.0) + (0.0 if same else 1.0)


def _between(one: YawBox, a: YawBox, b: YawBox) -> Measured:
    """In the middle part of the way from one to the other, not far off it; heights count as the checker's do not."""
    sx, sy = b.x - a.x, b.y - a.y
    length = np.maximum(np.hypot(sx, sy), 1e-9)
    t = ((one.x - a.x) * sx + (one.y - a.y) * sy) / length**2
    aside = np.abs((one.x - a.x) * sy - (one.y - a.y) * sx) / length**2
    return (t > _ENDS) & (t < 1.0 - _ENDS) & (aside < _BULGE), 2.0 * np.abs(t - 0.5) + 2.0 * aside


def walls_gaps(one: YawBox, size: Sequence[float]) -> tuple[Any, Any, Any, Any]:
    """Metres from a footprint to the walls at left, right, front and back of the room."""
    hx, hy = one.half
    return (
        one.x - hx + size[0] / 2,
        size[0] / 2 - one.x - hx,
        one.y - hy + size[1] / 2,
        size[1] / 2 - one.y - hy,
    )


def _wall_of(one: YawBox, size: Sequence[float]) -> int:
    """The wall nearest to a thing, as a row of `WALLS`."""
    return int(np.argmin([float(g) for g in walls_gaps(one, size)]))


def behind_gap(one: YawBox, size: Sequence[float]) -> Any:
    """Metres from a thing's back to the wall behind it; infinite where no wall is square behind."""
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
    """Within a sixth of the room's width and depth of its middle."""
    off = np.hypot(one.x, one.y)
    return (np.abs(one.x) <= size[0] / 6) & (np.abs(one.y) <= size[1] / 6), 1.5 * off


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

"""Cameras for a layout: an overview, and views at eye height from positions with a long line of sight."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...camera import Camera, Vec3
from ...world.box import YawBox
from ...world.person import EYE_HEIGHT
from .layout import Layout

Array = NDArray[np.float64]
_REACH = np.concatenate([[0.1], 0.2 * np.ones(15)]).cumsum()  # metres along a ray at which it is tested for hits


def cameras(layout: Layout) -> tuple[Camera, ...]:
    """An overview (from outside the open south side where there is one), then the clearest views at eye height."""
    w, d, h = layout.w, layout.d, layout.h
    side = _clearer_side(layout)
    if "south" in layout.walls:
        eye, target, fov = (side * 0.46 * w, -0.47 * d, h - 0.12), (-side * 0.12 * w, 0.15 * d, 0.4), 70.0
    else:
        eye, target, fov = (side * 0.28 * w, -0.5 * d - 2.1, h + 0.25), (-side * 0.03 * w, 0.02 * d, 0.75), 52.0
    return (Camera.look_at(eye, target, (0, 0, 1), 960, 640, fov, "overview"), *eye_views(layout))


def overview(layout: Layout, ceiling: bool) -> Camera:
    """A camera outside the open south side that sees the whole room, from above the walls, or from below a ceiling.

    Its distance from the room grows with the width of the room.
    """
    w, d, h = layout.w, layout.d, layout.h
    side, fov = _clearer_side(layout), 46.0
    back = max(2.0, 0.58 * w + 0.3)
    low, aim = (min(h - 0.45, 2.1), 0.42 * h) if ceiling else (h + 0.12 * d, 0.25 * h)
    eye = (side * 0.2 * w, -0.5 * d - back, low)
    return Camera.look_at(eye, (-side * 0.02 * w, 0.0, aim), (0, 0, 1), 960, 640, fov, "overview")


def _clearer_side(layout: Layout) -> float:
    """The front corner with the longer line of sight: 1 for the right one, -1 for the left one."""
    w, d, h = layout.w, layout.d, layout.h
    right, left = (_clear(layout, (s * 0.42 * w, -0.45 * d, h - 0.3)) for s in (1, -1))
    return 1.0 if right >= left else -1.0


def eye_views(layout: Layout) -> tuple[Camera, ...]:
    """Up to five views at eye height towards the middle, the clearest first, from positions apart from each other."""
    w, d = layout.w, layout.d
    ring = [(math.cos(a), math.sin(a)) for a in np.linspace(-math.pi / 2, 1.5 * math.pi, 17)[:-1]]
    spots = []
    for cx, cy in ring:
        reach = min(0.5 * w / max(abs(cx), 1e-6), 0.5 * d / max(abs(cy), 1e-6)) - 0.35
        eye = (cx * reach, cy * reach, EYE_HEIGHT)
        spots.append((_clear(layout, eye), eye))
    spots.sort(key=lambda s: -s[0])
    eyes = [spots[0][1]]
    for _, eye in spots[1:]:
        if len(eyes) < 5 and all(math.dist(eye, e) > 0.3 * w for e in eyes):
            eyes.append(eye)
    return tuple(
        Camera.look_at(e, (-0.4 * e[0], -0.4 * e[1], 0.7), (0, 0, 1), 960, 640, 62.0, f"view {k + 1}")
        for k, e in enumerate(eyes)
    )


def _clear(layout: Layout, eye: Vec3) -> float:
    """Mean line of sight from an eye towards the middle, metres, over a fan of rays; -1 inside a thing."""
    tall = [t.box for t in layout.things if t.support != "wall"]
    if not tall:
        return _REACH[-1]
    if _inside([b.grown(0.15) for b in tall], np.array([eye])).any():
        return -1.0
    ahead = math.atan2(-eye[1], -eye[0])
    fan = [
        (math.cos(ahead + turn), math.sin(ahead + turn), slope)
        for turn in np.radians([-30, -20, -10, 0, 10, 20, 30])
        for slope in (-0.05, -0.25)
    ]
    points = np.array(eye) + _REACH[:-1, None] * np.array(fan)[:, None, :]  # [rays, steps, 3]
    hit = _inside(tall, points.reshape(-1, 3)).reshape(len(fan), -1)
    first = np.where(hit.any(axis=1), hit.argmax(axis=1), len(_REACH) - 1)
    return float(sum(_REACH[first])) / len(fan)


def _inside(boxes: Sequence[YawBox], points: Array) -> NDArray[np.bool_]:
    """`[M]` whether each point `[M, 3]` is in one of the boxes."""
    centres = np.array([(b.x, b.y) for b in boxes])  # [B, 2]
    axes = np.array([b.axes for b in boxes])  # [B, 2, 2]
    half = np.array([(b.w / 2, b.d / 2) for b in boxes])
    low, high = np.array([b.low for b in boxes]), np.array([b.high for b in boxes])
    local = np.einsum("bij,bmj->bmi", axes, points[None, :, :2] - centres[:, None])
    level = (low[:, None] < points[:, 2]) & (points[:, 2] < high[:, None])
    return np.asarray(((np.abs(local) < half[:, None]).all(axis=2) & level).any(axis=0))

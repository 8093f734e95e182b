"""Relations between groups as geometry of their boxes, in a stated frame of reference.

Every function scores one candidate against its anchors in [0, 1]; 0.5 is where a relation begins to hold. Left,
right, in front and behind are those of the viewer, levelled to the ground, or of the anchor's own axes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from .field import Box, Group

HOLDS = 0.5
TOUCH = 0.06  # gap or overlap that still counts as resting on something, as a share of the typical object size


@dataclass(frozen=True)
class Stand:
    """Where one stands when saying left and right: unit vectors, world frame; `scale` a typical object size."""

    right: NDArray[np.float64]
    forward: NDArray[np.float64]
    up: NDArray[np.float64]
    eye: NDArray[np.float64]
    scale: float


def viewer_stand(camera: Camera, up: NDArray[np.float64], scale: float) -> Stand:
    """The camera's right and forward, levelled. A camera looking straight down keeps its image's right and top."""
    right = camera.right - up * (camera.right @ up)
    if np.linalg.norm(right) < 1e-6:  # a picture taken upright: its right is up or down, but it still looks ahead
        right = np.cross(camera.forward, up)
    right = right / np.linalg.norm(right)
    return Stand(right, np.cross(up, right), up, camera.position, scale)


def object_stand(anchor: Group, viewer: Stand) -> Stand:
    """The anchor's own frame: it faces along -y of its box, so its right hand is at its -x."""
    right, forward = -np.array(anchor.box.axes[0]), -np.array(anchor.box.axes[1])
    return Stand(right, forward, viewer.up, np.array(anchor.box.center), viewer.scale)


def score(name: str, candidate: Group, anchors: Sequence[Group], stand: Stand) -> float:
    """How well `candidate` stands in relation `name` to the anchors ("between" takes two, all others the first)."""
    if name == "between":
        return _between(candidate, anchors[0], anchors[-1], stand)
    anchor = anchors[0]
    if name in ("left_of", "right_of", "in_front_of", "behind"):
        return _beside(name, candidate, anchor, stand)
    if name == "next_to":
        return _next_to(candidate, anchor, stand)
    if name == "inside":
        return _inside(candidate, anchor, stand)
    return _vertical(name, candidate, anchor, stand)


def distance(a: Group, b: Group) -> float:
    """Gap between two boxes of one scene, scene units; 0 where they touch or overlap.

    Exact: both stand upright, so that the gap in plan and the gap in height do not depend on each other.
    """
    rise = abs(float((np.array(a.box.center) - np.array(b.box.center)) @ np.array(b.box.axes[2])))
    over = max(0.0, rise - (a.box.size[2] + b.box.size[2]) / 2)
    return math.hypot(_plan_gap(a.box, b.box), over)


def _plan_gap(a: Box, b: Box) -> float:
    """Gap between two rectangles: where they are apart, a corner of one of them is at an end of the shortest way."""
    gaps, apart = [], False
    for one, other in ((a, b), (b, a)):
        corners, half = other.local(one.corners()[:4])[:, :2], np.array(other.size[:2]) / 2
        apart |= bool((corners.min(axis=0) > half).any() or (corners.max(axis=0) < -half).any())
        gaps.append(float(np.linalg.norm(np.maximum(np.abs(corners) - half, 0), axis=1).min()))
    return min(gaps) if apart else 0.0


def _lattice(box: Box) -> NDArray[np.float64]:
    """`[125, 3]` points spread through a box."""
    t = np.linspace(-0.5, 0.5, 5)
    grid = np.stack(np.meshgrid(t, t, t, indexing="ij"), axis=-1).reshape(-1, 3)
    points: NDArray[np.float64] = np.array(box.center) + (grid * np.array(box.size)) @ np.array(box.axes)
    return points


def _height(group: Group, up: NDArray[np.float64]) -> tuple[float, float]:
    """Bottom and top along up."""
    middle = float(np.array(group.box.center) @ up)
    return middle - group.box.size[2] / 2, middle + group.box.size[2] / 2


def _beside(name: str, candidate: Group, anchor: Group, stand: Stand) -> float:
    """Cosine of the angle to the asked direction, between the boxes' centres: a relation reaches 60 degrees aside."""
    offset = np.array(candidate.box.center) - np.array(anchor.box.center)
    level = offset - stand.up * (offset @ stand.up)
    reach = float(np.linalg.norm(level))
    if reach < 1e-9:
        return 0.0
    # "in front" is on the viewer's side of the anchor; in the anchor's own frame it is where the anchor faces.
    toward_front = stand.forward if np.allclose(stand.eye, anchor.box.center) else -stand.forward
    aim = {
        "left_of": -stand.right,
        "right_of": stand.right,
        "in_front_of": toward_front,
        "behind": -toward_front,
    }[name]
    return min(max(float(level @ aim) / reach, 0.0), 1.0)


def _overlap(candidate: Group, anchor: Group) -> float:
    """Share of the candidate's footprint that lies over the anchor's."""
    t = np.linspace(-0.5, 0.5, 7)
    grid = np.stack(np.meshgrid(t, t, [0.0], indexing="ij"), axis=-1).reshape(-1, 3)
    points = np.array(candidate.box.center) + (grid * np.array(candidate.box.size)) @ np.array(candidate.box.axes)
    local = np.abs(anchor.box.local(points))[:, :2]
    return float((local <= np.array(anchor.box.size[:2]) / 2 + 1e-9).all(axis=1).mean())


def _vertical(name: str, candidate: Group, anchor: Group, stand: Stand) -> float:
    low, high = _height(candidate, stand.up)
    base, top = _height(anchor, stand.up)
    over = _overlap(candidate, anchor)
    under = _overlap(anchor, candidate)
    slack = max(TOUCH * stand.scale, 0.1 * (top - base))
    if name == "on":
        # On a shelf is within the shelf's height; a rug or a floor is thinner than a box is precise.
        rests = min(base + 0.02 * (top - base), top - slack) < low < top + slack
        smaller = (high - low) <= 1.5 * (top - base) or over > 0.9
        return over if rests and smaller and (low + high) / 2 > (base + top) / 2 - 0.5 * (top - base) else 0.0
    if name == "above":
        return max(over, under) if low >= top - slack else 0.0
    if name in ("under", "below"):
        return max(over, under) if (low + high) / 2 < (base + top) / 2 and low < top - slack else 0.0
    raise ValueError(f"unknown relation {name}")


def _inside(candidate: Group, anchor: Group, stand: Stand) -> float:
    local = np.abs(anchor.box.local(_lattice(candidate.box)))
    margin = TOUCH * stand.scale
    return float((local <= np.array(anchor.box.size) / 2 + margin).all(axis=1).mean())


def _next_to(candidate: Group, anchor: Group, stand: Stand) -> float:
    """1 when touching, 0.5 at a gap of 0.6 times the mean of their largest extents, falling beyond."""
    reach = 0.5 * (max(candidate.box.size) + max(anchor.box.size))
    return 1 / (1 + (distance(candidate, anchor) / max(0.6 * reach, 1e-9)) ** 2)


def _between(candidate: Group, first: Group, second: Group, stand: Stand) -> float:
    a, b, c = (np.array(g.box.center) for g in (first, second, candidate))
    span = b - a
    length = float(np.linalg.norm(span))
    if length < 1e-9:
        return 0.0
    t = float((c - a) @ span) / length**2
    aside = float(np.linalg.norm(c - a - t * span)) / length
    inside = 1.0 if 0.1 < t < 0.9 else 0.0
    return inside * math.exp(-((aside / 0.5) ** 2))

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
    if np.linalg.norm(right) < 1e-6:
        right = camera.forward - up * (camera.forward @ up)
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
    """Gap between two boxes, world units; 0 where they touch or overlap (sampled on corners, edges and centres)."""
    samples = np.concatenate([a.box.corners(), _lattice(a.box)])
    outside = np.maximum(np.abs(b.box.local(samples)) - np.array(b.box.size) / 2, 0)
    return float(np.linalg.norm(outside, axis=1).min())


def _lattice(box: Box) -> NDArray[np.float64]:
    """`[125, 3]` points spread through a box, so that a small box beside a long one finds it."""
    t = np.linspace(-0.5, 0.5, 5)
    grid = np.stack(np.meshgrid(t, t, t, indexing="ij"), axis=-1).reshape(-1, 3)
    points: NDArray[np.float64] = np.array(box.center) + (grid * np.array(box.size)) @ np.array(box.axes)
    return points


def _height(group: Group, up: NDArray[np.float64]) -> tuple[float, float]:
    """Bottom and top along up."""
    middle = float(np.array(group.box.center) @ up)
    return middle - group.box.size[2] / 2, middle + group.box.size[2] / 2


def _beside(name: str, candidate: Group, anchor: Group, stand: Stand) -> float:
    """Cosine-shaped cone of 60 degrees half angle about the asked direction, between the boxes' centres."""
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
    along = float(level @ aim) / reach
    return max(0.0, along) ** 1.0 if along < 1 else 1.0


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
        rests = low > base + 0.02 * (top - base) and low < top + slack  # on a shelf is within the shelf's height
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
    """1 when touching, 0.5 at a gap of one typical size of the two, falling beyond."""
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

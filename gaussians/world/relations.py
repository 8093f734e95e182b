"""Relations between groups as geometry of their boxes, in a stated frame of reference.

Every function scores all candidates at once against one anchor (or two) in [0, 1]; 0.5 is where a relation begins to
hold. Left, right, in front and behind are those of the viewer, levelled to the ground, or of the anchor's own axes.

Names: C candidates, `[C]` scores; a plan is the picture from above, its boxes are rectangles.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from ..language.field.language_field import Group
from .box import Boxes, distances, lattice

HOLDS = 0.5
F64 = NDArray[np.float64]
SIDEWAYS = ("left_of", "right_of", "in_front_of", "behind")
RESTS, HANGS = 0.02, 0.1  # of a thing's, or a wall's, height: what begins above is on it; lower stands on the floor
TOUCH = 0.06  # gap or overlap that still counts as resting on something, as a share of the typical object size


@dataclass(frozen=True)
class Stand:
    """Where one stands when saying left and right: unit vectors, world frame; `scale` a typical object size."""

    right: F64
    forward: NDArray[np.float64]
    up: NDArray[np.float64]
    eye: NDArray[np.float64]
    scale: float


def viewer_stand(camera: Camera, up: F64, scale: float) -> Stand:
    """The camera's right and forward, levelled. A camera looking straight down keeps its image's right and top."""
    right = camera.right - up * (camera.right @ up)
    if np.linalg.norm(right) < 1e-6:  # a picture taken upright: its right is up or down, but it still looks ahead
        right = np.cross(camera.forward, up)
    right = right / np.linalg.norm(right)
    return Stand(right, np.cross(up, right), up, camera.position, scale)


def object_stand(anchor: Group, front: F64, viewer: Stand) -> Stand:
    """The anchor's own frame: in front is where `front` (`[3]`, level, unit) points, right is its own right hand."""
    return Stand(np.cross(front, viewer.up), front, viewer.up, np.array(anchor.box.center), viewer.scale)


def score(name: str, candidate: Group, anchors: Sequence[Group], stand: Stand) -> float:
    """How well one `candidate` stands in relation `name` to the anchors; see `scores`."""
    flat = candidate.level == "structure"
    return float(scores(name, Boxes.of([candidate.box]), anchors, stand, np.array([flat]))[0])


def scores(
    name: str, candidates: Boxes, anchors: Sequence[Group], stand: Stand, structure: NDArray[np.bool_] | None = None
) -> F64:
    """`[C]` how well each candidate stands in relation `name` ("between" takes two anchors, all others the first).

    Args:
        structure: `[C]`, which candidates are floors, walls or ceilings; None: none of them.
    """
    first = Boxes.of([anchors[0].box])
    if name == "between":
        return _between(candidates, first.centers[0], np.array(anchors[-1].box.center))
    if name in SIDEWAYS:
        wide = np.zeros(len(candidates), bool) if structure is None else structure
        return _beside(name, candidates, first, stand, wide, anchors[0].level == "structure")
    if name == "next_to":
        reach = 0.5 * (candidates.sizes.max(axis=1) + first.sizes.max())
        near: F64 = 1 / (1 + (distances(candidates, first) / np.maximum(0.6 * reach, 1e-9)) ** 2)
        return near  # 1 when touching, 0.5 at a gap of 0.6 times the mean of their largest extents
    if name == "inside":
        return _inside(candidates, first, stand)
    return _vertical(name, candidates, first, stand, anchors[0].label == "wall")


FOOTPRINT, VOLUME = lattice(7, 1), lattice(5, 5)


def _beside(
    name: str, candidates: Boxes, anchor: Boxes, stand: Stand, wide: NDArray[np.bool_], anchor_wide: bool
) -> F64:
    """Cosine of the angle to the asked direction, between the boxes' centres: a relation reaches 60 degrees aside.

    A wall is where it is nearest: the one behind the sofa has its middle anywhere along it.
    """
    here = np.where(wide[:, None], _nearest(candidates, anchor.centers), candidates.centers)
    there = _nearest(anchor, candidates.centers) if anchor_wide else anchor.centers
    offset = here - there
    level = offset - (offset @ stand.up)[:, None] * stand.up
    reach = np.linalg.norm(level, axis=1)
    # "in front" is on the viewer's side of the anchor; in the anchor's own frame it is where the anchor faces.
    toward_front = stand.forward if np.allclose(stand.eye, anchor.centers[0]) else -stand.forward
    aim = {
        "left_of": -stand.right,
        "right_of": stand.right,
        "in_front_of": toward_front,
        "behind": -toward_front,
    }[name]
    cosine = (level @ aim) / np.maximum(reach, 1e-9)
    return np.where(reach < 1e-9, 0.0, np.clip(cosine, 0.0, 1.0))


def _nearest(boxes: Boxes, points: F64) -> F64:
    """`[C, 3]` the point of each box that is nearest to each point; one box or one point serves all."""
    local = boxes.local(points[:, None])[:, 0]
    inside = np.clip(local, -boxes.sizes / 2, boxes.sizes / 2)
    near: F64 = boxes.centers + (inside[:, None] @ boxes.axes)[:, 0]
    return near


def _overlaps(of: Boxes, over: Boxes) -> F64:
    """`[C]` share of one footprint that lies over another; one box on either side serves all."""
    local = np.abs(over.local(of.spread(FOOTPRINT)))[..., :2]
    share: F64 = (local <= over.sizes[:, None, :2] / 2 + 1e-9).all(axis=2).mean(axis=1)
    return share


def _vertical(name: str, candidates: Boxes, anchor: Boxes, stand: Stand, wall: bool) -> F64:
    low, high = candidates.heights(stand.up)
    base, top = (float(v[0]) for v in anchor.heights(stand.up))
    over = _overlaps(candidates, anchor)
    slack = max(TOUCH * stand.scale, 0.1 * (top - base))
    if name == "on":
        # On a shelf is within the shelf's height; a rug or a floor is thinner than a box is precise.
        lift = HANGS if wall else RESTS
        rests = (min(base + lift * (top - base), top - slack) < low) & (low < top + slack)
        smaller = ((high - low) <= 1.5 * (top - base)) | (over > 0.9)
        return np.where(rests & smaller & ((low + high) / 2 > base), over, 0.0)
    either = np.maximum(over, _overlaps(anchor, candidates))
    if name == "above":
        return np.where(low >= top - slack, either, 0.0)
    if name in ("under", "below"):
        return np.where(((low + high) / 2 < (base + top) / 2) & (low < top - slack), either, 0.0)
    raise ValueError(f"unknown relation {name}")


def _inside(candidates: Boxes, anchor: Boxes, stand: Stand) -> F64:
    """Share of a candidate's volume within the anchor and a little around it; what stands on top is not inside."""
    half = anchor.sizes / 2
    within = np.abs(anchor.local(candidates.spread(VOLUME))) <= half[:, None] + TOUCH * stand.scale
    middle = np.abs(anchor.local(candidates.centers[:, None])[:, 0, 2]) <= half[:, 2]
    return np.where(middle, within.all(axis=2).mean(axis=1), 0.0)


def _between(candidates: Boxes, a: F64, b: F64) -> F64:
    span = b - a
    length = float(np.linalg.norm(span))
    if length < 1e-9:
        return np.zeros(len(candidates))
    t = (candidates.centers - a) @ span / length**2
    aside = np.linalg.norm(candidates.centers - a - t[:, None] * span, axis=1) / length
    return np.where((t > 0.1) & (t < 0.9), np.exp(-((aside / 0.5) ** 2)), 0.0)

"""Score how well boxes fulfil each spatial relation, in a given frame of reference.

Every score is in [0, 1], for all candidates at once against one anchor (or two); a relation holds from 0.5 on.
Queries, the checker of scene graphs and, with a margin, the layout solver use these functions; `relations` assigns them
to relations. Left, right, in front and behind are those of the viewer, levelled to the
ground, or of the anchor's own axes.

Names: C candidates, `[C]` scores; the plan is the view from above, in which boxes are rectangles.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from ..language.field.language_field import Group
from .box import Boxes, distances, lattice

F64 = NDArray[np.float64]
FOOTPRINT, VOLUME = lattice(7, 1), lattice(5, 5)
HOLDS = 0.5  # score from which every relation holds: for a side at 60 degrees, for on and under at half a footprint
CLOSE = 0.3  # of the sum of two things' largest extents: the gap up to which they are next to each other
RESTS, HANGS = (
    0.02,
    0.1,
)  # of a thing's, or a wall's, height: things that begin above it are on it; lower ones stand on the floor
TOUCH = 0.06  # gap or overlap that still counts as resting on something, as a share of the typical object size
SLACK = 0.1  # the same as a share of the anchor's height, where that is more: the top of a tall thing is less precise
ENDS = 0.1  # share of the way between two things, at either end, that is no longer between them
BULGE = 0.5  # of that way: decay length of "between" to the side; it holds up to 0.42
FACES = 45.0  # largest angle in degrees between a thing's front and the direction to what it faces
ACROSS = 0.6  # of the anchor's distance from the middle: largest distance from the point across it; 37 degrees aside


@dataclass(frozen=True)
class Stand:
    """The frame of reference of left, right, in front and behind: unit vectors, world frame.

    Attributes:
        right, forward, up: horizontal, horizontal and vertical.
        eye: position of the viewer, or centre of the anchor whose frame it is.
        scale: a typical object size, scene units.
        own: whether the frame is the anchor's own, so that "in front" is forward; a viewer is on the near side.
        middle: `[3]` middle of the room.
    """

    right: F64
    forward: F64
    up: F64
    eye: F64
    scale: float
    own: bool = False
    middle: F64 = field(default_factory=lambda: np.zeros(3))

    def side(self, aim: tuple[float, float]) -> F64:
        """`[3]` unit vector of a side, given as (to the right, behind)."""
        behind = -self.forward if self.own else self.forward
        return aim[0] * self.right + aim[1] * behind


def viewer_stand(camera: Camera, up: F64, scale: float, middle: F64 | None = None) -> Stand:
    """The camera's right and forward, made horizontal.

    For a camera that looks straight down, they are the right and top of its image.
    """
    right = camera.right - up * (camera.right @ up)
    if (
        np.linalg.norm(right) < 1e-6
    ):  # the camera is rolled by 90 degrees: its right is up or down, its forward is still usable
        right = np.cross(camera.forward, up)
    right = right / np.linalg.norm(right)
    return Stand(
        right, np.cross(up, right), up, camera.position, scale, middle=np.zeros(3) if middle is None else middle
    )


def object_stand(anchor: Group, front: F64, viewer: Stand) -> Stand:
    """The anchor's own frame: in front is where `front` (`[3]`, level, unit) points, right is its own right hand."""
    center = np.array(anchor.box.center)
    return Stand(np.cross(front, viewer.up), front, viewer.up, center, viewer.scale, True, viewer.middle)


@dataclass(frozen=True, eq=False)
class Things:
    """Boxes that are related, and which of them are part of the building.

    Attributes:
        boxes: C of them; of an anchor one, or one for each candidate.
        structure: whether each is a floor, wall or ceiling, `[C]` or one for all.
        wall: whether they are walls.
    """

    boxes: Boxes
    structure: NDArray[np.bool_]
    wall: bool = False


Score = Callable[[Things, Sequence[Things], Stand], F64]  # candidates, anchors, frame -> `[C]` in [0, 1]


def toward(aim: tuple[float, float]) -> Score:
    """The score of being at a side, (to the right, behind): the cosine between it and the offset of the centres.

    For floors, walls and ceilings the nearest point replaces the centre: the wall behind a sofa may have its centre
    anywhere along it.
    """

    def score(candidates: Things, anchors: Sequence[Things], stand: Stand) -> F64:
        boxes, anchor = candidates.boxes, anchors[0].boxes
        here = np.where(candidates.structure[:, None], _nearest(boxes, anchor.centers), boxes.centers)
        there = np.where(anchors[0].structure[:, None], _nearest(anchor, boxes.centers), anchor.centers)
        offset = here - there
        level = offset - (offset @ stand.up)[:, None] * stand.up
        reach = np.linalg.norm(level, axis=1)
        cosine = (level @ stand.side(aim)) / np.maximum(reach, 1e-9)
        return np.where(reach < 1e-9, 0.0, np.clip(cosine, 0.0, 1.0))

    return score


def near(candidates: Things, anchors: Sequence[Things], stand: Stand) -> F64:
    """1 for boxes that touch, 0.5 at a gap of `CLOSE`."""
    boxes, anchor = candidates.boxes, anchors[0].boxes
    reach = 0.5 * (boxes.sizes.max(axis=1) + anchor.sizes.max(axis=1))
    score: F64 = 1 / (1 + (distances(boxes, anchor) / np.maximum(2 * CLOSE * reach, 1e-9)) ** 2)
    return score


def resting(candidates: Things, anchors: Sequence[Things], stand: Stand) -> F64:
    """Share of a candidate's footprint over the anchor, if its underside is at the anchor's top or on a shelf of it."""
    boxes, anchor = candidates.boxes, anchors[0].boxes
    (low, high), (base, top) = boxes.heights(stand.up), anchor.heights(stand.up)
    over, slack = _overlaps(boxes, anchor), _slack(base, top, stand)
    # On a shelf means within the shelf's height. A rug or a floor is thinner than the precision of a box.
    lift = HANGS if anchors[0].wall else RESTS
    rests = (np.minimum(base + lift * (top - base), top - slack) < low) & (low < top + slack)
    smaller = ((high - low) <= 1.5 * (top - base)) | (over > 0.9)
    return np.where(rests & smaller & ((low + high) / 2 > base), over, 0.0)


def over(candidates: Things, anchors: Sequence[Things], stand: Stand) -> F64:
    """Shared footprint of both, for candidates that begin at the anchor's top or higher."""
    low, _ = candidates.boxes.heights(stand.up)
    base, top = anchors[0].boxes.heights(stand.up)
    return np.where(low >= top - _slack(base, top, stand), _shared_footprint(candidates, anchors[0]), 0.0)


def beneath(candidates: Things, anchors: Sequence[Things], stand: Stand) -> F64:
    """Shared footprint of both, for candidates whose middle is lower than the anchor's."""
    low, high = candidates.boxes.heights(stand.up)
    base, top = anchors[0].boxes.heights(stand.up)
    lower = ((low + high) / 2 < (base + top) / 2) & (low < top - _slack(base, top, stand))
    return np.where(lower, _shared_footprint(candidates, anchors[0]), 0.0)


def within(candidates: Things, anchors: Sequence[Things], stand: Stand) -> F64:
    """Share of a candidate's volume within the anchor, enlarged by `TOUCH`; a thing on top of it is not inside."""
    boxes, anchor = candidates.boxes, anchors[0].boxes
    half = anchor.sizes / 2
    inside = np.abs(anchor.local(boxes.spread(VOLUME))) <= half[:, None] + TOUCH * stand.scale
    middle = np.abs(anchor.local(boxes.centers[:, None])[:, 0, 2]) <= half[:, 2]
    return np.where(middle, inside.all(axis=2).mean(axis=1), 0.0)


def between(candidates: Things, anchors: Sequence[Things], stand: Stand) -> F64:
    """1 on the line from the first anchor's centre to the last one's, falling to the side; 0 at either end."""
    a, b = anchors[0].boxes.centers, anchors[-1].boxes.centers
    span = b - a
    length = np.maximum(np.linalg.norm(span, axis=1), 1e-9)
    offset = candidates.boxes.centers - a
    t = (offset * span).sum(axis=1) / length**2
    aside = np.linalg.norm(offset - t[:, None] * span, axis=1) / length
    apart = (length > 1e-9) & (t > ENDS) & (t < 1 - ENDS)
    return np.where(apart, np.exp(-((aside / BULGE) ** 2)), 0.0)


def facing(candidates: Things, anchors: Sequence[Things], stand: Stand) -> F64:
    """1 where a candidate's front points to the anchor's centre, 0.5 at `FACES` degrees aside."""
    off: F64 = degrees_aside(candidates.boxes, anchors[0].boxes)
    return np.maximum(0.0, 1 - off * (1 - HOLDS) / FACES)


def degrees_aside(boxes: Boxes, anchor: Boxes) -> F64:
    """`[C]` degrees in plan between each box's front (its -y side) and the direction to the anchor's centre."""
    way = ((anchor.centers - boxes.centers)[:, None] * boxes.axes[:, :2]).sum(axis=2)  # [C, 2] in own axes
    reach = np.linalg.norm(way, axis=1)
    cosine = np.clip(-way[:, 1] / np.maximum(reach, 1e-9), -1.0, 1.0)
    return np.where(reach < 1e-9, 0.0, np.degrees(np.arccos(cosine)))


def across(candidates: Things, anchors: Sequence[Things], stand: Stand) -> F64:
    """Nearness to the anchor's centre mirrored at the middle of the room: 1 at that point, 0.5 at `ACROSS` from it.

    0 for an anchor in the middle of the room.
    """
    way = stand.middle - anchors[0].boxes.centers
    level = way - (way @ stand.up)[:, None] * stand.up
    off = candidates.boxes.centers - anchors[0].boxes.centers - 2 * level
    aside = np.linalg.norm(off - (off @ stand.up)[:, None] * stand.up, axis=1)
    reach = ACROSS * np.linalg.norm(level, axis=1)
    return np.where(reach < 1e-9, 0.0, 1 / (1 + (aside / np.maximum(reach, 1e-9)) ** 2))


def _nearest(boxes: Boxes, points: F64) -> F64:
    """`[C, 3]` the point of each box that is nearest to each point; one box or one point is broadcast."""
    local = boxes.local(points[:, None])[:, 0]
    inside = np.clip(local, -boxes.sizes / 2, boxes.sizes / 2)
    near: F64 = boxes.centers + (inside[:, None] @ boxes.axes)[:, 0]
    return near


def _overlaps(of: Boxes, over: Boxes) -> F64:
    """`[C]` share of one footprint that lies over another; one box on either side is broadcast."""
    local = np.abs(over.local(of.spread(FOOTPRINT)))[..., :2]
    share: F64 = (local <= over.sizes[:, None, :2] / 2 + 1e-9).all(axis=2).mean(axis=1)
    return share


def _shared_footprint(candidates: Things, anchor: Things) -> F64:
    """`[C]` shared footprint of two boxes as a share of the smaller one, by sample points of either."""
    return np.maximum(_overlaps(candidates.boxes, anchor.boxes), _overlaps(anchor.boxes, candidates.boxes))


def _slack(base: F64, top: F64, stand: Stand) -> F64:
    """`[C]` largest distance from an anchor's top that counts as being at it."""
    return np.maximum(TOUCH * stand.scale, SLACK * (top - base))

"""The true relations between things, from the boxes they were placed in: true, false, or None if it is debatable.

This definition is independent of how queries score relations, so that the one can test the other. Plain geometry of
upright boxes in metres with z up; angles in degrees.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...gaussians.assets import TruthObject
from ...gaussians.camera import Camera

F64 = NDArray[np.float64]

AHEAD, ASTRAY = 40.0, 100.0  # degrees off the asked direction up to, and from, which nobody disagrees
APART = 0.3  # metres between centres below which two things stand at one place
CLOSE, FAR = 0.15, 1.5  # metres between two things that are next to each other, and that are not
LEAD = 0.4  # metres by which the nearest or farthest must lead
HOLLOW = frozenset({"basket", "bin", "bowl", "box", "cooking pot"})
SIDES = ("left_of", "right_of", "in_front_of", "behind")


@dataclass(frozen=True, eq=False)
class Solid:
    """One true object as an upright box."""

    thing: TruthObject

    @cached_property
    def center(self) -> F64:
        """`[3]`."""
        return np.array(self.thing.position)

    @property
    def low(self) -> float:
        """Height of its bottom."""
        return self.thing.position[2] - self.thing.size[2] / 2

    @property
    def high(self) -> float:
        """Height of its top."""
        return self.thing.position[2] + self.thing.size[2] / 2

    @cached_property
    def facing(self) -> F64:
        """`[2]` level unit vector out of its front."""
        yaw = math.radians(self.thing.yaw)
        return np.array([math.sin(yaw), -math.cos(yaw)])

    @cached_property
    def rim(self) -> F64:
        """`[44, 2]` points along the outline of its footprint, corners among them."""
        t = np.linspace(-0.5, 0.5, 11)
        ends = np.full_like(t, 0.5)
        edges = [(t, -ends), (t, ends), (-ends, t), (ends, t)]
        local = np.concatenate([np.stack(edge, axis=1) for edge in edges]) * np.array(self.thing.size[:2])
        return self.center[:2] + local @ self._axes

    @cached_property
    def _axes(self) -> F64:
        """`[2, 2]` rows: its right (facing -y at yaw 0) and back, level."""
        return np.array([[-self.facing[1], self.facing[0]], -self.facing])

    def covers(self, points: F64, margin: float = 0.0) -> NDArray[np.bool_]:
        """Which level points `[M, 2]` lie within its footprint grown by `margin`."""
        local = np.abs((points - self.center[:2]) @ self._axes.T)
        within = local <= np.array(self.thing.size[:2]) / 2 + margin
        return np.asarray(within.all(axis=1))

    def reach(self, direction: F64) -> float:
        """How far its footprint extends from its centre in a level direction."""
        return float(((self.rim - self.center[:2]) @ direction).max())


def gap(a: Solid, b: Solid) -> float:
    """Level distance between two footprints, to about a twentieth of a side; 0 where they overlap."""
    if a.covers(b.rim).any() or b.covers(a.rim).any():
        return 0.0
    return float(np.linalg.norm(a.rim[:, None] - b.rim[None], axis=2).min())


def angle(offset: F64, direction: F64) -> float:
    """Degrees between two level vectors."""
    cosine = float(offset @ direction) / max(float(np.linalg.norm(offset) * np.linalg.norm(direction)), 1e-12)
    return math.degrees(math.acos(min(1.0, max(-1.0, cosine))))


def stands(name: str, thing: Solid, anchors: tuple[Solid, ...], viewer: Camera) -> bool | None:
    """Whether `thing` clearly has the relation to the anchors as seen from `viewer`; None if it is debatable."""
    anchor = anchors[0]
    if name in SIDES:
        return _beside(thing, anchor, _viewer_directions(name, anchor, viewer))
    if name == "between":
        return _between(thing, anchors[0], anchors[1])
    return {"on": _on, "under": _under, "above": _above, "inside": _inside, "next_to": _next_to}[name](thing, anchor)


def stands_by_object(name: str, thing: Solid, anchor: Solid) -> bool | None:
    """The same for left, right, in front and behind in the anchor's own frame: its front is the side it faces."""
    front = anchor.facing
    right = np.array([front[1], -front[0]])  # the right hand of someone who looks where it looks
    aim = {"left_of": -right, "right_of": right, "in_front_of": front, "behind": -front}[name]
    return _beside(thing, anchor, (aim,))


def _viewer_directions(name: str, anchor: Solid, viewer: Camera) -> tuple[F64, F64]:
    """The asked direction as the picture's axes have it, and as the line of sight to the anchor has it."""
    aims = []
    for sight in (viewer.forward[:2], anchor.center[:2] - viewer.position[:2]):
        ahead = sight / max(float(np.linalg.norm(sight)), 1e-9)
        right = np.array([ahead[1], -ahead[0]])
        aims.append({"left_of": -right, "right_of": right, "in_front_of": -ahead, "behind": ahead}[name])
    return aims[0], aims[1]


def _beside(thing: Solid, anchor: Solid, aims: tuple[F64, ...]) -> bool | None:
    offset = thing.center[:2] - anchor.center[:2]
    if np.linalg.norm(offset) < APART:
        return None
    off = [angle(offset, aim) for aim in aims]
    if min(off) >= ASTRAY:
        return False
    beyond = all(float(offset @ aim) > anchor.reach(aim) for aim in aims)  # its middle is past the anchor's edge
    return True if max(off) <= AHEAD and beyond else None


def _on(thing: Solid, anchor: Solid) -> bool | None:
    if thing.thing.support == anchor.thing.id:
        return True if thing.low > anchor.low + 0.5 * (anchor.high - anchor.low) else None
    return False if gap(thing, anchor) > 0.1 or thing.high <= anchor.low + 0.02 else None


def _under(thing: Solid, anchor: Solid) -> bool | None:
    if anchor.covers(thing.rim).all() and thing.high < anchor.low + 0.8 * (anchor.high - anchor.low):
        return True if thing.thing.support != anchor.thing.id else None
    return False if gap(thing, anchor) > 0.15 or thing.low >= anchor.high - 0.02 else None


def _above(thing: Solid, anchor: Solid) -> bool | None:
    if thing.low >= anchor.high + 0.1 and anchor.covers(thing.center[None, :2], 0.12).all():
        return True if thing.thing.support in ("wall", "ceiling") else None
    return False if gap(thing, anchor) > 0.3 or thing.high < anchor.high else None


def _inside(thing: Solid, anchor: Solid) -> bool | None:
    held = anchor.covers(thing.rim).all() and anchor.low - 0.01 <= thing.low and thing.high <= anchor.high + 0.01
    if held:
        return True if anchor.thing.kind in HOLLOW and thing.thing.support == anchor.thing.id else None
    return False if gap(thing, anchor) > 0.2 else None


def _next_to(thing: Solid, anchor: Solid) -> bool | None:
    apart = gap(thing, anchor)
    if apart > FAR:
        return False
    level = abs(thing.low - anchor.low) < 0.05 and apart > 0
    return True if level and apart <= CLOSE else None


def _between(thing: Solid, one: Solid, other: Solid) -> bool | None:
    span = other.center[:2] - one.center[:2]
    length = float(np.linalg.norm(span))
    if length < 1.0:
        return None
    offset = thing.center[:2] - one.center[:2]
    along = float(offset @ span) / length**2
    aside = float(np.linalg.norm(offset - along * span)) / length
    if not -0.1 < along < 1.1 or aside > 0.9:
        return False
    level = abs(thing.low - one.low) < 0.4 and abs(thing.low - other.low) < 0.4
    apart = gap(thing, one) > 0 and gap(thing, other) > 0
    return True if 0.3 <= along <= 0.7 and aside <= 0.2 and level and apart else None


def extreme(name: str, things: list[Solid], anchor: Solid) -> Solid | None:
    """The one of several nearest to, or farthest from, an anchor, by their gap and their middles; None if unclear."""
    sign = 1.0 if name == "nearest_to" else -1.0
    measures = (
        lambda t: gap(t, anchor) + max(0.0, t.low - anchor.high, anchor.low - t.high),
        lambda t: float(np.linalg.norm(t.center - anchor.center)),
    )
    firsts = []
    for measure in measures:
        ordered = sorted((sign * measure(t), i) for i, t in enumerate(things))
        if len(ordered) < 2 or ordered[1][0] - ordered[0][0] < LEAD:
            return None
        firsts.append(ordered[0][1])
    return things[firsts[0]] if firsts[0] == firsts[1] else None

"""Where a thing may be put, as "between the bed and the wall": a surface, and conditions on positions on it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ....gaussians.world import kinds
from ....gaussians.world.box import YawBox, plan_gap
from ....gaussians.world.person import STEP
from ..answer import Line
from ..candidates import meant
from ..reading.where_to import Anchor, Wall, Where
from ..survey import Survey, Thing
from .spaces import Allowed, Surface

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]

TOUCHES = 0.12  # metres between a thing and the wall that it stands at
BESIDE, NEAR, BEFORE = 0.4, 1.0, 1.2  # largest gaps in metres of next to, near, and in front of
AT = 0.15  # metres between a table and a chair at it
_SQUARE = (0.0, 90.0)


class Undecidable(Exception):
    """Boxes do not tell: the message says why."""


@dataclass(frozen=True)
class Region:
    """Places for the middle of a thing on a surface.

    Attributes:
        surface: what it stands on.
        words: the place, as told.
        allowed: conditions on positions in the room.
        along: degrees of the direction in which a width runs that is meant to face a wall or fill a gap; None if open.
        yaws: turns to try.
        gap: metres between the two things that the place is between, with the line; None without them.
        most: greatest height that the place allows, metres.
        things: what the place is named after.
        on: the thing whose top the surface is, None for the floor.
        backs: whether a thing whose back belongs at a wall stands there with its width along `along`.
    """

    surface: Surface
    words: str
    allowed: tuple[Allowed, ...] = ()
    along: float | None = None
    yaws: tuple[float, ...] = _SQUARE
    gap: tuple[float, Line] | None = None
    most: float = math.inf
    things: tuple[Thing, ...] = ()
    on: Thing | None = None
    backs: bool = False

    def allows(self, box: YawBox) -> Flags:
        """Whether all conditions hold for a box at many positions."""
        keep = np.ones(np.shape(box.x), dtype=bool)
        for condition in self.allowed:
            keep &= condition(box)
        return keep

    def and_also(self, other: Region) -> Region:
        """The places that fit both."""
        surface, on = (other.surface, other.on) if other.on is not None else (self.surface, self.on)
        return Region(
            surface, " ".join(w for w in (self.words, other.words) if w), (*self.allowed, *other.allowed),
            self.along if self.along is not None else other.along, tuple(dict.fromkeys((*self.yaws, *other.yaws))),
            self.gap or other.gap, min(self.most, other.most), tuple(dict.fromkeys((*self.things, *other.things))), on,
            self.backs or other.backs,
        )  # fmt: skip


@dataclass(frozen=True)
class _Side:
    """A wall of the room: its outward normal, its distance from the middle, and its name for the viewer."""

    normal: tuple[float, float]
    reach: float
    name: str


def floor_of(survey: Survey) -> Region:
    """The whole floor."""
    width, depth, height = survey.graph.room.size
    return Region(Surface(0.0, 0.0, 0.0, width, depth, 0.0, height), "")


def alternatives(wheres: Sequence[Where], survey: Survey) -> Iterator[tuple[str, list[Region]]]:
    """For each reading of the anchors the regions that the words allow, any of which will do.

    Raises:
        NotResolved: an anchor is absent.
        Undecidable: boxes do not tell.
    """
    per_part = [list(_readings(w, survey)) for w in wheres]
    for combination in product(*per_part):
        name = " and ".join(words for words, _ in combination if words)
        regions = [floor_of(survey)]
        for _, choices in combination:
            regions = [a.and_also(b) for a in regions for b in choices]
        yield name, regions


def _readings(where: Where, survey: Survey) -> Iterator[tuple[str, list[Region]]]:
    """One list of regions for each combination of things that the anchors may mean, with the words that tell it."""
    choices: list[list[Thing | Wall]] = []
    for anchor in where.anchors:
        if isinstance(anchor, Wall):
            choices.append([anchor])
        else:
            choices.append(list(meant(anchor, survey)))
    same = len(where.anchors) == 2 and where.anchors[0] == where.anchors[1]
    if same and len(choices[0]) == 2:
        choices = [[choices[0][0]], [choices[0][1]]]
    for anchors in product(*choices):
        things = [a for a in anchors if not isinstance(a, Wall)]
        if len(things) == 2 and things[0].row == things[1].row:
            continue
        several = [
            survey.named(a) for a, c in zip(anchors, choices, strict=True) if not isinstance(a, Wall) and len(c) > 1
        ]
        yield " and ".join(several), _regions(where, anchors, survey)


def _regions(where: Where, anchors: Sequence[Thing | Wall], survey: Survey) -> list[Region]:
    base = floor_of(survey)
    width, depth, _ = survey.graph.room.size
    if where.relation == "room":
        return [base]
    if where.relation == "middle":
        reach = (0.2 * width, 0.2 * depth)
        return [replace(base, words="in the middle of the room",
                        allowed=(lambda b: (np.abs(b.x) <= reach[0]) & (np.abs(b.y) <= reach[1]),))]  # fmt: skip
    if where.relation == "wall":
        return [_at_wall(base, side) for side in sides_of(survey, where.sides)]
    if where.relation == "corner":
        return [_in_corner(base, a, b) for a, b in _corners(survey, where.sides)]
    first = anchors[0]
    if where.relation == "between":
        return _between(base, anchors[0], anchors[1], survey)
    if isinstance(first, Wall):
        return [_at_wall(base, side) for side in sides_of(survey, _opposite(first.sides))]
    if first.node is None:
        raise Undecidable(f"{survey.named(first).capitalize()} has no box of its own here.")
    return [_by_thing(where.relation, base, first, survey)]


# -- walls -----------------------------------------------------------------------------------------------------------


def sides_of(survey: Survey, names: Sequence[str] = ()) -> list[_Side]:
    """The walls with these names for the viewer ("left", "back"); all four without names."""
    width, depth, _ = survey.graph.room.size
    stand, found = survey.stand, []
    for normal, reach in (
        ((1.0, 0.0), width / 2),
        ((-1.0, 0.0), width / 2),
        ((0.0, 1.0), depth / 2),
        ((0.0, -1.0), depth / 2),
    ):
        way = np.array([*normal, 0.0])
        scores = {"right": way @ stand.right, "left": -way @ stand.right, "back": way @ stand.forward,
                  "front": -way @ stand.forward}  # fmt: skip
        found.append(_Side(normal, reach, max(scores, key=lambda n: float(scores[n]))))
    return [s for s in found if not names or s.name in names]


def _opposite(names: Sequence[str]) -> tuple[str, ...]:
    other = {"left": "right", "right": "left", "back": "front", "front": "back"}
    return tuple(other[n] for n in names)


def _beyond(box: YawBox, side: _Side) -> F64:
    """Metres between a box at many positions and a wall."""
    nx, ny = side.normal
    hx, hy = box.half
    return np.asarray(side.reach - (box.x * nx + box.y * ny) - (abs(nx) * hx + abs(ny) * hy))


def _at_wall(base: Region, side: _Side) -> Region:
    along = math.degrees(math.atan2(side.normal[0], -side.normal[1]))
    return replace(
        base,
        words=f"against the {side.name} wall",
        allowed=(lambda b: _beyond(b, side) <= TOUCHES,),
        along=along,
        backs=True,
    )


def _corners(survey: Survey, names: Sequence[str]) -> list[tuple[_Side, _Side]]:
    sides = sides_of(survey)
    pairs = [(a, b) for a in sides for b in sides if a.normal[0] and b.normal[1]]
    return [p for p in pairs if set(names) <= {p[0].name, p[1].name}]


def _in_corner(base: Region, a: _Side, b: _Side) -> Region:
    deep, side = sorted((a, b), key=lambda s: s.name in ("left", "right"))
    return replace(base, words=f"in the {deep.name} {side.name} corner",
                   allowed=(lambda x: (_beyond(x, a) <= TOUCHES) & (_beyond(x, b) <= TOUCHES),))  # fmt: skip


# -- between ---------------------------------------------------------------------------------------------------------


def _between(base: Region, first: Thing | Wall, second: Thing | Wall, survey: Survey) -> list[Region]:
    if isinstance(first, Wall):
        first, second = second, first
    assert not isinstance(first, Wall)
    if isinstance(second, Wall):
        found = [_to_wall(base, first, side, survey) for side in sides_of(survey, second.sides)]
        open_ones = [r for r in found if r.gap is not None and r.gap[0] > STEP]
        return open_ones or found
    return [_gap_region(base, first, second, survey)]


def _flat(thing: Thing) -> tuple[float, float, float, float]:
    """Middle and half extents of a thing in plan, along the room's axes."""
    if thing.node is not None:
        box = thing.node.yaw_box
        return (float(box.x), float(box.y), *box.half)
    x, y, _ = thing.group.box.center
    return (x, y, thing.group.box.extent(np.array([1.0, 0, 0])) / 2, thing.group.box.extent(np.array([0, 1.0, 0])) / 2)


def _to_wall(base: Region, thing: Thing, side: _Side, survey: Survey) -> Region:
    x, y, hx, hy = _flat(thing)
    axis = 0 if side.normal[0] else 1
    sign = side.normal[axis]
    face = (x, y)[axis] * sign + (hx, hy)[axis]
    middle, half = ((y, hy), (x, hx))[axis]
    words = f"between {survey.named(thing)} and the {side.name} wall"
    start, end = (face * sign, middle), (side.reach * sign, middle)
    return _corridor(
        base, axis, (face * sign, side.reach * sign), (middle - half, middle + half), words, start, end, (thing,)
    )


def _gap_region(base: Region, a: Thing, b: Thing, survey: Survey) -> Region:
    first, second = _flat(a), _flat(b)
    apart = [abs(first[i] - second[i]) - first[2 + i] - second[2 + i] for i in (0, 1)]
    axis = int(apart[1] > apart[0])
    low, high = (first, second) if first[axis] <= second[axis] else (second, first)
    start, end = low[axis] + low[2 + axis], high[axis] - high[2 + axis]
    other = 1 - axis
    spans = [(f[other] - f[2 + other], f[other] + f[2 + other]) for f in (first, second)]
    shared = (max(s[0] for s in spans), min(s[1] for s in spans))
    union = (min(s[0] for s in spans), max(s[1] for s in spans))
    lateral = union if shared[0] < shared[1] else (shared[1], shared[0])
    middle = (shared[0] + shared[1]) / 2
    words = f"between {survey.named(a)} and {survey.named(b)}"
    return _corridor(base, axis, (start, end), lateral, words, (start, middle), (end, middle), (a, b))


def _corridor(
    base: Region, axis: int, span: tuple[float, float], lateral: tuple[float, float], words: str,
    start: tuple[float, float], end: tuple[float, float], things: tuple[Thing, ...],
) -> Region:  # fmt: skip
    """The strip between two faces at `span` along an axis, as wide across as what lies at its sides."""
    low, high = min(span), max(span)
    if span[0] > span[1] and len(things) == 2:
        low, high = span[1], span[1]
    gap = max(span[1] - span[0], 0.0) if len(things) == 2 else abs(span[1] - span[0])

    def inside(box: YawBox) -> Flags:
        here, half = (box.x, box.y)[axis], box.half[axis]
        across, reach = (box.x, box.y)[1 - axis], box.half[1 - axis]
        within = (here - half >= low - 0.005) & (here + half <= high + 0.005)
        return np.asarray(within & (across + reach > lateral[0]) & (across - reach < lateral[1])
                          & (across >= lateral[0] - reach) & (across <= lateral[1] + reach))  # fmt: skip

    ends = [(*p, 0.4) if axis == 0 else (p[1], p[0], 0.4) for p in (start, end)]
    line = Line(start=ends[0], end=ends[1], label=f"{gap:.2f} m")
    return replace(
        base,
        words=words,
        allowed=(inside,),
        along=0.0 if axis == 0 else 90.0,
        gap=(gap, line),
        things=things,
        backs=len(things) == 2,
    )


# -- places by a thing -------------------------------------------------------------------------------------------------


def _by_thing(relation: str, base: Region, thing: Thing, survey: Survey) -> Region:
    assert thing.node is not None
    box, name = thing.node.yaw_box, survey.named(thing)
    turned = tuple(dict.fromkeys((*_SQUARE, box.yaw % 180.0, (box.yaw + 90.0) % 180.0)))
    base = replace(base, things=(thing,), yaws=turned)
    front = _front_of(thing, survey)
    if relation == "on":
        return _on_top(base, thing, survey)
    if relation == "under":
        return _under(base, thing, survey)
    if relation == "next_to":
        return replace(base, words=f"next to {name}", allowed=(lambda b: _beside(b, box, survey.has_front(thing)),))
    if relation in ("near", "around"):
        return replace(base, words=f"near {name}", allowed=(lambda b: plan_gap(b, box) <= NEAR,))
    if relation == "at":
        return replace(base, words=f"at {name}", allowed=(lambda b: _at_edge(b, box),))
    if relation in ("in_front", "behind"):
        way = front if relation == "in_front" else (-front[0], -front[1])
        said = "in front of" if relation == "in_front" else "behind"
        return replace(base, words=f"{said} {name}", allowed=(lambda b: _toward(b, box, way, BEFORE),),
                       along=_across(way))  # fmt: skip
    if relation == "opposite":
        return replace(base, words=f"opposite {name}", allowed=(lambda b: _toward(b, box, front, math.inf),))
    if relation in ("left", "right"):
        right = survey.stand.right
        sign = 1.0 if relation == "right" else -1.0
        way = (sign * float(right[0]), sign * float(right[1]))
        return replace(base, words=f"to the {relation} of {name}", allowed=(lambda b: _toward(b, box, way, NEAR),))
    raise Undecidable(f"Whether something fits {relation.replace('_', ' ')} {name} cannot be told from boxes.")


def _front_of(thing: Thing, survey: Survey) -> tuple[float, float]:
    """Where "in front" is: out of its front, into the room from a wall, else toward the viewer."""
    assert thing.node is not None
    if thing.node.support == "wall":
        x, y = thing.node.position[:2]
        side = min(sides_of(survey), key=lambda s: s.reach - x * s.normal[0] - y * s.normal[1])
        return (-side.normal[0], -side.normal[1])
    if survey.has_front(thing):
        return thing.node.yaw_box.front
    forward = survey.stand.forward
    return (-float(forward[0]), -float(forward[1]))


def _across(way: tuple[float, float]) -> float:
    return math.degrees(math.atan2(way[1], way[0])) + 90.0


def _beside(box: YawBox, other: YawBox, sides_only: bool) -> Flags:
    """Next to a thing; left or right of it where it has a front."""
    near = np.asarray(plan_gap(box, other) <= BESIDE)
    if not sides_only:
        return near
    u, v = other.local(box.x, box.y)
    return np.asarray(near & (np.abs(u) >= other.w / 2) & (np.abs(v) <= other.d / 2 + min(box.w, box.d) / 2))


def _at_edge(box: YawBox, other: YawBox) -> Flags:
    """At an edge of a table, not at its corner."""
    u, v = other.local(box.x, box.y)
    beside = (np.abs(u) <= other.w / 2) | (np.abs(v) <= other.d / 2)
    return np.asarray((plan_gap(box, other) <= AT) & beside)


def _toward(box: YawBox, other: YawBox, way: tuple[float, float], reach: float) -> Flags:
    """On a side of a thing: its middle before that side of the thing, and no farther than `reach`."""
    dx, dy = box.x - other.x, box.y - other.y
    ahead = dx * way[0] + dy * way[1]
    aside = np.abs(dx * way[1] - dy * way[0])
    other_half = _half_along(other, way)
    side_half = _half_along(other, (way[1], -way[0]))
    own = _half_along(box, way)
    gap = ahead - other_half - own
    return np.asarray((gap >= -0.01) & (gap <= reach) & (aside <= max(side_half, 0.3)))


def _half_along(box: YawBox, way: tuple[float, float]) -> float:
    right, back = box.axes
    return float(abs(right @ way) * box.w + abs(back @ way) * box.d) / 2


def _on_top(base: Region, thing: Thing, survey: Survey) -> Region:
    assert thing.node is not None
    node, kind = thing.node, kinds.of(thing.label)
    if node.is_stepped_on:
        box = node.yaw_box
        return replace(base, words=f"on {survey.named(thing)}",
                       allowed=(lambda b: _within(b, box),))  # fmt: skip
    if node.support == "wall" or (kind is not None and kind.stores and node.top > 1.4):
        raise Undecidable(f"The box of {survey.named(thing)} tells its outside only, not its shelves.")
    height = survey.graph.room.size[2]
    surface = Surface(*node.position[:2], node.yaw, node.size[0], node.size[1], node.top, height)
    turns = (node.yaw % 360.0, (node.yaw + 90.0) % 360.0)
    return replace(base, surface=surface, words=f"on {survey.named(thing)}", yaws=turns, on=thing)


def _within(box: YawBox, other: YawBox) -> Flags:
    u, v = other.local(box.x, box.y)
    return np.asarray((np.abs(u) <= other.w / 2) & (np.abs(v) <= other.d / 2))


def _under(base: Region, thing: Thing, survey: Survey) -> Region:
    """Under what hangs. What stands on the floor tells only its outside: it may have legs or not."""
    assert thing.node is not None
    node, name = thing.node, survey.named(thing)
    if node.bottom <= STEP or node.support not in ("wall", "ceiling"):
        raise Undecidable(
            f"The box of {name} tells its outside, {node.size[0]:.2f} x {node.size[1]:.2f} m and {node.top:.2f} m "
            f"high, not how much room is under it."
        )
    box = node.yaw_box
    if node.support == "ceiling":
        return replace(base, words=f"under {name}", allowed=(lambda b: plan_gap(b, box) <= 0.0,), most=node.bottom)
    x, y = node.position[:2]
    side = min(sides_of(survey), key=lambda s: s.reach - x * s.normal[0] - y * s.normal[1])
    wall = _at_wall(base, side)
    way = (side.normal[1], -side.normal[0])
    half = _half_along(box, way)

    def below(b: YawBox) -> Flags:
        off = np.abs((b.x - x) * way[0] + (b.y - y) * way[1])
        return np.asarray(off <= np.maximum(half, _half_along(b, way)) - 0.5 * min(half, _half_along(b, way)) + 1e-9)

    return replace(wall, words=f"under {name}", allowed=(*wall.allowed, below), most=node.bottom, things=(thing,))


def anchors_of(wheres: Sequence[Where]) -> list[Anchor]:
    """Every anchor of some conditions."""
    return [a for w in wheres for a in w.anchors]

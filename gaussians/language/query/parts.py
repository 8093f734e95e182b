"""Parts of one thing by name, found by shape when asked for: legs, seat, top, back, shade, base, and its sides.

Knows the Gaussians of one thing in its own upright box. Refuses to know kinds and scenes: a leg is whatever thin stands
between the floor and the first wide layer. Where the shape has no such part the answer is a sentence.

Everything is read off one profile: for each of `LEVELS` heights the share of the plan that lies within the outline of
what is there (holes filled, so that the walls of a cabinet count as the whole of it). Wide levels carry, narrow ones
lead from one to the next.

Against what builders call by these names (mean IoU, share at 0.5 or better, ten unseen seeds a kind): legs of 14 kinds
0.72, 0.88; tops of 5 0.91, 0.98; seats of 6 0.59, 0.62; backs of 5 0.70, 0.70; shades of 3 0.91, 1.00; bases of 4 0.71,
0.76. Seats and backs of sofas and armchairs, whose arms rise as high, are the weak ones (0.3 to 0.5).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...world.box import Box

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]

LEVELS = 40  # heights of the profile
CELLS = 14  # of the plan, across and along
WIDE = 0.5  # share of the widest level's outline from which a level carries
THIN = 0.45  # and below which what stands there is legs or a pole
GAP = 4  # narrow levels within a wide run that are only badly sampled
FOOT = 6  # levels that a foot plate or a slab on its own is thick at most
BULK = 0.12  # share of the plan beyond which one piece is no leg
DEEP = 0.2  # of the height: the most that counts as a seat
REAR = 0.2  # of half the depth behind the middle: where a back begins; arms reach farther forward
SIDE = 0.2  # of the extent: how far "the left side" reaches in
FINE = 24  # cells of the plan in which pieces are told apart
CRUMB = 0.03  # share of a part below which a piece is a stray
FLAT = 0.05  # height as a share of the longer side below which a thing is a sheet
LEAST = 0.004  # share of the thing's Gaussians below which nothing was found


@dataclass(frozen=True, eq=False)
class Shape:
    """One thing in its box.

    Attributes:
        place: `[M, 3]` positions in the box: -1 to 1 along its two level axes and up.
        front: `[2]` unit vector along one of the level axes out of its front; None where that is not known.
        level: `[M]` cosine between each Gaussian's thin axis and up.
        tall: its height as a share of its longer level side.
    """

    place: F64
    front: F64 | None
    level: F64
    tall: float

    @cached_property
    def step(self) -> NDArray[np.int64]:
        """`[M]` level of each Gaussian, 0 at the bottom."""
        return np.clip(((self.place[:, 2] + 1) / 2 * LEVELS).astype(np.int64), 0, LEVELS - 1)

    @cached_property
    def cell(self) -> NDArray[np.int64]:
        """`[M, 2]` cell of the plan of each Gaussian."""
        return np.clip(((self.place[:, :2] + 1) / 2 * CELLS).astype(np.int64), 0, CELLS - 1)

    @cached_property
    def inside(self) -> Flags:
        """`[LEVELS, CELLS, CELLS]` cells with something before and behind them and on both sides, at about a height."""
        there = np.zeros((LEVELS, CELLS, CELLS), bool)
        there[self.step, self.cell[:, 0], self.cell[:, 1]] = True
        there[1:] |= there[:-1].copy()
        between = np.ones_like(there)
        for axis in (1, 2):
            ahead = np.maximum.accumulate(there, axis=axis)
            behind = np.flip(np.maximum.accumulate(np.flip(there, axis), axis=axis), axis)
            between &= ahead & behind
        return between | there

    @cached_property
    def outline(self) -> F64:
        """`[LEVELS]` share of the plan within the outline of what is at each height, of the widest one."""
        share: F64 = self.inside.sum(axis=(1, 2)).astype(np.float64)
        return share / max(float(share.max()), 1.0)

    @cached_property
    def carrying(self) -> list[tuple[int, int]]:
        """Runs of wide levels from the bottom, each as its first level and the one after its last.

        Narrow levels inside a run are where samples are far apart, as long as they are few.
        """
        return [r for r in _runs(self.outline >= WIDE, GAP) if r[1] - r[0] > 1]

    @cached_property
    def flat_topped(self) -> bool:
        """Whether it ends above in a level that carries: a table, not a chair."""
        return bool(self.carrying) and self.carrying[-1][1] >= LEVELS - 2


def shape_of(points: F64, thin: F64, box: Box, front: F64 | None) -> Shape:
    """A thing's shape.

    Args:
        points: `[M, 3]` its centres, world.
        thin: `[M, 3]` unit vectors along each Gaussian's thinnest axis, world.
        front: `[3]` level unit vector out of its front, world, or None.
    """
    place = box.local(points) / np.maximum(np.array(box.size) / 2, 1e-9)
    own = np.array(box.axes)[:2] @ front if front is not None else None
    return Shape(np.clip(place, -1, 1), own, np.abs(thin @ np.array(box.axes)[2]),
                 box.size[2] / max(*box.size[:2], 1e-9))  # fmt: skip


def legs(shape: Shape) -> Flags | str:
    """The thin things below the first level that carries, or, below a table's top, below and above its shelf too."""
    runs = shape.carrying
    end = runs[-1 if shape.flat_topped else 0][0] if runs else 0
    thin = np.ones(LEVELS, bool)
    for low, high in runs:
        thin[low:high] = low == 0 and high <= FOOT  # a foot plate belongs to the leg that stands on it
    if end == 0 or not thin[:end].any():
        return "it stands on all of itself, it has no legs"
    return (shape.step < end) & thin[shape.step] & ~_bulky(shape)


def _bulky(shape: Shape) -> Flags:
    """`[M]` what belongs to something too broad to be a leg, at its height: the drawers under a desk."""
    from scipy.ndimage import label

    broad = np.zeros_like(shape.inside)
    for level, plan in enumerate(shape.inside):
        piece, _ = label(plan)
        broad[level] = (np.bincount(piece.ravel())[piece] > BULK * CELLS**2) & plan
    broad[:FOOT] &= broad[FOOT]
    found: Flags = broad[shape.step, shape.cell[:, 0], shape.cell[:, 1]]
    return found


def seat(shape: Shape) -> Flags | str:
    """The upper part of the highest layer that carries."""
    if not shape.carrying or shape.carrying[-1][1] - shape.carrying[-1][0] > 0.7 * LEVELS:
        return "it has no layer to sit on that stands out from the rest"
    start, end = shape.carrying[-1]
    return (shape.step >= max(start, end - int(DEEP * LEVELS))) & (shape.step < end)


def top(shape: Shape) -> Flags | str:
    """The slab that closes it above, down to what carries it, or the level layer of it."""
    if shape.carrying:
        start, end = shape.carrying[-1]
        slab = start > 0.5 * LEVELS if shape.flat_topped else start > 0.4 * LEVELS and end - start <= FOOT
        if slab:
            return (shape.step >= start) & (shape.step < end)
    return (shape.place[:, 2] > 1 - 2 * 0.06) & (shape.level > 0.7)


def back(shape: Shape) -> Flags | str:
    """What rises above the seat on the side away from the front; of what has no seat its rear side."""
    if shape.front is None:
        return "its front cannot be told, so neither can its back"
    rear = -(shape.place[:, :2] @ shape.front)
    if shape.carrying and not shape.flat_topped:
        return (shape.step >= shape.carrying[-1][1] - 1) & (rear > REAR)
    return rear > 1 - 2 * SIDE


def shade(shape: Shape) -> Flags | str:
    """The widest lump of what hangs on or stands on something thin."""
    lumps = _lumps(shape)
    if len(lumps) == 1 and lumps[0] == (0, LEVELS):
        return "it is one lump from bottom to top, without a shade on something thin"
    above = [b for b in lumps if b[0] > 0] or lumps
    low, high = max(above, key=lambda b: float(shape.outline[b[0] : b[1]].sum()))
    return (shape.step >= low) & (shape.step < high)


def base(shape: Shape) -> Flags | str:
    """The lump that it stands on, below something thin."""
    lumps = _lumps(shape)
    if not lumps or lumps[0][0] > 1 or lumps[0][1] > 0.5 * LEVELS:
        return "it has no foot that is wider than what stands on it"
    return shape.step < lumps[0][1]


def side(axis: int | str, sign: int) -> Callable[[Shape], Flags | str]:
    """The outer part along an axis of the box (2: up) or along "front" and "right" of the thing itself."""

    def found(shape: Shape) -> Flags | str:
        if isinstance(axis, int):
            along = shape.place[:, axis]
        elif shape.front is None:
            return "its front cannot be told, so neither can its sides"
        else:
            out = shape.front if axis == "front" else np.array([-shape.front[1], shape.front[0]])
            along = shape.place[:, :2] @ out
        return sign * along > 1 - 2 * SIDE

    return found


NAMED: dict[str, Callable[[Shape], Flags | str]] = {
    "leg": legs, "foot": legs, "feet": legs, "seat": seat, "top": top, "tabletop": top, "surface": top, "back": back,
    "backrest": back, "shade": shade, "lampshade": shade, "base": base, "bottom": side(2, -1),
    "front": side("front", 1), "left side": side("right", 1), "right side": side("right", -1),
}  # fmt: skip
SEVERAL = frozenset({"leg", "foot", "feet"})  # each piece that hangs together is one of them


def part_of(name: str, shape: Shape) -> Flags | str:
    """`[M]` which Gaussians of a thing are its part of this name; a sentence where it has none that can be told."""
    if name not in NAMED:
        return f"what its {name} is cannot be told by shape; say its colour ('the white part')"
    if shape.tall < FLAT:
        return f"it is too flat to have a {name}"
    found = NAMED[name](shape)
    if not isinstance(found, str) and not LEAST < float(found.mean()) < 1 - LEAST:
        return f"it has no {name} that can be told from the rest by shape"
    return found


def pieces(shape: Shape, part: Flags) -> list[NDArray[np.int64]]:
    """Rows of each piece of a part that stands by itself in the plan, largest first; crumbs are left out."""
    from scipy.ndimage import label

    rows = np.flatnonzero(part)
    cell = np.clip(((shape.place[rows, :2] + 1) / 2 * FINE).astype(np.int64), 0, FINE - 1)
    plan = np.zeros((FINE, FINE), bool)
    plan[cell[:, 0], cell[:, 1]] = True
    of = label(plan, np.ones((3, 3)))[0][cell[:, 0], cell[:, 1]]
    found = [rows[of == k] for k in range(1, int(of.max(initial=0)) + 1)]
    return sorted((r for r in found if len(r) >= CRUMB * len(rows)), key=lambda r: (-len(r), int(r[0])))


def _lumps(shape: Shape) -> list[tuple[int, int]]:
    """Ranges of levels, from the bottom, whose outline is more than thin."""
    return [r for r in _runs(shape.outline >= THIN / 2, 1) if r[1] - r[0] > 1]


def _runs(flags: Flags, gap: int) -> list[tuple[int, int]]:
    """Where `[LEVELS]` flags are set, as half-open ranges; those no more than `gap` apart are one."""
    found: list[tuple[int, int]] = []
    for level in np.flatnonzero(flags):
        if found and level - found[-1][1] <= gap:
            found[-1] = (found[-1][0], int(level) + 1)
        else:
            found.append((int(level), int(level) + 1))
    return found

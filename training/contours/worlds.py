"""Compose scenes of solids with a number for each thing: rooms, tables, shelves, things in the air.

A world is geometry only; `shading` draws materials, light and views for it. Number 0 is the void, structure follows
from 1 (floor, walls, ceiling), then things.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ...gaussians import assets
from ...gaussians.assets.furnishing import recipes
from ...gaussians.assets.furnishing.layout import Layout
from . import solids
from .solids import Solid

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]
SMALL, LARGE = (0.06, 0.4), (0.4, 1.9)  # metres, longest side of things on a table and on the floor
STRUCTURE = 6  # numbers 1 to 6 are floor, four walls, ceiling


@dataclass(frozen=True, eq=False)
class World:
    """A scene without light.

    Attributes:
        solid: all triangles in world space, z up; parts are numbered through all things.
        local: `[F, 3, 2]` texture coordinates of the corners, metres.
        thing: `[F]` number of the thing of each face.
        looks: for each part its role ("floor", "wall" or "thing") and thing.
        targets: `[T, 3]` points worth looking at.
        inside: low and high corner of where cameras may stand, and how far from a target.
    """

    solid: Solid
    local: F32
    thing: I32
    looks: tuple[tuple[str, int], ...]
    targets: F32
    inside: tuple[F32, F32, tuple[float, float]]


@dataclass
class Stage:
    """A world being built."""

    rng: np.random.Generator
    pool: tuple[Solid, ...]
    placed: list[tuple[Solid, F32, int, str]] = field(default_factory=list)
    count: int = STRUCTURE
    targets: list[F32] = field(default_factory=list)

    def structure(self, number: int, solid: Solid) -> None:
        """Add a part of floor (1), wall (2 to 5) or ceiling (6), already in its place."""
        self.placed.append((solid, _projected(solid), number, "floor" if number == 1 else "wall"))

    def add(self, local: Solid, matrix: NDArray[np.floating], offset: F32, role: str = "thing") -> Solid:
        """Add a thing of its own; returns it in world space."""
        self.count += 1
        solid = local.transformed(matrix, offset)
        self.placed.append((solid, _projected(local), self.count, role))
        points = solid.corners.reshape(-1, 3)
        self.targets.append((points.min(axis=0) + points.max(axis=0)) / 2)
        return solid

    def any_solid(self, low: float, high: float) -> Solid:
        """A random body between two lengths: mostly an object, sometimes a simple shape, each stretched a little."""
        rng = self.rng
        longest = float(np.exp(rng.uniform(np.log(low), np.log(high))))
        draw = rng.random()
        if draw < 0.72:
            solid = self.pool[int(rng.integers(len(self.pool)))]
        elif draw < 0.84:
            w, d, h = (longest * rng.uniform(0.1, 1, 3)).tolist()
            solid = solids.block(w, d, h)
        elif draw < 0.93:
            solid = solids.lathe(rng, longest, longest * rng.uniform(0.1, 0.7))
        elif draw < 0.97:
            solid = solids.foliage(rng, longest)
        else:
            solid = solids.wheel(rng, longest / 2)
        stretch = np.diag(np.exp(rng.normal(size=3) * 0.15))
        return solid.sized(longest).transformed(stretch).standing()

    def world(self, inside: tuple[F32, F32, tuple[float, float]]) -> World:
        """Everything added so far as a world."""
        looks: list[tuple[str, int]] = []
        columns = []
        for solid, local, number, role in self.placed:
            columns.append((replace(solid, part=solid.part + len(looks)), local, np.full(len(local), number, np.int32)))
            looks += [(role, number)] * (int(solid.part.max()) + 1)
        whole = solids.merged([s for s, _, _ in columns])
        local, thing = (np.concatenate([c[i] for c in columns]) for i in (1, 2))
        return World(whole, local, thing, tuple(looks), np.array(self.targets, np.float32), inside)


def _projected(solid: Solid) -> F32:
    """Texture coordinates `[F, 3, 2]`: corners seen along the axis that each face's normal is closest to."""
    c = solid.corners
    normal = np.abs(np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0]))
    axes = np.array([[1, 2], [0, 2], [0, 1]])[normal.argmax(axis=1)]
    uv: F32 = np.take_along_axis(c, axes[:, None, :].repeat(3, axis=1), axis=2)
    return uv


def _turn(rng: np.random.Generator, free: bool = False) -> NDArray[np.float64]:
    """A rotation about the vertical axis; `free` about any, or in one case of six onto a side."""
    if free:
        q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        return np.asarray(q * np.sign(np.linalg.det(q)))
    a = rng.uniform(0, 2 * np.pi) if rng.random() < 0.6 else rng.choice([0, np.pi / 2, np.pi, -np.pi / 2])
    yaw = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    if rng.random() < 0.15:
        yaw = yaw @ np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    return yaw


class Heights:
    """Height of what lies on a square ground of `side` metres, to put the next thing on top."""

    def __init__(self, side: float, level: float, cells: int = 96) -> None:
        self.grid = np.full((cells, cells), level, np.float32)
        self.side, self.cells = side, cells

    def _cells(self, xy: F32) -> NDArray[np.int64]:
        return np.clip(((xy / self.side + 0.5) * self.cells).astype(np.int64), 0, self.cells - 1)

    def rest(self, solid: Solid, x: float, y: float) -> float:
        """The height at which a solid above `x, y` first touches."""
        points = solid.corners.reshape(-1, 3)[:, :2] * 0.85
        at = self._cells(points + np.array([x, y], np.float32))
        low, high = at.min(axis=0), at.max(axis=0) + 1
        return float(self.grid[low[0] : high[0], low[1] : high[1]].max())

    def cover(self, solid: Solid) -> None:
        """Raise the ground to the top of a solid in world space."""
        points = np.concatenate([solid.corners.reshape(-1, 3), solid.corners.mean(axis=1)])
        at = self._cells(points[:, :2])
        np.maximum.at(self.grid, (at[:, 0], at[:, 1]), points[:, 2])


def _scatter(stage: Stage, heights: Heights, count: int, sizes: tuple[float, float], spread: float) -> None:
    """Put things on the ground or on top of each other."""
    rng = stage.rng
    heap = rng.normal(size=2) * spread * 0.3
    for _ in range(count):
        solid = stage.any_solid(*sizes)
        turned = solid.transformed(_turn(rng)).standing()
        x, y = (heap + rng.normal(size=2) * 0.15 * spread) if rng.random() < 0.4 else rng.uniform(-0.5, 0.5, 2) * spread
        z = heights.rest(turned, float(x), float(y))
        heights.cover(stage.add(turned, np.eye(3), np.array([x, y, z], np.float32)))


def _shell(stage: Stage, w: float, d: float, h: float, ceiling: bool = True) -> None:
    """Floor, four walls and ceiling of a room centred on the origin."""
    up = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # a sheet turned upright, facing -y
    stage.structure(1, solids.sheet(w, d))
    for number, (yaw, length, out) in enumerate(((0, w, d), (90, d, w), (180, w, d), (270, d, w))):
        a = np.radians(yaw)
        turn = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
        wall = solids.sheet(length, h).transformed(up, (0, out / 2, h / 2)).transformed(turn)
        stage.structure(2 + number, wall)
    if ceiling:
        stage.structure(6, solids.sheet(w, d).transformed(np.diag([1.0, 1, -1]), (0, 0, h)))


def _hang(stage: Stage, w: float, d: float, h: float) -> None:
    """Flat things on the walls: pictures, boards, shelves, curtains."""
    rng = stage.rng
    for _ in range(int(rng.integers(0, 7))):
        side = int(rng.integers(4))
        length, out = ((w, d), (d, w))[side % 2]
        a, thick = np.radians(90 * side), float(rng.choice([0.004, 0.02, 0.05, 0.25]))
        turn = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
        size = np.exp(rng.uniform(np.log(0.15), np.log(1.6), 2))
        if rng.random() < 0.2:  # a curtain
            grid_u, grid_v = np.meshgrid(np.linspace(-0.5, 0.5, 41), np.linspace(0, 1, 6), indexing="ij")
            waves = 0.04 * np.sin(grid_u * rng.uniform(20, 80))
            grid = np.stack([grid_u * size[0], waves, grid_v * h * 0.9], axis=-1)[None]
            corners, normals = solids._grid(grid)
            thing = Solid(corners, normals, np.full(corners.shape, 0.5, np.float32), np.zeros(len(corners), np.int32))
            low = 0.0
        else:
            thing = solids.block(size[0], thick, size[1])
            low = float(rng.uniform(0, max(0.1, h - size[1])))
        x = rng.uniform(-0.5, 0.5) * max(0.1, length - size[0])
        at = turn @ np.array([x, out / 2 - thick / 2 - 0.003, low])
        stage.add(thing, turn, at.astype(np.float32))


def bare_room(rng: np.random.Generator, pool: tuple[Solid, ...]) -> World:
    """A room of four walls with rugs, hung things, and objects of any scale that stand and pile up on the floor."""
    stage = Stage(rng, pool)
    w, d = rng.uniform(2.2, 6, 2).tolist()
    h = float(rng.uniform(2.2, 3))
    _shell(stage, w, d, h)
    _hang(stage, w, d, h)
    heights = Heights(max(w, d), 0.0)
    if rng.random() < 0.4:
        long, wide = rng.uniform(0.8, 2.2, 2).tolist()
        rug = solids.block(long, wide, 0.008)
        heights.cover(stage.add(rug, _turn(np.random.default_rng(int(rng.integers(99)) + 1)), np.zeros(3, np.float32)))
    _scatter(stage, heights, int(rng.integers(4, 16)), LARGE, min(w, d) * 0.9)
    _scatter(stage, heights, int(rng.integers(4, 16)), (0.1, 0.5), min(w, d) * 0.8)
    low, high = np.array([-w / 2 + 0.3, -d / 2 + 0.3, 0.5]), np.array([w / 2 - 0.3, d / 2 - 0.3, h - 0.4])
    return stage.world((low.astype(np.float32), high.astype(np.float32), (0.8, 4.0)))


def furnished_room(rng: np.random.Generator, pool: tuple[Solid, ...]) -> World:
    """A room that our own recipes furnish, with true triangles in place of Gaussians, and loose objects on top."""
    stage = Stage(rng, pool)
    name = str(rng.choice(list(recipes.RECIPES)))
    recipe, widths, depths = recipes.RECIPES[name]
    w, d, h = float(rng.uniform(*widths)), float(rng.uniform(*depths)), float(rng.uniform(2.4, 2.9))
    layout = Layout(w, d, h, ("north", "west", "east", "south"), rng)
    get = recipes.Supplier(rng, 0.3)
    recipes.openings(layout, get)
    recipe(layout, get)
    recipes.fill_up(layout, get, int(rng.integers(10, 24)))
    _shell(stage, w, d, h)
    heights = Heights(max(w, d), 0.0)
    for thing in layout.things:
        solid = solids.own(thing.asset.kind, thing.asset.seed, thing.asset.size)
        a = np.radians(thing.box.yaw)
        turn = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
        at = np.array([thing.box.x, thing.box.y, thing.box.low], np.float32)
        heights.cover(stage.add(solid, turn, at))
    _scatter(stage, heights, int(rng.integers(0, 10)), (0.08, 0.5), min(w, d) * 0.9)
    low, high = np.array([-w / 2 + 0.3, -d / 2 + 0.3, 0.6]), np.array([w / 2 - 0.3, d / 2 - 0.3, h - 0.3])
    return stage.world((low.astype(np.float32), high.astype(np.float32), (0.7, 4.0)))


def table(rng: np.random.Generator, pool: tuple[Solid, ...]) -> World:
    """Small things standing, lying and piled on a table or desk before walls."""
    stage = Stage(rng, pool)
    _shell(stage, 5.0, 5.0, 2.6)
    side, level = float(rng.uniform(0.5, 1.6)), float(rng.uniform(0.4, 0.9))
    top = solids.block(side, side * rng.uniform(0.5, 1), 0.04)
    parts = [top.transformed(np.eye(3), (0, 0, level - 0.04))]
    for sx, sy in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        leg = solids.block(0.05, 0.05, level - 0.04)
        half = top.size[:2] / 2 - 0.03
        parts.append(leg.transformed(np.eye(3), (sx * half[0], sy * half[1], 0)))
    stage.add(solids.merged(parts), np.eye(3), np.zeros(3, np.float32))
    stage.targets.clear()
    heights = Heights(side * 1.4, level)
    if rng.random() < 0.3:
        long, wide = (side * rng.uniform(0.2, 0.7, 2)).tolist()
        cloth = solids.block(long, wide, 0.004)
        heights.cover(stage.add(cloth, _turn(rng), np.array([0, 0, level], np.float32)))
    _scatter(stage, heights, int(rng.integers(5, 22)), SMALL, side * 0.8)
    low, high = np.array([-2.2, -2.2, level + 0.15]), np.array([2.2, 2.2, level + 1.2])
    return stage.world((low.astype(np.float32), high.astype(np.float32), (0.4, 1.6)))


def shelf(rng: np.random.Generator, pool: tuple[Solid, ...]) -> World:
    """A shelf of boards against a wall, full of rows of books, boxes and small things that touch each other."""
    stage = Stage(rng, pool)
    _shell(stage, 4.0, 3.0, 2.6)
    rows, width, deep = int(rng.integers(2, 6)), float(rng.uniform(0.6, 2)), float(rng.uniform(0.2, 0.4))
    step, base = float(rng.uniform(0.22, 0.45)), float(rng.uniform(0, 0.4))
    boards = [solids.block(width, deep, 0.02).transformed(np.eye(3), (0, 0, base + i * step)) for i in range(rows + 1)]
    if rng.random() < 0.7:
        sides = solids.block(0.02, deep, rows * step)
        boards += [sides.transformed(np.eye(3), (s * width / 2, 0, base)) for s in (-1, 1)]
    if rng.random() < 0.5:
        boards.append(solids.block(width, 0.01, rows * step).transformed(np.eye(3), (0, deep / 2, base)))
    back = np.array([0, 1.5 - deep / 2 - 0.01, 0], np.float32)
    stage.add(solids.merged(boards), np.eye(3), back)
    for row in range(rows):
        x = -width / 2 + 0.02
        books = rng.random() < 0.6
        while x < width / 2 - 0.08:
            room = float(width / 2 - 0.02 - x)
            if books and rng.random() < 0.9:
                w = min(room, float(rng.uniform(0.015, 0.07)))
                solid = solids.block(w, deep * rng.uniform(0.5, 0.9), step * rng.uniform(0.5, 0.92))
            else:
                solid = stage.any_solid(0.08, step * 0.85)
                solid = solid.transformed(np.diag([*np.minimum(1, [room, deep] / solid.size[:2]), 1.0])).standing()
            at = np.array([x + solid.size[0] / 2, rng.normal() * 0.02, base + row * step + 0.021], np.float32)
            stage.add(solid, np.eye(3), at + back)
            x += float(solid.size[0]) + (0.002 if books else float(rng.uniform(0.0, 0.15)))
    _scatter(stage, Heights(3.0, 0.0), int(rng.integers(0, 6)), (0.2, 1.0), 2.0)
    return stage.world((np.array([-1.7, -1.3, 0.4], np.float32), np.array([1.7, 1.1, 2.2], np.float32), (0.5, 2.4)))


def floating(rng: np.random.Generator, pool: tuple[Solid, ...]) -> World:
    """Things of all sizes in any position in the air before a wall: dense occlusions of arbitrary outlines."""
    stage = Stage(rng, pool)
    _shell(stage, 6.0, 6.0, 3.0)
    for _ in range(int(rng.integers(15, 60))):
        solid = stage.any_solid(0.1, 1.0)
        at = rng.normal(size=3) * [1.0, 0.6, 0.7] + [0, 0.5, 1.4]
        stage.add(solid, _turn(rng, free=True), at.astype(np.float32))
    return stage.world((np.array([-2, -2.8, 0.5], np.float32), np.array([2, -1.5, 2.3], np.float32), (1.0, 4.0)))


MAKERS: dict[str, tuple[Callable[[np.random.Generator, tuple[Solid, ...]], World], float]] = {
    "furnished room": (furnished_room, 0.3),
    "bare room": (bare_room, 0.2),
    "table": (table, 0.25),
    "shelf": (shelf, 0.1),
    "floating": (floating, 0.15),
}


def make(rng: np.random.Generator, pool: tuple[Solid, ...]) -> tuple[str, World]:
    """A random world and the name of its kind."""
    names = list(MAKERS)
    name = names[int(rng.choice(len(names), p=[MAKERS[n][1] for n in names]))]
    return name, MAKERS[name][0](rng, pool)


def pool_of(foreign: list[Solid], rng: np.random.Generator, designs: int = 2) -> tuple[Solid, ...]:
    """Foreign objects, and `designs` of each kind of our own furniture."""
    ours = [solids.own(kind, int(rng.integers(1 << 30))) for kind in assets.kinds() for _ in range(designs)]
    return tuple(foreign + [s for s in ours if len(s.corners) <= solids.MAX_FACES])

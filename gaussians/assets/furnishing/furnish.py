"""`furnish`: generate a furnished room from a seed, as a scene with the ground truth about its things.

The returned scene has no groups; measurements compare with `Room.truth`.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from torch import Tensor

from ...camera import Vec3
from ...errors import UserError
from ...scene import Frame, Scene
from ...world import kinds
from ..registry import find
from . import recipes
from .assemble import raised
from .layout import Layout, Placed
from .viewpoints import cameras

WALLS = ("north", "west", "east", "south")


@dataclass(frozen=True)
class TruthObject:
    """The ground truth of one object.

    Attributes:
        id: its number in `Truth.ids`.
        kind: canonical kind name.
        color: basic name of its main colour.
        size: (w, d, h) of its oriented box, metres.
        position: centre of that box, world, metres.
        yaw: degrees counter-clockwise from facing -y.
        support: id of the object that it stands on, or "floor", "wall", "ceiling".
        parts: part names.
    """

    id: int
    kind: str
    color: str
    size: Vec3
    position: Vec3
    yaw: float
    support: int | str
    parts: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Truth:
    """Ground truth of a scene: `ids` `[N]` int32, object of each Gaussian (-1: floor and walls), and the objects."""

    ids: Tensor
    objects: tuple[TruthObject, ...]


@dataclass(frozen=True, eq=False)
class Room:
    """A furnished room: its scene, ground truth, kind and inner size (w, d, h) in metres."""

    scene: Scene
    truth: Truth
    kind: str
    size: Vec3


def room_kinds() -> tuple[str, ...]:
    """The kinds of rooms that `furnish` can make."""
    return tuple(recipes.RECIPES)


def furnish(
    seed: int,
    kind: str = "any",
    objects: int | None = None,
    detail: float = 1.0,
    *,
    include: Sequence[str] = (),
    ceiling: bool = False,
) -> Room:
    """A furnished room; the same arguments give the same bytes.

    Args:
        seed: of all random choices.
        kind: one of `room_kinds()`, or "any".
        objects: the least number of objects to aim for (3 to 40), random from 12 to 17 if None; recipes may place more.
        detail: factor on the number of Gaussians (1: about 80,000 to 150,000 in all).
        include: kinds that are added to those of the recipe, where they fit.
        ceiling: whether the room has a ceiling.

    Raises:
        UserError: the kind of room or object is unknown, or the number is out of range.
    """
    plan = arranged(seed, kind, objects, detail, include=include)
    return assemble(plan.layout, plan.kind, plan.rng, detail, ceiling)


@dataclass(frozen=True, eq=False)
class Arranged:
    """A room before it is built: where its things stand, its kind, and the state of its random numbers."""

    layout: Layout
    kind: str
    rng: np.random.Generator


def arranged(
    seed: int, kind: str = "any", objects: int | None = None, detail: float = 1.0, *, include: Sequence[str] = ()
) -> Arranged:
    """The layout of `furnish`; with a copy of its random numbers it is built with and without a thing alike.

    Raises:
        UserError: as `furnish`.
    """
    if kind != "any" and kind not in recipes.RECIPES:
        raise UserError(f"unknown kind of room {kind!r}; known: any, {', '.join(recipes.RECIPES)}")
    if objects is not None and not 3 <= objects <= 40:
        raise UserError(f"objects must be between 3 and 40, got {objects}")
    rng = np.random.default_rng([zlib.crc32(b"room"), seed & 0xFFFFFFFF])
    names = tuple(recipes.RECIPES)
    drawn = names[int(rng.integers(len(names)))]
    name = drawn if kind == "any" else kind
    recipe, widths, depths = recipes.RECIPES[name]
    layout = Layout(
        float(rng.uniform(*widths)), float(rng.uniform(*depths)), float(rng.uniform(2.5, 2.8)), _walls(rng), rng
    )
    get = recipes.Supplier(rng, detail)
    recipes.openings(layout, get)
    for extra in include:
        find(extra)  # raises for a kind without a builder
        _add(layout, get, extra)
    recipe(layout, get)
    recipes.fill_up(layout, get, objects or int(rng.integers(12, 18)))
    return Arranged(layout, name, rng)


def _walls(rng: np.random.Generator) -> tuple[str, ...]:
    """Two to four walls; most rooms have an open south side, for views from outside."""
    draw = rng.random()
    if draw < 0.6:
        return WALLS[:3]
    if draw < 0.8:
        return ("north", "west" if rng.random() < 0.5 else "east")
    return WALLS


def _add(layout: Layout, get: recipes.Supplier, name: str) -> None:
    """Put a requested thing where its kind belongs."""
    thing, known = get(name), kinds.find(name)
    assert known is not None
    if known.support == "wall":
        for wall in layout.walls * 4:
            length = layout.w if wall in ("north", "south") else layout.d
            if (
                layout.hang(
                    thing, wall, float(layout.rng.uniform(-0.4, 0.4) * length), 1.2 if thing.size[2] < 1.2 else 0.0
                )
                is not None
            ):
                return
    elif known.support == "surface":
        stand = layout.against(get("cabinet"))
        if stand is None or layout.on_top(thing, stand) is None:
            layout.anywhere(thing, 0.1)
    elif known.backed:
        layout.against(thing)
    else:
        layout.anywhere(thing, 0.15, edge=False)


# --- assembly --------------------------------------------------------------------------------------------------------


def assemble(layout: Layout, name: str, rng: np.random.Generator, detail: float, ceiling: bool) -> Room:
    """The room of a layout, with its scene and ground truth."""
    built = raised(layout, rng, detail, ceiling)
    truth = Truth(built.owner, tuple(_describe(i, t) for i, t in enumerate(layout.things)))
    frame = Frame((0.0, 0.0, 1.0), 0.0, 1.0, "given", "given")
    scene = Scene(built.cloud, frame, cameras(layout))
    return Room(scene, truth, name, (layout.w, layout.d, layout.h))


def _describe(index: int, thing: Placed) -> TruthObject:
    b = thing.box
    return TruthObject(
        id=index,
        kind=thing.asset.kind,
        color=thing.asset.color,
        size=(b.w, b.d, b.h),
        position=(b.x, b.y, b.low + b.h / 2),
        yaw=(b.yaw + 180) % 360 - 180,
        support=thing.support,
        parts=thing.asset.parts.names,
    )

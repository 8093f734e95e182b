"""Deletions in furnished rooms as a capture shows them, each with the same room made without the thing as truth."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.assets.furnishing.furnish import Arranged, Room, arranged, assemble
from ...gaussians.assets.furnishing.layout import Layout
from ...gaussians.camera import Camera
from ...gaussians.cloud import GaussianCloud
from ...gaussians.render import contributions
from ...gaussians.scene import Scene

Place = Literal["floor", "wall", "table top", "corner", "clutter"]
PLACES: tuple[Place, ...] = ("floor", "wall", "table top", "corner", "clutter")

EYES = 36  # photographs of a room
_WIDTH, _HEIGHT = 288, 192  # of the pictures in which a Gaussian must show
_SHOWS = 0.02  # pixels that a Gaussian must fill in all photographs, added up, so that a fit would have it
_CORNER = 0.5  # metres: nearer than this to two walls is a corner, to one a wall
_NEIGHBOURS = 2  # other things within `_CLOSE` that make clutter
_CLOSE = 0.35
_SMALLEST = 0.12  # metres, longest side of a thing that is deleted


@dataclass(frozen=True, eq=False)
class Deletion:
    """A thing of a room that is deleted.

    Attributes:
        name: of the room and the thing.
        place: where it stood.
        before: what photographs of the room show; what none shows is not there.
        gone: `[N]` bool, the thing and what stands on it.
        truth: the room made without them.
        size: of the room, metres.
        middle: of the thing, `[3]`, and `extent`, its longest side.
    """

    name: str
    place: Place
    before: Scene
    gone: Tensor
    truth: GaussianCloud
    size: tuple[float, float, float]
    middle: NDArray[np.float64]
    extent: float


def deletions(seed: int, most: int) -> Iterator[Deletion]:
    """At most `most` deletions in the room of a seed, of different places first."""
    plan = arranged(seed)
    room = _built(plan, set())
    eyes = photographs(room)
    shows = torch.zeros(len(room.scene.cloud))
    for eye in eyes:
        shows += contributions(room.scene.cloud, eye)
    seen = shows > _SHOWS
    owner = room.truth.ids[seen]
    cloud = room.scene.cloud[seen].replace(group=owner.to(torch.int32))
    scene = room.scene.replace(cloud=cloud, cameras=eyes)
    for index, place in _chosen(plan.layout, room, owner)[:most]:
        goes = _with_riders(plan.layout, index)
        thing = plan.layout.things[index]
        without = _built(plan, goes).scene.cloud
        gone = torch.isin(owner, torch.tensor(sorted(goes), dtype=owner.dtype))
        box = thing.box
        yield Deletion(
            f"{seed} {thing.asset.kind}", place, scene, gone, without, room.size,
            np.array([box.x, box.y, box.low + box.h / 2]), max(box.w, box.d, box.h),
        )  # fmt: skip


def photographs(room: Room) -> tuple[Camera, ...]:
    """Views of a room at different heights that look around in it, as somebody takes them who walks through."""
    w, d, _ = room.size
    rng = np.random.default_rng(0)
    found = []
    for k in range(EYES):
        turn = 2 * np.pi * k / EYES
        out = 0.42 if k % 3 else 0.2
        eye = np.array([out * w * np.cos(turn), out * d * np.sin(turn), (0.7, 1.3, 1.8)[k % 3]])
        aim = np.array([*(rng.uniform(-0.3, 0.3, 2) * [w, d]), 0.6])
        found.append(Camera.look_at(eye, aim, (0, 0, 1), _WIDTH, _HEIGHT, 70.0, f"photograph {k}"))
    return tuple(found)


def _built(plan: Arranged, without: set[int]) -> Room:
    """The room without some of its things, under the same light."""
    layout = copy.copy(plan.layout)
    layout.things = [t for i, t in enumerate(plan.layout.things) if i not in without]
    return assemble(layout, plan.kind, copy.deepcopy(plan.rng), 1.0, False)


def _with_riders(layout: Layout, index: int) -> set[int]:
    """A thing and all that stands on it."""
    found = {index}
    while more := {i for i, t in enumerate(layout.things) if t.support in found} - found:
        found |= more
    return found


def _chosen(layout: Layout, room: Room, owner: Tensor) -> list[tuple[int, Place]]:
    """The things to delete with their places, so that places take turns."""
    by_place: dict[Place, list[int]] = {p: [] for p in PLACES}
    for index, thing in enumerate(layout.things):
        if thing.asset.kind in ("window", "door", "rug") or max(thing.asset.size) < _SMALLEST:
            continue
        if int((owner == index).sum()) >= 50:
            by_place[_place(layout, index)].append(index)
    order: list[tuple[int, Place]] = []
    while any(by_place.values()):
        order += [(by_place[p].pop(0), p) for p in PLACES if by_place[p]]
    return order


def _place(layout: Layout, index: int) -> Place:
    thing = layout.things[index]
    if thing.support == "wall":
        return "wall"
    under = layout.things[thing.support] if isinstance(thing.support, int) else None
    if under is not None and under.asset.kind != "rug":
        return "table top"
    corners = thing.box.corners()
    gaps = {
        "north": layout.d / 2 - corners[:, 1].max(), "south": layout.d / 2 + corners[:, 1].min(),
        "east": layout.w / 2 - corners[:, 0].max(), "west": layout.w / 2 + corners[:, 0].min(),
    }  # fmt: skip
    near = [side for side in layout.walls if gaps[side] < _CORNER]
    if len(near) > 1:
        return "corner"
    others = sum(
        np.hypot(t.box.x - thing.box.x, t.box.y - thing.box.y)
        < _CLOSE + (max(t.box.w, t.box.d) + max(thing.box.w, thing.box.d)) / 2
        for i, t in enumerate(layout.things)
        if i != index and t.support == "floor"
    )
    if others >= _NEIGHBOURS:
        return "clutter"
    return "wall" if near else "floor"

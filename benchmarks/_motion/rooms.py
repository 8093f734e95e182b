"""Six rooms with moving things (`moving_room`): true tracks, true groups, and a language field as composed rooms have.

Everything that stands still is built from a scene graph; what moves, and what it is let into, is put in afterwards, so
that no shadow stays behind where it stood.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.assets.modeling import make
from ...gaussians.assets.modeling.shapes import Piece
from ...gaussians.camera import Vec3
from ...gaussians.cloud import GaussianCloud, concat
from ...gaussians.color import parse
from ...gaussians.errors import UserError
from ...gaussians.language import encoders
from ...gaussians.motion.motion import Motion, Track
from ...gaussians.scene import Scene
from ...planners.rooms.build import construct
from ...planners.rooms.graph import SceneGraph
from ...tools.field_update import NewObject, append_objects, recount
from . import paths, things

I64 = NDArray[np.int64]
T = TypeVar("T")

SEED = 3  # of the rooms' paint and designs
_GRAY = (0.5, 0.5, 0.5)
_LEVEL = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def moving_room(name: str, detail: float = 1.0) -> Scene:
    """One of the six rooms, 0 to 5 s; the same arguments give the same bytes.

    Args:
        name: one of `names()`.
        detail: factor on the number of Gaussians.

    Raises:
        UserError: no room has this name.
    """
    return one_of(_ROOMS, name, "moving room")(detail)


def one_of(rooms: Mapping[str, T], name: str, what: str) -> T:
    """What makes a room, by its name.

    Args:
        what: a room of these is.

    Raises:
        UserError: none has this name.
    """
    if name not in rooms:
        raise UserError(f"no {what} is called {name!r}; choose {', '.join(rooms)}")
    return rooms[name]


def names() -> tuple[str, ...]:
    """The rooms there are."""
    return tuple(_ROOMS)


@dataclass
class Room:
    """A room into which things are put.

    Attributes:
        scene: as it is by now.
        detail: factor on the number of Gaussians.
        tracks: of what moves.
        runs: ids of each part that was put in last, by "label" or "label/part".
    """

    scene: Scene
    detail: float
    tracks: list[Track] = field(default_factory=list)
    runs: dict[str, I64] = field(default_factory=dict)

    @classmethod
    def of(cls, size: Vec3, nodes: Sequence[Node], detail: float, ceiling: bool = False) -> Room:
        """The room with what stands still."""
        graph = SceneGraph.model_validate(
            {"room": {"size": size}, "nodes": [n.data(i) for i, n in enumerate(nodes)]}
        )  # fmt: skip
        return cls(construct(graph, seed=SEED, detail=detail, ceiling=ceiling).scene, detail)

    def put(self, parts: things.Parts) -> None:
        """Put in one or more things."""
        for label in dict.fromkeys(key.split("/")[0] for key in parts):
            own = {key: pieces for key, pieces in parts.items() if key.split("/")[0] == label}
            clouds = [make.to_asset(pieces, label, _GRAY, 0, self.detail).cloud for pieces in own.values()]
            start, table = len(self.scene.cloud), self.scene.language
            for key, cloud in zip(own, clouds, strict=True):
                self.runs[key] = np.array([[start, start + len(cloud)]])
                start += len(cloud)
            whole = concat(_numbered(clouds, len(self.scene.cloud)))
            table, (group,) = append_objects(
                table, [NewObject(whole, label, _LEVEL)], self.scene.frame, encoders.load()
            )  # fmt: skip
            whole = whole.replace(group=torch.full((len(whole),), group, dtype=torch.int32))
            self.scene = self.scene.replace(cloud=concat([self.scene.cloud, whole]), language=table)

    def open_wall(self, low: Vec3, high: Vec3, behind: Sequence[Piece]) -> None:
        """Cut a hole into the walls between two corners, and put `behind` there as a part of the wall."""
        cloud, table = self.scene.cloud, self.scene.language
        assert table is not None
        walls = [g.id for g in table.groups if g.level == "structure" and g.label == "wall"]
        inside = ((cloud.means > torch.tensor(low)) & (cloud.means < torch.tensor(high))).all(dim=1)
        gone = inside & torch.isin(cloud.group, torch.tensor(walls, dtype=torch.int32))
        wall = int(cloud.group[gone][0])
        made = make.to_asset(behind, "wall", _GRAY, 0, self.detail).cloud
        made = made.replace(group=torch.full((len(made),), wall, dtype=torch.int32))
        joined = concat(_numbered([cloud[~gone], made], 0))
        self.scene = self.scene.replace(cloud=joined, language=recount(table, joined))

    def rename(self, label: str, other: str) -> None:
        """Give the things of a label another one."""
        table = self.scene.language
        assert table is not None
        groups = tuple(replace(g, label=other, names=()) if g.label == label else g for g in table.groups)
        self.scene = self.scene.replace(language=replace(table, groups=groups))

    def done(self) -> Scene:
        """The room with its motion. Its names are given, not recognised: no encoder is asked whether they fit."""
        table = self.scene.language
        assert table is not None
        named = replace(table, groups=tuple(replace(g, named_by="user") for g in table.groups))
        return self.scene.replace(language=named, motion=Motion(tuple(self.tracks), (), (), paths.START, paths.STOP))


@dataclass(frozen=True)
class Node:
    """A thing that stands still: its name, size, place in plan, the way it looks (yaw, degrees), colour and support."""

    label: str
    size: Vec3
    x: float
    y: float
    yaw: float = 0.0
    color: str = ""
    support: str | int = "floor"
    low: float = 0.0

    def data(self, number: int) -> dict[str, object]:
        """As a node of a scene graph."""
        place = (self.x, self.y, self.low + self.size[2] / 2)
        return {"id": number, "label": self.label, "size": self.size, "position": place, "yaw": self.yaw,
                "color": self.color, "support": self.support}  # fmt: skip


def _numbered(clouds: list[GaussianCloud], start: int) -> list[GaussianCloud]:
    """Clouds whose ids are their rows when they are joined from `start` on."""
    found = []
    for cloud in clouds:
        found.append(cloud.replace(ids=torch.arange(start, start + len(cloud))))
        start += len(cloud)
    return found


# --- the rooms -------------------------------------------------------------------------------------------------------


def _ball(detail: float) -> Scene:
    """A red ball rolls from beside the sofa across the rug to the opposite wall."""
    rug, begin, way = (-0.85, 1.5), -1.95, 4.34
    room = Room.of(
        (5.0, 4.0, 2.6),
        (
            Node("sofa", (2.0, 0.9, 0.8), -2.02, 0.62, 90.0, "gray"),
            Node("rug", (2.35, 1.5, 0.012), 0.325, -0.6, 0.0, "blue"),
            Node("tv stand", (1.4, 0.4, 0.5), 1.2, 1.75),
            Node("floor lamp", (0.35, 0.35, 1.6), 2.2, 1.7),
            Node("coffee table", (1.0, 0.55, 0.42), -0.6, 0.8),
        ),
        detail,
    )
    room.put(things.red_ball((begin, -0.9, 0.0)))
    thick = 0.012

    def lift(gone: float) -> float:
        x, soft = begin + gone, 0.04
        return thick * float(np.clip((x - rug[0]) / soft + 0.5, 0, 1) * np.clip((rug[1] - x) / soft + 0.5, 0, 1))

    centre = (begin, -0.9, things.BALL)
    room.tracks.append(paths.rolling(room.runs["ball"], centre, way, lift, (0.5, 3.5)))
    return room.done()


def _door(detail: float) -> Scene:
    """A brown door opens by 80 degrees into a hallway and stays open."""
    x, wall = 0.35, 1.5
    room = Room.of(
        (4.0, 3.0, 2.6),
        (
            Node("coat rack", (0.48, 0.48, 1.75), -1.2, 1.1, 0.0, "brown"),
            Node("bench", (1.2, 0.38, 0.45), -1.76, -0.3, 90.0),
            Node("potted plant", (0.45, 0.45, 1.0), 1.65, 1.15),
        ),
        detail,
    )
    w, t, h = things.LEAF
    room.open_wall((x - w / 2, wall - 0.1, -0.1), (x + w / 2, wall + 0.1, h), things.closet(x, wall))
    room.put(things.door(x, wall))
    pivot = (x - w / 2, wall - t, 0.0)
    room.tracks.append(
        paths.hinged(room.runs["door"], pivot, (0.0, 0.0, 1.0), (1.0, 1.5, 2.0, 2.5), (0, -26, -62, -80), "door")
    )
    return room.done()


def _drawer(detail: float) -> Scene:
    """The top drawer of a white dresser slides out by 30 cm and back in."""
    room = Room.of(
        (4.0, 4.0, 2.6),
        (
            Node("bed", (1.6, 2.05, 0.6), -1.1, 0.9),
            Node("wardrobe", (1.3, 0.6, 2.0), 1.66, -0.4, -90.0, "brown"),
            Node("chair", (0.45, 0.5, 0.9), -1.2, -1.2, 150.0),
        ),
        detail,
    )
    drawers, body = things.dresser(0.85, 2.0)
    for drawer in reversed(drawers):  # `runs` keeps the top one, which is put in last
        room.put(drawer)
    room.put(body)
    times, way = (1.0, 2.0, 3.5, 4.5), (0.0, 0.3, 0.3, 0.0)
    room.tracks.append(paths.sliding(room.runs["drawer"], (0.0, -1.0, 0.0), times, way, "drawer"))
    return room.done()


def _fan(detail: float) -> Scene:
    """A ceiling fan turns once a second and stops at 4 s."""
    chairs = ((0.55, 0.75, 0.0), (-0.55, 0.75, 0.0), (0.55, -0.75, 180.0), (-0.55, -0.75, 180.0))
    room = Room.of(
        (4.0, 4.0, 2.6),
        (
            Node("dining table", (1.7, 0.95, 0.75), 0.0, 0.2),
            Node("vase", (0.16, 0.16, 0.3), 0.1, 0.2, 0.0, "blue", 0, 0.75),
            *(Node("chair", (0.45, 0.5, 0.9), x, 0.2 + y, yaw) for x, y, yaw in chairs),
        ),
        detail,
        ceiling=True,
    )
    room.put(things.ceiling_fan(0.0, 0.2, 2.6))
    runs = room.runs["ceiling fan/blades"]
    room.tracks.append(paths.spinning(runs, (0.0, 0.2, 2.3), (0.0, 4.0, 5.0), (0.0, 4.0, 4.0), "fan"))
    return room.done()


def _books(detail: float) -> Scene:
    """A red, a green and a blue book fall from a high board, one after another."""
    room = Room.of(
        (4.0, 3.6, 2.6),
        (
            Node("bookshelf", (0.9, 0.3, 1.8), -1.83, 0.3, 90.0),
            Node("desk", (1.3, 0.65, 0.75), 1.65, 0.1, -90.0),
            Node("lamp", (0.2, 0.3, 0.45), 1.7, 0.4, -90.0, "", 1, 0.75),
            Node("wall shelf", (1.4, 0.22, 0.05), 0.0, 1.69, 0.0, "brown", "wall", 1.45),
        ),
        detail,
    )
    top = _top_of(room.scene, "wall shelf")
    room.rename("wall shelf", "shelf board")  # drawn as a wall shelf; people call it a board too
    books = ((-0.42, "red", "#c8201e", 0.5), (0.0, "green", "#3c9a3f", 1.2), (0.42, "blue", "#2a5ac8", 2.0))
    for x, color, cover, start in books:
        room.put(things.book((x, 1.64, top), parse(cover)))
        middle = (x, 1.64, top + things.BOOK[2] / 2)
        room.tracks.append(paths.falling(room.runs["book"], middle, 0.42, start, f"{color} book"))
    return room.done()


def _toy(detail: float) -> Scene:
    """A green toy robot walks from the shelf, turns left and walks to the bed; a toy car stands still."""
    room = Room.of(
        (4.0, 3.4, 2.6),
        (
            Node("bed", (0.95, 2.0, 0.55), 0.5, 1.18, 90.0),
            Node("shelf", (0.9, 0.32, 1.3), -1.8, -0.45, 90.0),
            Node("toy car", (0.12, 0.24, 0.12), 0.9, -0.8, 40.0, "yellow"),
        ),
        detail,
    )
    begin, yaw = (-1.42, -0.45, 0.0), 90.0
    room.put(things.robot(begin, yaw))
    room.tracks.append(paths.walking(room.runs["toy robot"], begin, 1.5, 1.0))
    return room.done()


def _top_of(scene: Scene, label: str) -> float:
    """Height of the top of the thing with this name."""
    assert scene.language is not None
    box = next(g.box for g in scene.language.groups if g.label == label)
    return box.center[2] + box.size[2] / 2


_ROOMS: dict[str, Callable[[float], Scene]] = {
    "ball": _ball, "door": _door, "drawer": _drawer, "fan": _fan, "books": _books, "toy": _toy,
}  # fmt: skip

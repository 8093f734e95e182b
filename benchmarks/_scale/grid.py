"""Large scenes: copies of a composed room on a grid, streamed to a .ply with its language field; one room is different.

Every room has the same things, so that only the one that is different has things of a name of their own.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from ...gaussians.camera import Camera
from ...gaussians.cloud import GaussianCloud
from ...gaussians.files.fingerprint import fingerprint
from ...gaussians.files.formats import comments, inria_ply
from ...gaussians.language.field.language_field import Group
from ...gaussians.language.field.store import VERSION, field_path
from ...gaussians.scene import Scene
from ...planners.compose.api import compose
from ...planners.rooms.build import build

USUAL = "a living room with a red armchair, a blue sofa, a coffee table, a rug, a floor lamp and a bookshelf"
DIFFERENT = "a living room with a piano, a green sofa, a bicycle, a rug and a floor lamp"
RECOLORED, DELETED = "piano", "bicycle"  # things of the different room that no other has
APART = 10.0  # metres from one room to the next


@dataclass(frozen=True, eq=False)
class Grid:
    """Rooms on a grid.

    Attributes:
        usual, different: the rooms, each around the origin.
        count: rooms.
    """

    usual: Scene
    different: Scene
    count: int

    @property
    def side(self) -> int:
        return int(np.ceil(np.sqrt(self.count)))

    @property
    def special(self) -> int:
        """Number of the room that is different: one in the middle."""
        return min(self.side // 2 * self.side + self.side // 2, self.count - 1)

    @property
    def rows(self) -> int:
        return (self.count - 1) * len(self.usual.cloud) + len(self.different.cloud)

    def room(self, number: int) -> Scene:
        return self.different if number == self.special else self.usual

    def place(self, number: int) -> NDArray[np.float64]:
        """`[3]`, where a room stands."""
        return np.array([number % self.side, number // self.side, 0]) * APART

    def clouds(self) -> Iterator[GaussianCloud]:
        """The rooms in order, without ids and groups of their own."""
        for number in range(self.count):
            cloud = self.room(number).cloud
            yield cloud.replace(means=cloud.means + torch.tensor(self.place(number), dtype=torch.float32))

    def groups(self) -> Iterator[Group]:
        """The groups of all rooms."""
        first = 0
        for number in range(self.count):
            field = self.room(number).language
            assert field is not None
            step = self.place(number)
            for g in field.groups:
                x, y, z = (float(c) for c in np.array(g.box.center) + step)
                parent = g.parent + first if g.parent >= 0 else -1
                yield replace(g, id=g.id + first, parent=parent, box=replace(g.box, center=(x, y, z)))
            first += len(field.groups)

    def overview(self, width: int, height: int) -> Camera:
        """A camera that sees the whole grid from above."""
        middle = np.array([self.side - 1, self.side - 1, 0]) * APART / 2
        away = max(self.side, 2) * APART
        return Camera.look_at(middle + away * np.array([0.0, -0.75, 0.6]), middle, (0, 0, 1), width, height)

    def inside(self, width: int, height: int) -> Camera:
        """A camera in the room that is different."""
        camera = self.different.cameras[0].resized(width, height)
        pose = camera.world_to_camera.copy()
        pose[:3, 3] -= pose[:3, :3] @ self.place(self.special)
        return replace(camera, world_to_camera=pose)


def made(rows: int) -> Grid:
    """A grid of about so many Gaussians, of harmonics of degree 0."""
    usual, different = (_room(text) for text in (USUAL, DIFFERENT))
    return Grid(usual, different, max(1, round((rows - len(different.cloud)) / len(usual.cloud)) + 1))


def _room(text: str) -> Scene:
    scene = build(compose(text, planner="grammar"))
    return scene.replace(cloud=scene.cloud.with_degree(0))


def write(grid: Grid, path: Path) -> None:
    """Write the grid as a .ply, and its field beside it; no more than a room is in memory."""
    first = grid.inside(960, 640)
    scene = Scene(GaussianCloud.empty(0), grid.usual.frame, (first,))
    with open(path, "wb") as file:
        file.write(inria_ply.header(grid.rows, 0, comments.describe(scene)))
        for cloud in grid.clouds():
            inria_ply.write_rows(cloud, file)
    _write_field(grid, path)


def _write_field(grid: Grid, path: Path) -> None:
    """The field file, as `store.save_field` writes it, with the column of groups room by room."""
    groups = tuple(grid.groups())
    tables = [grid.room(number).language for number in range(grid.count)]
    width = tables[0].embeddings.shape[1] if tables[0] is not None else 0
    usual = grid.usual.language
    assert usual is not None
    header = {
        "version": VERSION, "scene": fingerprint(path), "encoder": usual.encoder, "groups": [asdict(g) for g in groups],
        "notes": usual.notes, "making": None if usual.making is None else asdict(usual.making),
        "frame": asdict(grid.usual.frame),
    }  # fmt: skip
    ends = 4 * grid.rows, 4 * (grid.rows + len(groups) * width)
    index = {
        "__metadata__": {"scenewright.field": json.dumps(header)},
        "group": {"dtype": "I32", "shape": [grid.rows], "data_offsets": [0, ends[0]]},
        "embeddings": {"dtype": "F32", "shape": [len(groups), width], "data_offsets": [ends[0], ends[1]]},
    }
    text = json.dumps(index).encode()
    text += b" " * (-len(text) % 8)
    with open(field_path(path), "wb") as file:
        file.write(struct.pack("<Q", len(text)) + text)
        before = 0
        for number, table in enumerate(tables):
            group = grid.room(number).cloud.group.numpy()
            file.write(np.where(group >= 0, group + before, -1).astype("<i4").tobytes())
            before += len(table.groups) if table is not None else 0
        for table in tables:
            file.write(table.embeddings.astype("<f4").tobytes() if table is not None else b"")

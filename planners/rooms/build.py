"""A scene graph becomes a scene: every node Gaussians in its box, a room around them, and the truth in its table.

Knows graphs, rooms and language fields. Refuses to know words beyond labels, how designs are made (designs.py), where
things come to rest (settling.py) and how a graph came about. The scene's table of groups is written from the graph
itself, so that every edit and question works at once and names are true; colours are measured, as embedding measures
them. `SceneGraph.from_scene` reads the graph back.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import torch
from torch import Tensor

from ...gaussians.assets.furnishing.assemble import Look, Raised, raised
from ...gaussians.assets.furnishing.layout import Layout
from ...gaussians.assets.furnishing.viewpoints import eye_views, overview
from ...gaussians.assets.modeling.make import Asset
from ...gaussians.camera import Camera, Vec3
from ...gaussians.errors import UserError
from ...gaussians.language.field.language_field import Group, LanguageField, Level
from ...gaussians.language.field.measure import lab_of_cloud
from ...gaussians.language.query.terms import STRUCTURE
from ...gaussians.scene import Frame, Scene
from ...gaussians.timing import timed
from ...gaussians.world.box import Box
from ...tools.field_update import NewObject, append_objects
from .asset_folder import Shelf
from .designs import Workshop
from .node import Drawn, Node, NodeId
from .rest_heights import loads, settled

if TYPE_CHECKING:
    from ...gaussians.language.encoders import Encoder

__all__ = ["Built", "Look", "build", "construct"]

SMALLEST, LARGEST = 0.5, 60.0  # metres that a room's sides may have: below, no one stands in it; above, it is no room
MOST_THINGS = 400  # each of some thousand Gaussians
WALLS = ("north", "west", "east")  # the south is left open, for looking in
_SPARE = 256  # ids up to this much above the number of nodes are kept as they are, with empty rows between them
_LEVEL = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
# Composed rooms are looked at more than they are measured: no light behind their walls shines through.
ANY_LOOK = Look(cover=0.68)
_SKIN = 0.001  # metres: floor, walls and ceiling are as thin in the table


@dataclass(frozen=True, eq=False)
class Built:
    """A scene made of a graph.

    Attributes:
        scene: with its table of groups; group `ids[n]` is node `n`.
        ids: group of each node that was drawn. Numbers that are small enough stay; names and large numbers get one.
        blocks: nodes that nothing could be found for, drawn as plain blocks.
        notes: what is to be told, a sentence each.
        seconds: by stage.
    """

    scene: Scene
    ids: Mapping[NodeId, int]
    blocks: tuple[NodeId, ...] = ()
    notes: tuple[str, ...] = ()
    seconds: Mapping[str, float] = field(default_factory=dict)


def build(
    graph: Drawn,
    *,
    seed: int = 0,
    assets: Path | None = None,
    detail: float = 1.0,
    ceiling: bool | None = None,
    look: Look = ANY_LOOK,
) -> Scene:
    """The scene that a graph describes; see `construct`, which also tells what had to be guessed."""
    return construct(graph, seed=seed, assets=assets, detail=detail, ceiling=ceiling, look=look).scene


def construct(
    graph: Drawn,
    *,
    seed: int = 0,
    assets: Path | None = None,
    detail: float = 1.0,
    ceiling: bool | None = None,
    look: Look = ANY_LOOK,
    encoder: Encoder | None = None,
) -> Built:
    """The scene that a graph describes, and what is to be told of it; the same arguments give the same bytes.

    Args:
        graph: z up, metres; need not be free of faults (`scenewright check` tells them).
        seed: chooses designs, light, floor and paint.
        assets: folder of .glb and .ply files. A file that is named as a node is called goes before our own kinds, one
            that only resembles it after them.
        detail: factor on the number of Gaussians, 0.05 to 8.
        ceiling: whether to close the room above; None closes it if something hangs from it.
        look: floor and paint.
        encoder: of the table's vectors; None takes the one that ships with the package.

    Raises:
        UserError: the room or the graph is too large to be built, or `assets` is no folder of assets.
        FileError: the folder's index is none.
    """
    _refuse(graph, detail)
    seconds: dict[str, float] = {}
    drawn = [n for n in graph.nodes if n.label.lower().strip() not in STRUCTURE or n.label.lower().strip() == "wall"]
    with timed(seconds, "assets"):
        shop = Workshop(seed, detail, Shelf.read(assets) if assets is not None else None)
        carried = loads(graph)
        made = {n.id: shop.make(n, carried.get(n.id, ())) for n in drawn}
    things = {key: one.asset for key, one in made.items()}
    closed = any(n.support == "ceiling" for n in graph.nodes) if ceiling is None else ceiling
    with timed(seconds, "room"):
        layout = _layout(graph, drawn, things, seed)
        room = raised(layout, layout.rng, detail, closed, look)
    notes = tuple(dict.fromkeys(note for one in made.values() for note in one.notes))
    with timed(seconds, "table"):
        rows = _rows(drawn)
        # Where things stand: measured on their Gaussians, the sides would be blurred by their extents.
        boxes = {n.id: t.box.box for n, t in zip(drawn, layout.things, strict=True)}
        scene = _with_table(graph, drawn, room, rows, boxes, encoder, notes)
        cameras = (*_given(graph), overview(layout, closed), *eye_views(layout))
    blocks = tuple(key for key, one in made.items() if one.block)
    return Built(scene.replace(cameras=cameras), rows, blocks, notes, seconds)


def _refuse(graph: Drawn, detail: float) -> None:
    """Say what cannot be built before anything is.

    Raises:
        UserError: it cannot.
    """
    if not 0.05 <= detail <= 8:
        raise UserError(f"detail must be between 0.05 and 8, got {detail:g}")
    if not all(SMALLEST <= side <= LARGEST for side in graph.room.size):
        said = " x ".join(f"{side:g}" for side in graph.room.size)
        raise UserError(f"the room is {said} m; a room to build has sides of {SMALLEST:g} to {LARGEST:g} m")
    if len(graph.nodes) > MOST_THINGS:
        raise UserError(f"the graph has {len(graph.nodes)} nodes; at most {MOST_THINGS} are built into one scene")


def _layout(graph: Drawn, drawn: Sequence[Node], things: Mapping[NodeId, Asset], seed: int) -> Layout:
    """The things where they come to rest, in the order of `drawn`."""
    width, depth, height = graph.room.size
    names = zlib.crc32(" ".join(n.label for n in drawn).encode())  # two rooms of one seed need not share their paint
    layout = Layout(width, depth, height, WALLS, np.random.default_rng([names, seed & 0xFFFFFFFF]))
    boxes = settled(graph, things)
    number = {n.id: i for i, n in enumerate(drawn)}
    for node in drawn:
        support = number[node.support] if node.support in number else str(node.support)
        layout.put(things[node.id], boxes[node.id], support)
    return layout


def _given(graph: Drawn) -> tuple[Camera, ...]:
    """The graph's own viewer, who then comes first."""
    if graph.viewer is None or math.dist(graph.viewer.position, graph.viewer.target) < 1e-6:
        return ()
    eye, target = graph.viewer.position, graph.viewer.target
    if math.dist(eye[:2], target[:2]) < 1e-6:  # straight up or down, there is no right side up
        return ()
    return (Camera.look_at(eye, target, (0, 0, 1), 960, 640, 55.0, "viewer"),)


# --- the table -------------------------------------------------------------------------------------------------------


def _rows(drawn: Sequence[Node]) -> dict[NodeId, int]:
    """Row of each node: its own number where all are small numbers, else its place in the graph."""
    own = [n.id for n in drawn]
    kept = all(isinstance(i, int) and i < len(drawn) + _SPARE for i in own)
    return {key: key if kept and isinstance(key, int) else place for place, key in enumerate(own)}


def _with_table(
    graph: Drawn,
    drawn: Sequence[Node],
    room: Raised,
    rows: Mapping[NodeId, int],
    boxes: Mapping[NodeId, Box],
    encoder: Encoder | None,
    notes: tuple[str, ...],
) -> Scene:
    """The room as a scene whose groups are the graph's nodes, and floor, walls and ceiling."""
    if encoder is None:
        from ...gaussians.language import encoders

        encoder = encoders.load()
    frame = Frame((0.0, 0.0, 1.0), 0.0, 1.0, "given", "given")
    owner = room.owner.long()
    new_objects = [NewObject(room.cloud[owner == i], n.label, boxes[n.id].axes) for i, n in enumerate(drawn)]
    empty = LanguageField((), np.zeros((0, encoder.dim), dtype=np.float32), encoder.fingerprint, notes)
    table, _ = append_objects(empty, new_objects, frame, encoder)
    assert table is not None
    faces = list(dict.fromkeys(room.faces.tolist()))
    top = max(rows.values(), default=-1) + 1
    groups = [_nothing(i) for i in range(top)]
    vectors = np.zeros((top + len(faces), encoder.dim), dtype=np.float32)
    for found, node in zip(table.groups, drawn, strict=True):
        level: Level = "structure" if node.label.lower().strip() in STRUCTURE else "object"
        groups[rows[node.id]] = replace(found, id=rows[node.id], level=level, box=boxes[node.id])
        vectors[rows[node.id]] = table.embeddings[found.id]
    number = torch.tensor([*(rows[n.id] for n in drawn), 0])  # the last one for the structure, filled in below
    filed = number[owner]
    shell = torch.from_numpy(np.array([faces.index(face) for face in room.faces], dtype=np.int64))
    filed[: len(shell)] = top + shell
    for k, face in enumerate(faces):
        groups.append(_face(graph, face, top + k, room, shell == k))
    cloud = room.cloud.replace(group=filed.to(torch.int32))
    return Scene(cloud, frame, language=replace(table, groups=tuple(groups), embeddings=vectors))


def _nothing(index: int) -> Group:
    """A row that nothing is filed under, as deleted things leave one."""
    zero: Vec3 = (0.0, 0.0, 0.0)
    return Group(index, "object", -1, "", 0.0, Box(zero, _LEVEL, zero), zero, 0, 0, 0.0)


def _face(graph: Drawn, face: str, index: int, room: Raised, mine: Tensor) -> Group:
    """Floor, ceiling or one wall: its measures are the room's."""
    w, d, h = graph.room.size
    box = {
        "floor": Box((0.0, 0.0, -_SKIN / 2), _LEVEL, (w, d, _SKIN)),
        "ceiling": Box((0.0, 0.0, h - _SKIN / 2), _LEVEL, (w, d, _SKIN)),
        "north wall": Box((0.0, (d - _SKIN) / 2, h / 2), _LEVEL, (w, _SKIN, h)),
        "west wall": Box(((_SKIN - w) / 2, 0.0, h / 2), _LEVEL, (_SKIN, d, h)),
        "east wall": Box(((w - _SKIN) / 2, 0.0, h / 2), _LEVEL, (_SKIN, d, h)),
    }[face]
    lab = lab_of_cloud(room.cloud[: len(mine)][mine])
    count = int(mine.sum())
    return Group(index, "structure", -1, face.split()[-1], 1.0, box, lab, count, 0, 1.0)

"""Build a scene from a scene graph: Gaussians for every node in its box, a room around them, and the group table.

The group table is written from the graph itself, so every edit and question works at once and the names are correct;
colours are measured, as embedding measures them. designs.py makes the things, rest_heights.py finds their heights, and
`SceneGraph.from_scene` reads the graph back.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, get_args

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
from ...gaussians.world import everyday
from ...gaussians.world.box import Box
from ...tools.field_update import NewObject, append_objects
from .designs import AssetMaker
from .node import Drawn, Node, NodeId
from .own_assets import own_assets
from .rest_heights import loads, rest_boxes
from .surfacing import COMPOSED_COVER, with_materials

if TYPE_CHECKING:
    from ...gaussians.language.encoders import Encoder

__all__ = ["Built", "Look", "build", "construct"]

SMALLEST, LARGEST = 0.5, 60.0  # metres: limits of a room's sides; nobody can stand in a smaller one
MOST_THINGS = 400  # each of some thousand Gaussians
WALLS = ("north", "west", "east")  # the south is left open, for looking in
_GROUND = ("tiles", "planks", "plain")  # outdoors
_GREEN = ("tree", "bush", "rock", "tent")  # shapes of what stands on grass
_LET_IN = ("door", "window")  # into walls, on which they cast no shadow
_SPARE = 256  # ids up to this much above the number of nodes are kept as they are, with empty rows between them
_LEVEL = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
# Composed rooms are made for viewing: this cover of Gaussians lets no light from behind the walls through.
ANY_LOOK = Look(cover=COMPOSED_COVER)
_SKIN = 0.001  # metres: floor, walls and ceiling are as thin in the table


@dataclass(frozen=True, eq=False)
class Built:
    """A scene built from a graph.

    Attributes:
        scene: with its table of groups; group `ids[n]` is node `n`.
        ids: group of each node that was drawn. Small numbers stay; names and large numbers get a new one.
        blocks: nodes without an asset, drawn as plain blocks.
        notes: sentences for the user.
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
    assets: str | Path | None = None,
    detail: float = 1.0,
    ceiling: bool | None = None,
    look: Look = ANY_LOOK,
) -> Scene:
    """The scene that a graph describes; see `construct`, which also returns notes on what was assumed."""
    return construct(graph, seed=seed, assets=assets, detail=detail, ceiling=ceiling, look=look).scene


def construct(
    graph: Drawn,
    *,
    seed: int = 0,
    assets: str | Path | None = None,
    detail: float = 1.0,
    ceiling: bool | None = None,
    look: Look = ANY_LOOK,
    encoder: Encoder | None = None,
) -> Built:
    """The scene that a graph describes, with notes; the same arguments give the same bytes.

    Args:
        graph: z up, metres; it may have faults (`scenewright check` reports them).
        seed: chooses designs, light, floor and paint.
        assets: folder of .glb and .ply files, or what makes things that the library does not draw ("dream:...", see
            `own_assets`). A file with the name of a node is preferred to the asset library; one
            with a similar name is used only if the library has no such kind.
        detail: factor on the number of Gaussians, 0.05 to 8.
        ceiling: whether to close the room above; None closes it if something hangs from it.
        look: floor and paint.
        encoder: of the table's vectors; None takes the one that ships with the package.

    Raises:
        UserError: the room or the graph is too large to be built, or `assets` is no folder of assets.
        FileError: the folder's index is not valid.
    """
    _refuse(graph, detail)
    seconds: dict[str, float] = {}
    drawn = [n for n in graph.nodes if n.label.lower().strip() not in STRUCTURE or n.label.lower().strip() == "wall"]
    with timed(seconds, "assets"):
        maker = AssetMaker(seed, detail, own_assets(assets))
        carried = loads(graph)
        made = {n.id: maker.make(n, carried.get(n.id, ())) for n in drawn}
    things = {key: one.asset for key, one in made.items()}
    hung = any(n.support == "ceiling" for n in graph.nodes) and not graph.room.outdoor
    closed = hung if ceiling is None else ceiling
    if graph.room.outdoor and look.floor is None:
        look = replace(look, floor=_ground(graph, seed))
    with timed(seconds, "room"):
        layout = _layout(graph, drawn, things, seed)
        room = raised(layout, layout.rng, detail, closed, look)
    notes = tuple(dict.fromkeys(note for one in made.values() for note in one.notes))
    with timed(seconds, "table"):
        rows = _rows(drawn)
        # Boxes come from the layout: if measured on the Gaussians, their extents would blur the sides.
        boxes = {n.id: t.box.box for n, t in zip(drawn, layout.things, strict=True)}
        scene = _with_table(graph, drawn, room, rows, boxes, encoder, notes)
        cameras = (*_given(graph), overview(layout, closed), *eye_views(layout))
    with timed(seconds, "materials"):
        scene, more = with_materials(scene, graph, rows)
    with timed(seconds, "shadows"):
        scene = _with_shadows(scene)
    with timed(seconds, "light"):
        scene, dim = _with_light(scene, graph, cameras[0])
    notes = tuple(dict.fromkeys((*notes, *more, *dim)))
    blocks = tuple(key for key, one in made.items() if one.block)
    return Built(scene.replace(cameras=cameras), rows, blocks, notes, seconds)


def _refuse(graph: Drawn, detail: float) -> None:
    """Refuse a graph that cannot be built, before anything is built. Raises UserError if the detail, the room's size or
    the number of nodes is out of range."""
    if not 0.05 <= detail <= 8:
        raise UserError(f"detail must be between 0.05 and 8, got {detail:g}")
    if not all(SMALLEST <= side <= LARGEST for side in graph.room.size):
        said = " x ".join(f"{side:g}" for side in graph.room.size)
        raise UserError(f"the room is {said} m; a room to build has sides of {SMALLEST:g} to {LARGEST:g} m")
    if len(graph.nodes) > MOST_THINGS:
        raise UserError(f"the graph has {len(graph.nodes)} nodes; at most {MOST_THINGS} are built into one scene")


def _layout(graph: Drawn, drawn: Sequence[Node], things: Mapping[NodeId, Asset], seed: int) -> Layout:
    """The things at their rest positions, in the order of `drawn`."""
    width, depth, height = graph.room.size
    names = zlib.crc32(" ".join(n.label for n in drawn).encode())  # two rooms of one seed need not share their paint
    layout = Layout(width, depth, height, _walls(graph), np.random.default_rng([names, seed & 0xFFFFFFFF]))
    boxes = rest_boxes(graph, things)
    number = {n.id: i for i, n in enumerate(drawn)}
    for node in drawn:
        support = number[node.support] if node.support in number else str(node.support)
        layout.put(things[node.id], boxes[node.id], support)
    return layout


def _ground(graph: Drawn, seed: int) -> str:
    """The ground of an outdoor place: grass where trees or shrubs stand, else tiles, planks or earth."""
    green = any(everyday.shape(n.label) in _GREEN or n.label == "shrub" for n in graph.nodes)
    return "grass" if green else _GROUND[zlib.crc32(str(seed).encode()) % len(_GROUND)]


def _walls(graph: Drawn) -> tuple[str, ...]:
    """The walls that are built: all but the south one; outdoors those that something hangs on."""
    if not graph.room.outdoor:
        return WALLS
    width, depth, _ = graph.room.size
    found = set()
    for node in graph.nodes:
        if node.support == "wall":
            x, y = node.position[:2]
            gaps = {"north": depth / 2 - y, "west": width / 2 + x, "east": width / 2 - x}
            found.add(min(gaps, key=lambda wall: gaps[wall]))
    return tuple(wall for wall in WALLS if wall in found)


def _with_shadows(scene: Scene) -> Scene:
    """The scene with a shadow under each thing that stands, lies or hangs."""
    from ...tools.harmony.shadows import shadows_under_everything

    return shadows_under_everything(scene, but=_LET_IN)[0]


def _with_light(scene: Scene, graph: Drawn, viewer: Camera) -> tuple[Scene, tuple[str, ...]]:
    """The scene under the light that its graph names, and a note where no such light is known."""
    if not graph.room.light:
        return scene, ()
    from ...tools.lighting.made_rooms import in_mood
    from ...tools.lighting.moods import MoodName

    mood = next((name for name in get_args(MoodName) if name == graph.room.light), None)
    if mood is None:
        known = ", ".join(get_args(MoodName))
        return scene, (f"“{graph.room.light}” is no light that is known ({known}): it was left out",)
    return in_mood(scene, mood, viewer), ()


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
    """An empty row of the group table, like that of a deleted thing."""
    zero: Vec3 = (0.0, 0.0, 0.0)
    return Group(index, "object", -1, "", 0.0, Box(zero, _LEVEL, zero), zero, 0, 0, 0.0)


def _face(graph: Drawn, face: str, index: int, room: Raised, mine: Tensor) -> Group:
    """The group of the floor, the ceiling or one wall, with the room's measures."""
    w, d, h = graph.room.size
    box = {
        "floor": Box((0.0, 0.0, -_SKIN / 2), _LEVEL, (w, d, _SKIN)),
        "ceiling": Box((0.0, 0.0, h - _SKIN / 2), _LEVEL, (w, d, _SKIN)),
        "north wall": Box((0.0, (d - _SKIN) / 2, h / 2), _LEVEL, (w, _SKIN, h)),
        "west wall": Box(((_SKIN - w) / 2, 0.0, h / 2), _LEVEL, (_SKIN, d, h)),
        "east wall": Box(((w - _SKIN) / 2, 0.0, h / 2), _LEVEL, (_SKIN, d, h)),
    }[face]
    lab = lab_of_cloud(room.cloud[: len(mine)][mine])
    return Group(index, "structure", -1, face.split()[-1], 1.0, box, lab, int(mine.sum()), 0, 1.0)

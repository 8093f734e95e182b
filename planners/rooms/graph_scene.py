"""A scene graph as a scene in which words can be resolved: one Gaussian for each node, with its box, label and colour.

So one resolver serves scenes and graphs. The scene is not meant to be rendered. color_words.py defines the colours.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import torch

from ...gaussians.camera import Camera, Vec3
from ...gaussians.cloud import GaussianCloud
from ...gaussians.color import BASIC, name_of, plain_color
from ...gaussians.language.field.language_field import Group, LanguageField
from ...gaussians.language.query.query import Query, Relation
from ...gaussians.language.query.resolve import Resolver, resolve
from ...gaussians.language.query.selection import Selection
from ...gaussians.language.query.terms import STRUCTURE
from ...gaussians.scene import Frame, Scene
from ...gaussians.world.box import Box, distance
from ...gaussians.world.compounds import is_part
from ...gaussians.world.person import EYE_HEIGHT
from ...gaussians.world.relation_geometry import Stand
from ...gaussians.world.support import SHELL
from .color_words import NO_COLOR, color_of, hex_of
from .graph import SceneGraph
from .label_encoder import WordEncoder
from .node import Node

Id = int | str
_UP: Vec3 = (0.0, 0.0, 1.0)
_SLAB = 0.15  # metres that floor, walls and ceiling reach out, and walls also in: what hangs on one lies in that slab

# The resolver takes "furniture" for anything at all; "everything" in a graph is its things, not floor and walls.
_SIDES = ("left_of", "right_of", "in_front_of", "behind")
_READ_AS = {"furniture": "furnishing", "everything": ""}
_ROW = re.compile(r"\(group (\d+)\)")
_BEFORE_WALL = 0.45  # metres from a wall to the middle of what stands against it
_REACH = 0.3  # metres, a hand's span and a half
_UPRIGHT = ("above", "below", "under")
_BY_PAIR = ("on", "inside", "under", "below", "above", "next_to")


@dataclass(frozen=True, eq=False)
class Stage:
    """A graph with the scene in which its words are resolved.

    Attributes:
        graph: as written.
        scene: its stand-in; row and group `i` is `ids[i]`.
        ids: the graph's ids; a floor, wall or ceiling without a node has its word as id.
        encoder: compares labels with phrases.
        viewer: camera that defines left and right.
    """

    graph: SceneGraph
    scene: Scene
    ids: tuple[Id, ...]
    encoder: WordEncoder
    viewer: Camera

    @classmethod
    def of(cls, graph: SceneGraph) -> Stage:
        """The stand-in of a graph."""
        encoder = WordEncoder(tuple(dict.fromkeys(_spoken(n) for n in graph.nodes if n.label)))
        groups = [_group(i, node) for i, node in enumerate(graph.nodes)]
        ids: list[Id] = [node.id for node in graph.nodes]
        shell = [s for s in SHELL if not any(g.level == "structure" and g.label == s for g in groups)]
        for name, box in ((s, b) for s in shell for b in _slabs(s, graph)):
            groups.append(Group(len(groups), "structure", -1, name, 1.0, box, NO_COLOR, 1, 1, 1.0))
            ids.append(name)
        vectors = np.array([encoder.of(g.label) for g in groups], dtype=np.float32).reshape(len(groups), encoder.dim)
        field = LanguageField(tuple(groups), vectors, encoder.fingerprint)
        frame = Frame(_UP, 0.0, 1.0, "given", "given")
        return cls(graph, Scene(_cloud(groups), frame, language=field), tuple(ids), encoder, _viewer(graph))

    @cached_property
    def stand(self) -> Stand:
        """Where the viewer stands when saying left and right."""
        return Resolver(self.scene, self.viewer).stand

    def find(self, query: Query, last: Selection | None = None) -> Selection:
        """What a query means here.

        Raises:
            UserError: a colour word is unknown.
        """
        meant = self._read(query)
        found = self._resolve(meant, last)
        for other in _otherwise(meant, found.verdict):
            again = self._resolve(other, last)
            if again.verdict == "found" or (found.verdict, again.verdict) == ("absent", "ambiguous"):
                return again
        if found.verdict == "absent" and (near := self._beside(meant, last)) is not None:
            return near
        if found.verdict == "absent" and any(r.name in _UPRIGHT for r in meant.relations):
            again = resolve(self._leaning, meant, self.viewer, encoder=self.encoder, last=last)
            return again if again.verdict != "absent" else found
        return found

    def _resolve(self, query: Query, last: Selection | None) -> Selection:
        return resolve(self.scene, query, self.viewer, encoder=self.encoder, last=last)

    def _beside(self, query: Query, last: Selection | None) -> Selection | None:
        """The result for "next to" between small things less than `_REACH` apart, whatever their size; None if none."""
        beside = [r for r in query.relations if r.name == "next_to"]
        if len(beside) != 1 or query.pick != "one":
            return None
        near = tuple(r.model_copy(update={"name": "nearest_to"}) if r in beside else r for r in query.relations)
        found = self._resolve(query.model_copy(update={"relations": near}), last)
        anchor = self._resolve(beside[0].anchors[0], last)
        if found.verdict != "found" or not anchor.groups or len(found.groups) != 1:
            return None
        gap = min(distance(self.group(found.groups[0]).box, self.group(a).box) for a in anchor.groups)
        return found if gap <= _REACH else None

    @cached_property
    def _leaning(self) -> Scene:
        """The scene with what hangs on walls moved to where furniture stands before them: a picture on the wall behind
        the sofa is above the sofa."""
        field = self.scene.language
        assert field is not None
        hung = {n.id for n in self.graph.nodes if n.support == "wall"}
        rows = tuple(replace(g, box=self.inward(g.box)) if self.ids[g.id] in hung else g for g in field.groups)
        return replace(self.scene, language=LanguageField(rows, field.embeddings, field.encoder))

    def inward(self, box: Box) -> Box:
        """The box of what hangs on a wall, moved to where furniture stands before that wall."""
        x, y, z = box.center
        width, depth, _ = self.graph.room.size
        gaps = {(1, 0): x + width / 2, (-1, 0): width / 2 - x, (0, 1): y + depth / 2, (0, -1): depth / 2 - y}
        dx, dy = min(gaps, key=lambda way: gaps[way])
        return replace(box, center=(x + dx * _BEFORE_WALL, y + dy * _BEFORE_WALL, z))

    def names(self, groups: Iterable[int]) -> tuple[Id, ...]:
        """The graph's ids of groups, each once."""
        return tuple(dict.fromkeys(self.ids[g] for g in groups))

    def told(self, reason: str) -> str:
        """A reason of the resolver with the graph's ids in place of rows."""
        return _ROW.sub(lambda row: f"({self.ids[int(row[1])]})", reason)

    def group(self, index: int) -> Group:
        """A row of the stand-in's table."""
        assert self.scene.language is not None
        return self.scene.language.groups[index]

    def without(self, groups: Iterable[int]) -> Stage:
        """The stage after some things were taken away."""
        gone = set(groups)
        return self._with({g: replace(self.group(g), count=0) for g in gone}, gone)

    def color(self, index: int) -> str:
        """The colour word of a thing, as the graph writes it or as an edit painted it; "" if it has none."""
        lab = self.group(index).lab
        written = self.graph.nodes[index].color if index < len(self.graph.nodes) else ""
        return written if written and color_of(written) == lab else name_of(lab) if lab != NO_COLOR else ""

    def painted(self, groups: Iterable[int], color: str) -> Stage:
        """The stage after some things were given a colour."""
        return self._with({g: replace(self.group(g), lab=color_of(color)) for g in groups}, set())

    def _with(self, changed: dict[int, Group], gone: set[int]) -> Stage:
        scene, field = self.scene, self.scene.language
        assert field is not None
        rows = tuple(changed.get(g.id, g) for g in field.groups)
        kept = torch.tensor([int(i) not in gone for i in scene.cloud.group], dtype=torch.bool)
        language = LanguageField(rows, field.embeddings, field.encoder)
        return replace(self, scene=replace(scene, cloud=scene.cloud[kept], language=language))

    def _read(self, query: Query) -> Query:
        """The query as it is meant of a room: "the wall" is all four, and what hangs on one lies at it."""
        plain = query.pick in ("one", "any") and not query.relations and not query.groups
        if query.region is not None and query.region.distance is None and query.region.name in _SIDES:
            beside = Relation(name=query.region.name, anchors=query.region.of[:1])
            query = query.model_copy(update={"region": None, "relations": (*query.relations, beside)})
        whole = plain and STRUCTURE.get(query.text) == "wall" and "wall" in self.ids
        relations = tuple(self._relation(r) for r in query.relations)
        return query.model_copy(
            update={
                "text": _READ_AS.get(query.text, query.text),
                "pick": "all" if whole else query.pick,
                "colors": tuple(map(self._color, query.colors)),
                "not_colors": tuple(map(self._color, query.not_colors)),
                "relations": relations,
                "exclude": tuple(self._read(q) for q in query.exclude),
                "also": tuple(self._read(q) for q in query.also),
            }
        )

    def _color(self, word: str) -> str:
        """A colour word that the graph uses becomes the Lab that the graph's nodes have; basic words stay."""
        plain = plain_color(word)
        written = plain not in BASIC and any(plain_color(n.color) == plain for n in self.graph.nodes)
        return hex_of(color_of(plain)) if written else word

    def _relation(self, relation: Relation) -> Relation:
        hung = relation.name == "on" and STRUCTURE.get(relation.anchors[0].text) in ("wall", "ceiling")
        anchors = tuple(self._read(a) for a in relation.anchors)
        return relation.model_copy(update={"name": "inside" if hung else relation.name, "anchors": anchors})


def _otherwise(query: Query, verdict: str) -> Iterator[Query]:
    """Other readings of a query that found nothing, or more than one thing.

    In terms of boxes a plant in a pot and a part of a sofa are "on" it, and the chairs of a table are "next to" it.
    "The cushion on the armchair" may be said where there are two armchairs and only one of them has a cushion.
    """
    beside = () if is_part(query.text) else ({"part_of": "next_to"},)  # the door by a wardrobe is not that of it
    for loose in ({"inside": "on", "part_of": "on"}, *beside):
        if verdict == "absent" and any(r.name in loose for r in query.relations):
            onto = tuple(r.model_copy(update={"name": loose.get(r.name, r.name)}) for r in query.relations)
            yield query.model_copy(update={"relations": onto})
    if verdict == "absent" and query.colors and Query(last=True) in query.exclude:
        yield query.model_copy(update={"colors": ()})  # "the other one" need not have the colour of the first
    if verdict == "ambiguous" and query.pick == "one" and any(r.name in _BY_PAIR for r in query.relations):
        yield query.model_copy(update={"relations": tuple(map(_to_any, query.relations))})


def _to_any(relation: Relation) -> Relation:
    """The relation to whichever thing fits its anchor."""
    if relation.name not in _BY_PAIR:
        return relation
    every = (a.model_copy(update={"pick": "all"}) if a.pick == "one" else a for a in relation.anchors)
    return relation.model_copy(update={"anchors": tuple(every)})


def _spoken(node: Node) -> str:
    """The text that words are compared with: the label, with the colour if no table knows it ("tartan blanket")."""
    unknown = node.color and node.label and color_of(node.color) == NO_COLOR
    return f"{node.color} {node.label}" if unknown else node.label


def _group(index: int, node: Node) -> Group:
    """A node as a row of the table."""
    kind = STRUCTURE.get(node.label.lower().strip())
    color = color_of(node.color) if node.color else NO_COLOR
    level, label = ("structure", kind) if kind else ("object", _spoken(node))
    return Group(index, level, -1, label, 1.0, node.box, color, 1, 1, 1.0)  # type: ignore[arg-type]


def _slabs(name: str, graph: SceneGraph) -> list[Box]:
    """Boxes of the floor, the ceiling or the four walls of the room."""
    width, depth, height = graph.room.size
    level = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), _UP)
    if name == "floor":
        return [Box((0.0, 0.0, -_SLAB / 2), level, (width, depth, _SLAB))]
    if name == "ceiling":
        return [Box((0.0, 0.0, height), level, (width, depth, 2 * _SLAB))]
    x, y, z, t = width / 2, depth / 2, height / 2, 2 * _SLAB
    return [
        *(Box((side * x, 0.0, z), level, (t, depth, height)) for side in (-1, 1)),
        *(Box((0.0, side * y, z), level, (width, t, height)) for side in (-1, 1)),
    ]


def _cloud(groups: list[Group]) -> GaussianCloud:
    n = len(groups)
    centres = torch.tensor([g.box.center for g in groups], dtype=torch.float32).reshape(n, 3)
    return GaussianCloud(
        means=centres,
        quats=torch.tensor([1.0, 0.0, 0.0, 0.0]).repeat(n, 1),
        scales=torch.full((n, 3), 0.01),
        opacities=torch.full((n,), 0.5),
        sh=torch.zeros(n, 1, 3),
        group=torch.arange(n, dtype=torch.int32),
        ids=torch.arange(n, dtype=torch.int64),
    )


def _viewer(graph: SceneGraph) -> Camera:
    """The graph's own viewer, or one before the room who looks along +y at eye height."""
    if graph.viewer is not None:
        return Camera.look_at(graph.viewer.position, graph.viewer.target, _UP)
    width, depth, _ = graph.room.size
    back = depth / 2 + max(width, depth, 1.0)
    return Camera.look_at((0.0, -back, EYE_HEIGHT), (0.0, 0.0, EYE_HEIGHT), _UP)

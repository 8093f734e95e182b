"""`Survey`: a scene or scene graph measured once, so that questions are answered from boxes, colours and relations.

All lengths are metres in the frame of the scene graph: z up, the origin at the centre of the floor. The words of a
question are resolved in the scene itself, with its encoder and its measured colours, or on the stage of a graph.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...gaussians.color import BASIC, FAMILIES, plain_color
from ...gaussians.language.query.attributes import COLOR_HOLDS, color_scores
from ...gaussians.language.query.nested import with_queries
from ...gaussians.language.query.query import Query, Relation
from ...gaussians.language.query.selection import Selection
from ...gaussians.language.query.terms import LOOSE, color_term
from ...gaussians.world import kinds, relations
from ...gaussians.world.relation_geometry import HOLDS, Stand
from ...gaussians.world.support import ALOFT, SHELL
from ...gaussians.world.words import is_plural, plural
from ..rooms.graph import SceneGraph
from ..rooms.graph_scene import Id, Stage
from .floor.floor_map import FloorMap
from .naming import named
from .picking import picked
from .reading import families
from .reading.noun_phrase import BY_ID
from .reading.room_phrases import is_place
from .room_places import Room, is_in
from .things import Found, NotResolved, Thing, gap

if TYPE_CHECKING:
    from ...gaussians.camera import Camera
    from ...gaussians.language.encoders import Encoder
    from ...gaussians.scene import Scene

_MEMORY = 4096  # queries whose results are kept

F64 = NDArray[np.float64]
Finder = Callable[[Query], Selection]  # a query to rows of the stage


@dataclass(frozen=True, eq=False)
class Survey:
    """A scene as questions see it.

    Attributes:
        graph: the scene graph, with the viewer if there is one.
        stage: the boxes, colours and relations of the graph's nodes.
        finder: resolves queries to rows of the stage; the groups that a query names are rows of the stage too.
        last: ids that "it" refers to.
        faces: whether the front of a thing was measured; None: its kind tells. A front is the -y side of its box.
        measured: whether boxes, colours and labels were measured in a scene, not written by somebody.
        shades: of a measured scene, the scores `[G]` of a colour word for the groups of its field.
        sure: ids of the things whose name is more likely right than wrong; None: all names.
        scaled: whether the length of a metre is known; else a scene unit counts as one.
        places: where things are in words, by row, as far as they were asked for; `placing.place_of` fills it.
    """

    graph: SceneGraph
    stage: Stage
    finder: Finder
    last: tuple[Id, ...] = ()
    faces: Callable[[Thing], bool] | None = None
    measured: bool = False
    shades: Callable[[str], F64] | None = None
    sure: frozenset[Id] | None = None
    scaled: bool = True
    places: dict[int, tuple[str, str]] = field(default_factory=dict)
    _memory: dict[str, Found] = field(default_factory=dict)
    _fronts: dict[Id, bool] = field(default_factory=dict)
    _names: dict[Id, str] = field(default_factory=dict)

    @classmethod
    def of_graph(cls, graph: SceneGraph, last: Sequence[Id] = ()) -> Survey:
        """The survey of a written scene graph."""
        return cls._on(Stage.of(graph), last)

    @classmethod
    def _on(cls, stage: Stage, last: Sequence[Id]) -> Survey:
        rows = tuple(stage.ids.index(i) for i in last if i in stage.ids)
        before = stage.find(Query(groups=rows)) if rows else None

        def find(query: Query) -> Selection:
            found = stage.find(query, before)
            return replace(found, reason=stage.told(found.reason))

        return cls(stage.graph, stage, find, tuple(last))

    def remembering(self, ids: Sequence[Id]) -> Survey:
        """The survey of the same written graph in which "it" refers to these ids."""
        return self._on(self.stage, ids)

    @classmethod
    def of_scene(cls, scene: Scene, viewer: Camera, encoder: Encoder | None, last: Selection | None = None) -> Survey:
        """The survey of an embedded scene as `viewer` sees it; "it" refers to `last`.

        Raises:
            UserError: the scene has no language field, or is larger than a graph may be.
        """
        survey = cls._measured(Stage.of(SceneGraph.from_scene(scene, viewer)))
        return survey.in_scene(scene, viewer, encoder, last)

    @classmethod
    def _measured(cls, stage: Stage) -> Survey:
        return cls(stage.graph, stage, stage.find)

    def in_scene(self, scene: Scene, viewer: Camera, encoder: Encoder | None, last: Selection | None) -> Survey:
        """The same things, with words resolved in the scene that they were read from, where "it" refers to `last`."""
        from ...gaussians.language.query.resolve import Resolver

        assert scene.language is not None
        language = scene.language
        structure = {g.id: g.label for g in language.groups if g.level == "structure"}
        rows = {id: row for row, id in reversed(list(enumerate(self.stage.ids)))}
        groups = _groups_of(self.stage.ids, structure, none=len(language.groups))
        resolver = Resolver(scene, viewer, encoder, last)

        def find(query: Query) -> Selection:
            return _on_stage(resolver.select(_in_scene(query, groups)), rows, structure)

        def faces(thing: Thing) -> bool:
            kind, group = kinds.of(thing.label), language.groups[int(thing.id)]
            by = resolver.facing(group).by
            # A wall tells the front of a cabinet, not that of a standing lamp beside it.
            return by == "shape" or (by == "wall" and (kind is None or kind.front or kind.seats > 0))

        last_groups = last.groups if last is not None else ()
        asked = replace(self, finder=find, last=last_groups, measured=True, faces=faces,
                        shades=lambda word: color_term(language, word), places={}, _memory={}, _fronts={},
                        _names={})  # fmt: skip
        return replace(asked, sure=_surely_named(scene), scaled=scene.frame.metres_per_unit is not None)

    def with_sure_names(self) -> Survey:
        """The same things, without the names that are hardly right."""
        if self.sure is None or all(n.id in self.sure or not n.label for n in self.graph.nodes):
            return self
        nodes = tuple(n if n.id in self.sure else n.model_copy(update={"label": ""}) for n in self.graph.nodes)
        graph = self.graph.model_copy(update={"nodes": nodes})
        return replace(self, graph=graph, stage=Stage.of(graph), places={}, _memory={}, _fronts={}, _names={})

    def with_aloft(self, ids: Collection[Id]) -> Survey:
        """The same things, of which some rest on nothing."""
        nodes = tuple(n.model_copy(update={"support": ALOFT}) if n.id in ids else n for n in self.graph.nodes)
        graph = self.graph.model_copy(update={"nodes": nodes})
        return replace(self, graph=graph, stage=replace(self.stage, graph=graph)) if ids else self

    # -- things -----------------------------------------------------------------------------------------------------

    @cached_property
    def things(self) -> tuple[Thing, ...]:
        """Everything with a node, in the order of the graph."""
        return tuple(self._thing_at(row) for row in range(len(self.graph.nodes)))

    def at(self, row: int) -> Thing:
        """The thing at a row of the stage."""
        return self.things[row] if row < len(self.graph.nodes) else self._thing_at(row)

    def _thing_at(self, row: int) -> Thing:
        node = self.graph.nodes[row] if row < len(self.graph.nodes) else None
        group = self.stage.group(row)
        if node is not None and self.shades is not None:
            shades, id = self.shades, int(node.id)
            node = node.model_copy(update={"color": max(BASIC, key=lambda word: float(shades(word)[id]))})
        return Thing(self.stage.ids[row], row, node.label if node else group.label, node, group)

    def thing(self, id: Id) -> Thing:
        """The thing with this id of the graph."""
        return self.at(self.stage.ids.index(id))

    def find(self, query: Query) -> Found:
        """What a query means here, whatever the verdict."""
        key = query.model_dump_json(exclude_defaults=True)
        if key not in self._memory:
            if len(self._memory) >= _MEMORY:
                self._memory.clear()
            self._memory[key] = self._found(query)
        return self._memory[key]

    def _found(self, query: Query) -> Found:
        for relation in query.relations:
            for anchor in relation.anchors:
                if anchor.text.startswith(f"{BY_ID} ") or anchor.text in families.named():
                    there = self.find(anchor)
                    if there.verdict != "found":
                        return replace(there, about=there.about or anchor)
                    meant = Query(groups=tuple(t.row for t in there.things))
                    return self._found(_with(query, anchor, meant))
        if query.text.startswith(f"{BY_ID} "):
            numbered = tuple(t for t in self.things if str(t.id) == query.text.removeprefix(f"{BY_ID} "))
            return Found("found" if numbered else "absent", numbered)
        place = next((r for r in query.relations if is_place(r.anchors[0].text)), None)
        if place is not None and not query.groups:
            return self._in_place(query, place)
        if query.text in families.named() and not query.groups:
            return self._of_family(query)
        if (held := _held_by_shell(query)) is not None:
            rest, shell = held
            return self._filtered(query, rest, lambda thing: thing.node is not None and thing.node.support == shell)
        found = self.finder(query)
        if found.verdict == "unconfirmed":  # what may be it is told as what comes nearest
            found = replace(found, verdict="absent", candidates=found.candidates[:3])
        if self.measured and found.verdict == "absent" and query.text and not _looks(query):
            by_label = self.stage.find(query)  # "the table" may be what is labelled a coffee table
            found = by_label if by_label.verdict != "absent" else found
        if found.verdict == "ambiguous" and (loose := self._to_any(query)) is not None:
            return self._found(loose)
        rows = tuple(dict.fromkeys(c.group for c in found.candidates if c.group >= 0))
        if found.verdict != "found" and (about := self._at_fault(query)) is not None:
            there = self.find(about)
            return replace(there, about=there.about or about)
        things = found.groups if found.verdict == "found" else rows if found.verdict == "ambiguous" else ()
        near = self._near(query, rows[:3]) if found.verdict == "absent" else ()
        return Found(found.verdict, tuple(map(self.at, things)), near, found.reason)

    def _of_family(self, query: Query) -> Found:
        """What a query for a family means: "the tallest piece of furniture"."""
        wider = query.model_copy(update={"text": ""})
        return self._filtered(query, wider, lambda thing: families.holds(query.text, thing.label))

    def _filtered(self, query: Query, wider: Query, fits: Callable[[Thing], bool]) -> Found:
        """What a query means that is answered by another, wider one and a condition on each thing."""
        every = self.find(wider.model_copy(update={"pick": "all", "count": None}))
        if every.about is not None or every.verdict == "ambiguous":
            return every
        members = tuple(t for t in every.things if fits(t))
        if not members:
            return Found("absent", (), every.things[:3] if wider.text else ())
        if query.pick in ("all", "rest"):
            right = query.count in (None, len(members))
            return Found("found" if right else "ambiguous" if len(members) > (query.count or 0) else "absent", members)
        if len(members) == 1 or query.pick == "any":
            return Found("found", members[:1])
        if query.pick == "one":
            return Found("ambiguous", members, reason=f"{query.describe()}: {len(members)} things match")
        return self._picked(query, members)

    def _in_place(self, query: Query, place: Relation) -> Found:
        """What a query for something in a place of the room means: "the lamp in the far left corner"."""
        others = tuple(r for r in query.relations if r is not place)
        every = self.find(query.model_copy(update={"relations": others, "pick": "all", "count": None}))
        if every.verdict != "found":
            return every
        things = tuple(t for t in every.things if t.node is not None and is_in(t, place.anchors[0].text, self.room)[0])
        if not things:
            return Found("absent", (), every.things[:3])
        if query.pick == "any" or len(things) == 1:
            return Found("found", things if query.pick == "all" else things[:1])
        if query.pick in ("all", "rest") and query.count in (None, len(things)):
            return Found("found", things)
        if query.pick in ("one", "all", "rest"):
            return Found("ambiguous", things, reason=f"{query.describe()}: {len(things)} things match")
        return self._picked(query, things)

    def _picked(self, query: Query, members: Sequence[Thing]) -> Found:
        """The one of several things that a superlative picks."""
        thing = picked(query, members, self.stand)
        return Found("found", (thing,)) if thing is not None else Found("ambiguous", tuple(members))

    def _to_any(self, query: Query) -> Query | None:
        """A query whose relations hold to any of several anchors; None if each of its anchors is one thing.

        The candidates of an ambiguous anchor are none of the query: "the lamp on the table" is no table.
        """
        relations = tuple(
            r.model_copy(update={"anchors": tuple(self._each_of(a) for a in r.anchors)}) if r.name in LOOSE else r
            for r in query.relations
        )
        return None if relations == query.relations else query.model_copy(update={"relations": relations})

    def _each_of(self, anchor: Query) -> Query:
        several = anchor.pick == "one" and not anchor.last and self.find(anchor).verdict == "ambiguous"
        return anchor.model_copy(update={"pick": "all"}) if several else anchor

    def _at_fault(self, query: Query) -> Query | None:
        """The phrase within a query that is absent or ambiguous by itself, None if none is."""
        for relation in query.relations:
            for anchor in relation.anchors:
                if anchor.text in SHELL or anchor.last or (anchor.pick == "one" and relation.name in LOOSE):
                    every = anchor.model_copy(update={"pick": "all"})
                    if anchor.text not in SHELL and not anchor.last and self.find(every).verdict == "absent":
                        return anchor
                    continue
                if self.find(anchor).verdict != "found":
                    return anchor
        return next((q for q in (*query.exclude, *query.also) if self.find(q).verdict != "found"), None)

    def _near(self, query: Query, rows: Sequence[int]) -> tuple[Thing, ...]:
        """Of an absent query, things that a person would think of: of that name but of another colour or elsewhere,
        or of the same family; else what looks most alike, and in a graph what is as large."""
        if query.text and (query.colors or query.relations or query.not_colors or query.size):
            named = self.find(Query(text=query.text, pick="all"))
            if named.verdict == "found":
                return named.things[:3]
        if not query.text:
            return tuple(map(self.at, rows))
        alike = [t for t in self.things if t.label and families.related(query.text, t.label)]
        if alike or self.measured:
            return tuple(alike[:3] or map(self.at, rows))
        kind = kinds.of(query.text)
        return tuple(map(self.at, rows)) if kind is None else self._as_large_as(kind)

    def _as_large_as(self, kind: kinds.Kind) -> tuple[Thing, ...]:
        """The things whose size is nearest to that of a kind as sold."""
        sold = np.log([sum(side) / 2 for side in kind.size])

        def apart(thing: Thing) -> float:
            return float(np.abs(np.log(np.maximum(thing.group.box.size, 1e-3)) - sold).sum())

        return tuple(sorted(self.things, key=apart)[:3])

    def all_of(self, query: Query) -> tuple[Thing, ...]:
        """Everything that a query describes, however many are meant; none if it is absent."""
        found = self.find(
            query.model_copy(update={"pick": "all", "count": None}) if query.pick in ("one", "any") else query
        )
        return found.things if found.verdict == "found" else ()

    def one(self, query: Query) -> Thing:
        """The one thing that a query describes.

        Raises:
            NotResolved: it is absent, or there are several.
        """
        found = self.find(query)
        if found.verdict != "found" or not found.things:
            raise NotResolved(query, found)
        if len({t.id for t in found.things}) > 1 and not self._is_shell(found.things):
            raise NotResolved(query, Found("ambiguous", found.things, reason=found.reason))
        return found.things[0]

    def some(self, query: Query) -> tuple[Thing, ...]:
        """The things that a query describes, at least one.

        Raises:
            NotResolved: it is absent or ambiguous.
        """
        found = self.find(query)
        if found.verdict != "found" or not found.things:
            raise NotResolved(query, found)
        return found.things

    @staticmethod
    def _is_shell(things: Iterable[Thing]) -> bool:
        return all(t.label in SHELL for t in things)

    @cached_property
    def floor(self) -> FloorMap:
        """The floor of the room, with where one can walk."""
        return FloorMap.of(self.graph)

    # -- geometry ---------------------------------------------------------------------------------------------------

    @cached_property
    def room(self) -> Room:
        """The walls and corners of the room as the viewer sees them."""
        width, depth, _ = self.graph.room.size
        forward = self.stand.forward[:2]
        return Room(width, depth, forward / max(float(np.linalg.norm(forward)), 1e-12))

    @property
    def stand(self) -> Stand:
        """The viewer's frame of reference."""
        return self.stage.stand

    def holds(self, relation: str, thing: Thing, anchors: Sequence[Thing], stand: Stand | None = None) -> bool:
        """Whether a relation holds between a thing and its anchors, in the viewer's frame unless another is given."""
        return relations.score(relation, thing.group, [a.group for a in anchors], stand or self.stand) >= HOLDS

    @staticmethod
    def gap(a: Thing, b: Thing) -> float:
        """Metres between the surfaces of two boxes; 0 where they touch."""
        return gap(a, b)

    @staticmethod
    def between_centers(a: Thing, b: Thing) -> float:
        """Metres between the centres of two boxes."""
        return float(np.linalg.norm(np.array(a.group.box.center) - np.array(b.group.box.center)))

    def has_front(self, thing: Thing) -> bool:
        """Whether it is known which side of a thing is its front; the floor, walls and ceiling have none."""
        if thing.node is None:
            return False
        if self.faces is not None:
            if thing.id not in self._fronts:
                self._fronts[thing.id] = self.faces(thing)
            return self._fronts[thing.id]
        kind = kinds.of(thing.label)
        return kind is not None and (kind.front or kind.seats > 0)

    # -- words ------------------------------------------------------------------------------------------------------

    def named(self, thing: Thing) -> str:
        """A definite description that tells a thing from the others: "the red chair", "the lamp on the desk".

        A number in brackets is its id, where colour and place do not tell it from the others.
        """
        if thing.id not in self._names:
            self._names[thing.id] = named(thing, self.things, self.stand)
        return self._names[thing.id]

    def has_color(self, thing: Thing, word: str) -> bool | None:
        """Whether a thing has a colour as its main colour; None if its colour, or its shade, is unknown."""
        if not thing.color:
            return None
        if self.shades is not None:
            return float(self.shades(word)[int(thing.id)]) >= COLOR_HOLDS
        own, asked = plain_color(thing.color), plain_color(word)
        if own == asked:
            return True
        basic = asked if asked in BASIC else FAMILIES.get(asked.replace(" ", ""))
        of = own if own in BASIC else FAMILIES.get(own.replace(" ", "")) or own.split()[-1]
        if not self.measured and own in BASIC and asked.split()[-1] == own and asked != own:
            return None  # a blue thing may be dark blue
        if asked in BASIC and of in BASIC and not self.measured:
            return of == basic
        return float(color_scores(word, np.array(thing.group.lab))) >= COLOR_HOLDS

    @staticmethod
    def counted(things: Sequence[Thing]) -> str:
        """Things by label with their numbers: "2 chairs, a lamp and 3 unnamed things"."""
        labels: dict[str, int] = {}
        for t in things:
            labels[t.name] = labels.get(t.name, 0) + 1
        return listed([f"{n} {as_plural(name)}" if n > 1 else with_article(name) for name, n in labels.items()])


def _looks(query: Query) -> bool:
    """Whether a query or an anchor of it tells a colour, or means the last answer: the stage knows neither."""
    asked = bool(query.colors or query.not_colors or query.last)
    within = [a for r in query.relations for a in r.anchors] + [*query.exclude, *query.also]
    return asked or any(map(_looks, within))


_SURE_NAME = 0.5  # calibrated probability from which a name is more often right than wrong


def _surely_named(scene: Scene) -> frozenset[Id]:
    """Ids of the objects whose name is likely right: calibrated, where the encoder knows such scenes, or by sight."""
    from ...gaussians.language.query.color.fallback import is_reliable

    assert scene.language is not None
    known = is_reliable(scene.language)
    objects = scene.language.objects()
    return frozenset(g.id for g in objects if g.named_by or (known and g.label_score >= _SURE_NAME))


def _held_by_shell(query: Query) -> tuple[Query, str] | None:
    """A query without its relation "on the floor", "on a wall" or "on the ceiling", and which of these; None if it has
    none.

    What holds a thing is in the graph; which wall is meant by "the left wall" is not.
    """
    for relation in query.relations:
        (anchor, *more) = relation.anchors
        plain = anchor.pick in ("one", "any", "all") and not (anchor.relations or anchor.colors or anchor.size or more)
        if relation.name in ("on", "inside") and anchor.text in SHELL and plain:
            rest = tuple(r for r in query.relations if r is not relation)
            return query.model_copy(update={"relations": rest}), anchor.text
    return None


def _with(query: Query, anchor: Query, other: Query) -> Query:
    """A query with another anchor in place of one of its anchors."""
    relations = tuple(
        r.model_copy(update={"anchors": tuple(other if a == anchor else a for a in r.anchors)}) for r in query.relations
    )
    return query.model_copy(update={"relations": relations})


__all__ = ["Found", "NotResolved", "Survey", "Thing", "be", "listed", "with_article"]


def listed(items: Sequence[str]) -> str:
    """Items as one enumeration: "a, b and c"; "nothing" if there are none."""
    if not items:
        return "nothing"
    return items[0] if len(items) == 1 else f"{', '.join(items[:-1])} and {items[-1]}"


def with_article(noun: str) -> str:
    """A noun with "a" or "an"; plurals stay as they are."""
    if is_plural(noun):
        return noun
    return f"{'an' if noun[:1] in 'aeiou' else 'a'} {noun}"


def as_plural(name: str) -> str:
    """A label for several things; one that is in the plural already ("books") stays as it is."""
    return name if is_plural(name) else plural(name)


def be(things: Sequence[Thing]) -> str:
    """ "is" or "are", as several things or one in the plural ("books") need."""
    return "is" if len(things) == 1 and not is_plural(things[0].name) else "are"


def _groups_of(ids: Sequence[Id], structure: dict[int, str], none: int) -> list[tuple[int, ...]]:
    """The group ids of a scene that each row of the stage means; of "wall" those of all walls.

    Args:
        none: an id that no group has, for rows without a group.
    """
    shell = {name: tuple(group for group, label in structure.items() if label == name) for name in SHELL}
    return [(id,) if isinstance(id, int) else shell.get(id) or (none,) for id in ids]


def _in_scene(query: Query, groups: Sequence[tuple[int, ...]]) -> Query:
    """A query with group ids of the scene in place of rows of the stage; `groups` holds those of each row."""

    def meant(part: Query) -> Query:
        ids = tuple(dict.fromkeys(group for row in part.groups for group in groups[row]))
        return part.model_copy(update={"groups": ids}) if part.groups else part

    changed: Query = with_queries(query, meant)
    return changed


def _on_stage(found: Selection, rows: dict[Id, int], structure: dict[int, str]) -> Selection:
    """A selection of a scene with the rows of the stage in place of group ids; groups without a row are left out."""

    def row(group: int) -> int:
        return rows.get(group, rows.get(structure.get(group, ""), -1))

    groups = tuple(dict.fromkeys(r for g in found.groups if (r := row(g)) >= 0))
    candidates = tuple(replace(c, group=row(c.group)) for c in found.candidates)
    verdict = "absent" if found.chosen and not groups else found.verdict
    return replace(found, verdict=verdict, groups=groups, candidates=candidates)

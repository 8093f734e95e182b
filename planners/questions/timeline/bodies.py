"""`Timeline`: what moves in a scene, by name; and which of it a phrase means."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from ....gaussians.color import name_of, plain_color
from ....gaussians.language.field.language_field import Group
from ....gaussians.language.query.query import Query
from ....gaussians.language.query.selection import Selection
from ....gaussians.motion import events
from ....gaussians.motion.at import at
from ....gaussians.motion.courses import Course, course_of, courses
from ....gaussians.motion.holding import Span
from ....gaussians.world import kinds
from ....gaussians.world.relation_geometry import Stand, viewer_stand
from ....gaussians.world.support import SHELL
from ....gaussians.world.words import singular
from ...grammar.tagging.words import bag
from ..reading.noun_phrase import is_anything
from ..survey import Found, NotResolved, Survey, Thing
from ..telling import told_apart

if TYPE_CHECKING:
    from ....gaussians.camera import Camera
    from ....gaussians.language.encoders import Encoder
    from ....gaussians.scene import Scene
    from ...rooms.node import Node


@dataclass(frozen=True, eq=False)
class Body:
    """A thing in time, or a part of one that moves by itself, as a drawer.

    Attributes:
        course: where it is through time.
        label: what it is called, with what tells it from others: "red book".
        group: its row of the scene's table.
        thing: the thing of the survey, or the one that it is a part of; None for floor, walls and ceiling.
        moving: the spans in which it moves.
    """

    course: Course
    label: str
    group: Group
    thing: Thing | None
    moving: tuple[Span, ...]

    @property
    def name(self) -> str:
        """For sentences: "the red book"."""
        return f"the {self.label}"


@dataclass(frozen=True, eq=False)
class Timeline:
    """What moves in a scene.

    Attributes:
        scene: with its motion.
        viewer: whose left and right are meant.
        encoder: for words.
        now: the time that questions without one are asked of, seconds.
        last: what "it" refers to.
    """

    scene: Scene
    viewer: Camera
    encoder: Encoder | None
    now: float = 0.0
    last: Selection | None = None
    _surveys: dict[float, Survey] = field(default_factory=dict)
    _movers: list[Body] = field(default_factory=list)

    @property
    def start(self) -> float:
        """Of the scene, seconds."""
        assert self.scene.motion is not None
        return self.scene.motion.start

    @property
    def stop(self) -> float:
        """Of the scene, seconds."""
        assert self.scene.motion is not None
        return self.scene.motion.stop

    @cached_property
    def unit(self) -> float:
        """Scene units of a metre."""
        return 1.0 / (self.scene.frame.metres_per_unit or 1.0)

    @cached_property
    def stand(self) -> Stand:
        """The viewer's frame, world."""
        assert self.scene.language is not None
        field = self.scene.language
        return viewer_stand(self.viewer, self.scene.frame.up_vector, field.typical_size, field.middle)

    @cached_property
    def _courses(self) -> dict[int, Course]:
        return courses(self.scene)

    def movers(self, survey: Survey) -> tuple[Body, ...]:
        """Everything that moves at some time: a thing, or the parts of it that move while the rest stands still."""
        if not self._movers:
            self._movers.extend(self._found(survey))
        return tuple(self._movers)

    def _found(self, survey: Survey) -> list[Body]:
        assert self.scene.language is not None
        table, found = self.scene.language.groups, list[Body]()
        for id, course in self._courses.items():
            group = table[id]
            if group.level != "object" or not (spans := events.movements(course, self.unit)):
                continue
            thing = next((t for t in survey.things if t.id == id), None)
            if thing is None:
                continue
            parts = [g for g in table if g.parent == id and g.id in self._courses and self._courses[g.id].moves]
            named = [p for p in parts if _is_a_thing(p.label)]
            if course.moves or not named:
                found.append(Body(course, told_apart(survey, thing, survey.things), group, thing, tuple(spans)))
                continue
            for part in named:
                own = events.movements(self._courses[part.id], self.unit)
                found.append(Body(self._courses[part.id], part.label, part, thing, tuple(own)))
        return sorted(found, key=lambda b: b.moving[0][0] if b.moving else self.stop)

    def body(self, thing: Thing, survey: Survey) -> Body:
        """A thing in time: what moves of it, or the thing itself standing still."""
        known = [
            b for b in self.movers(survey) if b.thing is not None and b.thing.id == thing.id and b.group.id == thing.id
        ]
        if known:
            return known[0]
        id = self.groups(thing)[0]
        assert self.scene.language is not None
        group = self.scene.language.groups[id]
        label = told_apart(survey, thing, survey.things) if thing.node is not None else thing.label
        return Body(course_of(self.scene, id), label, group, thing if thing.node is not None else None, ())

    def groups(self, thing: Thing) -> tuple[int, ...]:
        """The groups of a thing of the survey: of "wall" those of all walls."""
        assert self.scene.language is not None
        if isinstance(thing.id, int):
            return (thing.id,)
        return tuple(
            g.id for g in self.scene.language.groups if g.level == "structure" and g.label == thing.id and g.count
        )

    def meant(self, query: Query | None, survey: Survey) -> tuple[Body, ...]:
        """What a phrase means: of several things that it fits those that move; without a phrase, or of "it" if nothing
        was spoken of, all that moves.

        Raises:
            NotResolved: nothing fits, or several things that all move or all stand still.
        """
        movers = self.movers(survey)
        if query is not None and query.exclude and is_anything(query):
            gone = {b.group.id for q in query.exclude for b in self.meant(q, survey)}
            return tuple(b for b in movers if b.group.id not in gone)
        if query is None or (query.last and not survey.last) or is_anything(query):
            return movers
        if any(q.last for q in query.exclude) and not survey.last:  # "the other drawers": those that do not move
            rest = survey.find(query.model_copy(update={"exclude": (), "pick": "all"})).things
            going = {b.group.id for b in movers}
            return tuple(b for b in (self.body(t, survey) for t in rest) if b.group.id not in going)
        if query.last:
            found = survey.find(query)
            ids = {t.id for t in found.things}
            own = tuple(b for b in movers if b.thing is not None and b.thing.id in ids)
            return own or tuple(self.body(t, survey) for t in found.things)
        if (thing := _exactly(query, survey)) is not None:
            return tuple(b for b in self._of(thing, survey) if b.group.id == thing.id) or (self.body(thing, survey),)
        called = tuple(b for b in movers if self._is_called(query, b, survey)) if _is_plain(query) else ()
        if query.size is not None and _is_plain(sizeless := query.model_copy(update={"size": None})):
            alone = tuple(b for b in movers if self._is_called(sizeless, b, survey))
            called = alone if len(alone) == 1 else called  # "the small drawer", of one that moves
        if called and (query.pick != "one" or len(called) == 1):
            return called
        found = survey.find(query)
        if found.verdict == "absent" or not found.things:
            if called:
                return called
            if singular(query.text.split()[-1] if query.text else "") in _PARTS_ALONE and len(movers) == 1:
                return movers  # "the blades", of the one thing that moves
            raise NotResolved(query, found)
        bodies = tuple(dict.fromkeys(b for t in found.things for b in self._of(t, survey)))
        if found.verdict == "found" or all(t.label in SHELL and t.node is None for t in found.things):
            return bodies
        moving = tuple(b for b in bodies if b.moving)
        return moving or bodies

    def one(self, query: Query | None, survey: Survey) -> Body:
        """The one thing that a phrase means.

        Raises:
            NotResolved: there are none or several.
        """
        found = self.meant(query, survey)
        if len(found) == 1:
            return found[0]
        asked = query or Query(last=True)
        things = tuple(b.thing for b in found if b.thing is not None)
        raise NotResolved(asked, Found("ambiguous" if found else "absent", things, reason="several things are meant"))

    def _of(self, thing: Thing, survey: Survey) -> tuple[Body, ...]:
        """The bodies of a thing: itself, or the parts of it that move."""
        own = tuple(b for b in self.movers(survey) if b.thing is not None and b.thing.id == thing.id)
        return own or (self.body(thing, survey),)

    def _is_called(self, query: Query, body: Body, survey: Survey) -> bool:
        """Whether a plain phrase names a body: by words of its label, by its colour, or as what it is a part of."""
        said = {singular(w) for w in query.text.split()}
        own = {singular(w) for w in body.group.label.split()}
        whole = {singular(w) for w in body.thing.label.split()} if body.thing is not None else set()
        named = said <= own or (
            said <= whole and (body.group.id == getattr(body.thing, "id", None) or body.course.moves)
        )
        if body.thing is not None and body.group.id != body.thing.id and said <= whole and not said <= own:
            named = False  # the dresser stands still while its drawer moves
        return (bool(query.text) and named and all(self._has(body, c, survey) for c in query.colors)) or (
            not query.text and bool(query.colors) and all(self._has(body, c, survey) for c in query.colors)
        )

    def _has(self, body: Body, color: str, survey: Survey) -> bool:
        if body.thing is not None and body.thing.id == body.group.id:
            return bool(survey.has_color(body.thing, color))
        return name_of(body.group.lab) == plain_color(color)

    def survey_at(self, time: float) -> Survey:
        """The scene at a time as questions see it."""
        key = round(min(max(time, self.start), self.stop), 4)
        if key not in self._surveys:
            survey = Survey.of_scene(at(self.scene, key), self.viewer, self.encoder)
            self._surveys[key] = survey.with_aloft([n.id for n in survey.graph.nodes if self._is_aloft(n)])
        return self._surveys[key].in_scene(at(self.scene, key), self.viewer, self.encoder, self.last)

    def _is_aloft(self, node: Node) -> bool:
        """Whether something that moves at some time is well above the floor, and stands on nothing else."""
        own = self._courses.get(int(node.id)) if node.support == "floor" else None
        return own is not None and own.moves and node.bottom > max(_ALOFT, node.size[2])


_ALOFT = 0.15  # metres above the floor
_LEVELS = {"highest": "top", "lowest": "bottom", "middle": "middle"}


def _exactly(query: Query, survey: Survey) -> Thing | None:
    """The one thing that carries just the name that is said, or has that place in a stack: "the top drawer"."""
    if query.colors or query.relations or query.last or query.also or query.exclude or not query.text:
        return None
    if query.pick in _LEVELS:
        named = f"the {_LEVELS[query.pick]} {query.text}"
        return next((t for t in survey.things if survey.named(t) == named), None)
    own = [t for t in survey.things if t.label == query.text]
    return own[0] if query.pick == "one" and len(own) == 1 else None


def _is_plain(query: Query) -> bool:
    """Whether a phrase is a name with colours at most."""
    plain = Query(text=query.text, colors=query.colors, pick=query.pick, count=query.count)
    return query == plain and query.pick in ("one", "all", "any")


_PARTS_ALONE = bag("leaf blade blades body rotor panel wing base part frame hub hinge joint pivot axle")


def _is_a_thing(label: str) -> bool:
    """Whether a part is called by its own name ("drawer"), not by that of its thing ("leaf" of a door)."""
    head = singular(label.split()[-1]) if label else ""
    return bool(head) and head not in _PARTS_ALONE and (" " in label or kinds.find(head) is not None or head in _SAID)


_SAID = frozenset(
    {"drawer", "door", "lid", "wheel", "flap", "hand", "handle", "arm", "hatch", "gate", "shutter", "seat"}
)

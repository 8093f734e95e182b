"""Parses directions, distances and destinations, and decides which phrase behind a noun is the destination.

Rules:
- With a direction ("to the left") or a goal ("to the floor") the phrases behind the noun describe the noun.
- "move X P1 P2": the last phrase is the destination. "put X P1 P2": the first one opens it, unless the last says
  "into" or "onto", or repeats the relation of the first ("put the book on the table on the shelf").
- "copy X P": the phrase says which X, unless it begins with "into" or "onto".
- "on A next to B" is next to the B that is on A, if B is a small thing; with furniture it is the A next to B.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from ....gaussians.language.query.query import CORNERS
from ....gaussians.world import relations
from ....gaussians.world.words import head
from ..parsing import Node, Refusal, tag_of, tokens, trees
from ..vocabulary import nouns
from .described import NounPhrase, PostModifier, attach_modifiers, in_or_on
from .phrases import Phrases

Fields = dict[str, Any]
LITTLE: Fields = {"value": 20, "unit": "cm"}
MUCH: Fields = {"value": 1, "unit": "m"}
# The rules that `read_motion` takes.
MOTIONS = ("direction", "distance", "nudge", "toward", "away", "to", "spot", "times")
_BESIDE = ("next_to", *(kind.name for kind in relations.KINDS if kind.aim and not kind.own_frame))


@dataclass
class Motion:
    """The parts of a motion that a clause gives, each at most once."""

    direction: str | None = None
    distance: Fields | None = None
    place: Fields | None = None
    toward: Any = None
    away: bool | None = None
    times: int | None = None

    def fields(self) -> Fields:
        """The given parts as fields of an operation."""
        said = {k: getattr(self, k) for k in ("direction", "distance", "place", "toward", "away")}
        return {k: v for k, v in said.items() if v is not None}

    @property
    def aims(self) -> bool:
        """Whether it gives a direction, a place or a goal."""
        return bool(self.direction or self.place or self.toward)

    def set(self, name: str, value: Any, said: str) -> None:
        """Set a part; `said` is quoted if it is given twice.

        Raises:
            Refusal: it is given twice.
        """
        if getattr(self, name) is not None:
            raise Refusal(f"two different {name}s in one clause", said)
        setattr(self, name, value)


def read_motion(nodes: Sequence[Node], phrases: Phrases, moved: NounPhrase | None = None) -> Motion:
    """The motion that the motion nodes of a clause give; `moved` decides what "to the table" means."""
    motion = Motion()
    for node in nodes:
        said = " ".join(tag_of(t).text for t in node.scan_values(lambda _: True))
        _read_one(str(node.data), node, motion, phrases, said, moved)
    return motion


def _read_one(kind: str, node: Node, motion: Motion, phrases: Phrases, said: str, moved: NounPhrase | None) -> None:
    if kind == "direction":
        motion.set("direction", tokens(node, "DIR")[0].value, said)
    elif kind == "distance":
        motion.set("distance", length(tokens(node, "LENGTH")[0].value), said)
    elif kind == "nudge":
        motion.set("distance", LITTLE if tokens(node, "DEGREE")[0].value == "little" else MUCH, said)
    elif kind == "times":
        motion.set("times", whole(tokens(node, "TIMES", "NUMBER")[0].value, said), said)
    elif kind == "spot":
        motion.set("place", spot(tokens(node, "SPOT")[0].value), said)
    elif kind in ("toward", "away"):
        motion.set("toward", goal_of(phrases, trees(node, "np")[0]).full(), said)
        motion.away = True if kind == "away" else None
    elif kind == "to":
        motion.set("place", _place_of_goal(goal_of(phrases, trees(node, "np")[0]), moved), said)


def spot(name: str) -> Fields:
    """The place that a spot of the room is: its middle, some corner, or a corner by name ("back left")."""
    return {"relation": "corner", "corner": name} if name in CORNERS else {"relation": name}


def length(value: tuple[float, str]) -> Fields:
    """The value of a LENGTH token as fields.

    Raises:
        Refusal: it is not above 0 and at most 10,000.
    """
    if not 0 < value[0] <= 10_000:
        raise Refusal("that is not a length for things in a room", f"{value[0]:g}", verdict="impossible")
    return {"value": value[0], "unit": value[1]}


def whole(value: float, said: str) -> int:
    """A number as a count of copies.

    Raises:
        Refusal: it is not a whole number from 1 to 50.
    """
    if value != int(value) or not 1 <= value <= 50:
        raise Refusal("copies are counted from 1 to 50", said)
    return int(value)


def goal_of(phrases: Phrases, np: Node) -> NounPhrase:
    """The noun phrase of a goal; it does not become the antecedent of "one"."""
    kept = phrases.antecedent
    found = phrases.noun(np)
    phrases.antecedent = kept
    return found


def _place_of_goal(goal: NounPhrase, moved: NounPhrase | None) -> Fields:
    """The place that a goal means: "to the floor" is on it, "to the wall" against it, "to the window" next to it.

    For surfaces and containers it depends on what is moved: furniture goes next to them.
    """
    name = head(goal.query.text)
    _refuse_some_corner(goal)
    big = moved is not None and nouns.is_furniture(moved.query.text)
    if name == "wall":
        relation = "against"
    elif name in ("floor", "ground") or (nouns.is_surface(goal.query.text) and not big):
        relation = "on"
    elif nouns.is_container(goal.query.text) and not big:
        relation = "inside"
    else:
        relation = "next_to"
    return {"relation": relation, "anchors": (goal.full(),)}


def _refuse_some_corner(goal: NounPhrase) -> None:
    if goal.query.text == "corner":
        raise Refusal("one corner cannot be told from another; say the corner, or next to what", "corner")


def split_destination(found: NounPhrase, verb: str) -> tuple[NounPhrase, Fields | None]:
    """Split the destination off the postmodifiers of what is moved; the destination is None if there is none."""
    modifiers = found.modifiers
    at = _destination_start(modifiers, verb)
    if at is None:
        return found, None
    return replace(found, modifiers=modifiers[:at]), placement(modifiers[at:])


def _destination_start(modifiers: Sequence[PostModifier], verb: str) -> int | None:
    """The index of the first postmodifier that belongs to the destination, None if there is no destination."""
    goals = [
        i
        for i, p in enumerate(modifiers)
        if p.kind in ("related", "between", "centered", "in_spot") and _can_be_destination(p)
    ]
    if not goals:
        return None
    said = {i: modifiers[i].word.split()[0] for i in goals}
    for openers in (("into", "onto", "against", "up"), ("to",)):
        if explicit := [i for i in goals if said[i] in openers]:
            return explicit[0]
    if verb == "COPY":
        return None  # a copy needs no place, so "copy the lamp on the desk" says which lamp
    first, last = goals[0], goals[-1]
    repeats = first != last and modifiers[last].value in (modifiers[first].value, "inside")
    return last if verb == "MOVE" or repeats else first


def _can_be_destination(post: PostModifier) -> bool:
    return post.kind != "related" or bool(relations.placed_as(str(post.value)))


def placement(modifiers: Sequence[PostModifier]) -> Fields:
    """The placement that postmodifiers give, as fields."""
    first, rest = modifiers[0], modifiers[1:]
    if first.kind == "in_spot":
        if rest:
            raise Refusal("a place is one phrase", rest[0].word)
        return spot(first.value)
    on_floor = first.value == "on" and head(first.anchors[0].query.text) in ("floor", "ground")
    if on_floor and rest and rest[0].kind in ("related", "between"):
        return placement(rest)  # "on the floor in front of the sofa": "on the floor" is redundant
    if any(p.conjoined for p in rest):
        raise Refusal("a place is one phrase; name one of the two", rest[0].word)
    anchors = [a.full() for a in first.anchors]
    for anchor in first.anchors:
        _refuse_some_corner(anchor)
    if _refines(first, rest):
        beside = replace(rest[0].anchors[0], modifiers=(first,))
        return {"relation": _relation_of(rest[0]), "anchors": (attach_modifiers(beside.full(), rest[1:]),)}
    anchors[-1] = attach_modifiers(anchors[-1], rest)
    return {"relation": _relation_of(first), "anchors": tuple(anchors)}


def _refines(first: PostModifier, rest: Sequence[PostModifier]) -> bool:
    """Whether "on A next to B" means next to the small thing B that is on A."""
    if first.kind != "related" or first.value != "on" or not rest or rest[0].kind != "related":
        return False
    beside = rest[0].value in _BESIDE
    return beside and not nouns.is_furniture(rest[0].anchors[0].query.text)


def _relation_of(post: PostModifier) -> str:
    """The relation of a placement."""
    if post.kind == "between":
        return "between"
    if post.kind == "centered":
        return "center"
    relation = relations.placed_as(in_or_on(post))
    if relation in ("on", "inside") and post.anchors[0].query.pick == "all":
        raise Refusal("one place at a time; name one", post.word)
    return relation

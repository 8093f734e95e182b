"""Where something goes: directions, distances and destinations.

Knows which phrase behind a noun is a destination for a verb of motion. Refuses to know the verbs themselves.

Preferences:
- A direction ("to the left") or a goal ("to the floor") settles it: what stands behind the noun describes the noun.
- "move X P1 P2": the last phrase is the destination. "put X P1 P2": the first one opens it, unless the last says
  "into" or "onto", or repeats the relation of the first ("put the book on the table on the shelf").
- "copy X P": the phrase says which X, unless it begins with "into" or "onto".
- "on A next to B" is next to the B that is on A, if B is a small thing; with furniture it is the A next to B.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from ....gaussians.world import relations
from ....gaussians.world.words import head
from ..parsing import Node, Refusal, tag_of, tokens, trees
from ..vocabulary import nouns
from .described import Noun, Post, attach, in_or_on
from .phrases import Phrases

Fields = dict[str, Any]
LITTLE: Fields = {"value": 20, "unit": "cm"}
MUCH: Fields = {"value": 1, "unit": "m"}
MOTIONS = ("direction", "distance", "nudge", "toward", "to", "spot", "times")  # the rules that `read` takes
_BESIDE = ("next_to", *(kind.name for kind in relations.KINDS if kind.aim and not kind.own_frame))


@dataclass
class Motion:
    """What was said about a motion, each thing at most once."""

    direction: str | None = None
    distance: Fields | None = None
    place: Fields | None = None
    toward: Any = None
    times: int | None = None

    def fields(self) -> Fields:
        """The fields of an operation that were said."""
        said = {k: getattr(self, k) for k in ("direction", "distance", "place", "toward")}
        return {k: v for k, v in said.items() if v is not None}

    @property
    def aims(self) -> bool:
        return bool(self.direction or self.place or self.toward)

    def set(self, name: str, value: Any, said: str) -> None:
        if getattr(self, name) is not None:
            raise Refusal(f"two different {name}s in one clause", said)
        setattr(self, name, value)


def read(nodes: Sequence[Node], phrases: Phrases, moved: Noun | None = None) -> Motion:
    """The motion that a clause's motion nodes say; `moved` helps to read "to the table"."""
    motion = Motion()
    for node in nodes:
        said = " ".join(tag_of(t).text for t in node.scan_values(lambda _: True))
        _read_one(str(node.data), node, motion, phrases, said, moved)
    return motion


def _read_one(kind: str, node: Node, motion: Motion, phrases: Phrases, said: str, moved: Noun | None) -> None:
    if kind == "direction":
        motion.set("direction", tokens(node, "DIR")[0].value, said)
    elif kind == "distance":
        motion.set("distance", length(tokens(node, "LENGTH")[0].value), said)
    elif kind == "nudge":
        motion.set("distance", LITTLE if tokens(node, "DEGREE")[0].value == "little" else MUCH, said)
    elif kind == "times":
        motion.set("times", whole(tokens(node, "TIMES", "NUMBER")[0].value, said), said)
    elif kind == "spot":
        motion.set("place", {"relation": tokens(node, "SPOT")[0].value}, said)
    elif kind == "toward":
        motion.set("toward", anchor_only(phrases, trees(node, "np")[0]).full(), said)
    elif kind == "to":
        motion.set("place", _to(anchor_only(phrases, trees(node, "np")[0]), moved), said)


def length(value: tuple[float, str]) -> Fields:
    """A length token's value as fields."""
    if not 0 < value[0] <= 10_000:
        raise Refusal("that is no length for things in a room", f"{value[0]:g}", verdict="impossible")
    return {"value": value[0], "unit": value[1]}


def whole(value: float, said: str) -> int:
    """A count.

    Raises:
        Refusal: it is no whole number from 1 to 50.
    """
    if value != int(value) or not 1 <= value <= 50:
        raise Refusal("copies are counted from 1 to 50", said)
    return int(value)


def anchor_only(phrases: Phrases, np: Node) -> Noun:
    """The noun of a goal; it does not become what "one" refers to."""
    kept = phrases.antecedent
    found = phrases.noun(np)
    phrases.antecedent = kept
    return found


def _to(goal: Noun, moved: Noun | None) -> Fields:
    """ "to the floor" is on it, "to the wall" against it, "to the window" next to it; "to the table" depends."""
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


def _refuse_some_corner(goal: Noun) -> None:
    if goal.query.text == "corner":
        raise Refusal("one corner cannot be told from another; say the corner, or next to what", "corner")


def destination(found: Noun, verb: str) -> tuple[Noun, Fields | None]:
    """What is moved without its destination, and the destination among the phrases behind it, if there is one."""
    posts = found.posts
    at = _opens(posts, verb)
    if at is None:
        return found, None
    return replace(found, posts=posts[:at]), placement(posts[at:])


def _opens(posts: Sequence[Post], verb: str) -> int | None:
    """The index of the phrase that opens the destination."""
    goals = [i for i, p in enumerate(posts) if p.kind in ("related", "between", "centered", "in_spot") and _can(p)]
    if not goals:
        return None
    explicit = [i for i in goals if posts[i].word.split()[0] in ("into", "onto", "to", "against", "up")]
    if explicit:
        return explicit[0]
    if verb == "COPY":
        return None  # a copy needs no place, so "copy the lamp on the desk" says which lamp
    first, last = goals[0], goals[-1]
    repeats = first != last and posts[last].value in (posts[first].value, "inside")
    return last if verb == "MOVE" or repeats else first


def _can(post: Post) -> bool:
    return post.kind != "related" or bool(relations.placed_as(str(post.value)))


def placement(posts: Sequence[Post]) -> Fields:
    """A place from the phrases that say it."""
    first, rest = posts[0], posts[1:]
    if first.kind == "in_spot":
        if rest:
            raise Refusal("a place is one phrase", rest[0].word)
        return {"relation": first.value}
    on_floor = first.value == "on" and head(first.anchors[0].query.text) in ("floor", "ground")
    if on_floor and rest and rest[0].kind in ("related", "between"):
        return placement(rest)  # "on the floor in front of the sofa": being on the floor goes without saying
    if any(p.joined for p in rest):
        raise Refusal("a place is one phrase; name one of the two", rest[0].word)
    anchors = [a.full() for a in first.anchors]
    for anchor in first.anchors:
        _refuse_some_corner(anchor)
    if _refines(first, rest):
        beside = replace(rest[0].anchors[0], posts=(first,))
        return {"relation": _spot(rest[0]), "anchors": (attach(beside.full(), rest[1:]),)}
    anchors[-1] = attach(anchors[-1], rest)
    return {"relation": _spot(first), "anchors": tuple(anchors)}


def _refines(first: Post, rest: Sequence[Post]) -> bool:
    """Whether "on A next to B" means beside the small thing B that is on A."""
    if first.kind != "related" or first.value != "on" or not rest or rest[0].kind != "related":
        return False
    beside = rest[0].value in _BESIDE
    return beside and not nouns.is_furniture(rest[0].anchors[0].query.text)


def _spot(post: Post) -> str:
    """The placement's relation."""
    if post.kind == "between":
        return "between"
    if post.kind == "centered":
        return "center"
    relation = relations.placed_as(in_or_on(post))
    if relation in ("on", "inside") and post.anchors[0].query.pick == "all":
        raise Refusal("one place at a time; name one", post.word)
    return relation

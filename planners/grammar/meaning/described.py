"""Turns noun phrases with postmodifiers (relations, sides, properties behind the noun) into queries.

Attachment: a prepositional phrase belongs to the nearest noun before it ("the lamp on the table next to the sofa" is
about a table next to the sofa), unless "and" joins it to the one before ("left of the table and in front of the
window" says two things about one noun), it is negated ("not against the window"), or that noun is a floor or a wall.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from ....gaussians.language.query import wholes
from ....gaussians.language.query.nested import with_queries
from ....gaussians.language.query.query import CORNERS, Query, Region, Relation
from ....gaussians.world import relations
from ....gaussians.world.words import head
from ..parsing import Refusal
from ..vocabulary import nouns

# These describe the first noun, not the last: "the cup on the table that is white".
_OF_THE_FIRST = ("unrelated", "is_not_kind", "is_hue", "is_not_hue")
# These leave "everything" the whole scene: "everything that is not the sofa".
_OF_EVERYTHING = ("is_not_kind", "lacking", "in_region")

EVERYTHING = Query(text="everything", pick="all")  # the whole scene, with what belongs to no thing

Article = Literal["def", "indef", "all", "both", "any", "bare", "pronoun"]


@dataclass(frozen=True)
class PostModifier:
    """A postmodifier of a noun: a relation to further nouns, or a property.

    Attributes:
        kind: name of its rule in grammar.lark.
        value: the relation, side, spot or colour.
        word: its first words as written ("into").
        anchors: the noun phrases it relates to, without postmodifiers.
        conjoined: whether "and" joins it to the previous one.
    """

    kind: str
    value: Any
    word: str
    anchors: tuple[NounPhrase, ...] = ()
    conjoined: bool = False


@dataclass(frozen=True)
class NounPhrase:
    """One noun phrase.

    Attributes:
        query: the query without the postmodifiers.
        article: its determiner.
        plural: whether the noun is in the plural.
        number: 2 in "two chairs", None without a number.
        adjectives: size words before the noun, for naming new things.
        height: value and unit of "1.8 m tall".
        modifiers: the postmodifiers, as a flat list.
        said: the noun as written ("books").
    """

    query: Query
    article: Article
    plural: bool = False
    number: int | None = None
    adjectives: tuple[str, ...] = ()
    height: tuple[float, str] | None = None
    modifiers: tuple[PostModifier, ...] = field(default=())
    said: str = ""

    @property
    def is_new(self) -> bool:
        """Whether it can name something new ("a lamp", "two lamps", "lamp")."""
        plain = self.query.pick in ("one", "any", "all") and not self.query.exclude and not self.query.last
        return plain and bool(self.query.text) and self.article in ("indef", "bare")

    def full(self) -> Query:
        """The query with all postmodifiers; they apply to each of several colours ("red and blue mugs")."""
        first = attach_modifiers(self.query, self.modifiers)
        others = tuple(attach_modifiers(q, self.modifiers) for q in self.query.also)
        return updated(first, also=(*others, *first.also[len(others) :])) if first.also else first


def updated(query: Query, **fields: Any) -> Query:
    """A validated copy.

    Raises:
        Refusal: more colours, relations or exclusions than a query holds.
    """
    try:
        return Query(**{name: fields.get(name, getattr(query, name)) for name in Query.model_fields})
    except ValueError as error:
        raise Refusal("that is too much for one phrase; say it in parts") from error


def union(found: Sequence[NounPhrase]) -> Query:
    """One query for several nouns; "it" in a later one is the first: "the table and what is on it"."""
    first, *rest = (n.full() for n in found)
    if rest and not first.last:
        named = updated(first, also=())
        rest = [
            q if q.last else with_queries(q, lambda part: named if part == Query(last=True) else part) for q in rest
        ]
    return updated(first, also=(*first.also, *rest)) if rest else first


def is_all_on_it(phrase: NounPhrase) -> bool:
    """Whether a phrase means everything that stands on what was named before it."""
    on_it = Relation(name="on", anchors=(Query(last=True),))
    return phrase.full() == Query(relations=(on_it,), pick="all")


def existing(found: Sequence[NounPhrase]) -> Query:
    """The query for things that exist already.

    Raises:
        Refusal: it does not say which ("some chairs").
    """
    if any(n.article == "indef" and n.plural and n.number is None for n in found):
        raise Refusal("say which, or how many", "some")
    return union(found)


def all_of(target: Query, out: Query) -> Query:
    """The meaning of "all" before an exclusion: boxes in "all but the largest box", everything in "all but the box"."""
    ranked = out.pick not in ("one", "all", "any", "rest") and bool(out.text)
    return updated(Query(text=out.text, pick="all")) if target in (Query(pick="all"), EVERYTHING) and ranked else target


def attach_modifiers(query: Query, modifiers: Sequence[PostModifier]) -> Query:
    """`query` restricted by postmodifiers, each attached to the noun it belongs to."""
    i = 0
    while i < len(modifiers):
        j = i + 1
        while (
            j < len(modifiers)
            and not modifiers[j].conjoined
            and modifiers[j].kind not in _OF_THE_FIRST
            and _takes_more(modifiers[i])
        ):
            j += 1
        query = _narrow(query, modifiers[i], modifiers[i + 1 : j])
        i = j
    return query


def _takes_more(post: PostModifier) -> bool:
    """Whether the next postmodifier may belong to this one's noun: not to floors and walls, which are everywhere."""
    return bool(post.anchors) and head(post.anchors[-1].query.text) not in nouns.EVERYWHERE


def _narrow(query: Query, post: PostModifier, behind: Sequence[PostModifier]) -> Query:
    """`query` restricted by one postmodifier; `behind` are the postmodifiers of that one's last noun."""
    anchors = [a.full() for a in post.anchors]
    if anchors:
        anchors[-1] = attach_modifiers(anchors[-1], behind)
    if query.text == EVERYTHING.text and post.kind not in _OF_EVERYTHING and not _is_beside(post):
        query = updated(query, text="")  # "everything on the table" is every thing on it
    if post.kind == "unrelated":
        wrong = _relation(_relation_name(replace(post, kind="related")), anchors)
        bad = updated(query, relations=(*query.relations, wrong), pick="all", count=None)
        return updated(query, exclude=(*query.exclude, bad))
    if post.kind == "is_not_kind":
        every = (a.model_copy(update={"pick": "all"}) if a.pick in ("one", "any") else a for a in anchors)
        return updated(query, exclude=(*query.exclude, *every))
    if post.kind == "lacking":
        return _lacking(query, post, anchors)
    if post.kind == "having" and wholes.names_plant(query.text) and wholes.names_vessel(anchors[0].text):
        pot = updated(anchors[0], relations=(*anchors[0].relations, _relation("part_of", [query])))
        return updated(query, also=(*query.also, pot))  # "the plant with the pot": a pot is on no plant
    if post.kind == "in_region":
        of = () if post.value["name"] in ("above", "below") and _is_floor(anchors) else tuple(anchors)
        return _in_region(query, post.word, {**post.value, "of": of})
    if query.text == EVERYTHING.text:
        return _in_region(query, post.word, {"name": post.value, "of": tuple(anchors)})
    if name := _relation_name(post):
        own = post.kind == "related" and relations.named(str(post.value)).own_frame
        return updated(query, relations=(*query.relations, _relation(name, anchors, "object" if own else "viewer")))
    if post.kind == "is_hue":
        return updated(query, colors=(*query.colors, post.value))
    if post.kind == "is_not_hue":
        return updated(query, not_colors=(*query.not_colors, post.value))
    if post.kind == "side":
        if query.pick not in ("one", "any"):
            raise Refusal("a side picks one thing; say which one", post.word)
        return updated(query, pick=post.value)
    if post.kind == "counted":
        if query.pick != "nth":
            raise Refusal("counting needs a rank: the second chair from the left", post.word)
        if post.value == "right":
            return updated(query, ordinal=-(query.ordinal or 1))
        return query
    if post.kind == "in_spot" and post.value in CORNERS and query.pick in ("one", "any"):
        return updated(query, pick=post.value)
    if post.kind == "in_spot" and post.value == "center" and query.pick == "one":
        return updated(query, pick="middle")
    if post.kind == "in_spot" and post.value == "corner":
        return updated(query, relations=(*query.relations, _relation("inside", [Query(text="corner")])))
    raise Refusal("things cannot be selected by this", post.word)


def _is_beside(post: PostModifier) -> bool:
    """Whether a postmodifier gives a side, which of everything is a part of space: "everything left of the table"."""
    return post.kind == "related" and post.value in ("left_of", "right_of", "in_front_of", "behind")


def _is_floor(anchors: Sequence[Query]) -> bool:
    return all(head(a.text) in ("floor", "ground") for a in anchors)


def _in_region(query: Query, said: str, fields: dict[str, Any]) -> Query:
    """`query` restricted to a part of space.

    Raises:
        Refusal: it is restricted to another one already.
    """
    if query.region is not None:
        raise Refusal("one part of the space at a time; say it in two steps", said)
    try:
        return updated(query, region=Region(**fields))
    except ValueError as error:
        raise Refusal("that is not a length for things in a room", said, verdict="impossible") from error


def _lacking(query: Query, post: PostModifier, anchors: Sequence[Query]) -> Query:
    """Exclude one thing ("all lamps without the floor lamp") or what carries another ("the table without a vase")."""
    if not anchors[0].text or head(anchors[0].text) == head(query.text):
        return updated(query, exclude=(*query.exclude, anchors[0]))
    carrying = [a.model_copy(update={"pick": "all"}) for a in anchors]
    bad = updated(query, relations=(*query.relations, _relation(post.value, carrying)), pick="all", count=None)
    return updated(query, exclude=(*query.exclude, bad))


def _relation_name(post: PostModifier) -> str:
    """The relation that a postmodifier gives, "" if it gives none."""
    if post.kind == "having":
        return str(post.value)
    if post.kind == "related":
        return relations.named(str(post.value)).query_as or in_or_on(post)
    if post.kind == "off":
        inside = nouns.is_container(post.anchors[0].query.text)
        return "inside" if inside else "on"
    return {"part": "part_of", "between": "between"}.get(post.kind, "")


def in_or_on(post: PostModifier) -> str:
    """The relation of a prepositional phrase; "in" a seat means on it."""
    seat = post.value == "inside" and nouns.is_seat(post.anchors[0].query.text)
    return "on" if seat else str(post.value)


def _relation(name: str, anchors: Sequence[Query], frame: Literal["viewer", "object"] = "viewer") -> Relation:
    """A relation in which an anchor such as "a chair" means any of them."""
    anyone = (a.model_copy(update={"pick": "all"}) if a.pick == "any" and not a.last else a for a in anchors)
    return Relation(name=name, anchors=tuple(anyone), frame=frame)

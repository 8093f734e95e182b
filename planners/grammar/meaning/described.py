"""Nouns with what stands behind them, as queries.

Knows what a relation, a side or a spot means for a `Query`, and to which noun a prepositional phrase belongs. Refuses
to know how a noun phrase is built from its tokens (phrases.py).

Preference: a prepositional phrase belongs to the nearest noun before it ("the lamp on the table next to the sofa" is
about a table next to the sofa), unless "and" joins it to the one before ("left of the table and in front of the
window" says two things about one noun), it is denied ("not against the window"), or that noun is a floor or a wall.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from ....gaussians.language.query.query import Query, Relation
from ....gaussians.world import relations
from ....gaussians.world.words import head
from ..parsing import Refusal
from ..vocabulary import nouns

# "the cup on the table that is white", "anything on the bed that is not a pillow": about the first noun, not the last.
_OF_THE_FIRST = ("unrelated", "is_not_kind", "is_hue", "is_not_hue")

Article = Literal["def", "indef", "all", "both", "any", "bare", "pronoun"]


@dataclass(frozen=True)
class Post:
    """What stands behind a noun: a relation to further nouns, or a property.

    Attributes:
        kind: the rule's name in grammar.lark.
        value: the relation, side, spot or colour.
        word: how it was said ("into").
        anchors: the nouns it relates to, without anything behind them.
        joined: whether "and" joins it to the one before.
    """

    kind: str
    value: Any
    word: str
    anchors: tuple[Noun, ...] = ()
    joined: bool = False


@dataclass(frozen=True)
class Noun:
    """One noun phrase.

    Attributes:
        query: without what stands behind the noun.
        article: how it is introduced.
        plural: whether its form is plural.
        number: "two chairs".
        adjectives: words before the noun that no field of a query holds, for naming new things.
        height: "1.8 m tall", value and unit.
        posts: what stands behind it, flat.
        said: the noun as said, plural and all ("books").
    """

    query: Query
    article: Article
    plural: bool = False
    number: int | None = None
    adjectives: tuple[str, ...] = ()
    height: tuple[float, str] | None = None
    posts: tuple[Post, ...] = field(default=())
    said: str = ""

    @property
    def is_new(self) -> bool:
        """Whether it can name something that is not there yet ("a lamp", "two lamps", "lamp")."""
        plain = self.query.pick in ("one", "any", "all") and not self.query.exclude and not self.query.last
        return plain and bool(self.query.text) and self.article in ("indef", "bare")

    def full(self) -> Query:
        """The query with everything behind the noun, which counts for each of several colours ("red and blue mugs")."""
        first = attach(self.query, self.posts)
        return updated(first, also=tuple(attach(q, self.posts) for q in first.also)) if first.also else first


def updated(query: Query, **fields: Any) -> Query:
    """A validated copy.

    Raises:
        Refusal: more colours, relations or exclusions than a query holds.
    """
    try:
        return Query(**{name: fields.get(name, getattr(query, name)) for name in Query.model_fields})
    except ValueError as error:
        raise Refusal("that is more than one phrase can hold; say it in parts") from error


def union(found: Sequence[Noun]) -> Query:
    """One query for several nouns."""
    first, *rest = (n.full() for n in found)
    return updated(first, also=(*first.also, *rest)) if rest else first


def known(found: Sequence[Noun]) -> Query:
    """The query for things that are there already; "some chairs" does not say which."""
    if any(n.article == "indef" and n.plural and n.number is None for n in found):
        raise Refusal("say which, or how many", "some")
    return union(found)


def all_of(target: Query, out: Query) -> Query:
    """What "all" means before "but the largest box": boxes; before "but the box" it is everything."""
    ranked = out.pick not in ("one", "all", "any", "rest") and bool(out.text)
    return updated(Query(text=out.text, pick="all")) if target == Query(pick="all") and ranked else target


def attach(query: Query, posts: Sequence[Post]) -> Query:
    """`query` narrowed by what stands behind the noun, each phrase at the noun it belongs to."""
    i = 0
    while i < len(posts):
        j = i + 1
        while j < len(posts) and not posts[j].joined and posts[j].kind not in _OF_THE_FIRST and _takes_more(posts[i]):
            j += 1
        query = _narrow(query, posts[i], posts[i + 1 : j])
        i = j
    return query


def _takes_more(post: Post) -> bool:
    """Whether what follows may belong to this phrase's noun; floors and walls are everywhere, so not to theirs."""
    return bool(post.anchors) and head(post.anchors[-1].query.text) not in nouns.EVERYWHERE


def _narrow(query: Query, post: Post, behind: Sequence[Post]) -> Query:
    """`query` with one phrase behind it; `behind` belongs to that phrase's own (last) noun."""
    anchors = [a.full() for a in post.anchors]
    if anchors:
        anchors[-1] = attach(anchors[-1], behind)
    if post.kind == "unrelated":
        wrong = _relation(_relation_name(replace(post, kind="related")), anchors)
        bad = updated(query, relations=(*query.relations, wrong), pick="all", count=None)
        return updated(query, exclude=(*query.exclude, bad))
    if post.kind == "is_not_kind":
        every = (a.model_copy(update={"pick": "all"}) if a.pick in ("one", "any") else a for a in anchors)
        return updated(query, exclude=(*query.exclude, *every))
    if post.kind == "lacking":
        return _lacking(query, post, anchors)
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
    if post.kind == "in_spot" and post.value == "center" and query.pick == "one":
        return updated(query, pick="middle")
    if post.kind == "in_spot" and post.value == "corner":
        return updated(query, relations=(*query.relations, _relation("inside", [Query(text="corner")])))
    raise Refusal("things cannot be picked out by this", post.word)


def _lacking(query: Query, post: Post, anchors: Sequence[Query]) -> Query:
    """ "all lamps without the floor lamp" leaves one lamp out, "the table without a vase" the tables that carry one."""
    if not anchors[0].text or head(anchors[0].text) == head(query.text):
        return updated(query, exclude=(*query.exclude, anchors[0]))
    carrying = [a.model_copy(update={"pick": "all"}) for a in anchors]
    bad = updated(query, relations=(*query.relations, _relation(post.value, carrying)), pick="all", count=None)
    return updated(query, exclude=(*query.exclude, bad))


def _relation_name(post: Post) -> str:
    """The relation a phrase says, "" if it says none."""
    if post.kind == "having":
        return str(post.value)
    if post.kind == "related":
        return relations.named(str(post.value)).query_as or in_or_on(post)
    if post.kind == "off":
        inside = nouns.is_container(post.anchors[0].query.text)
        return "inside" if inside else "on"
    return {"part": "part_of", "between": "between"}.get(post.kind, "")


def in_or_on(post: Post) -> str:
    """The relation of a prepositional phrase; one sits "in" a chair by being on it."""
    seat = post.value == "inside" and nouns.is_seat(post.anchors[0].query.text)
    return "on" if seat else str(post.value)


def _relation(name: str, anchors: Sequence[Query], frame: Literal["viewer", "object"] = "viewer") -> Relation:
    """A relation; "next to a chair" is next to whichever chair."""
    anyone = (a.model_copy(update={"pick": "all"}) if a.pick == "any" and not a.last else a for a in anchors)
    return Relation(name=name, anchors=tuple(anyone), frame=frame)

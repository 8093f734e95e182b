"""Noun phrases as queries.

Knows what a determiner, an attribute and a relation mean for a `Query`, and to which noun a prepositional phrase
belongs. Refuses to know verbs.

Preference: a prepositional phrase belongs to the nearest noun before it ("the lamp on the table next to the sofa" is
about a table next to the sofa), unless "and" joins it to the one before ("left of the table and in front of the
window" says two things about one noun), it is denied ("not against the window"), or that noun is a floor or a wall.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from lark import Token, Tree

from ...gaussians.language.query import Query, Relation
from . import nouns
from .tags import Tag
from .words import bag

_SHAPES = bag("round square rectangular oval circular wooden metal plastic glass leather striped plain patterned")
# "the cup on the table that is white", "anything on the bed that is not a pillow": about the first noun, not the last.
_OF_THE_FIRST = ("unrelated", "is_not_kind", "is_hue", "is_not_hue")
PARTS = frozenset({"part", "piece", "area", "region", "bit"})  # of things, found by their own colour

Article = Literal["def", "indef", "all", "both", "any", "bare", "pronoun"]
Node = Tree[Token]


class Refusal(Exception):
    """The clause cannot become a plan.

    Attributes:
        verdict: of the plan.
        words: the words to blame, as written.
    """

    def __init__(self, reason: str, *words: str, verdict: str = "not_understood") -> None:
        super().__init__(reason)
        self.verdict = verdict
        self.words = words


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
        return _update(first, also=tuple(attach(q, self.posts) for q in first.also)) if first.also else first


def tag_of(token: Token) -> Tag:
    """The tag that a token of the grammar carries."""
    value: Tag = token.value
    return value


def tokens(node: Node, *types: str) -> list[Tag]:
    """The tags of these types directly below a node."""
    return [tag_of(c) for c in node.children if isinstance(c, Token) and c.type in types]


def trees(node: Node, *names: str) -> list[Node]:
    """The children with these names."""
    return [c for c in node.children if isinstance(c, Tree) and (not names or c.data in names)]


class Phrases:
    """Builds nouns; remembers the last head noun for "the green one"."""

    def __init__(self, antecedent: str = "", colors: tuple[str, ...] = ()) -> None:
        self.antecedent = antecedent
        self.sharing = False  # whether the noun of this phrase is said in the next one
        self.colors = colors  # of the antecedent: "the other one" has them too

    def targets(self, node: Node) -> list[Noun]:
        """The nouns of a `targets` node; an exclusion is folded into each of them."""
        groups = trees(node, "group")
        found = self.group(groups[0])
        return self.without(found, groups[1]) if len(groups) > 1 else found

    def group(self, node: Node) -> list[Noun]:
        """The nouns of a group; in "the biggest and the smallest planter" both are planters."""
        parts = trees(node, "np")
        found = []
        for i, part in enumerate(parts):
            if _is_headless(part) and (shared := next((t for p in parts[i + 1 :] if (t := self._named(p))), "")):
                self.antecedent, self.colors, self.sharing = shared, (), True
            found.append(self.noun(part))
            self.sharing = False
        return found

    def _named(self, node: Node) -> str:
        """The noun of a phrase, "" if it has none of its own."""
        core = node.children[0]
        tags = [tag_of(c) for c in core.children if isinstance(c, Token)] if isinstance(core, Tree) else []
        return self._head(tags)[0] if tags and tags[-1].type == "NOUN" else ""

    def without(self, found: list[Noun], excluded: Node) -> list[Noun]:
        """`found` except the nouns of a group."""
        out = union(self.group(excluded))
        meant = [all_of(n.query, out) if n.said == "all" else n.query for n in found]
        found = [replace(n, query=q) for n, q in zip(found, meant, strict=True)]
        return [replace(n, query=_update(n.query, exclude=(*n.query.exclude, out))) for n in found]

    def noun(self, node: Node) -> Noun:
        """A noun phrase with what stands behind it."""
        core, *rest = node.children
        assert isinstance(core, Tree)
        head = self.core(core)
        if head.query.text:
            self.antecedent, self.colors = _unshaped(head.query.text), head.query.colors
        headless = not tokens(core, "NOUN", "ONE", "THING") and bool(tokens(core, "SUP", "ORDINAL"))
        posts: list[Post] = []
        joined = False
        for child in rest:
            if isinstance(child, Token):
                joined = True
                continue
            posts.append(self.post(child, joined))
            joined = False
        if headless and posts and posts[0].kind == "part":
            return self._chosen(head, posts)
        return replace(head, posts=(*head.posts, *posts))

    def _chosen(self, head: Noun, posts: list[Post]) -> Noun:
        """ "the largest of the red chairs"."""
        among = posts[0].anchors[0]
        picked = {"pick": head.query.pick, "ordinal": head.query.ordinal, "count": None}
        self.antecedent = among.query.text or self.antecedent
        return replace(head, query=_update(among.query, **picked), posts=tuple(posts[1:]))

    def post(self, node: Node, joined: bool = False) -> Post:
        first = next((tag_of(c) for c in node.children if isinstance(c, Token)), None)
        anchors = tuple(self.core(c) for c in trees(node, "core"))
        kind, value, word = str(node.data), first.value if first else None, first.text if first else ""
        if kind == "unrelated":
            value = tokens(node, "PREP")[0].value
        elif kind == "is_not_kind":
            value = None
        elif kind == "having":
            value = next((t.value for t in tokens(node, "ONIT")), "below")
            kind = "lacking" if tokens(node, "LACKING") else kind
        elif kind == "between":
            anchors = self._sided(node)
        elif kind in ("is_hue", "is_not_hue"):
            value = tokens(node, "HUE")[0].value
        elif kind == "is_tall":
            value = tokens(node, "TALLER")[0].value
        return Post(kind, value, word, anchors, joined)

    def _sided(self, node: Node) -> tuple[Noun, ...]:
        """The nouns of "between", each narrowed by a side said behind it."""
        found: list[Noun] = []
        for child in node.children:
            if isinstance(child, Tree):
                found.append(self.core(child))
            elif child.type == "SIDE":
                found[-1] = replace(found[-1], query=_update(found[-1].query, pick=tag_of(child).value))
        return tuple(found)

    def core(self, node: Node) -> Noun:
        """A noun without what stands behind it."""
        if owner := trees(node, "core"):
            return self._owned(node, self.core(owner[0]))
        first = tag_of(node.children[0])  # type: ignore[arg-type]
        if first.type == "PRON":
            return Noun(Query(last=True, pick="any" if first.value == "any" else "one"), "pronoun")
        if first.type == "EVERYTHING":
            rest = (Query(last=True),) if first.value == "else" else ()
            return Noun(Query(pick="all", exclude=rest), "all", True, said=first.text)
        if first.type == "OTHERS":
            return Noun(Query(text=self.antecedent, pick="all", exclude=(Query(last=True),)), "all", True)
        return self._common(node)

    def _owned(self, node: Node, owner: Noun) -> Noun:
        """ "the table's legs"."""
        part = self._common(node)
        relation = Relation(name="part_of", anchors=(owner.full(),))
        return replace(part, article="def", query=_update(part.query, relations=(relation,)))

    def _common(self, node: Node) -> Noun:
        tags = [tag_of(c) for c in node.children if isinstance(c, Token)]
        text, plural = self._head(tags)
        article: Article = next((t.value for t in tags if t.type == "DET"), "bare")
        if article == "both" and not plural:
            article = "def"  # "both the vase and the candle"
        number = self._number(tags)
        if tags[0].type == "NUMBER" and any(t.type == "OF" for t in tags):
            raise Refusal("say which of them: the largest, the left one, or all", *_quote(tags))
        adjectives = tuple(t.text for t in tags if t.type == "ADJ")
        height = next((t.value for t in tags if t.type == "TALL"), None)
        sizes = [t.value for t in tags if t.type == "SIZE"]
        if len(sizes) > 1:
            raise Refusal("one size word at a time is understood", *(t.text for t in tags if t.type == "SIZE"))
        fields: dict[str, Any] = {
            "text": " ".join([*adjectives, text]).strip(),
            "colors": tuple(t.value for t in tags if t.type == "COLOR"),
            "not_colors": tuple(t.value for t in tags if t.type == "NONCOLOR"),
            "size": sizes[0] if sizes else None,
            **_pick(tags, article, plural, number),
        }
        if tags[-1].type == "ONE" and len(tags) == 1 and not plural:  # "all but one"
            fields["pick"] = "any"
        if any(t.type == "OTHER" for t in tags):
            fields["exclude"] = (Query(last=True),)
            if tags[-1].type == "ONE" and not fields["colors"]:
                fields["colors"] = self.colors
        if joined := next((t.value for t in tags if t.type == "COLORS"), ()):
            fields = _each(joined, fields, plural)
        words = tuple(t.text for t in tags if t.type == "SIZE")
        said = tags[-1].text if tags[-1].type == "NOUN" else ""
        return Noun(_update(Query(), **fields), article, plural, number, words, height, said=said)

    def _head(self, tags: Sequence[Tag]) -> tuple[str, bool]:
        """The noun's text, singular, and whether it was plural."""
        last = tags[-1]
        if last.type == "THING":
            return ("part" if nouns.singular(last.text) in PARTS else ""), bool(last.value)
        if last.type == "ONE":
            return self.antecedent, bool(last.value)
        if last.type != "NOUN":
            if last.type in ("SUP", "ORDINAL") or self.sharing:
                return self.antecedent, False
            raise Refusal("a noun is missing", *_quote(tags))
        words = str(last.value).split()
        plural = nouns.is_plural(words[-1])
        return " ".join([*words[:-1], nouns.singular(words[-1])]), plural

    def _number(self, tags: Sequence[Tag]) -> int | None:
        numbers = [t for t in tags if t.type == "NUMBER"]
        if not numbers:
            return None
        value = numbers[0].value
        if len(numbers) > 1 or value != int(value) or not 1 <= value <= 1000:
            raise Refusal("that is no number of things", *(t.text for t in numbers))
        return int(value)


def _each(colors: Sequence[str], fields: dict[str, Any], plural: bool) -> dict[str, Any]:
    """ "the red and blue mugs": those that are red, and those that are blue."""
    if not plural or fields.get("pick") != "all" or fields.get("count"):
        raise Refusal("say which of the colours it has", *colors)
    first, *others = ({**fields, "colors": (c,)} for c in colors)
    return {**first, "also": tuple(_update(Query(), **other) for other in others)}


def all_of(target: Query, out: Query) -> Query:
    """What "all" means before "but the largest box": boxes; before "but the box" it is everything."""
    ranked = out.pick not in ("one", "all", "any", "rest") and bool(out.text)
    return _update(Query(text=out.text, pick="all")) if target == Query(pick="all") and ranked else target


def _pick(tags: Sequence[Tag], article: Article, plural: bool, number: int | None) -> dict[str, Any]:
    """`pick`, `ordinal` and `count` of a query."""
    superlatives = [t for t in tags if t.type == "SUP"]
    ordinals = [t for t in tags if t.type == "ORDINAL"]
    several = plural or (number or 1) > 1 or article in ("all", "both")
    if superlatives or ordinals:
        if several or len(superlatives) + len(ordinals) > 1:
            raise Refusal("a superlative or a rank picks one thing; say which one", *_quote(tags))
        if ordinals:
            return {"pick": "nth", "ordinal": int(ordinals[0].value)}
        return {"pick": superlatives[0].value}
    if article == "both":
        return {"pick": "all", "count": 2}
    if article == "all":
        return {"pick": "all", "count": number}
    if article == "any" or (article == "indef" and not plural) or number == 1:
        return {"pick": "any"}
    return {"pick": "all" if several else "one", "count": number}


def _is_headless(node: Node) -> bool:
    """Whether a phrase is a superlative, a rank or a colour without a noun: "the biggest"."""
    core = node.children[0]
    kinds = {c.type for c in core.children if isinstance(c, Token)} if isinstance(core, Tree) else set()
    return bool(kinds & {"SUP", "ORDINAL", "COLOR"}) and not kinds & {"NOUN", "ONE", "THING"}


def _unshaped(text: str) -> str:
    """A noun without words of shape or material, which "the brown one" need not share ("square table": table)."""
    words = text.split()
    while len(words) > 1 and words[0] in _SHAPES:
        words = words[1:]
    return " ".join(words)


def _quote(tags: Sequence[Tag]) -> tuple[str, ...]:
    return (" ".join(t.text for t in tags),)


def _update(query: Query, **fields: Any) -> Query:
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
    return _update(first, also=(*first.also, *rest)) if rest else first


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
    return bool(post.anchors) and nouns.head(post.anchors[-1].query.text) not in nouns.EVERYWHERE


def _narrow(query: Query, post: Post, behind: Sequence[Post]) -> Query:
    """`query` with one phrase behind it; `behind` belongs to that phrase's own (last) noun."""
    anchors = [a.full() for a in post.anchors]
    if anchors:
        anchors[-1] = attach(anchors[-1], behind)
    if post.kind == "unrelated":
        wrong = _relation(_relation_name(replace(post, kind="related")), anchors)
        bad = _update(query, relations=(*query.relations, wrong), pick="all", count=None)
        return _update(query, exclude=(*query.exclude, bad))
    if post.kind == "is_not_kind":
        every = (a.model_copy(update={"pick": "all"}) if a.pick in ("one", "any") else a for a in anchors)
        return _update(query, exclude=(*query.exclude, *every))
    if post.kind == "lacking":
        return _lacking(query, post, anchors)
    if name := _relation_name(post):
        return _update(query, relations=(*query.relations, _relation(name, anchors)))
    if post.kind == "is_hue":
        return _update(query, colors=(*query.colors, post.value))
    if post.kind == "is_not_hue":
        return _update(query, not_colors=(*query.not_colors, post.value))
    if post.kind == "side":
        if query.pick not in ("one", "any"):
            raise Refusal("a side picks one thing; say which one", post.word)
        return _update(query, pick=post.value)
    if post.kind == "counted":
        if query.pick != "nth":
            raise Refusal("counting needs a rank: the second chair from the left", post.word)
        if post.value == "right":
            return _update(query, ordinal=-(query.ordinal or 1))
        return query
    if post.kind == "in_spot" and post.value == "center" and query.pick == "one":
        return _update(query, pick="middle")
    if post.kind == "in_spot" and post.value == "corner":
        return _update(query, relations=(*query.relations, _relation("inside", [Query(text="corner")])))
    raise Refusal("things cannot be picked out by this", post.word)


def _lacking(query: Query, post: Post, anchors: Sequence[Query]) -> Query:
    """ "all lamps without the floor lamp" leaves one lamp out, "the table without a vase" the tables that carry one."""
    if not anchors[0].text or nouns.head(anchors[0].text) == nouns.head(query.text):
        return _update(query, exclude=(*query.exclude, anchors[0]))
    carrying = [a.model_copy(update={"pick": "all"}) for a in anchors]
    bad = _update(query, relations=(*query.relations, _relation(post.value, carrying)), pick="all", count=None)
    return _update(query, exclude=(*query.exclude, bad))


def _relation_name(post: Post) -> str:
    """The relation a phrase says, "" if it says none."""
    if post.kind == "having":
        return str(post.value)
    if post.kind == "related":
        return "next_to" if post.value == "against" else in_or_on(post)
    if post.kind == "off":
        inside = nouns.head(post.anchors[0].query.text) in nouns.CONTAINERS
        return "inside" if inside else "on"
    return {"part": "part_of", "between": "between"}.get(post.kind, "")


def in_or_on(post: Post) -> str:
    """The relation of a prepositional phrase; one sits "in" a chair by being on it."""
    seat = post.value == "inside" and nouns.head(post.anchors[0].query.text) in nouns.SEATS
    return "on" if seat else str(post.value)


def _relation(name: str, anchors: Sequence[Query]) -> Relation:
    """A relation; "next to a chair" is next to whichever chair."""
    anyone = (a.model_copy(update={"pick": "all"}) if a.pick == "any" and not a.last else a for a in anchors)
    return Relation(name=name, anchors=tuple(anyone))  # type: ignore[arg-type]

"""Turns noun phrases of the parse tree into queries: determiners, attributes and pronouns.

Postmodifiers, the phrases behind a noun, are interpreted in described.py.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from lark import Token, Tree

from ....gaussians.language.query.query import Query, Relation
from ....gaussians.world.words import MASS, is_plural, singular
from ..parsing import Node, Refusal, tag_of, tokens, trees
from ..tagging.tags import Tag
from ..tagging.words import bag
from ..vocabulary import nouns
from .changes import Fields
from .described import EVERYTHING, Article, NounPhrase, PostModifier, all_of, existing, union, updated

_SHAPES = bag("round square rectangular oval circular wooden metal plastic glass leather striped plain patterned")
PARTS = frozenset({"part", "piece", "area", "region", "bit"})  # of things; selected by their own colour

_MIDDLES = frozenset({"middle", "centre", "center", "left side", "right side"})
_SIDES = _MIDDLES | {"left", "right", "front", "back", "rear", "top", "bottom"}
_SIDE_OF = {"left": "leftmost", "right": "rightmost", "forward": "farthest", "backward": "nearest", "up": "highest",
            "down": "lowest"}  # fmt: skip


class Phrases:
    """Builds the noun phrases of one instruction and remembers what later words refer to.

    Attributes:
        antecedent: the last head noun, for "the green one".
        before: operations of the previous clause, for "do the same to the lamp".
        colors: colours of the antecedent, which "the other one" has as well.
        sharing: whether the noun of the present phrase comes in a later one ("the red and the blue chair").
        beside: the thing before the present phrase in its list, whose parts it may name ("the plant and its pot").
    """

    def __init__(self, antecedent: str = "", before: Sequence[Fields] = (), colors: tuple[str, ...] = ()) -> None:
        self.antecedent = antecedent
        self.before = list(before)
        self.colors = colors
        self.sharing = False
        self.beside: NounPhrase | None = None

    def targeted(self, node: Node, op: str, **fields: Any) -> list[Fields]:
        """One operation on the things that a clause names, as fields."""
        return [{"op": op, "target": self.query(node), **fields}]

    def query(self, node: Node, index: int = 0) -> Query:
        """The query for the things that a clause names, which exist already."""
        return existing(self.things(node, index))

    def things(self, node: Node, index: int = 0) -> list[NounPhrase]:
        """The noun phrases of a clause; a direction behind the last one ("the chair to the left") picks by side."""
        found = self.targets(trees(node, "targets")[index])
        if (side := tokens(node, "DIR")) and str(node.data) in ("delete", "select", "isolate", "hide"):
            query = found[-1].query
            if query.pick not in ("one", "any"):
                raise Refusal("a side picks one thing; say which one", side[0].text)
            found[-1] = replace(found[-1], query=query.model_copy(update={"pick": _SIDE_OF[side[0].value]}))
        return found

    def targets(self, node: Node) -> list[NounPhrase]:
        """The noun phrases of a `targets` node; an exclusion is added to each of them."""
        groups = trees(node, "group")
        found = self.group(groups[0])
        self.beside = found[-1]
        return self.without(found, groups[1]) if len(groups) > 1 else found

    def group(self, node: Node) -> list[NounPhrase]:
        """The noun phrases of a group; in "the biggest and the smallest planter" both are planters."""
        parts = trees(node, "np")
        found = []
        for i, part in enumerate(parts):
            if _is_headless(part) and (shared := next((t for p in parts[i + 1 :] if (t := self._named(p))), "")):
                self.antecedent, self.colors, self.sharing = shared, (), True
            found.append(self.noun(part))
            self.sharing, self.beside = False, found[-1]
        self.beside = None
        return found

    def _named(self, node: Node) -> str:
        """The noun of a phrase, "" if it has none of its own."""
        core = node.children[0]
        tags = [tag_of(c) for c in core.children if isinstance(c, Token)] if isinstance(core, Tree) else []
        return self._head(tags)[0] if tags and tags[-1].type == "NOUN" else ""

    def without(self, found: list[NounPhrase], excluded: Node) -> list[NounPhrase]:
        """`found`, each excluding the noun phrases of a group."""
        out = union(self.group(excluded))
        meant = [all_of(n.query, out) if n.said == "all" else n.query for n in found]
        found = [replace(n, query=q) for n, q in zip(found, meant, strict=True)]
        return [replace(n, query=updated(n.query, exclude=(*n.query.exclude, out))) for n in found]

    def noun(self, node: Node) -> NounPhrase:
        """A noun phrase with its postmodifiers."""
        core, *rest = node.children
        assert isinstance(core, Tree)
        among = bool(rest) and isinstance(rest[0], Tree) and str(rest[0].data) == "part"
        head = self.core(core, among)
        if head.query.text and head.query.text != EVERYTHING.text:
            self.antecedent, self.colors = _unshaped(head.query.text), head.query.colors
        headless = not tokens(core, "NOUN", "THING") and bool(tokens(core, "SUP", "ORDINAL"))
        modifiers: list[PostModifier] = []
        conjoined = False
        for child in rest:
            if isinstance(child, Token):
                conjoined = True
                continue
            modifiers.append(self.post(child, conjoined))
            conjoined = False
        if headless and modifiers and modifiers[0].kind == "part":
            return self._chosen(head, modifiers)
        if modifiers and _is_content(head, modifiers[0]):
            text = f"{head.query.text} of {modifiers[0].anchors[0].said}"  # "the sacks of flour"
            head, modifiers = replace(head, query=updated(head.query, text=text)), modifiers[1:]
        return replace(head, modifiers=(*head.modifiers, *modifiers))

    def _chosen(self, head: NounPhrase, modifiers: list[PostModifier]) -> NounPhrase:
        """A pick among described things: "the largest of the red chairs"."""
        among = modifiers[0].anchors[0]
        picked = {"pick": head.query.pick, "ordinal": head.query.ordinal, "count": None}
        self.antecedent = among.query.text or self.antecedent
        return replace(head, query=updated(among.query, **picked), modifiers=tuple(modifiers[1:]))

    def post(self, node: Node, conjoined: bool = False) -> PostModifier:
        """The postmodifier of a `post` node."""
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
        elif kind == "in_region":
            value = tokens(node, "REGION", "HEIGHT")[0].value
        elif kind == "is_tall":
            value = tokens(node, "TALLER")[0].value
        return PostModifier(kind, value, word, anchors, conjoined)

    def _sided(self, node: Node) -> tuple[NounPhrase, ...]:
        """The anchors of "between", each restricted by a side given behind it."""
        found: list[NounPhrase] = []
        for child in node.children:
            if isinstance(child, Tree):
                found.append(self.core(child))
            elif child.type == "SIDE":
                found[-1] = replace(found[-1], query=updated(found[-1].query, pick=tag_of(child).value))
        return tuple(found)

    def core(self, node: Node, among: bool = False) -> NounPhrase:
        """A noun phrase without postmodifiers.

        `among` says that the first postmodifier gives the things to pick from ("the left of the two").
        """
        if not among:
            self._require_thing(tag_of(node.children[-1]))  # type: ignore[arg-type]
        if owner := trees(node, "core"):
            whose = self.core(owner[0])
            if whose.article == "pronoun" and self.beside is not None:
                whose = self.beside
            return self._owned(node, whose)
        first = tag_of(node.children[0])  # type: ignore[arg-type]
        if first.type == "PRON":
            return NounPhrase(Query(last=True, pick="any" if first.value == "any" else "one"), "pronoun")
        if first.type == "EVERYTHING":
            rest = (Query(last=True),) if first.value == "else" else ()
            every = EVERYTHING if first.value else Query(pick="all")
            return NounPhrase(updated(every, exclude=rest), "all", True, said=first.text)
        if first.type == "OTHERS":
            return NounPhrase(Query(text=self.antecedent, pick="all", exclude=(Query(last=True),)), "all", True)
        return self._common(node)

    def _require_thing(self, last: Tag) -> None:
        """Raise if a phrase names a place of the room instead of a thing: "clear the middle", "move the left side".

        After an antecedent a side may stand for a thing: "delete the left chair", "and the right". The middle rarely
        does.

        Raises:
            Refusal: it names a place.
        """
        if last.type == "SUP" and not self.sharing and last.text in (_MIDDLES if self.antecedent else _SIDES):
            raise Refusal(f"the {last.text} is a place; say what is there, or which one", last.text)
        if last.type == "NOUN" and singular(str(last.value).split()[-1]) in nouns.NOTHING:
            raise Refusal("that is not a kind of thing; name the things", last.text)

    def _owned(self, node: Node, owner: NounPhrase) -> NounPhrase:
        """A possessive phrase: "the table's legs"."""
        part = self._common(node)
        relation = Relation(name="part_of", anchors=(owner.full(),))
        return replace(part, article="def", query=updated(part.query, relations=(relation,)))

    def _common(self, node: Node) -> NounPhrase:
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
            fields["exclude"], fields["count"] = (Query(last=True),), None  # the others are counted with it
            if tags[-1].type == "ONE" and not fields["colors"]:
                fields["colors"] = self.colors
        if joined := next((t.value for t in tags if t.type == "COLORS"), ()):
            fields = _each(joined, fields, plural)
        words = tuple(t.text for t in tags if t.type == "SIZE")
        said = tags[-1].text if tags[-1].type == "NOUN" else ""
        return NounPhrase(updated(Query(), **fields), article, plural, number, words, height, said=said)

    def _head(self, tags: Sequence[Tag]) -> tuple[str, bool]:
        """The head noun in the singular, and whether it is plural in the text."""
        last = tags[-1]
        if last.type == "THING":
            return ("part" if singular(last.text) in PARTS else ""), bool(last.value)
        if last.type == "ONE":
            return self.antecedent, bool(last.value)
        if last.type == "NUMBER" and any(t.type == "OTHER" for t in tags) and self.antecedent:
            return self.antecedent, True  # "the other two"
        if last.type != "NOUN":
            if last.type in ("SUP", "ORDINAL") or self.sharing:
                return self.antecedent, False
            raise Refusal("a noun is missing", *_quote(tags))
        text = str(last.value)
        return singular(text), is_plural(text)

    def _number(self, tags: Sequence[Tag]) -> int | None:
        numbers = [t for t in tags if t.type == "NUMBER"]
        if not numbers:
            return None
        value = numbers[0].value
        if len(numbers) > 1 or value != int(value) or not 1 <= value <= 1000:
            raise Refusal("that is not a number of things", *(t.text for t in numbers))
        return int(value)


_HOLDING = bag(
    "sack bag box jar bottle can tin bowl cup mug glass pot bucket stack pile bunch pair set roll bale basket crate "
    "tub "
    "packet carton vase plate tray loaf jug barrel case chest pack bundle heap"
)


def _is_content(head: NounPhrase, post: PostModifier) -> bool:
    """Whether a phrase says what a container or a pile is of, which is part of its name: "sacks of flour"."""
    if post.kind != "part" or not head.query.text or head.query.text.split()[-1] not in _HOLDING or head.is_new:
        return False
    of = post.anchors[0]
    return of.article == "bare" and bool(of.said) and not (of.query.colors or of.query.relations or of.number)


def _each(colors: Sequence[str], fields: dict[str, Any], plural: bool) -> dict[str, Any]:
    """A query for each of several colours: "the red and blue mugs" are the red ones and the blue ones."""
    if not plural or fields.get("pick") != "all" or fields.get("count"):
        raise Refusal("say which of the colours it has", *colors)
    first, *others = ({**fields, "colors": (c,)} for c in colors)
    return {**first, "also": tuple(updated(Query(), **other) for other in others)}


def _pick(tags: Sequence[Tag], article: Article, plural: bool, number: int | None) -> dict[str, Any]:
    """The fields `pick`, `ordinal` and `count` of a query."""
    superlatives = [t for t in tags if t.type == "SUP"]
    ordinals = [t for t in tags if t.type == "ORDINAL"]
    last = tags[-1]
    if plural and superlatives and last.type == "NOUN" and str(last.value).split()[-1] in MASS:
        plural = False  # "the tallest furniture" is one piece
    several = plural or (number or 1) > 1 or article in ("all", "both")
    if superlatives or ordinals:
        if superlatives and several and number and number > 1 and not ordinals and len(superlatives) == 1:
            return {"pick": superlatives[0].value, "count": number}  # "the two tallest plants"
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
    """A noun without words for shape or material, which "the brown one" need not share ("square table": table)."""
    words = text.split()
    while len(words) > 1 and words[0] in _SHAPES:
        words = words[1:]
    return " ".join(words)


def _quote(tags: Sequence[Tag]) -> tuple[str, ...]:
    return (" ".join(t.text for t in tags),)

"""Remove choices from a model's plan that the instruction does not make: ids, colours and "all".

The queries then fit several things, and the session asks the user which one is meant.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

from ....gaussians.color import plain_color
from ....gaussians.language.query.nested import queries, with_queries
from ....gaussians.language.query.query import Query
from ....tools.operation import EditOp
from ...rooms.graph_scene import Id
from ...rooms.label_encoder import words
from .rehearsal import Rehearsal

_LOOSE = ("all", "any", "rest")
_WORD = re.compile(r"[^\W\d_]+")
_OPEN_CHOICE = re.compile(r"\b(?:any|some|either|one of|random|whichever|whatever)\b")
_SEVERAL = re.compile(r"\b(?:all|every\w*|each|both|any\w*|whole|entire|ones?|others?|rest|set|pair|group|\d+)\b")
_THE = r"\b(?:the|this|that|my|our|your) "
_IT = re.compile(r"\b(?:it|its|them|they|that|this|those|these|another|again|more|one|ones|same)\b")
# Comparatives, which tell things apart unless the size is what is to change.
_GRADED = frozenset(
    ["bigger", "larger", "smaller", "taller", "shorter", "wider", "narrower", "darker", "lighter", "brighter"]
)
# Words that do not distinguish things of one kind: verbs, amounts and function words.
_PLAIN_WORDS = """
a an the this that it its please kindly can could would will you i we me us my our your to of and then now just let s
want like need have get rid away out off up down go do be is are by for with in on at into onto from so as too also
move shift push pull slide put place set bring take carry turn rotate spin flip tilt make paint color colour recolor
recolour dye tint delete remove erase eliminate discard throw toss drop lose destroy kill clear hide show select pick
choose find highlight isolate keep only replace swap exchange change substitute duplicate copy clone add insert another
more less bit little much very slightly scale resize enlarge shrink grow raise lower lift darker lighter brighter bigger
larger smaller taller shorter wider narrower twice half double degrees degree metre meter metres meters cm mm m inch
inches foot feet ft clockwise counterclockwise transparent invisible opaque
"""


def drop_unstated_ids(ops: Sequence[EditOp], text: str, scene: Rehearsal) -> tuple[EditOp, ...]:
    """Remove ids where the words of the query fit more things and the instruction does not distinguish them.

    Example: "delete the chair", and a model that picks one of three. Ids stay where the plan treats every one of the
    things alike, each in a step of its own, and where the instruction says the colour that tells them apart.

    Args:
        ops: queries with ids that do not exist are left as they are.
        text: the instruction.
    """
    said = text.lower()
    if _OPEN_CHOICE.search(said):
        return tuple(ops)
    used = _used(ops)
    meant = {i for _, query in queries(tuple(ops)) for i in query.groups}

    def rewrite(query: Query) -> Query:
        if not query.groups or scene.missing_ids(query) or scene.misnamed(query):
            return query
        named = query if query.text else query.model_copy(update={"text": scene.label(query.groups[0])})
        fits = scene.by_words(named) if named.text else ()
        plain = _plain() if any(op.op == "scale" for op in ops) else _plain() - _GRADED
        told = all(stems(word) <= plain | used | stems(named.text) for word in _WORD.findall(said))
        if not set(query.groups) < set(fits) or not told:
            return query
        last = scene.last is not None and set(query.groups) == set(scene.last_ids) and _IT.search(said)
        if last or set(fits) <= meant or _told_by_color(set(query.groups), fits, stems(text), scene):
            return query
        # One thing is meant, however many ids the model gave; never all that the words fit.
        return named.model_copy(update={"groups": (), "pick": "one" if named.pick in _LOOSE else named.pick})

    return tuple(with_queries(op, rewrite) for op in ops)


def _told_by_color(chosen: set[int], fits: Sequence[Id], said: set[str], scene: Rehearsal) -> bool:
    """Whether the chosen things are those of the alike whose colour is said."""
    colors = {n.id: stems(plain_color(n.color)) for n in scene.graph.nodes if n.id in fits}
    spoken = {id: own & said for id, own in colors.items()}
    wanted = set[str]().union(*(spoken.get(i, set()) for i in chosen))
    return bool(wanted) and chosen == {i for i, own in spoken.items() if own & wanted}


def drop_unstated_colors(ops: Sequence[EditOp], text: str, previous: str | None) -> tuple[EditOp, ...]:
    """Remove colours that the instruction does not state, where all of its words are explained without them.

    Example: "delete the chair", and a model that says the red one. An unexplained word (of another language, "crimson",
    "my") may be the source of the colour, and then it stays.
    """
    said = stems(f"{text} {previous or ''}")
    used = _used(ops)
    if not all(stems(word) <= _plain() | used for word in _WORD.findall(text.lower())):
        return tuple(ops)

    def rewrite(query: Query) -> Query:
        if not query.text or query.last or query.groups:
            return query
        stated = tuple(c for c in query.colors if stems(c) & said)
        return query.model_copy(update={"colors": stated}) if stated != query.colors else query

    return tuple(with_queries(op, rewrite) for op in ops)


def singular_picks(ops: Sequence[EditOp], text: str, scene: Rehearsal) -> tuple[EditOp, ...]:
    """Set `pick` to "one" where the instruction speaks of one thing: "delete the chair" is never all chairs, nor any.

    Only if the name is that of things in the scene and occurs once in the instruction, in the singular, after "the" or
    the like, without a word for several or for any.
    """
    said = text.lower()
    heads = {w for node in scene.graph.nodes for w in words(node.label)[-1:]}

    def rewrite(query: Query) -> Query:
        noun = query.text.lower().split()[-1:]
        if query.pick not in ("all", "any") or query.groups or not noun or not heads & set(words(noun[0])):
            return query
        here = [w for w in _WORD.findall(said) if set(words(w)) & set(words(noun[0]))]
        one = here == noun and re.search(rf"{_THE}(?:[\w-]+ ){{0,3}}{re.escape(noun[0])}\b", said)
        return query.model_copy(update={"pick": "one"}) if one else query

    if _OPEN_CHOICE.search(said) or _SEVERAL.search(said):
        return tuple(ops)
    return tuple(with_queries(op, rewrite) for op in ops)


def stems(text: str) -> set[str]:
    """The words of a text, as written and normalised."""
    return {s for w in _WORD.findall(text.lower()) for s in (w, *words(w))}


@cache
def _plain() -> frozenset[str]:
    return frozenset(stems(_PLAIN_WORDS))


def _used(ops: Sequence[EditOp]) -> set[str]:
    """The words of all operations."""
    return {s for op in ops for value in _strings(op.model_dump(exclude_defaults=True)) for s in stems(value)}


def _strings(node: Any) -> Iterator[str]:
    if isinstance(node, str):
        yield node.replace("_", " ")
    for item in node.values() if isinstance(node, dict) else node if isinstance(node, tuple | list) else ():
        yield from _strings(item)

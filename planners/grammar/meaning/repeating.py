"""Rules for commands that repeat or continue the one before: "do the same to the lamp", "and the green one"."""

from __future__ import annotations

from ....gaussians.language.query.query import Query
from ..parsing import Node, Refusal, tokens
from . import changes
from .changes import Fields
from .described import existing
from .phrases import Phrases
from .places import split_destination


def same(phrases: Phrases, node: Node) -> list[Fields]:
    """Repeat the previous clause with another target: "do the same to the lamp"."""
    return _again(phrases, phrases.query(node))


def bare(phrases: Phrases, node: Node) -> list[Fields]:
    """Repeat the previous clause for a thing that is named alone: "and the green one too"."""
    found = phrases.things(node)
    pointing = all(n.article in ("def", "all", "both") and not n.query.last for n in found)
    if not phrases.before or not pointing:
        raise Refusal("it does not say what to do", found[0].said or found[0].query.text)
    if len(found) == 1 and len(phrases.before) == 1 and phrases.before[0].get("place"):
        thing, place = split_destination(found[0], "PUT")
        if place is not None and thing.article != "pronoun":
            return [{"op": "move", "target": existing([thing]), "place": place}]  # "and the vase on the shelf"
    return _again(phrases, existing(found))


def _again(phrases: Phrases, target: Query) -> list[Fields]:
    first = next((op.get("target") for op in phrases.before), None)
    if first is None or any("held" in op for op in phrases.before):
        raise Refusal("it is not clear what to do with it")
    if any(op.get("target") not in (first, Query(last=True)) for op in phrases.before):
        raise Refusal("the previous clause did several things; say what to do with it")
    chained = [op.get("target") != first for op in phrases.before]
    return [{**op, "target": Query(last=True) if c else target} for op, c in zip(phrases.before, chained, strict=True)]


def more(phrases: Phrases, node: Node) -> list[Fields]:
    """The last change again, by a little or as said: "a bit more" behind "move it to the left"."""
    if not phrases.before:
        raise Refusal("say of what", "more")
    return [changes.repeated(op, changes.degree_of(node)) for op in phrases.before]


def more_by(phrases: Phrases, node: Node) -> list[Fields]:
    """The last change again, as far as said: "another 10 cm" behind "move it 20 cm to the left"."""
    if not phrases.before:
        raise Refusal("say of what", "more")
    share = changes.share_of(node)
    amount = (
        ("FRACTION", share)
        if share is not None
        else next((t.type, t.value) for t in tokens(node, "LENGTH", "ANGLE", "NUMBER", "TIMES"))
    )
    return [changes.repeated_by(op, *amount) for op in phrases.before]


RULES = (same, bare, more, more_by)

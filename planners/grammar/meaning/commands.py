"""Parsed clauses as operations: one function for each rule of grammar.lark that is a command.

Those that move, turn, resize and add are in moving.py, shaping.py and adding.py. Every function gives operations as
fields, which the registry of tools validates.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise

from ....gaussians.language.query.query import Query
from ....gaussians.world.words import head
from ..parsing import Node, Refusal, tokens, trees
from ..vocabulary import nouns
from . import adding, changes, moving, shaping
from .adding import inserted
from .changes import Fields
from .described import Noun, all_of, known, union
from .moving import moved
from .phrases import Phrases
from .places import MOTIONS


def read(said: Phrases, tree: Node) -> list[Fields]:
    """The operations of a clause of the instruction whose phrases are `said`.

    Raises:
        Refusal: it parses, but does not say enough or asks for what no operation does.
    """
    simple, *excluded = [c for c in tree.children if not hasattr(c, "type")]
    ops = _rules()[str(simple.data).rstrip("_")](said, simple)
    for group in excluded:
        out = union(said.group(group))
        ops = [{**op, "target": _except(_all_of(op.get("target"), out, simple), out)} for op in ops]
    said.before = ops
    return ops


@cache
def _rules() -> dict[str, Callable[[Phrases, Node], list[Fields]]]:
    """The function of each rule of grammar.lark that is a command, by the rule's name."""
    found = (*_RULES, *adding.RULES, *moving.RULES, *shaping.RULES)
    named = {rule.__name__.rstrip("_"): rule for rule in found}
    return {**named, "change_color": give_color, "turn_color": give_color}


# ---- again ---------------------------------------------------------------------------------------------------


def same(said: Phrases, node: Node) -> list[Fields]:
    """ "do the same to the lamp": the clause before with another target."""
    return _again(said, said.query(node))


def bare(said: Phrases, node: Node) -> list[Fields]:
    """ "and the green one too": a thing alone is the next target of what was asked before."""
    found = said.things(node)
    pointing = all(n.article in ("def", "all", "both") and not n.query.last for n in found)
    if not said.before or not pointing:
        raise Refusal("it does not say what to do", found[0].said or found[0].query.text)
    return _again(said, known(found))


def _again(said: Phrases, target: Query) -> list[Fields]:
    first = next((op.get("target") for op in said.before), None)
    if first is None or any("held" in op for op in said.before):
        raise Refusal("it is not clear what is to be done with it")
    if any(op.get("target") not in (first, Query(last=True)) for op in said.before):
        raise Refusal("several things were done before; say what is to be done with it")
    chained = [op.get("target") != first for op in said.before]
    return [{**op, "target": Query(last=True) if c else target} for op, c in zip(said.before, chained, strict=True)]


# ---- seeing and removing -------------------------------------------------------------------------------------


def delete(said: Phrases, node: Node) -> list[Fields]:
    found = said.things(node)
    if any(p.word.startswith(("onto", "into")) for n in found for p in n.posts):
        return moved(said, found, node, "MOVE")  # "chuck the cushion onto the bed"
    _require_clear_end(found)
    return [{"op": "delete", "target": known(found)}]


def clear(said: Phrases, node: Node) -> list[Fields]:
    """ "clear the plants" removes them; "clear the table" and "clear the corner" say nothing of what is there."""
    found = said.things(node)
    if (place := next((n for n in found if _is_cleared(n)), None)) is not None:
        there = head(place.query.text) in nouns.PLACES
        raise Refusal(f"say {'what is to go from there' if there else 'whether to remove it or everything on it'}",
                      "clear")  # fmt: skip
    _require_clear_end(found)
    return [{"op": "delete", "target": union(found)}]


def drop(said: Phrases, node: Node) -> list[Fields]:
    found = said.things(node)
    if trees(node, *MOTIONS) or any(n.posts or n.article == "all" for n in found):
        raise Refusal("say put or delete", "drop")
    return said.targeted(node, "delete")


def take(said: Phrases, node: Node) -> list[Fields]:
    found = said.things(node)
    if not trees(node, *MOTIONS):
        return [{"op": "select", "target": known(found), "held": "taken"}]
    return moved(said, found, node, "MOVE")


def keep(said: Phrases, node: Node) -> list[Fields]:
    """ "keep the sofa and delete the rest": what is kept is what the next step leaves out."""
    return said.targeted(node, "select", held="kept")


def select(said: Phrases, node: Node) -> list[Fields]:
    word = tokens(node, "SELECT")[0].text
    if word == "show" and said.query(node) == Query(pick="all"):
        raise Refusal("what was hidden comes back with undo", word, verdict="impossible")
    return said.targeted(node, "select")


def isolate(said: Phrases, node: Node) -> list[Fields]:
    return said.targeted(node, "isolate")


def hide(said: Phrases, node: Node) -> list[Fields]:
    return said.targeted(node, "opacity", value=0.0)


def fade(said: Phrases, node: Node) -> list[Fields]:
    share = changes.share_of(node)
    if share is None:
        return said.targeted(node, **changes.opacity(changes.CLEARER[changes.degree_of(node)]))
    return said.targeted(node, **changes.opacity(share if tokens(node, "TO") else 1 - share))


def switch(said: Phrases, node: Node) -> list[Fields]:
    raise Refusal("moving parts and switches cannot be operated", "turn " + tokens(node, "SWITCH")[0].text,
                  verdict="impossible")  # fmt: skip


# ---- colour --------------------------------------------------------------------------------------------------


def paint(said: Phrases, node: Node) -> list[Fields]:
    return [op for coat in trees(node, "coat") for op in give_color(said, coat)]


def give_color(said: Phrases, node: Node) -> list[Fields]:
    hue = trees(node, "hue")[-1]
    if any(t.text == "tint" for t in tokens(hue, "COLORWORD")):
        return tint(said, node)
    return said.targeted(node, "recolor", color=changes.hue_of(hue))


def change_from(said: Phrases, node: Node) -> list[Fields]:
    found = said.things(node)
    was = tokens(node, "HUE")[0].value
    colored = [replace(n, query=n.query.model_copy(update={"colors": (*n.query.colors, was)})) for n in found]
    return [{"op": "recolor", "target": union(colored), "color": changes.hue_of(trees(node, "hue")[-1])}]


def tint(said: Phrases, node: Node) -> list[Fields]:
    return said.targeted(node, "recolor", adjust="toward", color=changes.hue_of(trees(node, "hue")[0]))


def tint_more(said: Phrases, node: Node) -> list[Fields]:
    amount = changes.AMOUNT[changes.degree_of(node)]
    return said.targeted(node, "recolor", adjust="toward", color=tokens(node, "HUE")[0].value, amount=amount)


def give_shade(said: Phrases, node: Node) -> list[Fields]:
    return said.targeted(node, **changes.adjusted(tokens(node, "LIGHT")[0].value, "", None))


def coat_on(said: Phrases, node: Node) -> list[Fields]:
    """ "slap a coat of red paint on the cabinet"."""
    if tokens(node, "PREP")[0].value != "on":
        raise Refusal("paint goes on things", tokens(node, "PREP")[0].text)
    target = known([said.noun(trees(node, "np")[0])])
    return [{"op": "recolor", "target": target, "color": tokens(node, "HUE")[0].value}]


def adjust(said: Phrases, node: Node) -> list[Fields]:
    kind = tokens(node, "ADJUST")[0].value[0]
    return said.targeted(node, **changes.adjusted(kind, changes.degree_of(node), changes.share_of(node)))


def change_opacity(said: Phrases, node: Node) -> list[Fields]:
    share = changes.share_of(node) or 0.0
    solid = tokens(node, "OPACITYWORD")[0].value
    return said.targeted(node, **changes.opacity(share if solid else 1 - share))


# ---- becoming ------------------------------------------------------------------------------------------------


def make(said: Phrases, node: Node) -> list[Fields]:
    first, *others = trees(node)
    change, *more = others
    if change.data == "absolute_size" and said.things(node)[0].article == "indef":
        raise Refusal("say the one that is there, or add one of that height", *said.things(node)[0].said.split())
    ops = [{**changes.change(change), "target": known(said.targets(first))}]
    for also in more:
        inner = trees(also)
        same = inner[0].data != "targets"
        fields = changes.change(inner[-1])
        if same and "color" in fields and "color" in ops[-1]:
            raise Refusal("one colour at a time", fields["color"])
        target = Query(last=True) if same else known(said.targets(inner[0]))
        ops.append({**fields, "target": target})
    return ops


def it_becomes(said: Phrases, node: Node) -> list[Fields]:
    return [{**changes.change(c), "target": Query(last=True)} for c in trees(node)]


# ---- moving or adding ----------------------------------------------------------------------------------------


def put(said: Phrases, node: Node) -> list[Fields]:
    found = said.things(node)
    fresh = [n.article == "indef" or (n.article == "bare" and (n.number or n.plural)) for n in found]
    if all(fresh):
        return inserted(said, found, node, "PUT")
    if any(fresh):
        raise Refusal("name what to move and what to add in two clauses")
    return moved(said, found, node, "PUT")


def _is_cleared(noun: Noun) -> bool:
    """Whether a noun is rather what is freed than what goes: a place, what carries or holds things, a part of it."""
    of_a_thing = any(p.kind == "part" for p in noun.posts) or any(r.name == "part_of" for r in noun.query.relations)
    name = noun.query.text
    freed = head(name) in nouns.EVERYWHERE | nouns.PLACES or nouns.is_surface(name) or nouns.is_furniture(name)
    return noun.query.last or of_a_thing or freed


def _require_clear_end(found: Sequence[Noun]) -> None:
    """Raise if it is open where a list ends: "remove the cushions from the sofa and the armchair".

    Raises:
        Refusal: it is.
    """
    for noun, following in pairwise(found):
        if any(p.kind == "off" for p in noun.posts) and not following.posts:
            raise Refusal("say in two clauses what it is taken from and what else goes", following.said)


def _all_of(target: Query | None, out: Query, node: Node) -> Query | None:
    """ "all but the largest box" speaks of boxes only."""
    said = [t.text for found in node.find_data("core") for t in tokens(found, "EVERYTHING")]
    return all_of(target, out) if target is not None and said == ["all"] else target


def _except(target: Query | None, out: Query) -> Query:
    if target is None or len(target.exclude) >= 4:
        raise Refusal("that cannot be left out here")
    also = tuple(_except(a, out) for a in target.also)
    return target.model_copy(update={"exclude": (*target.exclude, out), "also": also})


_RULES = (
    same, bare, delete, clear, drop, take, keep, select, isolate, hide, fade, switch, paint, give_color, change_from,
    tint, tint_more, give_shade, coat_on, adjust, change_opacity, make, it_becomes, put,
)  # fmt: skip

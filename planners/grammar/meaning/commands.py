"""Turns parsed clauses into operations: one function for each rule of grammar.lark that is a command.

The rules that move, rotate, resize, add and repeat are in moving.py, shaping.py, adding.py and repeating.py. Every
function returns operations as fields, which the registry of tools validates.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise
from typing import Any

from ....gaussians.language.query.nested import with_queries
from ....gaussians.language.query.query import Query, Region, Relation
from ....gaussians.world import kinds
from ....gaussians.world.words import head
from ..parsing import Node, Refusal, tokens, trees
from ..vocabulary import nouns
from ..vocabulary.materials import ANYTHING, is_mark, meant
from . import adding, changes, moving, repeating, shaping
from .adding import inserted
from .changes import Fields
from .described import EVERYTHING, NounPhrase, all_of, existing, is_all_on_it, union
from .moving import moved
from .phrases import Phrases
from .places import MOTIONS, goal_of, length, read_motion


def operations_of(phrases: Phrases, tree: Node) -> list[Fields]:
    """The operations of a parsed clause; `phrases` holds the context of its instruction.

    Raises:
        Refusal: the clause is incomplete, or no operation does what it asks for.
    """
    simple, *excluded = [c for c in tree.children if not hasattr(c, "type")]
    ops = _rules()[str(simple.data).rstrip("_")](phrases, simple)
    for group in excluded:
        out = union(phrases.group(group))
        ops = [{**op, "target": _except(_all_of(op.get("target"), out, simple), out)} for op in ops]
    ops = [_with_others(op, not phrases.before) for op in ops]
    phrases.before = ops
    return ops


def _with_others(op: Fields, first: bool) -> Fields:
    """An operation in which "the other one" leaves out its own target: "make the silver lamp like the other one".

    Where nothing was said before (`first`), "move the vase to the other table" leaves out the table that it is on.
    """
    target = op.get("target")
    if not isinstance(target, Query) or target.last:
        return op

    def named(query: Query) -> Query:
        if Query(last=True) not in query.exclude:
            return query
        if query.text != target.text:
            under = Relation(name="below", anchors=(target,))
            with_it = query.model_copy(update={"exclude": (), "relations": (*query.relations[:3], under)})
            return query.model_copy(update={"exclude": (with_it,)}) if first and target.pick != "all" else query
        rest = tuple(target if q == Query(last=True) else q for q in query.exclude)
        colors = () if query.colors == target.colors else query.colors
        return query.model_copy(update={"exclude": rest, "colors": colors})

    changed = {name: _named_in(op[name], named) for name in ("like", "toward", "place") if op.get(name) is not None}
    return {**op, **changed} if changed else op


def _named_in(value: Any, change: Callable[[Query], Query]) -> Any:
    """A query, or the anchors of a place, with every query changed."""
    if isinstance(value, Query):
        return with_queries(value, change)
    anchors = value.get("anchors") if isinstance(value, dict) else None
    return {**value, "anchors": tuple(with_queries(a, change) for a in anchors)} if anchors else value


@cache
def _rules() -> dict[str, Callable[[Phrases, Node], list[Fields]]]:
    """The functions of the command rules by the name of the rule in grammar.lark."""
    found = (*_RULES, *adding.RULES, *moving.RULES, *repeating.RULES, *shaping.RULES)
    named = {rule.__name__.rstrip("_"): rule for rule in found}
    return {**named, "change_color": give_color, "turn_color": give_color}


# ---- one thing or several -----------------------------------------------------------------------------------------


def merge(phrases: Phrases, node: Node) -> list[Fields]:
    """Several things are one: "merge the pot and the plant", "the pot is part of the plant"."""
    found = _all_things(phrases, node)
    into_last = tokens(node, "PARTOF", "TAKE") and found[-1].query.text
    return [{"op": "merge", "target": union(found), **({"name": into_last} if into_last else {})}]


def split(phrases: Phrases, node: Node) -> list[Fields]:
    """One thing is several: "split the lamp in two", "that is two things"."""
    many = [t.value for t in tokens(node, "INTOMANY", "BEMANY")]
    found = _all_things(phrases, node)
    if len(found) == 1 and (wholes := [p.anchors for p in found[0].modifiers if p.kind == "off"]):
        names = [n.query.text for n in (*found, *wholes[0]) if n.query.text]  # "the pot from the plant"
        return [{"op": "split", "target": existing(wholes[0]), "into": 2, "names": names}]
    if len(found) > 1:
        raise Refusal("say which one thing to split: one is split at a time", found[0].said)
    target = existing(found) if found else Query(last=True)
    return [{"op": "split", "target": target, **({"into": many[0]} if many else {})}]


def split_into(phrases: Phrases, node: Node) -> list[Fields]:
    """One thing is several that are named: "split the plant into the pot and the crown"."""
    whole, pieces = (phrases.targets(tree) for tree in trees(node, "targets"))
    names = [piece.query.text for piece in pieces]
    if len(whole) != 1 or len(names) < 2 or not all(names):
        raise Refusal("say one thing to split, and the names of two or more that it is to become", whole[0].said)
    return [{"op": "split", "target": existing(whole), "into": len(names), "names": names}]


def _all_things(phrases: Phrases, node: Node) -> list[NounPhrase]:
    """Every noun phrase of a clause, in the order of the words."""
    inner = [found for tree in trees(node, "targets") for found in phrases.targets(tree)]
    return [*inner, *(phrases.noun(tree) for tree in trees(node, "np"))]


# ---- selecting, hiding and removing -------------------------------------------------------------------------------


def delete(phrases: Phrases, node: Node) -> list[Fields]:
    found = phrases.things(node)
    if any(p.word.startswith(("onto", "into")) for n in found for p in n.modifiers):
        return moved(phrases, found, node, "MOVE")  # "chuck the cushion onto the bed"
    _require_clear_end(found)
    if len(found) > 1 and is_all_on_it(found[-1]) and not found[0].query.last:  # "the table and what is on it"
        return [{"op": "delete", "target": existing(found[:-1]), "on_it": "goes"}]
    return [{"op": "delete", "target": existing(found)}]


def clear(phrases: Phrases, node: Node) -> list[Fields]:
    """Remove things ("clear the plants"); "clear the table" and "clear the corner" do not say what to remove."""
    found = phrases.things(node)
    if (place := next((n for n in found if _is_cleared(n)), None)) is not None:
        there = head(place.query.text) in nouns.PLACES
        raise Refusal(f"say {'what to remove from there' if there else 'whether to remove it or everything on it'}",
                      "clear", firm=True)  # fmt: skip
    _require_clear_end(found)
    return [{"op": "delete", "target": union(found)}]


def drop(phrases: Phrases, node: Node) -> list[Fields]:
    found = phrases.things(node)
    far = [t for d in trees(node, "distance") for t in tokens(d, "LENGTH")]
    if len(far) == len(trees(node, *MOTIONS)) == 1:
        return phrases.targeted(node, "move", direction="down", distance=length(far[0].value))
    if any(p.kind == "related" and p.value in ("on", "inside") for p in found[-1].modifiers) and not trees(
        node, *MOTIONS
    ):
        return moved(phrases, found, node, "PUT")  # "drop it in the box"
    nudged = [d for d in trees(node, "nudge")]
    if len(nudged) == len(trees(node, *MOTIONS)) == 1:
        motion = read_motion(nudged, phrases)
        return phrases.targeted(node, "move", direction="down", **motion.fields())  # "drop it a bit"
    if trees(node, *MOTIONS) or any(n.modifiers or n.article == "all" for n in found):
        raise Refusal("say put or delete", "drop")
    return phrases.targeted(node, "delete")


def take(phrases: Phrases, node: Node) -> list[Fields]:
    found = phrases.things(node)
    goes = any(p.word.startswith(("into", "onto", "against", "up against")) for p in found[-1].modifiers)
    if not trees(node, *MOTIONS) and not goes:
        if all(n.is_new and n.article == "indef" for n in found) and tokens(node, "TAKE")[0].text in (
            "get",
            "fetch",
            "grab",
        ):
            return inserted(phrases, found, node, "ADD")  # "can we get a lamp next to the bed"
        off = any(p.kind == "off" for p in found[-1].modifiers)
        return [{"op": "select", "target": existing(found), "held": "taken off" if off else "taken"}]
    return moved(phrases, found, node, "MOVE")


def keep(phrases: Phrases, node: Node) -> list[Fields]:
    """Mark things for the next operation to leave out: "keep the sofa and delete the rest"."""
    return phrases.targeted(node, "select", held="kept")


def select(phrases: Phrases, node: Node) -> list[Fields]:
    word = tokens(node, "SELECT")[0].text
    if word == "show" and phrases.query(node) in (Query(pick="all"), EVERYTHING):
        raise Refusal("to show what was hidden, use undo", word, verdict="impossible")
    return phrases.targeted(node, "select")


def isolate(phrases: Phrases, node: Node) -> list[Fields]:
    return phrases.targeted(node, "isolate")


def hide(phrases: Phrases, node: Node) -> list[Fields]:
    return phrases.targeted(node, "opacity", value=0.0)


def crop(phrases: Phrases, node: Node) -> list[Fields]:
    """Keep only some things with what stands on them: "crop to the table"."""
    *_, kept = (phrases.targets(tree) for tree in trees(node, "targets"))
    return _cropped(existing(kept))


def crop_away(phrases: Phrases, node: Node) -> list[Fields]:
    """ "crop around the table"; "crop everything above 1 m" removes it."""
    found = phrases.query(node)
    if tokens(node, "CROP")[0].value == "around":
        return _cropped(found)
    if found == EVERYTHING:
        raise Refusal("say to what: crop to the table, crop to 2 m around the table", "crop")
    if found.region is None:
        raise Refusal("say crop to it, or remove it", tokens(node, "CROP")[0].text)
    return [{"op": "delete", "target": found}]


def crop_space(phrases: Phrases, node: Node) -> list[Fields]:
    """Keep only a part of space: "crop to 2 m around the table"; "crop the scene above 1 m" removes it."""
    space = tokens(node, "REGION", "HEIGHT")[0]
    of = tuple(phrases.noun(tree).full() for tree in trees(node, "np"))
    target = EVERYTHING.model_copy(update={"region": Region(**space.value, of=of)})
    removed = space.type == "HEIGHT" and not tokens(node, "TO")
    return [{"op": "delete" if removed else "isolate", "target": target}]


def _cropped(kept: Query) -> list[Fields]:
    """What keeps only a part of space or only things."""
    if kept.region is not None and kept.text == EVERYTHING.text:
        return [{"op": "isolate", "target": kept}]
    around = Region(name="around", of=(kept,))
    return [{"op": "isolate", "target": EVERYTHING.model_copy(update={"region": around})}]


def fade(phrases: Phrases, node: Node) -> list[Fields]:
    share = changes.share_of(node)
    if share is None:
        return phrases.targeted(node, **changes.opacity(changes.CLEARER[changes.degree_of(node)]))
    return phrases.targeted(node, **changes.opacity(share if tokens(node, "TO") else 1 - share))


def fade_to(phrases: Phrases, node: Node) -> list[Fields]:
    """ "fade the board to 30 % opacity", "make it 60 % transparency"."""
    share = changes.share_of(node) or 0.0
    solid = tokens(node, "OPACITYWORD")[0].value
    return phrases.targeted(node, **changes.opacity(share if solid else 1 - share))


def switch(phrases: Phrases, node: Node) -> list[Fields]:
    raise Refusal("moving parts and switches cannot be operated", "turn " + tokens(node, "SWITCH")[0].text,
                  verdict="impossible")  # fmt: skip


# ---- colour -------------------------------------------------------------------------------------------------------


def paint(phrases: Phrases, node: Node) -> list[Fields]:
    """A coat of paint; "paint it oak" asks for the colour of oak, "paint it #oak" stands for the material."""
    return [op for coat in trees(node, "coat") for op in give_color(phrases, coat, painted=True)]


def give_color(phrases: Phrases, node: Node, painted: bool = False) -> list[Fields]:
    hue = trees(node, "hue")[-1]
    if any(t.text == "tint" for t in tokens(hue, "COLORWORD")):
        return tint(phrases, node)
    said = changes.hue_of(hue)
    fields = {"op": "recolor", "color": said} if painted and not is_mark(said) else meant(said)
    return phrases.targeted(node, **fields)


def paint_like(phrases: Phrases, node: Node) -> list[Fields]:
    """ "paint the chair the same colour as the table", "the pattern of the curtain on the sofa"."""
    return phrases.targeted(node, **_likened(phrases, node))


def _likened(phrases: Phrases, node: Node) -> Fields:
    """The fields of what gets the colour, or the surface, of another thing."""
    like = goal_of(phrases, trees(node, "np")[0]).full()
    surface = tokens(node, "COLORLIKE")[0].value
    if surface is None:
        return {"op": "recolor", "like": like}
    return {"op": "restyle", "like": like, **({} if surface == ANYTHING else {"material": surface})}


def change_from(phrases: Phrases, node: Node) -> list[Fields]:
    found = phrases.things(node)
    was = tokens(node, "HUE")[0].value
    colored = [replace(n, query=n.query.model_copy(update={"colors": (*n.query.colors, was)})) for n in found]
    return [{"op": "recolor", "target": union(colored), "color": changes.hue_of(trees(node, "hue")[-1])}]


def tint(phrases: Phrases, node: Node) -> list[Fields]:
    return phrases.targeted(node, "recolor", adjust="toward", color=changes.hue_of(trees(node, "hue")[0]))


def tint_more(phrases: Phrases, node: Node) -> list[Fields]:
    amount = changes.AMOUNT[changes.degree_of(node)]
    return phrases.targeted(node, "recolor", adjust="toward", color=tokens(node, "HUE")[0].value, amount=amount)


def give_shade(phrases: Phrases, node: Node) -> list[Fields]:
    return phrases.targeted(node, **changes.adjusted(tokens(node, "LIGHT")[0].value, "", None))


def coat_on(phrases: Phrases, node: Node) -> list[Fields]:
    """Recolour: "slap a coat of red paint on the cabinet"."""
    if tokens(node, "PREP")[0].value != "on":
        raise Refusal("say on what to put the paint", tokens(node, "PREP")[0].text)
    target = existing([phrases.noun(trees(node, "np")[0])])
    return [{"op": "recolor", "target": target, "color": tokens(node, "HUE")[0].value}]


def adjust(phrases: Phrases, node: Node) -> list[Fields]:
    kind = tokens(node, "ADJUST")[0].value[0]
    return phrases.targeted(node, **changes.adjusted(kind, changes.degree_of(node), changes.share_of(node)))


def change_opacity(phrases: Phrases, node: Node) -> list[Fields]:
    share = changes.share_of(node) or 0.0
    solid = tokens(node, "OPACITYWORD")[0].value
    return phrases.targeted(node, **changes.opacity(share if solid else 1 - share))


# ---- becoming -----------------------------------------------------------------------------------------------------


def make(phrases: Phrases, node: Node) -> list[Fields]:
    first, *others = trees(node)
    change, *more = others
    found = phrases.targets(first)
    if tokens(node, "SHOULD") and found[0].article == "any":
        found = [
            replace(n, query=n.query.model_copy(update={"pick": "all"})) for n in found
        ]  # "any mirror should be gold"
    if change.data == "absolute_size" and found[0].article == "indef":
        raise Refusal("say which existing one, or add one of that height", *found[0].said.split())
    ops = [{**_changed(phrases, change), "target": existing(found)}]
    for also in more:
        inner = trees(also)
        same = inner[0].data != "targets"
        fields = _changed(phrases, inner[-1])
        if same and "color" in fields and "color" in ops[-1]:
            raise Refusal("one colour at a time", fields["color"])
        target = Query(last=True) if same else existing(phrases.targets(inner[0]))
        ops.append({**fields, "target": target})
    return ops


def it_becomes(phrases: Phrases, node: Node) -> list[Fields]:
    return [{**_changed(phrases, c), "target": Query(last=True)} for c in trees(node)]


def _changed(phrases: Phrases, change: Node) -> Fields:
    """The fields of a change; "the same colour as the table" names a thing, which other changes do not."""
    if change.data == "become_like":
        return _likened(phrases, change)
    return changes.change(change)


# ---- moving or adding ---------------------------------------------------------------------------------------------


def put(phrases: Phrases, node: Node) -> list[Fields]:
    found = phrases.things(node)
    fresh = [n.article == "indef" or (n.article == "bare" and (n.number or n.plural)) for n in found]
    if all(fresh):
        return inserted(phrases, found, node, "PUT")
    if any(fresh):
        raise Refusal("say what to move and what to add in two clauses")
    return moved(phrases, found, node, "PUT")


def _is_cleared(noun: NounPhrase) -> bool:
    """Whether "clear" frees a noun instead of removing it: a place, furniture, a surface, or a part of a thing."""
    of_a_thing = any(p.kind == "part" for p in noun.modifiers) or any(r.name == "part_of" for r in noun.query.relations)
    name = noun.query.text
    kind = kinds.of(name)
    seat = kind is not None and nouns.is_chair(kind)
    freed = head(name) in nouns.EVERYWHERE | nouns.PLACES or nouns.is_surface(name) or nouns.is_furniture(name)
    return noun.query.last or of_a_thing or (freed and not (seat and noun.plural))


def _require_clear_end(found: Sequence[NounPhrase]) -> None:
    """Raise if the end of a list is ambiguous: "remove the cushions from the sofa and the armchair".

    Raises:
        Refusal: it is ambiguous.
    """
    for noun, following in pairwise(found):
        if any(p.kind == "off" for p in noun.modifiers) and not following.modifiers:
            raise Refusal(
                "say in two clauses what it is removed from and what else to remove", following.said, firm=True
            )


def _all_of(target: Query | None, out: Query, node: Node) -> Query | None:
    """`target` restricted to the excluded kind after a plain "all": "all but the largest box" is about boxes only."""
    everything = [t.text for found in node.find_data("core") for t in tokens(found, "EVERYTHING")]
    return all_of(target, out) if target is not None and everything == ["all"] else target


def _except(target: Query | None, out: Query) -> Query:
    if target is None or len(target.exclude) >= 4:
        raise Refusal("that cannot be excluded here")
    also = tuple(_except(a, out) for a in target.also)
    return target.model_copy(update={"exclude": (*target.exclude, out), "also": also})


_RULES = (
    merge, split, split_into, delete, clear, drop, take, keep, select, isolate, hide, crop, crop_away,
    crop_space, fade, fade_to, switch, paint, paint_like, give_color, change_from, tint, tint_more, give_shade, coat_on,
    adjust, change_opacity, make, it_becomes, put,
)  # fmt: skip

"""Rules for commands that add things: insertions, replacements, exchanges and copies.

The names of new things are not checked here; the asset registry does that.
"""

from __future__ import annotations

from dataclasses import replace

from ....gaussians.language.query.query import Query
from ....gaussians.world.finishes import said as finish_said
from ....gaussians.world.words import head, plural
from ..parsing import Node, Refusal, tokens, trees
from ..vocabulary import nouns, sizes
from ..vocabulary.materials import surfaced
from . import places
from .changes import Fields
from .described import NounPhrase, existing, union
from .phrases import Phrases
from .places import MOTIONS

# Nouns in the plural that are added as one thing.
_IN_PLURAL = ("scissors", "stairs", "headphones", "streamers", "streamer", "balloons", "balloon", "lights", "light",
              "garlands", "garland", "bunting")  # fmt: skip
_MATERIALS = ("wooden", "oak", "walnut", "brass", "copper", "bronze")
# What belongs to a room and stays when it gets another material.
_FIXED = frozenset({"floor", "wall", "ceiling", "ground", "flooring", "floorboards", "carpet", "worktop", "countertop"})
_SOME = 3  # number for "some cushions", as for "a few"


def insert(phrases: Phrases, node: Node) -> list[Fields]:
    return inserted(phrases, phrases.things(node), node, "ADD")


def make_new(phrases: Phrases, node: Node) -> list[Fields]:
    found = phrases.things(node)
    if not all(n.article == "indef" for n in found):
        raise Refusal("it does not say what it should become", found[-1].query.text.rsplit(" ", 1)[-1])
    return inserted(phrases, found, node, "ADD")


def inserted(phrases: Phrases, found: list[NounPhrase], node: Node, verb: str) -> list[Fields]:
    motion = places.read_motion(trees(node, *MOTIONS), phrases, found[0])
    if motion.direction or motion.toward or motion.distance:
        raise Refusal("say what it should stand next to, or on")
    found[-1], place = (found[-1], motion.place) if motion.place else places.split_destination(found[-1], "PUT")
    ops = []
    for noun in map(_unhung, found):
        noun, own = places.split_destination(_with_height(noun), "PUT")
        where = own or place
        count = _count(noun)
        ops.append({
            "op": "insert", **_asset(noun), **({"count": count} if count > 1 else {}),
            **({"height": places.length(noun.height)} if noun.height else {}),
            **({"place": where} if where else {}),
        })  # fmt: skip
    return ops


def more_like(phrases: Phrases, node: Node) -> list[Fields]:
    """Copies of the last thing mentioned: "add two more chairs like this one"."""
    found = phrases.things(node)
    motion = places.read_motion(trees(node, *MOTIONS), phrases)
    if len(found) != 1 or found[0].article not in ("indef", "bare") or found[0].modifiers:
        raise Refusal("say how many copies of it")
    count = _count(found[0])
    return [{"op": "duplicate", "target": Query(last=True), **_counted(count), **motion.fields()}]


def more_like_that(phrases: Phrases, node: Node) -> list[Fields]:
    """Copies of a described thing: "add two more chairs like the red one"."""
    found = phrases.things(node)
    if len(found) != 1 or found[0].article not in ("indef", "bare") or found[0].modifiers:
        raise Refusal("say how many copies of it")
    like = phrases.noun(trees(node, "np")[0])
    return [{"op": "duplicate", "target": existing([like]), **_counted(_count(found[0]))}]


def _count(noun: NounPhrase) -> int:
    if noun.number is not None:
        return places.whole(noun.number, str(noun.number))
    if not noun.plural or head(noun.query.text) in _IN_PLURAL:
        return 1
    if noun.article == "indef":
        return _SOME
    raise Refusal("say how many", noun.query.text)


def _asset(noun: NounPhrase) -> Fields:
    """The fields `asset`, `height` and `color` of a new thing."""
    query, modifiers = noun.query, noun.modifiers
    if head(query.text) in nouns.PLACES:
        raise Refusal("space is made by moving things; say what to move", query.text)
    contents = f" of {modifiers[0].anchors[0].said}" if len(modifiers) == 1 and modifiers[0].kind == "part" else ""
    if not noun.is_new or query.relations or query.not_colors or (modifiers and not contents.strip(" of")):
        raise Refusal("name a new thing by its kind, such as: a red floor lamp", query.text)
    made_of = [c for c in query.colors if c in _MATERIALS]
    if made_of and len(query.colors) == 1:
        query = query.model_copy(update={"colors": (), "text": f"{made_of[0]} {query.text}"})  # "a wooden stool"
    if len(query.colors) > 1:
        raise Refusal("a new thing has one colour", *query.colors)
    if any(a.endswith("er") for a in noun.adjectives):
        raise Refusal("say how tall it should be, or make the existing one bigger", *noun.adjectives)
    fields: Fields = {"asset": query.text + contents}
    if query.size and not noun.height and (height := sizes.usual_height(query.text, query.size)):
        fields["height"] = {"value": height, "unit": "m"}
    elif noun.adjectives:
        fields["asset"] = " ".join([*noun.adjectives, query.text + contents])
    return {**fields, **({"color": query.colors[0]} if query.colors else {})}


def replace_(phrases: Phrases, node: Node) -> list[Fields]:
    old, new = phrases.things(node, 0), phrases.things(node, 1)
    if tokens(node, "INTO") and len(new) == 1 and (color := _only_colored(old, new[0])):
        return [{"op": "recolor", "target": existing(old), "color": color}]  # "turn the red chair into a blue one"
    return _replaced(old, new)


def _only_colored(old: list[NounPhrase], new: NounPhrase) -> str:
    """The colour that a thing of the same kind differs in, "" if it differs in more."""
    query = new.query
    same = not new.said and new.is_new and all(n.query.text == query.text for n in old)
    bare = not (query.size or query.relations or new.modifiers or new.adjectives or new.height)
    return query.colors[0] if same and bare and len(query.colors) == 1 else ""


def substitute(phrases: Phrases, node: Node) -> list[Fields]:
    new = phrases.things(node, 0)
    return _replaced(phrases.things(node, 1), new)


def _replaced(old: list[NounPhrase], new: list[NounPhrase]) -> list[Fields]:
    if len(new) != 1 or (new[0].number or 1) > 1:
        raise Refusal("a thing is replaced by one new thing")
    if new[0].article not in ("indef", "bare"):
        raise Refusal("introduce a new thing with a, not the; to let things change places, say swap", new[0].query.text,
                      verdict="impossible")  # fmt: skip
    if (material := _material(new[0])) and all(head(noun.query.text) in _FIXED for noun in old):
        return [{**material, "target": union(old)}]  # "replace the floor with oak planks"
    return [{"op": "replace", "target": union(old), **_asset(new[0])}]


def _material(new: NounPhrase) -> Fields | None:
    """The fields of the material that a noun phrase names, None if it names a thing."""
    name = next((n for n in (new.query.text, plural(new.query.text)) if finish_said(n)), None)
    if name is None:
        return None
    colored = {"color": new.query.colors[0]} if new.query.colors and not finish_said(new.query.colors[0]) else {}
    return {**surfaced(name), **colored}


def swap(phrases: Phrases, node: Node) -> list[Fields]:
    """Exchange places ("swap the lamp and the vase") or replace ("swap the lamp for a vase")."""
    found = [n for i in range(len(trees(node, "targets"))) for n in phrases.things(node, i)]
    if len(trees(node, "targets")) == 2 and found[-1].is_new and not tokens(node, "PLACES"):
        return replace_(phrases, node)
    both = union(found)
    if len(found) != 2 and not (len(found) == 1 and (found[0].query.count == 2 or found[0].article == "pronoun")):
        raise Refusal("say which two things change places", tokens(node, "SWAP")[0].text)
    return [{"op": "exchange", "target": both}]


def swap_colors(phrases: Phrases, node: Node) -> list[Fields]:
    """ "swap the colours of the chair and the table": each takes the colour that the other has."""
    found = [n for i in range(len(trees(node, "targets"))) for n in phrases.things(node, i)]
    if len(found) != 2 or any(n.plural for n in found):
        raise Refusal("say which two things exchange colours", tokens(node, "SWAP")[0].text)
    one, other = (n.full() for n in found)
    return [{"op": "recolor", "target": one, "like": other}, {"op": "recolor", "target": other, "like": one}]


def duplicate(phrases: Phrases, node: Node) -> list[Fields]:
    found = phrases.things(node)
    motion = places.read_motion(trees(node, *MOTIONS), phrases)
    if motion.toward or (motion.distance and not motion.direction):
        raise Refusal("copies go left, right, forward, backward, or next to something")
    if not motion.aims:
        found[-1], motion.place = places.split_destination(found[-1], "COPY")
    return [{"op": "duplicate", "target": existing(found), **_counted(motion.times), **motion.fields()}]


def copies(phrases: Phrases, node: Node) -> list[Fields]:
    found = phrases.things(node)
    motion = places.read_motion(trees(node, *MOTIONS), phrases)
    placed = any(p.kind in ("related", "between", "centered", "in_spot") for n in found for p in n.modifiers)
    if placed and not motion.aims:
        word = found[-1].modifiers[0].word
        raise Refusal("it is not clear whether that is where the copy goes; copy it, then move it", word)
    number = tokens(node, "NUMBER")
    times = places.whole(number[0].value, number[0].text) if number else None
    return [{"op": "duplicate", "target": union(found), **_counted(times), **motion.fields()}]


def _unhung(noun: NounPhrase) -> NounPhrase:
    """A new thing without the words "from the ceiling", which are redundant for things that hang there.

    Raises:
        Refusal: things of this kind do not hang from the ceiling.
    """
    kept = tuple(p for p in noun.modifiers if not (p.anchors and head(p.anchors[0].query.text) == "ceiling"))
    if kept == noun.modifiers:
        return noun
    name = "pendant lamp" if noun.query.text in ("lamp", "light") else noun.query.text
    if not sizes.hangs(name):
        raise Refusal(f"a {name} does not hang from the ceiling", noun.query.text, verdict="impossible")
    return replace(noun, modifiers=kept, query=noun.query.model_copy(update={"text": name}))


def _with_height(noun: NounPhrase) -> NounPhrase:
    """A new thing with the height given behind its noun ("a lamp, 1.5 m tall") moved to `height`."""
    tall = [p for p in noun.modifiers if p.kind == "is_tall"]
    rest = tuple(p for p in noun.modifiers if p.kind != "is_tall")
    return replace(noun, height=tall[0].value, modifiers=rest) if tall else noun


def _counted(times: int | None) -> Fields:
    return {"count": times} if times and times > 1 else {}


RULES = (insert, make_new, more_like, more_like_that, replace_, substitute, swap, swap_colors, duplicate, copies)

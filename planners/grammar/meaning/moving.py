"""Rules for commands that move things. Directions, distances and destinations are parsed in places.py."""

from __future__ import annotations

from lark import Token, Tree

from ....gaussians.language.query.query import Query
from ..parsing import Node, Refusal, tokens, trees
from . import changes, places
from .changes import Fields
from .described import NounPhrase, existing
from .phrases import Phrases
from .places import MOTIONS


def it_moves(phrases: Phrases, node: Node) -> list[Fields]:
    motion = places.read_motion(trees(node), phrases)
    if not motion.aims:
        raise Refusal("say which way, or what to change")
    return [{"op": "move", "target": Query(last=True), **motion.fields()}]


def move(phrases: Phrases, node: Node) -> list[Fields]:
    return moved(phrases, phrases.things(node), node, "MOVE")


def centering(phrases: Phrases, node: Node) -> list[Fields]:
    found = phrases.things(node)
    if any(n.modifiers for n in found):
        raise Refusal("say put it there; centring is in the middle of the room", found[-1].modifiers[0].word)
    return [{"op": "move", "target": existing(found), "place": {"relation": "center"}}]


def moved(phrases: Phrases, found: list[NounPhrase], node: Node, verb: str) -> list[Fields]:
    """Move operations for the things `found`; `verb` decides which phrase is the destination (places.py).

    Raises:
        Refusal: no destination or direction is given.
    """
    first, second = _split_at_and(node)
    motion = places.read_motion(first, phrases, found[0])
    if not motion.aims and (each := _each_to_its_place(found, verb)):
        return each
    if not motion.aims:
        found[-1], motion.place = places.split_destination(found[-1], verb)
        if motion.place is None:
            raise Refusal("say where to: left, 30 cm up, onto the desk, next to the sofa")
        if motion.distance is not None:
            raise Refusal("a distance needs a direction")
    target = existing(found)
    if target.last and motion.place is not None:
        motion.place = _named_before(phrases, motion.place)
    ops = [{"op": "move", "target": target, **motion.fields()}]
    if second:
        more = places.read_motion(second, phrases, found[0])
        ops.append({"op": "move", "target": Query(last=True), **more.fields()})
    return ops


def _named_before(phrases: Phrases, place: Fields) -> Fields:
    """A place relative to "it" as one relative to the goal of the move before: "no, put it beside it"."""
    before = phrases.before[0].get("place") if len(phrases.before) == 1 else None
    anchors = before.get("anchors", ()) if isinstance(before, dict) else ()
    if len(anchors) != 1 or tuple(place.get("anchors", ())) != (Query(last=True),):
        return place
    return {**place, "anchors": tuple(anchors)}


def _each_to_its_place(found: list[NounPhrase], verb: str) -> list[Fields]:
    """Moves for things that each have a destination: "put the vase on the shelf and the lamp on the desk"."""
    parted = [places.split_destination(n, verb) for n in found]
    if len(found) < 2 or not all(place and not thing.modifiers for thing, place in parted):
        return []
    return [{"op": "move", "target": existing([thing]), "place": place} for thing, place in parted]


def raise_(phrases: Phrases, node: Node) -> list[Fields]:
    lengths, degree = tokens(node, "LENGTH"), changes.degree_of(node)
    distance = places.length(lengths[0].value) if lengths else None
    if degree:
        distance = places.LITTLE if degree == "little" else places.MUCH
    fields = {"direction": tokens(node, "RAISE")[0].value, **({"distance": distance} if distance else {})}
    return phrases.targeted(node, "move", **fields)


def _split_at_and(node: Node) -> tuple[list[Node], list[Node]]:
    """The motions before and behind "and" ("1 m to the right and 50 cm up")."""
    at = next((i for i, c in enumerate(node.children) if isinstance(c, Token) and c.type == "AND"), len(node.children))
    before, behind = Tree("motions", node.children[:at]), Tree("motions", node.children[at:])
    return trees(before, *MOTIONS), trees(behind, *MOTIONS)


RULES = (it_moves, move, centering, raise_)

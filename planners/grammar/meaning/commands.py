"""Parsed clauses as operations: one method for each rule of grammar.lark that is a command.

Knows the verbs that remove, show and colour, and hands the others on (moving.py, shaping.py, adding.py). Refuses to
know words and tokens (tagger.py), noun phrases (phrases.py), places (places.py) and amounts (changes.py). Every method
gives operations as fields, which the registry of tools validates.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

from ....gaussians.language.query.query import Query
from ..nodes import Node, Refusal, tokens, trees
from ..vocabulary import nouns
from . import changes
from .adding import Adding
from .changes import Fields
from .described import Noun, all_of, union
from .moving import Moving
from .rules import MOTIONS, known
from .shaping import Shaping


class Commands(Moving, Shaping, Adding):
    """Turns one clause's tree into operations. Keep one for an instruction: it remembers what "one" refers to."""

    def read(self, tree: Node) -> list[Fields]:
        """The operations of a clause.

        Raises:
            Refusal: it parses, but does not say enough or asks for what no operation does.
        """
        simple, *excluded = [c for c in tree.children if not hasattr(c, "type")]
        method: Callable[[Node], list[Fields]] = getattr(self, f"_{str(simple.data).rstrip('_')}")
        ops = method(simple)
        for group in excluded:
            out = union(self.phrases.group(group))
            ops = [{**op, "target": _except(_all_of(op.get("target"), out, simple), out)} for op in ops]
        self.before = ops
        return ops

    # ---- again ---------------------------------------------------------------------------------------------------

    def _same(self, node: Node) -> list[Fields]:
        """ "do the same to the lamp": the clause before with another target."""
        return self._again(self._query(node))

    def _bare(self, node: Node) -> list[Fields]:
        """ "and the green one too": a thing alone is the next target of what was asked before."""
        found = self._nouns(node)
        pointing = all(n.article in ("def", "all", "both") and not n.query.last for n in found)
        if not self.before or not pointing:
            raise Refusal("it does not say what to do", found[0].said or found[0].query.text)
        return self._again(known(found))

    def _again(self, target: Query) -> list[Fields]:
        first = next((op.get("target") for op in self.before), None)
        if first is None or any("held" in op for op in self.before):
            raise Refusal("it is not clear what is to be done with it")
        if any(op.get("target") not in (first, Query(last=True)) for op in self.before):
            raise Refusal("several things were done before; say what is to be done with it")
        chained = [op.get("target") != first for op in self.before]
        return [{**op, "target": Query(last=True) if c else target} for op, c in zip(self.before, chained, strict=True)]

    # ---- seeing and removing -------------------------------------------------------------------------------------

    def _delete(self, node: Node) -> list[Fields]:
        found = self._nouns(node)
        if any(p.word.startswith(("onto", "into")) for n in found for p in n.posts):
            return self._moved(found, node, "MOVE")  # "chuck the cushion onto the bed"
        _require_clear_end(found)
        return [{"op": "delete", "target": known(found)}]

    def _clear(self, node: Node) -> list[Fields]:
        """ "clear the plants" removes them; "clear the table" and "clear the corner" say nothing of what is there."""
        found = self._nouns(node)
        if (place := next((n for n in found if _is_cleared(n)), None)) is not None:
            there = nouns.head(place.query.text) in nouns.PLACES
            raise Refusal(f"say {'what is to go from there' if there else 'whether to remove it or everything on it'}",
                          "clear")  # fmt: skip
        _require_clear_end(found)
        return [{"op": "delete", "target": union(found)}]

    def _drop(self, node: Node) -> list[Fields]:
        found = self._nouns(node)
        if trees(node, *MOTIONS) or any(n.posts or n.article == "all" for n in found):
            raise Refusal("say put or delete", "drop")
        return self._targeted(node, "delete")

    def _take(self, node: Node) -> list[Fields]:
        found = self._nouns(node)
        if not trees(node, *MOTIONS):
            return [{"op": "select", "target": known(found), "held": "taken"}]
        return self._moved(found, node, "MOVE")

    def _keep(self, node: Node) -> list[Fields]:
        """ "keep the sofa and delete the rest": what is kept is what the next step leaves out."""
        return self._targeted(node, "select", held="kept")

    def _select(self, node: Node) -> list[Fields]:
        said = tokens(node, "SELECT")[0].text
        if said == "show" and self._query(node) == Query(pick="all"):
            raise Refusal("what was hidden comes back with undo", said, verdict="impossible")
        return self._targeted(node, "select")

    def _isolate(self, node: Node) -> list[Fields]:
        return self._targeted(node, "isolate")

    def _hide(self, node: Node) -> list[Fields]:
        return self._targeted(node, "opacity", value=0.0)

    def _fade(self, node: Node) -> list[Fields]:
        share = changes.share_of(node)
        if share is None:
            return self._targeted(node, **changes.opacity(changes.CLEARER[changes.degree_of(node)]))
        return self._targeted(node, **changes.opacity(share if tokens(node, "TO") else 1 - share))

    def _switch(self, node: Node) -> list[Fields]:
        raise Refusal("moving parts and switches cannot be operated", "turn " + tokens(node, "SWITCH")[0].text,
                      verdict="impossible")  # fmt: skip

    # ---- colour --------------------------------------------------------------------------------------------------

    def _paint(self, node: Node) -> list[Fields]:
        return [op for coat in trees(node, "coat") for op in self._give_color(coat)]

    def _give_color(self, node: Node) -> list[Fields]:
        hue = trees(node, "hue")[-1]
        if any(t.text == "tint" for t in tokens(hue, "COLORWORD")):
            return self._tint(node)
        return self._targeted(node, "recolor", color=changes.hue_of(hue))

    _change_color = _turn_color = _give_color

    def _change_from(self, node: Node) -> list[Fields]:
        found = self._nouns(node)
        was = tokens(node, "HUE")[0].value
        colored = [replace(n, query=n.query.model_copy(update={"colors": (*n.query.colors, was)})) for n in found]
        return [{"op": "recolor", "target": union(colored), "color": changes.hue_of(trees(node, "hue")[-1])}]

    def _tint(self, node: Node) -> list[Fields]:
        return self._targeted(node, "recolor", adjust="toward", color=changes.hue_of(trees(node, "hue")[0]))

    def _tint_more(self, node: Node) -> list[Fields]:
        amount = changes.AMOUNT[changes.degree_of(node)]
        return self._targeted(node, "recolor", adjust="toward", color=tokens(node, "HUE")[0].value, amount=amount)

    def _give_shade(self, node: Node) -> list[Fields]:
        return self._targeted(node, **changes.adjusted(tokens(node, "LIGHT")[0].value, "", None))

    def _coat_on(self, node: Node) -> list[Fields]:
        """ "slap a coat of red paint on the cabinet"."""
        if tokens(node, "PREP")[0].value != "on":
            raise Refusal("paint goes on things", tokens(node, "PREP")[0].text)
        target = known([self.phrases.noun(trees(node, "np")[0])])
        return [{"op": "recolor", "target": target, "color": tokens(node, "HUE")[0].value}]

    def _adjust(self, node: Node) -> list[Fields]:
        kind = tokens(node, "ADJUST")[0].value[0]
        return self._targeted(node, **changes.adjusted(kind, changes.degree_of(node), changes.share_of(node)))

    def _change_opacity(self, node: Node) -> list[Fields]:
        share = changes.share_of(node) or 0.0
        solid = tokens(node, "OPACITYWORD")[0].value
        return self._targeted(node, **changes.opacity(share if solid else 1 - share))

    # ---- becoming ------------------------------------------------------------------------------------------------

    def _make(self, node: Node) -> list[Fields]:
        first, *others = trees(node)
        change, *more = others
        if change.data == "absolute_size" and self._nouns(node)[0].article == "indef":
            raise Refusal("say the one that is there, or add one of that height", *self._nouns(node)[0].said.split())
        ops = [{**changes.change(change), "target": known(self.phrases.targets(first))}]
        for also in more:
            inner = trees(also)
            same = inner[0].data != "targets"
            fields = changes.change(inner[-1])
            if same and "color" in fields and "color" in ops[-1]:
                raise Refusal("one colour at a time", fields["color"])
            target = Query(last=True) if same else known(self.phrases.targets(inner[0]))
            ops.append({**fields, "target": target})
        return ops

    def _it_becomes(self, node: Node) -> list[Fields]:
        return [{**changes.change(c), "target": Query(last=True)} for c in trees(node)]

    # ---- moving or adding ----------------------------------------------------------------------------------------

    def _put(self, node: Node) -> list[Fields]:
        found = self._nouns(node)
        fresh = [n.article == "indef" or (n.article == "bare" and (n.number or n.plural)) for n in found]
        if all(fresh):
            return self._inserted(found, node, "PUT")
        if any(fresh):
            raise Refusal("name what to move and what to add in two clauses")
        return self._moved(found, node, "PUT")


def _is_cleared(noun: Noun) -> bool:
    """Whether a noun is rather what is freed than what goes: a place, what carries or holds things, a part of it."""
    places = nouns.SURFACES | nouns.FURNITURE | nouns.EVERYWHERE | nouns.PLACES
    of_a_thing = any(p.kind == "part" for p in noun.posts) or any(r.name == "part_of" for r in noun.query.relations)
    return noun.query.last or of_a_thing or nouns.head(noun.query.text) in places


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

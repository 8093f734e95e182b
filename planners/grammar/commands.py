"""Parsed clauses as operations: one method for each rule of grammar.lark that is a command.

Knows the verbs. Refuses to know words and tokens (tagger.py), noun phrases (phrases.py), places (places.py) and
amounts (changes.py). Every method gives operations as fields, which the registry of tools validates.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from lark import Token, Tree

from ...gaussians.language.query import Query
from . import changes, nouns, places, sizes
from .phrases import Node, Noun, Phrases, Refusal, all_of, tokens, trees, union

Fields = dict[str, Any]
_MOTIONS = ("direction", "distance", "nudge", "toward", "to", "spot", "times")
_SIDES = {"left": "leftmost", "right": "rightmost", "forward": "farthest", "backward": "nearest", "up": "highest",
          "down": "lowest"}  # fmt: skip
_SOME = 3  # "some cushions", as "a few"


class Commands:
    """Turns one clause's tree into operations. Keep one for an instruction: it remembers what "one" refers to."""

    def __init__(self, antecedent: str = "", before: Sequence[Fields] = (), colors: tuple[str, ...] = ()) -> None:
        self.phrases = Phrases(antecedent, colors)
        self.before = list(before)  # operations of the clause before, for "do the same to the lamp"

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

    # ---- helpers -------------------------------------------------------------------------------------------------

    def _nouns(self, node: Node, index: int = 0) -> list[Noun]:
        """The nouns of a clause; a direction behind them ("the chair to the left") is a side of the last one."""
        found = self.phrases.targets(trees(node, "targets")[index])
        if (side := tokens(node, "DIR")) and str(node.data) in ("delete", "select", "isolate", "hide"):
            query = found[-1].query
            if query.pick not in ("one", "any"):
                raise Refusal("a side picks one thing; say which one", side[0].text)
            found[-1] = replace(found[-1], query=query.model_copy(update={"pick": _SIDES[side[0].value]}))
        return found

    def _query(self, node: Node, index: int = 0) -> Query:
        return _known(self._nouns(node, index))

    def _targeted(self, node: Node, op: str, **fields: Any) -> list[Fields]:
        return [{"op": op, "target": self._query(node), **fields}]

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
        return self._again(_known(found))

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
        return [{"op": "delete", "target": _known(found)}]

    def _clear(self, node: Node) -> list[Fields]:
        found = self._nouns(node)
        if any(nouns.head(n.query.text) in nouns.SURFACES for n in found):
            raise Refusal("say whether to remove it or everything on it", "clear")
        return [{"op": "delete", "target": union(found)}]

    def _drop(self, node: Node) -> list[Fields]:
        if trees(node, *_MOTIONS) or any(n.posts for n in self._nouns(node)):
            raise Refusal("say put or delete", "drop")
        return self._targeted(node, "delete")

    def _take(self, node: Node) -> list[Fields]:
        found = self._nouns(node)
        if not trees(node, *_MOTIONS):
            return [{"op": "select", "target": _known(found), "held": "taken"}]
        return self._moved(found, node, "MOVE")

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
        target = _known([self.phrases.noun(trees(node, "np")[0])])
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
        ops = [{**changes.change(change), "target": _known(self.phrases.targets(first))}]
        for also in more:
            inner = trees(also)
            same = inner[0].data != "targets"
            fields = changes.change(inner[-1])
            if same and "color" in fields and "color" in ops[-1]:
                raise Refusal("one colour at a time", fields["color"])
            target = Query(last=True) if same else _known(self.phrases.targets(inner[0]))
            ops.append({**fields, "target": target})
        return ops

    def _it_becomes(self, node: Node) -> list[Fields]:
        return [{**changes.change(c), "target": Query(last=True)} for c in trees(node)]

    # ---- moving --------------------------------------------------------------------------------------------------

    def _it_moves(self, node: Node) -> list[Fields]:
        motion = places.read(trees(node), self.phrases)
        if not motion.aims:
            raise Refusal("say which way, or what to change")
        return [{"op": "move", "target": Query(last=True), **motion.fields()}]

    def _move(self, node: Node) -> list[Fields]:
        return self._moved(self._nouns(node), node, "MOVE")

    def _centering(self, node: Node) -> list[Fields]:
        found = self._nouns(node)
        if any(n.posts for n in found):
            raise Refusal("say put it there; centring is in the middle of the room", found[-1].posts[0].word)
        return [{"op": "move", "target": _known(found), "place": {"relation": "center"}}]

    def _keep(self, node: Node) -> list[Fields]:
        """ "keep the sofa and delete the rest": what is kept is what the next step leaves out."""
        return self._targeted(node, "select", held="kept")

    def _moved(self, found: list[Noun], node: Node, verb: str) -> list[Fields]:
        first, second = _split_at_and(node)
        motion = places.read(first, self.phrases, found[0])
        if not motion.aims:
            found[-1], motion.place = places.destination(found[-1], verb)
            if motion.place is None:
                raise Refusal("say where to: left, 30 cm up, onto the desk, next to the sofa")
            if motion.distance is not None:
                raise Refusal("a distance needs a direction")
        ops = [{"op": "move", "target": _known(found), **motion.fields()}]
        if second:
            more = places.read(second, self.phrases, found[0])
            ops.append({"op": "move", "target": Query(last=True), **more.fields()})
        return ops

    def _raise(self, node: Node) -> list[Fields]:
        lengths, degree = tokens(node, "LENGTH"), changes.degree_of(node)
        distance = places.length(lengths[0].value) if lengths else None
        if degree:
            distance = places.LITTLE if degree == "little" else places.MUCH
        fields = {"direction": tokens(node, "RAISE")[0].value, **({"distance": distance} if distance else {})}
        return self._targeted(node, "move", **fields)

    def _put(self, node: Node) -> list[Fields]:
        found = self._nouns(node)
        fresh = [n.article == "indef" or (n.article == "bare" and (n.number or n.plural)) for n in found]
        if all(fresh):
            return self._inserted(found, node, "PUT")
        if any(fresh):
            raise Refusal("name what to move and what to add in two clauses")
        return self._moved(found, node, "PUT")

    # ---- turning -------------------------------------------------------------------------------------------------

    def _rotate(self, node: Node) -> list[Fields]:
        turns = trees(node, "turning")
        angle, clock, direction = (_only(turns, *kind) for kind in (("ANGLE", "NUMBER"), ("CLOCK",), ("DIR",)))
        if angle is None and (share := _only(turns, "FRACTION")) is not None:
            angle = 360 * share
        if any(tokens(t, "UPSIDE") for t in turns):
            if len(turns) > 1:
                raise Refusal("turning upside down is half a turn; leave the rest out")
            return self._targeted(node, "rotate", degrees=180.0, axis="forward")
        if direction is not None and direction not in ("left", "right"):
            raise Refusal("things turn to the left or right, clockwise or counterclockwise")
        if clock is not None and direction is not None:
            raise Refusal("say either clockwise or a side")
        around = any(tokens(t, "AROUND") for t in turns) or bool(tokens(node, "TURNROUND"))
        sign = clock or {"left": 1, "right": -1}.get(direction or "", 1)
        if angle is None and not around and clock is None and direction is None:
            raise Refusal("say by how many degrees, or to the left, or around")
        if _only(turns, "DEGREE") is not None and angle is None:
            angle = _slight(turns)
        # A quarter turn is what "turn it to the left" means without a number; "around" is half a turn.
        degrees = float(angle) if angle is not None else 180.0 if around else 90.0
        return self._targeted(node, "rotate", degrees=sign * degrees)

    def _flip(self, node: Node) -> list[Fields]:
        if tokens(node, "AROUND"):
            return self._targeted(node, "rotate", degrees=180.0)
        return self._targeted(node, "rotate", degrees=180.0, axis="forward")

    def _tilt(self, node: Node) -> list[Fields]:
        turns = trees(node, "turning")
        angle, clock, direction = (_only(turns, *kind) for kind in (("ANGLE",), ("CLOCK",), ("DIR",)))
        if angle is None or (clock is None) == (direction is None):
            raise Refusal("say by how many degrees and which way: tilt it 10 degrees to the left")
        # Clockwise as the viewer sees it is counter-clockwise from the tip of "forward", which points away.
        signs = {"left": ("forward", -1), "right": ("forward", 1), "forward": ("right", -1), "backward": ("right", 1)}
        axis, sign = ("forward", -clock) if clock is not None else signs.get(direction or "", ("", 0))
        if not sign:
            raise Refusal("things tilt left, right, forward or backward")
        return self._targeted(node, "rotate", degrees=sign * float(angle), axis=axis)

    # ---- sizing --------------------------------------------------------------------------------------------------

    def _factor(self, node: Node) -> tuple[float | None, float | None, bool, str]:
        """Share, times, whether "to" was said, and degree of a clause's `factor`."""
        for inner in trees(node, "factor", "degree_factor"):
            times = tokens(inner, "TIMES", "NUMBER")
            value = float(times[0].value) if times else None
            return changes.share_of(inner), value, bool(tokens(inner, "TO")), changes.degree_of(inner)
        return None, None, False, ""

    def _scale(self, node: Node) -> list[Fields]:
        share, times, to, degree = self._factor(node)
        way = [t.value for t in tokens(node, "DIR")]
        if way and way[0] in ("up", "down"):
            return self._sized(node, "all", way[0] == "up", (share, times, to, degree))
        if way or (share is None and times is None):
            raise Refusal("say by how much: by 1.5, to 50 %, up by 20 %")
        return self._targeted(node, **changes.scaled(times if times is not None else share or 0.0))

    def _sized(
        self, node: Node, axis: str, up: bool, factor: tuple[float | None, float | None, bool, str]
    ) -> list[Fields]:
        share, times, to, degree = factor
        if to and (share is not None or times is not None):
            return self._targeted(node, **changes.scaled(share if share is not None else times or 0.0, axis))
        return self._targeted(node, **changes.grown(axis, up, share, times, degree))

    def _grow(self, node: Node) -> list[Fields]:
        axis, up = tokens(node, "GROW")[0].value
        if axis == "prop" and trees(node, "factor"):
            axis = "all"
        if axis == "prop":
            raise Refusal("say what of it: its size, its height, its width", tokens(node, "GROW")[0].text)
        return self._sized(node, axis, up, self._factor(node))

    def _grow_prop(self, node: Node) -> list[Fields]:
        _, up = tokens(node, "GROW")[0].value
        return self._sized(node, tokens(node, "PROP")[0].value, up, self._factor(node))

    def _multiply(self, node: Node) -> list[Fields]:
        prop = tokens(node, "PROP")
        return self._targeted(
            node, **changes.scaled(tokens(node, "MULTIPLY")[0].value, prop[0].value if prop else "all")
        )

    # ---- new things ----------------------------------------------------------------------------------------------

    def _insert(self, node: Node) -> list[Fields]:
        return self._inserted(self._nouns(node), node, "ADD")

    def _make_new(self, node: Node) -> list[Fields]:
        found = self._nouns(node)
        if not all(n.article == "indef" for n in found):
            raise Refusal("it does not say what it should become", found[-1].query.text.rsplit(" ", 1)[-1])
        return self._inserted(found, node, "ADD")

    def _inserted(self, found: list[Noun], node: Node, verb: str) -> list[Fields]:
        motion = places.read(trees(node, *_MOTIONS), self.phrases, found[0])
        if motion.direction or motion.toward or motion.distance:
            raise Refusal("say what it should stand next to, or on")
        found[-1], place = (found[-1], motion.place) if motion.place else places.destination(found[-1], "PUT")
        ops = []
        for noun in found:
            noun, own = places.destination(_with_height(noun), "PUT")
            where = own or place
            count = self._count(noun)
            ops.append({
                "op": "insert", **self._asset(noun), **({"count": count} if count > 1 else {}),
                **({"height": places.length(noun.height)} if noun.height else {}),
                **({"place": where} if where else {}),
            })  # fmt: skip
        return ops

    def _more_like(self, node: Node) -> list[Fields]:
        """ "add two more chairs like this one": copies of what was spoken of."""
        found = self._nouns(node)
        motion = places.read(trees(node, *_MOTIONS), self.phrases)
        if len(found) != 1 or found[0].article not in ("indef", "bare") or found[0].posts:
            raise Refusal("say how many copies of it")
        count = self._count(found[0])
        return [{"op": "duplicate", "target": Query(last=True), **_counted(count), **motion.fields()}]

    def _more_like_that(self, node: Node) -> list[Fields]:
        """ "add two more chairs like the red one": copies of that one."""
        found = self._nouns(node)
        if len(found) != 1 or found[0].article not in ("indef", "bare") or found[0].posts:
            raise Refusal("say how many copies of it")
        like = self.phrases.noun(trees(node, "np")[0])
        return [{"op": "duplicate", "target": _known([like]), **_counted(self._count(found[0]))}]

    def _count(self, noun: Noun) -> int:
        if noun.number is not None:
            return places.whole(noun.number, str(noun.number))
        if not noun.plural or nouns.singular(noun.query.text) in ("scissors", "stairs", "headphones"):
            return 1
        if noun.article == "indef":
            return _SOME
        raise Refusal("say how many", noun.query.text)

    def _asset(self, noun: Noun) -> Fields:
        """Name and colour of a new thing."""
        query, posts = noun.query, noun.posts
        contents = f" of {posts[0].anchors[0].said}" if len(posts) == 1 and posts[0].kind == "part" else ""
        if not noun.is_new or query.relations or query.not_colors or (posts and not contents.strip(" of")):
            raise Refusal("a new thing is named by what it is: a red floor lamp", query.text)
        if len(query.colors) > 1:
            raise Refusal("a new thing has one colour", *query.colors)
        if any(a.endswith("er") for a in noun.adjectives):
            raise Refusal("say how tall, or make the one that is there bigger", *noun.adjectives)
        fields: Fields = {"asset": query.text + contents}
        if query.size and not noun.height and (height := sizes.usual_height(query.text, query.size)):
            fields["height"] = {"value": height, "unit": "m"}
        elif noun.adjectives:
            fields["asset"] = " ".join([*noun.adjectives, query.text + contents])
        return {**fields, **({"color": query.colors[0]} if query.colors else {})}

    def _replace(self, node: Node) -> list[Fields]:
        return self._replaced(self._nouns(node, 0), self._nouns(node, 1))

    def _substitute(self, node: Node) -> list[Fields]:
        new = self._nouns(node, 0)
        return self._replaced(self._nouns(node, 1), new)

    def _replaced(self, old: list[Noun], new: list[Noun]) -> list[Fields]:
        if len(new) != 1 or (new[0].number or 1) > 1:
            raise Refusal("a thing is replaced by one new thing")
        if new[0].article not in ("indef", "bare"):
            raise Refusal("things cannot change places; a new thing is called a, not the", new[0].query.text,
                          verdict="impossible")  # fmt: skip
        return [{"op": "replace", "target": union(old), **self._asset(new[0])}]

    def _swap(self, node: Node) -> list[Fields]:
        if len(trees(node, "targets")) < 2:
            said = tokens(node, "SWAP")[0].text
            raise Refusal("things cannot change places; say what to put there instead", said, verdict="impossible")
        return self._replace(node)

    def _duplicate(self, node: Node) -> list[Fields]:
        found = self._nouns(node)
        motion = places.read(trees(node, *_MOTIONS), self.phrases)
        if motion.toward or (motion.distance and not motion.direction):
            raise Refusal("copies go left, right, forward, backward, or next to something")
        if not motion.aims:
            found[-1], motion.place = places.destination(found[-1], "COPY")
        return [{"op": "duplicate", "target": _known(found), **_counted(motion.times), **motion.fields()}]

    def _copies(self, node: Node) -> list[Fields]:
        found = self._nouns(node)
        motion = places.read(trees(node, *_MOTIONS), self.phrases)
        if any(n.posts for n in found) and not motion.aims:
            said = found[-1].posts[0].word
            raise Refusal("it is not clear whether that is where the copy goes; copy it, then move it", said)
        number = tokens(node, "NUMBER")
        times = places.whole(number[0].value, number[0].text) if number else None
        return [{"op": "duplicate", "target": union(found), **_counted(times), **motion.fields()}]


def _known(found: Sequence[Noun]) -> Query:
    """The query for things that are there already; "some chairs" does not say which."""
    if any(n.article == "indef" and n.plural and n.number is None for n in found):
        raise Refusal("say which, or how many", "some")
    return union(found)


def _with_height(noun: Noun) -> Noun:
    """A new thing's height, said behind it ("a lamp, 1.5 m tall"), as if said before it."""
    said = [p for p in noun.posts if p.kind == "is_tall"]
    rest = tuple(p for p in noun.posts if p.kind != "is_tall")
    return replace(noun, height=said[0].value, posts=rest) if said else noun


def _split_at_and(node: Node) -> tuple[list[Node], list[Node]]:
    """The motions before and behind "and" ("1 m to the right and 50 cm up")."""
    at = next((i for i, c in enumerate(node.children) if isinstance(c, Token) and c.type == "AND"), len(node.children))
    before, behind = Tree("motions", node.children[:at]), Tree("motions", node.children[at:])
    return trees(before, *_MOTIONS), trees(behind, *_MOTIONS)


def _counted(times: int | None) -> Fields:
    return {"count": times} if times and times > 1 else {}


def _only(nodes: Sequence[Node], *types: str) -> Any:
    """The one value of these token types below the nodes, None if there is none."""
    found = [t for n in nodes for t in tokens(n, *types)]
    if len(found) > 1:
        raise Refusal("two of one kind in one clause", *(t.text for t in found))
    return found[0].value if found else None


def _slight(turns: Sequence[Node]) -> float:
    """Degrees of "turn it slightly to the left"."""
    if _only(turns, "DEGREE") != "little":
        raise Refusal("say by how many degrees", "much")
    return 15.0


def _all_of(target: Query | None, out: Query, node: Node) -> Query | None:
    """ "all but the largest box" speaks of boxes only."""
    said = [t.text for found in node.find_data("core") for t in tokens(found, "EVERYTHING")]
    return all_of(target, out) if target is not None and said == ["all"] else target


def _except(target: Query | None, out: Query) -> Query:
    if target is None or len(target.exclude) >= 4:
        raise Refusal("that cannot be left out here")
    also = tuple(_except(a, out) for a in target.also)
    return target.model_copy(update={"exclude": (*target.exclude, out), "also": also})

"""Commands that bring something new: insertions, replacements and copies.

Knows how a new thing is named and how many of it are meant. Refuses to know which assets there are: the registry does.
"""

from __future__ import annotations

from dataclasses import replace

from ....gaussians.language.query.query import Query
from ....gaussians.world.words import head
from ..parsing import Node, Refusal, tokens, trees
from ..vocabulary import nouns, sizes
from . import places
from .changes import Fields
from .described import Noun, known, union
from .phrases import Phrases
from .places import MOTIONS

# Named in the plural and added as one.
_IN_PLURAL = ("scissors", "stairs", "headphones", "streamers", "streamer", "balloons", "balloon", "lights", "light",
              "garlands", "garland", "bunting")  # fmt: skip
_SOME = 3  # "some cushions", as "a few"


def insert(said: Phrases, node: Node) -> list[Fields]:
    return inserted(said, said.things(node), node, "ADD")


def make_new(said: Phrases, node: Node) -> list[Fields]:
    found = said.things(node)
    if not all(n.article == "indef" for n in found):
        raise Refusal("it does not say what it should become", found[-1].query.text.rsplit(" ", 1)[-1])
    return inserted(said, found, node, "ADD")


def inserted(said: Phrases, found: list[Noun], node: Node, verb: str) -> list[Fields]:
    motion = places.read(trees(node, *MOTIONS), said, found[0])
    if motion.direction or motion.toward or motion.distance:
        raise Refusal("say what it should stand next to, or on")
    found[-1], place = (found[-1], motion.place) if motion.place else places.destination(found[-1], "PUT")
    ops = []
    for noun in map(_unhung, found):
        noun, own = places.destination(_with_height(noun), "PUT")
        where = own or place
        count = _count(noun)
        ops.append({
            "op": "insert", **_asset(noun), **({"count": count} if count > 1 else {}),
            **({"height": places.length(noun.height)} if noun.height else {}),
            **({"place": where} if where else {}),
        })  # fmt: skip
    return ops


def more_like(said: Phrases, node: Node) -> list[Fields]:
    """ "add two more chairs like this one": copies of what was spoken of."""
    found = said.things(node)
    motion = places.read(trees(node, *MOTIONS), said)
    if len(found) != 1 or found[0].article not in ("indef", "bare") or found[0].posts:
        raise Refusal("say how many copies of it")
    count = _count(found[0])
    return [{"op": "duplicate", "target": Query(last=True), **_counted(count), **motion.fields()}]


def more_like_that(said: Phrases, node: Node) -> list[Fields]:
    """ "add two more chairs like the red one": copies of that one."""
    found = said.things(node)
    if len(found) != 1 or found[0].article not in ("indef", "bare") or found[0].posts:
        raise Refusal("say how many copies of it")
    like = said.noun(trees(node, "np")[0])
    return [{"op": "duplicate", "target": known([like]), **_counted(_count(found[0]))}]


def _count(noun: Noun) -> int:
    if noun.number is not None:
        return places.whole(noun.number, str(noun.number))
    if not noun.plural or head(noun.query.text) in _IN_PLURAL:
        return 1
    if noun.article == "indef":
        return _SOME
    raise Refusal("say how many", noun.query.text)


def _asset(noun: Noun) -> Fields:
    """Name and colour of a new thing."""
    query, posts = noun.query, noun.posts
    if head(query.text) in nouns.PLACES:
        raise Refusal("room is made by moving what is there; say what", query.text)
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


def replace_(said: Phrases, node: Node) -> list[Fields]:
    return _replaced(said.things(node, 0), said.things(node, 1))


def substitute(said: Phrases, node: Node) -> list[Fields]:
    new = said.things(node, 0)
    return _replaced(said.things(node, 1), new)


def _replaced(old: list[Noun], new: list[Noun]) -> list[Fields]:
    if len(new) != 1 or (new[0].number or 1) > 1:
        raise Refusal("a thing is replaced by one new thing")
    if new[0].article not in ("indef", "bare"):
        raise Refusal("a new thing is called a, not the; to let things change places, say swap", new[0].query.text,
                      verdict="impossible")  # fmt: skip
    return [{"op": "replace", "target": union(old), **_asset(new[0])}]


def swap(said: Phrases, node: Node) -> list[Fields]:
    """ "swap the lamp and the vase" changes places, "swap the lamp for a vase" replaces."""
    found = [n for i in range(len(trees(node, "targets"))) for n in said.things(node, i)]
    if len(trees(node, "targets")) == 2 and found[-1].is_new and not tokens(node, "PLACES"):
        return replace_(said, node)
    both = union(found)
    if len(found) != 2 and not (len(found) == 1 and (found[0].query.count == 2 or found[0].article == "pronoun")):
        raise Refusal("say which two things change places", tokens(node, "SWAP")[0].text)
    return [{"op": "exchange", "target": both}]


def duplicate(said: Phrases, node: Node) -> list[Fields]:
    found = said.things(node)
    motion = places.read(trees(node, *MOTIONS), said)
    if motion.toward or (motion.distance and not motion.direction):
        raise Refusal("copies go left, right, forward, backward, or next to something")
    if not motion.aims:
        found[-1], motion.place = places.destination(found[-1], "COPY")
    return [{"op": "duplicate", "target": known(found), **_counted(motion.times), **motion.fields()}]


def copies(said: Phrases, node: Node) -> list[Fields]:
    found = said.things(node)
    motion = places.read(trees(node, *MOTIONS), said)
    if any(n.posts for n in found) and not motion.aims:
        word = found[-1].posts[0].word
        raise Refusal("it is not clear whether that is where the copy goes; copy it, then move it", word)
    number = tokens(node, "NUMBER")
    times = places.whole(number[0].value, number[0].text) if number else None
    return [{"op": "duplicate", "target": union(found), **_counted(times), **motion.fields()}]


def _unhung(noun: Noun) -> Noun:
    """A new thing "from the ceiling" without these words, which go without saying.

    Raises:
        Refusal: such things do not hang there.
    """
    kept = tuple(p for p in noun.posts if not (p.anchors and head(p.anchors[0].query.text) == "ceiling"))
    if kept == noun.posts:
        return noun
    name = "pendant lamp" if noun.query.text in ("lamp", "light") else noun.query.text
    if not sizes.hangs(name):
        raise Refusal(f"a {name} does not hang from the ceiling", noun.query.text, verdict="impossible")
    return replace(noun, posts=kept, query=noun.query.model_copy(update={"text": name}))


def _with_height(noun: Noun) -> Noun:
    """A new thing's height, said behind it ("a lamp, 1.5 m tall"), as if said before it."""
    said = [p for p in noun.posts if p.kind == "is_tall"]
    rest = tuple(p for p in noun.posts if p.kind != "is_tall")
    return replace(noun, height=said[0].value, posts=rest) if said else noun


def _counted(times: int | None) -> Fields:
    return {"count": times} if times and times > 1 else {}


RULES = (insert, make_new, more_like, more_like_that, replace_, substitute, swap, duplicate, copies)

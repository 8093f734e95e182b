"""Reads words as something that something does: a deed, with the things before and behind it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

from .....gaussians import late_re as re
from .....gaussians.language.query.query import Query
from .....gaussians.world import kinds
from ....grammar.tagging.words import bag
from .. import noun_phrase, relation_phrases
from ..noun_phrase import is_color_word
from .deeds import Deed, Kind, as_noun, said_in, verbs


@dataclass(frozen=True)
class Happening:
    """Something that something does.

    Attributes:
        deed: None where only a thing is named.
        subject: who does it, None if nobody is named.
        object: what it is done to or where; None if nothing is named.
        at: the preposition before the object, "" if there is none.
        nth: of several such happenings "first", "second", "third" or "last"; "" if not said.
        denied: whether it is said not to happen.
    """

    deed: Deed | None
    subject: Query | None = None
    object: Query | None = None
    at: str = ""
    nth: str = ""
    denied: bool = False


_BE = bag("is are was were be been being am get gets got")
_SILENT = _BE | bag(
    "from do does did will would can could shall has have had make makes made need needs needed take takes "
    "taken took use "
    "uses used require requires spend spends there which that who to of for in by with at then actually exactly "
    "immediately really already yet now even also too here itself again ever just total i we you and so please , own "
    "once long amount completely fully finally suddenly eventually still all both happen happens happened the a this "
    "its "
    "it's about when complete completes completed perform performs performed"
)
_ARTICLES = bag("the a this that its all both own")
_PRONOUNS = bag("it they them that this he she itself one two three four both all")
PARTICLES = bag("on off in out put")
_PASSIVE = re.compile(r"^(?:(?:does|do|did) .+ get|(?:is|are|was|were) .+|.+ (?:is|are|was|gets|got))$")
_STILL = bag("still already again now all")
_ACTING = bag("do does did will would has have had")
_AMBIGUOUS = bag("open opened closed shut")  # a state behind "is", else something that is done
_PREPOSITION = re.compile(
    r"^(?:right |just |directly |back |down |out )?(?P<at>at|on to|onto|on top of|on|in front of|into|inside|in|"
    r"against|"
    r"near|next to|beside|by|up to|all the way to|to|toward|towards|away from|from|off of|off|out of|of|over|"
    r"across|past|"
    r"underneath|under|behind|with|through|between|above|close to|along|around)(?= )"
)
# What a movement with a place is: "roll off the rug", "walk to the bed"; with another preposition it is not read.
_PATHS: dict[str, Kind] = {
    "to": "reach", "up to": "reach", "all the way to": "reach", "into": "reach", "against": "reach",
    "toward": "approach", "towards": "approach", "from": "leave", "off": "leave", "off of": "leave", "out of": "leave",
    "away from": "recede", "over": "cross", "across": "cross", "through": "cross", "along": "cross", "on": "cross",
    "past": "pass", "by": "pass", "onto": "enter", "on to": "enter",
}  # fmt: skip
_SIDES = {"under": "under", "underneath": "under", "behind": "behind", "in front of": "in_front_of", "inside": "inside"}
_BESIDE = bag("at in on near beside by against from") | {"next to", "in front of", "close to"}
TRANSITIVE = ("reach", "enter", "leave", "cross", "pass", "approach", "recede", "nearest", "farthest", "related")
_STATE = re.compile(
    r"^(?P<a>.+?) (?:(?:is|are|was|were|be|stay|stays|staying|stayed|remain|remains|lie|lies|lying|stand|stands|"
    r"sit|sits|"
    r"rest|rests|being|standing|sitting|resting) )?(?:still |already |now |all )*(?P<r>on top of|on|inside|in front of|"
    r"under|underneath|next to|beside|near|behind|above|over|against|by|in|close to|between|left of|right of|"
    r"to the left of|to the right of) (?P<b>(?:the|a|an|its|my|it) .+|it)$"
)
_STAYS = re.compile(r"\b(?:stay|stays|staying|stayed|remain|remains|remained|keep|keeps)\b")
_PARTICIPLE = re.compile(r"^(?:the |all )?(?P<v>\w+ing) (?P<x>\w+(?: \w+)?)$")
_FROM_TO = re.compile(r"^(?P<x>.*?) ?(?:gets?|to get|to go|goes)? ?from (?P<a>.+) (?:to|until|up to) (?P<b>.+)$")
_NOT = re.compile(r"\b(?:not|never|no longer|nothing)\b ?")
_ANY_MORE = re.compile(r" (?:any ?more|any longer)$")
_OPPOSITE: dict[Kind, Kind] = {
    "move": "still", "turn": "still", "still": "move", "is_open": "is_closed", "is_closed": "is_open",
}  # fmt: skip


def happenings(said: str) -> Iterator[Happening]:
    """Each way of reading words as a happening; every word must belong to it."""
    said = re.sub(r"(?: ,)* +", " ", f" {said} ").strip(" ,")
    said = re.sub(
        r"(?: (?:right )?(?:(?:in|up|over|around|out|down) )?(?:here|there)| (?:here )?in (?:the|this) room)$", "", said
    )
    if (found := _NOT.search(said)) is not None:
        yield from _denied(said, found)
        return
    yield from _with_deed(said)
    if (state := _STATE.match(_stripped(said, ends=False))) is not None:
        relation = relation_phrases.relation(tuple(state["r"].split())) or ""
        subject, other = _subject(state["a"]), thing(state["b"])
        if relation and subject and other is not None:
            stays = "stay" if _STAYS.search(said) else ""
            yield Happening(Deed("related", relation=relation, way=stays, verb=state["r"]), subject, other)
    yield from by_noun(_stripped(said))
    yield from _participle(_stripped(said))
    if (way := _FROM_TO.match(said)) is not None:
        goal, origin, subject = thing(way["b"]), thing(way["a"]), _subject(way["x"])
        if goal is not None and origin is not None and subject is not False:
            yield Happening(Deed("reach", verb="reach"), subject, goal)
    bare = _stripped(said)
    if not bare:
        yield Happening(None)
    elif (named := thing(bare)) is not None and (kinds.find(bare) or not verbs().intersection(bare.split())):
        yield Happening(None, named)


def _denied(said: str, found: re.Match[str]) -> Iterator[Happening]:
    """ "Does not move", "is not open"; "no longer moves" is that it stops."""
    anything = "anything " if found.group().startswith("nothing") else ""
    rest = f"{said[: found.start()]}{anything}{said[found.end() :]}".strip()
    less = _ANY_MORE.sub("", rest)
    for what in happenings(less):
        if what.deed is None or what.denied:
            continue
        if what.deed.phase:
            yield replace(what, denied=True)
        elif found.group().startswith("no longer") or less != rest:
            ended: Deed = replace(what.deed, phase="stop")
            yield replace(what, deed=Deed("leave", verb="leave") if what.deed.kind == "related" else ended)
        elif what.deed.kind in _OPPOSITE:
            yield replace(what, deed=Deed(_OPPOSITE[what.deed.kind], verb=what.deed.verb))
        else:
            yield replace(what, denied=True)


def _with_deed(said: str) -> Iterator[Happening]:
    seen = set[Happening]()
    for a, b, deed in said_in(said):
        for what in _around(deed, said[:a].strip(" ,"), said[b:].strip(" ,")):
            if what not in seen:
                seen.add(what)
                yield what


def _is_state(deed: Deed, before: str, after: str) -> bool:
    """Whether what may be a state or a particle is one: "is the door open", not "does the door open"."""
    words = before.split()
    is_so = bool(words) and (words[0] in _BE or words[-1] in _BE or words[-1] in _STILL)
    return is_so and _ACTING.isdisjoint(words) and not (deed.verb in PARTICLES and after)


def _around(deed: Deed, before: str, after: str) -> Iterator[Happening]:
    """A deed with the things before and behind it."""
    states = deed.kind in ("is_open", "is_closed", "still", "move")
    if states and deed.verb in _AMBIGUOUS | PARTICLES and not _is_state(deed, before, _ends(after)):
        return
    if deed.kind == "still" and deed.verb == "stopped" and not _is_state(deed, before, ""):
        return  # "it has stopped" is that it ended
    if deed.kind in ("open", "close") and deed.verb in ("open", "shut") and _is_state(deed, before, ""):
        return
    if deed.kind == "move" and deed.phase and not after and re.search(r"\b(?:in|at|by|until) the$", before):
        return  # "in the end"
    noun = as_noun(_stripped(before))
    if noun is not None and not after and deed.kind == "move" and deed.phase:
        yield Happening(replace(noun, phase=deed.phase))  # "when does the turn end"
        return
    subject = _subject(before)
    if subject is False:
        return
    away = re.match(r"^from (?P<a>.+?) (?:to|until|up to) (?P<b>.+)$", after)
    if away is not None and (goal := thing(away["b"])) is not None and thing(away["a"]) is not None:
        yield Happening(replace(deed, kind="reach") if deed.kind == "move" else deed, subject, goal, "to")
        return
    place = _PREPOSITION.match(after)
    rest = _ends(after[place.end() :].strip() if place is not None else after)
    at = place["at"] if place is not None and rest else ""
    if not rest and deed.kind == "reach" and _PASSIVE.match(before) is not None and not deed.verb.endswith("ing"):
        yield Happening(deed, thing("anything"), subject or None)  # "does the table get hit"
        return
    if not rest:
        yield Happening(deed, subject)
        return
    other = thing(rest)
    if other is None and subject is None and not at:
        yield from _two_behind(deed, rest)
    if other is not None:
        yield from _placed(deed, subject, other, at, before)


def _two_behind(deed: Deed, rest: str) -> Iterator[Happening]:
    """ "When reaches the robot the bed?": both things behind the verb."""
    for m in re.finditer(r" (?=(?:the|a|an|my|its) )", rest):
        first, second = thing(rest[: m.start()]), thing(rest[m.end() :])
        if first is not None and second is not None and deed.kind in TRANSITIVE:
            yield Happening(deed, first, second)


def _placed(deed: Deed, subject: Query | None, other: Query, at: str, before: str) -> Iterator[Happening]:
    """A deed with a place or a thing: what it means together with the preposition."""
    kind, words = deed.kind, before.split()
    if at == "by" and subject is not None and kind in TRANSITIVE and (set(words[:1]) | set(words[-1:])) & _BE:
        yield Happening(deed, other, subject)  # "is the vase hit by the fan"
    elif kind in TRANSITIVE or (kind == "land" and at in ("", "on", "onto", "in", "upon")):
        yield Happening(deed, subject, other, at)
    elif subject is None and at in ("", "by", "of"):
        yield Happening(deed, other)  # "when stops the fan", "the way travelled by the drawer"
    elif deed.way == "straight" and at:
        return  # it may reach it, but not straight
    elif kind == "move" and at in _PATHS and not deed.stops and not (deed.starts and at == "from"):
        yield Happening(replace(deed, kind=_PATHS[at]), subject, other, at)
    elif kind == "move" and not deed.phase and at in _SIDES:
        yield Happening(Deed("related", relation=_SIDES[at], verb=at), subject, other)
    elif kind == "fall" and at in ("on", "onto", "on to", "to", "into"):
        yield Happening(replace(deed, kind="land"), subject, other, at)
    elif (
        (kind == "fall" and at in ("from", "off", "off of", "out of"))
        or (
            kind in ("open", "close", "return", "is_open", "is_closed") and at in ("of", "from", "into", "to", "out of")
        )
        or (deed.phase and at in _BESIDE)
    ):
        yield Happening(deed, subject, other, at)


def by_noun(said: str) -> Iterator[Happening]:
    """A happening that a noun names: "the fall of the red book", "the blue drop", "its contact with the wall"."""
    if (deed := as_noun(said)) is not None:
        yield Happening(deed)
        return
    both = re.match(r"^(?P<d>.+) between (?P<x>.+) and (?P<y>.+)$", said)
    if both is not None and (deed := as_noun(both["d"])) is not None:
        first, second = thing(both["x"]), thing(both["y"])
        if first is not None and second is not None:
            yield Happening(deed, first, second)
    with_object = re.match(r"^(?P<w>.+) (?P<at>with|at|on|against|off|into|from|in|over|of) (?P<y>.+)$", said)
    if with_object is not None and (other := thing(with_object["y"])) is not None:
        for what in by_noun(with_object["w"]):
            if what.object is None and what.deed is not None and what.deed.kind in (*TRANSITIVE, "land"):
                yield replace(what, object=other, at=with_object["at"])
    of = re.match(r"^(?P<d>.+?) (?:of|by) (?P<x>.+)$", said)
    if of is not None and (deed := as_noun(of["d"])) is not None and (named := thing(of["x"])) is not None:
        yield Happening(deed, named)
    last = re.match(r"^(?P<x>.+?)(?: 's)? (?P<d>\w+)$", said)
    if last is not None and (deed := as_noun(last["d"])) is not None:
        colored = is_color_word(last["x"].split()[-1])
        named = thing(last["x"]) or (thing(f"{last['x']} thing") if colored else None)
        if named is not None:
            yield Happening(deed, named)


def _participle(said: str) -> Iterator[Happening]:
    """Things by what they do: "falling books"."""
    if (found := _PARTICIPLE.match(said)) is not None and (named := thing(found["x"])) is not None:
        for start, stop, deed in said_in(found["v"]):
            if (start, stop) == (0, len(found["v"])) and deed.kind not in TRANSITIVE and not deed.phase:
                yield Happening(deed, named)


def _subject(before: str) -> Query | Literal[False] | None:
    """The thing before a deed, None if there is none; False if the words are no thing."""
    plain = _stripped(before)
    if not plain:
        return None
    if (named := thing(plain)) is not None:
        return named
    words = plain.split()
    if words[-1] in _PRONOUNS and len(words) > 1 and (named := thing(" ".join(words[:-1]))) is not None:
        return named  # "how many things they move"
    return False


@lru_cache(maxsize=4096)
def thing(said: str) -> Query | None:
    """A noun phrase; "it" is what was spoken of."""
    said = said.strip(" ,")
    if not said:
        return None
    if said in _PRONOUNS:
        return Query(last=True)
    if is_color_word(said.removeprefix("the ")):
        said = f"{said} thing"  # "when does red land?"
    if said.split()[-1] in verbs() and kinds.find(said.removeprefix("the ")) is None:
        return None
    one = re.sub(r" one(s?)$", r" thing\1", said)
    one = re.sub(r"^any(?: of)?(?: the)? (?=\w+$)(?!thing$)", "the ", one)
    found = noun_phrase.thing(tuple(one.split()))
    if found is None and not said.startswith(("the ", "a ", "an ", "any ", "all ")):
        found = noun_phrase.thing(("the", *one.split()))
    return found


def _ends(said: str) -> str:
    """Words without those at their end that say nothing."""
    words = said.split()
    while words and words[-1] in _SILENT:
        words.pop()
    return " ".join(words)


def _stripped(said: str, ends: bool = True) -> str:
    """Words without those at either end that say nothing; articles stay with what follows them."""
    words = said.split()
    while words and words[0] in _SILENT and not (words[0] in _ARTICLES and len(words) > 1):
        words.pop(0)
    return _ends(" ".join(words)) if ends else " ".join(words)

"""Fills in what a sentence leaves out: the verb of later parts, the thing of a remark, the verb of a terse order."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .....gaussians import late_re as re
from .....gaussians.world.words import singular
from ...tagging.lookahead import Lookahead, color_at, match
from ...tagging.words import bag
from ...vocabulary import lexicon, quantities
from ..chunks import DOING, chunks, is_thing
from ..wishes.judgements import is_judged
from ..wishes.states import begins_state, states

_PRONOUNS = bag("it them they those these this that him her both")
_PRONOUN_PHRASES = (("this", "one"), ("that", "one"), ("these", "ones"), ("those", "ones"), ("all", "of", "them"),
                    ("both", "of", "them"), ("the", "thing"), ("them", "all"), ("the", "two"))  # fmt: skip
_TOPIC = re.compile(
    r"^(?:(?:and |so |now |ok |okay |hey |well )?(?:as for|as to|about|regarding|concerning|with|see|you see|you "
    r"know|you "
    r"know what|know|remember|notice|look at|do you see|can you see|you can see|there is|here is|that is|this is|"
    r"on to|next up|next|"
    r"take|consider|speaking of|when it comes to|in the case of|oh|ah|i see|what about|how about) )?(?P<thing>\S.*?)"
    r"(?: (?:over there|there|here|in there|over here))?$"
)
_NEW = ("a", "an", "another", "some", "more", "new")  # what begins so is no thing that was there before
_ARTICLES = bag("the a an my our your this that these those all both every each everything another some")
JOINTS = (",", "and", "then", "so", "but", ";", ":")
_MOST = 6  # joints that are tried


def substitute(thing: Sequence[str], clause: Sequence[str]) -> list[str] | None:
    """A clause whose first pronoun is replaced by a thing; None if it has none."""
    for i, word in enumerate(clause):
        for phrase in _PRONOUN_PHRASES:
            if tuple(clause[i : i + len(phrase)]) == phrase:
                return [*clause[:i], *thing, *clause[i + len(phrase) :]]
        if word in ("its", "their"):
            return [*clause[:i], *thing, "'s", *clause[i + 1 :]]
        if word in _PRONOUNS and not (word in ("that", "this", "these", "those") and _is_noun_ahead(clause, i + 1)):
            return [*clause[:i], *thing, *clause[i + 1 :]]
    return None


def _is_noun_ahead(clause: Sequence[str], i: int) -> bool:
    return Lookahead(clause).noun_at(i)


def topic_of(said: Sequence[str]) -> tuple[str, ...] | None:
    """The thing that a sentence only names, to say something of it in the next; None if it does more."""
    found = _TOPIC.match(" ".join(said))
    if not found:
        return None
    thing = tuple(found.group("thing").split())
    if not is_thing(thing) or is_judged(said):
        return None
    if thing[0] in _NEW or "more" in thing[:3]:
        return None
    if thing[-1] in (",", ":", "?"):
        thing = thing[:-1]
    return thing if is_thing(thing) and not Lookahead(thing).verb(0) else None


def about(thing: Sequence[str], clause: Sequence[str]) -> Iterator[list[str]]:
    """Readings of a clause as said of a thing named before: "the shelf: paint it", "the rug: delete", "sofa: blue"."""
    if {"one", "ones"} & set(clause) and (noun := _noun_of(thing)):
        named = [noun if w in ("one", "ones") and i and clause[i - 1] != "this" else w for i, w in enumerate(clause)]
        yield named
    if (filled := substitute(thing, clause)) is not None:
        yield filled
        return
    ahead = Lookahead(clause)
    start, _ = ahead.skip_polite(0)
    if (verb := ahead.verb(start)) is not None:
        sized = clause[-1] in ("size", "height", "width", "length")
        if clause[start + verb[1] : start + verb[1] + 1] and clause[start + verb[1]] in _ARTICLES and not sized:
            return  # it has an object of its own
        behind = list(clause[start + verb[1] :])
        if behind[:1] and behind[-1] in ("size", "height", "width", "length"):
            yield [*clause[: start + verb[1]], *behind, "of", *thing]
        yield [*clause[: start + verb[1]], *thing, *behind]
        return
    if begins_state(clause, 0) or ahead.preposition_at(0) or clause[0] in _OPENS_STATE:
        for command in states(" ".join(thing), clause):
            yield command.split()
    yield [*thing, *clause]


_OPENS_STATE = ("can", "could", "may", "should", "must", "all", "both", "each")


def _noun_of(thing: Sequence[str]) -> str:
    """The head noun of a phrase in the singular, "" if it has none."""
    head = next((c.head for c in chunks(tuple(thing)) if c.head >= 0), -1)
    return singular(thing[head]) if head >= 0 else ""


def topics(said: Sequence[str]) -> Iterator[list[str]]:
    """Readings of a sentence whose first part names a thing and whose second says what to do with it."""
    for i, word in enumerate(said):
        if word in (",", ":") and 0 < i < len(said) - 1 and (thing := topic_of(said[:i])) is not None:
            yield from about(thing, said[i + 1 :])


def gapped(said: Sequence[str]) -> Iterator[list[str]]:
    """Readings with the verb of the first part repeated in the later ones: "move A left and B right"."""
    ahead = Lookahead(said)
    start, _ = ahead.skip_polite(0)
    if (verb := ahead.verb(start)) is None or verb[0][0] == "ISOLATE":
        return
    spoken = list(said[start : start + verb[1]])
    joints = [i for i, w in enumerate(said) if w in (",", "and") and i > start and _opens_thing(said, i + 1)]
    chosen = [tuple(joints), *((j,) for j in reversed(joints))] if len(joints) > 1 else [tuple(joints)]
    for at in chosen[:_MOST]:
        if at:
            yield _with_verb(said, at, spoken)


def _opens_thing(said: Sequence[str], i: int) -> bool:
    while i < len(said) and said[i] in ("and", ",", "then", "also"):
        i += 1
    return i < len(said) and (Lookahead(said).object_follows(i))


def _with_verb(said: Sequence[str], at: Sequence[int], verb: Sequence[str]) -> list[str]:
    """The words with a full stop and the verb behind each joint."""
    found: list[str] = []
    skip = False
    for i, word in enumerate(said):
        if i in at:
            found += [".", *verb]
            skip = True
        elif skip and word in ("and", ",", "then", "also"):
            continue
        else:
            skip = False
            found.append(word)
    return found


def splits(said: Sequence[str]) -> Iterator[list[str]]:
    """Readings as two sentences, parted at a joint."""
    at = [i for i, w in enumerate(said) if w in JOINTS and 0 < i < len(said) - 1]
    for i in sorted(at, key=lambda i: said[i] not in (",", ";", ":"))[:_MOST]:
        first, second = list(said[:i]), list(said[i + 1 :])
        while second and second[0] in JOINTS:
            second = second[1:]
        while first and first[-1] in JOINTS:
            first = first[:-1]
        if first and second and not _only_hues(second):
            yield [*first, ".", *second]


def _only_hues(said: Sequence[str]) -> bool:
    """Whether words are colours and joints alone: "make it red, blue and green" asks for one colour too many."""
    i = 0
    while i < len(said):
        found = color_at(said, i)
        if found is None and said[i] not in JOINTS:
            return False
        i += found[1] if found else 1
    return True


_STATED = ("DIR", "LENGTH", "GROWN", "LIGHT", "PREP", "TO", "TOWARD", "SPOT", "AWAY", "UPSIDE", "TIMES", "DEGREE")
_VERBLESS = 10  # words
_LONGEST_LIST = 24


def terse(said: Sequence[str]) -> Iterator[str]:
    """Readings of an order without a verb: "rug out", "sofa blue", "lamp 20 cm to the left", "blue for the sofa"."""
    ahead = Lookahead(said)
    alone = said[0] in ("all", "both", "that", "this") and not ahead.noun_at(1)
    if (
        len(said) > _VERBLESS
        or not DOING.isdisjoint(said)
        or alone
        or said[0] in ("everything", "it", "they", "them")
        or ahead.verb(0) is not None
    ):
        return
    colored = color_at(said, 0)
    if colored and said[colored[1] : colored[1] + 1] in (["for"], ("for",)):
        yield f"paint {' '.join(said[colored[1] + 1 :])} {' '.join(said[: colored[1]])}"
    first = Lookahead(said).phrase(0)
    if first and first[0][0] in ("GROWN", "LIGHT") and len(said) > first[1]:
        yield f"make {' '.join(said[first[1] :])} {' '.join(said[: first[1]])}"
    for i in range(1, len(said)):
        if said[i - 1] not in ("one", "ones") and _states_at(said, i) and is_thing(tuple(said[:i])):
            yield from states(" ".join(said[:i]), said[i:])


def listed(said: Sequence[str]) -> str | None:
    """The parts of a list of orders as sentences: "vase on the shelf, lamp on the desk"; None for anything else."""
    if Lookahead(said).verb(0) is not None:
        return None
    parts: list[list[str]] = [[]]
    for word in said:
        if word in (",", "and", "then"):
            parts.append([])
        else:
            parts[-1].append(word)
    parts = [p for p in parts if p]
    if len(said) > _LONGEST_LIST or len(parts) < 2 or any(len(p) > _VERBLESS or not _is_order(p) for p in parts):
        return None
    noun = _noun_of([w for w in parts[0] if w not in ("one", "ones")])
    named = [[noun if noun and w == "one" and i else w for w in part] for i, part in enumerate(parts)]
    return " . ".join(" ".join(p) for p in named)


def _is_order(part: Sequence[str]) -> bool:
    """Whether words are a thing and what shall become of it."""
    return any(
        (part[i - 1] in ("one", "ones") or is_thing(tuple(part[:i])))
        and (_states_at(part, i) or Lookahead(part).preposition_at(i))
        for i in range(1, len(part))
    )


def _states_at(said: Sequence[str], i: int) -> bool:
    """Whether what begins at `i` says what to become of the thing before it."""
    if said[i] in ("out", "gone", "off", "away", "to", "onto", "into", "against", "in", "a", "another", "up", "down"):
        return True
    if color_at(said, i):
        return True
    amount = quantities.read(said[i:])
    if amount is not None and amount.kind not in ("NUMBER", "ORDINAL"):
        return True
    if said[i] in ("facing", "double", "twice", "at") or (said[i] in ("all", "both") and i + 1 < len(said)):
        return True
    found = match(lexicon.CLOSED_PHRASES, said, i)
    return (found is not None and found[0][0] in _STATED) or said[i][0].isdigit()

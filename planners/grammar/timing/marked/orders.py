"""The order in which an instruction names things: "the blue one first, then the green, and the red last"."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise, permutations
from typing import Any, Literal

from .....gaussians import late_re as re
from .....gaussians.language.query.query import Query
from .....gaussians.world.words import singular
from ...learned.marks import Span, held_by
from ...learned.seen import hues
from ...tagging.words import bag
from ...vocabulary.nouns import is_known, is_opened
from ..command import Command
from ..manner import Thing
from ..verbs import SENSES, has_form

_TELLS = re.compile(
    r"\b(?:notice[sd]?|saw|(?:i|you) (?:can |could )?see|sees|think|thought|said|says|know|watched|heard)\b"
)
_CONTRARY = re.compile(r"\b(?:instead of|rather than|not(?! until\b| till\b))\b")
_TOLD = re.compile(
    r"\b(?:order|sequence|succession|then|next|followed|one after the other|one by one|in turn|cascad\w+|stagger\w*)\b"
)
_JOINTS = re.compile(r"[,.;:!?=>→-]|\b(?:and|then|but|with|while|so|n)\b")
_BARE_JOINT = re.compile(r"^(?:[,.;:&/>→=-]|\b(?:and|then|next|or|nor|both|plus|lastly|finally)\b| )*$")
_COMES_NEXT = bag("follows comes goes next then last first second third opens")  # "middle follows"
_SOURCES = bag("off from")  # before what things fall from
_BEHIND = bag("and then one first last next before after comes goes falls drops at in to")
_RANKS_OF_PLACE = bag("top middle bottom upper lower upmost lowest topmost highest")  # among things of a kind
_ONE_BY_ONE = re.compile(r"\bone (?:after|behind|following) (?:the )?(?:other|another|next)\b|\bafter each other\b")
_SINGLE = ("one", "highest", "middle", "lowest")
_MOST = 5  # things in an order
_OTHERS = re.compile(
    r"^(?:(?:both|all|each) )?(?:of )?(?:the |its |my )?(?:outer |two )?(?:others?|rest|neighbou?rs|siblings|"
    r"colleagues|two)\b(?: (?:two|2|ones|others?|books))?$|^both$|^(?:all )?(?:of )?the three$"
)
_ALL = "both|all|only|just|the|of|each of|either of|that of|those of"
_SOONER = re.compile(
    rf"\b(?:before|ahead of|prior to|in front of|preced\w+|earlier than|sooner than|followed(?: up)? by|trailed by|"
    rf"pips?|beats?|overtakes?)(?: (?:{_ALL}))*$"
)
_LATER = re.compile(
    rf"(?<!\bone )\b(?:after|behind|following|follows?|later than|succeeds?|until|till|once|when)(?: (?:{_ALL}))*$"
)
_IT = r"(?:it|that|this|them|which|him|her|both)"
_BEFORE_IT, _AFTER_IT = re.compile(rf"\bbefore {_IT}\b"), re.compile(rf"\b(?:after|behind|following) {_IT}\b")
_NEXT = re.compile(r"\b(?:then|next|afterwards|thereafter|followed)\b")
_RELATION_ALONE = re.compile(
    r"^(?: |and|only|just|already|then|right|directly|straight|[,;:])*(?:before|after|behind|ahead of|following)"
    rf"(?: (?:{_ALL}))* *$"
)
PLACES = {  # in an order, by the words that tell them
    "1": 0, "1st": 0, "one": 0, "2": 1, "2nd": 1, "two": 1, "second": 1, "secondly": 1, "3": 2, "3rd": 2, "three": 2,
    "third": 2, "thirdly": 2,
}  # fmt: skip
_NUMBERED = bag("number no cue slot position place spot rank as")
_BY_INDEX = re.compile(r"\b(?:index|idx) (?P<at>\d)\b")
_ASKED = re.compile(r"^(?:\w+ ){0,2}?(?:why|can|could|might|may|would|should|will) not\b")  # "why not let blue lead?"
_FIRST = re.compile(
    r"\b(?:first|firstly|lead(?:s|ing|er)?|begins?|starts?(?: off)?|open(?:s|er|ing)|kicks? off|heads|heading|"
    r"to begin with|to start with|in front|fronts?|earliest|precedence|initial(?:ly)?|up front|"
    r"jumps? the queue|ahead)\b"
)
_LAST = re.compile(
    r"\b(?:last|lastly|final|finally|finale|finish\w*|ends?|ending|in the end|at the end|clos(?:es|e|er|ing)|"
    r"conclud\w+|rear|tail|trails?|winds? up|latest|hinner end)\b"
)
_MIDDLE = re.compile(r"\b(?:middle|in between|between|centre|center)\b")
Rank = int | Literal["last", "middle"]
_RANKS: tuple[tuple[Rank, re.Pattern[str]], ...] = ((0, _FIRST), ("last", _LAST), ("middle", _MIDDLE))


@dataclass(frozen=True)
class Order:
    """What goes first, in its order, and what goes last.

    Attributes:
        first: one thing or more.
        last: another one.
        alone: whether only what is named changes places; of others all that moves does.
    """

    first: tuple[Query, ...] = ()
    last: Query | None = None
    alone: bool = False

    @property
    def things(self) -> tuple[Query, ...]:
        """All that is named, in its order."""
        return self.first if self.last is None else (*self.first, self.last)

    def command(self, gap: float | None = None) -> Command:
        """What lets things begin to move in this order, so many seconds after each other if that is told."""
        more: dict[str, Any] = {} if gap is None else {"gap": gap}
        if self.first:
            more["first"] = self.first
        if self.last is not None:
            more["last"] = self.last
        pair = self.alone and all(query.text for query in self.first)
        first, *others = self.things
        target = first.model_copy(update={"also": tuple(others)}) if pair else Query(moving=True, pick="all")
        return ordered(target, "listed", **more)


def ordered(target: Query, order: str, **more: Any) -> Command:
    """The command that changes when several things begin to move; `more` tells which is first or last, or how far
    apart they begin."""
    return Command(({"op": "order", "target": target, "order": order, **more},))


@dataclass
class _Told:
    """What words say of an order: ranks of things, and pairs of which the first begins sooner."""

    ranks: dict[int, Rank] = field(default_factory=dict)
    sooner: list[tuple[int, int]] = field(default_factory=list)

    def allows(self, order: Sequence[int]) -> bool:
        """Whether an order of things agrees with all that is said."""
        place = {thing: at for at, thing in enumerate(order)}
        if any(place[one] > place[other] for one, other in self.sooner):
            return False
        return all(_has_rank(place[thing], rank, len(order)) for thing, rank in self.ranks.items())


def _has_rank(place: int, rank: Rank, count: int) -> bool:
    if rank == "middle":
        return 0 < place < count - 1
    return place == (count - 1 if rank == "last" else rank)


def told_order(words: Sequence[str], spans: Sequence[Span], thing: Thing) -> Order | None:
    """The order of things that an instruction tells; None if it tells none.

    Args:
        words: those of the instruction.
        spans: the marks in them.
        thing: reads a name.
    """
    named = list(_named(words, spans, thing))
    if not named:
        return None
    idle = {at for tag, a, b in spans if tag not in ("x", "y") for at in range(a, b)}
    gaps = [
        _ONE_BY_ONE.sub("in turn", " ".join(words[at] for at in range(a, b) if at not in idle)).strip()
        for a, b in _gaps([(start, stop) for _, start, stop in named], len(words))
    ]
    gaps[0] = _ASKED.sub("", gaps[0])
    if any(map(_CONTRARY.search, gaps)) or any(map(_TELLS.search, gaps)) or any(map(_is_past, gaps[1:])):
        return None
    queries = list(dict.fromkeys(query for query, _, _ in named))
    if len(queries) > _MOST:
        return None
    tokens = [queries.index(query) for query, _, _ in named]
    told = _Told()
    if not (_rank(gaps, tokens, told) and _relate(gaps, tokens, told)):
        return None
    return _solved(queries, tokens, told, gaps)


def _solved(queries: list[Query | None], tokens: list[int], told: _Told, gaps: list[str]) -> Order | None:
    """The order that agrees with what is told: where several do, the one that is nearest to how things are named."""
    rest = queries.index(None) if None in queries else None
    single = [at for at in range(len(queries)) if at != rest]
    if len(single) == 1:
        return _of_one(single[0], rest, told, queries)
    if rest is not None:
        return None
    things = [query for query in queries if query is not None]
    if len(things) > 2 and (alone := _apart(told, len(things))) is not None:
        one, first = alone
        others = [query for query in things if query != things[one]]
        return Order(first=(things[one], *others)) if first else Order(last=things[one])
    if len(things) == 2:
        return _of_two(things, told, gaps)
    if not (told.ranks or told.sooner or _is_list(gaps) or any(map(_TOLD.search, gaps))):
        return None
    fits = next(filter(told.allows, permutations(range(len(things)))), None)
    return None if fits is None else Order(first=tuple(things[at] for at in fits))


def _of_one(one: int, others: int | None, told: _Told, queries: list[Query | None]) -> Order | None:
    """The order in which one thing is before or behind all others."""
    query = queries[one]
    ranks = {told.ranks.get(one)}
    if others is not None:
        ranks = {0 for pair in told.sooner if pair == (one, others)} | {
            "last" for pair in told.sooner if pair == (others, one)
        } or ranks
    if query is None or query.pick not in _SINGLE or len(ranks) != 1:
        return None
    rank = ranks.pop()
    return Order(first=(query,)) if rank == 0 else Order(last=query) if rank == "last" else None


def _apart(told: _Told, count: int) -> tuple[int, bool] | None:
    """The one thing that all others begin before, or after, if nothing else is told; and whether it is first."""
    for one in range(count):
        for first in (True, False):
            pairs = {(one, other) if first else (other, one) for other in range(count) if other != one}
            if set(told.sooner) == pairs and set(told.ranks) <= {one} and told.ranks.get(one, None) in (
                None, 0 if first else "last"
            ):  # fmt: skip
                return one, first
    return None


def _of_two(things: list[Query], told: _Told, gaps: list[str]) -> Order | None:
    """The order of two things, which change places, or have a place each among all."""
    if "middle" in told.ranks.values():
        return None
    if len(told.ranks) == 2:
        by_rank = {rank: things[at] for at, rank in told.ranks.items()}
        if set(by_rank) == {0, "last"}:
            return Order(first=(by_rank[0],), last=by_rank["last"])
        return Order(first=(by_rank[0], by_rank[1])) if set(by_rank) == {0, 1} else None
    if not (told.ranks or told.sooner):
        return None
    fits = [order for order in permutations(range(2)) if told.allows(order)]
    return Order(first=tuple(things[at] for at in fits[0]), alone=True) if len(fits) == 1 else None


def _is_list(gaps: Sequence[str]) -> bool:
    """Whether words only list things."""
    return all(map(_BARE_JOINT.match, gaps[1:-1]))


def _rank(gaps: Sequence[str], tokens: Sequence[int], told: _Told) -> bool:
    """Adds the ranks that words next to names tell; False if they contradict each other."""
    ahead = any(_of_rank(piece) is not None for piece in _pieces(gaps[0]))  # "1st the blue one, 2nd the red one"
    for at, gap in enumerate(gaps):
        behind, before = _pieces(gap)
        alone = not before and (behind in PLACES or _JOINTS.search(gap) is None)
        if at == 0 or (alone and ahead and at < len(tokens)):
            behind, before = "", before or behind
        elif at == len(tokens) and _of_rank(behind) is None:
            behind = before
        for piece, token in ((behind, at - 1), (before, at)):
            if not 0 <= token < len(tokens) or (rank := _of_rank(piece)) is None:
                continue
            if told.ranks.setdefault(tokens[token], rank) != rank:
                return False
    taken = [rank for rank in told.ranks.values() if rank != "middle"]
    return len(set(taken)) == len(taken)


def _pieces(gap: str) -> tuple[str, str]:
    """The parts of words between two names: what stands directly behind the first one, and what stands before the
    second, if a joint divides them; "" for each that is not there."""
    head, *rest = (piece.strip() for piece in _JOINTS.split(gap))
    return head, next((piece for piece in reversed(rest) if piece), "")


def _of_rank(piece: str) -> Rank | None:
    """The place in an order that words beside a name tell."""
    if (index := _BY_INDEX.search(piece)) is not None:
        return int(index["at"])
    words = piece.split()
    for at in (len(words) - 1, 0) if words else ():
        counts = words[at].isalpha() and not words[at].endswith(("nd", "d", "ly"))  # "number one", and not "the one"
        if words[at] in PLACES and not (counts and len(words) > 1 and words[at - 1] not in _NUMBERED):
            return PLACES[words[at]]
    if any(pattern.search(piece) for pattern in (_SOONER, _LATER, _BEFORE_IT, _AFTER_IT)):
        return None
    return next((rank for rank, pattern in _RANKS if pattern.search(piece)), None)


def _relate(gaps: Sequence[str], tokens: Sequence[int], told: _Told) -> bool:
    """Adds which thing begins before which, as words between names tell; False if they contradict each other."""
    subjects, heads = list[int](), [tokens[0]]  # whose place is told beside others; what is joined up to here
    sooner = True  # whether the subjects are
    waiting = list[int]()  # things that stand behind "after" or "before" at the beginning of a clause
    leads = _LATER.search(gaps[0]), _SOONER.search(gaps[0])
    if any(leads):
        waiting, sooner = [tokens[0]], leads[0] is None
    for at in range(1, len(tokens)):
        gap, one, other = gaps[at], tokens[at - 1], tokens[at]
        joined = _BARE_JOINT.match(gap) is not None and _NEXT.search(gap) is None
        if waiting:
            if joined and gap != ",":
                waiting.append(other)
                continue
            told.sooner += [(other, own) if sooner else (own, other) for own in waiting]
            waiting, subjects = [], [other]
            continue
        head, tail = _pieces(gap)
        if at > 1 and tokens[at - 2] != one and (_BEFORE_IT.search(head) or _AFTER_IT.search(head)):
            pair = (one, tokens[at - 2])  # "the red one last, the blue one just before it"
            told.sooner.append(pair if _BEFORE_IT.search(head) else pair[::-1])
        before = _SOONER.search(gap) is not None or _AFTER_IT.search(tail) is not None
        after = _LATER.search(gap) is not None or _BEFORE_IT.search(tail) is not None
        if before != after:
            if joint := subjects and at > 1 and not _JOINTS.search(gap) and _BARE_JOINT.match(gaps[at - 1]) is not None:
                told.sooner = told.sooner[: -len(subjects)]  # "red before green, and blue before ...": not before blue
            if joint or not subjects or not _RELATION_ALONE.match(gap):
                subjects = [one] if joint else heads
            sooner = before or told.ranks.get(subjects[0]) == 0  # "first the blue one, after the green": then the green
        elif not joined:
            subjects = []
            told.sooner += [(one, other)] if _NEXT.search(gap) else []
        told.sooner += [(own, other) if sooner else (other, own) for own in subjects]
        heads = [*heads, other] if joined and not subjects else [other]
    told.sooner = list(dict.fromkeys((one, other) for one, other in told.sooner if one != other))
    return not any((other, one) in told.sooner for one, other in told.sooner)


def _is_past(said: str) -> bool:
    """Whether words tell what something did: "fell"; and not what has been done: "after it has landed"."""
    words = said.split()
    return any(
        word != "followed"
        and has_form(word, tuple(SENSES), "past")
        and not has_form(word, tuple(SENSES), "plain", "s")
        and not {"has", "have", "had", "is", "are"} & set(words[max(0, at - 2) : at])
        for at, word in enumerate(words)
    )


def _named(words: Sequence[str], spans: Sequence[Span], thing: Thing) -> Iterator[tuple[Query | None, int, int]]:
    """What each mark of one thing names, and where; None for all others. A colour alone is one of the noun that is
    named, and each thing of a list in one mark stands for itself."""
    marks = [
        (start, stop) for tag, start, stop in spans if tag == "x" or (tag == "y" and words[start - 1] not in _SOURCES)
    ]
    held = held_by(spans)
    marks += [(at - 1, at + 1) for at in range(1, len(words)) if at not in held and _is_bare_color(words, at)]
    if noun := next((noun for noun in map(singular, words) if is_opened(noun)), ""):
        whole = [mark for mark in marks if not set(words[mark[0] : mark[1]]) <= _RANKS_OF_PLACE | {"the", "one"}]
        ranked = (at for at, word in enumerate(words) if word in _RANKS_OF_PLACE)
        inside = {at for start, stop in marks for at in range(start, stop)}
        places = (
            (at, at + 1) for at in ranked
            if at in inside or f"{noun}s" in words or (words[at + 1 : at + 2] or [""])[0] in _COMES_NEXT
        )  # fmt: skip
        marks = whole + [own for own in places if not any(start <= own[0] < stop for start, stop in whole)]
        words = [
            f"the {word} {noun}" if word in _RANKS_OF_PLACE and singular(then) != noun else word
            for word, then in pairwise([*words, ""])
        ]
    marks.sort()
    said = [" ".join(words[start:stop]).strip(" ,.") for start, stop in marks]
    found = [thing(name) for name in said]
    nouns = [query.text for query in found if query is not None and query.text not in ("", "one", "ones")]
    for (start, stop), name, query in zip(marks, said, found, strict=True):
        if _OTHERS.match(name):
            yield None, start, stop
            continue
        bare = [word for word in name.split() if word not in ("the", "one")]
        if query is not None and bare and not is_known(bare[-1]) and bare[0] in hues():
            bare = bare[:1]  # "the red concludes"
        if bare and set(bare) <= hues():
            hue = " ".join(bare)
            query = Query(text=nouns[0] if nouns else "", colors=(hue,), moving=None if nouns else True)
        if query is None or query.last or query.pick not in _SINGLE:
            continue
        for one in (query.model_copy(update={"also": ()}), *query.also):
            yield one, start, stop


def _is_bare_color(words: Sequence[str], at: int) -> bool:
    """Whether a word is a colour with "the", and without a noun: ", and lastly the red"."""
    behind = words[at + 1] if at + 1 < len(words) else "."
    return words[at] in hues() and words[at - 1] == "the" and (behind in _BEHIND or not behind[0].isalpha())


def _gaps(places: Sequence[tuple[int, int]], count: int) -> Iterator[tuple[int, int]]:
    """From where to where the words before, between and behind places stand."""
    ends = [0, *(stop for _, stop in places)]
    starts = [*(start for start, _ in places), count]
    yield from zip(ends, starts, strict=True)


def each_in_time(words: Sequence[str], spans: Sequence[Span], thing: Thing) -> list[tuple[list[str], list[Span]]]:
    """The parts of an instruction that gives each of several things its own time, "blue at 0.5 s, green at 1.2 s": the
    words that all have in common, with one thing and its time; none of others."""
    ordered = sorted(spans, key=lambda span: span[1])
    pairs = [
        (own, time) for own, time in pairwise(ordered)
        if own[0] == "x" and time[0] in ("from", "in") and _BY_NUMBER.search(" ".join(words[time[1] : time[2]]))
    ]  # fmt: skip
    times = [span for span in ordered if span[0] in ("from", "in", "to", "for")]
    if len(pairs) < 2 or len(times) != len(pairs) or not all(_is_named(words[a:b], thing) for (_, a, b), _ in pairs):
        return []
    parts = list[tuple[list[str], list[Span]]]()
    for pair in pairs:
        left_out = {at for own in pairs if own != pair for _, start, stop in own for at in range(start, stop)}
        place = {at: new for new, at in enumerate(at for at in range(len(words)) if at not in left_out)}
        kept = [span for span in ordered if span[1] not in left_out and (span[0] != "x" or span == pair[0])]
        own_words = [words[at] for at in place]
        parts.append((own_words, [(tag, place[start], place[stop - 1] + 1) for tag, start, stop in kept]))
    return parts


def _is_named(words: Sequence[str], thing: Thing) -> bool:
    """Whether words name something: also by its colour alone."""
    query = thing(" ".join(words))
    return (query is not None and not query.last) or {word for word in words if word not in ("the", "one")} <= hues()


_BY_NUMBER = re.compile(r"^(?:(?:at|from|on|by|t|=) )*(?:second )?(?:\d|one\b|two\b|three\b|four\b|half\b)")

"""The order in which an instruction names things: "the blue one first, then the green, and the red last"."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

from .....gaussians import late_re as re
from .....gaussians.language.query.query import Query
from .....gaussians.world.words import singular
from ...learned.marks import Span
from ...learned.seen import hues
from ...tagging.words import bag
from ...vocabulary.nouns import is_known, is_opened
from ..command import Command
from ..manner import Thing
from ..verbs import SENSES, has_form
from .slots import Slots

_FIRST = re.compile(r"\b(?:first|to begin with|to start with)\b")
_LAST = re.compile(r"\b(?:last|lastly|finally|at the end|in the end|to finish)\b")
_MIDDLE = re.compile(r"\b(?:middle|second|between)\b")
_LATER = re.compile(r"\b(?:after|following|behind)\b")
_SOONER = re.compile(r"\b(?:before|ahead of|prior to)\b")
_NEXT_TO_IT = re.compile(r"\b(?:before|after) (?:it|that|both|them|the others?)\b")
_TOLD = re.compile(
    r"\b(?:order|sequence|then|next|followed|one after the other|one by one|in turn|cascad\w+|stagger\w*)\b"
)
_TELLS = re.compile(r"\b(?:notice[sd]?|saw|see|sees|think|thought|said|says?|know|watched|heard)\b")
_CONTRARY = re.compile(r"\b(?:instead of|rather than|not)\b")
_JOINTS = re.compile(r"[,.;:]|\b(?:and|then|but|with)\b")
_BEHIND = bag("and then one first last next before after comes goes falls drops at in to")
_RANKS_OF_PLACE = bag("top middle bottom upper lower upmost lowest topmost highest")  # among things of a kind
_ONE_BY_ONE = re.compile(r"\bone (?:after|behind|following) (?:the )?(?:other|another|next)\b|\bafter each other\b")
_SINGLE = ("one", "highest", "middle", "lowest")
_MOST = 8  # things in an order


def listed(words: Sequence[str], spans: Sequence[Span], thing: Thing) -> tuple[Query, ...]:
    """The things of an order, what begins first first; none if the words tell no order of several things.

    Args:
        words: those of the instruction.
        spans: the marks in them.
        thing: reads a name.
    """
    named = list(_named(words, spans, thing))
    if not 1 < len(named) <= _MOST:
        return ()
    places = [(start, stop) for _, start, stop in named]
    gaps = [_ONE_BY_ONE.sub("in turn", " ".join(words[a:b])) for a, b in _gaps(places, len(words))]
    between = gaps[1:-1]
    if any(map(_CONTRARY.search, gaps)) or any(map(_TELLS.search, gaps)) or any(_is_past(gap) for gap in gaps):
        return ()
    if _NEXT_TO_IT.search(_ONE_BY_ONE.sub("in turn", " ".join(words))):
        return ()
    if any(pattern.search(gap) for gap in (gaps[0], gaps[-1]) for pattern in (_LATER, _SOONER)):
        return ()  # "the green one before both"
    ranks = [_rank(_JOINTS.split(gaps[at])[-1], _JOINTS.split(gaps[at + 1])[0]) for at in range(len(named))]
    queries = [query for query, _, _ in named]
    later = [at for at, gap in enumerate(between, 1) if _LATER.search(gap)]
    if later:  # "both fall after the blue one"
        return () if len(later) > 1 or any(ranks) else (*queries[later[0] :], *queries[: later[0]])
    if "middle" in ranks and not {"first", "last"} & set(ranks):
        return ()
    told = any(ranks) or any(_TOLD.search(gap) or _SOONER.search(gap) for gap in gaps)
    place = {None: 1, "middle": 1, "first": 0, "last": 2}
    order = sorted(range(len(named)), key=lambda at: (place[ranks[at]], at))
    return tuple(queries[at] for at in order) if told else ()


OTHERS = re.compile(
    r"^(?:(?:both|all|each) )?(?:of )?(?:the |its |my )?(?:others?|rest)\b(?: (?:two|ones|books))?|^both$"
)
_LEADS = re.compile(
    r"\b(?:first|lead(?:s|ing)?|ahead|open(?:s|ing)?|in front|fronts?|starts? (?:off|things|the show)|earliest|"
    r"before (?:\||the others?|both|all)|head)\b"
)
_ENDS = re.compile(
    r"\b(?:last|rear|finally|final(?:e|ly)?|finish\w*|ends?|ending|clos(?:es|e|ing)|tail|trails?|"
    r"conclud\w+|winds? up|latest|after (?:\||the others?|both|all))\b"
)
_PRECEDES = re.compile(r"\b(?:before|ahead of|earlier than|sooner than|prior to|in front of|preced\w+)\b")
_FOLLOWS = re.compile(r"\b(?:after|behind|later than|follow\w*|succeed\w*)\b")


def rank_of(rest: str) -> str | None:
    """Whether words around the one thing that is named say that it is "first" or "last"; None if neither, or both."""
    first, last = (pattern.search(rest) is not None for pattern in (_LEADS, _ENDS))
    return None if first == last else "first" if first else "last"


def as_named(slots: Slots) -> tuple[Query, ...]:
    """The order in which several things are named, if no words beside them tell another one; none of others.

    Args:
        slots: whose `rest` has a bar for each name.
    """
    marked = [
        (slots.thing(" ".join(slots.words[a:b]).strip(" ,.")), a) for tag, a, b in slots.spans if tag in ("x", "y")
    ]
    named = [query for query, _ in marked]
    if len(named) < 2 or len(set(named)) != len(named) or len(named) > _MOST:
        return ()
    if any(query is None or query.last or query.pick not in _SINGLE for query in named):
        return ()
    queries = tuple(query for query in named if query is not None)
    parts = slots.rest.split("|")
    if len(parts) != len(named) + 1 or any(map(_TELLS.search, parts)) or any(map(_is_past, parts[1:])):
        return ()
    if len(named) == 2:
        if _PRECEDES.search(parts[1]):
            return queries
        if _FOLLOWS.search(parts[1]):
            return queries[::-1]
        return queries if _LEADS.search(parts[1]) or _ENDS.search(parts[2]) else ()
    begun, over = " ".join(parts[:2]), " ".join(parts[-2:])
    if _ENDS.search(begun) or _LEADS.search(over) or any(map(_PRECEDES.search, parts[1:-1])):
        return ()
    return queries


def _is_past(said: str) -> bool:
    """Whether words tell what something did: "fell"; and not what has been done: "after it has landed"."""
    words = said.split()
    return any(
        has_form(word, tuple(SENSES), "past")
        and not has_form(word, tuple(SENSES), "plain", "s")
        and not {"has", "have", "had", "is", "are"} & set(words[max(0, at - 2) : at])
        for at, word in enumerate(words)
    )


def in_order(things: Sequence[Query], gap: float | None = None) -> Command:
    """The command that lets things begin to move in an order, so many seconds after each other if that is told."""
    both = things[0].model_copy(update={"also": (things[1],)})
    target = both if len(things) == 2 and all(query.text for query in things) else Query(moving=True, pick="all")
    return ordered(target, "listed", first=tuple(things), **({} if gap is None else {"gap": gap}))


def ordered(target: Query, order: str, **more: Any) -> Command:
    """The command that changes when several things begin to move; `more` tells which is first or last, or how far
    apart they begin."""
    return Command(({"op": "order", "target": target, "order": order, **more},))


def _named(words: Sequence[str], spans: Sequence[Span], thing: Thing) -> Iterator[tuple[Query, int, int]]:
    """What each mark of one thing names, once, and where; a colour alone is one of the noun that is named."""
    marks = [(start, stop) for tag, start, stop in spans if tag in ("x", "y")]
    held = {at for start, stop in marks for at in range(start, stop)}
    marks += [(at - 1, at + 1) for at in range(1, len(words)) if at not in held and _is_bare_color(words, at)]
    if noun := next((noun for noun in map(singular, words) if is_opened(noun)), ""):
        whole = [mark for mark in marks if not set(words[mark[0] : mark[1]]) <= _RANKS_OF_PLACE | {"the", "one"}]
        ranked = (at for at, word in enumerate(words) if word in _RANKS_OF_PLACE)
        places = ((at, at + 1) for at in ranked if at in held or f"{noun}s" in words)
        marks = whole + [own for own in places if not any(start <= own[0] < stop for start, stop in whole)]
        words = [
            f"the {word} {noun}" if word in _RANKS_OF_PLACE and singular(then) != noun else word
            for word, then in pairwise([*words, ""])
        ]
    marks.sort()
    found = [(thing(" ".join(words[start:stop])), start, stop) for start, stop in marks]
    nouns = [query.text for query, _, _ in found if query is not None and query.text not in ("", "one", "ones")]
    seen = list[Query]()
    for query, start, stop in found:
        bare = [word for word in " ".join(words[start:stop]).split() if word not in ("the", "one")]
        if query is not None and not is_known(bare[-1]) and bare[0] in hues():
            bare = bare[:1]  # "the red concludes"
        if bare and set(bare) <= hues():
            hue = " ".join(bare)
            query = Query(text=nouns[0] if nouns else "", colors=(hue,), moving=None if nouns else True)
        if query is None or query.last or query.pick not in _SINGLE or query in seen:
            continue
        seen.append(query)
        yield query, start, stop


def _is_bare_color(words: Sequence[str], at: int) -> bool:
    """Whether a word is a colour with "the", and without a noun: ", and lastly the red"."""
    behind = words[at + 1] if at + 1 < len(words) else "."
    return words[at] in hues() and words[at - 1] == "the" and (behind in _BEHIND or not behind[0].isalpha())


def _gaps(places: Sequence[tuple[int, int]], count: int) -> Iterator[tuple[int, int]]:
    """From where to where the words before, between and behind places stand."""
    ends = [0, *(stop for _, stop in places)]
    starts = [*(start for start, _ in places), count]
    yield from zip(ends, starts, strict=True)


def _rank(before: str, behind: str) -> str | None:
    """What the words next to a name say of its place in the order."""
    for rank, pattern in (("first", _FIRST), ("last", _LAST), ("middle", _MIDDLE)):
        if pattern.search(before) or pattern.search(behind):
            return rank
    return None


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

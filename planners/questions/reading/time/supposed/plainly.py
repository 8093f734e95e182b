"""Plain questions of a kind: the things, the time and the unit of a question that no frame reads, put into one.

    "hey um, trolley get rolling at what second?"  ──►  "when does the trolley start to move"

A question is put plainly only if none of its words tells more: a negation, a number, a comparison, a rank, a thing.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace
from functools import lru_cache

from ......gaussians import late_re as re
from ......gaussians.world import kinds as kinds_of_things
from ......gaussians.world.spelling import best_slip
from ......gaussians.world.words import is_plural, plural, singular
from .....grammar.learned.marks import Span, held_by
from .....grammar.tagging.spelling import is_word
from .....grammar.tagging.words import bag
from .guards import CERTAIN, says_more
from .kinds import marked_ways, vocabulary, words_of
from .likely import OF_A_LEG, asks_why, likeliest, without_leg, without_options
from .phrases import ALL_OF, deed_of, one_of
from .said import Said, said_of
from .times import UP_TO_THE_TURN, time_left, times_of, with_article
from .wordings import PLAIN

LEAST = 0.5  # probability of a kind that is tried
_LONGEST = 70  # words
_SHORTEST = 2


@lru_cache(maxsize=1024)
def supposed(text: str, names: frozenset[str], least: float = LEAST, strictly: bool = False) -> tuple[str, ...]:
    """Plain questions that a text most likely means, with its time; none if that is not likely enough.

    Args:
        names: words of the names of the things of the scene.
        least: the probability of its kind that is likely enough.
        strictly: none, unless it is certain, if a word beside its marks may tell more.
    """
    if not text.strip() or len(text.split()) > _LONGEST:
        return ()
    told = tuple(_spelled(word, names) for word in words_of(text))
    if sum(word.isalpha() for word in told) < _SHORTEST:
        return ()
    told, leg = without_leg(without_options(told))
    times = [[" ".join(told[a:b]) for tag, a, b in spans if tag == "t"] for spans in marked_ways(told)]
    if (before := _WHEN_BEFORE.match(" ".join(told))) is not None:
        times.append([before["time"]])  # "once the door reaches its widest, how many seconds of film are left"
    if (left := next(filter(None, (time_left(told, own) for own in times)), None)) is not None:
        return (left,)
    kind, chance = likeliest(told)
    if chance < least or kind not in PLAIN:
        return ()
    chance = 0.0 if strictly and chance < CERTAIN else chance
    for spans in marked_ways(told):
        if found := tuple(dict.fromkeys(_plainly(told, spans, leg, kind, chance, names, strictly))):
            return found
    return ()


def _plainly(
    told: tuple[str, ...],
    spans: Collection[Span],
    leg: str,
    kind: str,
    chance: float,
    names: frozenset[str],
    strictly: bool,
) -> Iterator[str]:
    """The words of a question of a kind, with these marks, as plain questions; none if they say more."""
    aside = held_by(spans, "off")
    if asks_why(kind, " ".join(told), " ".join(word for at, word in enumerate(told) if at not in aside)):
        return
    said = said_of(told, spans, names)
    if said is not None and said.asked and kind.startswith("what_") and not is_plural(said.x):
        said = replace(said, x=plural(said.x))
    if said is None or says_more(kind, chance, said, names, strictly):
        return
    if kind in _OF_EVENTS and any(_is_missing(word, names) for word in said.rest.split()):
        return  # "its events by time: stops, cat jumps"
    if not said.x and kind not in _OF_ALL:
        if any(_is_missing(word, names) for word in told):
            return  # "any window I could open"
        if kind in _OF_ONE and _PRONOUN.isdisjoint(said.rest.split()):
            return
        said = replace(said, x="it")
    if kind in _GROWS and _PERFECT.search(said.rest) and _AFTER_SO_LONG.match(said.time):
        said = replace(said, times=(_AFTER_SO_LONG.sub("by ", said.time),))
    if leg:
        if (said.time and not UP_TO_THE_TURN.match(said.time)) or kind not in OF_A_LEG:
            return
        said = replace(said, time=leg, times=(leg,))
    times = tuple(dict.fromkeys(times_of(kind, said.times))) if said.time and kind != "gap" else ("",)
    if kind.startswith("when_") and (every := ALL_OF.match(said.x)) is not None:
        said = replace(said, x=f"the last {one_of(said.x[every.end() :])}")  # of several things the last one
    if kind == "how_many" and "at the end" in times and deed_of(said.rest, "") in ("fall", "land"):
        times = ("",)  # how many have fallen by then
    for time in times:
        for plain in PLAIN[kind](said):
            timed = "{when}" in plain or plain.startswith("how long is it from")
            whole = plain.format(when=time) if timed else f"{plain} {time}"
            yield " ".join(whole.split()).replace(" ,", ",")


def _is_missing(word: str, names: Collection[str]) -> bool:
    """Whether a word names a thing that the scene has not."""
    return kinds_of_things.find(singular(word)) is not None and singular(word) not in names and word not in names


def question_of(kind: str, x: str, y: str, rest: str = "") -> str | None:
    """The plain question of a kind about things; None if it needs another one.

    Args:
        rest: words beside them by which it is put otherwise: "half".
    """
    return next(PLAIN[kind](Said(with_article(x), y and with_article(y), "", "", rest)), None)


_WHEN_BEFORE = re.compile(
    r"^(?P<time>(?:once|when|after|as soon as|from when) [^,]+?)(?: 's)? , how (?:many|much|long)\b"
)
_GROWS = bag("far far_turns far_opens turns often")
_PERFECT = re.compile(r"\b(?:has|have|had)\b")  # "how far has it gone after two seconds"
_AFTER_SO_LONG = re.compile(r"^after (?=\d[\d.]* ?s(?:ec(?:ond)?s?)?$)")
_OF_EVENTS = bag("does order happens")
_OF_ALL = bag(
    "what_moves what_still how_many first last order fastest happens film_long gap if_moves if_still if_together "
    "what_open what_shut what_on what_fell what_up"
)


_OF_ONE = ("near", "where_at")  # are asked of what stands still, too
_PRONOUN = bag("it he she they")


def _spelled(word: str, names: frozenset[str]) -> str:
    """A word, or the word that it is with a slip."""
    if len(word) < 5 or not word.isalpha() or word in names or singular(word) in names or is_word(word):
        return word
    return word if word in vocabulary() else best_slip(word, vocabulary()) or word

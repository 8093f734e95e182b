"""How much of what wishes say is read, where their kinds and marks are known: what the networks tell has no part in it.

Plans are made of the marks of labelled wishes (`training/timed_wishes.tsv`) that are about one of the six rooms, in
that room. Whether a plan is right is not told: written instructions are judged for that.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from ...planners.grammar.learned.marks import Span
from ...planners.grammar.planner import judge_of
from ...planners.grammar.tagging.words import bag
from ...planners.grammar.timing.judging import wording_of
from ...planners.grammar.timing.marked.kinds import NO_WISH
from ...planners.grammar.timing.marked.slots import asks_more
from ...training.timed_words import FILES
from ...training.wording import MARK, Sentence, sentences
from ..harness import Metric
from .asking import session

_SURE = 0.99  # probability of a kind that is known
_ROOMS = {  # words by which a wish is about a room
    "ball": bag("ball sofa rug tv"), "door": bag("door bench rack coat potted"),
    "drawer": bag("drawer drawers dresser wardrobe"), "fan": bag("fan vase blades"),
    "books": bag("book books volume red green blue"), "toy": bag("robot car bot bed shelf"),
}  # fmt: skip


def metrics(quick: bool) -> list[Metric]:
    """The share of wishes of which there is a plan, of all and of each kind.

    Args:
        quick: of every fortieth, instead of every fourth.
    """
    known = [own for own in sentences(FILES["wishes"]) if own.kind != NO_WISH][:: 40 if quick else 4]
    given, read = Counter[str](), Counter[str]()
    for sentence in known:
        words, spans = marked_words(sentence)
        if (room := _room(words)) is not None:
            given[sentence.kind] += 1
            read[sentence.kind] += _is_read(room, sentence.kind, words, spans)
    share = read.total() / max(given.total(), 1)
    found = [
        Metric("marks.read", share, "share", "higher", tolerance=0.02),
        Metric("marks.given", given.total(), "count"),
    ]
    return found + [
        Metric(f"marks.{kind}", read[kind] / given[kind], "share", "higher", tolerance=0.02) for kind in given
    ]


def _is_read(room: str, kind: str, words: list[str], spans: list[Span]) -> bool:
    if any(asks_more(words[start:stop], tag) for tag, start, stop in spans):
        return False
    return judge_of(session(room)).made_of(kind, _SURE, words, spans) is not None


def marked_words(sentence: Sentence) -> tuple[list[str], list[Span]]:
    """The words of a sentence as planners read them, and the marks in these."""
    words, spans = list[str](), list[Span]()
    for tag, said in _parts(sentence.marked):
        start = len(words)
        words += filter(None, wording_of(said))
        if tag and len(words) > start:
            spans.append((tag, start, len(words)))
    return words, spans


def _parts(marked: str) -> Iterator[tuple[str, str]]:
    """What is said in each mark and between them, with its tag; "" for none."""
    at = 0
    for mark in MARK.finditer(marked):
        yield "", marked[at : mark.start()]
        yield mark["tag"], mark["said"]
        at = mark.end()
    yield "", marked[at:]


def _room(words: list[str]) -> str | None:
    """The room of which most words are said; None if there are none."""
    said = {room: len(own.intersection(words)) for room, own in _ROOMS.items()}
    room = max(said, key=said.__getitem__)
    return room if said[room] else None

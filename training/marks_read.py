"""How much of what wishes say is read, where their kinds and marks are known: what the networks tell has no part in it.

    python -m scenewright.training.marks_read [--every 4]

Takes the labelled wishes of `timed_wishes.tsv` that are about one of the six moving rooms of the benchmark, makes
commands of their marks in that room, and tells the share of each kind of which there is a plan. Whether a plan is right
is not told; `scenewright bench motion --part instructions` measures that.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterator

from ..agent.session.session import Session
from ..benchmarks._motion import rooms
from ..planners.grammar.learned.marks import Span
from ..planners.grammar.planner import judge_of
from ..planners.grammar.tagging.words import bag
from ..planners.grammar.timing.marked.kinds import NO_WISH
from ..planners.grammar.timing.marked.names import with_nouns
from ..planners.grammar.timing.marked.slots import asks_more
from ..planners.grammar.timing.wording import LONG_WORDS, in_words, spelt_out, spelt_right
from .timed_words import FILES
from .wording import MARK, Sentence, sentences

_DETAIL = 0.3  # of the rooms: what is read does not depend on it
_SURE = 0.99  # probability of a kind that is known
_ROOMS = {  # words by which a wish is about a room
    "ball": bag("ball sofa rug tv"), "door": bag("door bench rack coat potted"),
    "drawer": bag("drawer drawers dresser wardrobe"), "fan": bag("fan vase blades"),
    "books": bag("book books volume red green blue"), "toy": bag("robot car bot bed shelf"),
}  # fmt: skip


def main() -> None:
    """Tell how much is read of every so many wishes."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--every", type=int, default=4, metavar="N")
    every = parser.parse_args().every
    known = [sentence for sentence in sentences(FILES["wishes"]) if sentence.kind != NO_WISH][::every]
    sessions = {room: Session(rooms.moving_room(room, _DETAIL)) for room in _ROOMS}
    given, read = Counter[str](), Counter[str]()
    for sentence in known:
        words, spans = marked_words(sentence)
        if (room := _room(words)) is not None:
            given[sentence.kind] += 1
            more = any(asks_more(words[start:stop], tag) for tag, start, stop in spans)
            made = None if more else judge_of(sessions[room]).made_of(sentence.kind, _SURE, words, spans)
            read[sentence.kind] += made is not None
    for kind, count in sorted(given.items()):
        print(f"{kind}: {read[kind]} of {count}")
    print(f"all: {read.total()} of {given.total()}, {read.total() / max(given.total(), 1):.2f}")


def marked_words(sentence: Sentence) -> tuple[list[str], list[Span]]:
    """The words of a sentence as planners read them, and the marks in these."""
    words, spans = list[str](), list[Span]()
    for tag, said in _parts(sentence.marked):
        start = len(words)
        words += [word for word in with_nouns(spelt_right(spelt_out(in_words(said)), LONG_WORDS)).split(" ") if word]
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


if __name__ == "__main__":
    main()

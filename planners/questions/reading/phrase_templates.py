"""Phrase templates: a small notation for the ways in which people ask one thing, and a matcher with backtracking.

    how far BE {a} from {b}              words, and holes that are read as noun phrases
    (how many|what number of) {x}        alternatives
    what is the distance [in {u:unit}]   an optional part; a hole with a reader of its own

`BE` stands for "is" or "are" and covers the three orders of words in which a clause is asked: "is the sofa red",
"whether the sofa is red" and "the sofa is red". Commas in a question are skipped wherever a template has none.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

Words = tuple[str, ...]
Slots = dict[str, Any]
HoleReader = Callable[[Words], Any]  # the value of a hole's words, None if they are nothing of its type

LONGEST_HOLE = 24  # words
_PIECE = re.compile(r"\s*([()\[\]|]|\{[a-z_]+(?::[a-z_]+)?\}|[^\s()\[\]|{}]+)")
_BE = "(is|are|was|were|be|would be|will be|stands|sits|lies|hangs)"
_HOLE = r"\{[a-z_]+(?::[a-z_]+)?\}"


@dataclass(frozen=True)
class _Word:
    text: str


@dataclass(frozen=True)
class _Hole:
    name: str
    type: str


@dataclass(frozen=True)
class _Choice:
    """One of several sequences; an optional part has an empty one."""

    ways: tuple[_Sequence, ...]


_Sequence = tuple["_Word | _Hole | _Choice", ...]


@dataclass(frozen=True)
class Template:
    """One way of asking.

    Attributes:
        source: as written, for messages.
        parts: the parsed notation.
    """

    source: str
    parts: _Sequence

    def match(self, words: Words, readers: Mapping[str, HoleReader]) -> Iterator[Slots]:
        """Every way in which the words fill the template; earlier holes take as few words as they can.

        Args:
            words: of the whole question.
            readers: the reader of each type of hole.
        """
        yield from _fill(self.parts, words, 0, {}, readers)


def templates(notation: str) -> tuple[Template, ...]:
    """The templates of a text, one a line; lines with `BE` become several.

    Raises:
        ValueError: brackets do not match.
    """
    lines = (line.strip() for line in notation.splitlines())
    return tuple(Template(spread, parsed(spread)) for line in lines if line for spread in _orders(line))


def parsed(notation: str) -> _Sequence:
    """A line of the notation as a tree.

    Raises:
        ValueError: brackets do not match.
    """
    pieces = _PIECE.findall(notation)
    sequence, end = _sequence(pieces, 0)
    if end != len(pieces):
        raise ValueError(f"unmatched bracket in template {notation!r}")
    return sequence


def _orders(line: str) -> list[str]:
    """A line with "BE {x}" in the orders in which that is said."""
    found = re.search(rf"\bBE ({_HOLE})", line)
    if found is None:
        return [line.replace("BE", _BE)]
    hole, before, behind = found[1], line[: found.start()].strip(), line[found.end() :].strip()
    asked, told = f"{before} {_BE} {hole} {behind}", f"{before} {hole} {_BE} {behind}"
    return [asked, f"[whether] {told}"] if not before else [asked, told]


def _sequence(pieces: Sequence[str], at: int) -> tuple[_Sequence, int]:
    parts: list[_Word | _Hole | _Choice] = []
    while at < len(pieces) and pieces[at] not in (")", "]", "|"):
        piece = pieces[at]
        if piece in ("(", "["):
            choice, at = _choice(pieces, at)
            parts.append(choice)
            continue
        if piece.startswith("{"):
            name, _, kind = piece[1:-1].partition(":")
            parts.append(_Hole(name, kind or "thing"))
        else:
            parts.append(_Word(piece))
        at += 1
    return tuple(parts), at


def _choice(pieces: Sequence[str], at: int) -> tuple[_Choice, int]:
    closing = {"(": ")", "[": "]"}[pieces[at]]
    ways: list[_Sequence] = [()] if closing == "]" else []
    while True:
        way, at = _sequence(pieces, at + 1)
        ways.append(way)
        if at >= len(pieces) or pieces[at] not in ("|", closing):
            raise ValueError(f"unmatched bracket in template {' '.join(pieces)!r}")
        if pieces[at] == closing:
            return _Choice(tuple(ways)), at + 1


def _fill(parts: _Sequence, words: Words, at: int, slots: Slots, readers: Mapping[str, HoleReader]) -> Iterator[Slots]:
    """Every way in which `words[at:]` fill the parts, to the last word."""
    if not parts:
        if all(w == "," for w in words[at:]):
            yield slots
        return
    first, rest = parts[0], parts[1:]
    while at < len(words) and words[at] == "," and not (isinstance(first, _Word) and first.text == ","):
        at += 1
    if isinstance(first, _Word):
        if at < len(words) and words[at] == first.text:
            yield from _fill(rest, words, at + 1, slots, readers)
    elif isinstance(first, _Choice):
        for way in first.ways:
            yield from _fill((*way, *rest), words, at, slots, readers)
    else:
        ends = range(at + 1, min(len(words), at + LONGEST_HOLE) + 1) if rest else (len(words),)
        for end in ends:
            if end <= at or (rest and isinstance(rest[0], _Word) and (end >= len(words) or words[end] != rest[0].text)):
                continue
            value = readers[first.type](words[at:end])
            if value is not None:
                yield from _fill(rest, words, end, {**slots, first.name: value}, readers)

"""Phrase templates: a small notation for the ways in which people ask one thing, and a matcher with backtracking.

    how far BE {a} from {b}              words, and holes that are read as noun phrases
    (how many|what number of) {x}        alternatives
    what is the distance [in {u:unit}]   an optional part; a hole with a reader of its own

`BE` stands for "is" or "are" and covers the three orders of words in which a clause is asked: "is the sofa red",
"whether the sofa is red" and "the sofa is red". Commas in a question are skipped wherever a template has none.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from ....gaussians import late_re as re
from .words import SPELT

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

    @cached_property
    def needs(self) -> tuple[frozenset[str], ...]:
        """Sets of words: a question that lacks all words of one of them cannot fill the template."""
        return _needs(self.parts)

    @cached_property
    def _start(self) -> _State:
        return _compiled(self.parts, _END)

    def may_match(self, words: frozenset[str]) -> bool:
        """Whether a question of these words has the words that the template cannot do without."""
        return not any(map(words.isdisjoint, self.needs))

    def match(self, words: Words, readers: Mapping[str, HoleReader]) -> Iterator[Slots]:
        """Every way in which the words fill the template; earlier holes take as few words as they can.

        Args:
            words: of the whole question.
            readers: the reader of each type of hole.
        """
        if self.may_match(frozenset(words)):
            yield from _fill(self._start, words, 0, {}, readers)


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
            parts.append(_Word(SPELT.get(piece, piece)))
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


@dataclass(frozen=True, eq=False)
class _State:
    """A part of a template with what follows it.

    Attributes:
        part: a word, a hole, or None at the end and where ways part.
        ways: the states that follow; several where ways part, none at the end.
        starts: the words with which the rest may begin; None if it may begin with a hole or be empty.
    """

    part: _Word | _Hole | None
    ways: tuple[_State, ...]
    starts: frozenset[str] | None


_END = _State(None, (), None)


def _compiled(parts: _Sequence, after: _State) -> _State:
    """The state at the beginning of some parts that `after` follows."""
    for part in reversed(parts):
        if isinstance(part, _Choice):
            ways = tuple(_compiled(way, after) for way in part.ways)
            known = [w.starts for w in ways]
            starts = None if None in known else frozenset().union(*(k for k in known if k is not None))
            after = _State(None, ways, starts)
        else:
            after = _State(part, (after,), frozenset({part.text}) if isinstance(part, _Word) else None)
    return after


def _needs(parts: _Sequence) -> tuple[frozenset[str], ...]:
    needs: list[frozenset[str]] = []
    for part in parts:
        if isinstance(part, _Word):
            needs.append(frozenset({part.text}))
        elif isinstance(part, _Choice):
            ways = [_needs(way) for way in part.ways]
            if all(ways):
                needs.append(frozenset().union(*(way[0] for way in ways)))
    return tuple(needs)


def _fill(state: _State, words: Words, at: int, slots: Slots, readers: Mapping[str, HoleReader]) -> Iterator[Slots]:
    """Every way in which `words[at:]` fill a state and what follows it, to the last word."""
    part = state.part
    if part is None and not state.ways:
        if all(w == "," for w in words[at:]):
            yield slots
        return
    if part is None:
        for way in state.ways:
            yield from _fill(way, words, at, slots, readers)
        return
    while at < len(words) and words[at] == "," and not (isinstance(part, _Word) and part.text == ","):
        at += 1
    (rest,) = state.ways
    if isinstance(part, _Word):
        if at < len(words) and words[at] == part.text:
            yield from _fill(rest, words, at + 1, slots, readers)
        return
    longest = min(len(words), at + LONGEST_HOLE)
    for end in range(at + 1, longest + 1) if rest is not _END else (len(words),):
        if rest.starts is not None and (end >= len(words) or words[end] not in rest.starts | {","}):
            continue
        value = readers[part.type](words[at:end])
        if value is not None:
            yield from _fill(rest, words, end, {**slots, part.name: value}, readers)

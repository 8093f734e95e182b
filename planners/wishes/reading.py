"""Words to goals: the clauses of an instruction, each a wish or something the grammar understands.

Knows politeness, where clauses may be parted, and how the parts of a pattern become a goal. Refuses to know any scene,
and to guess: an instruction of which any clause is not understood is not read at all.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache

from ...gaussians.language.query.query import Query
from ...gaussians.world.lengths import in_metres
from ...tools.operation import EditOp
from ..grammar import GrammarPlanner
from ..grammar.tagging.words import clean, split
from ..grammar.vocabulary import lexicon, nouns, quantities
from .goals import (
    Become,
    Clear,
    Declutter,
    Formation,
    Goal,
    Party,
    Plain,
    ReadingCorner,
    Relation,
    See,
    SetTable,
    Spread,
    Symmetric,
    Tidy,
    Walls,
    Where,
)
from .phrases import COMPILED

Parts = dict[str, str]

_JOINTS = frozenset({",", "and", "then", "&", "but", "also", "plus"})
_JOINED = 4  # what a joint inside a clause costs: more than any clause
_ONES = frozenset({"one", "ones", "other", "others"})
_EVERYTHING = frozenset({"everything", "furniture", "the furniture", "all furniture", "all the furniture", "all"})
_COUNTS = {"a": 1, "couple": 2, "both": 2, "us": 2}
_BEFORE = frozenset({"in front of", "before"})
_MARKS = frozenset(".;!:\n")
_POLITE = tuple(sorted((*lexicon.POLITE, *lexicon.FILLER), key=len, reverse=True))
_KEPT = frozenset({"i want", "i need"})  # openers that some wishes begin with


class Unread(Exception):
    """The words are no wish; `words` are those to blame."""

    def __init__(self, reason: str, *words: str) -> None:
        super().__init__(reason)
        self.words = words


@dataclass(frozen=True)
class Reading:
    """What an instruction comes to.

    Attributes:
        goals: in the order in which they were said.
        wished: whether one of them is a wish for the room, and not all were for the grammar.
    """

    goals: tuple[Goal, ...]
    wished: bool


class Reader:
    """Reads instructions; one serves all threads."""

    def __init__(self) -> None:
        self.grammar = GrammarPlanner()

    def read(self, text: str) -> Reading:
        """The goals of an instruction.

        Raises:
            Unread: a part of it is neither a wish nor understood by the grammar, or none is a wish.
            UserError: it is too long to be an instruction.
        """
        goals: list[Goal] = []
        wished = False
        for words in _sentences(text):
            found = self._clauses(words)
            if found is None:
                raise Unread("this is no wish for a room that is understood", *self._blamed(words))
            goals += [goal for goal, _ in found]
            wished |= any(mine and not _is_plain_enough(goal) for goal, mine in found)
        if not goals or not wished:
            raise Unread("this is no wish for a room", *(text.split()[:1]))
        return Reading(tuple(goals), wished)

    def may_wish(self, text: str) -> bool:
        """Whether any part of an instruction between joints has the form of a wish; False settles that it is none.

        Raises:
            UserError: it is too long to be an instruction.
        """
        for words in _sentences(text):
            joints = [i for i, word in enumerate(words) if word in _JOINTS]
            spans = ((a, b) for a in (0, *(i + 1 for i in joints)) for b in (*joints, len(words)) if a < b)
            if any(p.fullmatch(" ".join(_plain(words[a:b]))) for a, b in spans for _, p in COMPILED):
                return True
        return False

    def _clauses(self, words: tuple[str, ...]) -> list[tuple[Goal, bool]] | None:
        """A sentence as clauses, wishes rather than plain edits; None if that is not possible.

        Parted wherever both sides can be read, so that no clause is swallowed by a phrase of another ("make room for a
        piano and add one") and a wish beside an edit is read as what it is; otherwise as few clauses as possible.
        """

        @cache
        def rest(start: int) -> tuple[int, tuple[tuple[Goal, bool], ...]] | None:
            while start < len(words) and words[start] in _JOINTS:
                start += 1
            if start == len(words):
                return 0, ()
            best: tuple[int, tuple[tuple[Goal, bool], ...]] | None = None
            for end in range(len(words), start, -1):
                if end < len(words) and words[end] not in _JOINTS:
                    continue
                if (goal := self._clause(words[start:end])) is None or (after := rest(end)) is None:
                    continue
                mine = not isinstance(goal, Plain)
                cost = after[0] + (2 if mine else 3) + _JOINED * sum(w in _JOINTS for w in words[start:end])
                if best is None or cost < best[0]:
                    best = (cost, ((goal, mine), *after[1]))
            return best

        found = rest(0)
        return None if found is None else list(found[1])

    def _clause(self, words: tuple[str, ...]) -> Goal | None:
        """One clause as a goal, None if it is not understood."""
        said = " ".join(_plain(words))
        for kind, pattern in COMPILED:
            matched = pattern.fullmatch(said)
            goal = self._goal(kind, {k: v for k, v in matched.groupdict().items() if v}) if matched else None
            if goal is not None:
                return goal
        plan = self.grammar.plan(" ".join(words)) if said else None
        return Plain(plan.ops) if plan is not None and plan.ok and not _refers_back(words, plan.ops) else None

    def _goal(self, kind: str, parts: Parts) -> Goal | None:
        """The goal of a matched pattern; None if its noun phrases are none."""
        try:
            return _BUILDERS[kind](self, parts)
        except Unread:
            return None

    def things(self, parts: Parts) -> Query | None:
        """What is to be arranged; None for all furniture."""
        said = parts.get("things", "")
        return None if said in _EVERYTHING else self.noun(said, every=True)

    def noun(self, said: str, every: bool = False) -> Query:
        """A noun phrase as a query.

        Raises:
            Unread: it is none.
        """
        plan = self.grammar.plan(f"select {said}")
        if len(plan.ops) != 1 or (query := plan.ops[0].query()) is None or query.last:
            raise Unread(f"“{said}” is not understood", said)
        if not query.text and not query.colors:
            raise Unread(f"“{said}” is not understood", said)
        return query.model_copy(update={"pick": "all"}) if every and query.pick in ("one", "any") else query

    def where(self, parts: Parts) -> Where | None:
        """The place that was said, None if none was."""
        if "anchor" in parts:
            relation: Relation = "in_front_of" if parts["near"] in _BEFORE else "next_to"
            return Where(relation, self.noun(parts["anchor"]))
        return Where() if "middle" in parts else None

    def _blamed(self, words: Sequence[str]) -> tuple[str, ...]:
        """The words of a sentence that no way of saying a wish has, else all of it."""
        strange = [w for w in _plain(words) if w not in _vocabulary() and not nouns.is_known(w) and w not in _JOINTS]
        return tuple(strange) or (" ".join(words),)


def _sentences(text: str) -> Iterator[tuple[str, ...]]:
    """The words of each sentence; a colon parts a headline from what it means."""
    words: list[str] = []
    for word in (*(w.text for w in split(clean(text))), "."):
        if word in _MARKS or word == "?":
            if words:
                yield tuple(words)
            words = []
        else:
            words.append(word)


def _plain(words: Sequence[str]) -> list[str]:
    """The words of a clause without politeness before and filler in and behind it."""
    kept = [w for w in words if w not in (",", '"')]
    while found := next((p for p in _POLITE if tuple(kept[: len(p)]) == p and " ".join(p) not in _KEPT), None):
        kept = kept[len(found) :]
    while found := next((p for p in lexicon.FILLER if p and tuple(kept[-len(p) :]) == p and p[-1] != "room"), None):
        kept = kept[: -len(found)]
    return [w for w in kept if w not in ("please", "just", "simply")]


def _refers_back(words: Sequence[str], ops: Sequence[EditOp]) -> bool:
    """Whether a clause speaks of what another named: "it", "the red ones". Beside a wish, which moves many things,
    nobody can tell what that is."""
    nameless = any(query is not None and not query.text for query in (op.query() for op in ops))
    return '"last":true' in ops[0].model_dump_json() or (nameless and bool(_ONES & set(words)))


@cache
def _vocabulary() -> frozenset[str]:
    return frozenset(w for _, pattern in COMPILED for w in re.findall(r"[a-z]+", pattern.pattern))


def _people(said: str) -> int:
    """A number of people.

    Raises:
        Unread: it is none from 1 to 20.
    """
    read = quantities.read((said,))
    number = read.value if read is not None and read.kind == "NUMBER" else _COUNTS.get(said, 0)
    if number != int(number) or not 1 <= number <= 20:
        raise Unread(f"“{said}” is no number of people", said)
    return int(number)


def _width(said: str) -> float:
    """Metres of a length in words.

    Raises:
        Unread: it is none.
    """
    words = tuple(w.text for w in split(said))
    read = quantities.read(words)
    if read is None or read.kind != "LENGTH" or read.taken < len(words) or not in_metres(read.value, read.unit) >= 0.2:
        raise Unread(f"“{said}” is no width", said)
    return in_metres(read.value, read.unit)


def _clear(reader: Reader, parts: Parts) -> Goal:
    purpose = parts.get("why", "").split()
    if any(w in _JOINTS and len(purpose) - i > 3 for i, w in enumerate(purpose)):
        raise Unread("what it is for goes on too long", *purpose)  # into another clause: "for a piano, then add one"
    called = parts.get("why") or {"area": "free area", "spot": "free spot"}.get(parts.get("called", ""), "")
    called = called or ("dance floor" if "danc" in parts.get("called", "") else "free floor")
    width = _width(parts["size"]) if "size" in parts else None
    return Clear(reader.where(parts) or Where(), width, called[:60])


def _formation(shape: str) -> Callable[[Reader, Parts], Goal]:
    def build(reader: Reader, parts: Parts) -> Goal:
        about = reader.noun(parts["goal"]) if "goal" in parts else None
        rows = {"two": 2, "three": 3, "four": 4}.get(parts.get("rows", ""), 1)
        things = reader.things(parts)
        if things is None:
            raise Unread("say which things", parts.get("things", ""))
        return Formation(shape, things, about, reader.where(parts), rows)  # type: ignore[arg-type]

    return build


def _declutter(reader: Reader, parts: Parts) -> Goal:
    surface = reader.noun(parts["goal"])
    name = surface.text
    if not (nouns.is_surface(name) or nouns.is_container(name) or nouns.is_furniture(name)):
        raise Unread(f"nothing stands on {parts['goal']}", parts["goal"])
    return Declutter(surface)


def _walls(reader: Reader, parts: Parts) -> Goal:
    said = parts.get("things", "")
    return Walls(None if said in _EVERYTHING else reader.noun(said))


def _is_plain_enough(goal: Goal) -> bool:
    """Whether the grammar does as well: one thing to the wall is one move."""
    return isinstance(goal, Walls) and goal.things is not None and goal.things.pick == "one" and not goal.things.also


def _spread(reader: Reader, parts: Parts) -> Goal:
    if (things := reader.things(parts)) is None:
        raise Unread("say which things", parts["things"])
    return Spread(things)


def _watch(_reader: Reader, _parts: Parts) -> Goal:
    return See(None, Query(text="television"))


_BUILDERS: dict[str, Callable[[Reader, Parts], Goal]] = {
    "clear": _clear,
    "walls": _walls,
    "circle": _formation("circle"),
    "arc": _formation("arc"),
    "row": _formation("row"),
    "around": _formation("around"),
    "tidy": lambda _reader, _parts: Tidy(),
    "declutter": _declutter,
    "set_table": lambda reader, parts: SetTable(
        reader.noun(parts["goal"]), _people(parts["people"]) if "people" in parts else None
    ),
    "see": lambda reader, parts: See(reader.things(parts), reader.noun(parts["goal"])),
    "watch": _watch,
    "spread": _spread,
    "reading_corner": lambda reader, parts: ReadingCorner(reader.where(parts)),
    "symmetric": lambda _reader, _parts: Symmetric(),
    "become": lambda _reader, parts: Become(parts["kind"].strip()),
    "party": lambda _reader, _parts: Party(),
}

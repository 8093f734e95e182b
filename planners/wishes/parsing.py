"""Parses an instruction into goals: each clause is a wish or an edit that the grammar understands.

Skips polite phrases, splits the instruction into clauses and builds goals from the parts of matched patterns. If any
clause is not understood, the whole instruction is refused. No scene is needed.
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
    FloorRelation,
    Formation,
    Goal,
    Party,
    PlainEdit,
    ReadingCorner,
    See,
    SetTable,
    Spread,
    Symmetric,
    Tidy,
    Walls,
    Where,
)
from .patterns import COMPILED

Parts = dict[str, str]

_JOINTS = frozenset({",", "and", "then", "&", "but", "also", "plus"})
_JOINED = 4  # cost of a joint inside a clause: more than that of any clause
_ONES = frozenset({"one", "ones", "other", "others"})
_EVERYTHING = frozenset({"everything", "furniture", "the furniture", "all furniture", "all the furniture", "all"})
_COUNTS = {"a": 1, "couple": 2, "both": 2, "us": 2}
_BEFORE = frozenset({"in front of", "before"})
_MARKS = frozenset(".;!:\n")
_POLITE = tuple(sorted((*lexicon.POLITE, *lexicon.FILLER), key=len, reverse=True))
_KEPT = frozenset({"i want", "i need"})  # openers that some wishes begin with


class NotAWish(Exception):
    """The instruction is not a wish; `words` are the ones that caused this."""

    def __init__(self, reason: str, *words: str) -> None:
        super().__init__(reason)
        self.words = words


@dataclass(frozen=True)
class ParsedInstruction:
    """A parsed instruction.

    Attributes:
        goals: the goals in the order of their clauses.
        wished: whether at least one of them is a wish for the room that the grammar cannot plan as well.
    """

    goals: tuple[Goal, ...]
    wished: bool


class WishParser:
    """Parses instructions into goals; thread-safe."""

    def __init__(self) -> None:
        self.grammar = GrammarPlanner()

    def parse(self, text: str) -> ParsedInstruction:
        """The goals of an instruction.

        Raises:
            NotAWish: a clause is neither a wish nor understood by the grammar, or no clause is a wish.
            UserError: the instruction is too long.
        """
        goals: list[Goal] = []
        wished = False
        for words in _sentences(text):
            found = self._clauses(words)
            if found is None:
                raise NotAWish("this is not understood as a wish for a room", *self._blamed(words))
            goals += [goal for goal, _ in found]
            wished |= any(mine and not _is_plain_enough(goal) for goal, mine in found)
        if not goals or not wished:
            raise NotAWish("this is not a wish for a room", *(text.split()[:1]))
        return ParsedInstruction(tuple(goals), wished)

    def may_be_wish(self, text: str) -> bool:
        """Whether any part between joints matches a wish pattern; if not, the instruction is certainly not a wish.

        Raises:
            UserError: the instruction is too long.
        """
        for words in _sentences(text):
            joints = [i for i, word in enumerate(words) if word in _JOINTS]
            spans = ((a, b) for a in (0, *(i + 1 for i in joints)) for b in (*joints, len(words)) if a < b)
            if any(p.fullmatch(" ".join(_plain(words[a:b]))) for a, b in spans for _, p in COMPILED):
                return True
        return False

    def _clauses(self, words: tuple[str, ...]) -> list[tuple[Goal, bool]] | None:
        """The goals of a sentence's clauses, and whether each is a wish; None if it cannot be split into clauses.

        The sentence is split wherever both sides can be parsed, so that no clause becomes part of a phrase of another
        ("make room for a piano and add one"). Otherwise as few clauses as possible are made, and a clause is parsed as
        a wish rather than as a plain edit.
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
                mine = not isinstance(goal, PlainEdit)
                cost = after[0] + (2 if mine else 3) + _JOINED * sum(w in _JOINTS for w in words[start:end])
                if best is None or cost < best[0]:
                    best = (cost, ((goal, mine), *after[1]))
            return best

        found = rest(0)
        return None if found is None else list(found[1])

    def _clause(self, words: tuple[str, ...]) -> Goal | None:
        """The goal of one clause, None if it is not understood."""
        said = " ".join(_plain(words))
        for kind, pattern in COMPILED:
            matched = pattern.fullmatch(said)
            goal = self._goal(kind, {k: v for k, v in matched.groupdict().items() if v}) if matched else None
            if goal is not None:
                return goal
        plan = self.grammar.plan(" ".join(words)) if said else None
        return PlainEdit(plan.ops) if plan is not None and plan.ok and not _refers_back(words, plan.ops) else None

    def _goal(self, kind: str, parts: Parts) -> Goal | None:
        """The goal of a matched pattern; None if one of its parts is not understood."""
        try:
            return _BUILDERS[kind](self, parts)
        except NotAWish:
            return None

    def things(self, parts: Parts) -> Query | None:
        """The query for what is to be arranged; None for all furniture."""
        said = parts.get("things", "")
        return None if said in _EVERYTHING else self.noun(said, every=True)

    def noun(self, said: str, every: bool = False) -> Query:
        """The query of a noun phrase.

        Raises:
            NotAWish: the text is not a noun phrase.
        """
        plan = self.grammar.plan(f"select {said}")
        if len(plan.ops) != 1 or (query := plan.ops[0].query()) is None or query.last:
            raise NotAWish(f"“{said}” is not understood", said)
        if not query.text and not query.colors:
            raise NotAWish(f"“{said}” is not understood", said)
        return query.model_copy(update={"pick": "all"}) if every and query.pick in ("one", "any") else query

    def where(self, parts: Parts) -> Where | None:
        """The given place, None if there is none."""
        if "anchor" in parts:
            relation: FloorRelation = "in_front_of" if parts["near"] in _BEFORE else "next_to"
            return Where(relation, self.noun(parts["anchor"]))
        return Where() if "middle" in parts else None

    def _blamed(self, words: Sequence[str]) -> tuple[str, ...]:
        """The words of a sentence that are unknown and in no wish pattern; the whole sentence if there are none."""
        strange = [w for w in _plain(words) if w not in _vocabulary() and not nouns.is_known(w) and w not in _JOINTS]
        return tuple(strange) or (" ".join(words),)


def _sentences(text: str) -> Iterator[tuple[str, ...]]:
    """The words of each sentence; a colon ends a sentence as well."""
    words: list[str] = []
    for word in (*(w.text for w in split(clean(text))), "."):
        if word in _MARKS or word == "?":
            if words:
                yield tuple(words)
            words = []
        else:
            words.append(word)


def _plain(words: Sequence[str]) -> list[str]:
    """The words of a clause without polite phrases before it and filler in and behind it."""
    kept = [w for w in words if w not in (",", '"')]
    while found := next((p for p in _POLITE if tuple(kept[: len(p)]) == p and " ".join(p) not in _KEPT), None):
        kept = kept[len(found) :]
    while found := next((p for p in lexicon.FILLER if p and tuple(kept[-len(p) :]) == p and p[-1] != "room"), None):
        kept = kept[: -len(found)]
    return [w for w in kept if w not in ("please", "just", "simply")]


def _refers_back(words: Sequence[str], ops: Sequence[EditOp]) -> bool:
    """Whether a clause refers to a thing that another clause names ("it", "the red ones"). Next to a wish, which moves
    many things, such a reference is ambiguous."""
    nameless = any(query is not None and not query.text for query in (op.query() for op in ops))
    return '"last":true' in ops[0].model_dump_json() or (nameless and bool(_ONES & set(words)))


@cache
def _vocabulary() -> frozenset[str]:
    return frozenset(w for _, pattern in COMPILED for w in re.findall(r"[a-z]+", pattern.pattern))


def _people(said: str) -> int:
    """A number of people in words or digits; raises NotAWish if it is not a number from 1 to 20."""
    read = quantities.read((said,))
    number = read.value if read is not None and read.kind == "NUMBER" else _COUNTS.get(said, 0)
    if number != int(number) or not 1 <= number <= 20:
        raise NotAWish(f"“{said}” is not a number of people", said)
    return int(number)


def _width(said: str) -> float:
    """A width in metres; raises NotAWish if it is not a length of at least 0.2 m."""
    words = tuple(w.text for w in split(said))
    read = quantities.read(words)
    if read is None or read.kind != "LENGTH" or read.taken < len(words) or not in_metres(read.value, read.unit) >= 0.2:
        raise NotAWish(f"“{said}” is not a width", said)
    return in_metres(read.value, read.unit)


def _clear(parser: WishParser, parts: Parts) -> Goal:
    purpose = parts.get("why", "").split()
    if any(w in _JOINTS and len(purpose) - i > 3 for i, w in enumerate(purpose)):
        raise NotAWish("the purpose is too long", *purpose)  # includes another clause: "for a piano, then add one"
    called = parts.get("why") or {"area": "free area", "spot": "free spot"}.get(parts.get("called", ""), "")
    called = called or ("dance floor" if "danc" in parts.get("called", "") else "free floor")
    width = _width(parts["size"]) if "size" in parts else None
    return Clear(parser.where(parts) or Where(), width, called[:60])


def _formation(shape: str) -> Callable[[WishParser, Parts], Goal]:
    def build(parser: WishParser, parts: Parts) -> Goal:
        about = parser.noun(parts["goal"]) if "goal" in parts else None
        rows = {"two": 2, "three": 3, "four": 4}.get(parts.get("rows", ""), 1)
        things = parser.things(parts)
        if things is None:
            raise NotAWish("say which things", parts.get("things", ""))
        return Formation(shape, things, about, parser.where(parts), rows)  # type: ignore[arg-type]

    return build


def _declutter(parser: WishParser, parts: Parts) -> Goal:
    surface = parser.noun(parts["goal"])
    name = surface.text
    if not (nouns.is_surface(name) or nouns.is_container(name) or nouns.is_furniture(name)):
        raise NotAWish(f"nothing stands on {parts['goal']}", parts["goal"])
    return Declutter(surface)


def _walls(parser: WishParser, parts: Parts) -> Goal:
    said = parts.get("things", "")
    return Walls(None if said in _EVERYTHING else parser.noun(said))


def _is_plain_enough(goal: Goal) -> bool:
    """Whether the grammar can plan a goal as well: one thing to the wall is one move."""
    return isinstance(goal, Walls) and goal.things is not None and goal.things.pick == "one" and not goal.things.also


def _spread(parser: WishParser, parts: Parts) -> Goal:
    if (things := parser.things(parts)) is None:
        raise NotAWish("say which things", parts["things"])
    return Spread(things)


_BUILDERS: dict[str, Callable[[WishParser, Parts], Goal]] = {
    "clear": _clear,
    "walls": _walls,
    "circle": _formation("circle"),
    "arc": _formation("arc"),
    "row": _formation("row"),
    "around": _formation("around"),
    "tidy": lambda _parser, _parts: Tidy(),
    "declutter": _declutter,
    "set_table": lambda parser, parts: SetTable(
        parser.noun(parts["goal"]), _people(parts["people"]) if "people" in parts else None
    ),
    "see": lambda parser, parts: See(parser.things(parts), parser.noun(parts["goal"])),
    "watch": lambda _parser, _parts: See(None, Query(text="television")),
    "spread": _spread,
    "reading_corner": lambda parser, parts: ReadingCorner(parser.where(parts)),
    "symmetric": lambda _parser, _parts: Symmetric(),
    "become": lambda _parser, parts: Become(parts["kind"].strip()),
    "party": lambda _parser, _parts: Party(),
}

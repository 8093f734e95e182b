"""The grammar planner: plain imperative English to a plan, in milliseconds, or an honest refusal.

Knows the order of the work: clean, split into sentences and clauses, tag, parse, build, join. Refuses to guess: a
clause that does not parse is named with the words to blame, and then nothing of the instruction is planned.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

from ...gaussians.errors import UserError
from ...gaussians.language.query.query import Query
from ...tools.operation import EditOp
from ...tools.registry import parse as parse_op
from ..plan import MAX_OPS, EditPlan
from .meaning.changes import Fields
from .meaning.commands import read
from .meaning.phrases import Phrases
from .parsing import Refusal, first_words, parse, trees
from .tagging.lookahead import match
from .tagging.non_edits import FORBIDDEN, STATEMENT, empty_refusal, is_chat, refuse_non_edit
from .tagging.spelling import correct_spelling
from .tagging.tagger import clauses
from .tagging.tags import Clause, Tag, sentences
from .tagging.words import Word, clean, split
from .vocabulary import lexicon
from .vocabulary.unsafe import unsafe_words

if TYPE_CHECKING:
    from ..plan import Sight

NAME = "grammar"


@dataclass(frozen=True)
class _Outcome:
    """What was understood: operations, the last noun, the operations of the last clause, slips corrected, and the last
    noun's colours."""

    ops: tuple[dict[str, Any], ...]
    antecedent: str
    again: tuple[dict[str, Any], ...] = ()
    remarks: tuple[str, ...] = ()
    colors: tuple[str, ...] = ()


class GrammarPlanner:
    """Plans what it understands completely and abstains otherwise. Stateless; one instance serves all threads."""

    name = NAME

    def __init__(self) -> None:
        _make_tables()

    def plan(self, text: str, *, previous: str | None = None, sight: Sight | None = None) -> EditPlan:
        """The plan for an instruction; see `Planner.plan`. The scene (`sight`) is not looked at.

        Raises:
            UserError: the text is too long to be an instruction.
        """
        started = time.perf_counter()
        cleaned = clean(text)
        told: dict[str, Any]
        try:
            outcome = _understand(cleaned, previous)
            told = {"ops": tuple(_valid(op) for op in outcome.ops), "reason": "; ".join(outcome.remarks)[:2000]}
        except Refusal as refusal:
            told = {"verdict": refusal.verdict, "reason": str(refusal), "unknown": _short(refusal.words)}
        return EditPlan(instruction=text, planner=NAME, seconds=time.perf_counter() - started, **told)


@cache
def _make_tables() -> None:
    """Build the parser and the word tables, once a process, so that the first instruction is as fast as the others."""
    _understand("paint it red and add a small mug", None)


def _valid(fields: dict[str, Any]) -> EditOp:
    """The operation, if its fields are in range."""
    try:
        return parse_op(fields)
    except UserError as error:
        raise Refusal(str(error)[:500], verdict="impossible") from error


def _short(words: Sequence[str]) -> tuple[str, ...]:
    return tuple(w[:200] for w in words if w)[:64]


def _understand(cleaned: str, previous: str | None) -> _Outcome:
    """Operations of a cleaned instruction.

    Raises:
        Refusal: any part of it is not understood, or none of it is an edit.
    """
    if phrase := unsafe_words(cleaned):
        raise Refusal("this is not about the scene", phrase, verdict="unsafe")
    words, remarks = correct_spelling(split(cleaned))
    before = _before(previous)
    said = Phrases(before.antecedent, before.again, before.colors)
    ops: list[dict[str, Any]] = []
    idle: Refusal | None = None
    topic: Query | None = None
    stated_first = False
    for sentence, mark in sentences(words):
        if ops and match(lexicon.RETRACTIONS, [w.text for w in sentence if w.text != ","], 0):
            raise Refusal("it takes back what it said before; say only what to do", sentence[0].text)
        for clause in clauses(sentence):
            follows = bool(ops) or previous is not None or topic is not None
            try:
                ops += _carry(clause, sentence, mark, said, follows, cleaned)
            except Refusal as refusal:
                if refusal.verdict != "not_an_edit" or (idle and not is_chat(refusal)):
                    raise
                idle, stated_first = refusal, not ops
                topic = _topic(clause, refusal)
    if idle and ops and str(idle) == STATEMENT and stated_first:
        idle = None  # "I love the sofa. Delete the rug."
        if topic is not None and ops[0].get("target") == Query(last=True):
            ops[0] = {**ops[0], "target": topic}
    if idle and ops and str(idle) == FORBIDDEN and topic is not None:
        ops, idle = [_sparing(op, topic) for op in ops], None  # "don't touch the sofa, remove everything"
    ops = _release(ops)
    if not ops:
        raise idle or empty_refusal(words)
    if idle and not is_chat(idle):
        raise Refusal(f"this part is not an edit, so nothing was planned: {idle}", *idle.words)
    if len(ops) > MAX_OPS:
        raise Refusal(f"that is more than {MAX_OPS} steps; say it in parts")
    return _Outcome(tuple(_merge_copies(ops)), said.antecedent, tuple(said.before), remarks, said.colors)


def _topic(clause: Clause, idle: Refusal) -> Query | None:
    """What a statement or a prohibition is about: "the sofa is ugly, delete it"."""
    if str(idle) not in (STATEMENT, FORBIDDEN):
        return None
    first = next((i for i, t in enumerate(clause.tags) if t.type == "DET"), None)
    if first is None:
        return None
    for end in range(len(clause.tags), first + 1, -1):
        about = clause.tags[first:end]
        with suppress(Refusal):
            (op,) = read(Phrases(), parse(Clause([Tag("SELECT", None, about[0].words), *about], "SELECT")))
            query: Query = op["target"]
            return query.model_copy(update={"pick": "one"}) if query.pick == "any" else query
    return None


def _before(previous: str | None) -> _Outcome:
    """What the instruction before was about."""
    if previous:
        with suppress(Refusal, UserError):
            return _understand(clean(previous), None)
    return _Outcome((), "")


def _carry(
    clause: Clause, sentence: Sequence[Word], mark: str, said: Phrases, follows: bool, cleaned: str
) -> list[dict[str, Any]]:
    """One clause's operations; refusals quote it."""
    refuse_non_edit(clause, sentence, mark)
    try:
        if clause.unsupported:
            raise Refusal(clause.unsupported, clause.tags[0].text, verdict="impossible")
        tree = parse(clause)
        if not follows and any(t.data in ("it_becomes", "it_moves") for t in trees(tree)):
            raise Refusal("it does not say what to do, or to what", *first_words(clause))
        return read(said, tree)
    except Refusal as refusal:
        raise Refusal(f"“{_quote(clause, cleaned)}”: {refusal}", *refusal.words, verdict=refusal.verdict) from None


def _quote(clause: Clause, cleaned: str) -> str:
    words = [w for t in clause.tags for w in t.words]
    said = cleaned[words[0].start : words[-1].end] if words else cleaned
    return said if len(said) <= 80 else said[:79] + "…"


# ---- what one clause's operations mean for another's ----


def _sparing(op: Fields, spared: Query) -> Fields:
    """An operation on several things without what was forbidden to touch."""
    target = op.get("target")
    if target is None or target.pick != "all" or len(target.exclude) >= 4:
        return op
    return {**op, "target": target.model_copy(update={"exclude": (*target.exclude, spared)})}


def _release(ops: Sequence[Fields]) -> list[Fields]:
    """Settle clauses that are half a sentence: "keep the sofa (and delete the rest)", "take the cup (and put …)".

    Raises:
        Refusal: the other half is missing.
    """
    settled: list[Fields] = []
    taken: Query | None = None
    for i, op in enumerate(ops):
        held, fields = op.get("held"), {k: v for k, v in op.items() if k != "held"}
        after = ops[i + 1].get("target") if i + 1 < len(ops) else None
        if held == "kept" and (after is None or Query(last=True) not in after.exclude):
            raise Refusal("it says what to keep, and asks for no change", "keep", verdict="not_an_edit")
        if op["op"] == "isolate" and after is not None and after.pick == "all" and Query(last=True) in after.exclude:
            fields = {"op": "select", "target": op["target"]}  # "just keep the sofa and remove everything else"
        if held == "taken":
            if after != Query(last=True) or ops[i + 1]["op"] != "move":
                raise Refusal("say where to, or take it away", "take")
            taken = op["target"]
            continue
        if taken is not None:
            fields, taken = {**fields, "target": taken}, None
        settled.append(fields)
    return settled


def _merge_copies(ops: Sequence[Fields]) -> list[Fields]:
    """ "copy the chair and put it next to the desk" is one copy that goes there."""
    merged: list[Fields] = []
    for op in ops:
        before = merged[-1] if merged else {}
        bare = before.get("op") == "duplicate" and not {"place", "direction"} & before.keys()
        if bare and op["op"] == "move" and op["target"].last and "toward" not in op:
            merged[-1] = {**before, **{k: v for k, v in op.items() if k not in ("op", "target")}}
        else:
            merged.append(op)
    return merged

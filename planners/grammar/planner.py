"""The grammar planner: plain imperative English to a plan, in milliseconds, or an honest refusal.

Knows the order of the work: clean, split into sentences and clauses, tag, parse, build. Refuses to guess: a clause that
does not parse is named with the words to blame, and then nothing of the instruction is planned.
"""

from __future__ import annotations

import difflib
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lark import Lark, Token
from lark.exceptions import UnexpectedInput, UnexpectedToken
from lark.lexer import Lexer

from ...gaussians.errors import UserError
from ...gaussians.language.query import Query
from ...tools.base import EditOp
from ...tools.registry import parse as parse_op
from ..plan import MAX_OPS, EditPlan
from . import lexicon, nouns
from .commands import Commands
from .nodes import Node, Refusal, trees
from .reading import color_at, match
from .spelling import respell
from .tagger import Tagger
from .tags import Clause, Tag, sentences
from .unsafe import unsafe_words
from .words import Word, bag, clean, split

if TYPE_CHECKING:
    from ..graph import SceneGraph

NAME = "grammar"


class _Passed(Lexer):
    """Hands on tokens that the tagger made."""

    def __init__(self, _conf: object) -> None:
        pass

    def lex(self, data: Sequence[Tag]) -> Iterator[Token]:  # type: ignore[override]
        for i, tag in enumerate(data):
            token = Token(tag.type, tag, start_pos=i)
            token.value = tag
            yield token


@cache
def _parser() -> Lark:
    grammar = Path(__file__).with_name("grammar.lark").read_text(encoding="utf-8")
    return Lark(grammar, parser="lalr", lexer=_Passed)


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
        # Everything that is made once is made here, so that the first instruction is as quick as the others.
        _understand("paint it red and add a small mug", None)

    def plan(self, text: str, *, previous: str | None = None, graph: SceneGraph | None = None) -> EditPlan:
        """The plan for an instruction; see `Planner.plan`. The scene (`graph`) is not looked at.

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
    words, remarks = respell(split(cleaned))
    before = _before(previous)
    commands = Commands(before.antecedent, before.again, before.colors)
    ops: list[dict[str, Any]] = []
    idle: Refusal | None = None
    topic: Query | None = None
    stated_first = False
    for sentence, mark in sentences(words):
        if ops and match(lexicon.RETRACTIONS, [w.text for w in sentence if w.text != ","], 0):
            raise Refusal("it takes back what it said before; say only what to do", sentence[0].text)
        for clause in Tagger(sentence).clauses():
            follows = bool(ops) or previous is not None or topic is not None
            try:
                ops += _carry(clause, sentence, mark, commands, follows, cleaned)
            except Refusal as refusal:
                if refusal.verdict != "not_an_edit" or (idle and not _is_chat(refusal)):
                    raise
                idle, stated_first = refusal, not ops
                topic = _topic(clause, refusal)
    if idle and ops and str(idle) == _STATEMENT and stated_first:
        idle = None  # "I love the sofa. Delete the rug."
        if topic is not None and ops[0].get("target") == Query(last=True):
            ops[0] = {**ops[0], "target": topic}
    if idle and ops and str(idle) == _FORBIDDEN and topic is not None:
        ops, idle = [_sparing(op, topic) for op in ops], None  # "don't touch the sofa, remove everything"
    ops = _release(ops)
    if not ops:
        raise idle or _empty(words)
    if idle and not _is_chat(idle):
        raise Refusal(f"this part is not an edit, so nothing was planned: {idle}", *idle.words)
    if len(ops) > MAX_OPS:
        raise Refusal(f"that is more than {MAX_OPS} steps; say it in parts")
    spoken = commands.phrases
    return _Outcome(tuple(_merge_copies(ops)), spoken.antecedent, tuple(commands.before), remarks, spoken.colors)


def _topic(clause: Clause, idle: Refusal) -> Query | None:
    """What a statement or a prohibition is about: "the sofa is ugly, delete it"."""
    if str(idle) not in (_STATEMENT, _FORBIDDEN):
        return None
    first = next((i for i, t in enumerate(clause.tags) if t.type == "DET"), None)
    if first is None:
        return None
    for end in range(len(clause.tags), first + 1, -1):
        about = clause.tags[first:end]
        with suppress(Refusal):
            (op,) = Commands().read(_parse(Clause([Tag("SELECT", None, about[0].words), *about], "SELECT")))
            query: Query = op["target"]
            return query.model_copy(update={"pick": "one"}) if query.pick == "any" else query
    return None


def _sparing(op: dict[str, Any], spared: Query) -> dict[str, Any]:
    """An operation on several things without what was forbidden to touch."""
    target = op.get("target")
    if target is None or target.pick != "all" or len(target.exclude) >= 4:
        return op
    return {**op, "target": target.model_copy(update={"exclude": (*target.exclude, spared)})}


def _empty(words: Sequence[Word]) -> Refusal:
    """The refusal of an instruction in which nothing but filler stands."""
    said = tuple(w.text for w in words if w.text[0].isalpha())
    if any(w in lexicon.CHAT for w in said):
        return Refusal(_CHAT, verdict="not_an_edit")
    return (
        Refusal("it does not say what to do", *said) if said else Refusal("there are no words", verdict="not_an_edit")
    )


def _release(ops: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Settle clauses that are half a sentence: "keep the sofa (and delete the rest)", "take the cup (and put …)".

    Raises:
        Refusal: the other half is missing.
    """
    settled: list[dict[str, Any]] = []
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


def _is_chat(refusal: Refusal) -> bool:
    return str(refusal) == _CHAT


_CHAT = "this asks for nothing"
_FORBIDDEN = "it says what not to do, and asks for no change"
_STATEMENT = "this is a statement, not an edit"
_JUDGING = bag("looks look seems seem feels sounds works good great nice fine better perfect lovely")
_BEING = bag("is are was were should")
_TELLING = ("DIR", "HUE", "LIGHT", "GROWN", "ONE", "OTHER", "OTHERS", "LENGTH", "DEGREE")


def _before(previous: str | None) -> _Outcome:
    """What the instruction before was about."""
    if previous:
        with suppress(Refusal, UserError):
            return _understand(clean(previous), None)
    return _Outcome((), "")


def _carry(
    clause: Clause, sentence: Sequence[Word], mark: str, commands: Commands, follows: bool, cleaned: str
) -> list[dict[str, Any]]:
    """One clause's operations; refusals quote it."""
    _refuse_idle(clause, sentence, mark)
    said = _quote(clause, cleaned)
    if clause.unsupported:
        raise Refusal(f"“{said}”: {clause.unsupported}", clause.tags[0].text, verdict="impossible")
    try:
        tree = _parse(clause)
        if not follows and any(t.data in ("it_becomes", "it_moves") for t in trees(tree)):
            raise Refusal("it does not say what to do, or to what", *_first_words(clause))
        return commands.read(tree)
    except Refusal as refusal:
        raise Refusal(f"“{said}”: {refusal}", *refusal.words, verdict=refusal.verdict) from None


def _quote(clause: Clause, cleaned: str) -> str:
    words = [w for t in clause.tags for w in t.words]
    said = cleaned[words[0].start : words[-1].end] if words else cleaned
    return said if len(said) <= 80 else said[:79] + "…"


def _refuse_idle(clause: Clause, sentence: Sequence[Word], mark: str) -> None:
    """Raise if the clause is a question, a statement, chat, a session command or a prohibition."""
    if clause.negated:
        raise Refusal(_FORBIDDEN, "not", verdict="not_an_edit")
    asked = clause.tags[1] if clause.verb == "SELECT" and len(clause.tags) > 1 else None
    if asked and asked.type != "EVERYTHING" and asked.words[0].text in lexicon.QUESTION:
        raise Refusal("this is a question, not an edit", clause.tags[1].text, verdict="not_an_edit")
    if clause.verb or clause.unsupported:
        return
    texts = [w.text for w in sentence if w.text != ","]
    first = next((t for t in texts if t not in ("and", "so", "well", "but", "ok", "okay", "hey", "hi", "please")), "")
    polite = {w for p in (*lexicon.FILLER, *lexicon.POLITE) for w in p} | lexicon.CHAT
    if first in lexicon.COMMANDS:
        raise Refusal(f"{first} is a command of the session, not an edit", first, verdict="not_an_edit")
    says = any(t.type in _TELLING for t in clause.tags)
    if not says and all(t in polite for t in texts) and any(t in lexicon.CHAT for t in texts):
        raise Refusal(_CHAT, verdict="not_an_edit")
    if texts[:3] == ["do", "the", "same"] or any(t.type == "SHOULD" for t in clause.tags):
        return
    if first in lexicon.QUESTION or first in lexicon.ASKING or mark == "?":
        raise Refusal("this is a question, not an edit", first, verdict="not_an_edit")
    own = [w.text for t in clause.tags for w in t.words]
    judges = own[:1] in (["that"], ["this"], ["it"], ["looks"]) and bool(_JUDGING & set(own))
    if first in lexicon.STATEMENT or judges or _BEING & set(texts):
        raise Refusal(_STATEMENT, first, verdict="not_an_edit")


def _parse(clause: Clause) -> Node:
    try:
        return _parser().parse(clause.tags)
    except UnexpectedToken as error:
        at = error.token.start_pos if error.token.type != "$END" else None
        raise _blame(clause, at) from None
    except UnexpectedInput as error:
        raise Refusal("this cannot be read") from error


def _blame(clause: Clause, at: int | None) -> Refusal:
    """Which words to name: `at` is the index of the token that did not fit, None for the end of the clause."""
    tags = clause.tags
    if not clause.verb:
        return _unknown_verb(_first_words(clause)[0])
    if at is None:
        tail = _unknown_tail(tags[-1]) if tags else ()
        if tail:
            return Refusal(f"“{' '.join(tail)}” is not understood", " ".join(tail))
        return Refusal(f"something is missing after “{tags[-1].text}”")
    found = tags[at]
    if found.type in ("DET", "PRON", "EVERYTHING") and at > 1 and tags[at - 1].type == "NOUN":
        found = tags[at - 1]
    elif found.type not in ("NOUN", "UNKNOWN"):
        strange = (t for t in tags[at + 1 :] if t.type == "UNKNOWN" or (t.type == "NOUN" and not _is_known(t)))
        found = next(strange, found)
    return Refusal(f"“{found.text}” is not understood here", found.text)


def _unknown_verb(word: str) -> Refusal:
    verbs = [v[0] for v in lexicon.VERB_PHRASES if len(v) == 1]
    close = difflib.get_close_matches(word, verbs, n=1, cutoff=0.75)
    hint = f"; did you mean {close[0]}?" if close else ""
    return Refusal(f"“{word}” is no verb this planner knows{hint}", word)


def _first_words(clause: Clause) -> tuple[str, ...]:
    return (clause.tags[0].words[0].text,) if clause.tags else ("",)


def _is_known(tag: Tag) -> bool:
    return any(nouns.is_known(w) for w in tag.text.split())


def _unknown_tail(tag: Tag) -> tuple[str, ...]:
    """The words behind the last everyday noun of a run ("wall blorange"), or the last word if none is known."""
    if tag.type != "NOUN" or color_at([w.text for w in tag.words], 0):
        return ()
    texts = tag.text.split()
    known = [i for i, w in enumerate(texts) if nouns.is_known(w)]
    if known:
        return tuple(texts[known[-1] + 1 :])
    return (texts[-1],) if len(texts) > 1 else ()


def _merge_copies(ops: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """ "copy the chair and put it next to the desk" is one copy that goes there."""
    merged: list[dict[str, Any]] = []
    for op in ops:
        before = merged[-1] if merged else {}
        bare = before.get("op") == "duplicate" and not {"place", "direction"} & before.keys()
        if bare and op["op"] == "move" and op["target"].last and "toward" not in op:
            merged[-1] = {**before, **{k: v for k, v in op.items() if k not in ("op", "target")}}
        else:
            merged.append(op)
    return merged

"""The grammar planner: turns plain imperative English into a plan within milliseconds, or refuses.

Steps: clean the text, correct its spelling, split it into sentences and clauses, tag, parse, build operations, join
them. If one clause is not understood, nothing is planned, and the refusal names the clause and its words.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel

from ...gaussians import late_re as re
from ...gaussians.errors import UserError
from ...gaussians.language.query.nested import queries, with_queries
from ...gaussians.language.query.query import Query
from ...gaussians.world import kinds
from ...tools.operation import EditOp
from ...tools.registry import OPS
from ...tools.registry import parse as parse_op
from ..plan import MAX_OPS, EditPlan
from .lighting.splitting import Part, may_be_light, parts_of
from .meaning.changes import Fields
from .meaning.phrases import Phrases
from .naming import named_there
from .parsing import Refusal
from .reader import Reader
from .restating.changes.filling import Heard, heard
from .restating.changes.likenesses import with_likenesses, with_photo
from .restating.changes.shadows import ShadowsHeard, shadows_heard
from .restating.order.sequence import in_order
from .restating.speech.frames import asks_nothing
from .restating.speech.remarks import is_remark
from .restating.speech.smoothing import smoothed
from .tagging.non_edits import QUESTION, STATEMENT
from .tagging.spelling import correct_spelling
from .tagging.words import Word, clean, split, without_owners
from .timing.ending import with_end
from .timing.judging import Judge, wording_of
from .timing.keeping import Kept, held, without_kept
from .timing.marked.kinds import SURE
from .timing.reading import TimeReader, is_misread, may_be_timed
from .timing.sending import behind, in_its_place, require_no_loss, sent, without_then
from .timing.spoken import written
from .vocabulary.nouns import is_known
from .vocabulary.unsafe import unsafe_words

if TYPE_CHECKING:
    from ..plan import Observation

NAME = "grammar"
_SAYS_MOVING = re.compile(r"\bmov(?:es|ing)\b", re.IGNORECASE)
SUPPOSED = "no rule reads these words; this is what such a wish most likely asks for"
_COPIES = frozenset({"copy", "duplicate", "clone", "new one", "second one", "second copy"})
_ORIGINALS = frozenset({"original", "original one", "first one", "old one"})
_FITTED = frozenset({"insert", "replace"})  # operations whose new things are fitted to the light of the scene
_REVEALING = frozenset({"delete", "move", "replace"})  # operations whose holes are filled
_REST = frozenset({"rest", "everything", "everything else", "other"})
_SIDES = {"right_of": "right", "left_of": "left", "next_to": None}  # of the original, and the direction of its copies


@dataclass(frozen=True)
class _Outcome:
    """What was understood of an instruction.

    Attributes:
        ops: the operations, as fields.
        antecedent: the last head noun.
        again: the operations of the last clause.
        remarks: spelling corrections, and whether it was told by the kind of its wish.
        plainly: whether every sentence was read in its own words.
        colors: colours of the last head noun.
    """

    ops: tuple[dict[str, Any], ...]
    antecedent: str
    again: tuple[dict[str, Any], ...] = ()
    remarks: tuple[str, ...] = ()
    colors: tuple[str, ...] = ()
    plainly: bool = True


class GrammarPlanner:
    """Plans instructions that it understands completely, abstains otherwise. Stateless and thread-safe."""

    name = NAME

    def plan(self, text: str, *, previous: str | None = None, observation: Observation | None = None) -> EditPlan:
        """The plan for an instruction; see `Planner.plan`. The scene is only asked what moves in it and what it
        lacks, where that tells which of several wishes is meant.

        Raises:
            UserError: the text is too long.
        """
        started = time.perf_counter()
        cleaned = clean(text)
        told: dict[str, Any]
        try:
            outcome = _understand(cleaned, previous, observation)
            told = {"ops": tuple(_valid(op) for op in outcome.ops), "reason": "; ".join(outcome.remarks)[:2000]}
        except Refusal as refusal:
            told = {"verdict": refusal.verdict, "reason": str(refusal), "unknown": _shortened(refusal.words)}
        return EditPlan(instruction=text, planner=NAME, seconds=time.perf_counter() - started, **told)

    def otherwise(self, plan: EditPlan, *, observation: Observation | None = None) -> EditPlan | None:
        """What the instruction of a plan most likely asks for by its kind, for a scene in which that plan cannot be
        carried out; None if that is not likely enough, or the same."""
        started = time.perf_counter()
        try:
            ops = tuple(_valid(op) for op in _most_likely(clean(plan.instruction), observation))
        except Refusal:
            return None
        if not ops or ops == plan.ops:
            return None
        seconds = time.perf_counter() - started
        return EditPlan(instruction=plan.instruction, planner=NAME, ops=ops, reason=SUPPOSED, seconds=seconds)

    def is_sure(self, text: str, *, previous: str | None = None) -> bool:
        """Whether nothing of an instruction's meaning was guessed.

        A plan is sure if every sentence was read in its own words and spelling, and every name in it is known. That
        something is no edit is sure of questions, chat, commands of the session, prohibitions, and remarks on how
        things are; not of other statements, nor of requests in the form of a question.
        """
        cleaned = clean(text)
        try:
            outcome = _understand(cleaned, previous)
        except Refusal as refusal:
            if refusal.verdict != "not_an_edit":
                return refusal.verdict in ("unsafe", "impossible")
            said = [w.text for w in split(cleaned)]
            asked = str(refusal) == QUESTION and bool(said) and said[0] not in _REQUESTING
            return asked or str(refusal) not in (QUESTION, STATEMENT) or is_remark(said)
        names = [q.text for op in outcome.ops for q in _targets(op)]
        return outcome.plainly and not outcome.remarks and all(_is_known_name(n) for n in names)


_REQUESTING = ("can", "could", "would", "will", "may", "might", "should", "shall", "please", "the", "that", "this")


def _targets(fields: dict[str, Any]) -> list[Query]:
    return [q for _, q in queries(tuple(v for v in fields.values() if isinstance(v, BaseModel)))]


def _is_known_name(name: str) -> bool:
    return not name or kinds.find(name) is not None or all(is_known(word) for word in name.split())


@cache
def make_tables() -> None:
    """Build the parser and the word tables once per process, so that the first instruction is as fast as the others.

    A program that answers many instructions calls it at its start; a command that answers one does not.
    """
    _understand("paint it red and add a small mug", None)


def _valid(fields: dict[str, Any]) -> EditOp:
    """The validated operation.

    Raises:
        Refusal: a field is out of range.
    """
    try:
        return parse_op(fields)
    except UserError as error:
        raise Refusal(str(error)[:500], verdict="impossible") from error


def _shortened(words: Sequence[str]) -> tuple[str, ...]:
    return tuple(w[:200] for w in words if w)[:64]


def _understand(cleaned: str, previous: str | None, scene: Observation | None = None) -> _Outcome:
    """Parse a cleaned instruction; what a scene lacks is looked for by a name that is as near.

    Args, raises: as `_read_whole`.
    """
    if scene is not None and (opened := in_its_place(cleaned, _thing, scene.movement)):
        return _Outcome(opened, antecedent="", plainly=False)
    said, then = without_then(cleaned)
    outcome = _read_whole(said, previous, scene)
    require_no_loss(said, outcome.ops)
    if scene is None:
        return outcome
    ops = sent(said, tuple(named_there(outcome.ops, scene.lacks)), scene.moves)
    return replace(outcome, ops=behind(ops, scene.movement) if then else ops)


def _read_whole(cleaned: str, previous: str | None, scene: Observation | None) -> _Outcome:
    """Parse a cleaned instruction.

    Args:
        scene: asked what moves in it, and what it lacks; None if there is none.

    Raises:
        Refusal: any part of it is not understood, or none of it is an edit.
    """
    cleaned = written(cleaned)
    if phrase := unsafe_words(cleaned):
        raise Refusal("this is not about the scene", phrase, verdict="unsafe")
    if not may_be_timed(cleaned):
        return _wished(cleaned, previous, scene)
    reader = TimeReader(_operations, _thing)
    judge = judge_of(scene, reader)
    if judge.contradicts_itself(cleaned):
        raise Refusal("this asks for two things that cannot both be", cleaned[:200], verdict="impossible")
    asked, kept = without_kept(cleaned)
    try:
        outcome = _in_time(asked, previous, scene, reader, judge)
    except Refusal:
        if not kept:
            raise
        outcome = _in_time(cleaned, previous, scene, reader, judge)  # what seems to stay may be what is asked for
        try:
            return replace(outcome, ops=_as_kept(outcome.ops, asked, kept, scene))
        except Refusal:
            asked, kept = cleaned, ()
    return replace(outcome, ops=_as_kept(outcome.ops, asked, kept, scene))


def _most_likely(cleaned: str, scene: Observation | None) -> Sequence[Fields]:
    """What an instruction most likely asks for by its kind, without any rule; none if that is not likely enough.

    Raises:
        Refusal: that would change what it says is to stay.
    """
    cleaned = written(cleaned)
    judge = judge_of(scene)
    if not may_be_timed(cleaned):
        return judge.wished(cleaned) or ()
    asked, kept = without_kept(cleaned)
    return _as_kept(judge.likeliest(asked) or (), asked, kept, scene)


def _as_kept(ops: Sequence[Fields], asked: str, kept: Sequence[Kept], scene: Observation | None) -> tuple[Fields, ...]:
    """Operations with the end that an instruction asks for, and with which everything stays that is to stay.

    Args:
        asked: the instruction without the words that say what stays.
        kept: what these say.

    Raises:
        Refusal: they change just what is to stay.
    """
    movement = scene.movement if scene is not None else _unknown
    return held(with_end(asked.lower(), ops, movement), kept, movement)


def judge_of(scene: Observation | None, reader: TimeReader | None = None) -> Judge:
    """A judge of what is read of an instruction, for a scene if there is one.

    Args:
        reader: reads its times, names and commands; None: a new one.
    """
    reader = TimeReader(_operations, _thing) if reader is None else reader
    return Judge(reader) if scene is None else Judge(reader, scene.moves, scene.movement, scene.has, scene.after)


def _unknown(query: Query) -> None:
    """How something moves where there is no scene."""


def _in_time(
    cleaned: str, previous: str | None, scene: Observation | None, reader: TimeReader, judge: Judge
) -> _Outcome:
    """As `_read_whole`, of an instruction that may be about time or motion.

    Raises:
        Refusal: as `_read_whole`.
    """
    try:
        outcome = _timed(reader, cleaned, previous)
    except Refusal as refusal:
        if refusal.verdict == "unsafe" or (refusal.firm and refusal.verdict != "impossible"):
            raise
        if (supposed := judge.likeliest(cleaned, SURE if refusal.verdict == "impossible" else 0.0)) is None:
            raise
        return _guessed(supposed)
    if judge.contradicts(cleaned, outcome.ops):
        if (supposed := judge.likeliest(cleaned)) is None:
            raise Refusal("this says something of time or motion that is not understood", cleaned[:200])
        return _guessed(supposed)
    if (supposed := judge.timed(cleaned, outcome.ops)) is not None:
        return _guessed(supposed)
    if (fuller := judge.fuller(cleaned, outcome.ops)) is not None:
        return _guessed(fuller)
    if judge.is_still(outcome.ops) and (supposed := judge.likeliest(cleaned)) and not judge.is_still(supposed):
        return _guessed(supposed)
    if judge.is_about_another(cleaned, outcome.ops):
        if supposed := judge.likeliest(cleaned):
            return outcome if judge.is_about_another(cleaned, supposed) else _guessed(supposed)
        plainly = outcome.ops[0]["op"] == "delete" and outcome.ops[0]["target"].text != "everything"
        if plainly and judge.is_named_beside(cleaned, outcome.ops[0]["target"]):
            raise Refusal("what is to be removed is not understood", cleaned[:200])
    if judge.misses_a_thing(cleaned, outcome.ops) and (supposed := judge.likeliest(cleaned)):
        return outcome if judge.misses_a_thing(cleaned, supposed) else _guessed(supposed)
    if judge.is_of_another_kind(cleaned, outcome.ops):
        if supposed := judge.likeliest(cleaned):
            return _guessed(supposed)
        if judge.is_of_another_kind(cleaned, outcome.ops, SURE):
            raise Refusal("this says something of time or motion that is not understood", cleaned[:200])
    told = judge.as_told(outcome.ops, wording_of(cleaned))
    if outcome.ops and tuple(told) != tuple(outcome.ops):
        if supposed := told or judge.likeliest(cleaned):
            return _guessed(supposed)
        raise Refusal("what moves would not do so at the time that this tells", cleaned[:200])
    if scene is not None and _lacks(scene, outcome.ops) and (supposed := judge.likeliest(cleaned)):
        return outcome if _lacks(scene, supposed) else _guessed(supposed)
    of_all = any(query.text == "everything" for op in outcome.ops for query in _targets(op))
    of_all = of_all and _SAYS_MOVING.search(cleaned) is None  # "play it all at half speed" is about the whole scene
    if not of_all and not _names_things(outcome.ops, previous) and (supposed := judge.likeliest(cleaned)):
        return _guessed(supposed) if _names_things(supposed, previous) else outcome
    return outcome


def _wished(cleaned: str, previous: str | None, scene: Observation | None) -> _Outcome:
    """As `_timeless`; where no rule reads it, what it most likely wishes to look different or to be gone, or of what
    moves in a scene.

    Raises:
        Refusal: as `_timeless`.
    """
    judge = judge_of(scene)
    try:
        outcome = _timeless(cleaned, previous)
    except Refusal as refusal:
        if refusal.firm or refusal.verdict in ("unsafe", "impossible"):
            raise
        if (wished := judge.wished(cleaned)) is None:
            raise
        return _guessed(wished)
    nameless = previous is None and bool(outcome.ops) and all(q.last for q in _targets(outcome.ops[0]))
    if nameless and (wished := judge.wished(cleaned)) is not None and _names_things(wished, previous):
        return _guessed(wished)  # "this plant I do not like at all, take it away"
    return outcome


def _timed(reader: TimeReader, cleaned: str, previous: str | None) -> _Outcome:
    """As `_understand`, of an instruction that may be about time or motion, by rules.

    Raises:
        Refusal: as `_understand`.
    """
    if (timed := reader.read(cleaned)) is not None:
        return _of_time(timed)
    outcome = _timeless(cleaned, previous)
    if is_misread([op for op in outcome.ops if op["op"] != "select"]):
        raise Refusal("this says something of time or motion that is not understood", cleaned[:200])
    return outcome


def _lacks(scene: Observation, ops: Sequence[Fields]) -> bool:
    """Whether a scene has nothing of what operations are about: "let the fan go the other way" is about no "fan go"."""
    timed = any(op.get("when") is not None or OPS[op["op"]].makes_motion for op in ops)
    return timed and any(scene.lacks(query) for op in ops for query in _targets(op) if not query.last and query.text)


def _names_things(ops: Sequence[Fields], previous: str | None) -> bool:
    """Whether every name in operations is made of known nouns, and "it" can mean something: "stop the ball dead at 2 s"
    is not about a dead ball."""
    before = previous is not None or (bool(ops) and not any(query.last for query in _targets(ops[0])))
    whole = [op for op in ops if op.get("change") == "stop" and op["target"].text == "everything"]
    return before and all(_is_known_name(query.text) for op in ops if op not in whole for query in _targets(op))


def _operations(cleaned: str) -> Sequence[Fields]:
    """The operations of a plain command, as fields. Raises Refusal."""
    return _timeless(cleaned, None).ops


def _of_time(ops: Sequence[Fields]) -> _Outcome:
    """The outcome of an instruction about time or motion."""
    last: Query | None = ops[-1].get("target")
    named = last is not None and not last.last
    return _Outcome(
        tuple(ops),
        last.text if named and last is not None else "",
        tuple(ops[-1:]),
        (),
        last.colors if named and last is not None else (),
    )


def _guessed(ops: Sequence[Fields]) -> _Outcome:
    """The outcome of an instruction about time or motion that was told by the kind of its wish."""
    return replace(_of_time(ops), remarks=(SUPPOSED,), plainly=False)


def _timeless(cleaned: str, previous: str | None) -> _Outcome:
    """As `_understand`, of an instruction that is safe and says nothing of time.

    Raises:
        Refusal: any part of it is not understood, or none of it is an edit.
    """
    if (shadows := shadows_heard(cleaned)) is not None:
        return _with_shadows(shadows, previous)
    if may_be_light(cleaned) and (parts := _lit(cleaned, previous)) is not None:
        return _with_light(parts, previous)
    said = heard(cleaned)
    if said.requests or said.leave or said.anyway:
        return _with_holes(said, previous)
    cleaned, file = with_photo(cleaned)
    words, remarks = correct_spelling(smoothed(with_likenesses(in_order(without_owners(split(cleaned))))))
    before = _understand_previous(previous)
    try:
        ops, phrases, reader = _read(words, before, cleaned, previous is not None)
    except Refusal as refusal:
        again, told = correct_spelling(words, freely=True)
        if refusal.verdict != "not_understood" or refusal.firm or not told:
            raise
        try:
            ops, phrases, reader = _read(again, before, cleaned, previous is not None)
        except Refusal:
            raise refusal from None
        remarks = (*remarks, *told)
    ops = _without_repeats(_complete_halves(ops))
    ops = [{**op, "reference": file} if file and op.get("reference") else op for op in ops]
    if len(ops) > MAX_OPS:
        raise Refusal(f"that is more than {MAX_OPS} steps; say it in parts")
    return _Outcome(
        tuple(_merge_copies(ops)),
        phrases.antecedent,
        tuple(phrases.before),
        remarks,
        phrases.colors,
        not reader.restated,
    )


def _read(words: Sequence[Word], before: _Outcome, cleaned: str, follows: bool) -> tuple[list[Fields], Phrases, Reader]:
    """The operations of an instruction, what its words may refer to afterwards, and how it was read.

    Raises:
        Refusal: any part of it is not understood, or none of it is an edit.
    """
    phrases = Phrases(before.antecedent, before.again, before.colors)
    reader = Reader(phrases, cleaned, follows)
    return reader.read(words), phrases, reader


def _lit(cleaned: str, previous: str | None) -> list[Part] | None:
    """The parts of an instruction that says something of light, None for others."""
    before = _understand_previous(previous)
    lit = bool(before.ops) and before.ops[-1]["op"] == "relight"
    return parts_of(cleaned, lit, previous is None, _thing)


def _thing(phrase: str) -> Query | None:
    """What a phrase for things means, None if it is not understood."""
    with suppress(Refusal, UserError):
        ops = _timeless(f"select {phrase}", None).ops
        if len(ops) == 1:
            target: Query = ops[0]["target"]
            return target
    return None


def _with_light(parts: Sequence[Part], previous: str | None) -> _Outcome:
    """An instruction of which some parts are about light.

    Raises:
        Refusal: as `_understand`, of the other parts.
    """
    outcome, before = _Outcome((), ""), previous
    ops: list[dict[str, Any]] = []
    for part in parts:
        if part.fields is not None:
            ops.append({"op": "relight", "target": part.target, **part.fields})
            outcome = replace(outcome, antecedent=part.target.text, colors=())
        else:
            try:
                found = _understand(part.text, before)
            except Refusal as refusal:
                if refusal.verdict == "not_an_edit" and str(refusal) == STATEMENT:
                    continue  # "We have guests. Make it cosy in here."
                if refusal.verdict in ("not_understood", "not_an_edit") and asks_nothing(part.text):
                    continue
                raise
            ops += found.ops
            outcome = replace(found, remarks=(*outcome.remarks, *found.remarks), plainly=outcome.plainly)
        before = part.text
    return replace(outcome, ops=tuple(ops), again=tuple(ops[-1:]))


def _with_holes(said: Heard, previous: str | None) -> _Outcome:
    """An instruction that says to fill holes, or to leave what it reveals as it is.

    Raises:
        Refusal: as `_understand`.
    """
    rest, holes = said.rest, said.requests
    outcome = _understand(rest, previous) if rest or not holes else _understand_previous(previous)
    ops = list(outcome.ops) if rest else []
    if said.anyway and not any(op["op"] in _REVEALING for op in ops):
        raise Refusal("nothing is taken away there that would leave a hole", "fill")
    if said.leave:
        ops = [{**op, "infill": False} if op["op"] in _REVEALING else op for op in ops]
    for hole in holes:
        if not hole.what:
            ops.append({"op": "infill", "target": Query(text="everything", pick="all")})
            continue
        surface = _understand(f"select {hole.what}", rest or previous)
        for op in surface.ops:
            target: Query = op["target"]
            if hole.where == "in" and target.pick == "one" and not target.relations:
                target = target.model_copy(update={"pick": "all"})  # a room has several walls
            ops.append({"op": "infill", "target": target, **({} if hole.where == "in" else {"where": hole.where})})
    return replace(outcome, ops=tuple(ops), again=tuple(ops[-1:]))


def _with_shadows(said: ShadowsHeard, previous: str | None) -> _Outcome:
    """An instruction that says something of shadows, or that what it puts somewhere stays as it is.

    Raises:
        Refusal: as `_understand`.
    """
    ops, outcome, before = list[Fields](), _understand_previous(previous), previous
    for part in said.parts:
        if isinstance(part, str):
            outcome = _understand(part, before)
            ops += [{**op, "harmony": False} if said.as_is and op["op"] in _FITTED else op for op in outcome.ops]
            before = part
            continue
        outcome = _understand(f"select {part.what}", before)
        ops += [{"op": "shadow", "target": op["target"], "change": part.change} for op in outcome.ops]
        before = f"select {part.what}" if part.what not in ("it", "them") else before
    return replace(outcome, ops=tuple(ops), again=tuple(ops[-1:]))


def _understand_previous(previous: str | None) -> _Outcome:
    """The outcome of the previous instruction, empty if there is none or it is not understood."""
    if previous:
        with suppress(Refusal, UserError):
            return _understand(clean(previous), None)
    return _Outcome((), "")


# ---- combining the operations of several clauses ----


def _complete_halves(ops: Sequence[Fields]) -> list[Fields]:
    """Combine clauses that need the next clause: "keep the sofa (and delete the rest)", "take the cup (and put …)".

    Raises:
        Refusal: the next clause is missing.
    """
    settled: list[Fields] = []
    taken: Query | None = None
    kept: Query | None = None
    for i, op in enumerate(ops):
        held, fields = op.get("held"), {k: v for k, v in op.items() if k != "held"}
        after = ops[i + 1].get("target") if i + 1 < len(ops) else None
        if held == "kept" and settled and after is None and _is_the_rest(op["target"]):
            continue  # "paint it red, keep the rest as it is"
        if held == "kept" and settled and after is None and _is_among(op["target"], settled[-1].get("target")):
            settled[-1] = _without(settled[-1], op["target"])  # "delete the lamps, but keep the white one"
            continue
        if held == "kept" and after is None:
            raise Refusal("it says what to keep, and asks for no change", "keep", verdict="not_an_edit")
        if held == "kept" and not _leaves_it_out(after):
            if _is_among(op["target"], after):
                ops = [*ops[: i + 1], _without(ops[i + 1], op["target"]), *ops[i + 2 :]]
            continue  # "leave the bed, move the desk"
        if op["op"] == "isolate" and settled and settled[-1]["op"] == "delete" and settled[-1]["target"].pick == "all":
            settled[-1] = _without(settled[-1], op["target"])  # "take everything off the desk, leave only the lamp"
            continue
        alone = op["op"] == "isolate" and after is not None and _is_all_else(after)
        if held == "kept" or alone:
            kept = op["target"]  # "just keep the sofa and remove everything else"
            continue
        if held == "taken off" and after != Query(last=True):
            fields = {"op": "delete", "target": op["target"]}  # "take the picture off the wall"
        elif held in ("taken", "taken off"):
            if after != Query(last=True):
                raise Refusal("say where to, or take it away", "take")
            taken = op["target"]
            continue
        if kept is not None:
            fields, kept = {**fields, "target": naming_last(fields["target"], kept)}, None
        if taken is not None:
            fields, taken = {**fields, "target": taken}, None
        settled.append(fields)
    return settled


def _is_among(kept: Query, target: Query | None) -> bool:
    """Whether what shall stay is one of the things that a target means: "the white one" of "the lamps"."""
    if target is None or target.pick not in ("all", "rest") or len(target.exclude) >= 4:
        return False
    return kept.text == target.text or target.text in ("", "everything")


def _without(op: Fields, kept: Query) -> Fields:
    target: Query = op["target"]
    return {**op, "target": target.model_copy(update={"exclude": (*target.exclude, kept), "count": None})}


def _leaves_it_out(query: Query | None) -> bool:
    """Whether a target leaves out what was named before it: "the others", "everything on the desk but that"."""
    return query is not None and any(Query(last=True) in q.exclude for q in (query, *query.also))


def _is_all_else(query: Query) -> bool:
    """Whether a target is all that was not named before it, wherever it is."""
    plain = query.pick == "all" and query.text in ("", "everything") and not (query.relations or query.colors)
    return plain and Query(last=True) in query.exclude and query.region is None


def naming_last(query: Query, meant: Query) -> Query:
    """A query with what "it" means in it named; "the other one" need not have the colours of what it leaves out."""
    alike = query.text == meant.text and query.colors == meant.colors and Query(last=True) in query.exclude
    query = query.model_copy(update={"colors": ()}) if alike else query
    return with_queries(query, lambda q: meant if q == Query(last=True) else q)


def _is_the_rest(kept: Query) -> bool:
    return kept.pick == "rest" or kept.text in _REST or Query(last=True) in kept.exclude


def _without_repeats(ops: Sequence[Fields]) -> list[Fields]:
    """Drop deletions of what was just deleted: "we don't need the basin any more, delete it"."""
    again = {"op": "delete", "target": Query(last=True)}
    return [op for i, op in enumerate(ops) if not (i and op == again and ops[i - 1]["op"] == "delete")]


def _merge_copies(ops: Sequence[Fields]) -> list[Fields]:
    """Merge a copy and its move: "copy the chair and put it next to the desk" is one copy that is placed there. A side
    of the original itself is the direction of a row: "copy the chair and put the copy to the right of it"."""
    merged: list[Fields] = []
    for op in ops:
        before = merged[-1] if merged else {}
        bare = before.get("op") == "duplicate" and not {"place", "direction"} & before.keys()
        if bare and op["op"] == "move" and _is_the_copy(op["target"], before["target"]) and "toward" not in op:
            merged[-1] = {**before, **{k: v for k, v in op.items() if k not in ("op", "target")}}
        elif _places_new(before, op):
            merged[-1] = {**before, "place": op["place"]}  # "a table is needed, next to the bed"
        else:
            merged.append(op)
    return [_in_a_row(op) if op["op"] == "duplicate" else op for op in merged]


def _places_new(before: Fields, op: Fields) -> bool:
    """Whether a move only says where what was just added stands."""
    bare = before.get("op") == "insert" and before.get("place") is None
    return bare and op["op"] == "move" and set(op) == {"op", "target", "place"} and op["target"] == Query(last=True)


def _is_the_copy(moved: Query, original: Query) -> bool:
    """Whether a query means the copy of what was just copied: "it", "the copy", "the second one"."""
    second = moved.pick == "nth" and moved.ordinal == 2 and moved.text == original.text
    return moved.last or second or (moved.text in _COPIES and not (moved.colors or moved.relations))


def _in_a_row(op: Fields) -> Fields:
    """A copy that is placed at a side of its own original: along the direction of that side, or beside it."""
    place = op.get("place")
    if not isinstance(place, dict) or place.get("relation") not in _SIDES:
        return op
    relation, anchors = place["relation"], list(place.get("anchors", ()))
    if len(anchors) != 1 or not _is_original(anchors[0], op["target"]):
        return op
    way = _SIDES[relation]
    return {**{k: v for k, v in op.items() if k != "place"}, **({"direction": way} if way else {})}


def _is_original(anchor: Any, target: Query) -> bool:
    said = anchor if isinstance(anchor, Query) else Query.model_validate(anchor)
    return said.last or said == target or said.text in _ORIGINALS

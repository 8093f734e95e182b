"""Reads an instruction: each sentence as it stands, else as the plainer sentences that it may stand for.

A sentence that the grammar does not understand, or takes for a statement or a question, is restated
(`restating/restating.py`); a restatement counts only if the whole of it is understood. Reading is cut off after a fixed
number of tries, so that no text takes long.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

from ...gaussians.language.query.query import Query
from .meaning.changes import Fields, with_parts
from .meaning.commands import operations_of
from .meaning.phrases import Phrases
from .parsing import Refusal, first_words, parse, trees
from .restating.changes.impossible import cannot_be
from .restating.order.conditions import has_condition
from .restating.order.elision import about, topic_of
from .restating.speech.corrections import corrected, takes_back
from .restating.speech.remarks import is_remark, says_how_far, subject_of
from .tagging.non_edits import FORBIDDEN, STATEMENT, empty_refusal, is_chat, refuse_non_edit
from .tagging.tagger import clauses
from .tagging.tags import Clause, Tag, sentences
from .tagging.words import Word
from .vocabulary import lexicon

_MOST_TRIES = 90
_DEEPEST = 3
_MOST_READINGS = 6  # of what was taken back


@dataclass
class _State:
    """What was understood so far.

    Attributes:
        ops: the operations, as fields.
        said: the parts that ask for no change.
        topic: what the last of them was about.
        stated_first: whether it came before any operation.
        antecedent, before, colors: of `Phrases`.
    """

    ops: list[Fields] = field(default_factory=list)
    said: tuple[Refusal, ...] = ()
    topic: Query | None = None
    stated_first: bool = False
    antecedent: str = ""
    before: tuple[Fields, ...] = ()
    colors: tuple[str, ...] = ()


class Reader:
    """Reads the sentences of one instruction.

    Args:
        phrases: what words may refer to from the instruction before.
        cleaned: the instruction, for quotes.
        follows: whether there was an instruction before.
    """

    def __init__(self, phrases: Phrases, cleaned: str, follows: bool) -> None:
        self.phrases = phrases
        self._cleaned = cleaned
        self._follows = follows
        self._state = _State(antecedent=phrases.antecedent, before=tuple(phrases.before), colors=phrases.colors)
        self._tries = 0
        self.restated = False  # whether any sentence was read in other words than its own

    def read(self, words: Sequence[Word]) -> list[Fields]:
        """The operations of an instruction, as fields; none is only half done.

        Raises:
            Refusal: any part of it is not understood, or none of it is an edit.
        """
        parts = list(sentences(words))
        while self._follows and len(parts) > 1 and _takes_back(parts[0][0]):
            parts = parts[1:]  # "No, wait. Next to the bed."
        for sentence, mark in _with_topics(_with_corrections(parts)):
            self._sentence(sentence, mark, 0)
        return self._settled(words)

    def _settled(self, words: Sequence[Word]) -> list[Fields]:
        """The operations, with what statements and prohibitions add to them."""
        ops, said, topic = list(self._state.ops), self._serious(), self._state.topic
        non_edit = (said or self._state.said or (None,))[0]
        if non_edit and ops and str(non_edit) == STATEMENT and self._state.stated_first:
            non_edit = None  # "I love the sofa. Delete the rug."
            if topic is not None and ops[0].get("target") == Query(last=True):
                ops[0] = {**ops[0], "target": topic}
        if non_edit and ops and all(r.remark for r in said):
            non_edit = None  # "Lose the flip chart. It's ancient."
        if non_edit and ops and str(non_edit) == FORBIDDEN and topic is not None:
            if ops[0].get("target") == Query(last=True):
                ops, non_edit = [{**ops[0], "target": topic}, *ops[1:]], None  # "don't delete the sofa, move it left"
            else:
                ops = [with_last(ops[0], topic), *ops[1:]]
                ops, non_edit = [_excluding(op, topic) for op in ops], None  # "don't touch the sofa, remove everything"
        if not ops:
            raise non_edit or empty_refusal(words)
        if non_edit and not is_chat(non_edit):
            raise Refusal(f"this part is not an edit, so nothing was planned: {non_edit}", *non_edit.words)
        return ops

    def _serious(self) -> tuple[Refusal, ...]:
        return tuple(r for r in self._state.said if not is_chat(r))

    def _sentence(self, sentence: Sequence[Word], mark: str, depth: int) -> None:
        """Read one sentence as it stands, or restated.

        Raises:
            Refusal: neither is understood.
        """
        if has_condition([w.text for w in sentence]):
            raise Refusal("conditions are not checked; say what to do without one", sentence[0].text, firm=True)
        before = self._saved()
        if (taken_back := list(corrected(" ".join(w.text for w in sentence)))) and depth < _DEEPEST:
            return self._corrected(taken_back, sentence, depth)
        refusal: Refusal | None = None
        try:
            self._plain(sentence, mark)
        except Refusal as error:
            refusal = error
        after = self._saved()
        new = len(self._serious()) - sum(not is_chat(r) for r in before.said)
        done = len(after.ops) > len(before.ops)
        said = [r for r in after.said[len(before.said) :] if not is_chat(r)]
        remarked = done and all(r.remark for r in said) and not says_how_far([w.text for w in sentence])
        if refusal is None and (not new or remarked):
            return
        final = refusal if refusal is not None and refusal.firm else None
        if final is None and depth < _DEEPEST:
            found = self._restated(sentence, mark, depth, before, new if refusal is None else None)
            if found is True:
                return
            final = found or None
        self._restore(after if refusal is None else before)
        told = final or refusal
        if told is None:
            return
        if not told.firm and (reason := cannot_be([w.text for w in sentence])):
            raise Refusal(reason, sentence[0].text, verdict="impossible")
        if told.verdict == "not_understood" and depth <= 1 and is_remark([w.text for w in sentence]):
            return self._remark(sentence)
        raise told

    def _remark(self, sentence: Sequence[Word]) -> None:
        """Keep a sentence that only says how things are apart; "it" may mean what it is about."""
        state = self._state
        said = Refusal(STATEMENT, sentence[0].text, verdict="not_an_edit")
        said.remark = True
        state.said = (*state.said, said)
        state.stated_first = not state.ops
        state.topic = self._name([w.text for w in sentence]) or state.topic

    def _corrected(self, readings: Sequence[str], sentence: Sequence[Word], depth: int) -> None:
        """Read a sentence that takes back part of what it says.

        Raises:
            Refusal: it cannot be told which part.
        """
        before = self._saved()
        final: Refusal | None = None
        for reading in filter(None, readings[:_MOST_READINGS]):
            self._restore(before)
            try:
                for part, mark in sentences(_spanning(reading.split(), sentence)):
                    self._sentence(part, mark, depth + 1)
            except Refusal as error:
                final = final or (error if error.firm else None)
                continue
            if len(self._state.ops) > len(before.ops):
                self.restated = True
                return
        self._restore(before)
        told = "it takes back what it said before; say only what to do"
        raise final or Refusal(told, sentence[0].text)

    def _restated(
        self, sentence: Sequence[Word], mark: str, depth: int, before: _State, stated: int | None
    ) -> bool | Refusal:
        """Whether a restatement was understood; the refusal of one that was understood and cannot be done.

        Args:
            stated: how many parts of the sentence as it stands ask for no change; None if it is not understood.
        """
        final: bool | Refusal = False
        follows = self._follows or bool(before.ops)
        plain = len(self._state.ops)
        from .restating.restating import restatements

        for candidate in restatements([w.text for w in sentence], mark, follows):
            if self._tries >= _MOST_TRIES:
                break
            self._tries += 1
            self._restore(before)
            try:
                for part, _ in sentences(_spanning(candidate, sentence)):
                    self._sentence(part, "", depth + 1)
            except Refusal as error:
                final = final or (error if error.firm else False)
                continue
            new = len(self._serious()) - sum(not is_chat(r) for r in before.said)
            done = len(self._state.ops) > len(before.ops)
            gained = new < (stated or 0) or len(self._state.ops) > plain
            if (done and gained) or (stated is None and (done or not new)):
                self.restated = True
                return True
        return final

    def _plain(self, sentence: Sequence[Word], mark: str) -> None:
        """Read a sentence as it stands; parts that ask for no change are kept apart."""
        state = self._state
        for clause in clauses(sentence):
            follows = bool(state.ops) or self._follows or state.topic is not None
            try:
                found = self._clause(clause, sentence, mark, follows)
            except Refusal as refusal:
                if refusal.verdict != "not_an_edit" or (self._serious() and not is_chat(refusal)):
                    raise
                words = [w.text for t in clause.tags for w in t.words]
                refusal.remark = is_remark(words)
                state.said = (*state.said, refusal)
                state.stated_first = not state.ops
                topic, named = _topic(clause, refusal), self._name(words)
                state.topic = named if refusal.remark and named is not None else topic
                if (clause.negated or named is None) and state.topic is not None and state.topic.text:
                    self.phrases.antecedent, self.phrases.colors = state.topic.text, ()
                continue
            state.ops = [*state.ops, *found]

    def _clause(self, clause: Clause, sentence: Sequence[Word], mark: str, follows: bool) -> list[dict[str, Any]]:
        """The operations of one clause, as fields; refusals quote the clause."""
        refuse_non_edit(clause, sentence, mark)
        try:
            if clause.unsupported:
                raise Refusal(clause.unsupported, clause.tags[0].text, verdict="impossible")
            tree = parse(clause)
            if not follows and any(t.data in ("it_becomes", "it_moves") for t in trees(tree)):
                raise Refusal("it does not say what to do, or to what", *first_words(clause))
            return with_parts(operations_of(self.phrases, tree), [t.text for t in clause.tags])
        except Refusal as refusal:
            said = f"“{_quote(clause, self._cleaned)}”: {refusal}"
            raise Refusal(said, *refusal.words, verdict=refusal.verdict, firm=refusal.firm) from None

    def _name(self, said: Sequence[str]) -> Query | None:
        """What a statement is about, kept for "the middle one" behind "there are three guitars"; None if it cannot be
        told."""
        about_it = subject_of(said)
        if about_it is None:
            return None
        with suppress(Refusal):
            spoken = clauses(_spanning(("select", *about_it), (Word("", 0, 0),)))
            phrases = Phrases()
            (op,) = operations_of(phrases, parse(spoken[0]))
            self.phrases.antecedent, self.phrases.colors = phrases.antecedent, ()
            meant: Query = op["target"]
            return meant
        return None

    def _saved(self) -> _State:
        phrases = self.phrases
        return replace(self._state, antecedent=phrases.antecedent, before=tuple(phrases.before), colors=phrases.colors)

    def _restore(self, state: _State) -> None:
        self._state = replace(state)
        self.phrases.antecedent, self.phrases.before, self.phrases.colors = (
            state.antecedent,
            [*state.before],
            state.colors,
        )


def _takes_back(sentence: Sequence[Word]) -> bool:
    """Whether a sentence only takes back the instruction before."""
    return tuple(w.text for w in sentence if w.text != ",") in lexicon.RETRACTIONS


def _spanning(texts: Sequence[str], sentence: Sequence[Word]) -> tuple[Word, ...]:
    """Words of a restatement, each with the place of the whole sentence, which refusals then quote."""
    start, end = sentence[0].start, max(w.end for w in sentence)
    return tuple(Word(text, start, end) for text in texts)


def _with_corrections(parts: list[tuple[tuple[Word, ...], str]]) -> list[tuple[tuple[Word, ...], str]]:
    """The sentences, those that take back the one before joined to it: "Delete the lamp. No, wait, the vase."."""
    found: list[tuple[tuple[Word, ...], str]] = []
    for sentence, mark in parts:
        if found and takes_back([w.text for w in sentence]):
            before, _ = found.pop()
            comma = Word(",", sentence[0].start, sentence[0].start)
            sentence = (*before, comma, *sentence)
        found.append((sentence, mark))
    return found


def _with_topics(parts: list[tuple[tuple[Word, ...], str]]) -> list[tuple[tuple[Word, ...], str]]:
    """The sentences, those that only name a thing joined to the next: "The bookcase. Slide it to the left."."""
    found: list[tuple[tuple[Word, ...], str]] = []
    i = 0
    while i < len(parts):
        sentence, mark = parts[i]
        if i + 2 < len(parts) and is_remark([w.text for w in parts[i + 1][0]]):
            parts[i], parts[i + 1] = parts[i + 1], parts[i]  # "The rug. I hate beige. Make it teal."
            sentence, mark = parts[i]
        if i + 1 < len(parts) and (topic := topic_of([w.text for w in sentence])) is not None:
            behind, last = parts[i + 1]
            joined = next(about(topic, [w.text for w in behind]), None)
            if joined is not None:
                found.append((_spanning(joined, (*sentence, *behind)), last))
                i += 2
                continue
        found.append((sentence, mark))
        i += 1
    return found


def with_last(op: Fields, meant: Query) -> Fields:
    """An operation whose target leaves out, or is, what was spoken of before: "don't touch A, delete the other one"."""
    target = op.get("target")
    if target is None or Query(last=True) not in target.exclude:
        return op
    rest = tuple(meant if q == Query(last=True) else q for q in target.exclude)
    text = target.text or meant.text
    colors = () if target.colors == meant.colors else target.colors
    return {**op, "target": target.model_copy(update={"exclude": rest, "text": text, "colors": colors})}


def _excluding(op: Fields, spared: Query) -> Fields:
    """An operation on all things of a kind, with the things that must not be touched excluded."""
    target = op.get("target")
    if target is None or target.pick != "all" or len(target.exclude) >= 4:
        return op
    return {**op, "target": target.model_copy(update={"exclude": (*target.exclude, spared)})}


def _topic(clause: Clause, non_edit: Refusal) -> Query | None:
    """The query for what a statement or prohibition is about ("the sofa is ugly, delete it"); None if there is none."""
    if str(non_edit) not in (STATEMENT, FORBIDDEN):
        return None
    first = next((i for i, t in enumerate(clause.tags) if t.type == "DET"), None)
    if first is None:
        return None
    for end in range(len(clause.tags), first + 1, -1):
        said = clause.tags[first:end]
        with suppress(Refusal):
            (op,) = operations_of(Phrases(), parse(Clause([Tag("SELECT", None, said[0].words), *said], "SELECT")))
            query: Query = op["target"]
            return query.model_copy(update={"pick": "one"}) if query.pick == "any" else query
    return None


def _quote(clause: Clause, cleaned: str) -> str:
    words = [w for t in clause.tags for w in t.words]
    quoted = cleaned[words[0].start : words[-1].end] if words else cleaned
    return quoted if len(quoted) <= 80 else quoted[:79] + "…"

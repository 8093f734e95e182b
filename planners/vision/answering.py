"""Answer a question from rendered pictures: choose views, ask a vision model, show what it asks for, vote, and stop.

The loop ends when the model is sure, or when the views, seconds, tokens or dollars of the budget are spent. "I cannot
tell from these views" is an answer. What geometry measured goes along as data, and contradictions to it are told.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from ... import prompts
from ...tools.alternatives import NOT_GIVEN, either, given
from ..budget import Ledger, OverBudgetError, Progress
from ..model.backend import Message, ModelBackend, UnreachableError
from ..model.prompt.examples import quoted
from ..model.prompt.labels import plain
from ..model.prompt.pruning import tokens
from ..model.verify.json_reply import ReplyError, printable
from ..questions.answer import Answer, AnswerType, Evidence
from .asking import (
    PICTURE_TOKENS,
    REPLY_TOKENS,
    NoReplyError,
    Purse,
    Wanted,
    ask,
    described,
    fitting,
    require_sight,
    schema,
    shown_marks,
)
from .facts import Facts, same
from .looker import Looker, Shown

SURE = 0.75  # confidence from which an answer stands without another look; see `Terms.sure`
MAX_CHARS = 1000  # of a question
_ROUNDS = 6  # requests for more pictures in one sample, whatever the budget
_FACTS_TOKENS = 3000
_FEW_FACTS = "#1: a thing, " * 60  # facts that have their place even where the window is small
_LABEL, _REASON, _ANSWER = 80, 300, 400  # characters
_MARK = re.compile(r"#(\d{1,6})\b")
_WANTED = {
    "yesno": 'The answer is "yes" or "no" (answer_type "yesno").',
    "number": 'The answer is a count (answer_type "number").',
    "metres": 'The answer is a length in metres (answer_type "metres").',
    "label": 'The answer is one short label (answer_type "label").',
    "list": 'The answer is a list of labels (answer_type "list").',
    "text": 'The answer is a sentence (answer_type "text").',
}

Word = Annotated[str, Field(min_length=1, max_length=_LABEL, strict=True)]
Number = Annotated[int, Field(ge=0, le=10**6, strict=True)]


_SILENT = {"cannot_tell": {"maxLength": 0}}
_LENGTH = {"type": "number", "minimum": 0, "maximum": 1e5}
# What goes together in a reply, by answer_type; "" and "more" are those of replies without an answer.
_ALTERNATIVES: dict[str, dict[str, Any]] = {
    "yesno": {"answer_type": given(enum=["yesno"]), "answer": given(enum=["yes", "no"]), **_SILENT},
    "number": {"answer_type": given(enum=["number"]), "answer": given(**_LENGTH), **_SILENT},
    "metres": {"answer_type": given(enum=["metres"]), "answer": given(**_LENGTH), **_SILENT},
    "label": {
        "answer_type": given(enum=["label"]),
        "answer": given(type="string", minLength=1, maxLength=_LABEL),
        **_SILENT,
    },
    "list": {
        "answer_type": given(enum=["list"]),
        "answer": given(type="array", items={"type": "string", "minLength": 1, "maxLength": _LABEL}, maxItems=24),
        **_SILENT,
    },
    "text": {
        "answer_type": given(enum=["text"]),
        "answer": given(type="string", minLength=1, maxLength=_ANSWER),
        **_SILENT,
    },
    "": {"answer": NOT_GIVEN, "cannot_tell": given(type="string", minLength=1, maxLength=_REASON)},
    "more": {"answer": NOT_GIVEN, "need_more": given(minItems=1)},
}


class SeenReply(BaseModel):
    """What a vision model answers to a question; the prompt `vision_ask` explains the fields."""

    model_config = ConfigDict(frozen=True, extra="forbid", json_schema_extra=either(*_ALTERNATIVES.values()))

    because: Annotated[str, Field(max_length=_REASON, strict=True)] = ""
    answer: (
        Annotated[float, Field(ge=-1e5, le=1e5, allow_inf_nan=False, strict=True)]
        | Annotated[str, Field(min_length=1, max_length=_ANSWER, strict=True)]
        | Annotated[tuple[Word, ...], Field(max_length=24)]
        | None
    ) = None
    answer_type: AnswerType
    confidence: Annotated[float, Field(ge=0, le=1, allow_inf_nan=False, strict=True)]
    evidence_views: Annotated[tuple[Number, ...], Field(max_length=16)] = ()
    things: Annotated[tuple[Number, ...], Field(max_length=24)] = ()
    need_more: Annotated[tuple[Word, ...], Field(max_length=4)] = ()
    cannot_tell: Annotated[str, Field(max_length=_REASON, strict=True)] = ""

    @model_validator(mode="before")
    @classmethod
    def _yes_or_no(cls, given: Any) -> Any:
        """ "Yes." is as good as "yes"."""
        if isinstance(given, dict) and given.get("answer_type") == "yesno" and isinstance(given.get("answer"), str):
            return {**given, "answer": given["answer"].strip().rstrip(".").lower()}
        return given

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if self.answer is None:
            if not self.cannot_tell.strip() and not self.need_more:
                raise ValueError("without an answer, say in cannot_tell why, or ask for pictures in need_more")
            return self
        if self.cannot_tell:
            raise ValueError("give either an answer or cannot_tell")
        value, kind = self.answer, self.answer_type
        fits = {
            "yesno": value in ("yes", "no"),
            "number": isinstance(value, float) and value >= 0,
            "metres": isinstance(value, float) and value >= 0,
            "label": isinstance(value, str) and len(value) <= _LABEL,
            "list": isinstance(value, tuple),
            "text": isinstance(value, str),
        }
        if not fits[kind]:
            raise ValueError(f'the answer does not fit answer_type "{kind}"')
        return self


@dataclass(frozen=True)
class Terms:
    """How a question is asked.

    Attributes:
        answer_type: the type that the question asks for; None leaves it to the model.
        groups: ids of the groups that the question names; the first pictures show them. Empty: the whole scene.
        first: pictures of the first request.
        marks: whether numbers are drawn on things.
        sure: confidence from which an answer stands without another look, unless something speaks against it.
        samples: most conversations, each with other pictures where there are any; their answers are voted on.
        ledger: budget and spending of the session; a budget of its own where there is none.
        progress: called while the model is waited for.
    """

    answer_type: AnswerType | None = None
    groups: tuple[int, ...] = ()
    first: int = 3
    marks: bool = True
    sure: float = SURE
    samples: int = 3
    ledger: Ledger | None = field(default=None, compare=False)
    progress: Progress | None = field(default=None, compare=False)


@dataclass(frozen=True)
class Sample:
    """The reply of one conversation.

    Attributes:
        reply: the last one.
        shown: the pictures that it was given.
        against: sentences that say what speaks against its answer: measured facts, or references to nothing.
    """

    reply: SeenReply
    shown: tuple[Shown, ...]
    against: tuple[str, ...] = ()

    @property
    def confidence(self) -> float:
        """The model's estimate, halved if something speaks against the answer."""
        return self.reply.confidence / 2 if self.against else self.reply.confidence


def ask_about(text: str, facts: Facts, looker: Looker, backend: ModelBackend, terms: Terms | None = None) -> Answer:
    """The answer to a question from pictures.

    Without a usable reply the answer is None, its source "none", and its text says why.

    Args:
        text: the question.
        facts: what geometry measured.
        looker: renders the pictures.
        backend: a model that reads pictures.

    Raises:
        BackendError: the model reads no pictures, cannot be reached, or the session's budget was used up before.
    """
    terms = terms or Terms()
    require_sight(backend)
    purse = Purse(terms.ledger, terms.progress)
    purse.require()
    loop = _Loop(printable(text, MAX_CHARS), facts, looker, backend, terms, purse)
    stopped = ""
    samples: list[Sample] = []
    for turn in range(max(terms.samples, 1)):
        try:
            sample = loop.sample(turn)
        except (OverBudgetError, NoReplyError) as error:
            stopped = str(error)
            break
        except UnreachableError as error:
            if not samples and loop.last is None:
                raise
            stopped = str(error)
            break
        if sample is None:
            break
        samples.append(sample)
        if sample.confidence >= terms.sure:
            break
    if loop.last is not None and loop.last not in samples:
        samples.append(loop.last)
    if not samples:
        return _nothing(stopped or "there is no picture to look at", terms, purse)
    return loop.result(samples, stopped)


class _Loop:
    """The conversations about one question.

    Attributes:
        last: the newest reply, also of a conversation that was cut short.
    """

    def __init__(
        self, question: str, facts: Facts, looker: Looker, backend: ModelBackend, terms: Terms, purse: Purse
    ) -> None:
        self._question, self._facts, self._looker, self._backend = question, facts, looker, backend
        self._terms, self._purse = terms, purse
        self._rendered: dict[str, Shown] = {}
        self._met: dict[str, Shown] = {}  # by request
        self._begun: set[tuple[str, ...]] = set()  # names of the pictures that conversations began with
        self.last: Sample | None = None

    def sample(self, turn: int) -> Sample | None:
        """One conversation: ask, show what is asked for, and ask again; None if nothing new can be shown.

        Raises:
            NoReplyError, UnreachableError, OverBudgetError: as `asking.ask`.
        """
        shown, asked = self._first(turn), set[str]()
        missing: tuple[str, ...] = ()
        if not shown:
            return None
        for _ in range(_ROUNDS):
            sample = self._ask(shown, missing)
            self.last = sample
            wanted = [one for one in dict.fromkeys(sample.reply.need_more) if one not in asked]
            if sample.reply.confidence >= self._terms.sure and sample.reply.answer is not None:
                return sample
            if not wanted:
                return sample
            more, missing = self._look(wanted)
            asked.update(one for one in wanted if one != "overview" or one in missing)  # there may be another overview
            shown = _fitting((*shown, *(one for one in more if one not in shown)), self._most)
        return sample

    @property
    def _most(self) -> int:
        """Pictures that fit the model's window beside the prompt."""
        return fitting(self._backend, prompts.load("vision_ask").text, self._question, _FEW_FACTS)

    def _first(self, turn: int) -> tuple[Shown, ...]:
        """The pictures that a conversation begins with; later ones begin with a new one, or with the same in another
        order; none if that has been tried."""
        if turn == 0:
            count = self._purse.take(min(self._terms.first, self._most))
            made = self._looker.overview(self._terms.groups, count, self._terms.marks) if count else ()
            chosen = made[:count]
        else:
            seen = tuple(self._rendered.values())
            fresh = self._next_overview()
            kept = tuple(reversed(seen)) if turn == 1 else (*seen[1:], *seen[:1])
            chosen = (*fresh, *kept[: max(self._most - len(fresh), 0)])
        self._rendered.update({one.name: one for one in chosen})
        names = tuple(one.name for one in chosen)
        if names in self._begun:
            return ()
        self._begun.add(names)
        return chosen

    def _next_overview(self) -> tuple[Shown, ...]:
        """Another picture of the whole; none if there is none, or the budget is spent."""
        made = self._looker.look("overview") if self._purse.views > 0 else None
        if made is None or made.name in self._rendered:
            return ()
        self._purse.take(1)
        return (made,)

    def _look(self, wanted: Sequence[str]) -> tuple[tuple[Shown, ...], tuple[str, ...]]:
        """The pictures that were asked for, and the requests that cannot be met or are over the budget."""
        shown: list[Shown] = []
        missing: list[str] = []
        for request in wanted:
            made = self._met.get(request)
            if made is None and self._purse.views > 0:
                made = self._looker.look(request)
            if made is None:
                missing.append(request)
                continue
            if made.name not in self._rendered:
                self._purse.take(1)
                self._rendered[made.name] = made
            if request != "overview":  # which is another one each time
                self._met[request] = made
            shown.append(made)
        return tuple(shown), tuple(missing)

    def _ask(self, shown: tuple[Shown, ...], missing: Sequence[str]) -> Sample:
        marks = shown_marks(shown)
        stage = f"asking {self._backend.name} about {len(shown)} picture{'s' if len(shown) != 1 else ''}"
        said = ask(
            self._backend,
            self._messages(shown, missing, marks),
            Wanted(
                SeenReply,
                lambda reply: self._check(reply, len(shown), marks),
                _schema(self._terms.answer_type, len(shown), marks),
            ),
            self._purse,
            stage,
        )
        value = _cleaned(said.reply.answer)
        against = self._facts.contradictions(self._question, value, said.reply.answer_type)
        if said.doubt and value is not None:
            against.append("The model refers to pictures or numbers that it was not shown.")
        return Sample(said.reply, shown, tuple(against))

    def _messages(self, shown: tuple[Shown, ...], missing: Sequence[str], marks: dict[int, int]) -> list[Message]:
        rules = prompts.load("vision_ask").text
        pictures = described(shown)
        used = tokens(rules) + tokens(pictures) + tokens(self._question) + 200 + PICTURE_TOKENS * len(shown)
        room = min(self._backend.window - REPLY_TOKENS - used, _FACTS_TOKENS)
        before = ""
        if missing:
            told = ", ".join(printable(one, 40) for one in missing)
            before = f"\nThese pictures cannot be shown: {told}. Answer with what there is."
        elif self._purse.views <= 0:
            before = "\nNo more pictures can be shown. Answer with what there is."
        kind = self._terms.answer_type
        request = prompts.load("vision_ask_request").fill(
            pictures=pictures,
            facts=self._facts.table(self._question, marks, max(room, 0)),
            before=before,
            wanted=_WANTED[kind] if kind else "Choose the answer_type that the question asks for.",
            question=quoted(self._question),
        )
        return [Message("system", rules), Message("user", request, tuple(one.png for one in shown))]

    def _check(self, reply: SeenReply, count: int, marks: dict[int, int]) -> str:
        """What the type of a reply cannot say.

        Raises:
            ReplyError: the answer is of the wrong type, or names what cannot be a name.
        """
        wanted = self._terms.answer_type
        if wanted is not None and reply.answer is not None and reply.answer_type != wanted:
            raise ReplyError(f'answer_type: the question asks for "{wanted}", not "{reply.answer_type}"')
        if reply.answer_type in ("label", "list"):
            names = reply.answer if isinstance(reply.answer, tuple) else (reply.answer,)
            if any(isinstance(name, str) and plain(name) is None for name in names):
                raise ReplyError("answer: a label is a short name such as 'floor lamp' or 'dark red'")
        if isinstance(reply.answer, str) and not printable(reply.answer, _ANSWER):
            raise ReplyError("answer: it is empty")
        faults = []
        if unknown := sorted(set(reply.evidence_views) - set(range(1, count + 1))):
            faults.append(f"evidence_views: there is no picture {unknown[0]}, pictures are 1 to {count}")
        mentioned = {int(found) for found in _MARK.findall(f"{reply.because} {reply.answer} {reply.cannot_tell}")}
        if unknown := sorted((set(reply.things) | mentioned) - set(marks)):
            there = ", ".join(f"#{mark}" for mark in sorted(marks)) or "none"
            faults.append(f"things: no picture shows the number {unknown[0]}; numbers are {there}")
        return "\n".join(faults)

    def result(self, samples: Sequence[Sample], stopped: str) -> Answer:
        """The answer that most samples give, weighted by their confidence."""
        answered = [sample for sample in samples if sample.reply.answer is not None]
        silent = [sample for sample in samples if sample.reply.answer is None]
        camps: list[list[Sample]] = []
        for sample in answered:
            for camp in camps:
                first = camp[0].reply
                if first.answer_type == sample.reply.answer_type and same(
                    first.answer, sample.reply.answer, first.answer_type
                ):
                    camp.append(sample)
                    break
            else:
                camps.append([sample])
        camps.sort(key=lambda camp: -_weight(camp))
        if not camps or _weight(silent) > _weight(camps[0]):
            return self._silent(max(silent, key=lambda sample: sample.confidence), stopped)
        total = _weight(answered) + _weight(silent)
        best = max(camps[0], key=lambda sample: sample.confidence)
        share = _weight(camps[0]) / total if total > 0 else 0.0
        return self._told(best, best.confidence * share, len(camps[0]), len(samples))

    def _told(self, sample: Sample, confidence: float, votes: int, of: int) -> Answer:
        reply, marks = sample.reply, shown_marks(sample.shown)
        value = _cleaned(reply.answer)
        voted = f" ({votes} of {of} looks agree.)" if of > 1 else ""
        ids = tuple(dict.fromkeys(marks[mark] for mark in reply.things if mark in marks))
        names = [sample.shown[n - 1].name for n in reply.evidence_views if 1 <= n <= len(sample.shown)]
        return Answer(
            answer=value,
            answer_type=reply.answer_type,
            text=" ".join([_sentence(value, reply) + voted, *sample.against]),
            confidence=round(confidence, 4),
            source="vlm",
            evidence=Evidence(ids=ids, views=tuple(dict.fromkeys(names))),
            unit="m" if reply.answer_type == "metres" else "",
            usage=self._purse.usage,
        )

    def _silent(self, sample: Sample, stopped: str) -> Answer:
        reply = sample.reply
        why = printable(reply.cannot_tell, _REASON) or stopped or "the pictures that it asked for cannot be shown"
        count = len(self._rendered)
        return Answer(
            answer=None,
            answer_type=self._terms.answer_type or reply.answer_type,
            text=f"I cannot tell from {count} view{'s' if count != 1 else ''}: {_ended(why)}",
            confidence=reply.confidence,
            source="none",
            evidence=Evidence(views=tuple(self._rendered)),
            usage=self._purse.usage,
        )


def _schema(answer_type: AnswerType | None, pictures: int, marks: Collection[int]) -> dict[str, Any]:
    """The schema of a reply, narrowed to a type of answer and to the pictures and marks that there are."""
    made = schema(SeenReply, evidence_views=range(1, pictures + 1), things=marks)
    if answer_type is not None:
        kept = (answer_type, "", "more")
        made["anyOf"] = [branch for name, branch in zip(_ALTERNATIVES, made["anyOf"], strict=True) if name in kept]
    return made


def _nothing(why: str, terms: Terms, purse: Purse) -> Answer:
    """The answer where no reply was usable."""
    return Answer(
        answer=None,
        answer_type=terms.answer_type or "text",
        text=f"I cannot tell: {_ended(why)}",
        confidence=0.0,
        source="none",
        usage=purse.usage,
    )


def _fitting(shown: tuple[Shown, ...], most: int) -> tuple[Shown, ...]:
    """At most so many pictures: the first, and the newest."""
    return shown if len(shown) <= most else (*shown[:1], *shown[len(shown) - most + 1 :])


def _weight(samples: Sequence[Sample]) -> float:
    return sum(sample.confidence for sample in samples)


def _cleaned(answer: float | str | tuple[str, ...] | None) -> float | str | tuple[str, ...] | None:
    """An answer without control characters; labels as they may be shown and kept."""
    if isinstance(answer, str):
        return printable(answer, _ANSWER)
    if isinstance(answer, tuple):
        return tuple(dict.fromkeys(printable(one, _LABEL) for one in answer))
    return answer


def _sentence(value: float | str | tuple[str, ...] | None, reply: SeenReply) -> str:
    because = printable(reply.because, _REASON)
    if reply.answer_type == "text":
        return _ended(str(value))
    if isinstance(value, float):
        told = f"{value:.2f} m" if reply.answer_type == "metres" else f"{value:g}"
    elif isinstance(value, tuple):
        told = ", ".join(value) or "nothing"
    else:
        told = str(value)
    told = told[:1].upper() + told[1:]
    return f"{told}: {_ended(because)}" if because else f"{told}."


def _ended(text: str) -> str:
    return text if text.endswith((".", "!", "?", "…")) else f"{text}."

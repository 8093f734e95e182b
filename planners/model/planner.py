"""The model planner: any instruction to a checked plan, by asking a language model and not believing it.

Knows the order of the work: ask, read, guard, ask again with what was wrong. Refuses to know how a model is reached
(`backend.py`) and what is wrong with a plan (`reply.py`, `guard.py`), and never hands on what did not pass every check.
"""

from __future__ import annotations

import time
import unicodedata
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field

from ...gaussians.errors import ScenewrightError, UserError
from ...tools.operation import EditOp
from ..plan import EditPlan, NoPlanError, Planner, Sight, Usage, Verdict
from .backend import Answer, Message, ModelBackend, UnreachableError
from .prompt.labels import cleaned
from .prompt.messages import Request, messages, prompt_hash, repaired
from .verify import reply
from .verify.guard import Fault, Guard

Progress = Callable[[str, float], None]  # stage in words, share done in [0, 1]

MAX_CHARS = 4000  # of an instruction
_REASON_CHARS = 400
_USUAL_ANSWER = 400  # characters; only to show how far an answer may be


class ModelPlanner:
    """Plans by asking a language model; stateless between instructions.

    Args:
        backend: the model.
        attempts: how often it may be asked about one instruction; later ones repair what was wrong.
        seconds: the longest that all of them may take together.
        pictures: whether to show it the viewer's picture, if it sees and there is one.
        progress: told that planning goes on whenever a piece of an answer arrives; without it answers are not
            streamed. The share is a guess, as nobody knows how long an answer will be.

    Raises:
        UserError: attempts or seconds allow no answer.
    """

    def __init__(
        self,
        backend: ModelBackend,
        *,
        attempts: int = 3,
        seconds: float = 60.0,
        pictures: bool = False,
        progress: Progress | None = None,
    ) -> None:
        if attempts < 1 or not seconds > 0:
            raise UserError(f"a model needs at least one attempt and some time, got {attempts} and {seconds:g} s")
        self.backend = backend
        self._attempts, self._seconds, self._pictures = attempts, seconds, pictures
        self._progress = progress

    @property
    def name(self) -> str:
        """The back end's name."""
        return self.backend.name

    def plan(self, text: str, *, previous: str | None = None, sight: Sight | None = None) -> EditPlan:
        """The plan for an instruction; see `Planner.plan`.

        A scene that cannot be looked at is left out of the prompt: whether that matters shows when the plan is carried
        out.

        Raises:
            UserError: the text is empty, no text, or too long to be an instruction.
            UnreachableError: the model cannot be reached, or not any more. (A NoPlanError.)
            NoPlanError: it gave no valid plan in all its attempts, or in the time it had. (A BackendError.)
        """
        _require_words(text)
        started = time.monotonic()
        request = self._request(text, previous, sight)
        guard = Guard(text, request.previous, request.graph, _grammar())
        asking = _Asking(self.backend, messages(request, self.backend.window), started + self._seconds, self._progress)
        said = _Said()
        for attempt in range(1, self._attempts + 1):
            answer = asking.once(attempt)
            if answer is None:
                break
            outcome = said.judged(answer, guard, last=attempt == self._attempts)
            if isinstance(outcome, _Outcome):
                return self._made(outcome, text, asking.usage, time.monotonic() - started)
            asking.again(answer.text, outcome)
        if said.standing is not None:
            return self._made(_Outcome("ok", said.standing[1]), text, asking.usage, time.monotonic() - started)
        raise self._nothing(said.wrong, asking)

    def _request(self, text: str, previous: str | None, sight: Sight | None) -> Request:
        """What the model is told; what are no names in the scene is left out here, before anything else sees it."""
        graph, picture = None, None
        if sight is not None:
            with suppress(ScenewrightError):
                graph = cleaned(sight.graph())
            with suppress(ScenewrightError):
                picture = sight.picture() if self._pictures and self.backend.sees else None
        before = (previous or "").encode(errors="replace").decode()[:MAX_CHARS]
        return Request(text, before or None, graph, picture)

    def _made(self, outcome: _Outcome, text: str, usage: Usage | None, seconds: float) -> EditPlan:
        return EditPlan(
            instruction=text,
            ops=outcome.ops,
            planner=self.name[:200],
            prompt_hash=prompt_hash(),
            verdict=outcome.verdict,
            reason=_plain(outcome.reason),
            unknown=tuple(filter(None, (_plain(word)[:200] for word in outcome.unknown))),
            seconds=seconds,
            usage=usage,
        )

    def _nothing(self, wrong: str, asking: _Asking) -> NoPlanError:
        asked = asking.usage.requests if asking.usage is not None else 0
        late = f" within {self._seconds:g} s (--budget gives it more)" if asking.late else ""
        last = f"; at last: {_plain(wrong)}" if wrong else ""
        told = f"{self.name} gave no valid plan in {asked} attempt(s){late}{last}"
        return NoPlanError(f"{told}. Say it more simply, or use another model", asking.usage)


@dataclass(frozen=True)
class _Outcome:
    """What an instruction comes to."""

    verdict: Verdict
    ops: tuple[EditOp, ...] = ()
    reason: str = ""
    unknown: tuple[str, ...] = ()


class _Asking:
    """One conversation with a model: what it was told, until when it may answer, and what that cost."""

    def __init__(
        self, backend: ModelBackend, first: tuple[Message, ...], deadline: float, progress: Progress | None
    ) -> None:
        self._backend, self._first, self._deadline, self._progress = backend, first, deadline, progress
        self._messages = first
        self.usage: Usage | None = None
        self.late = False

    def once(self, attempt: int) -> Answer | None:
        """The next answer; None if the time is up.

        Raises:
            UnreachableError: there was none.
        """
        left = self._deadline - time.monotonic()
        self.late = left <= 0
        if self.late:
            return None
        stage = f"planning with {self._backend.name}" + (f", attempt {attempt}" if attempt > 1 else "")
        heard = _Heard(self._progress, stage) if self._progress is not None else None
        try:
            answer = self._backend.answer(self._messages, reply.schema(), seconds=left, heard=heard)
        except UnreachableError as error:
            cost = _sum(self.usage, error.usage)  # the attempts before it were paid for
            raise UnreachableError(str(error), cost) from error
        if heard is not None:
            heard.done()
        self.usage = _sum(self.usage, answer.usage)
        return answer

    def again(self, answer: str, fault: str) -> None:
        """Say what was wrong with the last answer."""
        self._messages = repaired(self._first, answer, fault)


def _sum(before: Usage | None, after: Usage | None) -> Usage | None:
    return after if before is None else before if after is None else before.plus(after)


class _Heard:
    """Tells that an answer is coming in; how much of it is there is a guess."""

    def __init__(self, progress: Progress, stage: str) -> None:
        self._progress, self._stage, self._characters = progress, stage, 0
        progress(stage, 0.0)

    def __call__(self, piece: str) -> None:
        self._characters += len(piece)
        self._progress(self._stage, self._characters / (self._characters + _USUAL_ANSWER))

    def done(self) -> None:
        self._progress(self._stage, 1.0)


@dataclass
class _Said:
    """What the answers so far came to.

    Attributes:
        wrong: what was wrong with the last one.
        told: kinds of faults that the model has heard of; it hears of each once.
        standing: the last operations that had no fault but this one, that the scene leaves something open.
    """

    wrong: str = ""
    told: set[str] = field(default_factory=set)
    standing: tuple[Fault, tuple[EditOp, ...]] | None = None

    def judged(self, answer: Answer, guard: Guard, *, last: bool) -> _Outcome | str:
        """What an answer comes to, or what to tell the model about it.

        Args:
            last: there is no further attempt, so that faults which a plan may end with end it.
        """
        if answer.end == "declined":
            return _Outcome("not_understood", reason=f"the model declined: {answer.text}")
        cut = "the answer was cut off because it is too long; answer shorter, with fewer operations"
        if answer.end == "closed":  # valid, but half of what was meant
            self.wrong = cut
            return self.wrong
        try:
            said = reply.read(answer.text)
        except reply.ReplyError as error:
            self.wrong = cut if answer.end == "cut" else str(error)
            return self.wrong
        ops = guard.settled(said.ops)
        faults = guard.faults(ops)
        if said.verdict != "ok":
            return self._hesitant(said, ops, faults)
        return self._faulty(said, ops, faults, last) if faults else _Outcome("ok", ops, said.reason)

    def _hesitant(self, said: reply.Reply, ops: tuple[EditOp, ...], faults: Sequence[Fault]) -> _Outcome:
        """Any verdict but ok. Where the graph agrees that something is absent or ambiguous, the operations go to the
        session, which asks the user; else the model's word stands."""
        if faults and faults[0].kind == said.verdict:
            return _Outcome("ok", ops, said.reason)
        if not ops and self.standing is not None and self.standing[0].kind == said.verdict:
            return _Outcome("ok", self.standing[1], said.reason)
        return _Outcome(said.verdict, (), said.reason, said.unknown)

    def _faulty(
        self, said: reply.Reply, ops: tuple[EditOp, ...], faults: Sequence[Fault], last: bool
    ) -> _Outcome | str:
        """Faults of a plan: told once a kind; what is insisted on ends as the fault says."""
        worst = faults[0]
        self.wrong = "\n".join(f.told for f in faults)
        self.standing = (worst, ops) if worst.verdict == "ok" else None
        insisted = last or all(f.kind in self.told for f in faults)
        self.told |= {f.kind for f in faults}
        if not insisted or worst.verdict is None:
            return self.wrong
        if worst.verdict == "ok":
            return _Outcome("ok", ops, said.reason)
        return _Outcome(worst.verdict, (), worst.reason)


def _require_words(text: str) -> None:
    """Raise if a text cannot be an instruction.

    Raises:
        UserError: it cannot.
    """
    if len(text) > MAX_CHARS:
        raise UserError(f"the instruction has {len(text)} characters, at most {MAX_CHARS} are read; say it in parts")
    if not text.strip():
        raise UserError("the instruction is empty; say what to do")
    if any("\ud800" <= c <= "\udfff" for c in text):
        raise UserError("the text is not UTF-8; type it again, or set the terminal to UTF-8")


def _plain(text: str) -> str:
    """What a model said, as it may be printed: one line, without control characters, cut short."""
    line = " ".join("".join(" " if unicodedata.category(c)[0] == "C" else c for c in text).split())
    return line if len(line) <= _REASON_CHARS else line[: _REASON_CHARS - 1] + "…"


def _grammar() -> Planner:
    """Reads the instruction before, to tell what "it" means; costs nothing."""
    from ..grammar import GrammarPlanner

    return GrammarPlanner()

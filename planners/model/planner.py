"""The model planner: asks a language model for a plan, checks it, and asks again with the faults until it is valid.

`reply.py` parses answers and `guard.py` checks plans; a plan that fails a check is never returned.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field

from ...gaussians.errors import ScenewrightError, UserError
from ...tools.operation import EditOp
from ..plan import EditPlan, NoPlanError, Observation, Usage, Verdict
from .backend import Answer, Message, ModelBackend, UnreachableError
from .prompt.labels import sanitize
from .prompt.messages import Request, prompt, prompt_hash, repaired
from .verify import reply
from .verify.guard import Fault, Guard
from .verify.json_reply import printable

Progress = Callable[[str, float], None]  # stage in words, share done in [0, 1]

MAX_CHARS = 4000  # of an instruction
_REASON_CHARS = 400
_USUAL_ANSWER = 400  # characters of a typical answer, for the progress estimate


class ModelPlanner:
    """Plans with a language model; stateless between instructions.

    Args:
        backend: the model.
        attempts: maximum requests per instruction; later ones ask to repair faults.
        seconds: time limit of all attempts together.
        pictures: whether to send the viewer's image if there is one and the model accepts images.
        progress: called for each piece of an answer; without it answers are not streamed. The share is an estimate,
            since the length of an answer is unknown.

    Raises:
        UserError: `attempts` is below 1 or `seconds` is not above 0.
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

    def plan(self, text: str, *, previous: str | None = None, observation: Observation | None = None) -> EditPlan:
        """The plan for an instruction; see `Planner.plan`.

        A scene whose graph cannot be read is left out of the prompt; if that matters, the execution of the plan fails.

        Raises:
            UserError: the text is empty, not valid UTF-8, or too long.
            UnreachableError: the model cannot be reached. (A NoPlanError.)
            NoPlanError: no valid plan within the attempts or the time. (A BackendError.)
        """
        from ..grammar import GrammarPlanner  # resolves "it" in the previous instruction, without a model

        _require_words(text)
        started = time.monotonic()
        request = self._request(text, previous, observation)
        guard = Guard(text, request.previous, request.graph, GrammarPlanner())
        told = prompt(request, self.backend.window)
        conversation = _Conversation(self.backend, told.messages, started + self._seconds, self._progress)
        outcome = self._outcome(conversation, guard)
        usage = conversation.usage
        return EditPlan(
            instruction=text,
            ops=outcome.ops,
            planner=self.name[:200],
            prompt_hash=prompt_hash(),
            verdict=outcome.verdict,
            reason=printable(outcome.reason, _REASON_CHARS),
            unknown=tuple(filter(None, (printable(word, 200) for word in outcome.unknown))),
            seconds=time.monotonic() - started,
            usage=usage.model_copy(update={"prompt": told.size}) if usage is not None else None,
        )

    def _outcome(self, conversation: _Conversation, guard: Guard) -> _Outcome:
        """Ask until an answer decides; raises as `plan`."""
        review = _Review()
        for attempt in range(1, self._attempts + 1):
            answer = conversation.ask(attempt)
            if answer is None:
                break
            outcome = review.judge(answer, guard, last=attempt == self._attempts)
            if isinstance(outcome, _Outcome):
                return outcome
            conversation.add_fault(answer.text, outcome)
        if review.standing is not None:
            return _Outcome("ok", review.standing[1])
        asked = conversation.usage.requests if conversation.usage is not None else 0
        late = f" within {self._seconds:g} s (--budget gives it more)" if conversation.late else ""
        last = f"; at last: {printable(review.wrong, _REASON_CHARS)}" if review.wrong else ""
        problem = f"{self.name} gave no valid plan in {asked} attempt(s){late}{last}"
        raise NoPlanError(f"{problem}. Say it more simply, or use another model", conversation.usage)

    def _request(self, text: str, previous: str | None, observation: Observation | None) -> Request:
        """Input of the prompt. Labels are sanitised here, before anything else uses them."""
        graph, picture = None, None
        if observation is not None:
            with suppress(ScenewrightError):
                graph = sanitize(observation.graph())
            with suppress(ScenewrightError):
                picture = observation.picture() if self._pictures and self.backend.sees else None
        before = (previous or "").encode(errors="replace").decode()[:MAX_CHARS]
        return Request(text, before or None, graph, picture)


@dataclass(frozen=True)
class _Outcome:
    """The result for an instruction."""

    verdict: Verdict
    ops: tuple[EditOp, ...] = ()
    reason: str = ""
    unknown: tuple[str, ...] = ()


class _Conversation:
    """A conversation with a model about one instruction, with its deadline and its usage."""

    def __init__(
        self, backend: ModelBackend, first: tuple[Message, ...], deadline: float, progress: Progress | None
    ) -> None:
        self._backend, self._first, self._deadline, self._progress = backend, first, deadline, progress
        self._messages = first
        self.usage: Usage | None = None
        self.late = False

    def ask(self, attempt: int) -> Answer | None:
        """The next answer; None if the time is up.

        Raises:
            UnreachableError: the model gave no answer.
        """
        left = self._deadline - time.monotonic()
        self.late = left <= 0
        if self.late:
            return None
        stage = f"planning with {self._backend.name}" + (f", attempt {attempt}" if attempt > 1 else "")
        progress = self._progress or (lambda stage, share: None)
        progress(stage, 0.0)
        characters = 0

        def on_text(piece: str) -> None:
            nonlocal characters
            characters += len(piece)
            progress(stage, characters / (characters + _USUAL_ANSWER))

        listener = on_text if self._progress is not None else None
        try:
            answer = self._backend.answer(self._messages, reply.schema(), seconds=left, on_text=listener)
        except UnreachableError as error:
            cost = _sum(self.usage, error.usage)  # earlier attempts count too
            raise UnreachableError(str(error), cost) from error
        progress(stage, 1.0)
        self.usage = _sum(self.usage, answer.usage)
        return answer

    def add_fault(self, answer: str, fault: str) -> None:
        """Append the last answer and what was wrong with it."""
        self._messages = repaired(self._first, answer, fault)


def _sum(before: Usage | None, after: Usage | None) -> Usage | None:
    return after if before is None else before if after is None else before.plus(after)


@dataclass
class _Review:
    """Judges the answers of one conversation.

    Attributes:
        wrong: faults of the last answer.
        told: kinds of faults already reported to the model; each is reported once.
        standing: the last operations whose worst fault is acceptable (absent or ambiguous on the graph), and the fault.
    """

    wrong: str = ""
    told: set[str] = field(default_factory=set)
    standing: tuple[Fault, tuple[EditOp, ...]] | None = None

    def judge(self, answer: Answer, guard: Guard, *, last: bool) -> _Outcome | str:
        """The outcome of an answer, or the faults to report to the model.

        Args:
            last: whether this is the last attempt, after which acceptable faults and refusals decide the outcome.
        """
        if answer.end == "declined":
            return _Outcome("not_understood", reason=f"the model declined: {answer.text}")
        cut = "the answer was cut off because it is too long; answer shorter, with fewer operations"
        try:
            if answer.end == "closed":  # valid, but incomplete
                raise reply.ReplyError(cut)
            said = reply.read(answer.text)
        except reply.ReplyError as error:
            self.wrong = cut if answer.end == "cut" else str(error)
            return self.wrong
        ops = guard.drop_unstated(said.ops)
        faults = guard.faults(ops)
        if said.verdict != "ok":
            return self._hesitant(said, ops, faults)
        return self._faulty(said, ops, faults, last) if faults else _Outcome("ok", ops, said.reason)

    def _hesitant(self, said: reply.Reply, ops: tuple[EditOp, ...], faults: Sequence[Fault]) -> _Outcome:
        """Outcome of any verdict but "ok". If the graph agrees that something is absent or ambiguous, the operations go
        to the session, which asks the user; otherwise the model's verdict is returned."""
        if faults and faults[0].kind == said.verdict:
            return _Outcome("ok", ops, said.reason)
        if not ops and self.standing is not None and self.standing[0].kind == said.verdict:
            return _Outcome("ok", self.standing[1], said.reason)
        return _Outcome(said.verdict, (), said.reason, said.unknown)

    def _faulty(
        self, said: reply.Reply, ops: tuple[EditOp, ...], faults: Sequence[Fault], last: bool
    ) -> _Outcome | str:
        """Outcome of a plan with faults: each kind is reported once; a repeated one ends with its verdict."""
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
    """Check that a text can be an instruction.

    Raises:
        UserError: it is empty, too long or not valid UTF-8.
    """
    if len(text) > MAX_CHARS:
        raise UserError(f"the instruction has {len(text)} characters, at most {MAX_CHARS} are read; split it")
    if not text.strip():
        raise UserError("the instruction is empty; say what to do")
    if any("\ud800" <= c <= "\udfff" for c in text):
        raise UserError("the text is not UTF-8; type it again, or set the terminal to UTF-8")

"""The model planner: any instruction to a checked plan, by asking a language model and not believing it.

Knows the order of the work: ask, read, guard, ask again with what was wrong. Refuses to know how a model is reached
(`backend.py`), and never hands on what did not pass every check.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable

from ...gaussians.errors import BackendError, UserError
from ..plan import EditPlan, Sight, Usage
from . import reply
from .backend import Message, ModelBackend

Progress = Callable[[str, float], None]  # stage in words, share done in [0, 1]


class ModelPlanner:
    """Plans by asking a language model; stateless between instructions.

    Args:
        backend: the model.
        attempts: how often it may be asked about one instruction; later ones repair what was wrong.
        seconds: the longest that all of them may take together.
        pictures: whether to show it the viewer's picture, if it sees and there is one.
        progress: told that planning goes on whenever a piece of an answer arrives.

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
        self._progress = progress or (lambda stage, share: None)

    @property
    def name(self) -> str:
        """The back end's name."""
        return self.backend.name

    def plan(self, text: str, *, previous: str | None = None, sight: Sight | None = None) -> EditPlan:
        """The plan for an instruction; see `Planner.plan`.

        Raises:
            UserError: the text is too long to be an instruction.
            BackendError: the model cannot be reached (`UnreachableError`), or gave no valid plan after all attempts.
        """
        started = time.perf_counter()
        usage: Usage | None = None
        schema = reply.schema()
        messages = [
            Message("system", f"Answer with JSON of this schema only: {json.dumps(schema)}"),
            Message("user", json.dumps({"previous": previous, "instruction": text}, ensure_ascii=False)),
        ]
        wrong = ""
        for _ in range(self._attempts):
            left = self._seconds - (time.perf_counter() - started)
            if left <= 0:
                break
            answer = self.backend.answer(messages, schema, seconds=left, heard=self._heard)
            usage = answer.usage if usage is None else usage.plus(answer.usage)
            try:
                said = reply.read(answer.text)
            except reply.ReplyError as error:
                wrong = str(error)
                continue
            took = time.perf_counter() - started
            return EditPlan(
                instruction=text, planner=self.name, verdict=said.verdict, ops=said.ops, reason=said.reason,
                unknown=said.unknown, seconds=took, usage=usage,
            )  # fmt: skip
        raise BackendError(f"{self.name} gave no valid plan: {wrong}; say it more simply, or use another model")

    def _heard(self, piece: str) -> None:
        self._progress(f"planning with {self.name}", 0.0)

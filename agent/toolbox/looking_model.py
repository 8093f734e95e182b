"""A language model that may call the tools that look, before it answers the planner: the same tools as over MCP.

Edits stay in the plan that it answers with, which is checked as every plan of a model is (`planners/model/verify`).
"""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError

from ... import prompts
from ...planners.budget import Metered, Progress
from ...planners.model import load
from ...planners.model.backend import Answer, Message, ModelBackend, OnText, UnreachableError
from ...planners.model.planner import ModelPlanner
from ...planners.model.verify.json_reply import ReplyError, bare, given_object
from ...planners.plan import Planner, Usage
from ..session.session import Session
from .limits import Arguments, complaint
from .toolbox import Toolbox

LOOKS = 6  # calls of tools for one answer
_TOLD = 1500  # characters of a result
_ARGUMENTS = {
    "select": "target",
    "ask": "question",
    "render": "camera",
    "find_view": "view",
}  # what `words` is of each tool
_NO_MORE = "\n\nYou cannot look any more: answer now."


class Look(Arguments):
    """A call of a tool by the model."""

    tool: Literal["select", "ask", "check", "render", "find_view"]
    words: Annotated[str, Field(max_length=400)] = ""


class LookingModel:
    """A `ModelBackend` that carries out the looks of another one until that answers.

    Looks run on a session of their own on the same scene, so that "it" and open questions stay what they are.

    Args:
        backend: the model.
        session: whose scene is looked at.
        looks: at most so many calls for one answer.
    """

    def __init__(self, backend: ModelBackend, session: Session, looks: int = LOOKS) -> None:
        self._backend, self._session, self._looks = backend, session, looks
        self.name, self.sees, self.window = backend.name, backend.sees, backend.window

    def answer(
        self, messages: Sequence[Message], schema: dict[str, Any], *, seconds: float, on_text: OnText | None = None
    ) -> Answer:
        """See `ModelBackend.answer`; `usage` is that of all requests."""
        rules = f"{messages[0].text}\n\n{prompts.load('look').text}"
        talk = [replace(messages[0], text=rules), *messages[1:]]
        deadline, usage = time.monotonic() + seconds, None
        toolbox: Toolbox | None = None
        for left in range(self._looks, -1, -1):
            wanted = with_look(schema) if left else schema
            answer = self._asked(talk, wanted, max(deadline - time.monotonic(), 0.1), on_text, usage)
            usage = answer.usage
            look, text = _read(answer.text)
            if look is None or answer.end != "done" or not left:
                return replace(answer, text=text)
            toolbox = toolbox or self._toolbox()
            talk += [Message("assistant", answer.text[:_TOLD]), self._found(toolbox, look, left == 1)]
        raise AssertionError("the last answer is returned")

    def _asked(
        self, talk: list[Message], schema: dict[str, Any], seconds: float, on_text: OnText | None, usage: Usage | None
    ) -> Answer:
        """One answer, with the usage so far added; raises as `answer`."""
        try:
            answer = self._backend.answer(talk, schema, seconds=seconds, on_text=on_text)
        except UnreachableError as error:
            raise UnreachableError(str(error), _sum(usage, error.usage)) from error
        return replace(answer, usage=_sum(usage, answer.usage))

    def _toolbox(self) -> Toolbox:
        session = self._session
        return Toolbox(Session(session.embed(), "grammar", session.encoder, viewer=session.viewer, vlm=None))

    def _found(self, toolbox: Toolbox, look: Look | str, last: bool) -> Message:
        """What a look found, or what is wrong with it, as the next message."""
        end = _NO_MORE if last else ""
        if isinstance(look, str):
            return Message("user", look[:_TOLD] + end)
        argument = _ARGUMENTS.get(look.tool)
        reply = toolbox.call(look.tool, {argument: look.words} if argument and look.words else {})
        return Message("user", reply.text[:_TOLD] + end, reply.pictures if self.sees else ())


def looking_planner(session: Session, model: str | ModelBackend, *, looks: int = LOOKS) -> Planner:
    """A planner whose language model may look at the session's scene: `session.planner = looking_planner(session, …)`.

    It has the session's budget, and what it costs counts as the session's.

    Args:
        model: "openai:MODEL" and so on, as `planners.model.load` takes it, or a back end.
        looks: at most so many looks for one answer of the model.

    Raises:
        UserError: no such model.
        BackendError: a package, folder or key is missing.
    """
    backend = LookingModel(load(model) if isinstance(model, str) else model, session, looks)
    ledger = session.ledger

    def make(report: Progress) -> Planner:
        return ModelPlanner(backend, seconds=ledger.budget.seconds, progress=report)

    return Metered(backend.name, make, ledger)


def with_look(schema: dict[str, Any]) -> dict[str, Any]:
    """A schema that allows either a look or an answer of `schema`."""
    answer = {k: v for k, v in schema.items() if k != "$defs"}
    definitions = {**schema.get("$defs", {}), "Look": _look_schema(), "Answer": answer}
    options = {name: {"$ref": f"#/$defs/{name.capitalize()}"} for name in ("look", "answer")}
    null = {"type": "null"}
    return {
        "type": "object",
        "additionalProperties": False,
        "properties": {name: {"anyOf": [option, null]} for name, option in options.items()},
        "anyOf": [
            {"properties": {"look": options["look"], "answer": null}, "required": ["look"]},
            {"properties": {"answer": options["answer"], "look": null}, "required": ["answer"]},
        ],
        "$defs": definitions,
    }


@cache
def _look_schema() -> dict[str, Any]:
    made: dict[str, Any] = bare(Look.model_json_schema())
    return made


def _read(text: str) -> tuple[Look | str | None, str]:
    """The look that a text asks for, or what is wrong with it, or None; and the text of the answer, if it is one."""
    try:
        given = given_object(text)
    except ReplyError:
        return None, text  # the planner says what is wrong
    if "look" in given and "answer" not in given:
        try:
            return Look.model_validate(given["look"]), text
        except ValidationError as error:
            return str(complaint(error, "look")), text
    answer = given.get("answer")
    return None, json.dumps(answer, ensure_ascii=False) if isinstance(answer, dict) else text


def _sum(before: Usage | None, after: Usage | None) -> Any:
    return after if before is None else before if after is None else before.plus(after)

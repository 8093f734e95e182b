"""`Toolbox`: the list of tools of a session, and calls of them by name, one at a time."""

from __future__ import annotations

import logging
import re
import threading
import weakref
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import torch

from ...gaussians.cloud import GaussianCloud
from ...gaussians.errors import ScenewrightError, UserError
from ...planners.model.prompt.labels import plain
from ..session.clarify import Question
from ..session.history import DEPTH
from ..session.session import Session
from . import views
from .folder import Folder
from .instructions import instruction_tools
from .limits import ArgumentError, check_arguments
from .looking import looking_tools
from .operations import operation_tools
from .progress import Progress, Report
from .reply import Reply, asked_back, refused
from .saving import saving_tools
from .schemas import described_once
from .tool import Desk, Tool

_WORD = re.compile(r"[^\W_]+")
_logger = logging.getLogger(__name__)


class Toolbox:
    """The tools of one session: for function calls of a language model, and for tool servers.

    Calls may come from any thread; they are carried out one after the other. Every reply holds `scene`: the number of
    Gaussians, how many instructions can be undone, and a digest that is equal only for scenes whose Gaussians are equal
    bit for bit. Labels of the scene's file that are no plausible names of things are left out of replies, as they may
    be meant as instructions to the model that reads them.

        toolbox = Toolbox(session, folder="scenes")
        functions = toolbox.definitions()  # into the request to a language model
        reply = toolbox.call("recolor", {"target": {"text": "sofa"}, "color": "red"})  # as it asked for

    Args:
        session: the session.
        folder: the only folder that `save` writes to; without one there is no `save`.
        keep_field: write the language field beside a saved scene.
        progress: the session's progress, if calls are to report it.

    Attributes:
        tools: the tools by name.
    """

    def __init__(
        self,
        session: Session,
        folder: str | Path | None = None,
        *,
        keep_field: bool = False,
        progress: Progress | None = None,
    ) -> None:
        self._desk = Desk(session, Folder(folder) if folder is not None else None, keep_field)
        saving = saving_tools() if folder is not None else []
        listed = [*instruction_tools(), *looking_tools(), *saving, *operation_tools()]
        self.tools: dict[str, Tool] = {t.name: t for t in listed}
        self._progress = progress or Progress()
        self._lock = threading.RLock()
        self._digests: weakref.WeakKeyDictionary[GaussianCloud, str] = weakref.WeakKeyDictionary()
        self._asked: tuple[Question | None, int] = (None, 0)

    @property
    def session(self) -> Session:
        return self._desk.session

    def definitions(self) -> list[dict[str, Any]]:
        """Name, description and parameters (JSON Schema) of each tool, as function-calling interfaces take them.

        Types that several tools take are described with the first of them.
        """
        told: set[str] = set()
        return [
            {"name": t.name, "description": t.description, "parameters": described_once(t.schema, told)}
            for t in self.tools.values()
        ]

    def call(self, name: str, arguments: Any = None, report: Report | None = None) -> Reply:
        """Call a tool. What a caller does wrong raises nothing: the reply then has `failed`, and its data say why.

        Args:
            arguments: a JSON object, as a mapping.
            report: called with progress, a number that rises, and the stage in words. What it raises ends the call, and
                the scene stays as it was.
        """
        with self._lock:
            self._progress.listen(report)
            try:
                suspect = self._suspect_labels()
                reply = self._run(name, {} if arguments is None else arguments)
                return reply.without(suspect | self._suspect_labels()).plus(scene=self.state())
            finally:
                self._progress.listen(None)

    def state(self) -> dict[str, Any]:
        """The present state of the scene, as in every reply."""
        with self._lock:
            cloud = self.session.scene.cloud
            undo = min(len(self.session.done), DEPTH)
            return {"digest": self._digest(cloud), "gaussians": len(cloud), "undo": undo}

    def _suspect_labels(self) -> frozenset[str]:
        """Labels of the present scene that are no plausible names of things. A single English word instructs nobody."""
        field = self.session.scene.language
        labels = {g.label for g in field.groups} if field is not None else set()
        long = (label for label in labels if not label.isascii() or len(_WORD.findall(label)) > 1)
        return frozenset(label for label in long if plain(label) is None)

    def _run(self, name: str, arguments: Any) -> Reply:
        asked_before = self.session.question
        try:
            tool = self.tools.get(name)
            if tool is None:
                raise ArgumentError(f"there is no tool {name[:80]!r}; tools are {', '.join(self.tools)}")
            given = check_arguments(arguments)
            if name == "answer":
                self._require_open(given.get("question"))
            self._progress(name, 0.01)
            if tool.needs_field:
                self._embed()
            reply = tool.run(self._desk, given)
            self._progress("done", 1.0)
            return reply
        except ScenewrightError as error:
            fresh = name == "answer" or self.session.question is not asked_before
            return self._refused(error) if fresh else refused(error)
        except Exception as error:  # a fault of ours: operations are transactions, so the scene is as it was
            _logger.exception("tool %r failed", name)
            reason = f"internal error ({type(error).__name__}); the scene is as it was. Please report it"
            return Reply(reason, {"verdict": "internal", "reason": reason}, failed=True)

    def _embed(self) -> None:
        """Embed the scene if it is not yet. A caller that gives up meanwhile does not interrupt this: clients have time
        limits, and the next call finds it done. If it fails, a tool that cannot do without says why."""
        if self.session.scene.language is None:
            with self._progress.uninterrupted(), suppress(ScenewrightError):
                self.session.embed()

    def _refused(self, error: ScenewrightError) -> Reply:
        """The refusal; with the candidates and a picture of them if a question is open."""
        reply = refused(error)
        question = self.session.question
        if isinstance(error, ArgumentError) or question is None or not question.candidates:
            return reply
        reply = asked_back(reply, question, self.session.viewer, self._question_id(question))
        return replace(reply, pictures=(views.of_question(self.session, question),))

    def _question_id(self, question: Question) -> str:
        if question is not self._asked[0]:
            self._asked = (question, self._asked[1] + 1)
        return f"q{self._asked[1]}"

    def _require_open(self, id: object) -> None:
        """Raises UserError if `id` is given and is not the id of the open question."""
        question = self.session.question
        if id and (question is None or id != self._question_id(question)):
            raise UserError("that question is no longer open; call the tool again that asked it")

    def _digest(self, cloud: GaussianCloud) -> str:
        """SHA-256 of the Gaussians without the numbers of groups, so that embedding, which is no edit, keeps it."""
        if cloud not in self._digests:
            self._digests[cloud] = cloud.replace(group=torch.zeros_like(cloud.group)).digest()
        return self._digests[cloud]

"""What each message of a page does to the session, and the answer to it. Runs on the hub's worker."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
import torch
from torch import Tensor

from ...gaussians.errors import InstructionError, ScenewrightError, UserError
from ...gaussians.language.field.group_index import difference, index_groups, union
from ...gaussians.language.query.nested import without_confirmation
from ...planners.plan import EditPlan
from ...tools import registry
from ..session.dialogue import Dialogue, Said
from ..toolbox.folder import Folder
from ..toolbox.limits import check_arguments
from ..toolbox.operations import operation_words
from ..toolbox.saving import SaveArguments, save_scene
from ..toolbox.tool import Desk
from . import messages
from .commands import PageCommands
from .frames import frame
from .messages import Asked, Operate, Save, Say, Select, SelectSlots, Step
from .slots import EMPTY, slots_of
from .state import camera_json, numbered

if TYPE_CHECKING:
    from ...planners.questions.answer import Answer
    from ..session.result import Result
    from .changes import Shown
    from .gallery import Gallery

Reply = dict[str, Any]


class Stage(Protocol):
    """The part of the hub that messages use."""

    shown: Shown
    gallery: Gallery

    def settle(self) -> None: ...
    def before(self) -> bytes: ...
    def export(self) -> str: ...


class Actions:
    """Carries messages out.

    Args:
        stage: what is shown.
        dialogue: the session, and what words mean to it.
        folder: where scenes are saved; None: nowhere.
        keep_field: write the language field beside a saved scene.
    """

    def __init__(self, stage: Stage, dialogue: Dialogue, folder: Folder | None, keep_field: bool) -> None:
        self._stage = stage
        self._dialogue = dialogue
        self._session = dialogue.session
        self._desk = Desk(dialogue.session, folder, keep_field)
        self._commands = PageCommands(self._desk, dialogue, stage.gallery)

    def do(self, message: Asked) -> Reply | bytes:
        """The answer to a message, without its number; bytes go as they are.

        Raises:
            ScenewrightError: it cannot be done; nothing was changed.
        """
        if isinstance(message, Say):
            self._look(message)
            return self._typed(message.text)
        if isinstance(message, messages.Answer):
            return self._typed(str(message.choice))
        if isinstance(message, Select | SelectSlots):
            return self._select(message)
        if isinstance(message, Operate):
            self._look(message)
            return self._operate(message)
        if isinstance(message, Save):
            return self._save(message)
        if isinstance(message, messages.Frame):
            return frame(self._stage.shown, message.time, message.id)
        assert isinstance(message, Step)
        if message.type == "before":
            return self._stage.before()
        return self._stepped(message)

    def _look(self, message: Say | Operate) -> None:
        """Take over the camera of the page."""
        if message.camera is not None:
            self._session.viewer = message.camera.camera()

    # -- words -------------------------------------------------------------------------------------------------------

    def _typed(self, text: str) -> Reply:
        """A line that was typed. One that is refused or asks back is answered with why."""
        try:
            if text.startswith("/"):
                return self._command(text)
            return self._said(self._dialogue.say(text))
        except ScenewrightError as error:
            return self._refused(error)

    def _command(self, line: str) -> Reply:
        """A slash command, and what it shows."""
        self._dialogue.begin()
        told = self._commands.run(line)
        said = Said("\n".join(told.texts), camera=told.camera)
        return {**self._said(said), "receipt": _receipt(told.results), "pictures": told.pictures}

    def _refused(self, error: ScenewrightError) -> Reply:
        refused = self._dialogue.refused(error)
        first, *lines = refused.lines
        question = self._session.question if isinstance(error, InstructionError) else None
        first = numbered(first, question.candidates if question is not None else ())
        if question is not None:
            lines = list(refused.after)  # the picture shows the candidates
        return {**_ANSWER, "ok": False, "text": first, "lines": lines}

    def _stepped(self, step: Step) -> Reply:
        if step.type == "export":
            return self._export()
        result = self._session.undo() if step.type == "undo" else self._session.redo()
        return self._said(self._dialogue.edited(result))

    def _export(self) -> Reply:
        """The scene as a page of its own, to download."""
        return {**_ANSWER, "text": "the page is ready", "link": self._stage.export()}

    # -- the selection -----------------------------------------------------------------------------------------------

    def _select(self, message: Select | SelectSlots) -> Reply:
        """Let "it" mean what was clicked, boxed or brushed."""
        if self._session.scene.language is None and message.mode != "clear":
            self._session.embed()
            self._stage.settle()
        ids = self._meant(message)
        now = self._session.last.ids if self._session.last is not None else ids[:0]
        if message.mode == "add":
            ids = union(now, ids)
        elif message.mode == "remove":
            ids = difference(now, ids)
        found = self._session.point(ids)
        self._dialogue.begin()
        text = "nothing is selected" if found is None else f"{len(found):,} Gaussians are selected"
        return {**_ANSWER, "text": text}

    def _meant(self, message: Select | SelectSlots) -> Tensor:
        """The ids `[M]` that a message means, ascending."""
        shown = self._stage.shown
        cloud, field = shown.scene.cloud, shown.scene.language
        if isinstance(message, SelectSlots):
            ranges = np.array(message.ranges, np.int64).reshape(-1, 2)
            if len(ranges) and int(ranges[-1].sum()) > shown.slots.count:
                raise UserError("there are no such slots; the page shows an older state")
            rows = shown.slots.rows[slots_of(ranges)]
            return cloud.ids[torch.from_numpy(rows[rows != EMPTY])].sort().values
        if message.mode == "clear" or field is None:
            return cloud.ids[:0]
        group = message.group
        if message.slot is not None:
            row = int(shown.slots.rows[message.slot]) if message.slot < shown.slots.count else EMPTY
            group = int(cloud.group[row]) if row != EMPTY else -1
            group = group if message.mode == "part" else int(shown.owner[group + 1])
        if group is None or not 0 <= group < len(field.groups):
            if message.slot is None:
                raise UserError(f"there is no thing {group}; the page shows an older state")
            return cloud.ids[:0]  # what was clicked belongs to no thing
        return index_groups(cloud).ids_of(field.leaves(group))

    def _operate(self, message: Operate) -> Reply:
        """Typed operations on the selection, as one step."""
        if self._session.last is None:
            raise UserError("nothing is selected; click a thing first")
        ops = []
        for given in message.ops:
            fields = check_arguments(given)
            op = registry.parse({**fields, "target": fields.get("target", {"last": True})})
            ops.append(without_confirmation(op))
        plan = EditPlan(instruction=" and ".join(map(operation_words, ops))[:400], ops=tuple(ops), planner="page")
        try:
            return self._said(self._dialogue.edited(self._session.apply(plan)))
        except ScenewrightError as error:
            return self._refused(error)

    def _save(self, message: Save) -> Reply:
        if "/" in message.name or "\\" in message.name:
            raise UserError(
                f"{message.name!r} is not the name of a file; it is saved beside the scene, without a folder"
            )
        return {**_ANSWER, "text": save_scene(self._desk, SaveArguments(file=message.name, force=message.force)).text}

    # -- answers -----------------------------------------------------------------------------------------------------

    def _said(self, said: Said) -> Reply:
        """The answer to what was done, or asked."""
        first, *lines = said.text.split("\n")
        rows = _receipt([said.result] if said.result is not None else [])
        camera = camera_json(said.camera) if said.camera is not None else None
        pictures = self._evidence(said.answer) if said.answer is not None else []
        return {
            **_ANSWER, "ok": said.sure, "text": first, "lines": lines, "receipt": rows, "camera": camera,
            "pictures": pictures,
        }  # fmt: skip

    def _evidence(self, answer: Answer) -> list[str]:
        """The path of the picture of what an answer rests on; none where there is nothing to draw."""
        from ..pictures.evidence import evidence_png, has_picture

        scene, viewer = self._session.scene, self._session.viewer
        return [self._stage.gallery.add(lambda: evidence_png(scene, answer, viewer))] if has_picture(answer) else []


_ANSWER: Reply = {
    "type": "said", "ok": True, "text": "", "lines": [], "receipt": [], "pictures": [], "link": None, "camera": None,
}  # fmt: skip


def _receipt(results: Sequence[Result]) -> list[dict[str, Any]]:
    """What was checked of results, a row for each check."""
    checks = [check for result in results for receipt in result.receipts for check in receipt.checks]
    return [{"name": c.name, "passed": c.passed, "text": c.sentence} for c in checks]

"""Tools that take words: an instruction, an answer to an open question, a selection; and undo and redo."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ...gaussians.errors import UserError
from ...gaussians.language.query.nested import without_confirmation
from ...gaussians.language.query.query import Query
from ..session.history import DEPTH
from ..session.plan_report import selection_json
from . import views
from .limits import Arguments, Text
from .reply import Reply, edited, numbered_candidates
from .tool import READS, Desk, Hints, Tool, tool

Picture = Annotated[bool, Field(strict=True, description="Also return a picture of the scene afterwards.")]


class DoArguments(Arguments):
    """Arguments of `do`."""

    instruction: Text
    """What to do, in words: "put a red ball on the coffee table"."""
    dry_run: Annotated[bool, Field(strict=True)] = False
    """Only tell what would be done."""
    picture: Picture = False


class AnswerArguments(Arguments):
    """Arguments of `answer`."""

    answer: Text
    """A number of the list, "all", or words that choose: "the left one", "the red one", or "yes"."""
    question: Annotated[str, Field(max_length=40)] = ""
    """The id of the question, as it was told; by default the open one."""
    picture: Picture = False


class SelectArguments(Arguments):
    """Arguments of `select`."""

    target: Text | Query
    """What to select: words ("the chair next to the window") or a query."""
    picture: Annotated[bool, Field(strict=True)] = False
    """Also return a picture: the selection highlighted, or the candidates numbered."""


class StepArguments(Arguments):
    """Arguments of `undo` and `redo`."""

    steps: Annotated[int, Field(ge=1, le=DEPTH, strict=True)] = 1
    """How many instructions."""


def _do(desk: Desk, said: DoArguments) -> Reply:
    """Carry out an instruction in words, completely or not at all, and return a receipt with every measured check.
    Several steps may be given at once ("make the sofa red and remove the lamp"). If several things match, or
    the name of what was chosen is not confirmed, nothing is changed and it is asked back: call `answer`."""
    result = desk.session.preview(said.instruction) if said.dry_run else desk.session.do(said.instruction)
    return edited(result, (views.after_edit(result),) if said.picture else ())


def _answer(desk: Desk, said: AnswerArguments) -> Reply:
    """Answer the open question of a call by choosing among its candidates, or by "yes" to what was chosen without
    confirmation; the call is then carried out."""
    result = desk.session.answer(said.answer)
    return edited(result, (views.after_edit(result),) if said.picture else ())


def _select(desk: Desk, said: SelectArguments) -> Reply:
    """Find things and return what matches, with groups, boxes and scores. The verdict "unconfirmed" says that what is
    returned was not recognised by its name. The scene is not changed; "it" and
    `{"last": true}` then mean what was found."""
    from ..pictures.image_files import encoded_png
    from ..pictures.scene_pictures import numbered, spotlight

    session = desk.session
    found = session.select(without_confirmation(said.target))
    listed = numbered_candidates(found.candidates, session.viewer)
    what = f"found: {found.query.describe()}" if found.verdict == "found" else found.reason or found.verdict
    if found.verdict == "unconfirmed":
        what = f"unconfirmed: {what}"
    text = "\n".join([what, *(f"  {c['number']}. {c['said']}" for c in listed)])
    pictures: tuple[bytes, ...] = ()
    if said.picture:
        camera = views.sized(session.viewer, views.WIDTH)
        marked = found.chosen
        drawn = spotlight(session.scene, camera, found) if marked else numbered(session.scene, camera, found.candidates)
        pictures = (encoded_png(drawn),)
    return Reply(text, {**selection_json(found), "candidates": listed}, pictures)


def _undo(desk: Desk, said: StepArguments) -> Reply:
    """Undo the last instructions: the scene is again bit for bit what it was, which `scene.digest` shows."""
    there = min(len(desk.session.done), DEPTH)
    if said.steps > max(there, 1):
        raise UserError(f"only {there} instructions can be undone")
    for _ in range(said.steps):
        result = desk.session.undo()
    return edited(result)


def _redo(desk: Desk, said: StepArguments) -> Reply:
    """Redo instructions that were undone."""
    for step in range(said.steps):
        try:
            result = desk.session.redo()
        except UserError as error:
            for _ in range(step):
                desk.session.undo()
            raise UserError(f"only {step} instructions can be redone" if step else str(error)) from error
    return edited(result)


def instruction_tools() -> list[Tool]:
    """The tools of this module."""
    return [
        tool("do", DoArguments, Hints(destructive=True), _do),
        tool("answer", AnswerArguments, Hints(destructive=True), _answer, needs_field=False),
        tool("select", SelectArguments, READS, _select),
        tool("undo", StepArguments, Hints(destructive=True), _undo, needs_field=False),
        tool("redo", StepArguments, Hints(), _redo, needs_field=False),
    ]

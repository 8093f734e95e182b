"""`scenewright ask SCENE "TEXT"`: answer a question about a scene or a scene graph."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..options import Batch, Budget, Debug, Effort, Encoder, Force, Json, View, Vlm, Window
from ..terminal.effort import dialled, reported, tell
from ..terminal.output import read_batch, terminal

if TYPE_CHECKING:
    from ...planners.questions.answer import Answer
    from ..session.session import Session

Ask = Callable[[str, str | None], "Answer"]  # arguments: the question, and the question before it


def command(
    arguments: Annotated[
        list[str] | None,
        typer.Argument(metavar="[SCENE] TEXT", help="The question, after a scene file unless --graph is given."),
    ] = None,
    batch: Batch = None,
    graph: Annotated[
        Path | None, typer.Option("--graph", metavar="ROOM.json", help="A scene graph to ask instead of a scene.")
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option("--picture", metavar="OUT.png", help="Draw the evidence: things outlined, distances as lines."),
    ] = None,
    vlm: Vlm = "auto",
    budget: Budget = None,
    window: Window = None,
    effort: Effort = None,
    encoder: Encoder = "auto",
    view: View = "auto",
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Answer a question about a scene: what is there, how many, how large, how far, where, what fits, which way.

    Geometry answers what boxes, colours and relations decide, and a vision model, if one is named, what pictures show.
    What nobody can tell is said. With --json the answer is
    {"answer", "answer_type", "text", "confidence", "source", "evidence", "frame", "unit"}.
    """
    started = time.perf_counter()
    from ...gaussians.errors import UserError
    from ..output_files import refuse_existing
    from ..session.opening import SessionOptions, open_session
    from ..session.plan_report import format_usage

    dial = dialled(effort, started)
    given = arguments or []
    scene, text = _scene_and_text(given, batch is not None, graph is not None)
    if picture is not None and (graph is not None or batch is not None):
        raise UserError("--picture draws the evidence of one question in a scene; leave out --graph and --batch")
    if picture is not None:
        refuse_existing([picture], force)
    rows = read_batch(str(batch)) if batch else [{"text": text}]
    session = (
        open_session(SessionOptions(scene, "grammar", encoder, view, budget=budget, vlm=vlm, dial=dial))[0]
        if scene is not None
        else None
    )
    ask = _of_session(session) if session is not None else _of_graph(graph)
    for row in rows:
        if batch is not None:
            terminal.row({"id": row["id"], **_one_of_batch(ask, row)})
            continue
        found = ask(row["text"], None)
        terminal.result(found.text, found.to_json() | reported(dial))
        tell(dial)
        if found.usage is not None:
            terminal.say(format_usage(found.usage))
        if picture is not None and session is not None:
            _draw(session, found, picture, force)
        if found.confidence == 0.0:
            raise typer.Exit(3)


def _scene_and_text(given: list[str], batch: bool, graph: bool) -> tuple[Path | None, str]:
    """The scene file, if one is given, and the question; raises UserError if the arguments do not fit."""
    from ...gaussians.errors import UserError

    wanted = (0 if graph else 1) + (0 if batch else 1)
    if len(given) != wanted:
        raise UserError(
            'write: scenewright ask SCENE "TEXT", or: scenewright ask "TEXT" --graph ROOM.json; '
            "--batch FILE takes the place of TEXT"
        )
    scene = None if graph else Path(given[0])
    return scene, "" if batch else given[-1]


def _of_session(session: Session) -> Ask:
    """Answers about a scene."""

    def ask(text: str, context: str | None) -> Answer:
        session.recall(None)
        if context:
            session.ask(context)
        return session.ask(text)

    return ask


def _of_graph(path: Path | None) -> Ask:
    """Answers about a written scene graph."""
    from ...planners.questions.asking import answer
    from ...planners.questions.survey import Survey
    from ...planners.questions.topic import topic
    from ...planners.rooms.graph import SceneGraph

    assert path is not None
    survey = Survey.of_graph(SceneGraph.read(path))

    def ask(text: str, context: str | None) -> Answer:
        meant = survey.remembering(topic(answer(context, survey), survey)) if context else survey
        return answer(text, meant)

    return ask


def _one_of_batch(ask: Ask, row: dict[str, Any]) -> dict[str, Any]:
    """The answer to one line of a batch; a rejected text does not stop the others."""
    from ...gaussians.errors import UserError
    from ...planners.questions.answer import Answer

    try:
        return ask(row["text"], row.get("context")).to_json()
    except UserError as error:
        return Answer(answer=None, answer_type="text", text=str(error), confidence=0.0, source="none").to_json()


def _draw(session: Session, answer: Answer, target: Path, force: bool) -> None:
    """Write the picture of the evidence."""
    from ..pictures.evidence import evidence_picture
    from ..pictures.image_files import save_png

    save_png(evidence_picture(session.scene, answer, viewer=session.viewer), target, force)

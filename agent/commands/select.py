"""`scenewright select SCENE "TEXT"`: which Gaussians a phrase means."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..options import Batch, Debug, Encoder, Force, Json, Planner, SceneFile, View
from ..terminal import read_batch, terminal

if TYPE_CHECKING:
    from ...gaussians.language.selection import Selection
    from ..session import Session

Ids = Annotated[
    Path | None,
    typer.Option(
        "--ids", metavar="FILE", help="Write the Gaussians' row numbers (.npy); with --batch a folder of <id>.npy."
    ),
]


def command(
    scene: SceneFile,
    text: Annotated[str | None, typer.Argument(metavar="TEXT", help="What to select, e.g. 'the red chair'.")] = None,
    ids: Ids = None,
    batch: Batch = None,
    encoder: Encoder = "auto",
    planner: Planner = "auto",
    view: View = "auto",
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Find what a phrase means: found, ambiguous (with the candidates) or absent (with the nearest)."""
    from ...gaussians.errors import UserError
    from ..opening import Opening, open_session
    from ..targets import make_folder

    if (text is None) == (batch is None):
        raise UserError('give either TEXT or --batch FILE: scenewright select SCENE "the red chair"')
    rows = read_batch(str(batch)) if batch else [{"id": None, "text": text}]
    targets = [_target(ids, row["id"], batch is not None) for row in rows]
    _check_targets([t for t in targets if t is not None], force)
    if ids is not None and batch is not None:
        make_folder(ids)
    session, _ = open_session(Opening(scene, planner, encoder, view))
    if batch is None:
        _one(session, str(text), targets[0], force)
        return
    for row, target in zip(rows, targets, strict=True):
        session.recall(row.get("context"))
        selection, data = _answer(session, row["text"])
        if target is not None:
            _write_rows(selection, target, force)
        terminal.row({"id": row["id"], **data})


def _target(ids: Path | None, row: Any, batch: bool) -> Path | None:
    """Where the rows of one answer go; an id that is no plain file name is refused."""
    from ...gaussians.errors import UserError

    if ids is None or not batch:
        return ids
    name = f"{row}.npy"
    if Path(name).name != name or name.startswith("."):
        raise UserError(f"the id {row!r} cannot be a file name; use letters, digits, '-' and '_'")
    return ids / name


def _check_targets(targets: list[Path], force: bool) -> None:
    """Say before the work that a file would be overwritten, or that two answers would go to one."""
    from ...gaussians.errors import UserError
    from ..targets import refuse_existing

    twice = [t for t in targets if targets.count(t) > 1] if len(set(targets)) < len(targets) else []
    if twice:
        raise UserError(f"two lines of the batch would both be written to {twice[0]}; give each its own id")
    refuse_existing(targets, force)


def _one(session: Session, text: str, target: Path | None, force: bool) -> None:
    selection, data = _answer(session, text)
    if selection is None or selection.verdict != "found":
        terminal.result(data["reason"], data)
        for number, c in enumerate(selection.candidates if selection is not None else (), start=1):
            terminal.say(f"  {number}. {c.describe()}, score {c.score:.2f}")
        raise typer.Exit(3)
    if target is not None:
        _write_rows(selection, target, force)
    things = ", ".join(c.describe() for c in selection.candidates) or selection.query.describe()
    note = f" ({selection.reason})" if selection.reason else ""
    terminal.result(f"{len(selection):,} Gaussians: {things}{note}", data)


def _answer(session: Session, text: str) -> tuple[Selection | None, dict[str, Any]]:
    """The selection, None if the words were not understood, and the answer as data."""
    from ...gaussians.errors import UserError
    from ..resolved import selection_json

    started = time.perf_counter()
    try:
        selection = session.select(text)
    except UserError as error:
        refused = {"verdict": "not_understood", "gaussians": 0, "groups": [], "candidates": [], "reason": str(error)}
        return None, {**refused, "seconds": round(time.perf_counter() - started, 4)}
    return selection, {**selection_json(selection), "seconds": round(time.perf_counter() - started, 4)}


def _write_rows(selection: Selection | None, target: Path, force: bool) -> None:
    """Row numbers of the selected Gaussians in the loaded file, int64; none where nothing was found."""
    import numpy as np

    from ...gaussians.files import writing

    rows = selection.ids.cpu().numpy() if selection is not None else np.zeros(0, dtype=np.int64)
    with writing(target, force) as file:
        np.save(file, rows, allow_pickle=False)

"""`scenewright select SCENE "TEXT"`: select the Gaussians that a phrase describes."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..options import Batch, Debug, Effort, Encoder, Force, Json, Memory, Planner, SceneFile, View, Vlm
from ..terminal.effort import dialled, reported, tell
from ..terminal.output import read_batch, terminal

if TYPE_CHECKING:
    from ...gaussians.language.query.query import Query
    from ...gaussians.language.query.selection import Selection
    from ..session.session import Session

Ids = Annotated[
    Path | None,
    typer.Option(
        "--ids", metavar="FILE", help="Write the Gaussians' row numbers (.npy); with --batch a folder of <id>.npy."
    ),
]
Save = Annotated[
    Path | None,
    typer.Option("--save", metavar="FILE", help="Write the selection: Gaussians (.ply, …), or a coloured mesh (.glb)."),
]
Grow = Annotated[float | None, typer.Option(metavar="METRES", help="Then add the Gaussians within this distance.")]
Shrink = Annotated[
    float | None, typer.Option(metavar="METRES", help="Then remove those within this distance of other Gaussians.")
]
Invert = Annotated[bool, typer.Option("--invert", help="Then select everything else instead.")]
Explain = Annotated[
    bool, typer.Option("--explain", help="Print each candidate's score of each term, and its threshold or rival.")
]


def command(
    scene: SceneFile,
    text: Annotated[str | None, typer.Argument(metavar="TEXT", help="What to select, e.g. 'the red chair'.")] = None,
    ids: Ids = None,
    grow: Grow = None,
    shrink: Shrink = None,
    invert: Invert = False,
    explain: Explain = False,
    save: Save = None,
    batch: Batch = None,
    encoder: Encoder = "auto",
    planner: Planner = "auto",
    vlm: Vlm = "auto",
    view: View = "auto",
    effort: Effort = None,
    memory: Memory = None,
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Select what a phrase describes: found, unconfirmed (chosen, but not by a confirmed name), ambiguous (with the
    candidates) or absent (with the nearest)."""
    started = time.perf_counter()
    from ...gaussians.errors import UserError
    from ..output_files import make_folder
    from ..session.opening import SessionOptions, open_session

    if (text is None) == (batch is None):
        raise UserError('give either TEXT or --batch FILE: scenewright select SCENE "the red chair"')
    dial = dialled(effort, started)
    rows = read_batch(str(batch)) if batch else [{"id": None, "text": text}]
    targets = [_target(ids, row["id"], batch is not None) for row in rows]
    _check_targets([t for t in targets if t is not None], force)
    if ids is not None and batch is not None:
        make_folder(ids)
    if save is not None:
        _check_save(save, batch is not None, force)
    changes = SelectionChanges(_steps(grow, shrink, invert), explain)
    session, _ = open_session(SessionOptions(scene, planner, encoder, view, vlm=vlm, dial=dial, tiled=True))
    if batch is None:
        _one(session, str(text), changes, _Files(targets[0], save, force))
        return
    for row, target in zip(rows, targets, strict=True):
        session.recall(row.get("context"))
        selection, data = _answer(session, row["text"], changes)
        if target is not None:
            _write_rows(selection, target, force)
        terminal.row({"id": row["id"], **data})


@dataclass(frozen=True)
class SelectionChanges:
    """Options applied to each selection: queries on "it" that change it in turn, and whether to explain it."""

    steps: tuple[Query, ...]
    explain: bool


def _steps(grow: float | None, shrink: float | None, invert: bool) -> tuple[Query, ...]:
    """The requested changes in the order grow, shrink, invert."""
    from ...gaussians.errors import UserError
    from ...gaussians.language.query.query import Query

    for name, by in (("--grow", grow), ("--shrink", shrink)):
        if by is not None and not 0 < by <= 100:
            raise UserError(f"{name} takes metres above 0 and up to 100, not {by:g}")
    steps = []
    if grow is not None:
        steps.append(Query(last=True, grow=grow))
    if shrink is not None:
        steps.append(Query(last=True, grow=-shrink))
    if invert:
        steps.append(Query(last=True, invert=True))
    return tuple(steps)


def _target(ids: Path | None, row: Any, batch: bool) -> Path | None:
    """The file for the rows of one answer; raises UserError if the id of a batch line cannot be a file name."""
    from ...gaussians.errors import UserError

    if ids is None or not batch:
        return ids
    name = f"{row}.npy"
    if Path(name).name != name or name.startswith("."):
        raise UserError(f"the id {row!r} cannot be a file name; use letters, digits, '-' and '_'")
    return ids / name


def _check_targets(targets: list[Path], force: bool) -> None:
    """Check before the work that no file would be overwritten and no two answers go to one file."""
    from ...gaussians.errors import UserError
    from ..output_files import refuse_existing

    twice = [t for t in targets if targets.count(t) > 1] if len(set(targets)) < len(targets) else []
    if twice:
        raise UserError(f"two lines of the batch would both be written to {twice[0]}; give each its own id")
    refuse_existing(targets, force)


@dataclass(frozen=True)
class _Files:
    """The files that one answer is written to."""

    ids: Path | None
    save: Path | None
    force: bool


def _check_save(save: Path, batch: bool, force: bool) -> None:
    """Check before the work that the selection can be written there."""
    from ...gaussians.assets.exporting import check_export
    from ...gaussians.errors import UserError
    from ..output_files import refuse_existing, require_folder

    if batch:
        raise UserError("--save writes one selection; it does not go with --batch")
    check_export(save)
    require_folder(save)
    refuse_existing([save], force)


def _one(session: Session, text: str, changes: SelectionChanges, files: _Files) -> None:
    selection, data = _answer(session, text, changes)
    if selection is None or not selection.chosen:
        terminal.result(data["reason"], data | reported(session.dial))
        tell(session.dial)
        for number, c in enumerate(selection.candidates if selection is not None else (), start=1):
            terminal.say(f"  {number}. {c.describe()}, score {c.score:.2f}")
        raise typer.Exit(3)
    if files.ids is not None:
        _write_rows(selection, files.ids, files.force)
    if files.save is not None:
        from ...gaussians.assets.exporting import export

        export(session.scene, selection.ids, files.save, files.force)
        data["path"] = str(files.save)
    things = ", ".join(c.describe() for c in selection.candidates) or data["asked"]
    note = f" ({selection.reason})" if selection.reason else ""
    doubt = "unconfirmed, " if selection.verdict == "unconfirmed" else ""
    terminal.result(f"{doubt}{len(selection):,} Gaussians: {things}{note}", data | reported(session.dial))
    tell(session.dial)


def _answer(session: Session, text: str, changes: SelectionChanges) -> tuple[Selection | None, dict[str, Any]]:
    """The selection, None if the words were not understood, and the answer as data."""
    from ...gaussians.errors import UserError
    from ..session.plan_report import selection_json

    started = time.perf_counter()
    try:
        explained = session.explain(text) if changes.explain else None
        selection = session.select(text)
        words = selection.query.describe()
        for step in changes.steps if selection.chosen else ():
            selection, words = session.select(step), step.describe().replace("it", words, 1)
    except UserError as error:
        refused = {"verdict": "not_understood", "gaussians": 0, "groups": [], "candidates": [], "reason": str(error)}
        return None, {**refused, "seconds": round(time.perf_counter() - started, 4)}
    data = {**selection_json(selection), "asked": words, "seconds": round(time.perf_counter() - started, 4)}
    if explained is not None:
        data["explained"] = explained.to_json()
        for line in explained.lines():
            terminal.say(line)
    return selection, data


def _write_rows(selection: Selection | None, target: Path, force: bool) -> None:
    """Write the row numbers of the selected Gaussians in the loaded file, int64; an empty array for no selection."""
    import numpy as np

    from ...gaussians.files import writing

    rows = selection.ids.cpu().numpy() if selection is not None else np.zeros(0, dtype=np.int64)
    with writing(target, force) as file:
        np.save(file, rows, allow_pickle=False)

"""`scenewright edit SCENE "TEXT" -o out.ply`: carry out an instruction on a file."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..options import Debug, Encoder, Force, Json, Log, Output, Planner, SceneFile, Seed, Size, View
from ..terminal import terminal

if TYPE_CHECKING:
    from ..session import Session


@dataclass(frozen=True)
class _Targets:
    """Files that an edit leaves behind."""

    output: Path | None
    pictures: Path | None
    force: bool
    keep_field: bool


def command(
    scene: SceneFile,
    text: Annotated[str | None, typer.Argument(metavar="TEXT", help="What to do, e.g. 'make the sofa teal'.")] = None,
    output: Output = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Show the plan and what would change; write nothing.")
    ] = False,
    pictures: Annotated[
        Path | None, typer.Option("--pictures", metavar="FOLDER", help="Leave before.png and after.png there.")
    ] = None,
    log: Log = None,
    replay: Annotated[
        Path | None, typer.Option("--replay", metavar="LOG", help="Carry out what the last session in a log did.")
    ] = None,
    view: View = "auto",
    size: Size = None,
    planner: Planner = "auto",
    encoder: Encoder = "auto",
    seed: Seed = 0,
    force: Force = False,
    as_json: Json = False,
    debug: Debug = False,
) -> None:
    """Edit a scene in words. An instruction is carried out whole or not at all, and checked.

    A language field saved beside SCENE (see `embed`) is used, and the edited scene gets one too.
    """
    from ...gaussians.errors import UserError
    from ..opening import Opening, open_session

    if (text is None) == (replay is None):
        raise UserError('give either TEXT or --replay LOG: scenewright edit SCENE "make the sofa teal" -o out.ply')
    if output is None and not dry_run:
        raise UserError("say where to write the edited scene: -o out.ply (or look first with --dry-run)")
    _refuse_existing(output, pictures, force or dry_run)
    started = time.perf_counter()
    opening = Opening(scene, planner, encoder, view, size, None if dry_run else log, seed)
    session, had_field = open_session(opening)
    seconds = {"open": time.perf_counter() - started}
    targets = _Targets(None if dry_run else output, pictures, force, had_field)
    outcome = _replay(session, replay, dry_run) if replay is not None else _instruct(session, str(text), dry_run)
    _leave(session, outcome, targets, seconds, started)
    session.close()


def _refuse_existing(output: Path | None, pictures: Path | None, force: bool) -> None:
    """Say at once, not after the work, that a file would be overwritten."""
    from ...gaussians.errors import UserError

    wanted = [output] if output else []
    wanted += [pictures / name for name in ("before.png", "after.png")] if pictures else []
    for path in wanted:
        if path.exists() and not force:
            raise UserError(f"{path} exists; choose another name, or overwrite it with --force")


def _instruct(session: Session, text: str, dry_run: bool) -> dict[str, Any]:
    """Do what was said; the outcome as data, with the scenes for pictures under "before" and "after"."""
    from ...gaussians.errors import InstructionError
    from ..refusal import verdict_of
    from ..resolved import candidate_json

    try:
        result = session.preview(text) if dry_run else session.do(text)
    except InstructionError as error:
        candidates = session.question.candidates if session.question else ()
        data = {"verdict": verdict_of(error), "reason": str(error), "exit_code": error.exit_code,
                "candidates": [candidate_json(c) for c in candidates]}  # fmt: skip
        terminal.refuse(error, data, [c.describe() for c in candidates])
    return {"before": result.before, "after": result.scene, "lines": result.sentences(), "data": result.to_json()}


def _replay(session: Session, log: Path, dry_run: bool) -> dict[str, Any]:
    """Replay a log; on a dry run everything is taken back again by dropping the session."""
    before = session.scene
    replayed = session.replay(log)
    results = [r.result for r in replayed if r.result is not None]
    lines = [line for result in results for line in (f"> {result.text}", *result.sentences())]
    data = {"verdict": "ok", "replayed": [r.to_json() for r in results], "dry_run": dry_run,
            "gaussians": len(session.scene.cloud)}  # fmt: skip
    return {"before": before, "after": session.scene, "lines": lines, "data": data}


def _leave(
    session: Session, outcome: Mapping[str, Any], targets: _Targets, seconds: dict[str, float], started: float
) -> None:
    """Write what was asked for and tell what was done."""
    from ...gaussians.language.store import save_field

    data: dict[str, Any] = dict(outcome["data"])
    if targets.output is not None:
        mark = time.perf_counter()
        session.save(targets.output, force=targets.force)
        if targets.keep_field and session.scene.language is not None:
            data["field"] = str(save_field(session.scene, targets.output))
        seconds["save"] = time.perf_counter() - mark
        data["output"] = str(targets.output)
    if targets.pictures is not None:
        mark = time.perf_counter()
        data["pictures"] = _draw(session, outcome, targets.pictures, targets.force)
        seconds["pictures"] = time.perf_counter() - mark
    seconds["total"] = time.perf_counter() - started
    data["seconds"] = {**data.get("seconds", {}), **{k: round(v, 3) for k, v in seconds.items()}}
    lines = [*outcome["lines"]]
    if data["dry_run"]:
        lines.append("dry run: nothing was written")
    lines += [f"wrote {data['output']}"] if "output" in data else []
    lines += [f"wrote {path}" for path in data.get("pictures", ())]
    lines.append("seconds: " + ", ".join(f"{stage} {value:.2f}" for stage, value in data["seconds"].items()))
    terminal.result("\n".join(lines), data)


def _draw(session: Session, outcome: Mapping[str, Any], folder: Path, force: bool) -> list[str]:
    from ...gaussians.render import render
    from ..pictures import save_png

    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for name in ("before", "after"):
        save_png(render(outcome[name].cloud, session.viewer).to_uint8(), folder / f"{name}.png", force)
        written.append(str(folder / f"{name}.png"))
    return written
